"""When a field of bodies is largest."""

from collections.abc import Iterable
from functools import partial

import numpy as np

from ..results import QuantityError, Results
from ..results.peaks import largest_over_time
from ..results.steps import inside
from ..results.transforms import Window
from ..superelement.validation import Array


def worst_time(
    results: Results, bodies: Iterable[str], field: str, window: Window | None = None
) -> float:
    """The recorded time, of a window, at which a field is largest on any of the bodies [s]."""
    time = results.time
    if window is not None:
        time = time[inside(time, *window)]
    if not len(time):
        raise QuantityError(f"{field}: nothing was recorded within the times")
    largest: Array = np.zeros(len(time))
    for body in bodies:
        values = partial(results.outline_field, body, name=field)
        over_time, _ = largest_over_time(values, time, len(results.outline(body).points))
        largest = np.maximum(largest, over_time)
    return float(time[largest.argmax()])
