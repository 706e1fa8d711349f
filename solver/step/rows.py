"""Rows: scalar coordinates of a pair of frames A and B, with gradients and second derivatives.

With a = D_A a_A, a' = D_A a'_A, b = D_B b_B carried by the frames, and Delta = r_B - r_A, all in
space:

    translation   c = a . Delta             gradient: r_A: -a,  theta_A: a x Delta,  r_B: a
    rotation      c = a . b                 gradient: theta_A: a x b,  theta_B: -a x b
    distance      c = |Delta|               gradient: r_A: -n,  r_B: n,  n = Delta / |Delta|
    angle         c = atan2(a' . b, a . b)  gradient: from those of the two rotation rows;
                                            continued over full turns
    angle of A    the same, of b carried by A, seen from a and a' carried by B
    attitude      c = a(t) . b              as a rotation, of an axis a that follows three drives

Lengths and angles are measured from a zero, which is subtracted from them.

A wrench lambda times the gradient changes, at constant lambda, by lambda times the tangent H (12,
12) of the row: with N(a, b) = skew(b) skew(a) = a b^T - (a . b) I, d(a x b) = N dtheta_A - N^T
dtheta_B. Second derivatives in time follow from gradient and tangent (couplings.py). A kind of row
is a class with `@row_kind`; those of contacts are in gaps.py, those of discs in rolling.py. Source:
docs/theory.md, Frames, joints, loads.
"""

import math

from ..arrays import Array
from ..compiler.dispatch import dispatcher
from ..compiler.marks import compiled
from .gaps import Gap
from .kinds import ROW_KINDS, delta_of, row_kind
from .records.couplings import Rows
from .rolling import Touch
from .system import Workspace
from .vectors import UNIT_AXES, Vector, add, cross, dot, rotate, row, scale, subtract, triple


@compiled
def carried_axis(rows: Rows, i: int, angle: float) -> Vector:
    """The axis of row i in frame A, turned by an angle from a towards a'."""
    a = row(rows.a, i)
    if angle == 0.0:
        return a
    return add(scale(math.cos(angle), a), scale(math.sin(angle), row(rows.a_turned, i)))


@compiled
def _axes(rows: Rows, i: int, angle: float, work: Workspace) -> tuple[Vector, Vector]:
    """a and b in space."""
    a = rotate(work.frames.D, rows.frame_a[i], carried_axis(rows, i, angle))
    return a, rotate(work.frames.D, rows.frame_b[i], row(rows.b, i))


@row_kind(length=True)
class Translation:
    """c = a . Delta"""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        delta = delta_of(rows, i, work)
        a = rotate(work.frames.D, rows.frame_a[i], row(rows.a, i))
        lever = cross(a, delta)
        for k in range(3):
            gradient[k] = -a[k]
            gradient[3 + k] = lever[k]
            gradient[6 + k] = a[k]
        return float(dot(a, delta) - rows.zero[i])

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        delta = delta_of(rows, i, work)
        f = scale(factor, rotate(work.frames.D, rows.frame_a[i], row(rows.a, i)))
        for j in range(3):
            f_e = cross(f, UNIT_AXES[j])
            turned = cross(delta, f_e)
            for k in range(3):
                H[k, 3 + j] += f_e[k]
                H[6 + k, 3 + j] -= f_e[k]
                H[3 + k, j] -= f_e[k]
                H[3 + k, 6 + j] += f_e[k]
                H[3 + k, 3 + j] += turned[k]


@row_kind(length=False)
class Rotation:
    """c = a . b"""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        a, b = _axes(rows, i, angle, work)
        _set_rotation_gradient(cross(a, b), gradient)
        return dot(a, b)

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        a, b = _axes(rows, i, angle, work)
        _add_rotation(a, b, factor, H)


@row_kind(length=True)
class Distance:
    """c = |Delta|"""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        delta = delta_of(rows, i, work)
        length = math.sqrt(dot(delta, delta))
        inverse = 1.0 / length if length > 0.0 else 0.0  # without direction no force
        for k in range(3):
            gradient[k] = -delta[k] * inverse
            gradient[6 + k] = delta[k] * inverse
        return float(length - rows.zero[i])

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        delta = delta_of(rows, i, work)
        length = math.sqrt(dot(delta, delta))
        if length == 0.0:
            return
        n = scale(1.0 / length, delta)
        for j in range(3):
            for k in range(3):
                value = factor * ((1.0 if j == k else 0.0) - n[j] * n[k]) / length
                H[k, j] += value
                H[6 + k, 6 + j] += value
                H[k, 6 + j] -= value
                H[6 + k, j] -= value


