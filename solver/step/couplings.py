"""Joints and springs: wrenches on frames, residuals of constraints and of force laws, and their
derivatives.

The wrench of a row on its frames is lambda times its gradient, for L + lambda^T phi. A joint's row
must vanish, phi = c (less the driven distance; a driven rotation row turns its axis instead). A
spring's row has

    phi_i = lambda_i + sum_j (stiffness_ij (c_j - rest_j) + damping_ij dc_j/dt) + table_i(c_i) = 0

so that springs enter Newton like joints, and couple no two bodies but through their multiplier.
"""

import math

from ..arrays import Array
from .frames import add_pair_tangent, coordinate, pull_back, width
from .jit import compiled
from .rows import ROTATION, add_row_tangent, carried_axis, evaluate_row, measures_length
from .system import Couplings, Frames, State, System, Workspace
from .vectors import dot, rotate, row, triple


@compiled
def turn_of(couplings: Couplings, i: int, drive: Array) -> float:
    """The angle by which the drive of row i turns its axis."""
    d = couplings.drive[i]
    return float(drive[d]) if d >= 0 and couplings.rows.kind[i] == ROTATION else 0.0


@compiled
def evaluate_couplings(
    couplings: Couplings, lam: Array, near: Array, drive: Array, work: Workspace
) -> None:
    """Coordinates, rates, residuals and gradients of all rows; the wrenches are added to those of
    the frames.
    """
    rows = couplings.rows
    for i in range(len(rows.kind)):
        gradient = work.gradient[i]
        A, B = rows.frame_a[i], rows.frame_b[i]
        work.coordinate[i] = evaluate_row(
            rows, i, turn_of(couplings, i, drive), near[i], work, gradient
        )
        rate = 0.0
        for k in range(6):
            rate += gradient[k] * work.V[A, k] + gradient[6 + k] * work.V[B, k]
            work.wrench[A, k] += lam[i] * gradient[k]
            work.wrench[B, k] += lam[i] * gradient[6 + k]
        work.rate[i] = rate
        _constrain(couplings, i, drive, work)
    for j in range(len(couplings.range) - 1):
        wrench = work.coupling_wrench[j]
        wrench[:] = 0.0
        for i in range(couplings.range[j], couplings.range[j + 1]):
            for k in range(6):
                wrench[k] += lam[i] * work.gradient[i, couplings.second[i] + k]
            if couplings.compliant[i]:
                _follow_law(couplings, i, couplings.range[j], couplings.range[j + 1], lam, work)


@compiled
def _constrain(couplings: Couplings, i: int, drive: Array, work: Workspace) -> None:
    """phi = c - s on a driven length, c elsewhere; d phi / d s of the drive."""
    work.phi[i] = work.coordinate[i]
    d = couplings.drive[i]
    if d < 0:
        return
    if measures_length(couplings.rows.kind[i]):
        work.phi[i] -= drive[d]
        work.drive_slope[i] = -1.0
    else:
        ahead = carried_axis(couplings.rows, i, drive[d] + 0.5 * math.pi)
        A, B = couplings.rows.frame_a[i], couplings.rows.frame_b[i]
        work.drive_slope[i] = dot(
            rotate(work.D, A, ahead), rotate(work.D, B, row(couplings.rows.b, i))
        )


@compiled
def _follow_law(
    couplings: Couplings, i: int, first: int, last: int, lam: Array, work: Workspace
) -> None:
    total, size = lam[i], abs(lam[i])
    for j in range(first, last):
        elastic = couplings.stiffness[i, j - first] * (work.coordinate[j] - couplings.rest[j])
        viscous = couplings.damping[i, j - first] * work.rate[j]
        total += elastic + viscous
        size += abs(elastic) + abs(viscous)
    force, _, _ = table(couplings, i, work.coordinate[i])
    work.phi[i] = total + force
    work.law_scale[i] = size + abs(force)


