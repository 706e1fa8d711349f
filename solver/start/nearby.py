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

# rotations [rad], and displacements over the length of a body: far beyond rounding, near enough for
# Newton's method
POSE_DISTANCE = 0.01
# Random motions: one may happen to lie along a singular path, three hardly.
MAX_POSES = 3
# Newton's method closes joints to rounding where it squares errors. At a dead point it halves them:
# the pose is then still beside that.
CLOSING_CORRECTIONS = 7
# singular values of a Jacobian with rows of unit length
FREE_MOTION_TOLERANCE = 1e-9
# what rounding leaves of a random motion of order one where none is free
MIN_FREE_MOTION = 1e-6


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
    for _ in range(MAX_POSES):
        any_motion = random.standard_normal(J.shape[1])
        # The projection on the null space of J, without its singular vectors.
        along = any_motion - least_solution(J, J @ any_motion, owners, FREE_MOTION_TOLERANCE)
        if np.abs(along).max() < MIN_FREE_MOTION:
            break
        change = scale @ along * (POSE_DISTANCE / np.abs(along).max())
        move_bodies(change.reshape(-1, 6), state, work)
        for _ in range(CLOSING_CORRECTIONS):
            approach_joints(lowered, state, work)
        yield
        # A generator: the caller looks at the pose between `yield` and here.
        for array, old in zip(arrays, saved, strict=True):
            array[:] = old
    evaluate(lowered.system, state, work)
    linearize(lowered.system, state, work)
