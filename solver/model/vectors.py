"""Three numbers, checked."""

from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError, plain


def vector(name: str, value: Any) -> Array:
    array = np.asarray(value, dtype=float)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ModelError(f"{name}: expected three numbers, got {plain(value)}")
    return array


def unit_vector(name: str, value: Any) -> Array:
    array = np.asarray(value, dtype=np.float64)
    length = float(np.linalg.norm(array))
    if array.shape != (3,) or not (np.isfinite(length) and length > 0.0):
        raise ModelError(
            f"{name}: expected three numbers that are not all zero, got {plain(value)}"
        )
    unit: Array = array / length
    return unit
