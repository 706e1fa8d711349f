"""Band-limited noise of a given power spectral density."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, FieldSpec, NameInFile, entry
from ..schema.values import NotNegative, Positive, points
from .harmonics import harmonic_integrals
from .profiles import Frequencies
from .signal import SIGNAL_FORMS, Pointwise, Smooth

MAX_LINES = 100_000
# A block of doubles of 2 MB stays in the cache.
SINES_AT_ONCE = 1 << 18


def _seed(value: Any) -> int:
    seed = int(value)
    if isinstance(value, bool) or seed != value or not 0 <= seed < 2**63:
        raise ValueError
    return seed


def _spectrum(value: Any) -> tuple[tuple[float, float], ...]:
    pairs = points(value)
    if len(pairs) < 2 or not (pairs > 0.0).all() or not (np.diff(pairs[:, 0]) > 0.0).all():
        raise ValueError
    return tuple((f, density) for f, density in pairs.tolist())


Seed = Annotated[int, FieldSpec("an integer of at least 0", _seed, int)]
Spectrum = Annotated[
    tuple[tuple[float, float], ...],
    FieldSpec(
        "two or more pairs of a frequency and a density, all positive, of increasing frequencies",
        _spectrum,
        tuple[tuple[float, float], ...],
    ),
]


class Lines(NamedTuple):
    """Amplitudes, angular frequencies [rad/s] and phases [rad] of sines (n,)."""

    amplitude: Array
    omega: Array
    phase: Array


class _Noise(Smooth, Pointwise):
    """A sum of harmonics at the multiples of 1 / period within a band, of random phases.

        f(t) = sum_k sqrt(2 S_k) cos(2 pi k t / period + phi_k)

    S_k is the part of the density in (k - 1/2 .. k + 1/2) / period, so that the mean square over a
    period is the integral of the density.
    """

    period: float
    seed: int
    lines: Lines

    def _cumulative(self, f: Array) -> Array:
        """The integral of the density from the lower end of the band to f [Hz]."""
        raise NotImplementedError

    def _band(self) -> tuple[float, float]:
        raise NotImplementedError

    def validate(self) -> None:
        first, last = self._band()
        if not first < last:
            raise ModelError(f"noise: band: expected increasing frequencies, got {[first, last]}")
        n = (last - first) * self.period
        if not 1.0 <= n <= MAX_LINES:
            raise ModelError(
                f"noise: expected 1 to {MAX_LINES} lines, a period times the width of the band, "
                f"got {n:.6g}: a period of {self.period:g} s, a band of {last - first:g} Hz"
            )
        # Lines whose bands overlap the given one; edges are clipped, so that no power is lost or
        # added.
        lines = np.arange(np.floor(first * self.period + 0.5), np.floor(last * self.period) + 2.0)
        edges = np.clip(np.append(lines - 0.5, lines[-1] + 0.5) / self.period, first, last)
        squares = np.diff(self._cumulative(edges))
        # Line 0 would be a constant force.
        kept = (squares > 0.0) & (lines > 0.0)
        # the bits of a PCG64 are the same in all versions of numpy, its distributions are not
        bits = np.random.PCG64(self.seed).random_raw(len(lines))[kept]
        phases = 2.0 * np.pi * (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53
        omegas = 2.0 * np.pi * lines[kept] / self.period
        # cos(x) = sin(x + pi / 2): harmonics.py integrates sines.
        sines = Lines(np.sqrt(2.0 * squares[kept]), omegas, phases + 0.5 * np.pi)
        object.__setattr__(self, "lines", sines)

    @property
    def highest_frequency(self) -> float:
        """The highest frequency [Hz]."""
        return self._band()[1]

    @property
    def rms(self) -> float:
        """The root of the mean square."""
        return float(np.sqrt(0.5 * (self.lines.amplitude**2).sum()))

    def values_at(self, t: Array) -> Array:
        return self._sum(t, lambda times: (np.sin(self.lines.omega * times + self.lines.phase),))[0]

    def derivatives_at(self, t: Array) -> tuple[Array, Array]:
        _, omegas, phases = self.lines

        def terms(times: Array) -> tuple[Array, Array]:
            angles = omegas * times + phases
            return omegas * np.cos(angles), -(omegas**2) * np.sin(angles)

        rate, acceleration = self._sum(t, terms)
        return rate, acceleration

    def antiderivatives(self, t: Array) -> tuple[Array, Array]:
        once, twice = self._sum(
            t, lambda times: harmonic_integrals(times, self.lines.omega, self.lines.phase)
        )
        return once, twice

    def _sum(self, t: Array, terms: Any) -> list[Array]:
        """Sums over the lines of functions of a time and a line, at times of any shape."""
        # Times by lines may be a matrix of gigabytes: blocks of rows.
        flat, rows = t.reshape(-1, 1), max(SINES_AT_ONCE // max(len(self.lines.omega), 1), 1)
        blocks = [flat[k : k + rows] for k in range(0, max(len(flat), 1), rows)]
        sums = [[(self.lines.amplitude * f).sum(axis=1) for f in terms(block)] for block in blocks]
        return [np.concatenate(parts).reshape(t.shape) for parts in zip(*sums, strict=True)]


@SIGNAL_FORMS.in_files("noise")
@entry(eq=True)
class Noise(_Noise, Entry):
    """Noise of a constant power spectral density within a band.

    Parameters
    ----------
    density : float [unit^2/Hz]
        One-sided.
    band : (2,) [Hz]
    period : float [s]
        The time after which the noise repeats itself; choose it longer than the run.
    seed : int
        Another seed gives another noise of the same density.

    Examples
    --------
    >>> noise = Noise(2.0, band=(1.0, 50.0), period=10.0)
    >>> noise(1.0) == Noise(2.0, band=(1.0, 50.0), period=10.0)(1.0)
    True
    """

    density: Annotated[NotNegative, NameInFile("noise")]
    band: Frequencies
    period: Positive
    seed: Seed = 0

    def _band(self) -> tuple[float, float]:
        return self.band

    def _cumulative(self, f: Array) -> Array:
        cumulative: Array = self.density * (f - self.band[0])
        return cumulative


@SIGNAL_FORMS.in_files("spectrum")
@entry(eq=True)
class ShapedNoise(_Noise, Entry):
    """Noise of a power spectral density given at some frequencies.

    Parameters
    ----------
    spectrum : (n, 2)
        Frequencies [Hz] and the one-sided density there [unit^2/Hz]; straight between them on
        logarithmic axes, zero outside.
    period : float [s]
    seed : int
        See `Noise` for both.

    Examples
    --------
    >>> random = ShapedNoise([(10.0, 0.1), (100.0, 1.0)], period=10.0)
    >>> abs(random(10.3) - random(0.3)) < 1e-9
    True
    """

    spectrum: Spectrum
    period: Positive
    seed: Seed = 0

    def _band(self) -> tuple[float, float]:
        return self.spectrum[0][0], self.spectrum[-1][0]

    def _cumulative(self, f: Array) -> Array:
        corners, densities = np.array(self.spectrum).T
        slopes = np.diff(np.log(densities)) / np.diff(np.log(corners))
        i = np.clip(np.searchsorted(corners, f, side="right") - 1, 0, len(slopes) - 1)
        whole = densities[:-1] * _power(corners[1:], corners[:-1], slopes)
        before = np.concatenate([np.zeros(1), np.cumsum(whole)])
        cumulative: Array = before[i] + densities[i] * _power(f, corners[i], slopes[i])
        return cumulative


def _power(f: Array, corner: Array, slope: Array) -> Array:
    """The integral of (f / corner)^slope from the corner to f."""
    logarithm, n = np.log(f / corner), slope + 1.0
    # A slope of -1 integrates to a logarithm; next to it expm1 keeps the difference of two powers.
    near = np.abs(n * logarithm) < 1e-12
    safe = np.where(near, 1.0, n)
    power: Array = corner * np.where(near, logarithm, np.expm1(safe * logarithm) / safe)
    return power
