"""Simulations step by step, for controllers, co-simulation and real time."""

import os
import warnings
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..results.batches import Batch, Energies
from ..results.motion import Energy, Events
from ..results.results import Results
from ..results.validity import Validity
from .arrays import Array
from .checkpoint.carried import FMUS_PREFIX, Snapshot, carried, with_prefix
from .checkpoint.saved_state import SavedState
from .errors import ModelError, ValidityWarning, about
from .history.uniform import UniformConvolution
from .model.model import Model
from .model.settings import Settings
from .output.branches import Branches
from .output.chatter import ENOUGH_STEPS, MIN_SWING_STEPS, chatters
from .output.columns import axes_of, views
from .output.events import waiting
from .output.passages import check_passages, check_resolution
from .output.recording import Recording
from .output.validity import ValidityMonitor, check_range
from .output.writer import check_output
from .signals.curves import Input
from .simulation import failure, signals, start_warnings
from .step.loop import advance
from .step.record import record
from .stepper import Stepper

# Signals that are no inputs are sampled at once for so many steps, and inputs are checked as often.
STEPS_AHEAD = 256
LAST, GROWTH = 8, 10.0
"""of the last steps before a failure, in which swings of an input grew by more than this factor"""
PAST_PREFIX = "past/"
"""names of the arrays of the convolution begin with it"""


