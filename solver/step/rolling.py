"""Rows of a disc with a sharp rim that rolls on a plane without slip.

Frame A carries the plane with the normal n, frame B the disc of radius R with the axle b, all in
space. The rim touches at Delta + l from A and at l from B, Delta = r_B - r_A:

    w = n - (n . b) b,   q = |w|,   l = -R w / q
    heading t = b x n / q,   across it n x t

    touch       c = n . Delta - R q     the direction e of its force: n
    roll        no coordinate           t
    side slip   no coordinate           n x t

The point of the disc that touches moves against the plane along e by gradient . V, with the
gradient r_A: -e, theta_A: -(Delta + l) x e, r_B: e, theta_B: l x e. Along n this is dc/dt. The
other two rates are constraints that no coordinate has (couplings.py). Source: docs/theory.md,
Rolling.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled
from .kinds import delta_of, row_kind
from .records.couplings import Rows
from .system import Workspace
from .vectors import (
    UNIT_AXES,
    ZERO_VECTOR,
    Vector,
    add,
    cross,
    dot,
    rotate,
    row,
    scale,
    subtract,
)

NORMAL, HEADING, ACROSS = 0, 1, 2
"""directions of the rows"""


@compiled
def _radius(rows: Rows, i: int) -> float:
    return rows.parameters[rows.first[i]]  # type: ignore[no-any-return]


@compiled
def _inverse_tilt(w: Vector) -> float:
    """1 / q; 0 for a disc that lies flat, whose rim touches everywhere."""
    square = dot(w, w)
    return 1.0 / math.sqrt(square) if square > 0.0 else 0.0


@compiled
def _direction(n: Vector, b: Vector, inverse: float, which: int) -> Vector:
    if which == NORMAL:
        return n
    t = scale(inverse, cross(b, n))
    return t if which == HEADING else cross(n, t)


@compiled
def _touching(
    rows: Rows, i: int, which: int, work: Workspace
) -> tuple[Vector, Vector, Vector, float, Vector, Vector]:
    """n, b, w, 1 / q, e and l of a row."""
    n = rotate(work.frames.D, rows.frame_a[i], row(rows.a, i))
    b = rotate(work.frames.D, rows.frame_b[i], row(rows.b, i))
    w = subtract(n, scale(dot(n, b), b))
    inverse = _inverse_tilt(w)
    l_B = scale(-_radius(rows, i) * inverse, w)
    return n, b, w, inverse, _direction(n, b, inverse, which), l_B


@compiled
def _set_gradient(rows: Rows, i: int, which: int, work: Workspace, gradient: Array) -> float:
    """The gradient of a row; returns n . Delta - R q."""
    n, _, _, _, e, l_B = _touching(rows, i, which, work)
    delta = delta_of(rows, i, work)
    by_A, by_B = cross(add(delta, l_B), e), cross(l_B, e)
    for k in range(3):
        gradient[k] = -e[k]
        gradient[3 + k] = -by_A[k]
        gradient[6 + k] = e[k]
        gradient[9 + k] = by_B[k]
    return float(dot(n, delta) + dot(n, l_B))


@compiled
def _add_gradient_tangent(
    rows: Rows, i: int, which: int, factor: float, work: Workspace, H: Array
) -> None:
    n, b, w, inverse, e, l_B = _touching(rows, i, which, work)
    R, s = _radius(rows, i), dot(n, b)
    l_A, t = add(delta_of(rows, i, work), l_B), scale(inverse, cross(b, n))
    for j in range(12):
        unit = UNIT_AXES[j % 3]
        d_delta, dn, db = ZERO_VECTOR, ZERO_VECTOR, ZERO_VECTOR
        if j < 3:
            d_delta = scale(-1.0, unit)
        elif j < 6:
            dn = cross(unit, n)
        elif j < 9:
            d_delta = unit
        else:
            db = cross(unit, b)
        dw = subtract(dn, add(scale(dot(dn, b) + dot(n, db), b), scale(s, db)))
        along = dot(w, dw) * inverse * inverse
        dl_B = scale(-R * inverse, subtract(dw, scale(along, w)))
        dl_A, de = add(d_delta, dl_B), dn
        if which != NORMAL:
            dt = scale(inverse, add(cross(db, n), cross(b, dn)))
            dt = subtract(dt, scale(dot(t, dt), t))
            de = dt if which == HEADING else add(cross(dn, t), cross(n, dt))
        by_A, by_B = add(cross(dl_A, e), cross(l_A, de)), add(cross(dl_B, e), cross(l_B, de))
        for k in range(3):
            H[k, j] -= factor * de[k]
            H[3 + k, j] -= factor * by_A[k]
            H[6 + k, j] += factor * de[k]
            H[9 + k, j] += factor * by_B[k]


@row_kind(length=True)
class Touch:
    """c = n . Delta - R q"""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        return _set_gradient(rows, i, NORMAL, work, gradient)

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_gradient_tangent(rows, i, NORMAL, factor, work, H)


@row_kind(length=True, slips=True)
class Roll:
    """The rate of the point that touches along the heading."""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        _set_gradient(rows, i, HEADING, work, gradient)
        return 0.0

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_gradient_tangent(rows, i, HEADING, factor, work, H)


@row_kind(length=True, slips=True)
class SideSlip:
    """Its rate across the heading."""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        _set_gradient(rows, i, ACROSS, work, gradient)
        return 0.0

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_gradient_tangent(rows, i, ACROSS, factor, work, H)
