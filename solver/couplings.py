"""Joints and springs: wrenches on frames, residuals of constraints and of force laws, and their derivatives.

The wrench of a row on its frames is lambda times its gradient, for L + lambda^T phi. A joint's row must vanish, phi = c
(less the driven distance; a driven rotation row turns its axis instead). A spring's row has

    phi_i = lambda_i + sum_j (stiffness_ij (c_j - rest_j) + damping_ij dc_j/dt) + table_i(c_i) = 0

so that springs enter Newton like joints, and couple no two bodies but through their multiplier.
"""

import math

from .compiled import Array, compiled
from .frames import add_pair_tangent, column, width
from .rows import ROTATION, add_row_tangent, carried_axis, evaluate_row, measures_length
from .system import Couplings, Frames, Workspace
from .vectors import dot, rotate, row


@compiled
def turn_of(couplings: Couplings, i: int, drive: Array) -> float:
    """The angle by which the drive of row i turns its axis."""
    d = couplings.drive[i]
    return float(drive[d]) if d >= 0 and couplings.rows.kind[i] == ROTATION else 0.0


@compiled
def evaluate_couplings(couplings: Couplings, lam: Array, near: Array, drive: Array, work: Workspace) -> None:
    """Coordinates, rates, residuals and gradients of all rows; the wrenches are added to those of the frames."""
    rows = couplings.rows
    for i in range(len(rows.kind)):
        gradient = work.gradient[i]
        A, B = rows.frame_a[i], rows.frame_b[i]
        work.coordinate[i] = evaluate_row(rows, i, turn_of(couplings, i, drive), near[i], work, gradient)
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
                wrench[k] += lam[i] * work.gradient[i, 6 + k]
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
        work.drive_slope[i] = dot(rotate(work.D, A, ahead), rotate(work.D, B, row(couplings.rows.b, i)))


@compiled
def _follow_law(couplings: Couplings, i: int, first: int, last: int, lam: Array, work: Workspace) -> None:
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
    """Force, slope and energy (from the first point) of the tabulated law of row i: linear, and so beyond its ends."""
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
def add_couplings(
    couplings: Couplings, frames: Frames, n_q: int, h: float, lam: Array, drive: Array, work: Workspace
) -> None:
    """B, B_rate and A of all rows, and K += the tangents of the wrenches at constant multipliers."""
    rows, H = couplings.rows, work.frame_tangent
    for j in range(len(couplings.range) - 1):
        first, last = couplings.range[j], couplings.range[j + 1]
        if first == last:  # all its rows were redundant
            continue
        A, B = rows.frame_a[first], rows.frame_b[first]
        for i in range(first, last):
            _add_gradient(frames, n_q, i, A, 0, work.gradient[i], work.map, work.B)
            _add_gradient(frames, n_q, i, B, 6, work.gradient[i], work.map, work.B)
            if couplings.compliant[i]:
                _add_rate(couplings, frames, n_q, i, drive, work)
        for i in range(first, last):
            _add_residual(couplings, i, first, last, h, work)
        H[:] = 0.0
        for i in range(first, last):
            add_row_tangent(rows, i, turn_of(couplings, i, drive), lam[i], work, H)
        add_pair_tangent(frames, n_q, A, A, 0, 0, work)
        add_pair_tangent(frames, n_q, A, B, 0, 6, work)
        add_pair_tangent(frames, n_q, B, A, 6, 0, work)
        add_pair_tangent(frames, n_q, B, B, 6, 6, work)


@compiled
def _add_gradient(
    frames: Frames, n_q: int, i: int, f: int, first: int, gradient: Array, maps: Array, out: Array
) -> None:
    """out[i] += gradient[first : first + 6] map_f"""
    for k in range(width(frames, f)):
        total = 0.0
        for m in range(6):
            total += gradient[first + m] * maps[f, m, k]
        out[i, column(frames, n_q, f, k)] += total


@compiled
def _add_rate(couplings: Couplings, frames: Frames, n_q: int, i: int, drive: Array, work: Workspace) -> None:
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
    for f, first in ((A, 0), (B, 6)):
        _add_gradient(frames, n_q, i, f, first, turned, work.map, work.B_rate)
        _add_gradient(frames, n_q, i, f, first, work.gradient[i], work.rate_map, work.B_rate)


@compiled
def _add_residual(couplings: Couplings, i: int, first: int, last: int, h: float, work: Workspace) -> None:
    """A[i] = B[i] of a constraint; h^2 (stiffness B + damping B_rate + table' B)[i] of a force law."""
    out = work.A[i]
    if not couplings.compliant[i]:
        for z in range(len(out)):
            out[z] = work.B[i, z]
        return
    out[:] = 0.0
    _, slope, _ = table(couplings, i, work.coordinate[i])
    for j in range(first, last):
        stiffness = h * h * (couplings.stiffness[i, j - first] + (slope if i == j else 0.0))
        damping = h * h * couplings.damping[i, j - first]
        for z in range(len(out)):
            out[z] += stiffness * work.B[j, z] + damping * work.B_rate[j, z]
