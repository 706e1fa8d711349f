"""Points and lines of Campbell diagrams: the modes of each spin, and which belong together."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from .modes import Complex

# of a frequency in space over that of the spin; gyroscopic moments of a thin disk make it two
MAX_CHANGE_PER_SPIN = 4.0
FORWARD, BACKWARD, NONE, MIXED = "forward", "backward", "none", "mixed"
# of a mode from spin to spin: 0 for the same shape and frequency, 2 for neither
MAX_LINE_COST = 1.2


class Point(NamedTuple):
    """Whirl, frequency [Hz] and damping ratio of a mode, and its shape in unit inertia (n,)."""

    whirl: str
    frequency: float
    ratio: float
    shape: Complex


@dataclass(frozen=True)
class Line:
    """A line of a Campbell diagram.

    whirl: "forward", "backward" or "none", on bearings also "mixed" where its sense changes with
    the spin; frequencies (n,) in space [Hz], or those that the mechanism sees where it does not
    whirl; ratios (n,): of damping; NaN where the line has ended.
    """

    whirl: str
    frequencies: Array
    ratios: Array


def whirling_alike(points: Sequence[Point], whirling: Sequence[Point], spin: float) -> list[Point]:
    """Points at rest with the whirl of those nearest to them at a small spin.

    A mode at rest in one of two unequal planes is half forward, half backward; its line goes on
    with one of them.
    """
    from scipy.optimize import linear_sum_assignment

    near = MAX_CHANGE_PER_SPIN * spin / (2.0 * np.pi)
    at_rest = [k for k, point in enumerate(points) if point.whirl != NONE]
    others = [point for point in whirling if point.whirl != NONE]
    apart = np.abs(
        np.subtract.outer(
            [points[k].frequency for k in at_rest], [point.frequency for point in others]
        )
    )
    found = list(points)
    for row, column in zip(*linear_sum_assignment(np.minimum(apart, near)), strict=True):
        if apart[row, column] < near:
            k = at_rest[row]
            found[k] = points[k]._replace(whirl=others[column].whirl)
    return found


def lines_by_whirl(points: Sequence[Sequence[Point]], n: int) -> Iterator[Line]:
    """Lines of the modes of each kind of whirl, by their order."""
    found = []
    for whirl in (FORWARD, BACKWARD, NONE):
        sets = [[p for p in spin if p.whirl == whirl] for spin in points]
        for k in range(max(map(len, sets))):
            rows = [one[k][1:3] if k < len(one) else (np.nan, np.nan) for one in sets]
            frequencies, ratios = np.array(rows).T
            found.append(Line(whirl, frequencies, ratios))
    found.sort(key=lambda line: float(np.nanmin(line.frequencies)))
    yield from found


def followed_lines(spins: Array, points: Sequence[Sequence[Point]], n: int) -> list[Line]:
    """The n lowest lines of modes, which are followed by their shapes from spin to spin."""
    lines = [{0: point} for point in points[0]]
    for k in range(1, len(points)):
        near = MAX_CHANGE_PER_SPIN * float(spins[k] - spins[k - 1]) / (2.0 * np.pi)
        going = [line for line in lines if k - 1 in line]
        taken = _continued([line[k - 1] for line in going], points[k], near)
        for line, place in zip(going, taken, strict=True):
            if place is not None:
                line[k] = points[k][place]
        lines += [{k: point} for i, point in enumerate(points[k]) if i not in taken]
    lines.sort(key=lambda line: min(point.frequency for point in line.values()))
    return [_line(line, len(spins)) for line in lines[:n]]


def _continued(before: Sequence[Point], after: Sequence[Point], near: float) -> list[int | None]:
    """The places among the points of a spin at which those of the spin before go on.

    near [Hz]: how far a frequency may move. Shapes count by the square of their correlation.
    """
    from scipy.optimize import linear_sum_assignment

    cost = np.empty((len(before), len(after)))
    for i, one in enumerate(before):
        for j, other in enumerate(after):
            product = abs(np.vdot(one.shape, other.shape)) ** 2
            alike = product / float(
                np.vdot(one.shape, one.shape).real * np.vdot(other.shape, other.shape).real
            )
            moved = abs(one.frequency - other.frequency) / near
            cost[i, j] = 1.0 - alike + min(moved, 1.0)
    taken: list[int | None] = [None] * len(before)
    for i, j in zip(*linear_sum_assignment(cost), strict=True):
        if cost[i, j] < MAX_LINE_COST:
            taken[int(i)] = int(j)
    return taken


def _line(points: Mapping[int, Point], n: int) -> Line:
    """A line of points by the number of their spin."""
    frequencies, ratios = np.full((2, n), np.nan)
    for k, point in points.items():
        frequencies[k], ratios[k] = point.frequency, point.ratio
    # At rest modes of unequal planes whirl neither way.
    whirls = {point.whirl for k, point in points.items() if k > 0 or len(points) == 1}
    return Line(whirls.pop() if len(whirls) == 1 else MIXED, frequencies, ratios)
