"""Groups of formats that know no groups, from integers on cells or points.

Where the array NAME has the value 7 is the group "NAME 7"; of an array of 0 and 1 alone, 1 is the
group NAME too. An array that numbers cells or points, all its values being different, makes no
groups.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..mesh import IntArray
from .draft import Draft

MAX_GROUP_VALUES = 1000  # distinct values beyond which an array makes no groups


def mark_values(
    draft: Draft, name: str, values: Any, mark: Callable[[str, IntArray], None]
) -> None:
    """The groups of an array with one integer for each cell or point."""
    if values.dtype.kind not in "iub" or values.size != len(values):
        return
    distinct, which = np.unique(values.ravel().astype(np.int64), return_inverse=True)
    # A numbering would make a group of each cell; two cells may well be two groups.
    if len(distinct) == len(values) > 2:
        return
    if len(distinct) > MAX_GROUP_VALUES:
        draft.lost.append(
            f"groups of the array {name!r}, which has {len(distinct)} values, more than "
            f"{MAX_GROUP_VALUES}"
        )
        return
    for number, value in enumerate(distinct.tolist()):
        mark(f"{name} {value}", np.flatnonzero(which == number))
    if set(distinct.tolist()) <= {0, 1}:
        mark(name, np.flatnonzero(values.ravel()))
