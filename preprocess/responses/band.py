"""The band of frequencies in which modes must be right, and how far from right they are."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...superelement import GeneralizedAlpha, Modes
from ...superelement.transfer import dynamic_stiffness, laplace_stiffness, receptance
from ...superelement.validation import Array

Complex = NDArray[np.complex128]
Stiffness = Callable[[Modes], Complex]
"""The dynamic stiffness (n, m) of every mode at the n points of a part of the band."""

LEAST_DAMPING = 1e-3
"""Damping ratio, beside that of the body, at which errors are judged: resonances are five hundred
times as high as static displacements then, and an error of frequency counts so many times.
"""
BAND_PARTS = 8
"""Equal parts of the band, each on a scale of its own: displacements fall with the square of the
frequency.
"""
FREQUENCIES_PER_PART = 16  # besides those of the resonances in it
N_COARSER_STEPS = 5
"""Steps, from h to the coarsest that resolves the band, of which g[0] is looked at."""
AT_ONCE: Complex = np.zeros(1, dtype=np.complex128)  # the delay d of g[0] = G(0)
AT_REST: Complex = np.zeros(1, dtype=np.complex128)  # the s of static displacements
SLOW_SHARE = 0.5  # of the first natural frequency, up to which rotation is slow
# Parts that are tried, by quarters of an octave.
NARROWER_BANDS = 2.0 ** -np.arange(0.0, 6.25, 0.25)
RESONANCES_PER_PART = 64  # of more, each second, third, ... from the top


@dataclass(frozen=True)
class Band:
    """The responses that modes must have right: at rest, from 0 to `limit` [Hz], and in a step.

        G(s) = phi diag(1 / (s^2 + 2 zeta omega s + omega^2)) phi^T
        s = (LEAST_DAMPING + i) w,    0 <= w <= 2 pi top

    and g[0], what a load does within a step h [s] or a coarser one that resolves the band. None of
    that knows how long a run is. Errors are |G_ij - G'_ij| / sqrt(max |G_ii| max |G_jj|), each
    entry on the scale of its own two rows, with the largest |G_ii| in each eighth of the band, and
    from there to the top, for itself, and for static displacements and each g[0] alone. Source:
    docs/theory.md, Large meshes.
    """

    h: float
    scheme: GeneralizedAlpha
    limit: float

    @property
    def finest_step(self) -> float:
        """The step [s] of which the band reaches half the Nyquist frequency; h itself if it reaches
        less.
        """
        return min(self.h, 0.25 / self.limit)

    @property
    def coarsest_step(self) -> float:
        """The step [s] that resolves the band to half its Nyquist frequency; h itself where that is
        finer.
        """
        return max(self.h, 0.25 / self.limit)

    @property
    def top(self) -> float:
        """The frequency [Hz] of the modes that steps take to `limit`: they bend the frequencies."""
        delay = np.exp(-2j * np.pi * np.array([self.limit * self.finest_step]))
        sigma, _ = self.scheme.symbols(self.finest_step, delay)
        return max(self.limit, float(np.sqrt(-sigma[0].real)) / (2.0 * np.pi))

    def error(self, modes: Modes, better: Modes, enough: float = np.inf) -> float:
        """The largest error of `modes`, taking `better` for the truth.

        First of g[0], then of static displacements and from the highest frequencies down, until one
        is beyond `enough`.
        """
        return self._largest_error(modes, better, enough, better.resonances)

    def smooth_error(self, modes: Modes, better: Modes, enough: float = np.inf) -> float:
        """A bound of the same for modes that differ beyond the band alone: no resonance in it has
        another error than its neighborhood.
        """
        return self._largest_error(modes, better, enough, np.zeros(0))

    def _largest_error(
        self, modes: Modes, better: Modes, enough: float, resonances: Array
    ) -> float:
        largest = 0.0
        for stiffness in (*self._at_once(), *self._inside(resonances)):
            largest = max(largest, _error(modes, better, stiffness))
            if largest > enough:
                break
        return largest

    def within(
        self, tolerance: float, modes: Modes, better: Modes, turn: Array | None = None
    ) -> tuple["Band", float]:
        """The widest part of the band in which `modes` are right to the tolerance, and their error.

        Where there is none, the narrowest of the parts that are tried. `better` is taken for the
        truth. turn (m', m), `modes` in terms of it: the error is then that of `field_error` too.
        """
        for share in NARROWER_BANDS:
            part = replace(self, limit=float(share * self.limit))
            error = part._error_inside(modes, better, turn)
            if error <= tolerance:
                break
        return part, error

    def slow(self, modes: Modes) -> "Band":
        """The part of the band in which nothing resonates."""
        return replace(self, limit=min(self.limit, SLOW_SHARE * float(modes.frequencies.min())))

    def slow_error(self, modes: Modes, better: Modes) -> float:
        """The largest error in the slow part of the band, which g[0] does not belong to."""
        return self.slow(better)._error_inside(modes, better, None)

    def field_error(self, modes: Modes, better: Modes, turn: Array) -> float:
        """The largest error of displacements under unit loads on the interfaces, in strain energy.

        |u_j - u'_j| / max |u_j| for the load on each interface dof j, |u|^2 = u^T K u = sum omega^2
        eta^2. Kernels, which see loads where they act, err with the square of this. turn (m', m):
        `modes` in terms of `better`.
        """
        parts = (*self._at_once(), *self._inside(better.resonances))
        return max(_field_error(modes, better, turn, stiffness) for stiffness in parts)

    def _error_inside(self, modes: Modes, better: Modes, turn: Array | None) -> float:
        """The largest error at rest and from 0 to the limit, g[0] not among it."""
        parts = list(self._inside(better.resonances))
        error = max(_error(modes, better, stiffness) for stiffness in parts)
        if turn is None:
            return error
        return max(error, *(_field_error(modes, better, turn, stiffness) for stiffness in parts))

    def _at_once(self) -> Iterator[Stiffness]:
        """g[0] of steps from h to the coarsest that resolves the band."""
        for h in np.geomspace(self.h, self.coarsest_step, N_COARSER_STEPS):
            yield partial(dynamic_stiffness, h=float(h), scheme=self.scheme, delay=AT_ONCE)

    def _inside(self, found: Array) -> Iterator[Stiffness]:
        """Rest, and every part of the band from the highest: a grid, and the resonances `found`
        [rad/s].
        """
        yield partial(laplace_stiffness, s=AT_REST)
        edges = 2.0 * np.pi * np.append(np.linspace(0.0, self.limit, BAND_PARTS + 1), self.top)
        for low, high in reversed(list(pairwise(edges))):
            inside = found[(low <= found) & (found <= high)]
            inside = np.sort(inside)[:: -(1 + len(inside) // RESONANCES_PER_PART)]
            omega = np.concatenate([np.linspace(low, high, FREQUENCIES_PER_PART), inside])
            yield partial(laplace_stiffness, s=(LEAST_DAMPING + 1j) * omega)


def _error(modes: Modes, better: Modes, stiffness: Stiffness) -> float:
    G = receptance(better, stiffness(better))
    scale = np.sqrt(_largest(np.abs(np.diagonal(G, axis1=1, axis2=2))))
    missing = np.abs(receptance(modes, stiffness(modes)) - G).max(axis=0)
    return float((missing / np.outer(scale, scale)).max())


def _field_error(modes: Modes, better: Modes, turn: Array, stiffness: Stiffness) -> float:
    eta = _coordinates(better, stiffness)
    missing = _energy(better, eta - turn @ _coordinates(modes, stiffness)).sum(axis=1)
    return float(np.sqrt((missing / _largest(_energy(better, eta).sum(axis=1))).max()))


def _coordinates(modes: Modes, stiffness: Stiffness) -> Complex:
    """eta (n, m, n_c) under a unit load on each interface dof."""
    return np.asarray(modes.phi.T / stiffness(modes)[:, :, None])


def _largest(sizes: Array) -> Array:
    """The largest (n_c,) over the first axis; at least the smallest positive number."""
    largest: Array = sizes.max(axis=0)
    return np.maximum(largest, np.finfo(float).tiny)


def _energy(modes: Modes, eta: Complex) -> Array:
    """Twice the strain energy of each mode (n, m, n_c)."""
    return np.asarray((modes.omega[:, None] * np.abs(eta)) ** 2)
