"""The friction of contacts and joints: its bristle, and what its normal force is made of."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..couplings.contacts import Contact
from ..couplings.friction import FrictionCoefficient, JointFriction
from ..couplings.joints import Joint
from ..model.model import GROUND, Coupling, Model
from .placement import Pose

RESOLVED = 0.3
"""angular frequency of a bristle times the step, where nobody says how stiff it is"""
DAMPED = 0.2
"""damping of a bristle over sqrt(stiffness inertia), where nobody says: a ratio of 0.1"""


@dataclass(frozen=True)
class Bristle:
    """Friction of the last rows of a coupling."""

    coefficient: FrictionCoefficient
    stiffness: float
    damping: float
    viscous: float = 0.0
    preload: float = 0.0


def bristle_of(
    coupling: Coupling, model: Model, poses: Mapping[str, Pose], axis: Array, h: float
) -> Bristle | None:
    """The friction of a contact or a joint, in steps of h [s]; None where there is none.

    axis (3,): that of the joint, in space at the start.
    """
    if isinstance(coupling, Contact) and coupling.friction is not None:
        mass = _reduced(_masses(coupling, model))
        spring = coupling.tangential_stiffness, coupling.tangential_damping
        return Bristle(coupling.friction, *_spring(*spring, mass, h))
    if isinstance(coupling, Joint) and (friction := coupling.friction) is not None:
        turns = coupling.type == "revolute"
        moved = _inertias(coupling, model, poses, axis) if turns else _masses(coupling, model)
        return Bristle(
            friction.coefficient,
            *_spring(friction.stiffness, friction.damping, _reduced(moved), h),
            friction.viscous,
            friction.preload * (friction.radius or 1.0),
        )
    return None


def normal_weights(joint: Joint, friction: JointFriction) -> list[tuple[float, int]]:
    """Weight and group of each row of a joint in its normal force, by which friction is one of the
    joint's coordinate: times the radius of a revolute joint.
    """
    kind, arm = joint.kind, friction.radius or 1.0
    bearings = 2.0 * arm / friction.width if friction.width else 0.0
    forces = [(arm, 1 if k == 2 else 0) for k in kind.translations]
    # a moment about e3 of a prismatic joint turns what those across e3 tilt
    moments = [(bearings, 1 if {i, j} == {0, 1} else 2) for i, j in kind.rotations]
    return forces + moments


def _spring(
    stiffness: float | None, damping: float | None, inertia: float, h: float
) -> tuple[float, float]:
    """Stiffness and damping of a bristle that moves an inertia, by default those of its step."""
    stiffness = inertia * (RESOLVED / h) ** 2 if stiffness is None else stiffness
    damping = DAMPED * math.sqrt(stiffness * inertia) if damping is None else damping
    return stiffness, damping


def _sides(coupling: Contact | Joint) -> list[tuple[str, str]]:
    """Body and frame of both sides, less the ground."""
    sides = [side.partition(".") for side in coupling.between]
    return [(body, frame) for body, _, frame in sides if body != GROUND]


def _reduced(inertias: Sequence[float]) -> float:
    """1 / sum of 1 / inertia"""
    return 1.0 / sum(1.0 / inertia for inertia in inertias)


def _masses(coupling: Contact | Joint, model: Model) -> list[float]:
    return [model.bodies[body].mass for body, _ in _sides(coupling)]


def _inertias(joint: Joint, model: Model, poses: Mapping[str, Pose], axis: Array) -> list[float]:
    """Of the bodies of a joint about its axis."""
    inertias = []
    for name, frame in _sides(joint):
        body, own = model.bodies[name], poses[name].R.T @ axis
        lever = body.frames[frame].position if frame else np.zeros(3)
        arm = np.cross(own, lever)
        inertias.append(float(own @ body.inertia @ own + body.mass * arm @ arm))
    return inertias