@compiled
def table(couplings: Couplings, i: int, coordinate: float) -> tuple[float, float, float]:
    """Force, slope and energy (from the first point) of the tabulated law of row i: linear, and so
    beyond its ends.
    """
    first, last = couplings.table[i], couplings.table[i + 1]
    if first == last:
        return 0.0, 0.0, 0.0
    x, force = couplings.table_coordinate, couplings.table_force
    energy = 0.0
    k = first
    while k + 2 < last and coordinate > x[k + 1]:
        energy += 0.5 * (force[k] + force[k + 1]) * (x[k + 1] - x[k])
        k += 1
    slope = (force[k + 1] - force[k]) / (x[k + 1] - x[k])
    value = force[k] + slope * (coordinate - x[k])
    return value, slope, energy + 0.5 * (force[k] + value) * (coordinate - x[k])


@compiled
def spring_energy(couplings: Couplings, work: Workspace) -> float:
    """1/2 (c - rest)^T stiffness (c - rest) and the areas under the tables."""
    total = 0.0
    for j in range(len(couplings.range) - 1):
        first = couplings.range[j]
        for i in range(first, couplings.range[j + 1]):
            if couplings.compliant[i]:
                stretch = work.coordinate[i] - couplings.rest[i]
                for k in range(first, couplings.range[j + 1]):
                    other = work.coordinate[k] - couplings.rest[k]
                    total += 0.5 * stretch * couplings.stiffness[i, k - first] * other
                _, _, energy = table(couplings, i, work.coordinate[i])
                total += energy
    return total


@compiled
def add_couplings(system: System, drive: Array, state: State, work: Workspace) -> None:
    """B, B_rate and A of all rows, and K += the tangents of the wrenches at constant multipliers."""
    couplings, frames, h = system.couplings, system.frames, system.scheme.h
    rows, H = couplings.rows, work.frame_tangent
    for j in range(len(couplings.range) - 1):
        first, last = couplings.range[j], couplings.range[j + 1]
        if first == last:  # all its rows were redundant
            continue
        A, B = rows.frame_a[first], rows.frame_b[first]
        for i in range(first, last):
            pull_back_pair(frames, A, B, work.gradient[i], state, work, work.B[i])
            if couplings.compliant[i]:
                _add_rate(couplings, frames, i, drive, state, work)
        for i in range(first, last):
            _add_residual(couplings, i, first, last, h, work)
        H[:] = 0.0
        for i in range(first, last):
            add_row_tangent(rows, i, turn_of(couplings, i, drive), state.lam[i], work, H)
        _pull_back_tangent(frames, A, B, state, work)
        _place_tangent(system, j, A, B, work)


@compiled
def pull_back_pair(
    frames: Frames, A: int, B: int, gradient: Array, state: State, work: Workspace, out: Array
) -> None:
    """A derivative by (r, theta) of two frames (12,) as one by the coordinates of both (24,)."""
    pull_back(frames, A, triple(gradient, 0), triple(gradient, 3), state, work, out[:12])
    pull_back(frames, B, triple(gradient, 6), triple(gradient, 9), state, work, out[12:])


@compiled
def _pull_back_tangent(frames: Frames, A: int, B: int, state: State, work: Workspace) -> None:
    """`work.pair_tangent` = map^T `work.frame_tangent` map, columns first."""
    H, half = work.frame_tangent, work.half_tangent
    for k in range(12):
        for f, first in ((A, 0), (B, 6)):
            force = (H[first, k], H[first + 1, k], H[first + 2, k])
            moment = (H[first + 3, k], H[first + 4, k], H[first + 5, k])
            pull_back(frames, f, force, moment, state, work, half[k, 2 * first : 2 * first + 12])
    for z in range(24):
        for f, first in ((A, 0), (B, 6)):
            force = (half[first, z], half[first + 1, z], half[first + 2, z])
            moment = (half[first + 3, z], half[first + 4, z], half[first + 5, z])
            pull_back(
                frames,
                f,
                force,
                moment,
                state,
                work,
                work.pair_tangent[z, 2 * first : 2 * first + 12],
            )


