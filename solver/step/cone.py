"""Coulomb's law at rows of contacts with friction: y = q + W lambda, of gaps and slips.

A row with friction is three: its gap y_n, and its slips s along two tangents in the step.

    0 <= P  _|_  y_n >= 0,    |T| <= mu P,    T = -mu P s/|s| where it slips

as zeros of lambda - proj(lambda - r y), by a semismooth Newton's method. What sticks has s = 0
exactly. W is symmetric and positive definite. mu may fall with the rate of slip: it is held while
Newton's method runs, and taken from the slips that this finds until it no longer changes. Where
Newton's method goes in circles, as it may for large mu, sweeps of relaxation lead to another start.
Source: P. Alart, A. Curnier: A mixed formulation for frictional contact problems prone to Newton
like solution methods (1991).
"""

import math

from ..arrays import Array, Index
from ..compiler.marks import compiled
from ..compiler.parts import n_parts, part
from .lu import factorize_lu, substitute_lu
from .vectors import inner

OPEN, STICKS, SLIPS = 0, 1, 2
MAX_ITERATIONS = 60
"""iterations after which Newton's method starts again; a step takes two or three"""
MAX_STARTS, RELAXATION_SWEEPS = 6, 40
"""starts after which the law counts as unsolvable, and sweeps of relaxation before each but one"""
MAX_COEFFICIENTS = 300
"""how often coefficients follow the slips"""
SETTLED_COEFFICIENT = 1e-10
"""change of a coefficient, over its static one, that counts as none"""
SLOW_RATE = 0.1
"""residual over the one before from which on factors of an earlier law are made anew"""
MAX_HALVINGS = 4
"""how often a correction that does not help is halved"""
CONVERGED_RESIDUAL = 1e-12
"""residual over the largest force at which Newton's method has converged"""
SUFFICIENT_RESIDUAL = 1e-8
"""the same, which serves where it no longer falls"""


@compiled
def solve_cone(
    n: int,
    W: Array,
    q: Array,
    mu: Array,
    active: Index,
    A: Array,
    order: Index,
    pivots: Index,
    made: Index,
    lam: Array,
    y: Array,
    law: Array,
    trial: Array,
) -> int:
    """Forces lam, a guess at first, and gaps and slips y of n rows; the number of closed rows.

    -1 where there is no solution. mu (n, 3): static and sliding coefficient of each row and the
    slip in a step at which it falls; of a slip, the second row or the third, it is -1. active (n,):
    OPEN, STICKS or SLIPS. order: the rows that are not open. made (n,): `active` as factors in A
    and pivots were made, -1 where there are none. law (n, 6): see `_judge`.
    """
    for i in range(n):
        law[i, 2] = mu[i, 0]
    for _ in range(MAX_COEFFICIENTS):
        if not _find_forces(n, W, q, mu, active, A, order, pivots, made, lam, y, law, trial):
            return -1
        if not _follow_slips(n, mu, y, law):
            # Zero to the bit, where the last correction left rounding.
            for i in range(n):
                if not active[i]:
                    lam[i] = 0.0
            return order_rows(n, active, order)
    return -1


@compiled
def _follow_slips(n: int, mu: Array, y: Array, law: Array) -> bool:
    """Take the coefficients from the slips where these are less; whether any has changed."""
    changed = False
    for i in range(n - 2):
        # Constant ones need no second look, and a row without friction stands alone.
        if mu[i, 0] < 0.0 or mu[i, 0] == mu[i, 1] or mu[i + 1, 0] >= 0.0:
            continue
        slip = math.sqrt(y[i + 1] * y[i + 1] + y[i + 2] * y[i + 2])
        ratio = slip / mu[i, 2]
        friction = mu[i, 1] + (mu[i, 0] - mu[i, 1]) * math.exp(-ratio * ratio)
        # What only falls comes to rest, where rows that slip in turn would go back and forth.
        friction = min(friction, law[i, 2])
        if law[i, 2] - friction > SETTLED_COEFFICIENT * mu[i, 0]:
            changed = True
        law[i, 2] = friction
    return changed


@compiled
def _find_forces(
    n: int,
    W: Array,
    q: Array,
    mu: Array,
    active: Index,
    A: Array,
    order: Index,
    pivots: Index,
    made: Index,
    lam: Array,
    y: Array,
    law: Array,
    trial: Array,
) -> bool:
    """Forces for the coefficients at hand, from those at hand; False where none are found."""
    for start in range(MAX_STARTS):
        if start > 0:
            # Newton's method may have led anywhere.
            if start == 1:
                for i in range(n):
                    lam[i] = 0.0
            _relax(n, W, q, mu, lam, law)
        if _run_newton(n, W, q, mu, active, A, order, pivots, made, lam, y, law, trial):
            return True
    return False


