"""Derivatives of numbers of runs by the parameters of a search, by runs on both sides."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ..files.arrays import Array
from .errors import StudyError
from .search_axis import SearchAxis

Values = Mapping[str, float]


def central_differences(
    axes: Sequence[SearchAxis],
    values: Values,
    base: Array,
    numbers_at: Callable[[Sequence[Values]], Sequence[Array | str]],
    steps: Sequence[float],
) -> tuple[Array, Array]:
    """Derivatives (m, n) as the search counts parameters, and the largest change of each number.

    One-sided where the run on one side fails, or a bound is near. base (m,): the numbers at
    values; numbers_at: those of several points, or why one has none; steps (n,): over the scales
    of the parameters. `StudyError` where there is a run on neither side.
    """
    ends = [axis.ends(values[axis.name], step) for axis, step in zip(axes, steps, strict=True)]
    points = [
        {**values, axis.name: end} for axis, both in zip(axes, ends, strict=True) for end in both
    ]
    found = numbers_at(points)
    slopes, changes = np.empty((len(base), len(axes))), np.empty((len(base), len(axes)))
    for i, (axis, (high, low)) in enumerate(zip(axes, ends, strict=True)):
        at, ahead, back = values[axis.name], found[2 * i], found[2 * i + 1]
        if isinstance(ahead, str):
            if isinstance(back, str):
                raise StudyError(f"the model does not run beside {axis.name} = {at:.9g}: {ahead}")
            high, ahead = at, base
        elif isinstance(back, str):
            low, back = at, base
        slopes[:, i] = (ahead - back) / (high - low) * axis.slope(at)
        changes[:, i] = np.maximum(np.abs(ahead - base), np.abs(back - base))
    return slopes, changes
