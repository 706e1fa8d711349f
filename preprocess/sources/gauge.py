"""Strain gauges of a length: what they measure is the change of distance of their ends."""

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..body.sensors import SensorPoint
from ..errors import BodyError

MIN_GAUGE_LENGTH = 1e-6  # over the size of the mesh


def unit_vector(direction: Any) -> Array:
    """A direction as a vector (3,) of length 1."""
    vector = np.asarray(direction, dtype=float)
    vector = vector / np.abs(vector).max()  # whose square is a number
    return np.asarray(vector / np.linalg.norm(vector))


def stretch_rows(displacement_at: Callable[[Array], Any], sensor: SensorPoint, size: float) -> Any:
    """One row: the mean strain d . (u_2 - u_1) / length between the ends of a gauge.

    displacement_at: rows (3, n_u) of a point (3,) [m]; size: of the mesh [m]. `BodyError` for a
    length that is lost in the rounding of places.
    """
    d, length = unit_vector(sensor.direction), float(sensor.length or 0.0)
    if length < MIN_GAUGE_LENGTH * size:
        raise BodyError(
            f"length: expected at least {MIN_GAUGE_LENGTH * size:.3g} m, found {length:.3g}"
        )
    # The point is the middle of a gauge, as the data sheets of gauges have it.
    middle = np.array(sensor.point)
    first, second = (displacement_at(middle + s * 0.5 * length * d) for s in (-1.0, 1.0))
    return sp.csr_array((d / length)[None]) @ (second - first)
