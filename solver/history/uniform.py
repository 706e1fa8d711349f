"""Convolution of past loads by FFT in equal blocks, with equal work in every step: for real time.

    ahead[k B + a] = sum_{q >= 2} sum_c g[q B + a - c] p[(k - q) B + c],    a, c = 1 .. B

The time loop sums the last B to 2 B loads itself, so the older ones that block k needs are known B
steps before it begins; its uniformly partitioned products of spectra are spread over B slots, one
after each step. A step costs n_c n_a times (1.5 B in the loop + lags / B in spectra); all steps the
same. Source: T. G. Stockham, AFIPS 28 (1966), in partitions; docs/theory.md, History.
"""

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np
from numpy import fft
from numpy.typing import NDArray

from ..arrays import Array
from ..step.records.elastic import Elastic
from ..step.system import State
from . import dyadic

Complex: TypeAlias = NDArray[np.complex128]


class UniformConvolution:
    """Updates `state.past.u_ahead` during a run whose steps prepare the next one at their end."""

    def __init__(self, elastic: Elastic) -> None:
        self._block = dyadic.DIRECT_STEPS
        self._window = dyadic.Window(elastic)
        self._bodies = [
            _BodyConvolution(elastic, e, self._block)
            for e in np.flatnonzero(elastic.kernels.by_fft).tolist()
        ]

    def update(self, state: State) -> None:
        """Run the slot of step n, which has prepared step n + 1, for the next block."""
        n, block = int(state.step[0]), self._block
        # Step n + 1 has been prepared already, and its row is in use.
        self._window.shift(n + 1, state)
        for body in self._bodies:
            if n % block == 0:
                body.plan(n // block + 1)
            body.run_slot(n % block, state)
            if (n + 1) % block == 0:
                state.past.since[body.number] = n + 2 - block

    def saved(self) -> dict[str, Array]:
        """Copies of what the slots that have run have left, by name."""
        return {
            f"{body.number}/{name}": array.view(np.float64).copy()
            for body in self._bodies
            for name, array in body.kept.items()
        }

    def load(self, n: int, saved: Mapping[str, Array]) -> None:
        """Go back to what `saved` gave after step n."""
        for body in self._bodies:
            prefix = f"{body.number}/"
            kept = {
                name.removeprefix(prefix): array.view(np.complex128).copy()
                for name, array in saved.items()
                if name.startswith(prefix)
            }
            body.load(n // self._block + 1, kept)


class _BodyConvolution:
    """The convolution of one flexible body."""

    def __init__(self, elastic: Elastic, e: int, block: int) -> None:
        self.number = e
        self._block = block
        self._dofs = slice(int(elastic.dof[e]), int(elastic.dof[e + 1]))
        self._loaded = elastic.loaded[elastic.loaded_range[e] : elastic.loaded_range[e + 1]]
        self._spectra = _spectra(elastic, e, self._loaded - self._dofs.start, block)
        self._loads: dict[int, Complex] = {}
        self._tasks: list[Callable[[State], None]] = []
        self._sum: Complex = np.empty((len(self._loaded), 0), dtype=np.complex128)

    def plan(self, k: int) -> None:
        """List the tasks of block k, to be run in the slots of block k - 1.

        They transform the loads of block k - 2, add the products of spectra, and transform back.
        """
        n_c, _, n_f = self._spectra.shape[1:]
        self._sum = np.zeros((n_c, n_f), dtype=np.complex128)
        self._tasks = []
        if k >= 2 and len(self._spectra):
            self._tasks.append(lambda state: self._transform(k - 2, state))
            self._tasks += [
                self._product_task(k - 2 - i, i) for i in range(min(k - 1, len(self._spectra)))
            ]
            self._tasks.append(lambda state: self._transform_back(k, state))

    @property
    def kept(self) -> dict[str, Complex]:
        """The sum of the present block, and the transforms of loads by their blocks."""
        return {"sum": self._sum} | {str(j): loads for j, loads in self._loads.items()}

    def load(self, k: int, kept: Mapping[str, Complex]) -> None:
        """Go back to what was `kept` while block k was being made ready."""
        self.plan(k)
        loads = dict(kept)
        self._sum = loads.pop("sum")
        self._loads = {int(j): transform for j, transform in loads.items()}

    def run_slot(self, slot: int, state: State) -> None:
        """Run the tasks of one step of a block, slot = 0 .. B - 1."""
        n = len(self._tasks)
        # Integer division spreads n tasks evenly over the slots, each run once.
        for task in self._tasks[slot * n // self._block : (slot + 1) * n // self._block]:
            task(state)

    def _transform(self, j: int, state: State) -> None:
        first = j * self._block + 1 - int(state.past.first[0])
        self._loads[j] = fft.rfft(
            state.past.p[self._loaded, first : first + self._block], 2 * self._block
        )
        # Loads older than the kernel are needed no more.
        self._loads.pop(j - len(self._spectra), None)

    def _product_task(self, j: int, i: int) -> Callable[[State], None]:
        def add(_: State) -> None:
            self._sum += np.einsum("ikf,kf->if", self._spectra[i], self._loads[j])

        return add

    def _transform_back(self, k: int, state: State) -> None:
        first = k * self._block + 1 - int(state.past.first[0])
        ahead = state.past.u_ahead[self._dofs, first : first + self._block]
        ahead += fft.irfft(self._sum, 2 * self._block)[:, self._block :][:, : ahead.shape[1]]


def _spectra(elastic: Elastic, e: int, columns: NDArray[np.int64], block: int) -> Complex:
    """Transforms of the lags (q - 1) B to (q + 1) B - 1, q = 2, 3, ...: (n_q, n_c, n_a, B + 1)."""
    lags, start = int(elastic.kernels.lags[e]), int(elastic.kernels.g_start[e])
    n_c = int(elastic.dof[e + 1] - elastic.dof[e])
    reversed_lags = elastic.kernels.g[start : start + n_c * n_c * lags].reshape(n_c, n_c, lags)
    g: Array = reversed_lags[:, columns, ::-1]
    spectra = [
        fft.rfft(g[:, :, first : first + 2 * block], 2 * block)
        for first in range(block, lags - 1, block)
    ]
    shape = len(spectra), n_c, len(columns), block + 1
    return np.array(spectra, dtype=np.complex128).reshape(shape)
