"""The state that a model is linearized about: an equilibrium, at rest or in steady rotation."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError, about
from ..laws.law import LAWS
from ..laws.maxwell import MaxwellLaw
from ..lower.lower import LoweredModel, lower
from ..model.joints import Joint
from ..model.model import Model
from ..model.output_request import OutputRequest
from ..model.settings import StartFrom, SteadyRotation
from ..start.initial import InitialState, initialize
from ..step.equations import evaluate
from ..step.system import State, System, Workspace


@dataclass(frozen=True, eq=False)
class Pose:
    """A lowered model in equilibrium, and the rotation of all its bodies as one.

    angular_velocity (3,) in space [rad/s] about the point center (3,) [m]; zero: at rest.
    """

    lowered: LoweredModel
    state: State
    work: Workspace
    angular_velocity: Array
    center: Array

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
    """The equilibrium of a model nearest to its start, under gravity and the loads at t = 0.

    rotation: in place of the steady rotation of its settings. Velocities of the start count for
    nothing. `ModelError` where there is none, and for what has no linear equations: friction that
    acts, and laws with a memory but Maxwell's.
    """
    model = _at_rest(model, rotation)
    with about(model.path):
        initial = initialize(model, lower(model), continuous=True)
        _check_linear(initial)
    rotation = model.settings.steady_rotation or SteadyRotation(np.zeros(3))
    return Pose(
        initial.lowered,
        initial.state,
        initial.work,
        np.array(rotation.angular_velocity),
        np.array(rotation.center),
    )


def _at_rest(model: Model, rotation: SteadyRotation | None) -> Model:
    """The model with a start in equilibrium, and without velocities."""
    settings = model.settings
    if isinstance(settings.start, StartFrom):
        raise ModelError(
            "simulation: start: a linear analysis is about an equilibrium near a pose that the "
            "model gives, got the end of another run"
        )
    changes: dict[str, Any] = {
        "start": "equilibrium",
        "contact_step": None,
        "rule": "consistent",
        "output": OutputRequest(),
    }
    if all(body.superelement.modes is not None for body in model.flexible_bodies.values()):
        changes |= {"history": "recursive", "kernel_length": None}
    if rotation is not None:
        changes["steady_rotation"] = rotation
    zero = np.zeros(3)
    bodies = {
        name: replace(body, start=replace(body.start, velocity=zero, angular_velocity=zero))
        for name, body in model.bodies.items()
    }
    joints = tuple(_without_rates(joint) for joint in model.joints)
    return replace(model, bodies=bodies, joints=joints, settings=replace(settings, **changes))


def _without_rates(joint: Joint) -> Joint:
    if not any(key.endswith("_rate") for key in joint.start):
        return joint
    kept = {key: value for key, value in joint.start.items() if not key.endswith("_rate")}
    return replace(joint, start=kept)


def _check_linear(initial: InitialState) -> None:
    """`ModelError` for friction that acts, and for laws whose slope depends on their past."""
    lowered, couplings = initial.lowered, initial.lowered.system.couplings
    status = initial.work.couplings.status
    for j in np.flatnonzero(couplings.friction_of >= 0).tolist():
        if couplings.contact_of[j] < 0 or status[j]:
            owner = lowered.model.couplings[j].owner
            raise ModelError(f"{owner}: friction sticks or slips, and has no linear equations")
    laws = couplings.laws
    for motor in lowered.model.motors:
        if motor.integral > 0.0:
            raise motor.error(
                "integral: linear equations take stiffness and damping of motors alone, got "
                f"{motor.integral:g}"
            )
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        law = LAWS[laws.number[m]]
        if laws.memory[m + 1] > laws.memory[m] and law is not MaxwellLaw:
            raise ModelError(
                f"{lowered.owner_of(i)}: {law.__name__} depends on its past, and has no linear "
                "equations"
            )
