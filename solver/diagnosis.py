"""Why Newton's method may have failed in a step, in words.

Found from the state that the step was predicted to end in, before any correction.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .arrays import Array
from .lower.lower import LoweredModel
from .start.inertia import geometric_scale, inverse_inertia
from .start.jacobian import constraint_jacobian, constraint_rows, coupling_jacobian
from .start.matrices import dense_of, is_small, unit_rows
from .start.redundancy import describe_rows
from .step.bodies import accelerate, largest_coordinate
from .step.equations import evaluate, linearize
from .step.force_laws import law_of_row
from .step.friction import friction_rounding, set_normal_force
from .step.spin_tables import beyond_table
from .step.system import State, Workspace

LARGE_TURN = 0.5
"""rad in a step, from which on its prediction is poor"""
ABSURD_TURN = 1e3
"""rad in a step, which no smaller step would mend"""
TOO_LIGHT = "it is too light for its loads, or the step too large"
LARGE_FLIGHT = 10.0
"""displacement in a step over the size of the model that no motion of it has"""
NEARLY_DEPENDENT = 0.03
"""singular value of the Jacobian of joints, with rows of length one, of a pose next to singular"""
# share of a row in a dependence; more rows than cause it would hide those that do
MIN_NAMED_SHARE = 0.1
FEW_ITERATIONS = 10
# relative change of a spin in a step
NEAR_END_OF_TABLE = 1e-3
COARSE_BRISTLE = 1e-3
"""rounding of a bristle's force, over that at which it slips, which hides whether it does"""
MOTOR_SIGNALS = ("torque or force", "reference", "reference_rate")


class Failure(NamedTuple):
    """The step in which Newton's method failed."""

    lowered: LoweredModel
    state: State
    work: Workspace
    time: float


def likely_cause(lowered: LoweredModel, state: State, work: Workspace, time: float) -> str:
    """The first cause that shows, "" if none does; the state is put back to the prediction."""
    failure = Failure(lowered, state, work, time)
    # Before the state is put back: both look at what Newton's method left.
    given, unsettled = _input(failure), _unsettled(failure)
    if given:
        return given
    _predict(failure)
    found = (find(failure) for find in FAILURE_CAUSES)
    return next((cause for cause in found if cause), unsettled)


def _predict(failure: Failure) -> None:
    """The state that the step was predicted to end in without acceleration."""
    lowered, state, work, _ = failure
    state.bodies.v_dot[:] = 0.0
    accelerate(lowered.system.scheme, state, work)
    state.interfaces.u[:] = work.interfaces.u_n
    state.couplings.lam[:] = work.couplings.lam_n
    evaluate(lowered.system, state, work)
    linearize(lowered.system, state, work)


def _input(failure: Failure) -> str:
    """A load, a motor or a drive that is no number, or a drive that jumps."""
    lowered, state, work, t = failure
    for load, value in zip(lowered.loads, work.loads.value.tolist(), strict=True):
        if not math.isfinite(value):
            return f"{load.owner}: its signal is {_sample(load.signal, t)} at this time"
    for motor, values in zip(lowered.model.motors, work.motors.value.reshape(-1, 3), strict=True):
        if not np.isfinite(values).all():
            key = MOTOR_SIGNALS[int(np.argmin(np.isfinite(values)))]
            return f"{motor.owner}: its {key} is no number at this time"
    for d, value in enumerate(work.drives.value.tolist()):
        i = int(lowered.system.couplings.driven[d])
        size, unit = _size_of(lowered, i)
        change = value - float(state.drives.value[d])
        if not math.isfinite(value):
            return f"{lowered.owner_of(i)}: its drive is {_sample(lowered.drives[d], t)} here"
        if abs(change) > LARGE_TURN * size:
            return f"{lowered.owner_of(i)}: its drive moves by {change:.3g} {unit} in this step"
    return ""


def _sample(signal: Callable[[float], float], t: float) -> str:
    return f"{signal(t):g}"


def _size_of(lowered: LoweredModel, row: int) -> tuple[float, str]:
    """What the coordinate of a row is measured by, and its unit."""
    lengths = lowered.measures_lengths
    return (float(lowered.system.bodies.size), "m") if lengths[row] else (1.0, "rad")


def _spin(failure: Failure) -> str:
    """A shaft that spins faster or slower than the table of its bearing."""
    lowered, _, work, _ = failure
    tables = lowered.system.couplings.laws.tables
    for t, row in enumerate(tables.spin.tolist()):
        spin = float(work.couplings.rate[row])
        # A spin at the end of its margin leaves it in the corrections that follow.
        if beyond_table(tables, t, spin) > -NEAR_END_OF_TABLE * abs(spin):
            speeds = tables.speed[tables.first[t] : tables.first[t + 1]]
            return (
                f"{lowered.owner_of(row)}: its spin of {spin:.6g} rad/s is beyond its table, from "
                f"{speeds[0]:.6g} to {speeds[-1]:.6g}"
            )
    return ""


def _turn(failure: Failure) -> str:
    """A body that turns far in the step."""
    lowered, _, work, _ = failure
    turns = np.linalg.norm(work.bodies.psi, axis=1)
    b = int(np.argmax(turns))
    if not turns[b] > LARGE_TURN:
        return ""
    step, mass = lowered.h * LARGE_TURN / turns[b], float(lowered.system.bodies.mass[b])
    remedy = f"try a step below {step:.2g} s" if turns[b] < ABSURD_TURN else TOO_LIGHT
    name = lowered.body_names[b]
    return f"body {name!r} of {mass:g} kg turns by {turns[b]:.3g} rad in this step; {remedy}"


