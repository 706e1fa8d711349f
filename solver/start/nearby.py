"""Poses beside that of the start, which a mechanism reaches without opening a joint."""

from collections.abc import Iterator

import numpy as np

from ..lower.lower import LoweredModel
from ..step.equations import evaluate, linearize
from ..step.system import State, Workspace
from .assembly import approach_joints, move_bodies
from .dependence import least_solution, owners_of_columns
from .inertia import geometric_scale
from .matrices import Matrix, unit_rows

DISTANCE = 0.01
"""of the poses from the start: rotations [rad], and displacements over the length of a body"""
TRIES = 3
CORRECTIONS = 7
"""of Newton's method, which closes joints to rounding where it squares errors

At a dead point, to which it comes back, it halves them: the pose is then still beside that.
"""
FREE = 1e-9
"""singular values of a Jacobian with rows of unit length below which a motion is free"""
IMMOVABLE = 1e-6
"""what is left of a random motion of order one where none is free"""


def poses_nearby(lowered: LoweredModel, state: State, work: Workspace, J: Matrix) -> Iterator[None]:
    """Bring the bodies into a few poses nearby, with `work` linearized there; then back.

    J (n, 6 n_b): the scaled Jacobian of the constraints at the start. The poses lie along random
    motions that it leaves free, with joints closed as far as they can be.
    """
    J, _ = unit_rows(J)
    owners = owners_of_columns(lowered.system, J)
    scale, random = geometric_scale(lowered.system), np.random.default_rng(0)
    arrays = [*state.arrays(), work.bodies.quaternion_n, work.bodies.psi]
    saved = [array.copy() for array in arrays]
    for _ in range(TRIES):
        any_motion = random.standard_normal(J.shape[1])
        along = any_motion - least_solution(J, J @ any_motion, owners, FREE)
        if np.abs(along).max() < IMMOVABLE:
            break
        change = scale @ along * (DISTANCE / np.abs(along).max())
        move_bodies(change.reshape(-1, 6), state, work)
        for _ in range(CORRECTIONS):
            approach_joints(lowered, state, work)
        yield
        for array, old in zip(arrays, saved, strict=True):
            array[:] = old
    evaluate(lowered.system, state, work)
    linearize(lowered.system, state, work)
