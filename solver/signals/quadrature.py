"""First and second integrals of signals from t = 0: in closed form, or by quadrature.

Signals that have `antiderivatives`, and compositions of such, are integrated in closed form.
Others, as products, are series of Legendre polynomials between their breaks, on panels that are
halved until the series has converged to `SERIES_TOLERANCE` of the largest value so far. Panels
begin at t = 0 and do not depend on the times that are asked for.
"""

from typing import Any

import numpy as np
from numpy.polynomial import legendre

from ..arrays import Array, distinct
from ..errors import ModelError
from .signal import Signal, breaks_of, parts_of, values_of

# of the last coefficients of a panel, relative to the largest value so far
SERIES_TOLERANCE = 1e-14
# The same, below which a tail that halving does not make smaller consists of rounding errors of the
# signal.
ROUNDED_TAIL = 1e-8
PANEL_POINTS = 20
# Several must have vanished: single coefficients of odd or even functions are zero.
TAIL_COEFFICIENTS = 4
# [s] a fixed grid, so that integrals do not depend on the times that are asked for
MAX_PANEL = 1.0
# A signal that jumps without naming its breaks would be halved for ever: 2^-40 s is below any step.
MAX_HALVINGS = 40
# between two breaks: a signal that needs more is not resolved by any step
MAX_PANELS = 100_000
_POINTS, _WEIGHTS = legendre.leggauss(PANEL_POINTS)
_TO_SERIES = (
    legendre.legvander(_POINTS, PANEL_POINTS - 1).T
    * _WEIGHTS
    * (np.arange(PANEL_POINTS) + 0.5)[:, None]
)
"""from values at the points to coefficients"""


def is_closed(signal: Signal) -> bool:
    """True for signals whose integrals have a closed form."""
    return hasattr(signal, "antiderivatives") and all(map(is_closed, parts_of(signal)))


class Integrals:
    """The first and second integral of a signal from t = 0."""

    def __init__(self, signal: Signal) -> None:
        self._antiderivatives: Any = getattr(signal, "antiderivatives", None)
        if not is_closed(signal):
            # Products and functions of users have no closed integral.
            self._antiderivatives = _Panels(signal)
        first, second = self._antiderivatives(np.zeros(1))
        self._first, self._second = float(first[0]), float(second[0])

    def __call__(self, t: Array) -> tuple[Array, Array]:
        """Both at times t (n,) of at least 0."""
        first, second = self._antiderivatives(t)
        return first - self._first, second - self._second - self._first * t


class _Panels:
    """Both integrals as series on panels, which are made as far as they are asked for."""

    def __init__(self, signal: Signal) -> None:
        self._signal = signal
        self._breaks = distinct([b for b in breaks_of(signal) if b > 0.0])
        self._largest = 0.0
        self._ends: list[float] = [0.0]
        self._series: list[Array] = []
        """of the second integral, without what has gathered before a panel"""
        self._gathered: list[tuple[float, float]] = [(0.0, 0.0)]
        """both integrals at the starts of panels"""

    def __call__(self, t: Array) -> tuple[Array, Array]:
        # Panels are made in order and kept: values do not depend on how a run asks for them.
        while self._ends[-1] <= t.max(initial=0.0):
            self._extend()
        ends, gathered = np.array(self._ends), np.array(self._gathered)
        i = np.searchsorted(ends, t, side="right") - 1
        length = ends[i + 1] - ends[i]
        # Legendre polynomials live on [-1, 1].
        x = 2.0 * (t - ends[i]) / length - 1.0
        series = np.array(self._series)[i].T
        once = 0.5 * length * legendre.legval(x, legendre.legint(series, lbnd=-1), tensor=False)
        twice = legendre.legint(legendre.legint(series, lbnd=-1), lbnd=-1)
        second = 0.25 * length**2 * legendre.legval(x, twice, tensor=False)
        first = gathered[i, 0] + once
        return first, gathered[i, 1] + gathered[i, 0] * (t - ends[i]) + second

    def _extend(self) -> None:
        """Panels up to the next break, or the next multiple of the longest."""
        start = self._ends[-1]
        end = (np.floor(start / MAX_PANEL) + 1.0) * MAX_PANEL
        k = int(np.searchsorted(self._breaks, start, side="right"))
        if k < len(self._breaks):
            end = min(end, float(self._breaks[k]))
        self._divide(start, float(end), 0, np.inf, len(self._series) + MAX_PANELS)

    def _divide(self, start: float, end: float, depth: int, before: float, most: int) -> None:
        """Panels from start to end; before: the last coefficients of the whole that they are of."""
        middle = 0.5 * (start + end)
        values = values_of(self._signal, middle + 0.5 * (end - start) * _POINTS)
        if not np.isfinite(values).all() or len(self._series) >= most:
            raise ModelError(
                f"the integral of this signal does not converge near t = {middle:.6g} s"
            )
        series: Array = _TO_SERIES @ values
        self._largest = max(self._largest, float(np.abs(values).max()))
        tail = float(np.abs(series[-TAIL_COEFFICIENTS:]).max())
        # Halving a panel of a smooth signal makes its tail much smaller; one that stays is noise.
        rounded = 0.1 * before < tail <= ROUNDED_TAIL * self._largest
        converged = tail <= SERIES_TOLERANCE * self._largest or rounded
        # start < middle < end ends the halving of panels of a few roundings.
        if not converged and depth < MAX_HALVINGS and start < middle < end:
            self._divide(start, middle, depth + 1, tail, most)
            self._divide(middle, end, depth + 1, tail, most)
            return
        self._add(end, series)

    def _add(self, end: float, series: Array) -> None:
        start, (first, second) = self._ends[-1], self._gathered[-1]
        length = end - start
        once = 0.5 * length * 2.0 * series[0]
        # int int of P_0 is 2, of P_1 -2/3 over the panel, of higher ones 0
        twice = 0.25 * length**2 * (2.0 * series[0] - 2.0 / 3.0 * series[1])
        self._ends.append(end)
        self._series.append(series)
        self._gathered.append((first + once, second + first * length + twice))
