"""Whether drives, motors, springs and constraints allow rest or a steady rotation."""

import numpy as np

from ..arrays import Array, Index
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..step.records.laws import Motors
from ..step.system import Workspace
from .assembly import drive_rates
from .steady import SteadyMotion

NEGLIGIBLE_RATE = 1e-8
"""relative to the rates of the whole run: splines and sines vanish but for rounding"""
DRIVE_SAMPLES = 65
"""times of a run at which the rates of drives are looked at"""


def check_drives(lowered: LoweredModel) -> None:
    """ModelError for a drive that accelerates at t = 0."""
    accelerations = np.array([drive.derivatives(0.0)[1] for drive in lowered.drives])
    accelerates = np.abs(accelerations) > _negligible(lowered)[:, 1]
    for d, i in enumerate(lowered.system.couplings.driven.tolist()):
        if accelerates[d]:
            raise ModelError(
                f"{lowered.owner_of(i)}: start = 'equilibrium' needs drives without acceleration "
                f"at t = 0, got {accelerations[d]:.6g}"
            )


def _negligible(lowered: LoweredModel) -> Array:
    """Rates and accelerations of the drives that count as none (n_drives, 2).

    Relative to those of the whole run: a spline, or a sine with a phase, is zero but for rounding.
    """
    T = lowered.model.settings.t_end
    times = np.linspace(0.0, T, DRIVE_SAMPLES).tolist()
    limits = np.zeros((len(lowered.drives), 2))
    for d, drive in enumerate(lowered.drives):
        motion = np.abs([(drive(t), *drive.derivatives(t)) for t in times]).max(axis=0)
        limits[d] = NEGLIGIBLE_RATE * (motion[1:] + motion[:-1] / T)
    return limits


def _negligible_references(lowered: LoweredModel) -> Array:
    """Rates of the references of motors that count as none (n_motors,), as those of drives."""
    times = np.linspace(0.0, lowered.model.settings.t_end, DRIVE_SAMPLES)
    rates = lowered.motor_signals[2::3]
    return NEGLIGIBLE_RATE * np.array(
        [np.abs(rate.samples(times, lowered.h)).max() for rate in rates]
    )


def check_steady(lowered: LoweredModel, motion: SteadyMotion | None, work: Workspace) -> None:
    """ModelError unless constraints and springs keep their coordinates in the steady motion.

    That is a steady rotation, or rest. The rates B v + phi_t must vanish, so that a
    drive may run at the speed of the rotation and at no other.
    """
    couplings, lengths = lowered.system.couplings, lowered.measures_lengths
    V = np.zeros_like(work.frames.V)
    if motion is not None:
        moving = lowered.system.frames.body >= 0
        Omega = motion.angular_velocity[lowered.system.frames.body[moving]]
        V[moving, :3] = np.cross(Omega, work.frames.r[moving] - motion.center)
        V[moving, 3:] = Omega
    V_ab = np.hstack([V[couplings.rows.frame_a], V[couplings.rows.frame_b]])
    driven = drive_rates(lowered, work)
    laws = couplings.laws
    _follow_references(lowered, driven, work)
    resisting = laws.stiffness.any(1) | laws.damping.any(1) | (np.diff(laws.range) > 0)
    resisting |= np.isin(laws.motor, _servos(laws.motors))
    # Rows without a law, as of friction, resist nothing at rest.
    inert = (couplings.compliant == 1) & ~resisting
    along = np.einsum("ij,ij->i", work.couplings.gradient, V_ab)
    terms = couplings.terms
    V_ab = np.hstack([V[terms.rows.frame_a], V[terms.rows.frame_b]])
    by_terms = np.einsum("ij,ij->i", work.terms.gradient, V_ab)
    np.add.at(along, terms.row, terms.ratio * by_terms)
    rates = np.where(inert, 0.0, np.abs(along + driven))
    speed = 0.0 if motion is None else motion.speed
    allowed = NEGLIGIBLE_RATE * np.where(lengths, speed * lowered.system.bodies.size, speed)
    # Rows without a drive have the number -1, and so the zero at the end.
    allowed += np.array([*_negligible(lowered)[:, 0], 0.0])[couplings.drive]
    allowed[laws.motors.row] += _negligible_references(lowered)
    if not (rates > allowed).any():
        return
    i = int(np.argmax(rates - allowed))
    effect = (
        "misses its drive" if driven[i] else "deforms it" if couplings.compliant[i] else "opens it"
    )
    rotation = lowered.model.settings.steady_rotation
    state_of_motion = "rest"
    if rotation is not None:
        state_of_motion = f"a steady rotation of {rotation.angular_velocity.tolist()} rad/s"
    unit = "m/s" if lengths[i] else "rad/s"
    raise ModelError(
        f"{lowered.owner_of(i)}: start = 'equilibrium': {state_of_motion} {effect} "
        f"by {rates[i]:.6g} {unit}"
    )


def _servos(motors: Motors) -> Index:
    """The motors that have gains, by number."""
    return np.flatnonzero((motors.stiffness > 0) | (motors.damping > 0) | (motors.integral > 0))


def _follow_references(lowered: LoweredModel, driven: Array, work: Workspace) -> None:
    """Set the rates at which the references of servos run from the coordinates of their rows."""
    motors = lowered.system.couplings.laws.motors
    for m in _servos(motors).tolist():
        driven[motors.row[m]] = -work.motors.value[3 * m + 2]
