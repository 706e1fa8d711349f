"""Rows of a Jacobian that depend on one another, found by eliminating body by body.

An orthogonal transformation of the rows that meet a body leaves the columns of that body in as many
rows as they have rank, which no dependence can involve, since the columns occur nowhere else. The
others go on to the bodies beside it, and those that are left without any column are dependences:

    Q^T [ J_b  J_rest ] = [ J_1  * ]        y^T J = 0  only if  y = Q [ 0  y_2 ]
                          [ 0  J_2 ]

So the cost of trees and of chains of loops grows with the number of bodies, where that of singular
values of J grows with its cube. Singular values decide the ranks of the small blocks. Source: T. A.
Davis: Direct Methods for Sparse Linear Systems (2006), multifrontal QR factorization.
"""

import heapq
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Index, distinct
from ..step.system import System
from .matrices import Matrix, dense_of, factorize_square, unit_rows

# Rounding gives null vectors small entries at rows that take no part.
MIN_SHARE_IN_DEPENDENCE = 1e-6
# Shares of equal rows differ by rounding. This is more, so that what is left out does not depend on
# the machine.
LATER_ROW_PREFERENCE = 1e-3


def owners_of_columns(system: System, J: Matrix) -> Index:
    """The body of each column: of those of (x, Theta), and of active dofs where J has them."""
    rigid = np.repeat(np.arange(len(system.bodies.mass)), 6)
    elastic = np.repeat(system.elastic.body, np.diff(system.elastic.active_range))
    owners: Index = np.concatenate([rigid, elastic])[: J.shape[1]]
    return owners


def dependences(J: Matrix, owners: Index, tolerance: float) -> Array:
    """Orthonormal vectors y (n, k) with y^T J = 0: k is the number of rows less their rank.

    J (n, m): with rows of unit length or zero; owners (m,): the bodies that columns belong to;
    tolerance: singular values that count as zero.
    """
    n = J.shape[0]
    elimination = _Elimination(owners, tolerance)
    elimination.run(J, [(i, 1.0) for i in range(n)])
    found = [(front.places, front.carried) for front in elimination.dependent]
    null = np.zeros((n, sum(len(vectors) for _, vectors in found)))
    first = 0
    for places, vectors in found:
        null[places, first : first + len(vectors)] = vectors.T
        first += len(vectors)
    return null


def rows_to_leave_out(null: Array) -> list[int]:
    """The rows to leave out so that the others are independent, one for each dependence (n, k).

    Of equal choices the later ones.
    """
    from scipy.linalg import qr

    # Pivoting takes the largest row first, which is then left out.
    later = 1.0 + LATER_ROW_PREFERENCE * np.arange(len(null)) / len(null)
    _, _, pivots = qr(null.T * later, pivoting=True, mode="economic")
    return sorted(pivots[: null.shape[1]].tolist())


def least_solution(A: Matrix, b: Array, owners: Index, tolerance: float) -> Array:
    """The least of all x (m,) for which |A x - b| is least, A^+ b.

    A (n, m): rows of unit length, which may depend on one another; owners, tolerance: see
    `dependences`. In a large matrix the rows J_1 of the elimination, which are independent,
    determine x, with b transformed as they are.
    """
    if not isinstance(A, np.ndarray):
        elimination = _Elimination(owners, tolerance)
        elimination.run(A, [(0, value) for value in b.tolist()])
        R, transformed = elimination.independent_rows()
        R, scale = unit_rows(R)
        if (solve := factorize_square(R)) is not None:
            x: Array = R.T @ solve(scale * transformed)
            return x
    return np.linalg.lstsq(dense_of(A), b, rcond=tolerance)[0].astype(np.float64, copy=False)


@dataclass(frozen=True, eq=False)
class _Front:
    """Rows that are left of an elimination: their entries by body, and what goes with them."""

    entries: dict[int, Array]
    """(m, columns of the body)"""
    places: Index
    """(p,) ascending: the columns of what goes with them that are not zero"""
    carried: Array
    """(m, p)"""

    def turned(self, rows: Array, bodies: Iterable[int]) -> "_Front":
        """Combinations of the rows (k, m), with the entries of some of the bodies."""
        entries = {body: rows @ self.entries[body] for body in bodies}
        return _Front(entries, self.places, rows @ self.carried)


