"""Means of signals over the hat functions of the time grid.

    m_n = int f(t) w_n(t) dt / int w_n(t) dt,     w_n(t) = max(1 - |t - t_n| / h, 0),  t >= 0

The sum of h m_n is the area under f, to rounding, however short it is and wherever it begins.
"""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Index, as_index
from .signal import Pointwise, Signal, breaks_of, corners_of, values_of

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
"""of Gauss' rule in each piece of half a hat, between the breaks of the signal"""
# Steps about a corner within which samples are means. Farther away the mean over a hat differs from
# the value by curvature alone.
CORNER_STEPS = 8.0
# Between corners that are further apart sums of values have the area to 1e-6.
LONG_SPAN_STEPS = 1000.0


class Averaged(Pointwise):
    """Signals that are sampled by means near their corners."""

    def samples(self, t: Array, h: float) -> Array:
        return samples_of(self, t, h)


def samples_of(signal: Signal, t: Array, h: float) -> Array:
    """Values at the steps t (n,), but near corners and within pulses means."""
    near = _are_near(corners_of(signal), t, h)
    samples = np.empty(len(t))
    samples[near] = means(signal, t[near], h)
    samples[~near] = values_of(signal, t[~near])
    return samples


def _are_near(corners: tuple[float, ...], t: Array, h: float) -> NDArray[np.bool_]:
    """True for the steps near a corner, or between two that are not far from one another (n,)."""
    ends = np.sort(np.array(corners, dtype=np.float64))
    first = np.searchsorted(ends, t - CORNER_STEPS * h)
    after = np.searchsorted(ends, t + CORNER_STEPS * h, side="right")
    # Between near corners, as of a short pulse, sums of values would miss some of the area.
    is_short = np.append(np.diff(ends) < LONG_SPAN_STEPS * h, False)
    before = np.searchsorted(ends, t, side="right") - 1
    between = (before >= 0) & is_short[before] if len(ends) else np.zeros(len(t), dtype=bool)
    near: NDArray[np.bool_] = (after > first) | between
    return near


def means(signal: Signal, t: Array, h: float) -> Array:
    """Means over the hats about the steps t (n,), that of t = 0 without its left half."""
    # Each hat is two straight halves: a polynomial rule is exact within, not across the peak.
    starts = np.stack([np.maximum(t - h, 0.0), t], axis=1).ravel()
    ends = np.stack([t, t + h], axis=1).ravel()
    a, b, half = _pieces(starts, ends, np.sort(np.array(breaks_of(signal), dtype=np.float64)))
    at = 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * NODES
    hat = np.maximum(1.0 - np.abs(at - t[half // 2][:, None]) / h, 0.0)
    areas = 0.5 * (b - a) * (values_of(signal, at) * hat * WEIGHTS).sum(axis=1)
    # Pieces are sorted by halves of hats: those of step n begin with half 2 n.
    first = np.searchsorted(half, 2 * np.arange(len(t)))
    total: Array = np.add.reduceat(areas, first) if len(t) else areas
    return total / np.where(t < 0.5 * h, 0.5 * h, h)


def _pieces(starts: Array, ends: Array, breaks: Array) -> tuple[Array, Array, Index]:
    """Intervals cut at the breaks within: starts, ends, and the numbers of the intervals."""
    first = np.searchsorted(breaks, starts, side="right")
    inner = np.maximum(np.searchsorted(breaks, ends, side="left") - first, 0)
    number = as_index(np.repeat(np.arange(len(starts)), inner + 1))
    place = np.arange(len(number)) - np.repeat(np.cumsum(inner + 1) - inner - 1, inner + 1)
    # One more entry, which is never chosen, keeps indices of the last intervals valid.
    padded = np.append(breaks, np.inf)
    cut = np.minimum(first[number] + place, len(breaks))
    before = np.maximum(cut - 1, 0)
    a = np.where(place == 0, starts[number], padded[before])
    b = np.where(place == inner[number], ends[number], padded[cut])
    return a, b, number
