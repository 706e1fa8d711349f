"""The inertia that the friction of a coupling moves."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import Array
from ..couplings.coupling import GROUND, Coupling, Inertia
from ..couplings.rows import Pose
from ..model.model import Model


def inertia_between(coupling: Coupling, model: Model, poses: Mapping[str, Pose]) -> Inertia:
    """The reduced mass of the bodies of a coupling [kg], or with an axis (3,), in space at the
    start, that of their inertias about it through its frames [kg m^2]. The ground has none.
    """

    def inertia(axis: Array | None) -> float:
        if axis is None:
            return _reduced([model.bodies[body].mass for body, _ in sides])
        return _reduced([_about(axis, model, poses, *side) for side in sides])

    named = (side.partition(".") for side in coupling.between)
    # The closure reads `sides` when it is called: the ground has no inertia, and so no term.
    sides = [(body, frame) for body, _, frame in named if body != GROUND]
    return inertia


def _reduced(inertias: Sequence[float]) -> float:
    """1 / sum of 1 / inertia"""
    return 1.0 / sum(1.0 / inertia for inertia in inertias)


def _about(axis: Array, model: Model, poses: Mapping[str, Pose], name: str, frame: str) -> float:
    """The inertia of a body about an axis through one of its frames."""
    body, own = model.bodies[name], poses[name].R.T @ axis
    lever = body.frames[frame].position if frame else np.zeros(3)
    arm = np.cross(own, lever)
    # Steiner: the axis goes through the frame, not the center of mass.
    return float(own @ body.inertia @ own + body.mass * arm @ arm)
