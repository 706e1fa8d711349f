"""Rows of a contact: the gap between a ball on frame B and a shape that frame A carries, and slip.

With y = D_A^T Delta, Delta = r_B - r_A, a shape of distance s(y) (shapes.py), turned inside out
where the ball is inside, and a ball of radius r,

    gap     c = s(y) - r                gradient: r_A: -n,  theta_A: n x Delta,  r_B: n

with n = D_A grad s. The bodies touch at r_B - r n, l_A = Delta - r n from A and l_B = -r n from B;
there they slip along t1, which is an axis of A projected on the tangent plane, and t2 = n x t1:

    slip    no coordinate               gradient: r_A: -t,  theta_A: -l_A x t,
                                                  r_B:  t,  theta_B:  l_B x t

The axis is that of t1 at the last step, so that it rolls along with the normal. A shape is turned
by w = dtheta_A and passed by at m = dDelta - w x Delta:

    dn = D_A K D_A^T m + w x n
    dt1 = w x t1 + (1 - t1 t1^T) dp / |p|,  p = (1 - n n^T) axis
    dt2 = w x t2 + dn' x t1 + n x dt1'

with dn', dt1' less the parts of w. Source: docs/theory.md, Contact.
"""

import math
from collections.abc import Sequence

from ..arrays import Array
from ..compiler.marks import compiled
from .kinds import delta_of, row_kind
from .records.couplings import Couplings, Rows
from .shapes import CYLINDER, HALF_LENGTH, PROFILE, Curvature, curve, surface_at
from .system import Workspace
from .vectors import (
    UNIT_AXES,
    ZERO_VECTOR,
    Vector,
    add,
    cross,
    dot,
    rotate,
    rotate_back,
    row,
    scale,
    subtract,
    triple,
)

BALL, SIDE, SHAPE = 0, 1, 2
"""places of the parameters of a row (`gap_parameters`)"""
MIN_PROJECTED_AXIS = 1e-3
"""length of a unit axis, projected on the tangent plane, below which it gives no direction"""


def gap_parameters(ball: float, hollow: bool, shape: Sequence[float]) -> list[float]:
    """The parameters of the rows of a contact.

    ball: radius of the ball, 0 for a point [m]; hollow: the ball is inside of the shape; shape: the
    parameters of the shape (shapes.py).
    """
    return [ball, -1.0 if hollow else 1.0, *shape]


@compiled
def ball_radius(rows: Rows, i: int) -> float:
    """The radius of the ball of row i [m], 0 for a point."""
    return rows.parameters[rows.first[i] + BALL]  # type: ignore[no-any-return]


@compiled
def place_of_ball(rows: Rows, i: int, work: Workspace) -> Vector:
    """y, the center of the ball from frame A in the axes of A."""
    return rotate_back(work.frames.D, rows.frame_a[i], delta_of(rows, i, work))


@compiled
def _surface(rows: Rows, i: int, work: Workspace) -> tuple[float, Vector, Curvature, float]:
    """The gap, n and K in the axes of A, and how far the ball is beyond the ends of the shape."""
    return _surface_at(rows, i, place_of_ball(rows, i, work))


@compiled
def _surface_at(rows: Rows, i: int, y: Vector) -> tuple[float, Vector, Curvature, float]:
    """The same with the ball at y."""
    parameters = rows.parameters[rows.first[i] : rows.first[i + 1]]
    s, n, K, beyond = surface_at(
        rows.shape[i], parameters[SHAPE:], row(rows.a, i), row(rows.a_turned, i), y
    )
    side = parameters[SIDE]
    K = (side * K[0], side * K[1], side * K[2], side * K[3], side * K[4], side * K[5])
    return side * s - parameters[BALL], scale(side, n), K, beyond


@compiled
def gap_at(rows: Rows, i: int, y: Vector, blocked: bool) -> tuple[float, bool]:
    """The gap with the ball at y, and whether a contact cannot begin there (`is_blocked`).

    blocked: whether it could not at the place before.
    """
    gap, _, _, beyond = _surface_at(rows, i, y)
    blocked = gap < 0.0 and (beyond > 0.0 or blocked)
    return _open_past_ends(gap, beyond, blocked), blocked


@compiled
def _open_past_ends(gap: float, beyond: float, blocked: bool) -> float:
    if beyond > 0.0:
        # Two distances add, so that the gap stays continuous as the ball comes round the end.
        return max(gap, 0.0) + beyond
    # A ball that came in from an end has not touched the surface: it must not be thrown out.
    return abs(gap) if blocked else gap


