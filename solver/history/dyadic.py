"""Convolution of past loads by FFT in dyadic blocks, each as soon as it is complete.

    after step n, with b = DIRECT_STEPS 2^l the largest that divides n:   for i = 1 .. b
        ahead[n + i] += sum_{j = n-b+1..n} g[n + i - j] p_j

Together with the sum over the present block, which the time loop takes, these squares tile all
pairs of steps once, so the result is that of the direct sum to rounding; N steps cost
O(N log^2 N). A kernel of fewer lags than b needs no larger squares, and no loads older than itself:
then the storage does not grow with the steps.

Source: E. Hairer, Ch. Lubich, M. Schlichte, SIAM J. Sci. Stat.
Comput. 6 (1985); docs/theory.md, History.
"""

from typing import TypeAlias

import numpy as np
from numpy import fft
from numpy.typing import NDArray

from ..arrays import Array, Index
from ..step.records.elastic import Elastic
from ..step.system import State

Complex: TypeAlias = NDArray[np.complex128]

# steps whose loads the time loop sums directly: about where the sum costs as much as the FFT
DIRECT_STEPS = 128


class Window:
    """The steps whose loads are kept: twice `span`; when full, the older half is dropped."""

    def __init__(self, elastic: Elastic) -> None:
        self.span = power_above(int(elastic.kernels.lags.max(initial=0)))

    def capacity(self, n_steps: int) -> int:
        """The number of steps whose loads a run of n_steps keeps at a time, t = 0 included.

        The largest block reaches beyond the end, where a longer run may go on.
        """
        return min(power_above(n_steps + 1), 2 * self.span) + 1

    def shift(self, n: int, state: State) -> None:
        """Drop the older half if step n has filled the window."""
        if n - state.past.first[0] == 2 * self.span:
            for rows in (state.past.p, state.past.u_ahead):
                # Halving makes shifts rare: each load is copied once at most.
                rows[:, : self.span + 1] = rows[:, self.span : 2 * self.span + 1]
                rows[:, self.span + 1 :] = 0.0
            state.past.first[0] += self.span


class DyadicConvolution:
    """Updates `state.past.u_ahead` during a run, block by block."""

    def __init__(self, elastic: Elastic) -> None:
        self._elastic = elastic
        self._by_fft = np.flatnonzero(elastic.kernels.by_fft).tolist()
        self._window = Window(elastic)
        self._spectra: dict[tuple[int, int], Complex] = {}

    def steps_until_due(self, step: int, n: int) -> int:
        """The number of steps, up to n, that may follow `step` before `update` is due."""
        if self._by_fft:
            n = min(n, DIRECT_STEPS - step % DIRECT_STEPS)
        elif self._elastic.kernels.lags.any():
            n = min(n, self._window.span - step % self._window.span)
        return n

    def update(self, state: State) -> None:
        """Convolve the loads up to the last step, and drop those older than the kernels."""
        n = int(state.step[0])
        self._window.shift(n, state)
        if n > 0 and n % DIRECT_STEPS == 0:
            for e in self._by_fft:
                # n & -n is the largest power of two that divides n.
                block = min(n & -n, power_above(int(self._elastic.kernels.lags[e])))
                self._convolve(e, n, block, state)
                state.past.since[e] = n + 1

    def _convolve(self, e: int, n: int, block: int, state: State) -> None:
        elastic = self._elastic
        loaded = elastic.loaded[elastic.loaded_range[e] : elastic.loaded_range[e + 1]]
        dofs = slice(elastic.dof[e], elastic.dof[e + 1])
        now = n - int(state.past.first[0])
        p = state.past.p[loaded, now - block + 1 : now + 1]
        response = self._response(e, block, loaded - dofs.start, p)
        ahead = state.past.u_ahead[dofs, now + 1 : now + 1 + block]
        # At the end of the window fewer steps are left than a block has.
        ahead += response[:, : ahead.shape[1]]

    def _response(self, e: int, block: int, loaded: Index, p: Array) -> Array:
        """Of the block of steps after those of the loads p on some dofs of body e."""
        # Twice the block: padding with zeros keeps the cyclic convolution from wrapping around.
        loads = fft.rfft(p, 2 * block)
        columns = self._spectrum(e, block)[:, loaded]
        return fft.irfft(np.einsum("ikf,kf->if", columns, loads), 2 * block)[:, block:]

    def _spectrum(self, e: int, block: int) -> Complex:
        """The transform of the first 2 block lags of body e, (n_c, n_c, block + 1)."""
        key = int(self._elastic.kernels.g_start[e]), block
        if key not in self._spectra:
            n_c = int(self._elastic.dof[e + 1] - self._elastic.dof[e])
            lags = int(self._elastic.kernels.lags[e])
            self._spectra[key] = self._transform(key[0], n_c, lags, block)
        return self._spectra[key]

    def _transform(self, first: int, n_c: int, lags: int, block: int) -> Complex:
        g = self._elastic.kernels.g[first : first + n_c * n_c * lags].reshape(n_c, n_c, lags)
        return fft.rfft(g[:, :, ::-1][:, :, : 2 * block], 2 * block)


def power_above(lags: int) -> int:
    """The smallest block of at least so many lags."""
    block = DIRECT_STEPS
    while block < lags:
        block *= 2
    return block
