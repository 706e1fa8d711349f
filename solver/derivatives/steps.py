"""Steps with derivatives: those of two sizes, and histories that are convolved between them."""

from collections.abc import Mapping
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy import fft

from ..arrays import Array, Index
from ..checkpoint.carried import Arrays
from ..history.dyadic import Complex, DyadicConvolution
from ..lower.lower import LoweredModel
from ..phases import Phases
from ..step.loop import advance, is_contact_near
from ..step.sizes import change_size
from ..step.system import Inputs, Run
from .records import DualRecord, entry_symbol, entry_with_derivatives


def live_state(run: DualRecord) -> Any:
    """What Python reads and writes of the state between steps, as `State` has it."""
    past = {name: run.arrays[f"state/past/{name}"] for name in ("p", "u_ahead", "first", "since")}
    own = {name: run.arrays[f"state/{name}"] for name in ("step", "in_flight")}
    return SimpleNamespace(past=SimpleNamespace(**past), **own)


class DualPhases(Phases):
    """Steps of one or two sizes; signals: the derivatives (steps, ..., k) of inputs by name."""

    def __init__(
        self,
        lowered: LoweredModel,
        plain: Run,
        runs: tuple[DualRecord, DualRecord],
        k: int,
        signals: Mapping[str, Array],
    ) -> None:
        super().__init__(lowered, plain.state, plain.work, plain.output)
        self._records, self._k, self._signals = runs, k, signals
        self._state = live_state(runs[0])
        entries = (advance, change_size, is_contact_near)
        self._advance, self._change, self._near = (
            entry_with_derivatives(entry_symbol(one), k, bool(lowered.model.surface_contacts))
            for one in entries
        )

    @cached_property
    def _live(self) -> Arrays:
        arrays = self._records[0].arrays
        return {name: a for name, a in arrays.items() if name.startswith(("state/", "work/"))}

    def _take(self, in_flight: int, inputs: Inputs) -> tuple[int, float]:
        stride = self._lowered.ratio if in_flight else 1
        steps = self._state.step[0] + stride * np.arange(1, len(inputs.load) + 1)
        seeds = {name: array[steps - 1] for name, array in self._signals.items()}
        given = DualRecord(inputs, self._k, seeds)
        taken, residual, *_ = self._advance(self._records[in_flight], given)
        return int(taken), residual

    def _change_size(self, in_flight: int) -> None:
        old, new = self._records[1 - in_flight], self._records[in_flight]
        self._change(old.part("system"), *(new.part(one) for one in ("system", "state", "work")))

    def _is_contact_near(self) -> bool:
        system, state, work = (self._records[0].part(one) for one in ("system", "state", "work"))
        return bool(self._near(system, self._lowered.longest_step, state, work)[0])


class DualConvolution(DyadicConvolution):
    """Convolution of past loads; g (..., 1 + k): the kernels. Both may have derivatives."""

    def __init__(self, lowered: LoweredModel, g: Array) -> None:
        super().__init__(lowered.system.elastic)
        # Next to always the same for all parameters.
        self._g = g if g[:, 1:].any() else g[:, :1]

    def _response(self, e: int, block: int, loaded: Index, p: Array) -> Array:
        columns = self._spectrum(e, block)[:, loaded]
        loads = fft.rfft(p, 2 * block, axis=1)
        response = np.einsum("ikf,kfn->ifn", columns[..., 0], loads)
        if columns.shape[-1] > 1:
            response[..., 1:] += np.einsum("ikfn,kf->ifn", columns[..., 1:], loads[..., 0])
        return fft.irfft(response, 2 * block, axis=1)[:, block:]

    def _transform(self, first: int, n_c: int, lags: int, block: int) -> Complex:
        g = self._g[first : first + n_c * n_c * lags].reshape(n_c, n_c, lags, -1)
        return fft.rfft(g[:, :, ::-1][:, :, : 2 * block], 2 * block, axis=2)
