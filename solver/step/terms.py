"""Terms of rows: coordinates of other pairs of frames that join the constraint of a row.

    phi = c + sum_t ratio_t c_t - s(t) = 0

So a row couples the coordinates of several joints, of as many bodies as they are between. The
wrench of a term on its frames is lambda ratio_t times its gradient; c is that of the row itself
(couplings.py), and c_t are rows of the same kinds.
"""

from ..arrays import Index
from ..compiler.marks import compiled
from .frames import (
    Pair,
    add_pair_tangent,
    add_wrench_scale,
    coordinate,
    pull_back_pair,
    pull_back_tangent,
    width,
)
from .records.couplings import Couplings
from .records.frames import Frames
from .records.matrix import Pattern
from .rows import add_row_tangent, evaluate_row, measures_length
from .system import State, System, Workspace
from .vectors import scale, triple


@compiled
def add_term_wrenches(couplings: Couplings, state: State, work: Workspace) -> None:
    """Coordinates and rates of all terms, in the residuals of their rows; wrenches on frames."""
    terms, out, frames = couplings.terms, work.terms, work.frames
    for t in range(len(terms.row)):
        i, gradient = terms.row[t], out.gradient[t]
        out.coordinate[t] = evaluate_row(terms.rows, t, 0.0, out.near[t], work, gradient)
        work.couplings.phi[i] += terms.ratio[t] * out.coordinate[t]
        f, g = terms.rows.frame_a[t], terms.rows.frame_b[t]
        # Virtual work: lambda acts on c + sum ratio_t c_t, so each term gets its share.
        force = state.couplings.lam[i] * terms.ratio[t]
        rate = 0.0
        for k in range(6):
            rate += gradient[k] * frames.V[f, k] + gradient[6 + k] * frames.V[g, k]
            frames.wrench[f, k] += force * gradient[k]
            frames.wrench[g, k] += force * gradient[6 + k]
        out.rate[t] = rate
        j = terms.own[t]
        if j >= 0:
            for k in range(6):
                work.couplings.wrench[j, k] += force * gradient[couplings.second[i] + k]


@compiled
def add_term_scales(system: System, state: State, work: Workspace) -> None:
    """The wrenches of all terms join the force scales of the bodies."""
    terms, gradient = system.couplings.terms, work.terms.gradient
    for t in range(len(terms.row)):
        force = state.couplings.lam[terms.row[t]] * terms.ratio[t]
        on_a = scale(force, triple(gradient[t], 0)), scale(force, triple(gradient[t], 3))
        on_b = scale(force, triple(gradient[t], 6)), scale(force, triple(gradient[t], 9))
        add_wrench_scale(system.frames, terms.rows.frame_a[t], on_a, state, work)
        add_wrench_scale(system.frames, terms.rows.frame_b[t], on_b, state, work)


@compiled
def linearize_terms(system: System, state: State, work: Workspace) -> None:
    """B of all terms, and K += the tangents of their wrenches at constant multipliers."""
    couplings, frames, pattern = system.couplings, system.frames, system.pattern
    terms, tangent = couplings.terms, work.couplings.tangent
    for t in range(len(terms.row)):
        pair = terms.rows.frame_a[t], terms.rows.frame_b[t]
        pull_back_pair(frames, pair, work.terms.gradient[t], state, work, work.terms.B[t])
        force = state.couplings.lam[terms.row[t]] * terms.ratio[t]
        tangent[:] = 0.0
        add_row_tangent(terms.rows, t, 0.0, force, work, tangent)
        pull_back_tangent(frames, pair, tangent, state, work)
        # A term may couple other bodies than its row: it has blocks of its own.
        add_tangent_of_pair(frames, pattern, pair, pattern.term_block[t], work)


