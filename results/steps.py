"""Recorded steps: those of a window of time, some evenly among them, and all, a few at once."""

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array, Index
from .errors import ExportError

# Relative to the length of the run: times are sums of many steps.
RELATIVE_TIME_ROUNDING = 1e-9


def window(time: Array, start: float | None = None, end: float | None = None) -> slice:
    """The steps of times (n,) from start to end, both within [s]; `ExportError` for none."""
    low = time[0] if start is None else start
    high = time[-1] if end is None else end
    rows = np.flatnonzero(inside(time, low, high))
    if not len(rows):
        raise ExportError(
            f"nothing was recorded from {low:.9g} to {high:.9g} s: expected times from "
            f"{time[0]:.9g} to {time[-1]:.9g} s"
        )
    return slice(int(rows[0]), int(rows[-1]) + 1)


def inside(time: Array, start: float, end: float) -> NDArray[np.bool_]:
    """Which of the times (n,) are from start to end, both within but for rounding [s]."""
    rounding = RELATIVE_TIME_ROUNDING * float(np.ptp(time))
    found: NDArray[np.bool_] = (time >= start - rounding) & (time <= end + rounding)
    return found


def evenly(time: Array, rows: slice, most: int) -> Index:
    """The numbers of at most so many of these steps, evenly over time, first and last with them."""
    first, last, _ = rows.indices(len(time))
    if last - first <= most:
        return np.arange(first, last)
    even = np.linspace(time[first], time[last - 1], most)
    after = np.searchsorted(time[first:last], even).clip(1, last - first - 1) + first
    nearer_before = even - time[after - 1] <= time[after] - even
    return np.unique(np.where(nearer_before, after - 1, after))


def batches(n: int, at_once: int) -> tuple[slice, ...]:
    """n rows in slices of equal length, but for the last: at least one row at once."""
    length = max(at_once, 1)
    return tuple(slice(k, min(k + length, n)) for k in range(0, n, length))
