"""Whether the rows of a sparse matrix are independent, as its square is eliminated."""

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import SuperLU, splu

from ..arrays import Array

CLEAR = 1e-10
"""pivots above which rows are independent; rounding leaves those of dependent rows far below"""


def unit_rows(J: csr_array) -> tuple[csr_array, Array]:
    """The rows scaled to unit length, and their scales; rows of zeros stay."""
    length = np.sqrt(J.multiply(J).sum(axis=1))
    scale = 1.0 / np.where(length > 0.0, length, 1.0)
    return csr_array(scale[:, None] * J), scale


def factorise_square(J: csr_array) -> SuperLU | None:
    """Factors of J J^T for rows of unit length, and at least one; None unless they are clearly
    independent.

    A pivot is the square of the distance of a row from the space of those before it.
    """
    try:
        factors = splu(
            (J @ J.T).tocsc(),
            "MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:  # exactly singular
        return None
    return factors if float(factors.U.diagonal().min()) > CLEAR else None