def _flight(failure: Failure) -> str:
    """A body that moves far in the step."""
    lowered, state, _, _ = failure
    motions = lowered.h * np.linalg.norm(state.bodies.v[:, :3], axis=1)
    b = int(np.argmax(motions))
    if not motions[b] > LARGE_FLIGHT * lowered.system.bodies.size:
        return ""
    mass = float(lowered.system.bodies.mass[b])
    return (
        f"body {lowered.body_names[b]!r} of {mass:g} kg moves by {motions[b]:.3g} m in this step; "
        f"{TOO_LIGHT}"
    )


def _dependence(failure: Failure) -> str:
    """Joints that depend on one another in this pose, or nearly so."""
    lowered, state, work, _ = failure
    # Singular values of large models would take longer than the run until there.
    if not is_small(lowered.system) or not len(constraint_rows(lowered.system)):
        return ""
    B, _ = constraint_jacobian(lowered.system, state, work)
    J, _ = unit_rows(dense_of(B @ geometric_scale(lowered.system)))
    left, values, _ = np.linalg.svd(J)
    # More rows than unknowns are dependent in any pose.
    least = float(values[-1]) if len(J) <= J.shape[1] else 0.0
    if not least < NEARLY_DEPENDENT:
        return ""
    rows = constraint_rows(lowered.system)[np.abs(left[:, -1]) > MIN_NAMED_SHARE].tolist()
    driven = any(lowered.system.couplings.drive[i] >= 0 for i in rows)
    ask = "; its drive requires a pose that the mechanism cannot reach, or where its path branches"
    return f"a singular pose, with dependent constraints {describe_rows(lowered, rows)}" + (
        ask if driven else ""
    )


def _bristle(failure: Failure) -> str:
    """Friction that sticks by so stiff a spring that positions have no digits for its bend."""
    lowered, state, work, _ = failure
    couplings = lowered.system.couplings
    friction, reach = couplings.friction, largest_coordinate(lowered.system.bodies, state)
    for j in np.flatnonzero(couplings.friction_of >= 0).tolist():
        r, first = int(couplings.friction_of[j]), int(couplings.range[j])
        row, stiffness = int(friction.first[r]), float(friction.stiffness[r])
        normal = set_normal_force(couplings, first, r, work.couplings.lam_n, work)
        limit = float(friction.static[r]) * normal
        if friction_rounding(couplings, j, row, reach, work) > COARSE_BRISTLE * limit > 0.0:
            return (
                f"{lowered.owner_of(row)}: sticks by a spring of {stiffness:.3g}, which bends by "
                f"{limit / stiffness:.2g} before it slips, near the rounding of positions: take "
                "a smaller stiffness of friction"
            )
    return ""


def _stiffness(failure: Failure) -> str:
    """A spring whose period is less than a few steps."""
    lowered = failure.lowered
    couplings = lowered.system.couplings
    if not couplings.n_compliant:
        return ""
    stiffness = np.array([_slope(failure, i) for i in range(len(couplings.compliant))])
    # stiffness times mobility is the square of the frequency of the row alone.
    frequency = np.sqrt(np.maximum(stiffness * _mobility(failure), 0.0))
    i = int(np.argmax(frequency))
    if not frequency[i] * lowered.h > 1.0:
        return ""
    return (
        f"{lowered.owner_of(i)}: its period there is {2.0 * np.pi / frequency[i]:.2g} s, too short "
        "for the step"
    )


def _slope(failure: Failure, row: int) -> float:
    """The stiffness of a row's own law, 0 of a constraint."""
    couplings = failure.lowered.system.couplings
    if not couplings.compliant[row]:
        return 0.0
    first = couplings.range[failure.lowered.coupling_of(row)]
    _, slope, _, _ = law_of_row(couplings.laws, row, failure.state, failure.work)
    return abs(float(couplings.laws.stiffness[row, row - first])) + abs(slope)


def _mobility(failure: Failure) -> Array:
    """Accelerations of all rows by unit multipliers of their own, bodies rigid (n_rows,)."""
    lowered, state, work, _ = failure
    n_q = 6 * len(lowered.system.bodies.mass)
    B = coupling_jacobian(lowered.system, state, work)[:, :n_q]
    product = (B @ inverse_inertia(lowered.system)) * B
    mobility: Array = np.asarray(product.sum(axis=1)).ravel()
    return mobility


def _unsettled(failure: Failure) -> str:
    """A force law that Newton's method did not satisfy."""
    lowered, work = failure.lowered, failure.work
    compliant = lowered.system.couplings.compliant == 1
    # phi of a law is its multiplier less its force, relative to the force of the step.
    error = np.abs(work.couplings.phi) * compliant / np.maximum(work.couplings.scale, 1e-300)
    if not error.size or not error.max() > lowered.model.settings.tolerance:
        return ""
    owner = lowered.owner_of(int(np.argmax(error)))
    return f"{owner}: its law is too steep there for the step"


def _iterations(failure: Failure) -> str:
    """A limit of iterations that is too low."""
    limit = failure.lowered.model.settings.max_iterations
    return f"max_iterations = {limit} are few" if limit < FEW_ITERATIONS else ""


FAILURE_CAUSES = (_spin, _turn, _flight, _bristle, _stiffness, _iterations, _dependence)