@compiled
def is_blocked(rows: Rows, i: int, work: Workspace) -> bool:
    """Whether the ball is where a contact cannot have begun: beyond an end, or in from there."""
    gap, _, _, beyond = _surface(rows, i, work)
    return bool(gap < 0.0 and (beyond > 0.0 or work.couplings.blocked[i] == 1))


@compiled
def has_ends(rows: Rows, i: int) -> bool:
    """Whether the shape is a cylinder of finite length, or a profile that is not closed."""
    first, end = rows.first[i] + SHAPE, rows.first[i + 1]
    if rows.shape[i] == CYLINDER:
        return bool(rows.parameters[first + HALF_LENGTH] < math.inf)
    # The last parameter of a profile says whether it is closed.
    return bool(rows.shape[i] == PROFILE and rows.parameters[end - 1] == 0.0)


@compiled
def slip_axis(rows: Rows, i: int, work: Workspace) -> Vector:
    """An axis across the normal, from which slip is counted when a contact begins."""
    _, n, _, _ = _surface(rows, i, work)
    along, across = row(rows.a, i), row(rows.a_turned, i)
    best, least = along, abs(dot(along, n))
    for axis in (across, cross(along, across)):
        # The margin keeps rounding from choosing between two axes that are equally good.
        if abs(dot(axis, n)) < least - 1e-9:
            best, least = axis, abs(dot(axis, n))
    return best


@compiled
def settled_axis(rows: Rows, i: int, work: Workspace) -> Vector:
    """t1 of slip i in the axes of A."""
    _, n, _, _ = _surface(rows, i, work)
    f = rows.frame_a[i]
    t, _, _ = tangents(rows, i, rotate(work.frames.D, f, n), work)
    return rotate_back(work.frames.D, f, t)


@row_kind(length=True)
class Gap:
    """c = s(y) - r; open, past an end of the shape, by its distance from there as well.

    The gradient is that of s: past an end there is no force.
    """

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        gap, n, _, beyond = _surface(rows, i, work)
        n = rotate(work.frames.D, rows.frame_a[i], n)
        lever = cross(n, delta_of(rows, i, work))
        for k in range(3):
            gradient[k] = -n[k]
            gradient[3 + k] = lever[k]
            gradient[6 + k] = n[k]
        return _open_past_ends(gap, beyond, work.couplings.blocked[i] == 1)

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _, n, K, _ = _surface(rows, i, work)
        n, delta = rotate(work.frames.D, rows.frame_a[i], n), delta_of(rows, i, work)
        for j in range(9):
            w, d_delta = _motion(j)
            dn = add(_turned_normal(rows, i, K, w, d_delta, delta, work), cross(w, n))
            d_lever = add(cross(dn, delta), cross(n, d_delta))
            for k in range(3):
                H[k, j] -= factor * dn[k]
                H[3 + k, j] += factor * d_lever[k]
                H[6 + k, j] += factor * dn[k]


@compiled
def _motion(j: int) -> tuple[Vector, Vector]:
    """dtheta_A and dDelta of a unit of coordinate j of (r_A, theta_A, r_B)."""
    e = UNIT_AXES[j % 3]
    if j < 3:
        return ZERO_VECTOR, scale(-1.0, e)
    return (e, ZERO_VECTOR) if j < 6 else (ZERO_VECTOR, e)


@compiled
def _turned_normal(
    rows: Rows, i: int, K: Curvature, w: Vector, d_delta: Vector, delta: Vector, work: Workspace
) -> Vector:
    """D_A K D_A^T (dDelta - w x Delta)"""
    f, m = rows.frame_a[i], subtract(d_delta, cross(w, delta))
    return rotate(work.frames.D, f, curve(K, rotate_back(work.frames.D, f, m)))


@compiled
def tangents(rows: Rows, i: int, n: Vector, work: Workspace) -> tuple[Vector, Vector, float]:
    """t1 and the axis in space, and 1 / |p|; zero where the axis gives no direction."""
    axis = rotate(work.frames.D, rows.frame_a[i], row(work.couplings.slip_axis, i))
    t1, inverse = _across(n, axis)
    return t1, axis, inverse


