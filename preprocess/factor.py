"""The one place where sparse matrices are factorized."""

from collections.abc import Callable
from typing import Any

from scipy.sparse.linalg import splu

from ..superelement.validation import Array


def factorize(matrix: Any) -> Callable[[Array], Array]:
    """x = solve(b) for a sparse symmetric positive definite matrix (n, n); b (n,) or (n, k)."""
    # Positive definite matrices need no pivoting: keeping the diagonal keeps the symmetric, sparser ordering.
    options = {"SymmetricMode": True}
    factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    return lambda b: factors.solve(b)
