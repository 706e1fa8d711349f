"""When a field of bodies is largest."""

from collections.abc import Iterable
from functools import partial

import numpy as np

from ..results import QuantityError, Results
from ..results.peaks import largest_over_time
from ..results.steps import inside
from ..results.transforms import Window


def worst_time(
    results: Results, bodies: Iterable[str], field: str, window: Window | None = None
) -> float:
    """The recorded time, of a window, at which a field is largest on any of the bodies [s]."""
    time = results.time
    rows = np.arange(len(time)) if window is None else np.flatnonzero(inside(time, *window))
    if not len(rows):
        raise QuantityError(f"{field}: nothing was recorded within the times")
    found = [_worst(results, body, field, slice(rows[0], rows[-1] + 1)) for body in bodies]
    return float(time[max(found, default=(0.0, rows[0]), key=lambda worst: worst[0])[1]])


def _worst(results: Results, body: str, field: str, rows: slice) -> tuple[float, int]:
    """The largest value of a field on a body in some steps, and the step that has it."""
    if field == "von_mises" or (field == "displacement" and _of_its_mesh(results, body)):
        extremes = results.field_extremes(body, field, rows)
        return extremes.largest, extremes.at_largest
    values = partial(results.outline_field, body, name=field)
    largest = largest_over_time(values, results.time[rows], len(results.outline(body).points))
    return float(largest.max()), rows.start + int(largest.argmax())


def _of_its_mesh(results: Results, body: str) -> bool:
    """Whether the outline of a body is the surface of its mesh, with known modes."""
    return results.outline_source(body) == "recovery" and results.outline(body).node is None
