"""The band of frequencies in which a kernel must be right, and how far from right it is."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...superelement import GeneralizedAlpha, Modes
from ...superelement.transfer import dynamic_stiffness, transfer
from ...superelement.validation import Array

Complex = NDArray[np.complex128]

PARTS = 8
"""Equal parts of the band, each on a scale of its own: displacements fall with the square of the
frequency.
"""
GRID = 16
"""Frequencies in every part, besides those of the resonances in it."""
COARSER = 5
"""Steps, from h to the coarsest that resolves the band, of which g[0] is looked at."""
AT_ONCE: Complex = np.zeros(1, dtype=np.complex128)
"""The delay d of g[0] = G(0)."""
SLOW = 0.5
"""Share of the first natural frequency up to which loads of rotation are slow."""
NARROWER = 2.0 ** -np.arange(0.0, 6.25, 0.25)
"""Parts of a band that are tried, each narrower than the one before: quarters of an octave."""
RESONANCES = 64
"""Resonances looked at in every part; of more, each second, third, ... from the top."""


@dataclass(frozen=True)
class Band:
    """The transfer function of kernels with step h [s] and `steps` steps, from 0 to `limit` [Hz].

        G(d) = sum_k g[k] d^k,    d = exp(-1 / steps - 2 pi i f h),    0 <= f <= limit

    On this circle lags count for as long as the kernel is, and resonances are as high as they grow
    in that time. Errors are |G_ij - G'_ij| / sqrt(max |G_ii| max |G_jj|), each entry on the scale
    of its own two rows, with the largest |G_ii| in each eighth of the band for itself, and for g[0]
    = G(0) alone. Source: docs/theory.md, Impulse responses and Large meshes.
    """

    h: float
    scheme: GeneralizedAlpha
    steps: int
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

    def error(self, modes: Modes, better: Modes, enough: float = np.inf) -> float:
        """The largest error of `modes`, taking `better` for the truth.

        First of g[0], of coarser steps too as long as they resolve the band; then from the highest
        frequencies down, which converge last, until one is beyond `enough`.
        """
        coarser = np.geomspace(self.h, self.coarsest_step, COARSER)
        largest = max(replace(self, h=float(h))._error(modes, better, AT_ONCE) for h in coarser)
        for delay in reversed(self._delays(better)):
            largest = max(largest, self._error(modes, better, delay))
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
        for share in NARROWER:
            part = replace(self, limit=float(share * self.limit))
            error = part._error_inside(modes, better, turn)
            if error <= tolerance:
                break
        return part, error

    def slow(self, modes: Modes) -> "Band":
        """The part of the band in which nothing resonates."""
        return replace(self, limit=min(self.limit, SLOW * float(modes.frequencies.min())))

    def slow_error(self, modes: Modes, better: Modes) -> float:
        """The largest error in the slow part of the band, which g[0] does not belong to."""
        return self.slow(better)._error_inside(modes, better, None)

    def slow_contributions(self, modes: Modes) -> Array:
        """The error (m,) there that leaving out each mode makes, at most."""
        slow = self.slow(modes)
        return slow._contributions(modes, slow._delays(modes)[1:])

    def contributions(self, modes: Modes) -> Array:
        """The error (m,) that leaving out each mode makes, at most: |phi_i phi_j| is largest for i
        = j.
        """
        return self._contributions(modes, self._delays(modes))

    def _contributions(self, modes: Modes, delays: list[Complex]) -> Array:
        largest = np.zeros(len(modes.omega))
        for delay in delays:
            scale = _scale(self._transfer(modes, delay))
            weight = np.abs(1.0 / dynamic_stiffness(modes, self.h, self.scheme, delay)).max(axis=0)
            largest = np.maximum(largest, (modes.phi**2 / scale[:, None]).max(axis=0) * weight)
        return largest

    def field_error(self, modes: Modes, better: Modes, turn: Array) -> float:
        """The largest error of displacements under unit loads on the interfaces, in strain energy.

        |u_j - u'_j| / max |u_j| for the load on each interface dof j, |u|^2 = u^T K u = sum omega^2
        eta^2. Kernels, which see loads where they act, err with the square of this. turn (m', m):
        `modes` in terms of `better`.
        """
        return max(self._field_error(modes, better, turn, delay) for delay in self._delays(better))

    def field_contributions(self, modes: Modes) -> Array:
        """The error (m,) that leaving out each mode makes in this norm."""
        largest = np.zeros(len(modes.omega))
        for delay in self._delays(modes):
            energy = _energy(modes, self._coordinates(modes, delay))
            share = energy / _largest(energy.sum(axis=1))
            largest = np.maximum(largest, np.sqrt(share.max(axis=(0, 2))))
        return largest

    def _error_inside(self, modes: Modes, better: Modes, turn: Array | None) -> float:
        """The largest error from 0 to the limit, g[0] not among it."""
        delays = self._delays(better)[1:]
        error = max(self._error(modes, better, delay) for delay in delays)
        if turn is None:
            return error
        return max(error, *(self._field_error(modes, better, turn, d) for d in delays))

    def _field_error(self, modes: Modes, better: Modes, turn: Array, delay: Complex) -> float:
        eta = self._coordinates(better, delay)
        missing = _energy(better, eta - turn @ self._coordinates(modes, delay)).sum(axis=1)
        return float(np.sqrt((missing / _largest(_energy(better, eta).sum(axis=1))).max()))

    def _coordinates(self, modes: Modes, delay: Complex) -> Complex:
        """eta (n, m, n_c) under a unit load on each interface dof."""
        eta: Complex = (
            modes.phi.T / dynamic_stiffness(modes, self.h, self.scheme, delay)[:, :, None]
        )
        return eta

    def _error(self, modes: Modes, better: Modes, delay: Complex) -> float:
        G = self._transfer(better, delay)
        scale = np.sqrt(_scale(G))
        return float(
            (np.abs(self._transfer(modes, delay) - G).max(axis=0) / np.outer(scale, scale)).max()
        )

    def _transfer(self, modes: Modes, delay: Complex) -> Complex:
        return transfer(modes, self.h, self.scheme, delay)

    def _delays(self, modes: Modes) -> list[Complex]:
        """The delays of every part of the band: a grid, and the resonances, Re sigma = -omega^2."""
        edges = np.linspace(0.0, 2.0 * np.pi * self.limit * self.h, PARTS + 1)
        parts, found = [AT_ONCE], modes.resonances
        for low, high in pairwise(edges):
            fine = np.linspace(low, high, 1024)
            sigma, _ = self.scheme.symbols(self.h, self._delay(fine))
            inside = found[(-sigma[0].real <= found**2) & (found**2 <= -sigma[-1].real)]
            inside = np.sort(inside)[:: -(1 + len(inside) // RESONANCES)]
            resonances = np.interp(inside**2, -sigma.real, fine)
            parts.append(self._delay(np.concatenate([np.linspace(low, high, GRID), resonances])))
        return parts

    def _delay(self, angle: Array) -> Complex:
        delay: Complex = np.exp(-1.0 / self.steps - 1j * angle)
        return delay


def _scale(G: Complex) -> Array:
    """max |G_ii| (n_c,) over the first axis."""
    return _largest(np.abs(np.diagonal(G, axis1=1, axis2=2)))


def _largest(sizes: Array) -> Array:
    """The largest (n_c,) over the first axis; at least the smallest positive number."""
    largest: Array = sizes.max(axis=0)
    return np.maximum(largest, np.finfo(float).tiny)


def _energy(modes: Modes, eta: Complex) -> Array:
    """Twice the strain energy of each mode (n, m, n_c)."""
    energy: Array = (modes.omega[:, None] * np.abs(eta)) ** 2
    return energy
