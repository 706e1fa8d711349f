"""Friction on rows of a coupling: a bristle that bends, and slips where it cannot hold.

With the normal force N, the change dc of the coordinate in the step, its rate w at the end and the
deflection s of the bristle at the start, both of one or two rows, the force of the bristle is
f = stiffness s+ + damping (s+ - s) / h:

    f* = stiffness s + (stiffness + damping / h) dc
    |f*| <= mu_h N:   f = f*,                   s+ = s + dc       sticks
    else:             f = mu N e, e = f*/|f*|,  s+ by the same    slips

    mu = sliding + (static - sliding) exp(-(|w| / speed)^2)
    mu_h = mu if it slipped at the start of the step, else static

What sticks moves by its bristle alone: its rate w is no speed of slip, and does not lower what it
takes to break away. What slips goes on by its rate, in which the bristle has no part worth naming.
And phi = lambda + f + viscous w. What sticks does not creep, and what slips takes f (f* - f) /
(stiffness + damping / h) >= 0. Source: docs/theory.md, Contact.
"""

import math

from ..arrays import Array
from ..compiler.marks import compiled
from .measure import SUM_ROUNDING
from .records.couplings import Couplings
from .rows import measures_length, slips
from .system import State, Workspace

STICKS, SLIPS = 1, 2
MAX_NORMAL_GROUPS = 3
"""number of groups of rows in a normal force, as solver/couplings/joint.py makes them"""

Bristle = tuple[float, float, float, float, float]
"""normal force, |f*|, mu_h N, mu N and its derivative by |w|"""


@compiled
def _root(square: float) -> float:
    # of a constant zero LLVM would make a call of sqrtf, which is not linked
    return math.sqrt(square) if square > 0.0 else 0.0


@compiled
def keep_status(couplings: Couplings, work: Workspace) -> None:
    """Whether friction sticks or slips at the start of a step."""
    for w in range(len(couplings.switching)):
        j = couplings.switching[w]
        work.couplings.status_n[j] = work.couplings.status[j]


@compiled
def set_normal_force(
    couplings: Couplings, first: int, r: int, lam: Array, work: Workspace
) -> float:
    """N of friction r on a coupling whose rows begin at `first`, and its derivatives."""
    friction, slope = couplings.friction, work.couplings.normal_slope
    end = friction.first[r]
    total = friction.preload[r]
    for group in range(MAX_NORMAL_GROUPS):
        squares = 0.0
        for i in range(first, end):
            if friction.group[i] == group:
                part = friction.weight[i] * lam[i]
                squares += part * part
        N = _root(squares)
        total += N
        for i in range(first, end):
            if friction.group[i] == group:
                part = friction.weight[i] * lam[i]
                slope[i] = friction.weight[i] * part / N if N > 0.0 else 0.0
    return float(total)


@compiled
def trial_force(couplings: Couplings, r: int, i: int, state: State, work: Workspace) -> float:
    """f* of row i."""
    friction, out = couplings.friction, work.couplings
    change = out.coordinate[i] - state.couplings.coordinate[i]
    elastic = friction.stiffness[r] * state.couplings.bristle[i]
    return float(elastic + _steepness(couplings, r, work) * change)


@compiled
def _acts(work: Workspace) -> bool:
    """Friction resists what moves in a step: at the start, and in a step without end, is none."""
    elapsed: float = work.couplings.elapsed[0]
    return 0.0 < elapsed < math.inf


@compiled
def _steepness(couplings: Couplings, r: int, work: Workspace) -> float:
    """stiffness + damping / h"""
    friction = couplings.friction
    return float(friction.stiffness[r] + friction.damping[r] / work.couplings.elapsed[0])


@compiled
def _speed(couplings: Couplings, r: int, work: Workspace) -> float:
    friction, squares = couplings.friction, 0.0
    for i in range(friction.first[r], friction.first[r] + friction.n[r]):
        squares += work.couplings.rate[i] * work.couplings.rate[i]
    return _root(squares)


@compiled
def bristle_of(couplings: Couplings, j: int, first: int, state: State, work: Workspace) -> Bristle:
    """The bristle of coupling j, whose rows begin at `first`."""
    friction, r = couplings.friction, couplings.friction_of[j]
    N = set_normal_force(couplings, first, r, state.couplings.lam, work)
    squares = 0.0
    for i in range(friction.first[r], friction.first[r] + friction.n[r]):
        force = trial_force(couplings, r, i, state, work)
        squares += force * force
    speed, limit = _speed(couplings, r, work), friction.speed[r]
    excess = 0.0
    if friction.static[r] > friction.sliding[r]:
        excess = (friction.static[r] - friction.sliding[r]) * math.exp(
            -(speed / limit) * (speed / limit)
        )
    mu = friction.sliding[r] + excess
    slope = -2.0 * excess * speed / (limit * limit) * N if excess > 0.0 else 0.0
    hold = mu if work.couplings.status_n[j] == SLIPS else friction.static[r]
    return N, _root(squares), hold * N, mu * N, slope


