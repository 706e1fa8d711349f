"""Numbers as users give them in Python, for tables that take tuples."""

import numpy as np
from duhamel.inputs import InputError, quoted
from numpy.typing import ArrayLike

Three = tuple[float, float, float]


def vector(given: ArrayLike) -> Three:
    """Three numbers; `InputError` for anything else."""
    try:
        x, y, z = np.asarray(given, dtype=np.float64).tolist()
    except (TypeError, ValueError) as error:
        raise InputError(f"expected three numbers, found {quoted(given)}") from error
    return float(x), float(y), float(z)
