"""Linear complementarity problems of contacts: y = q + W lambda,  0 <= lambda  _|_  y >= 0.

W is symmetric and positive definite. Whole sets change sides at once (primal-dual active sets),
which ends within two or three iterations from the set of the last step; where the number of
violations no longer falls, one row changes sides at a time, the last of those that violate, which
ends for every such matrix. Rows that move alike, as those of two surfaces at their common border,
leave W singular, and share their force. Source: J. J. Judice, F. M. Pires: A block principal
pivoting algorithm for large-scale strictly monotone linear complementarity problems (1994).
"""

import math

from ..arrays import Array, Index
from ..compiler.marks import compiled
from .vectors import inner

NEGLIGIBLE_VIOLATION = 1e-13
"""violation, over the largest force, or gap without forces, that counts as none"""
MIN_PIVOT = 1e-12
"""pivot of a row, over its own compliance, below which others move it alike"""
PATIENT_ITERATIONS = 10
"""iterations without fewer violations before rows change sides one at a time"""
MAX_CHANGES = 10000
"""iterations after which the problem counts as unsolvable, as with entries that are no numbers"""


@compiled
def solve_complementarity(
    n: int,
    W: Array,
    q: Array,
    held: bool,
    active: Index,
    factored: Index,
    factor: Array,
    order: Index,
    lam: Array,
    y: Array,
) -> int:
    """Forces lam and gaps y of n rows; the number of closed rows, -1 where there is no solution.

    active (n,): 1 for the rows that are closed, a guess at first, unless `held`: then they stay so,
    and pull where they must. order: the closed rows, in the order of `factor`, Cholesky's factor of
    their part of W; factored (n,): 1 for the rows that it has, -1 first where there is none yet.
    """
    fewest, patience = n + 1, PATIENT_ITERATIONS
    for _ in range(MAX_CHANGES):
        count = _order_closed(n, active, order)
        # From iterate to iterate the closed rows mostly stay the same, and so does their factor.
        if not _is_factored(n, active, factored):
            if not _factorize(count, W, order, factor):
                # Half a factor is none, and must not serve the next call.
                factored[0] = -1
                return -1
            for i in range(n):
                factored[i] = active[i]
        _solve_closed(n, count, W, q, active, factor, order, lam, y)
        violations, last = _violations(n, q, active, lam, y)
        if held or violations == 0:
            return count
        # While violations fall, changes of whole sets cannot go in circles.
        if violations < fewest:
            fewest, patience = violations, PATIENT_ITERATIONS
        else:
            patience -= 1
        _change_sides(n, active, lam, y, last if patience < 0 else -1)
    return -1


@compiled
def _order_closed(n: int, active: Index, order: Index) -> int:
    """The closed rows, and their number."""
    count = 0
    for i in range(n):
        if active[i]:
            order[count] = i
            count += 1
    return count


@compiled
def _is_factored(n: int, active: Index, factored: Index) -> bool:
    changed = 0
    for i in range(n):
        changed += abs(factored[i] - active[i])
    return changed == 0


@compiled
def _solve_closed(
    n: int,
    count: int,
    W: Array,
    q: Array,
    active: Index,
    factor: Array,
    order: Index,
    lam: Array,
    y: Array,
) -> None:
    """lam = -W_aa^-1 q_a of the closed rows, and the gaps of all others."""
    for i in range(n):
        lam[i] = 0.0
    for a in range(count):
        y[a] = -q[order[a]]
    solve_closed(count, factor, y)
    for a in range(count):
        lam[order[a]] = y[a]
    for i in range(n):
        y[i] = 0.0 if active[i] else q[i] + inner(W[i, :n], lam[:n])


@compiled
def _factorize(count: int, W: Array, order: Index, factor: Array) -> bool:
    """factor = L with L L^T the closed part of W; False if that is not positive definite."""
    for a in range(count):
        for b in range(a + 1):
            rest = W[order[a], order[b]] - inner(factor[a, :b], factor[b, :b])
            if a == b:
                own = W[order[a], order[a]]
                if not own > 0.0 or math.isnan(rest):
                    return False
                factor[a, a] = math.sqrt(max(rest, MIN_PIVOT * own))
            else:
                factor[a, b] = rest / factor[b, b]
    return True


@compiled
def solve_closed(count: int, factor: Array, x: Array) -> None:
    """x <- W_aa^-1 x of the closed rows."""
    for a in range(count):
        x[a] = (x[a] - inner(factor[a, :a], x[:a])) / factor[a, a]
    for a in range(count - 1, -1, -1):
        x[a] /= factor[a, a]
        for b in range(a):
            x[b] -= factor[a, b] * x[a]


@compiled
def _violations(n: int, q: Array, active: Index, lam: Array, y: Array) -> tuple[int, int]:
    """The number of closed rows that pull and of open ones that penetrate, and the last of them."""
    force, gap = 0.0, 0.0
    for i in range(n):
        force, gap = max(force, abs(lam[i])), max(gap, abs(q[i]))
    # Relative to the largest: rows within rounding would change sides again and again.
    force, gap = NEGLIGIBLE_VIOLATION * force, NEGLIGIBLE_VIOLATION * gap
    count, last = 0, -1
    for i in range(n):
        right = lam[i] >= -force if active[i] else y[i] >= -gap
        if not right:  # also where it is not a number
            count, last = count + 1, i
    return count, last


@compiled
def _change_sides(n: int, active: Index, lam: Array, y: Array, only: int) -> None:
    """Close what penetrates and open what pulls, all of it or one row alone."""
    for i in range(n):
        if only < 0 or i == only:
            right = lam[i] >= 0.0 if active[i] else y[i] >= 0.0
            if not right:
                active[i] = 1 - active[i]
