"""The reaction of an FMU within a step: the slopes of its outputs by the coordinates it gets.

The reaction over a step, d(output at t + H)/d(input at t), is what Newton's method needs. It is
measured where the state of the FMU can be saved: by the same step once more, from the same state,
with a changed input. Without that the FMU's own directional derivatives stand for it, which leave
out what its states do within the step. Source: docs/theory.md, FMUs.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..arrays import Array
from ..model.fmus import FMU, Reaction
from .instance import FMUInstance

# steps after which slopes are measured again in any case
MAX_AGE = 64
# of the change that the slopes foretell: beyond, they are measured again
MAX_DRIFT = 0.1
# Without a change, drifts are dynamics of the FMU: they are believed less often then.
MAX_WAIT = 16
# The change of an input: that of the last step, but no less than this, relative or in rad and m.
LEAST_CHANGE = 1e-6


class Slopes:
    """The slopes of the outputs of an FMU by joint coordinates and their rates.

    reactions: on which motors; `gains` (n, 2): the slopes by the coordinate and by its rate.
    """

    def __init__(self, instance: FMUInstance, reactions: Sequence[Reaction]) -> None:
        self._instance, self.reactions = instance, tuple(reactions)
        description = instance.description
        inputs = [one.name for one in description.inputs]
        outputs = [one.name for one in description.outputs]
        self._outputs = [outputs.index(one.output) for one in self.reactions]
        self._inputs = [
            [inputs.index(name) if name else -1 for name in (one.angle, one.rate)]
            for one in self.reactions
        ]
        self._asked = sorted({i for pair in self._inputs for i in pair if i >= 0})
        self.gains = np.zeros((len(self.reactions), 2))
        self._table = np.zeros((len(outputs), len(inputs)))
        self._pace = np.zeros(2)
        """steps since they were measured; steps until a drift is believed"""

    @property
    def memory(self) -> list[Array]:
        """What a run carries on."""
        return [self.gains, self._table, self._pace]

    def step(self, t: float, h: float, before: Array, inputs: Array, start: Array) -> Array:
        """A step as `FMUInstance.step` takes it, and the slopes over it.

        before: inputs (n,) of the last step; start: outputs (n,) at its end.
        """
        if not self._instance.description.saves:
            end = self._instance.step(t, h, inputs)
            self._derive()
            return end
        if self._pace[0] == 0.0 or self._pace[0] >= MAX_AGE:
            return self._measured(t, h, before, inputs)
        with self._instance.saved() as state:
            end = self._instance.step(t, h, inputs)
            foretold = self._table @ (inputs - before)
            drift = np.abs(end - start - foretold) > MAX_DRIFT * np.abs(foretold)
            if self._pace[0] >= self._pace[1] and drift[self._outputs].any():
                self._instance.restore(state)
                return self._measured(t, h, before, inputs)
        self._pace[0] += 1.0
        return end

    def _measured(self, t: float, h: float, before: Array, inputs: Array) -> Array:
        """A step, with changed inputs first, so that the FMU ends where it should."""
        earlier = self.gains.copy()
        with self._instance.saved() as state:
            ends: dict[int, Any] = {}
            for i in self._asked:
                change = inputs[i] - before[i]
                least = LEAST_CHANGE * max(abs(inputs[i]), 1.0)
                change = change if abs(change) > least else least
                changed = inputs.copy()
                changed[i] += change
                ends[i] = self._instance.step(t, h, changed), changed[i] - inputs[i]
                self._instance.restore(state)
        end = self._instance.step(t, h, inputs)
        for i, (other, change) in ends.items():
            self._table[:, i] = (other - end) / change
        self._take_gains()
        has_changed = np.abs(self.gains - earlier) > MAX_DRIFT * np.abs(earlier)
        self._pace[1] = 1.0 if has_changed.any() else min(2.0 * self._pace[1] + 1.0, MAX_WAIT)
        self._pace[0] = 1.0
        return end

    def reaction(self, change: Array) -> Array:
        """What a change (n,) of the inputs adds to the outputs (n,) at once."""
        added = np.zeros(len(self._table))
        for output, pair, gains in zip(self._outputs, self._inputs, self.gains, strict=True):
            added[output] = sum(g * change[i] for g, i in zip(gains, pair, strict=True) if i >= 0)
        return added

    def _derive(self) -> None:
        for output, pair, reaction in zip(self._outputs, self._inputs, self.reactions, strict=True):
            own = [i for i in pair if i >= 0]
            names = [name for name in (reaction.angle, reaction.rate) if name]
            self._table[output, own] = self._instance.derivative(reaction.output, names)
        self._take_gains()

    def _take_gains(self) -> None:
        for k, (output, pair) in enumerate(zip(self._outputs, self._inputs, strict=True)):
            self.gains[k] = [self._table[output, i] if i >= 0 else 0.0 for i in pair]


def check_slopes(fmu: FMU, instance: FMUInstance) -> None:
    """ModelError for an FMU whose slopes cannot be known."""
    description = instance.description
    if not (description.saves or description.derives):
        raise fmu.error(
            f'coupling: "slope" needs an FMU that can save its state (canGetAndSetFMUState) or '
            f"gives directional derivatives; {fmu.file} does neither"
        )