@compiled
def _across(n: Vector, axis: Vector) -> tuple[Vector, float]:
    """The part p of an axis across n, over its length, and 1 / |p|."""
    p = subtract(axis, scale(dot(n, axis), n))
    length = math.sqrt(dot(p, p))
    inverse = 1.0 / length if length > MIN_PROJECTED_AXIS else 0.0
    return scale(inverse, p), inverse


@compiled
def _set_slip(rows: Rows, i: int, second: bool, work: Workspace, gradient: Array) -> None:
    _, n, _, _ = _surface(rows, i, work)
    n = rotate(work.frames.D, rows.frame_a[i], n)
    t, _, _ = tangents(rows, i, n, work)
    if second:
        t = cross(n, t)
    l_B = scale(-ball_radius(rows, i), n)
    l_A = add(delta_of(rows, i, work), l_B)
    by_A, by_B = cross(l_A, t), cross(l_B, t)
    for k in range(3):
        gradient[k] = -t[k]
        gradient[3 + k] = -by_A[k]
        gradient[6 + k] = t[k]
        gradient[9 + k] = by_B[k]


@compiled
def _add_slip_tangent(
    rows: Rows, i: int, second: bool, factor: float, work: Workspace, H: Array
) -> None:
    _, n, K, _ = _surface(rows, i, work)
    n, delta = rotate(work.frames.D, rows.frame_a[i], n), delta_of(rows, i, work)
    t1, axis, inverse = tangents(rows, i, n, work)
    t = cross(n, t1) if second else t1
    r = ball_radius(rows, i)
    l_B = scale(-r, n)
    l_A = add(delta, l_B)
    for j in range(9):
        w, d_delta = _motion(j)
        dn = _turned_normal(rows, i, K, w, d_delta, delta, work)
        dp = scale(-1.0, add(scale(dot(n, axis), dn), scale(dot(dn, axis), n)))
        dt = scale(inverse, subtract(dp, scale(dot(t1, dp), t1)))
        if second:
            dt = add(cross(dn, t1), cross(n, dt))
        dn, dt = add(dn, cross(w, n)), add(dt, cross(w, t))
        dl_B = scale(-r, dn)
        dl_A = add(d_delta, dl_B)
        by_A, by_B = add(cross(dl_A, t), cross(l_A, dt)), add(cross(dl_B, t), cross(l_B, dt))
        for k in range(3):
            H[k, j] -= factor * dt[k]
            H[3 + k, j] -= factor * by_A[k]
            H[6 + k, j] += factor * dt[k]
            H[9 + k, j] += factor * by_B[k]


@row_kind(length=True, slips=True)
class FirstSlip:
    """The rate along t1."""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        _set_slip(rows, i, False, work, gradient)
        return 0.0

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_slip_tangent(rows, i, False, factor, work, H)


@row_kind(length=True, slips=True)
class SecondSlip:
    """The rate along t2."""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        _set_slip(rows, i, True, work, gradient)
        return 0.0

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_slip_tangent(rows, i, True, factor, work, H)


@compiled
def contact_motion(
    couplings: Couplings, j: int, work: Workspace
) -> tuple[tuple[float, float], Vector, Vector]:
    """Rates of slip of contact j along t1 and t2, its normal, and its point r_B - r n, in space."""
    rows, frames, i = couplings.rows, work.frames, couplings.range[j]
    f, g = rows.frame_a[i], rows.frame_b[i]
    _, normal, _, _ = _surface(rows, i, work)
    # An open contact has no axis yet; records need one for its tangents.
    axis = slip_axis(rows, i, work)
    if couplings.friction_of[j] >= 0 and work.couplings.status[j]:
        axis = row(work.couplings.slip_axis, i + 1)
    n = rotate(frames.D, f, normal)
    t1, _ = _across(n, rotate(frames.D, f, axis))
    l_B = scale(-ball_radius(rows, i), n)
    v = subtract(_velocity(g, l_B, work), _velocity(f, add(delta_of(rows, i, work), l_B), work))
    return (dot(v, t1), dot(v, cross(n, t1))), n, add(row(frames.r, g), l_B)


@compiled
def contact_arm(rows: Rows, i: int, work: Workspace) -> Vector:
    """The arm of the normal force about frame A, in space: n x Delta, of the last gradient."""
    return triple(work.couplings.gradient[i], 3)


@compiled
def _velocity(f: int, lever: Vector, work: Workspace) -> Vector:
    """Of a point at a lever from frame f, that moves with it."""
    V = work.frames.V[f]
    return add(triple(V, 0), cross(triple(V, 3), lever))
