"""Past loads convolved in blocks, by FFT: what a block that is complete does to the steps ahead.

    after step n, with b = BLOCK 2^l the largest that divides n:   for i = 1 .. b
        ahead[n + i] += sum_{j = n-b+1..n} g[n + i - j] p_j

Together with the sum over the present block, which the time loop takes, these squares tile all
pairs of steps once, so the result is that of the direct sum to rounding; N steps cost O(N log^2 N).
A kernel of fewer lags than b needs no larger squares, and no loads older than itself: then memory
does not grow with the steps. Source: E. Hairer, Ch. Lubich, M. Schlichte, SIAM J. Sci. Stat.
Comput. 6 (1985); docs/theory.md, History.
"""

from typing import TypeAlias

import numpy as np
from numpy import fft
from numpy.typing import NDArray

from ..step.system import Elastic, State

Complex: TypeAlias = NDArray[np.complex128]

BLOCK = 128
"""steps whose loads the time loop convolves itself: about where a block costs what its FFT does"""


class Window:
    """The steps whose loads are kept: twice `span`, of which the older half goes when they are
    full.
    """

    def __init__(self, elastic: Elastic) -> None:
        self.span = _power_above(int(elastic.kernels.lags.max(initial=0)))

    def kept(self, n_steps: int) -> int:
        """How many steps a run of n_steps keeps the loads of, at a time, t = 0 included."""
        return min(n_steps, 2 * self.span) + 1

    def make_room(self, n: int, state: State) -> None:
        """For what comes after step n."""
        if n - state.past.first[0] == 2 * self.span:
            for rows in (state.past.p, state.past.u_ahead):
                rows[:, : self.span + 1] = rows[:, self.span : 2 * self.span + 1]
                rows[:, self.span + 1 :] = 0.0
            state.past.first[0] += self.span


class Lookahead:
    """Keeps `state.past.u_ahead` for a run."""

    def __init__(self, elastic: Elastic) -> None:
        self._elastic = elastic
        self._looking = np.flatnonzero(elastic.kernels.by_fft).tolist()
        self._window = Window(elastic)
        self._spectra: dict[tuple[int, int], Complex] = {}

    def room(self, step: int, n: int) -> int:
        """How many steps, up to n, may follow `step` before `look` is called."""
        if self._looking:
            n = min(n, BLOCK - step % BLOCK)
        elif self._elastic.kernels.lags.any():
            n = min(n, self._window.span - step % self._window.span)
        return n

    def look(self, state: State) -> None:
        """Take in the loads up to the last step, and let go of those too old to be felt."""
        n = int(state.step[0])
        self._window.make_room(n, state)
        if n > 0 and n % BLOCK == 0:
            for e in self._looking:
                block = min(n & -n, _power_above(int(self._elastic.kernels.lags[e])))
                self._convolve(e, n, block, state)
                state.past.since[e] = n + 1

    def _convolve(self, e: int, n: int, block: int, state: State) -> None:
        elastic = self._elastic
        active = elastic.active[elastic.active_range[e] : elastic.active_range[e + 1]]
        own = slice(elastic.dof[e], elastic.dof[e + 1])
        now = n - int(state.past.first[0])
        loads = fft.rfft(state.past.p[active, now - block + 1 : now + 1], 2 * block)
        columns = self._spectrum(e, block)[:, active - own.start]
        response = fft.irfft(np.einsum("ikf,kf->if", columns, loads), 2 * block)[:, block:]
        ahead = state.past.u_ahead[own, now + 1 : now + 1 + block]
        ahead += response[:, : ahead.shape[1]]

    def _spectrum(self, e: int, block: int) -> Complex:
        """The transform of the first 2 block lags of body e, (n_c, n_c, block + 1)."""
        key = int(self._elastic.kernels.g_start[e]), block
        if key not in self._spectra:
            n_c = int(self._elastic.dof[e + 1] - self._elastic.dof[e])
            lags = int(self._elastic.kernels.lags[e])
            g = self._elastic.kernels.g[key[0] : key[0] + n_c * n_c * lags].reshape(n_c, n_c, lags)
            self._spectra[key] = fft.rfft(g[:, :, ::-1][:, :, : 2 * block], 2 * block)
        return self._spectra[key]


def _power_above(lags: int) -> int:
    """The smallest block that reaches over so many lags."""
    block = BLOCK
    while block < lags:
        block *= 2
    return block
