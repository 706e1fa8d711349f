"""One step at a time, for inputs that are known only when the step is due.

For controllers, co-simulation and real time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from .arrays import Array
from .errors import ModelError, about
from .history.uniform import Partitions
from .lower.allocation import make_output
from .model.model import Model
from .model.settings import Settings
from .model.signals import Input
from .output.columns import views
from .simulation import failure, signals
from .start.initial import initialize
from .step.loop import advance
from .step.record import record
from .step.system import Inputs, Run

AHEAD = 256
"""steps for which the signals that are no inputs are sampled at once"""


class Simulator:
    """A model from t = 0 to t_end, with the values of its `Input` signals given step by step.

        simulator = Simulator(model, outputs=["joints/pivot/angle", "frames/beam.tip/position"])
        while True:
            simulator.step([controller(simulator.outputs)])

    `step` takes the values at the end of the step, in the order of `inputs`. Loads are linear
    between them: a force that is to be held from one step to the next acts half a step early, with
    the same impulse. As much of a step as goes before they are known is done at the end of the one
    before: its free response, its prediction, and the factors of the matrix where the iterations
    are fixed (`Settings.fixed_iterations`), with which all steps cost about the same. History "fft"
    is convolved in equal parts, one a step, not in the growing blocks of `simulate`.

    `outputs` (n,) are the chosen quantities of results, one after the other, at the present `time`;
    `views` has those of each name, in arrays that every step changes. They are those of `simulate`.

    Raises ModelError for a model that cannot start, an output that there is not, a wrong number of
    inputs and a step beyond t_end; ConvergenceError where Newton's method fails, and then there are
    no further steps.
    """

    def __init__(
        self, model: Model, outputs: Sequence[str], settings: Settings | None = None
    ) -> None:
        if settings is not None:
            model = replace(model, settings=settings)
        with about(model.path):
            initial = initialize(model)
            lowered, state = initial.lowered, initial.state
            output = make_output(lowered, 1)
            parts = {name: views(lowered, name, output) for name in outputs}
        self._parts = [part for name in outputs for part in parts[name]]
        self._outputs = np.zeros(sum(map(len, self._parts)))
        lengths = [sum(map(len, parts[name])) for name in outputs]
        pieces = np.split(self._outputs, np.cumsum(lengths)[:-1]) if outputs else []
        self.views: Mapping[str, Array] = dict(zip(outputs, pieces, strict=True))
        """the chosen outputs by name, each (n,)"""
        self._lowered, self._state, self._work = lowered, state, initial.work
        self._run = Run(system=lowered.system, state=state, work=initial.work, output=output)
        given = [*lowered.load_signals, *lowered.drives]
        self.inputs = tuple(dict.fromkeys(s.name for s in given if isinstance(s, Input)))
        """the names of the inputs"""
        load, drive = np.zeros((1, len(lowered.load_signals))), np.zeros((1, len(lowered.drives)))
        self._load, self._drive = load[0], drive[0]
        self._destinations = [
            (values, i, self.inputs.index(signal.name))
            for values, kind in ((self._load, lowered.load_signals), (self._drive, lowered.drives))
            for i, signal in enumerate(kind)
            if isinstance(signal, Input)
        ]
        """(array, index in it, number of the input)"""
        self._all_are_inputs = all(isinstance(signal, Input) for signal in given)
        row = np.zeros(1, dtype=np.int64)
        self._next = Inputs(load=load, drive=drive, row=row, ahead=1)
        self._last = self._next.replace(ahead=0)
        self._partitions = Partitions(lowered.system.elastic)
        self._number, self._n_steps, self._h = 0, lowered.n_steps, lowered.h
        record(self._run, 0)
        advance(self._run, Inputs(load=load[:0], drive=drive[:0], row=row[:0], ahead=1))
        self._gather()

    @property
    def time(self) -> float:
        """[s]"""
        return self._h * self._number

    @property
    def outputs(self) -> Array:
        """(n,)"""
        return self._outputs.copy()

    def step(self, inputs: Any) -> Array:
        """Take a step with the values (n,) of the inputs at its end; the outputs there."""
        if len(inputs) != len(self.inputs):
            values = np.asarray(inputs, dtype=np.float64).tolist()
            raise ModelError(f"inputs: expected values of {list(self.inputs)}, got {values}")
        number = self._number + 1
        if number > self._n_steps:
            t_end = self._lowered.model.settings.t_end
            raise ModelError(f"t_end = {t_end:.9g} s has been reached")
        if not self._all_are_inputs:
            self._set_signals(number)
        for values, i, k in self._destinations:
            values[i] = inputs[k]
        # a kernel ends with the run
        last = number == self._n_steps
        taken, residual = advance(self._run, self._last if last else self._next)
        if not taken:
            raise failure(self._lowered, number, residual, self._work)
        self._number = number
        self._partitions.work(self._state)
        return self._gather()

    def _gather(self) -> Array:
        if self._parts:
            np.concatenate(self._parts, out=self._outputs)
        return self._outputs.copy()

    def _set_signals(self, number: int) -> None:
        """The signals of step `number` that are no inputs, sampled for many steps at once."""
        k = (number - 1) % AHEAD
        if k == 0:
            n = min(AHEAD, self._n_steps - number + 1)
            self._sampled = signals(self._lowered, number, np.zeros(n, dtype=np.int64))
        self._load[:] = self._sampled.load[k]
        self._drive[:] = self._sampled.drive[k]