@compiled
def _relax(n: int, W: Array, q: Array, mu: Array, lam: Array, law: Array) -> None:
    """Let each row by itself obey its law, in sweeps over all rows."""
    for _ in range(RELAXATION_SWEEPS):
        for i in range(n):
            if mu[i, 0] < 0.0:
                continue
            lam[i] = max(lam[i] - (q[i] + inner(W[i, :n], lam[:n])) / W[i, i], 0.0)
            if i + 2 >= n or mu[i + 1, 0] >= 0.0:
                continue
            r = min(1.0 / W[i + 1, i + 1], 1.0 / W[i + 2, i + 2])
            first = lam[i + 1] - r * (q[i + 1] + inner(W[i + 1, :n], lam[:n]))
            second = lam[i + 2] - r * (q[i + 2] + inner(W[i + 2, :n], lam[:n]))
            size, limit = math.sqrt(first * first + second * second), law[i, 2] * lam[i]
            share = limit / size if size > limit else 1.0
            lam[i + 1], lam[i + 2] = share * first, share * second


@compiled
def _run_newton(
    n: int,
    W: Array,
    q: Array,
    mu: Array,
    active: Index,
    A: Array,
    order: Index,
    pivots: Index,
    made: Index,
    lam: Array,
    y: Array,
    law: Array,
    trial: Array,
) -> bool:
    """The semismooth Newton's method from the forces at hand; False where it does not converge."""
    residual = _judge(n, W, q, mu, active, lam, y, law)
    slow = False
    for _ in range(MAX_ITERATIONS):
        largest = 0.0
        for i in range(n):
            largest = max(largest, abs(lam[i]))
        if residual <= CONVERGED_RESIDUAL * largest or residual == 0.0:
            break
        # Open rows are solved for at once, lambda = 0: only closed ones need the factors.
        count = order_rows(n, active, order)
        # Factors of the same rows serve as long as they lead on: making them is most of the work.
        kept = not slow and is_made(n, active, made)
        if not kept and not make_factors(n, count, W, active, law, order, pivots, A, made):
            return False
        _set_correction(n, count, W, active, law, A, order, pivots, y, trial)
        # At kinks of the law a whole correction may lead from one side to the other and back.
        before, share = residual, 1.0
        for i in range(n):
            lam[i] += trial[i]
        residual = _judge(n, W, q, mu, active, lam, y, law)
        for _halving in range(MAX_HALVINGS):
            if residual <= (1.0 - 0.1 * share) * before:
                break
            share *= 0.5
            for i in range(n):
                lam[i] -= share * trial[i]
            residual = _judge(n, W, q, mu, active, lam, y, law)
        # Where no part of it helps the whole is taken: a set of rows that changes leads on.
        if (
            not residual <= (1.0 - 0.1 * share) * before
            and residual > SUFFICIENT_RESIDUAL * largest
        ):
            for i in range(n):
                lam[i] += (1.0 - share) * trial[i]
            residual = _judge(n, W, q, mu, active, lam, y, law)
        slow = kept and not residual < SLOW_RATE * before
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(lam[i]))
    if not residual <= SUFFICIENT_RESIDUAL * largest:
        return False
    if n == 0 or n_parts(lam[0]) == 1:
        return True
    # Values end the iteration, also at once. With factors of the law as it is one more correction
    # of derivatives alone is exact.
    count = order_rows(n, active, order)
    if not make_factors(n, count, W, active, law, order, pivots, A, made):
        return False
    _set_correction(n, count, W, active, law, A, order, pivots, y, trial)
    for i in range(n):
        lam[i] += trial[i] - part(trial[i], 0)
    _judge(n, W, q, mu, active, lam, y, law)
    return True


@compiled
def _set_correction(
    n: int,
    count: int,
    W: Array,
    active: Index,
    law: Array,
    A: Array,
    order: Index,
    pivots: Index,
    y: Array,
    trial: Array,
) -> None:
    """trial: the correction of the forces by the factors at hand; y is scratch."""
    for i in range(n):
        trial[i] = 0.0 if active[i] else -law[i, 0]
    for a in range(count):
        i, total = order[a], -law[order[a], 0]
        for k in range(n):
            if not active[k] and trial[k] != 0.0:
                total -= _entry(W, active, law, i, k) * trial[k]
        y[a] = total
    substitute_lu(count, A, pivots, y)
    for a in range(count):
        trial[order[a]] = y[a]


@compiled
def order_rows(n: int, active: Index, order: Index) -> int:
    """The rows that are not open, and their number."""
    count = 0
    for i in range(n):
        if active[i]:
            order[count] = i
            count += 1
    return count


