"""The state that a model is linearized about: an equilibrium, at rest or in steady rotation."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..couplings.joint import Joint
from ..couplings.motors import Motor
from ..errors import ModelError
from ..laws.contact import ContactLaw
from ..laws.law import LAW_KINDS
from ..laws.maxwell import MaxwellLaw
from ..lower.lower import LoweredModel, lower
from ..model.model import Model
from ..model.output_request import OutputRequest
from ..model.settings import StartFrom, SteadyRotation
from ..model.speed_ratios import speed_ratios
from ..signals.curves import Constant
from ..start.initial import InitialState, initialize
from ..step.equations import evaluate
from ..step.system import State, System, Workspace
from .driven import driven_at

# relative change of a deformation, and a rate, beside which slopes are compared
SLOPE_PROBE = 1e-6
# relative change of a slope; smooth laws change by about SLOPE_PROBE
MIN_SLOPE_JUMP = 1e-2


@dataclass(frozen=True, eq=False)
class Pose:
    """A lowered model in equilibrium, and the steady rotation of its bodies.

    angular_velocity (3,) in space [rad/s] about the point center (3,) [m]; zero: at rest; ratios
    (n_b,): the angular velocities of the bodies over it.
    """

    lowered: LoweredModel
    state: State
    work: Workspace
    angular_velocity: Array
    center: Array
    ratios: Array

    @property
    def system(self) -> System:
        return self.lowered.system

    @property
    def speed(self) -> float:
        return float(np.linalg.norm(self.angular_velocity))

    def settle(self, rate: Array) -> None:
        """Scratch of a step of no length, at whose end elastic dofs move at a rate (n_u,)."""
        work = self.work
        work.bodies.quaternion_n[:] = self.state.bodies.quaternion
        work.bodies.psi[:] = 0.0
        work.interfaces.u_predicted[:] = self.state.interfaces.u
        work.interfaces.rate_predicted[:] = rate
        work.interfaces.history[:] = 0.0
        work.couplings.elapsed[:] = np.inf

    def evaluate(self, system: System) -> None:
        """Wrenches and residuals of the state, with the coefficients of `system`."""
        self.settle(np.zeros_like(self.state.interfaces.u))
        evaluate(system, self.state, self.work)


def pose_of(model: Model, rotation: SteadyRotation | None = None) -> Pose:
    """The equilibrium of a model nearest to its start, under gravity.

    And under the loads at t = 0 where the model starts in equilibrium; where it starts as given,
    they begin then, and count for nothing, as velocities do. rotation: in place of the steady
    rotation of its settings; drives that turn the mechanism follow it.
    `ModelError` where there is none, and for what has no linear equations: friction that acts, laws
    with a memory but Maxwell's, laws with a kink there.
    """
    model = _at_rest(model, rotation)
    initial = initialize(model, lower(model), continuous=True)
    _check_linear(initial)
    rotation = model.settings.steady_rotation or SteadyRotation(np.zeros(3))
    return Pose(
        initial.lowered,
        initial.state,
        initial.work,
        np.array(rotation.angular_velocity),
        np.array(rotation.center),
        _ratios(model, rotation),
    )


def _ratios(model: Model, rotation: SteadyRotation) -> Array:
    """The speeds of the bodies over that of a rotation (n_b,); at rest they do not matter."""
    if not np.any(rotation.angular_velocity):
        return np.ones(len(model.bodies))
    return np.array(list(speed_ratios(model, rotation).values()))


def _at_rest(model: Model, rotation: SteadyRotation | None) -> Model:
    """The model with a start in equilibrium, and without velocities."""
    settings = model.settings
    if isinstance(settings.start, StartFrom):
        raise ModelError(
            "simulation: start: a linear analysis starts from a pose given in the model, "
            "got the end of another run"
        )
    changes: dict[str, Any] = {
        "start": "equilibrium",
        "contact_step": None,
        "rule": "consistent",
        "output": OutputRequest(),
    }
    elements = [body.superelement for body in model.flexible_bodies.values()]
    kernels = [element.kernel.length for element in elements if element.modes is None]
    # how long a run would be is no matter here, but the kernels of one must be as long
    changes |= {"t_end": min([settings.t_end, *kernels]), "kernel_length": None}
    if not kernels:
        changes |= {"history": "recursive"}
    if rotation is not None:
        changes["steady_rotation"] = rotation
        model = replace(model, **driven_at(model, rotation))
    zero = np.zeros(3)
    bodies = {
        name: replace(body, start=replace(body.start, velocity=zero, angular_velocity=zero))
        for name, body in model.bodies.items()
    }
    loads, motors = model.loads, model.motors
    if settings.start != "equilibrium":
        loads = tuple(load.unloaded() for load in loads)
        motors = tuple(_without_torque(motor) for motor in motors)
    joints = tuple(_without_rates(joint) for joint in model.joints)
    return replace(
        model,
        bodies=bodies,
        joints=joints,
        loads=loads,
        motors=motors,
        settings=replace(settings, **changes),
    )


def _without_torque(motor: Motor) -> Motor:
    """The motor with what it gives without an error at zero, as loads are."""
    torque = None if motor.torque is None else Constant(0.0)
    return replace(motor, torque=torque, force=None if motor.force is None else Constant(0.0))


def _without_rates(joint: Joint) -> Joint:
    if not any(key.endswith("_rate") for key in joint.start):
        return joint
    kept = {key: value for key, value in joint.start.items() if not key.endswith("_rate")}
    return replace(joint, start=kept)


def _is_open(initial: InitialState, i: int) -> bool:
    """Whether a row belongs to an open contact or stop."""
    j = initial.lowered.coupling_of(i)
    contact = initial.lowered.system.couplings.contact_of[j] >= 0
    return bool(contact and not initial.work.couplings.status[j])


def _check_slopes(initial: InitialState, m: int, i: int) -> None:
    """`ModelError` for a law whose slope jumps at rest, where no tangent is right."""
    lowered, work = initial.lowered, initial.work
    laws = lowered.system.couplings.laws
    law = LAW_KINDS[laws.number[m]]
    parameters = laws.parameters[laws.first[m] : laws.first[m + 1]]
    memory = initial.state.couplings.memory[laws.memory[m] : laws.memory[m + 1]]
    c = float(work.couplings.coordinate[i] - laws.rest[i])
    near = SLOPE_PROBE * max(abs(c), SLOPE_PROBE)
    for moves in ((near, 0.0), (0.0, SLOPE_PROBE)):
        slopes = [
            law.evaluate(parameters, memory, np.inf, c + way * moves[0], way * moves[1])[1:3]
            for way in (-1.0, 1.0)
        ]
        for before, after in zip(*slopes, strict=True):
            if abs(after - before) > MIN_SLOPE_JUMP * max(abs(after), abs(before)):
                raise ModelError(
                    f"{lowered.owner_of(i)}: the slope of {law.__name__} jumps at rest, "
                    f"from {before:.6g} to {after:.6g}"
                )


def _check_linear(initial: InitialState) -> None:
    """`ModelError` for friction that acts, and for laws whose slope depends on their past."""
    lowered, couplings = initial.lowered, initial.lowered.system.couplings
    status = initial.work.couplings.status
    for j in np.flatnonzero(couplings.friction_of >= 0).tolist():
        if couplings.contact_of[j] < 0 or status[j]:
            owner = lowered.model.couplings[j].owner
            raise ModelError(f"{owner}: friction sticks or slips and cannot be linearized")
    laws = couplings.laws
    for motor, limited in zip(lowered.model.motors, initial.work.motors.status, strict=True):
        if limited:
            raise motor.error("it is at its limit and cannot be linearized")
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        law = LAW_KINDS[laws.number[m]]
        if laws.memory[m + 1] > laws.memory[m] and law not in (MaxwellLaw, ContactLaw):
            raise ModelError(
                f"{lowered.owner_of(i)}: {law.__name__} depends on its past and cannot be "
                "linearized"
            )
        if not _is_open(initial, i):
            _check_slopes(initial, m, i)
