"""Piecewise polynomials, and their integrals."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array


class Pieces:
    """Polynomials between knots, of which the first and the last go on for ever.

        f(t) = sum_k c[i, k] (t - o_i)^k,     k_(i-1) <= t < k_i

    knots (m,), increasing, m > 0; coefficients (m + 1, d). The origins are o_i = k_(i-1), and
    o_0 = k_0.
    """

    def __init__(self, knots: Sequence[float] | Array, coefficients: Array) -> None:
        self.knots = np.array(knots, dtype=np.float64)
        self.coefficients = coefficients
        self._origins = np.concatenate([self.knots[:1], self.knots])

    def __call__(self, t: Array) -> Array:
        """The values at times t, of any shape; at a knot that of the piece after it."""
        i = np.searchsorted(self.knots, t, side="right")
        x = t - self._origins[i]
        columns = self.coefficients.T
        value: Array = columns[-1][i]
        for column in columns[-2::-1]:
            value = value * x + column[i]
        return value

    def derivative(self) -> "Pieces":
        degrees = np.arange(1, self.coefficients.shape[1])
        rates = self.coefficients[:, 1:] * degrees
        return Pieces(self.knots, rates if rates.size else np.zeros_like(self.coefficients))

    def antiderivative(self) -> "Pieces":
        """The continuous one that is zero at the first knot."""
        n, d = self.coefficients.shape
        raised = np.zeros((n, d + 1))
        raised[:, 1:] = self.coefficients / np.arange(1, d + 1)
        # of a piece between two knots, its integral over all of its length
        lengths = np.diff(self.knots)
        gains = np.zeros(len(lengths))
        for column in raised[1:-1].T[::-1]:
            gains = gains * lengths + column
        # Row 1 begins at the first knot, where the antiderivative is 0; each later piece goes on
        # from the one before.
        raised[2:, 0] = np.cumsum(gains)
        return Pieces(self.knots, raised)


def steps(times: Sequence[float], values: Sequence[float]) -> Pieces:
    """values[i] from times[i] on, 0 before."""
    return Pieces(times, np.array([0.0, *values])[:, None])


def lines(times: Sequence[float], values: Sequence[float]) -> Pieces:
    """Straight between the points, constant outside."""
    v = np.array(values, dtype=np.float64)
    slopes = np.diff(v) / np.diff(times)
    starts = np.concatenate([v[:1], v])
    return Pieces(times, np.column_stack([starts, [0.0, *slopes.tolist(), 0.0]]))


def cubics(times: Sequence[float], spline: Array) -> Pieces:
    """A spline of scipy's coefficients (4, m - 1), straight outside."""
    # scipy has the highest power first.
    middle = spline.T[:, ::-1]
    length = times[-1] - times[-2]
    last = middle[-1]
    end = last[0] + length * (last[1] + length * (last[2] + length * last[3]))
    slope = last[1] + length * (2.0 * last[2] + length * 3.0 * last[3])
    before = [middle[0, 0], middle[0, 1], 0.0, 0.0]
    return Pieces(times, np.vstack([before, middle, [end, slope, 0.0, 0.0]]))
