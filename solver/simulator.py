"""One step at a time, for inputs that are known only when the step is due: controllers,
co-simulation, real time.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .arrays import Array, Index, as_index
from .errors import ModelError, about
from .history.uniform import Partitions
from .model.model import Model
from .model.signals import Input, Signal
from .output.columns import make_output, views
from .simulation import failure
from .start.initial import begin
from .step.loop import advance, record
from .step.system import Inputs


class Simulator:
    """A model from t = 0 to t_end, with the values of its `Input` signals given step by step.

        simulator = Simulator(model, outputs=["joints/pivot/angle", "frames/beam.tip/position"])
        while True:
            simulator.step([controller(simulator.outputs)])

    `step` takes the values at the end of the step, in the order of `inputs`. Loads are linear
    between them: a force that is to be held from one step to the next acts half a step early, with
    the same impulse. What the next step can do before they are known is done at the end of the one
    before: to recall the past, to predict, to factor the matrix of a given number of `corrections`,
    with which all steps cost about the same. History "fft" is convolved in equal parts, one a step,
    not in the growing blocks of `simulate`. `outputs` (n,) are the chosen quantities of results,
    one after the other, at the present `time`; they are those of `simulate`.

    Raises ModelError for a model that cannot start, an output that there is not, a wrong number of
    inputs and a step beyond t_end; ConvergenceError where Newton's method fails, and then there are
    no further steps.
    """

    def __init__(self, model: Model, outputs: Sequence[str]) -> None:
        with about(model.path):
            beginning = begin(model)
            compiled, self._state, self._work = beginning.compiled, beginning.state, beginning.work
            self._output = make_output(compiled, 1)
            self._parts = views(compiled, outputs, self._output)
        self._compiled, self._quaternions = compiled, compiled.frame_quaternions
        signals: list[Signal] = [*compiled.load_signals, *compiled.drives]
        self.inputs = tuple(
            dict.fromkeys(signal.name for signal in signals if isinstance(signal, Input))
        )
        """the names of the inputs"""
        load, drive = np.zeros((1, len(compiled.load_signals))), np.zeros((1, len(compiled.drives)))
        self._load, self._drive = load[0], drive[0]
        self._load_inputs = _places(compiled.load_signals, self.inputs)
        self._drive_inputs = _places(compiled.drives, self.inputs)
        self._signals = Inputs(load, drive, np.zeros(1, dtype=np.int64), ahead=1)
        self._partitions = Partitions(compiled.system.elastic)
        record(compiled.system, self._quaternions, 0, self._state, self._work, self._output)
        self._advance(Inputs(load[:0], drive[:0], as_index([]), ahead=1))
        self._foresee(1)

    @property
    def time(self) -> float:
        """[s]"""
        return self._compiled.h * float(self._state.step[0])

    @property
    def outputs(self) -> Array:
        """(n,)"""
        return np.concatenate(self._parts)

    def step(self, inputs: Any) -> Array:
        """Take a step with the values (n,) that the inputs have at its end; return the outputs
        there.
        """
        values = np.asarray(inputs, dtype=np.float64)
        if values.shape != (len(self.inputs),):
            raise ModelError(
                f"inputs: expected values of {list(self.inputs)}, got {values.tolist()}"
            )
        number = int(self._state.step[0]) + 1
        if number > self._compiled.n_steps:
            raise ModelError(f"t_end = {self._compiled.model.t_end:.9g} s has been reached")
        for array, (places, given) in (
            (self._load, self._load_inputs),
            (self._drive, self._drive_inputs),
        ):
            array[places] = values[given]
        # a kernel ends with the run
        last = number == self._compiled.n_steps
        taken, residual = self._advance(self._signals._replace(ahead=0) if last else self._signals)
        if not taken:
            raise failure(self._compiled, number, residual, self._work)
        self._partitions.work(self._state)
        self._foresee(number + 1)
        return self.outputs

    def _advance(self, inputs: Inputs) -> tuple[int, float]:
        return advance(
            self._compiled.system, self._quaternions, inputs, self._state, self._work, self._output
        )

    def _foresee(self, number: int) -> None:
        """The signals of step `number` that are no inputs."""
        h = self._compiled.h
        for i, load in enumerate(self._compiled.load_signals):
            if not isinstance(load, Input):
                self._load[i] = load.samples(np.array([h * number]), h)[0]
        for i, drive in enumerate(self._compiled.drives):
            if not isinstance(drive, Input):
                self._drive[i] = drive(h * number)


def _places(signals: Sequence[Signal], inputs: tuple[str, ...]) -> tuple[Index, Index]:
    """Which of the signals are inputs, and which of the inputs each of these is."""
    found = [
        (i, inputs.index(signal.name))
        for i, signal in enumerate(signals)
        if isinstance(signal, Input)
    ]
    return as_index([i for i, _ in found]), as_index([k for _, k in found])