@row_kind(length=False)
class Angle:
    """c = atan2(s, c) of s = a' . b and c = a . b, the value nearest to `near`.

    The gradient is (c g_s - s g_c) / q, with q = s^2 + c^2 and the gradients g of s and c; its
    derivative has the terms of H_s, H_c and those of the factors: d(c/q) = ((s^2 - c^2) dc - 2 s c
    ds) / q^2 and d(s/q) = ((c^2 - s^2) ds - 2 s c dc) / q^2.
    """

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        normal, value = _angle(rows, i, (rows.frame_a[i], rows.frame_b[i]), work)
        _set_rotation_gradient(normal, gradient)
        return nearest_angle(value - rows.zero[i], near)

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_angle(rows, i, (rows.frame_a[i], rows.frame_b[i]), factor, work, H)


@row_kind(length=False)
class AngleOfA:
    """The angle at which b, here carried by A, is seen from a and a', carried by B."""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        normal, value = _angle(rows, i, (rows.frame_b[i], rows.frame_a[i]), work)
        _set_rotation_gradient(scale(-1.0, normal), gradient)
        return nearest_angle(value - rows.zero[i], near)

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        _add_angle(rows, i, (rows.frame_b[i], rows.frame_a[i]), factor, work, H)


@row_kind(length=False)
class Attitude:
    """c = a . b, of an axis a in frame A whose components follow three drives."""

    number: int

    @staticmethod
    def evaluate(
        rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
    ) -> float:
        a, b = _driven_axes(rows, i, work)
        _set_rotation_gradient(cross(a, b), gradient)
        return dot(a, b)

    @staticmethod
    def add_tangent(
        rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
    ) -> None:
        a, b = _driven_axes(rows, i, work)
        _add_rotation(a, b, factor, H)


@compiled
def _driven_axes(rows: Rows, i: int, work: Workspace) -> tuple[Vector, Vector]:
    """a and b in space, of a row whose axis a is driven."""
    a = rotate(work.frames.D, rows.frame_a[i], triple(work.drives.value, rows.axis[i]))
    return a, rotate(work.frames.D, rows.frame_b[i], row(rows.b, i))


@compiled
def _three_axes(
    rows: Rows, i: int, pair: tuple[int, int], work: Workspace
) -> tuple[Vector, Vector, Vector]:
    """a and a', carried by the first of two frames, and b, by the second, in space."""
    a = rotate(work.frames.D, pair[0], row(rows.a, i))
    turned = rotate(work.frames.D, pair[0], row(rows.a_turned, i))
    return a, turned, rotate(work.frames.D, pair[1], row(rows.b, i))


@compiled
def _angle(rows: Rows, i: int, pair: tuple[int, int], work: Workspace) -> tuple[Vector, float]:
    """The gradient of an angle by the rotation of the first frame, and its value."""
    a, turned, b = _three_axes(rows, i, pair, work)
    s, c = dot(turned, b), dot(a, b)
    by_sine, by_cosine = scale(c, cross(turned, b)), scale(s, cross(a, b))
    return scale(1.0 / (s * s + c * c), subtract(by_sine, by_cosine)), math.atan2(s, c)


@compiled
def _add_angle(
    rows: Rows, i: int, pair: tuple[int, int], factor: float, work: Workspace, H: Array
) -> None:
    """H += factor times the tangent of an angle; n: place of the rotation of the first frame."""
    a, turned, b = _three_axes(rows, i, pair, work)
    n = 3 if pair[0] == rows.frame_a[i] else 9
    m = 12 - n
    s, c = dot(turned, b), dot(a, b)
    q = s * s + c * c
    _add_rotation_at(turned, b, factor * c / q, n, H)
    _add_rotation_at(a, b, -factor * s / q, n, H)
    g_s, g_c = cross(turned, b), cross(a, b)
    # q is 1 only where b is in the plane of a and a'; elsewhere the factors change with it.
    same, mixed = (c * c - s * s) / (q * q), 2.0 * s * c / (q * q)
    for k in range(3):
        for j in range(3):
            value = -g_s[k] * (same * g_c[j] + mixed * g_s[j])
            value -= g_c[k] * (same * g_s[j] - mixed * g_c[j])
            H[n + k, n + j] += factor * value
            H[m + k, m + j] += factor * value
            H[n + k, m + j] -= factor * value
            H[m + k, n + j] -= factor * value