@compiled
def _place_tangent(system: System, j: int, A: int, B: int, work: Workspace) -> None:
    frames, pattern = system.frames, system.pattern
    a, b = frames.body[A], frames.body[B]
    if a >= 0:
        add_pair_tangent(
            frames, A, A, 0, 0, pattern.body_block[a, 0], pattern.body_block[a, 1], work
        )
    if b >= 0:
        add_pair_tangent(
            frames, B, B, 12, 12, pattern.body_block[b, 0], pattern.body_block[b, 1], work
        )
    if a >= 0 and b >= 0:
        place = pattern.coupling_block[j]
        add_pair_tangent(frames, A, B, 0, 12, place[0, 0], place[0, 1], work)
        add_pair_tangent(frames, B, A, 12, 0, place[1, 0], place[1, 1], work)


@compiled
def place_rows(system: System, work: Workspace) -> None:
    """B^T / h^2 into the rows of bodies, A and Z into those of couplings."""
    couplings, frames, pattern = system.couplings, system.frames, system.pattern
    h2 = system.scheme.h * system.scheme.h
    S = work.S
    for j in range(len(couplings.range) - 1):
        first, last = couplings.range[j], couplings.range[j + 1]
        place = pattern.coupling_block[j]
        for i in range(first, last):
            for side in range(2):
                f = couplings.rows.frame_a[i] if side == 0 else couplings.rows.frame_b[i]
                above, stride = place[2 + 2 * side, 0], place[2 + 2 * side, 1]
                beside = place[3 + 2 * side, 0] + (i - first) * place[3 + 2 * side, 1]
                for k in range(width(frames, f)):
                    z = coordinate(frames, f, k)
                    S[above + z * stride + i - first] += work.B[i, 12 * side + k] / h2
                    S[beside + z] += work.A[i, 12 * side + k]
            if couplings.compliant[i]:
                S[place[6, 0] + (i - first) * (place[6, 1] + 1)] = 1.0


@compiled
def _add_rate(
    couplings: Couplings, frames: Frames, i: int, drive: Array, state: State, work: Workspace
) -> None:
    """B_rate[i]: of dc/dt = gradient . V, by the gradient (V^T H) and by V."""
    rows, H, turned = couplings.rows, work.frame_tangent, work.scratch_12
    A, B = rows.frame_a[i], rows.frame_b[i]
    H[:] = 0.0
    add_row_tangent(rows, i, turn_of(couplings, i, drive), 1.0, work, H)
    for k in range(12):
        total = 0.0
        for m in range(6):
            total += work.V[A, m] * H[m, k] + work.V[B, m] * H[6 + m, k]
        turned[k] = total
    pull_back_pair(frames, A, B, turned, state, work, work.B_rate[i])
    for k in range(12):
        for m in range(6):
            work.B_rate[i, k] += work.gradient[i, m] * work.rate_map[A, m, k]
            work.B_rate[i, 12 + k] += work.gradient[i, 6 + m] * work.rate_map[B, m, k]


@compiled
def _add_residual(
    couplings: Couplings, i: int, first: int, last: int, h: float, work: Workspace
) -> None:
    """A[i] = B[i] of a constraint; h^2 (stiffness B + damping B_rate + table' B)[i] of a force law."""
    out = work.A[i]
    if not couplings.compliant[i]:
        for z in range(24):
            out[z] = work.B[i, z]
        return
    out[:] = 0.0
    _, slope, _ = table(couplings, i, work.coordinate[i])
    for j in range(first, last):
        stiffness = h * h * (couplings.stiffness[i, j - first] + (slope if i == j else 0.0))
        damping = h * h * couplings.damping[i, j - first]
        for z in range(24):
            out[z] += stiffness * work.B[j, z] + damping * work.B_rate[j, z]
