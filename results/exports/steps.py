"""The recorded steps that are written: those of a window of time, or some evenly among them."""

import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..errors import ExportError

ROUNDING = 1e-9
"""of times, in the length of the run"""


def window(time: Array, start: float | None = None, end: float | None = None) -> slice:
    """The steps of times (n,) from start to end, both within [s]; `ExportError` for none."""
    low = time[0] if start is None else start
    high = time[-1] if end is None else end
    rounding = ROUNDING * float(np.ptp(time))
    rows = np.flatnonzero((time >= low - rounding) & (time <= high + rounding))
    if not len(rows):
        raise ExportError(
            f"nothing was recorded from {low:.9g} to {high:.9g} s: expected times from "
            f"{time[0]:.9g} to {time[-1]:.9g} s"
        )
    return slice(int(rows[0]), int(rows[-1]) + 1)


def frames(time: Array, rows: slice, most: int) -> NDArray[np.int64]:
    """The numbers of at most so many of these steps, evenly over time, first and last with them."""
    first, last, _ = rows.indices(len(time))
    if last - first <= most:
        return np.arange(first, last)
    even = np.linspace(time[first], time[last - 1], most)
    after = np.searchsorted(time[first:last], even).clip(1, last - first - 1) + first
    nearer_before = even - time[after - 1] <= time[after] - even
    return np.unique(np.where(nearer_before, after - 1, after))