@compiled
def set_friction_residual(
    couplings: Couplings, j: int, first: int, state: State, work: Workspace
) -> None:
    """phi and scale of the rows with friction of coupling j, and whether it sticks."""
    friction, r, out = couplings.friction, couplings.friction_of[j], work.couplings
    end = friction.first[r] + friction.n[r]
    if not _acts(work):
        for i in range(friction.first[r], end):
            out.phi[i] = state.couplings.lam[i]
            out.scale[i] = abs(out.phi[i])
        return
    _, size, hold, limit, _ = bristle_of(couplings, j, first, state, work)
    sticks = size < hold or out.holds[0] == 1
    out.status[j] = STICKS if sticks else SLIPS
    # The bound only avoids 0 / 0: a bristle without force does not slip.
    share = 1.0 if sticks else limit / max(size, 1e-300)
    for i in range(friction.first[r], end):
        force = share * trial_force(couplings, r, i, state, work)
        viscous = friction.viscous[r] * out.rate[i]
        out.phi[i] = state.couplings.lam[i] + force + viscous
        out.scale[i] = abs(state.couplings.lam[i]) + abs(force) + abs(viscous)


@compiled
def set_friction_derivative(
    couplings: Couplings, j: int, first: int, h: float, state: State, work: Workspace
) -> None:
    """A and Z of the rows with friction of coupling j; the force has

    df = share (1 - e e^T) (stiffness + damping / h) dc + e (mu dN + N mu' d|w|) + viscous dw

    with e = 0 and share = 1 where it sticks.
    """
    friction, r, out = couplings.friction, couplings.friction_of[j], work.couplings
    begin, n = friction.first[r], friction.n[r]
    if not _acts(work):
        for i in range(begin, begin + n):
            out.A[i, :] = 0.0
            out.Z[i, :] = 0.0
        return
    N, size, _, limit, slope = bristle_of(couplings, j, first, state, work)
    slides = out.status[j] == SLIPS
    share = limit / max(size, 1e-300) if slides else 1.0
    speed = _speed(couplings, r, work)
    mu = limit / N if N > 0.0 else friction.static[r]
    for i in range(begin, begin + n):
        out.A[i, :] = 0.0
        e_i = trial_force(couplings, r, i, state, work) / max(size, 1e-300) if slides else 0.0
        for k in range(first, begin):
            out.Z[i, k - first] = mu * e_i * out.normal_slope[k]
        for k in range(begin, begin + n):
            e_k = trial_force(couplings, r, k, state, work) / max(size, 1e-300) if slides else 0.0
            same = 1.0 if i == k else 0.0
            factor = share * (same - e_i * e_k)
            by_rate = same * friction.viscous[r]
            if slides and speed > 0.0:
                by_rate += e_i * slope * out.rate[k] / speed
            by_change = factor * _steepness(couplings, r, work)
            # The coordinate of slip is the integral of its rate: its change is h/2 times that of
            # the rate.
            if slips(couplings.rows.kind[k]):
                by_rate += 0.5 * h * by_change
                by_change = 0.0
            for z in range(24):
                out.A[i, z] += h * h * (by_change * out.B[k, z] + by_rate * out.B_rate[k, z])


@compiled
def bend_bristle(couplings: Couplings, j: int, first: int, state: State, work: Workspace) -> None:
    """The bristle of coupling j at the end of a step."""
    friction, r, out = couplings.friction, couplings.friction_of[j], work.couplings
    # An open contact forgets its bristle: the next one starts unbent.
    holds = couplings.contact_of[j] < 0 or out.status[j] > 0
    _, size, _, limit, _ = bristle_of(couplings, j, first, state, work)
    share = limit / max(size, 1e-300) if out.status[j] == SLIPS else 1.0
    for i in range(friction.first[r], friction.first[r] + friction.n[r]):
        force = share * trial_force(couplings, r, i, state, work)
        bristle = state.couplings.bristle[i]
        # From the force, not from the motion: a bristle that slips keeps the bend that its force
        # holds.
        bend = (force - friction.stiffness[r] * bristle) / _steepness(couplings, r, work)
        state.couplings.bristle[i] = bristle + bend if holds else 0.0


@compiled
def friction_rounding(couplings: Couplings, j: int, i: int, reach: float, work: Workspace) -> float:
    """Change of the bristle's force in row i of coupling j by the rounding of positions."""
    r = couplings.friction_of[j]
    if r < 0 or i < couplings.friction.first[r] or not _acts(work):
        return 0.0
    kind = couplings.rows.kind[i]
    length = slips(kind) or measures_length(kind)
    size = reach if length else max(1.0, abs(work.couplings.coordinate[i]))
    return float(SUM_ROUNDING * _steepness(couplings, r, work) * size)


@compiled
def bristle_energy(couplings: Couplings, r: int, state: State) -> float:
    friction, total = couplings.friction, 0.0
    for i in range(friction.first[r], friction.first[r] + friction.n[r]):
        bristle = state.couplings.bristle[i]
        total += 0.5 * friction.stiffness[r] * bristle * bristle
    return total
