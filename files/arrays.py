"""Types of the arrays that all packages exchange, in one place below them."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""real numbers, in SI units"""
IntArray = NDArray[np.int64]
"""whole numbers: 64 bits on every platform, as files and compiled code have them"""
Index = IntArray
"""whole numbers that select rows of another array"""
Complex = NDArray[np.complex128]
"""complex numbers"""
