"""Channels and hits that are late or early, by the phases that a fit leaves.

A delay tau of a channel turns its responses by exp(-i omega tau), which no modes with real shapes
do. Of each pair of a channel and a hit

    tau = arg max  Re sum_k exp(i omega_k tau) w_k^2 conj(fit_k) H_k

and medians over hits are the delays of channels, medians of what remains those of hits.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...files.arrays import Array
from ..identification.responses import Measurement, ModalFit

LARGEST_PHASE = 0.15
"""of a delay at the upper end of the band [rad]: those of right tests are within 0.05"""
DELAY_STEPS = 12
LOW_LINES = 0.25
"""of the band, in which delays turn little: there signs are seen"""
LEAST_LIKENESS = 0.8
"""of a response to its fit, below which its phases say nothing of delays"""
SAME_DELAY = 0.3
"""relative difference within which delays are alike: the fit takes up a part of common ones"""


@dataclass(frozen=True, eq=False)
class Delays:
    """Delays [s] of channels (n_o,) and of hits (n_i,); limit [s]: the least that is told."""

    channels: Array
    hits: Array
    limit: float

    def told(self, channels: Sequence[str], hits: Sequence[str]) -> Iterator[str]:
        """A line for each channel and hit that is late or early, one where most of them are."""
        yield from self._told("channel", channels, self.channels)
        yield from self._told("hit", hits, self.hits)

    def undone(self, measured: Measurement) -> Measurement:
        """A measurement without the delays that are told."""
        by_channel, by_hit = (
            np.where(np.abs(delays) > self.limit, delays, 0.0)
            for delays in (self.channels, self.hits)
        )
        seconds = by_channel[:, None] + by_hit
        if not seconds.any():
            return measured
        omega = measured.s.imag[:, None, None]
        return replace(measured, H=measured.H * np.exp(1j * omega * seconds))

    def _told(self, kind: str, names: Sequence[str], delays: Array) -> Iterator[str]:
        common = float(np.median(delays))
        late = np.abs(delays) > self.limit
        alike = np.abs(delays - common) < SAME_DELAY * abs(common)
        if abs(common) > self.limit and alike.mean() > 0.5:
            which = "all" if alike.all() else f"{int(alike.sum())} of {len(names)}"
            yield f"{which} {kind}s are about {_in_words(common)}"
            late &= ~alike
        for k in np.flatnonzero(late).tolist():
            yield f"{kind} {names[k]} is {_in_words(delays[k])}"


def _in_words(delay: float) -> str:
    return f"{1e6 * abs(delay):.3g} us {'late' if delay > 0.0 else 'early'}"


def delays_of(measured: Measurement, fit: ModalFit) -> Delays:
    """The delays that a fit leaves."""
    omega = measured.s.imag
    rigid = measured.H - measured.elastic
    weighted = (fit.responses(measured) + rigid).conj() * measured.H
    weighted *= measured.weights[:, None, None] ** 2
    # A reversed channel is another fault.
    low = weighted[omega < LOW_LINES * measured.highest].real.sum(axis=0)
    weighted *= np.where(low < 0.0, -1.0, 1.0)
    x = omega / measured.highest
    phase = np.zeros(weighted.shape[1:])
    for _ in range(DELAY_STEPS):
        turned = weighted * np.exp(1j * x[:, None, None] * phase)
        slope = np.einsum("k,kab->ab", x, turned.imag)
        curvature = np.einsum("k,kab->ab", x**2, np.abs(turned.real))
        phase -= slope / np.maximum(curvature, 1e-300)
    likeness = turned.real.sum(axis=0) / np.maximum(np.abs(weighted).sum(axis=0), 1e-300)
    known = np.where(likeness > LEAST_LIKENESS, phase, np.nan)
    by_channel = _medians(known, 1)
    by_hit = _medians(known - by_channel[:, None], 0)
    return Delays(
        by_channel / measured.highest, by_hit / measured.highest, LARGEST_PHASE / measured.highest
    )


def _medians(phases: Array, axis: int) -> Array:
    """Medians of the known phases, 0 where fewer than half are known."""
    enough = np.isfinite(phases).mean(axis=axis) > 0.5
    filled = np.where(np.expand_dims(enough, axis), phases, 0.0)
    return np.asarray(np.nanmedian(filled, axis=axis))
