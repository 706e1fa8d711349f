"""Whether the equations of a steady rotation are constant: the same when all has turned on.

What stands in space, bearings, gravity, loads that do not follow, must look the same from the
mechanism at every time. That is so where it is alike all round the axis.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..step.bodies import largest_coordinate
from ..step.force_laws import law_rounding
from ..step.rotations import quaternion_exponential, quaternion_matrix, quaternion_product
from .equations import Equations, Forcing, equations_of
from .pose import Pose
from .tangent import tangent_of

# [rad] A quarter turn would hide what has fourfold symmetry; 1 rad is a part of no full turn.
PROBE_TURN = 1.0
# relative
NEGLIGIBLE_DIFFERENCE = 1e-6

# of the farthest motion, below which motions are rounding
MIN_MOTION = 1e-4


def check_constant(equations: Equations) -> None:
    """`ModelError` where forces or coefficients of a steady rotation change with its angle."""
    pose = equations.pose
    if pose.speed == 0.0:
        return
    before = _rigid_response(equations)
    with turned(equations) as other:
        balanced = other is not None
        after = before if other is None else _rigid_response(other)
    size = _sizes(before, pose.system.bodies.size)
    if (
        not balanced
        or (np.abs(after - before) > NEGLIGIBLE_DIFFERENCE * np.outer(size, size)).any()
    ):
        what = "its stiffness, damping or constraints change" if balanced else "forces change"
        raise ModelError(
            f"steady rotation of {pose.angular_velocity.tolist()} rad/s: {what} with the angle "
            "of rotation: supports and loads must be symmetric about the axis"
        )


@contextmanager
def turned(equations: Equations, angle: float = PROBE_TURN) -> Iterator[Equations | None]:
    """The equations when all bodies have turned on by an angle [rad]; None where nothing balances.

    The state of their pose is put back at the end: what follows from it belongs into the block.
    """
    pose = equations.pose
    arrays = (*pose.state.arrays(), *pose.work.drives.arrays())
    saved = [array.copy() for array in arrays]
    _turn(pose, angle)
    try:
        yield equations_of(pose) if _balance(equations) else None
    finally:
        for array, old in zip(arrays, saved, strict=True):
            array[:] = old
        pose.evaluate(pose.system)


def _rigid_response(equations: Equations) -> Any:
    """Motions of bodies (n_r, n_r) under unit wrenches in their axes, at a real frequency."""
    sizes = equations.sizes
    n_l = len(equations.pose.system.elastic.loaded)
    wrenches = -np.eye(sizes.n_r)
    forcing = Forcing(wrenches, np.zeros((n_l, sizes.n_r)), np.zeros((sizes.n_i, sizes.n_r)))
    return equations.factorized(0.37 * equations.pose.speed).forced(forcing).xi


def _sizes(response: Any, length: float) -> Array:
    """How far coordinates move (n_r,), each at least a little of the farthest."""
    moved = np.sqrt(np.abs(np.diag(response))).reshape(-1, 2, 3)
    weight = np.array([1.0, length])[None, :, None]
    sizes: Array = np.maximum(moved, MIN_MOTION * (weight * moved).max() / weight).ravel()
    return sizes


def _turn(pose: Pose, angle: float) -> None:
    """Turn all bodies, and drives with them, as the rotation goes on by an angle [rad]."""
    axis = pose.angular_velocity / pose.speed
    turn, Q, product = np.empty(4), np.empty((3, 3)), np.empty(4)
    motion = pose.state.bodies
    for b, ratio in enumerate(pose.ratios.tolist()):
        quaternion_exponential(ratio * angle * axis, turn)
        quaternion_matrix(turn, Q)
        motion.x[b] = pose.center + Q @ (motion.x[b] - pose.center)
        quaternion_product(turn, motion.quaternion[b], product)
        motion.quaternion[b] = product
        quaternion_matrix(product, motion.R[b])
        for array in (motion.v, motion.v_dot):
            array[b, :3] = Q @ array[b, :3]
    pose.work.drives.value[:] += pose.work.drives.rate * angle / pose.speed


def _balance(equations: Equations) -> bool:
    """Find the multipliers there, whose rows may stand in space; False if none balance."""
    pose, sizes = equations.pose, equations.sizes
    system, state, work = pose.system, pose.state, pose.work
    active = system.elastic.active
    loads = state.interfaces.p[active].copy()
    pose.evaluate(system)
    state.couplings.lam[:] -= work.couplings.phi * system.couplings.compliant
    pose.evaluate(system)
    hard = np.flatnonzero(system.couplings.compliant == 0)
    by_rows = tangent_of(pose).by_rows[:, hard]
    pose.evaluate(system)
    H: Any = equations.flexibility(equations.transfers(0.0))[:, equations.acting]
    missing = np.concatenate(
        [_in_bodies(pose), _stiffness_scale(pose) * (H @ (state.interfaces.p[active] - loads))]
    )
    matrix = np.vstack([by_rows[sizes.rigid], _stiffness_scale(pose) * H @ by_rows[sizes.active]])
    change, *_ = np.linalg.lstsq(matrix, -missing, rcond=None)
    state.couplings.lam[hard] += change
    left = np.abs(missing + matrix @ change).max(initial=0.0)
    return bool(
        left <= NEGLIGIBLE_DIFFERENCE * _force(pose)
        and np.abs(work.couplings.phi).max(initial=0.0) < 1e-6
    )


def _in_bodies(pose: Pose) -> Array:
    residual = pose.work.bodies.residual.copy()
    R = pose.state.bodies.R
    residual[:, :3] = np.einsum("bji,bj->bi", R, residual[:, :3])
    return residual.ravel()


def _force(pose: Pose) -> float:
    """A force of the rotation, of the loads, or that stiff springs make of rounding [N, N m]."""
    bodies = pose.system.bodies
    size = max(bodies.size, 1.0)
    spin = float(bodies.mass.sum()) * pose.speed**2 * bodies.size
    return size * max(
        spin,
        float(np.abs(pose.state.couplings.lam).max(initial=0.0)),
        _rounding(pose) / NEGLIGIBLE_DIFFERENCE,
    )


def _rounding(pose: Pose) -> float:
    """The largest change of the force of a law by the rounding of positions."""
    couplings = pose.system.couplings
    reach = largest_coordinate(pose.system.bodies, pose.state)
    first = np.repeat(couplings.range[:-1], np.diff(couplings.range)).tolist()
    return max(
        (
            law_rounding(pose.system, i, first[i], reach, pose.state, pose.work)
            for i in np.flatnonzero(couplings.compliant).tolist()
        ),
        default=0.0,
    )


def _stiffness_scale(pose: Pose) -> float:
    """What makes forces of elastic displacements, so that both count alike [N/m]."""
    return float(pose.system.bodies.mass.sum()) * pose.speed**2