@compiled
def add_tangent_of_pair(
    frames: Frames, pattern: Pattern, pair: Pair, blocks: Index, work: Workspace
) -> None:
    """K += `pair_tangent` in the blocks (A, B) and (B, A) between the bodies of two frames."""
    f, g = pair
    a, b = frames.body[f], frames.body[g]
    tangent = work.frames.pair_tangent
    if a >= 0:
        add_pair_tangent(frames, (f, f), tangent, (0, 0), pattern.body_block[a], work)
    if b >= 0:
        add_pair_tangent(frames, (g, g), tangent, (12, 12), pattern.body_block[b], work)
    if a >= 0 and b >= 0:
        add_pair_tangent(frames, (f, g), tangent, (0, 12), blocks[0], work)
        add_pair_tangent(frames, (g, f), tangent, (12, 0), blocks[1], work)


@compiled
def assemble_terms(system: System, work: Workspace) -> None:
    """ratio B^T / h^2 into the rows of bodies, ratio B into those of couplings."""
    terms, frames, S = system.couplings.terms, system.frames, work.matrix.S
    h2 = system.scheme.h * system.scheme.h
    for t in range(len(terms.row)):
        blocks, number, ratio = system.pattern.term_block[t], terms.number[t], terms.ratio[t]
        for side in range(2):
            f = terms.rows.frame_a[t] if side == 0 else terms.rows.frame_b[t]
            above, stride = blocks[2 + 2 * side, 0] + number, blocks[2 + 2 * side, 1]
            beside = blocks[3 + 2 * side, 0] + number * blocks[3 + 2 * side, 1]
            for k in range(width(frames, f)):
                z = coordinate(frames, f, k)
                value = ratio * work.terms.B[t, 12 * side + k]
                S[above + z * stride] += value / h2
                S[beside + z] += value


@compiled
def term_scale(
    couplings: Couplings, i: int, motion: tuple[float, float], reach: float, work: Workspace
) -> tuple[float, float]:
    """Motion of the terms of row i in a step, of lengths and of angles, and their magnitudes."""
    terms, length, angle = couplings.terms, motion[0], motion[1]
    moved, size = 0.0, 0.0
    for t in range(terms.range[i], terms.range[i + 1]):
        ratio = abs(terms.ratio[t])
        is_length = measures_length(terms.rows.kind[t])
        moved += ratio * (length if is_length else angle)
        size += ratio * (reach if is_length else 1.0 + abs(work.terms.coordinate[t]))
    return moved, size


@compiled
def add_convective_terms(couplings: Couplings, work: Workspace) -> None:
    """The second derivatives of all terms where no body accelerates (`set_convective`)."""
    terms, frames, H = couplings.terms, work.frames, work.couplings.rate_tangent
    for t in range(len(terms.row)):
        f, g = terms.rows.frame_a[t], terms.rows.frame_b[t]
        H[:] = 0.0
        add_row_tangent(terms.rows, t, 0.0, 1.0, work, H)
        total = 0.0
        for k in range(12):
            V_k = frames.V[f, k] if k < 6 else frames.V[g, k - 6]
            A_k = frames.A[f, k] if k < 6 else frames.A[g, k - 6]
            total += work.terms.gradient[t, k] * A_k
            for m in range(6):
                total += V_k * (H[k, m] * frames.V[f, m] + H[k, 6 + m] * frames.V[g, m])
        work.couplings.convective[terms.row[t]] += terms.ratio[t] * total


@compiled
def expect_terms(h: float, state: State, work: Workspace) -> None:
    """The coordinates at the end of a step by their rates, to which angles are then the nearest."""
    for t in range(len(work.terms.near)):
        work.terms.near[t] = state.terms.coordinate[t] + h * state.terms.rate[t]


@compiled
def keep_terms(state: State, work: Workspace) -> None:
    """The coordinates and rates at the end of a step, or at the start."""
    for t in range(len(work.terms.near)):
        state.terms.coordinate[t] = work.terms.coordinate[t]
        state.terms.rate[t] = work.terms.rate[t]