@compiled
def _judge(
    n: int, W: Array, q: Array, mu: Array, active: Index, lam: Array, y: Array, law: Array
) -> float:
    """Gaps, status and residuals; the largest residual.

    law: residual of a row, its r, of a gap mu, and of slips mu e, e, mu (P - r y_n) / |T - r s| and
    the row of their gap.
    """
    for i in range(n):
        y[i] = q[i] + inner(W[i, :n], lam[:n])
    largest = 0.0
    for i in range(n):
        # Slips follow with their gap, whose force is the radius of their disk.
        if mu[i, 0] < 0.0:
            continue
        # Any r > 0 has the same zeros; that of the row alone makes its own correction exact.
        law[i, 1] = 1.0 / W[i, i]
        push = lam[i] - law[i, 1] * y[i]
        active[i] = STICKS if push > 0.0 else OPEN
        law[i, 0] = lam[i] - max(push, 0.0)
        largest = max(largest, abs(law[i, 0]))
        # A row without friction stands alone.
        if i + 2 >= n or mu[i + 1, 0] >= 0.0:
            continue
        # One r for both tangents, or the projection on the disk would not be one.
        r = min(1.0 / W[i + 1, i + 1], 1.0 / W[i + 2, i + 2])
        first, second = lam[i + 1] - r * y[i + 1], lam[i + 2] - r * y[i + 2]
        size = math.sqrt(first * first + second * second)
        friction = law[i, 2]
        limit = friction * max(push, 0.0)
        status, ratio = active[i], 1.0
        if status == STICKS and size > limit:
            status, ratio = SLIPS, limit / size
        for k in range(i + 1, i + 3):
            active[k] = status
            tangential = first if k == i + 1 else second
            law[k, 1], law[k, 5] = r, i
            law[k, 3] = tangential / size if size > 0.0 else 0.0
            law[k, 2] = friction * law[k, 3]
            law[k, 4] = ratio
            law[k, 0] = lam[k] - (ratio * tangential if status else 0.0)
            largest = max(largest, abs(law[k, 0]))
            # Comparisons with what is not a number are false: it is passed on by hand.
            if math.isnan(law[k, 0]):
                largest = math.nan
        if math.isnan(law[i, 0]):
            largest = math.nan
    return largest


@compiled
def _entry(W: Array, active: Index, law: Array, i: int, k: int) -> float:
    """An entry of I - D (I - r W), D the derivative of the projection, in a row i not open."""
    # Where it sticks D is I, and I - (I - r W) = r W.
    if active[i] == STICKS:
        return float(law[i, 1] * W[i, k])
    one = 1.0 if i == k else 0.0
    return float(one - by_law(active, law, i, k, W[k], True))  # W is symmetric


@compiled
def by_law(active: Index, law: Array, i: int, k: int, x: Array, unit: bool) -> float:
    """Entry i of D (1_k - r x) of a slip that slips; without unit of -D r x, of any row."""
    if active[i] == STICKS:
        return float(-law[i, 1] * x[i])
    # the tangents of one row are neighbors, first and second by their normal row
    normal = int(law[i, 5])
    first = normal + 1
    along, push = 0.0, -law[normal, 1] * x[normal]
    own = -law[i, 1] * x[i]
    for t in range(first, first + 2):
        part = -law[t, 1] * x[t]
        if unit and t == k:
            part += 1.0
        along += law[t, 3] * part
    if unit and normal == k:
        push += 1.0
    if unit and i == k:
        own += 1.0
    return float(law[i, 2] * push + law[i, 4] * (own - law[i, 3] * along))


@compiled
def is_made(n: int, active: Index, made: Index) -> bool:
    """Whether the factors are those of rows of this status."""
    for i in range(n):  # noqa: SIM110 - compiled code has no generators
        if active[i] != made[i]:
            return False
    return True


@compiled
def make_factors(
    n: int,
    count: int,
    W: Array,
    active: Index,
    law: Array,
    order: Index,
    pivots: Index,
    A: Array,
    made: Index,
) -> bool:
    """Factors of the law as it is, with the status of its rows; False where it is singular."""
    for i in range(n):
        made[i] = active[i]
    if not _factorize_law(count, W, active, law, order, pivots, A):
        made[0] = -1
        return False
    return True


@compiled
def _factorize_law(
    count: int, W: Array, active: Index, law: Array, order: Index, pivots: Index, A: Array
) -> bool:
    """LU factors of the closed part of I - D (I - r W); False where it is singular."""
    for a in range(count):
        for b in range(count):
            A[a, b] = _entry(W, active, law, order[a], order[b])
    return bool(factorize_lu(count, A, pivots))
