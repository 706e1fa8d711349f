"""The FMUs of a model beside its time loop: what they exchange with it, and when."""

import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Self

import numpy as np

from ...inputs.errors import did_you_mean
from ..arrays import Array, Index
from ..checkpoint.carried import Arrays, Snapshot
from ..errors import ModelError, StateError, about
from ..lower.allocation import make_output
from ..lower.lower import LoweredModel
from ..model.fmus import FMU
from ..output.columns import available, views
from ..phases import Phases
from ..step.events import is_full
from ..step.record import record
from ..step.system import Inputs, Output, Run, State, System, Workspace
from .unit import Unit

COMPONENT_OF_OUTPUT = re.compile(r"(?P<name>.*)\[(?P<number>[1-9]\d*)\]")
"""one of several numbers of an output of a step"""
SERIALIZED_STATE = "fmu"
"""the name of the state of an FMU among the arrays that a run carries on"""


class Exchange:
    """All FMUs of a model, from their start to `close`, to be used in a `with` block.

    Explicit coupling: at its communication points, from t to t + H, an FMU gets outputs at t, and
    its own outputs are inputs of the model at t + H. restartable: whether their states are to be
    kept in files. `ModelError` for an FMU that does not fit the model.
    """

    def __init__(self, lowered: LoweredModel, *, restartable: bool = False) -> None:
        self.model = lowered.model
        self.lowered = _with_own_gains(lowered) if self.model.fmus else lowered
        """the model, with gains of motors that change with the slopes of FMUs"""
        self._units: list[Unit] = []
        self._failure: ModelError | None = None
        try:
            for fmu in self.model.fmus:
                sources = [_source(fmu, name, lowered, self.row) for name in fmu.inputs.items()]
                self._units.append(Unit(fmu, lowered, sources))
            if restartable:
                self.check_serializes("simulation: checkpoint")
        except BaseException:
            self.close()
            raise
        ends = np.cumsum([0, *(len(unit.fmu.outputs) for unit in self._units)])
        self._columns = [slice(*pair) for pair in pairwise(ends.tolist())]

    @cached_property
    def row(self) -> Output:
        """The row of output from which the FMUs get theirs."""
        return make_output(self.lowered, 1)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *failure: Any) -> None:
        self.close()

    def __bool__(self) -> bool:
        return bool(self._units)

    def close(self) -> None:
        """End all FMUs."""
        for unit in self._units:
            with suppress(Exception):
                unit.instance.close()

    def bind(self, state: State, work: Workspace, *, recorded: bool = False) -> None:
        """Be beside a state; recorded: whether `row` is that of each step once it is taken."""
        self._state, self._is_recorded = state, recorded
        if self._units:
            self._run = Run(system=self.lowered.system, state=state, work=work, output=self.row)

    def start(self) -> dict[str, float]:
        """Initialize all FMUs; the inputs that they give, by name."""
        if self._units:
            record(self._run, 0)
        values: dict[str, float] = {}
        step = int(self._state.step[0])
        for unit in self._units:
            given = unit.start(step).tolist()
            values |= dict(zip(unit.fmu.outputs.values(), given, strict=True))
        return values

    def begin_from(self, values: Mapping[str, float]) -> None:
        """Let inputs begin at these values, by name, in place of those of the FMUs."""
        for unit in self._units:
            unit.begin_from(values)

    def advance(
        self, phases: Phases, inputs: Inputs, stride: int, output: Output
    ) -> tuple[int, float, bool]:
        """Take steps as `Phases.advance` does, with an exchange at each communication point."""
        if not self._units:
            return phases.advance(inputs)
        if self._failure is not None:
            raise self._failure
        done, n, residual = 0, len(inputs.load), 0.0
        while done < n:
            try:
                self.exchange()
            except ModelError as failure:
                # The steps before it are kept first.
                if not done:
                    raise
                self._failure = failure
                return done, residual, False
            first = int(self._state.step[0])
            # Communication points are multiples of the longer step: both sizes end there.
            k = min(n - done, *(unit.until_due(first) // stride for unit in self._units))
            rows, steps = slice(done, done + k), first + stride * np.arange(1, k + 1)
            self.fill(inputs, rows, steps)
            part = _rows(inputs, rows)
            taken, residual, failed = phases.advance(part)
            self.keep(output, part.row[:taken], steps[:taken])
            done += taken
            # With one step to a part, a part may be whole though the loop stopped.
            if taken < k or failed or self._must_stop():
                return done, residual, failed
        return done, residual, False

    def exchange(self) -> None:
        """Let the FMUs whose communication point this is get and give what is due."""
        step = int(self._state.step[0])
        if any(unit.is_due(step) for unit in self._units):
            self._look(step)
            with about(self.model.path):
                for unit in self._units:
                    unit.exchange(step)
                    unit.set_gains(self.lowered.system.couplings.laws.motors)

    def fill(self, inputs: Inputs, rows: slice, steps: Index) -> None:
        """Give rows of inputs what the FMUs give at steps."""
        for unit in self._units:
            unit.fill(inputs, rows, steps)

    def keep(self, output: Output, rows: Index, steps: Index) -> None:
        """Write what the FMUs give at steps into rows of the output, but for rows -1."""
        kept = rows >= 0
        for unit, columns in zip(self._units, self._columns, strict=True):
            output.fmu_value[rows[kept], columns] = unit.values(steps[kept])
            unit.hide_references(output, rows[kept])

    def warnings(self) -> list[str]:
        """Lines about what FMUs gave until now."""
        return [line for unit in self._units for line in unit.chattering()]

    def check_serializes(self, key: str) -> None:
        """ModelError for a key that needs states which an FMU cannot write."""
        for unit in self._units:
            unit.check_serializes(key)

    def saved(self) -> dict[str, Array | Index]:
        """Copies of all that the FMUs carry on, by name."""
        arrays: dict[str, Array | Index] = {}
        for unit in self._units:
            arrays |= {f"{unit.fmu.name}/{key}": one.copy() for key, one in unit.memory.items()}
            arrays[f"{unit.fmu.name}/{SERIALIZED_STATE}"] = unit.instance.serialized()
        return arrays

    def resume(self, arrays: Arrays) -> None:
        """Start all FMUs, and go on from what `saved` gave."""
        self.start()
        self.load(arrays)

    def load(self, arrays: Arrays) -> None:
        """Go on from what `saved` gave; `StateError` where it is of other FMUs."""
        live = {
            f"{unit.fmu.name}/{key}": array
            for unit in self._units
            for key, array in unit.memory.items()
        }
        states = {f"{unit.fmu.name}/{SERIALIZED_STATE}": unit for unit in self._units}
        if missing := sorted(states.keys() - arrays.keys()):
            raise StateError(f"state: expected the states of FMUs, found none of {missing[0]}")
        own = {name: array for name, array in arrays.items() if name not in states}
        Snapshot(0, own).put_back(live)
        for name, unit in states.items():
            unit.instance.deserialize(arrays[name])
            unit.set_gains(self.lowered.system.couplings.laws.motors)

    def _look(self, step: int) -> None:
        """Let the row be that of the present step."""
        if not self._is_recorded:
            record(self._run, 0)
        self.keep(self.row, np.zeros(1, dtype=np.int64), np.array([step]))

    def _must_stop(self) -> bool:
        """Whether the step that was taken last is to be looked at before the next."""
        state = self._state
        left, passed = state.extremes.left[0], state.contacts.passed[0]
        return bool(left or passed or is_full(state.contacts))


def _with_own_gains(lowered: LoweredModel) -> LoweredModel:
    """The model with copies of the gains of its motors, which slopes of FMUs may change."""
    motors = lowered.system.couplings.laws.motors
    # The model's own are part of the identity of a state, and must stay.
    own = motors.replace(stiffness=motors.stiffness.copy(), damping=motors.damping.copy())

    def changed(system: System) -> System:
        laws = system.couplings.laws.replace(motors=own)
        return system.replace(couplings=system.couplings.replace(laws=laws))

    flight = None if lowered.flight is None else changed(lowered.flight)
    return replace(lowered, system=changed(lowered.system), flight=flight)


def _rows(inputs: Inputs, rows: slice) -> Inputs:
    return inputs.replace(
        load=inputs.load[rows],
        drive=inputs.drive[rows],
        motor=inputs.motor[rows],
        row=inputs.row[rows],
    )


def _source(fmu: FMU, pair: tuple[str, str], lowered: LoweredModel, row: Output) -> Array:
    """The view (1,) of an output of a step that an input of an FMU takes."""
    variable, name = pair
    match = COMPONENT_OF_OUTPUT.fullmatch(name)
    key = match["name"] if match else name
    known = available(lowered)
    if key not in known:
        raise fmu.error(f"inputs: {variable}: no output {name!r}{did_you_mean(key, known, n=3)}")
    numbers = [view[i : i + 1] for view in views(lowered, key, row) for i in range(len(view))]
    # The first of several would be a guess.
    if match is None and len(numbers) != 1:
        raise fmu.error(
            f"inputs: {variable}: {name!r} has {len(numbers)} numbers: expected one of them, "
            f"'{key}[1]' to '{key}[{len(numbers)}]'"
        )
    k = int(match["number"]) if match else 1
    if k > len(numbers):
        raise fmu.error(
            f"inputs: {variable}: expected '{key}[1]' to '{key}[{len(numbers)}]', got {name!r}"
        )
    return numbers[k - 1]
