"""LU factors in panels of columns."""

import numpy as np
import pytest
from duhamel.solver.step.lu import PANEL_COLUMNS, factorize_lu, substitute_lu


@pytest.mark.parametrize("n", [1, 2, PANEL_COLUMNS, PANEL_COLUMNS + 1, 3 * PANEL_COLUMNS - 1, 70])
def test_factors_solve_equations_that_need_exchanges(n):
    rng = np.random.default_rng(n)
    A = rng.normal(size=(n, n))
    # As of rows that stick and slip: some are those of the unit matrix, and diagonals vanish.
    A[::3] = np.eye(n)[::-1][::3] if n > 1 else 2.0
    x = rng.normal(size=n)
    room, pivots = np.zeros((n + 3, n + 3)), np.zeros(n, dtype=np.int64)
    room[:n, :n] = A
    assert factorize_lu(n, room, pivots)
    y = A @ x
    substitute_lu(n, room, pivots, y)
    np.testing.assert_allclose(y, x, rtol=1e-9, atol=1e-9)


def test_a_singular_matrix_is_told():
    A = np.ones((20, 20))
    assert not factorize_lu(20, A, np.zeros(20, dtype=np.int64))
    nothing = np.full((3, 3), np.nan)
    assert not factorize_lu(3, nothing, np.zeros(3, dtype=np.int64))
