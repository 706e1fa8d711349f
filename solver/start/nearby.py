"""Poses beside that of the start, which a mechanism reaches without opening a joint."""

from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from ..lower.lower import LoweredModel
from ..step.equations import evaluate, linearize
from ..step.system import State, Workspace
from .assembly import approach_joints, move_bodies
from .inertia import geometric_scale
from .matrices import dense_of

DISTANCE = 0.01
"""of the poses from the start: rotations [rad], and displacements over the length of a body"""
TRIES = 3
CORRECTIONS = 7
"""of Newton's method, which closes joints to rounding where it squares errors

At a dead point, to which it comes back, it halves them: the pose is then still beside that.
"""
FREE = 1e-9
"""singular values of a Jacobian with columns of order one below which a motion is free"""


def poses_nearby(lowered: LoweredModel, state: State, work: Workspace, J: Array) -> Iterator[None]:
    """Bring the bodies into a few poses nearby, with `work` linearized there; then back.

    J (n, 6 n_b): the scaled Jacobian of the constraints at the start. The poses lie along random
    motions that it leaves free, with joints closed as far as they can be.
    """
    _, values, right = np.linalg.svd(J)
    free = right[np.count_nonzero(values > FREE) :]
    scale, random = dense_of(geometric_scale(lowered.system)), np.random.default_rng(0)
    arrays = [*state.arrays(), work.bodies.quaternion_n, work.bodies.psi]
    saved = [array.copy() for array in arrays]
    for _ in range(TRIES if len(free) else 0):
        along = random.standard_normal(len(free)) @ free
        change = scale @ along * (DISTANCE / np.abs(along).max())
        move_bodies(change.reshape(-1, 6), state, work)
        for _ in range(CORRECTIONS):
            approach_joints(lowered, state, work)
        yield
        for array, old in zip(arrays, saved, strict=True):
            array[:] = old
    evaluate(lowered.system, state, work)
    linearize(lowered.system, state, work)