class _Elimination:
    """The rows of a matrix, as they are spread over the bodies that are left.

    owners (m,): the bodies that columns belong to; tolerance: of ranks.
    """

    def __init__(self, owners: Index, tolerance: float) -> None:
        self.tolerance = tolerance
        self.columns = columns_by_owner(owners)
        self.fronts: dict[int, _Front] = {}
        self.of_body: dict[int, set[int]] = {}
        self.n_fronts = 0
        self.independent: list[_Front] = []
        self.dependent: list[_Front] = []

    def run(self, J: Matrix, carried: list[tuple[int, float]]) -> None:
        """Eliminate all bodies; carried: what goes with each row, its place and value."""
        for front in self._rows_of(J, carried):
            self._add(front)
        heap = [(self._degree(body), body) for body in self.of_body]
        heapq.heapify(heap)
        while heap:
            degree, body = heapq.heappop(heap)
            # heapq cannot change the priority of an entry: stale ones are passed over.
            if degree != self._degree(body):  # known by a later entry, or eliminated
                continue
            for other in sorted(self._eliminate(body)):
                heapq.heappush(heap, (self._degree(other), other))

    def independent_rows(self) -> tuple[Matrix, Array]:
        """The transformed rows that are independent, and the one number that goes with each."""
        from scipy.sparse import coo_array

        values, rows, columns, first = [np.zeros(0)], [np.zeros(0, int)], [np.zeros(0, int)], 0
        for front in self.independent:
            m = len(front.carried)
            for body, block in front.entries.items():
                values.append(block.ravel())
                rows.append(np.repeat(first + np.arange(m), block.shape[1]))
                columns.append(np.tile(self.columns[body], m))
            first += m
        places = np.concatenate(rows), np.concatenate(columns)
        shape = first, sum(map(len, self.columns.values()))
        R = coo_array((np.concatenate(values), places), shape=shape).tocsr()
        return R, np.concatenate(
            [np.zeros(0), *(front.carried[:, 0] for front in self.independent)]
        )

    def _add(self, front: _Front) -> None:
        if not front.entries:
            self.dependent.append(front)
            return
        self.fronts[self.n_fronts] = front
        for body in front.entries:
            self.of_body.setdefault(body, set()).add(self.n_fronts)
        self.n_fronts += 1

    def _degree(self, body: int) -> int:
        """How many bodies share a row with this one; -1 where it is eliminated."""
        if body not in self.of_body:
            return -1
        return len(set().union(*(self.fronts[k].entries for k in self.of_body[body])))

    def _eliminate(self, body: int) -> set[int]:
        """Take the rows of a body; returns the bodies beside it, which share what is left."""
        numbers = self.of_body.pop(body)
        if not numbers:
            return set()
        merged = _merge([self.fronts.pop(k) for k in sorted(numbers)])
        beside = merged.entries.keys() - {body}
        for other in beside:
            self.of_body[other] -= numbers
        turn, rank = self._ranked(merged.entries[body])
        self.independent.append(merged.turned(turn[:rank], merged.entries))
        left = merged.turned(turn[rank:], sorted(beside))
        if beside and len(left.carried):
            # What depends already here need not be carried on to the root.
            turn, rank = self._ranked(np.hstack(list(left.entries.values())))
            self.dependent.append(left.turned(turn[rank:], ()))
            left = left.turned(turn[:rank], left.entries)
        if len(left.carried):
            self._add(left)
        return beside

    def _ranked(self, block: Array) -> tuple[Array, int]:
        """An orthogonal matrix, by which a block keeps as many rows as its rank, and the rank."""
        # Singular values are reliable ranks; blocks are as small as a body's neighborhood.
        left, values, _ = np.linalg.svd(block)
        return left.T, int(np.count_nonzero(values > self.tolerance))

    def _rows_of(self, J: Matrix, carried: list[tuple[int, float]]) -> Iterator[_Front]:
        """One front for each row."""
        place = {int(c): k for columns in self.columns.values() for k, c in enumerate(columns)}
        owner = {int(c): body for body, columns in self.columns.items() for c in columns}
        entries: list[dict[int, Array]] = [{} for _ in carried]
        for i, column, value in zip(*triplets(J), strict=True):
            body = owner[column]
            if body not in entries[i]:
                entries[i][body] = np.zeros((1, len(self.columns[body])))
            entries[i][body][0, place[column]] += value
        for row, (where, value) in zip(entries, carried, strict=True):
            yield _Front(row, np.array([where]), np.array([[value]]))


def _merge(fronts: list[_Front]) -> _Front:
    """One front with the rows of all of them."""
    sizes = [len(front.carried) for front in fronts]
    places = distinct(np.concatenate([front.places for front in fronts]))
    carried = np.zeros((sum(sizes), len(places)))
    entries: dict[int, Array] = {}
    first = 0
    for front, m in zip(fronts, sizes, strict=True):
        rows = slice(first, first + m)
        carried[rows, np.searchsorted(places, front.places)] = front.carried
        for body, block in front.entries.items():
            if body not in entries:
                entries[body] = np.zeros((sum(sizes), block.shape[1]))
            entries[body][rows] = block
        first += m
    return _Front(entries, places, carried)


def columns_by_owner(owners: Index) -> dict[int, Index]:
    """The columns (k,) that belong to each body."""
    order = np.argsort(owners, kind="stable")
    bodies, first = np.unique(owners[order], return_index=True)
    return dict(zip(bodies.tolist(), np.split(order, first[1:]), strict=True))


def triplets(J: Matrix) -> tuple[list[int], list[int], list[float]]:
    """Rows, columns and values of the entries of a matrix."""
    if isinstance(J, np.ndarray):
        rows, columns = np.nonzero(J)
        values = J[rows, columns]
    else:
        entries = J.tocoo()
        rows, columns, values = entries.row, entries.col, entries.data
    return rows.tolist(), columns.tolist(), values.tolist()
