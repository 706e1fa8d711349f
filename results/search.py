"""The extremes over time of the largest value of a field, found without all of its values.

The values are seminorms of modal coordinates, as an equivalent stress is: |sum_j c_j x_j| is at
most sum_j |c_j| |x_j|. So between two steps a and b, with d the distance of the modal coordinates
from the chord,

    F(n) <= max(F(a), F(b)) + sum_j |d_j(n)| b_j,   b_j = F of mode j alone,

where F is the largest value at any point: intervals that cannot reach the largest value found so
far are left out, the others are halved down to single steps. From below, F is bounded by its values
at the few points that were largest before. What is told of a step is always computed from all
points.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array, Index
from ..superelement import von_mises
from .steps import batches

# Values at points times steps in memory together.
SEARCH_BATCH_VALUES = 1_000_000
# Intervals are halved down to single steps, so this is a power of two.
FIRST_INTERVAL_STEPS = 64
# Modal coordinates of as many steps are in memory.
MODAL_BLOCK_STEPS = 64 * FIRST_INTERVAL_STEPS
LOW_BLOCK_STEPS = 16


@dataclass(frozen=True)
class Extremes:
    """The largest and the smallest over time of the largest value at any point.

    at_largest, at_smallest: numbers of steps; point: of the largest value.
    """

    largest: float
    at_largest: int
    point: int
    smallest: float
    at_smallest: int


class Field:
    """A field of a body as a function of modal coordinates x (k, m): lengths of shapes times x.

    shapes (p, c, m); length: of components (..., c), the equivalent stress or the Euclidean norm.
    """

    def __init__(self, shapes: Array, length: Callable[[Array], Array]) -> None:
        self._shapes, self._length = shapes, length
        self.n_points = len(shapes)

    def values(self, x: Array, points: Index | None = None) -> Array:
        """Its values (k, p) at all points, or at some."""
        shapes = self._shapes if points is None else self._shapes[points]
        p, c, m = shapes.shape
        return self._length((x @ shapes.reshape(p * c, m).T).reshape(len(x), p, c))

    def of_modes(self) -> Array:
        """The largest value (m,) of each mode."""
        found = np.zeros(self._shapes.shape[2])
        for part in batches(self.n_points, SEARCH_BATCH_VALUES // max(len(found), 1)):
            of_part = self._length(np.moveaxis(self._shapes[part], 2, 0))
            np.maximum(found, of_part.max(axis=1), out=found)
        return found


def euclidean(components: Array) -> Array:
    """Lengths (...) of vectors (..., 3)."""
    lengths: Array = np.sqrt(np.einsum("...i,...i->...", components, components))
    return lengths


# How a field is measured where its extremes are sought.
LENGTH_OF_FIELD: dict[str, Callable[[Array], Array]] = {
    "von_mises": von_mises,
    "displacement": euclidean,
}


def extremes(field: Field, blocks: Iterable[tuple[int, Array]]) -> Extremes:
    """The extremes of a field, whose modal coordinates (k, m) come with the number of their first
    step, in the order of time.
    """
    search = _Search(field)
    for first, x in blocks:
        search.take(first, x)
    return search.found


class _Search:
    def __init__(self, field: Field) -> None:
        self._field, self._of_modes = field, field.of_modes()
        self._hot: Index = np.zeros(0, dtype=np.int64)
        self.found = Extremes(-np.inf, 0, 0, np.inf, 0)

    def take(self, first: int, x: Array) -> None:
        """Take the steps from this number on, with these modal coordinates (k, m)."""
        known = np.full(len(x), np.nan)
        for rows in self._sought(x, known):
            self._evaluate(first, x, rows, known)
        self._seek_smallest(first, x, known)

    def _sought(self, x: Array, known: Array) -> Iterator[Index]:
        """Steps (k,) whose values are needed to be sure of the largest one."""
        ends = np.unique(np.append(np.arange(0, len(x), FIRST_INTERVAL_STEPS), len(x) - 1))
        yield ends
        a, b = ends[:-1], ends[1:]
        while len(a):
            inside = b - a > 1
            a, b = a[inside], b[inside]
            # F is convex in x: on the chord it is at most the larger end; off it, at most by what
            # each mode can add.
            reach = np.maximum(known[a], known[b]) + self._beyond_chord(x, a, b)
            # What cannot exceed the largest value that is known needs no look.
            a, b = a[reach > self.found.largest], b[reach > self.found.largest]
            middle = (a + b) // 2
            yield middle
            a, b = np.concatenate([a, middle]), np.concatenate([middle, b])

    def _beyond_chord(self, x: Array, a: Index, b: Index) -> Array:
        """How far (k,) F can be above its larger value at the ends of each interval."""
        beyond = np.zeros(len(a))
        for i, (low, high) in enumerate(zip(a.tolist(), b.tolist(), strict=True)):
            share = np.arange(1, high - low)[:, None] / (high - low)
            chord = x[low] + share * (x[high] - x[low])
            beyond[i] = (np.abs(x[low + 1 : high] - chord) @ self._of_modes).max()
        return beyond

    def _evaluate(self, first: int, x: Array, rows: Index, known: Array) -> None:
        """F at some steps, from all points."""
        for part in batches(len(rows), SEARCH_BATCH_VALUES // self._field.n_points):
            here = rows[part]
            values = self._field.values(x[here])
            points = values.argmax(axis=1)
            largest = values[np.arange(len(here)), points]
            known[here] = largest
            # A stress peaks at few points of a body, so these bound most steps from below.
            self._hot = np.union1d(self._hot, points)
            self._note(first + here, largest, points)

    def _note(self, steps: Index, largest: Array, points: Index) -> None:
        found = self.found
        high, low = int(largest.argmax()), int(largest.argmin())
        above, at, point = found.largest, found.at_largest, found.point
        below, when = found.smallest, found.at_smallest
        if largest[high] > above:
            above, at, point = float(largest[high]), int(steps[high]), int(points[high])
        if largest[low] < below or (largest[low] == below and steps[low] < when):
            below, when = float(largest[low]), int(steps[low])
        self.found = Extremes(above, at, point, below, when)

    def _seek_smallest(self, first: int, x: Array, known: Array) -> None:
        """Evaluate steps that may be below the smallest value, those with the lowest bounds first.

        A bound is the largest value at the points that were the largest at some step.
        """
        bounds = np.full(len(x), -np.inf)
        taken: Index = np.zeros(0, dtype=np.int64)
        while True:
            # Evaluations below can add points, by which the bounds rise.
            fresh = np.setdiff1d(self._hot, taken)
            taken = self._hot
            left = np.flatnonzero(np.isnan(known) & (bounds < self.found.smallest))
            if len(fresh) and len(left):
                bounds[left] = np.maximum(
                    bounds[left], self._field.values(x[left], fresh).max(axis=1)
                )
                left = left[bounds[left] < self.found.smallest]
            if not len(left):
                return
            lowest = left[np.argsort(bounds[left], kind="stable")[:LOW_BLOCK_STEPS]]
            self._evaluate(first, x, np.sort(lowest), known)