@compiled
def nearest_angle(angle: float, near: float) -> float:
    """The angle, by full turns nearest to another."""
    # atan2 knows angles within a turn alone; the prediction tells which turn.
    return angle + 2.0 * math.pi * round((near - angle) / (2.0 * math.pi))


@compiled
def _set_rotation_gradient(normal: Vector, gradient: Array) -> None:
    for k in range(3):
        gradient[3 + k] = normal[k]
        gradient[9 + k] = -normal[k]


@compiled
def _add_rotation(a: Vector, b: Vector, factor: float, H: Array) -> None:
    """H += factor times the tangent of a . b."""
    _add_rotation_at(a, b, factor, 3, H)


@compiled
def _add_rotation_at(a: Vector, b: Vector, factor: float, n: int, H: Array) -> None:
    """The same with the rotation of the frame of a at n = 3 or 9, that of the other at 12 - n."""
    value, m = dot(a, b), 12 - n
    for j in range(3):
        for k in range(3):
            N = factor * (a[k] * b[j] - (value if j == k else 0.0))
            H[n + k, n + j] += N
            H[m + k, n + j] -= N
            H[n + j, m + k] -= N
            H[m + j, m + k] += N


LENGTH_KINDS = tuple(kind.number for kind in ROW_KINDS if kind.length)
SLIP_KINDS = tuple(kind.number for kind in ROW_KINDS if kind.slips)
ROTATION, ANGLE, GAP, TOUCH = Rotation.number, Angle.number, Gap.number, Touch.number
ANGLE_OF_A, ATTITUDE = AngleOfA.number, Attitude.number
_evaluate = dispatcher(
    "evaluate_kind",
    "rows, i, angle, near, work, gradient",
    [kind.evaluate for kind in ROW_KINDS],
    otherwise="0.0",
)
_add_tangent = dispatcher(
    "add_kind_tangent",
    "rows, i, angle, factor, work, H",
    [kind.add_tangent for kind in ROW_KINDS],
    otherwise="None",
)


@compiled
def measures_length(kind: int) -> bool:
    """True where the coordinate of a kind of rows is a length."""
    for number in LENGTH_KINDS:  # noqa: SIM110 - compiled code has no generators
        if kind == number:
            return True
    return False


@compiled
def is_angle(kind: int) -> bool:
    """True where the coordinate of a kind of rows is an angle, which goes on over full turns."""
    return kind in (ANGLE, ANGLE_OF_A)


@compiled
def slips(kind: int) -> bool:
    """True where a kind of rows has no coordinate but the integral of its rate."""
    for number in SLIP_KINDS:  # noqa: SIM110 - compiled code has no generators
        if kind == number:
            return True
    return False


@compiled
def nearest_turn(rows: Rows, i: int, value: float, near: float) -> float:
    """The coordinate of row i, an angle by full turns nearest to `near`."""
    return nearest_angle(value, near) if is_angle(rows.kind[i]) else value


@compiled
def evaluate_row(
    rows: Rows, i: int, angle: float, near: float, work: Workspace, gradient: Array
) -> float:
    """The coordinate of row i, for an angle the value nearest to `near`, and its gradient (12,).

    angle: the angle by which a drive turns the axis a.
    """
    gradient[:] = 0.0
    return float(_evaluate(rows.kind[i], rows, i, angle, near, work, gradient))


@compiled
def add_row_tangent(
    rows: Rows, i: int, angle: float, factor: float, work: Workspace, H: Array
) -> None:
    """H (12, 12) += factor times the tangent of row i."""
    _add_tangent(rows.kind[i], rows, i, angle, factor, work, H)