class Simulator:
    """A model from t = 0 to t_end, with the values of its `Input` signals given step by step.

    `step` takes the values at the end of the step, in the order of `inputs`. Loads are linear
    between them: a force that is to be held from one step to the next acts half a step early, with
    the same impulse. The end of a step prepares the next one as far as it does not depend on them:
    its free response, its prediction, and the factors of the matrix where the iterations are fixed
    (`Settings.fixed_iterations`), with which all steps cost about the same. History "fft" is
    convolved in equal blocks, not in the growing ones of `simulate`.

    `outputs` (n,) are the chosen quantities of results, one after the other, at the present `time`;
    `views` has those of each name, in arrays that every step changes. They are those of `simulate`.

    Use it in a `with` block, or call `finish`, to end the results file. After an error there are no
    further steps but from an earlier state: `save` gives the present one, `restore` goes back.

    Parameters
    ----------
    model : Model
    outputs : sequence of str
        As "joints/pivot/angle" or "frames/beam.tip/position".
    settings : Settings, optional
        By default those of the model.
    results : path, optional
        A results file, as `simulate` writes it; by default none. `energy` and `validity` are there
        without it too. Time in a file only advances: there is no `restore` with it.

    Raises
    ------
    ModelError
        For a model that cannot start, an unknown output, a wrong number of inputs, and a step
        beyond t_end.
    ConvergenceError
        Where Newton's method fails.
    OutOfRangeError
        Where a body deforms too far for linear elasticity.
    MissedContactError
        Where a ball passes through a shape in one step.

    Warns
    -----
    ValidityWarning
        At the start as `simulate` does; at the end of limits of the method that were passed; and at
        once of an input that changes direction at every step, as that of a controller does whose
        gains are too large for its delay.

    Examples
    --------
    >>> from duhamel.solver import Force, Input, Model, RigidBody, Settings
    >>> push = Force("ball", [1.0, 0.0, 0.0], Input("push"))
    >>> model = Model({"ball": RigidBody(1.0, [0.1] * 3)}, loads=[push],
    ...               settings=Settings(t_end=1.0, step=0.1))
    >>> with Simulator(model, ["bodies/ball/v"]) as simulator:
    ...     while simulator.time < 0.95:
    ...         velocity = simulator.step([1.0 - simulator.outputs[0]])
    >>> bool(0.5 < velocity[0] < 0.7)
    True
    """

    def __init__(
        self,
        model: Model,
        outputs: Sequence[str],
        settings: Settings | None = None,
        *,
        results: str | os.PathLike[str] | None = None,
    ) -> None:
        if settings is not None:
            model = replace(model, settings=settings)
        path = None if results is None else Path(results)
        if path is not None:
            check_output(path, model)
        # Inputs of one step at a time cannot be taken back.
        if model.settings.contact_step is not None:
            with about(model.path):
                raise ModelError("simulation: contact_step: a Simulator takes steps of one size")
        stepper = Stepper(model, outputs)
        lowered, initial, run = stepper.lowered, stepper.initial, stepper.run
        state, output = run.state, run.output
        sources = {name: views(lowered, name, output) for name in outputs}
        with about(model.path):
            self._recording = None if path is None else Recording(path, initial)
        for line in start_warnings(initial):
            warnings.warn(line, ValidityWarning, stacklevel=2)
        self._sources = [view for name in outputs for view in sources[name]]
        self._outputs = np.zeros(sum(map(len, self._sources)))
        lengths = [sum(map(len, sources[name])) for name in outputs]
        ranges = np.split(self._outputs, np.cumsum(lengths)[:-1]) if outputs else []
        self.views: Mapping[str, Array] = dict(zip(outputs, ranges, strict=True))
        """the chosen outputs by name, each (n,)"""
        self._lowered, self._state, self._work = lowered, state, run.work
        self._removed, self._contacts = initial.removed, state.contacts
        self._run = run
        self.inputs = stepper.input_names
        """the names of the inputs"""
        self._next, self._last = stepper.inputs, stepper.last
        self._destinations = [
            (place, self.inputs.index(signal.name))
            for place, signal in stepper.signals
            if isinstance(signal, Input) and signal.name in self.inputs
        ]
        """(its place, number of the input)"""
        self._exchange = stepper.exchange
        self._all_are_inputs = len(self._destinations) == len(stepper.signals)
        self._convolution = UniformConvolution(lowered.system.elastic)
        self._number, self._n_steps, self._h = int(state.step[0]), lowered.n_steps, lowered.h
        self._live = carried(state=state, work=run.work, output=output)
        self._sampled_from = 0
        self._begin, self._output, self._has_ended = self._number, output, False
        self._branches, self._has_warned = Branches(lowered), False
        self._chattering: set[str] = set()
        self._told: deque[tuple[float, ...]] = deque(maxlen=STEPS_AHEAD)
        record(self._run, 0)
        self._keep_given()
        self._start = Energies.of(output)
        # The free response of the first step is made before its inputs are known.
        advance(self._run, stepper.first)
        self._gather()

    @property
    def time(self) -> float:
        """The present time [s]."""
        return self._h * self._number

    @property
    def outputs(self) -> Array:
        """The chosen outputs at the present time (n,)."""
        return self._outputs.copy()

    @property
    def events(self) -> dict[str, Events]:
        """The contacts and stops that opened in the last step, by name; each one or none."""
        names = axes_of(self._lowered)["event_owner"].names
        return Events.by_owner(waiting(self._state), names)

    def step(self, inputs: Any) -> Array:
        """Take a step with the values (n,) of the inputs at its end; return the outputs there."""
        if len(inputs) != len(self.inputs):
            values = np.asarray(inputs, dtype=np.float64).tolist()
            raise ModelError(f"inputs: expected values of {list(self.inputs)}, got {values}")
        number = self._number + 1
        if self._recording is not None:
            # not earlier, since it takes the events, which are those of the last step until now
            self._recording.keep(self._number, self._output)
        self._contacts.n_events[0] = 0
        if self._has_ended:
            raise ModelError("step: finish has already ended the results")
        if number > self._n_steps:
            t_end = self._lowered.model.settings.t_end
            raise ModelError(f"t_end = {t_end:.9g} s has been reached")
        if not self._all_are_inputs:
            self._set_signals(number)
        for place, k in self._destinations:
            place[0] = inputs[k]
        if self._exchange:
            self._exchange.exchange()
            self._exchange.fill(self._next, slice(0, 1), np.array([number]))
        self._told.append(tuple(inputs))
        # a kernel ends with the run
        last = number == self._n_steps
        # The last step prepares none: a kernel ends with the run.
        taken, residual = advance(self._run, self._last if last else self._next)
        check_passages(self._lowered, self._state, self._work, number - 1)
        check_resolution(self._lowered, self._state, number)
        check_range(self._lowered, self._state, number)
        if not taken:
            cause = self._growing_input() or ValidityMonitor(self._lowered).cause(
                self._state, number - 1
            )
            raise failure(self._lowered, self._state, self._work, number, residual, cause)
        self._number = number
        self._keep_given()
        self._branches.check(self._work, number)
        if last or number % STEPS_AHEAD == 0:
            self._removed.check(self._work, self.time)
            self._check_inputs(STEPS_AHEAD)
        self._convolution.update(self._state)
        if last:
            self._warn_of_limits()
        return self._gather()

    @property
    def energy(self) -> Energy:
        """The energies at the present time, each (1,) [J], as those of results."""
        batch = Batch(np.array([self._number]), self._h, self._output, self._start)
        return Energy({one.attribute: one.take(batch, {}) for one in Energy.quantities})

    @property
    def validity(self) -> Validity:
        """How far the steps until now can be trusted, as that of results."""
        return ValidityMonitor(self._lowered).validity(self._state, self._number - self._begin)

    def finish(self) -> Results:
        """End the results file, at t_end or before, and open it; there are no further steps."""
        if self._recording is None:
            raise ModelError("finish: this Simulator writes no results: expected results = FILE")
        self._recording.keep(self._number, self._output)
        results, self._recording = self._recording.finish(), None
        self._has_ended = True
        self._exchange.close()
        self._warn_of_limits()
        return results

    def __enter__(self) -> "Simulator":
        return self

    def __exit__(self, *failure: Any) -> None:
        self._exchange.close()
        if failure[1] is not None:
            if self._recording is not None:
                self._recording.keep(self._number, self._output)
                self._recording.abandon(*failure)
                self._recording = None
        elif self._recording is not None:
            self.finish()
        else:
            self._warn_of_limits()

    def save(self) -> SavedState:
        """The present state, to go back to.

        `ModelError` for an FMU that cannot serialize its own.
        """
        self._exchange.check_serializes("save")
        arrays = {name: array.copy() for name, array in self._live.items()}
        # Two namespaces in one dictionary of a snapshot: arrays of the loop and of the convolution.
        past = with_prefix(PAST_PREFIX, self._convolution.saved())
        beside = with_prefix(FMUS_PREFIX, self._exchange.saved())
        return SavedState(Snapshot(self._number, arrays | past | beside), self._lowered)

    def restore(self, state: SavedState) -> Array:
        """Go back, or forth, to a state that was saved; return the outputs there.

        All that follows is then to the bit what followed when it was saved. `StateError` for a
        state of another model, version or machine.
        """
        if self._recording is not None:
            raise ModelError("restore: expected a Simulator without a results file")
        state.check(self._lowered)
        own, past = state.snapshot.split(PAST_PREFIX)
        own, beside = own.split(FMUS_PREFIX)
        number = own.step
        # Into the arrays that compiled code points to: these are never replaced.
        own.put_back(self._live)
        self._convolution.load(number, past)
        self._exchange.load(beside)
        self._number, self._has_warned = number, False
        return self._gather()

    def _keep_given(self) -> None:
        """Let the outputs have what FMUs give at the present time."""
        at = np.zeros(1, dtype=np.int64), np.array([self._number])
        self._exchange.keep(self._output, *at)

    def _warn_of_limits(self) -> None:
        """Warn, once, of each limit that the steps until now have passed, and of inputs."""
        self._check_inputs(ENOUGH_STEPS)
        if not self._has_warned:
            self._has_warned = True
            for line in self.validity.brief():
                warnings.warn(line, ValidityWarning, stacklevel=3)

    def _check_inputs(self, enough: int) -> None:
        """Warn, once of each, of inputs that chattered in the last steps, if there are enough."""
        for name, values in zip(self.inputs, np.array(self._told).T, strict=False):
            if len(values) >= enough and name not in self._chattering and chatters(values):
                self._chattering.add(name)
                line = (
                    f"input {name!r} chatters: until t = {self.time:.6g} s it went up and down "
                    f"every {MIN_SWING_STEPS} steps or sooner, by {np.ptp(values[-8:]):.3g}, for "
                    f"{len(values)} steps: take smaller gains of its controller, or a smaller step"
                )
                warnings.warn(line, ValidityWarning, stacklevel=3)

    def _growing_input(self) -> str:
        """The input that went up and down ever farther before a failure, "" if none did."""
        for name, values in zip(self.inputs, np.array(self._told)[-LAST:].T, strict=True):
            sizes = np.abs(np.diff(values))
            if len(sizes) and chatters(values) and sizes[-1] > GROWTH * sizes[0]:
                return (
                    f"input {name!r} goes up and down, ever farther: take smaller gains of its "
                    f"controller, or a smaller step"
                )
        return ""

    def _gather(self) -> Array:
        if self._sources:
            np.concatenate(self._sources, out=self._outputs)
        return self._outputs.copy()

    def _set_signals(self, number: int) -> None:
        """Sample the signals of step `number` that are not inputs, for many steps at once."""
        k = (number - 1) % STEPS_AHEAD
        first = number - k
        # After `restore` the number may lie in another block.
        if first != self._sampled_from:
            n = min(STEPS_AHEAD, self._n_steps - first + 1)
            self._sampled = signals(self._lowered, first, np.zeros(n, dtype=np.int64))
            self._sampled_from = first
        self._next.load[0] = self._sampled.load[k]
        self._next.drive[0] = self._sampled.drive[k]
        self._next.motor[0] = self._sampled.motor[k]
