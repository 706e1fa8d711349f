"""The variables of an FMU: its inputs, parameters and outputs, each a number."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from fnmatch import fnmatchcase

import numpy as np

from ..inputs.errors import did_you_mean
from ..solver.arrays import Array
from ..solver.couplings.motors import Motor
from ..solver.lower.lower import LoweredModel
from ..solver.model.loads import Load
from ..solver.output.columns import available, axes_of, cells
from ..solver.signals.curves import Input
from ..solver.step.system import Output
from ..solver.stepper import Stepper
from .errors import FMUError
from .naming import structured
from .parameters import parameters

UNASKED_GROUPS = ("joints", "motors", "sensors", "energy")
"""groups of outputs that there are where none is named"""
TERMINAL_GROUPS = ("joints", "motors", "frames", "sensors")
"""groups whose owners are terminals"""


class VariableKind(IntEnum):
    """What the C code does for a variable (`VariableKind` in fmu/c/core.h)."""

    TIME = 0
    INPUT = 1
    PARAMETER = 2
    REAL = 3
    INTEGER = 4


@dataclass(frozen=True, eq=False)
class Variable:
    """A number that importers read or set.

    place: a view (1,) of it among the arrays of a step, none of the time and of inputs; start: of
    inputs and parameters; terminal: what it belongs to, "" if to nothing.
    """

    name: str
    kind: VariableKind
    unit: str
    description: str
    place: Array | None = None
    start: float | None = None
    terminal: str = ""

    @property
    def is_output(self) -> bool:
        return self.kind in (VariableKind.REAL, VariableKind.INTEGER)


def variables(
    stepper: Stepper, outputs: Sequence[str], tunable: Sequence[str]
) -> tuple[Variable, ...]:
    """The time, then inputs, parameters and outputs; their numbers are their value references.

    outputs, tunable: as "joints/pivot/angle" and "motors/servo/stiffness", where stars stand for
    anything. `FMUError` for a name that nothing has.
    """
    lowered = stepper.lowered
    time = Variable("time", VariableKind.TIME, "s", "time")
    inputs = [_input(stepper, name) for name in stepper.input_names]
    known = parameters(lowered)
    chosen = [
        one for name in chosen_names("parameter", tunable, list(known)) for one in known[name]
    ]
    given = [
        Variable(
            one.name, VariableKind.PARAMETER, one.unit, one.description, one.place, one.place.item()
        )
        for one in chosen
    ]
    names = output_names(lowered, outputs)
    found = (time, *inputs, *given, *_outputs(lowered, names, stepper.run.output))
    _check_names(found)
    return found


def output_names(lowered: LoweredModel, outputs: Sequence[str]) -> list[str]:
    """The outputs that are asked for, by default those of `[output]` or of `UNASKED_GROUPS`."""
    known = list(available(lowered))
    if outputs:
        return chosen_names("output", outputs, known)
    # Frames of flexible bodies may be many: they are outputs where they are asked for.
    quantities = lowered.model.settings.output.quantities or UNASKED_GROUPS
    chosen = {name for name in known for group in quantities if name.startswith(f"{group}/")}
    return [name for name in known if name in chosen]


def chosen_names(what: str, patterns: Sequence[str], known: Sequence[str]) -> list[str]:
    """The known names that patterns stand for, each once; `FMUError` for one of none."""
    found: dict[str, None] = {}
    for pattern in patterns:
        # Names may have brackets, which patterns read otherwise: first as they are.
        names = [name for name in known if name == pattern or fnmatchcase(name, pattern)]
        if not names:
            raise FMUError(f"{what}: no {pattern!r}{did_you_mean(pattern, known, n=3)}")
        found |= dict.fromkeys(names)
    return list(found)


def _outputs(lowered: LoweredModel, names: Sequence[str], output: Output) -> Iterator[Variable]:
    for name in names:
        group, owner = name.split("/")[0], name.rpartition("/")[0]
        numbers = cells(lowered, name, output)
        for i, cell in enumerate(numbers):
            index = f"[{i + 1}]" if len(numbers) > 1 else ""
            states = f"; {cell.quantity.states}" if cell.quantity.states else ""
            yield Variable(
                structured(name) + index,
                VariableKind.INTEGER if cell.place.dtype == np.int64 else VariableKind.REAL,
                cell.unit,
                cell.quantity.description + states,
                cell.place,
                terminal=structured(owner) if group in TERMINAL_GROUPS else "",
            )


def _input(stepper: Stepper, name: str) -> Variable:
    """An input, with the unit of all that it is used for, "" where these differ."""
    given = [s for _, s in stepper.signals if isinstance(s, Input) and s.name == name]
    # An input may drive a torque and a force at once: then it has no unit.
    units = set(units_of_input(stepper.lowered, name))
    return Variable(
        structured(f"inputs/{name}"),
        VariableKind.INPUT,
        units.pop() if len(units) == 1 else "",
        "held over a communication step",
        start=given[0].value,
    )


def units_of_input(lowered: LoweredModel, name: str) -> Iterator[str]:
    """The units in which the loads and motors of a model take an input."""
    model = lowered.model
    for load in model.loads:
        if isinstance(load.signal, Input) and load.signal.name == name:
            yield load.unit if isinstance(load, Load) else ""
    motors = axes_of(lowered)["motor"]
    for motor, angular in zip(model.motors, motors.angular, strict=True):
        own: Motor = motor.motor if hasattr(motor, "motor") else motor
        length, force = ("rad", "N m") if angular else ("m", "N")
        for signal, unit in (
            (own.torque, force),
            (own.force, force),
            (own.reference, length),
            (own.reference_rate, f"{length} s-1"),
        ):
            if isinstance(signal, Input) and signal.name == name:
                yield unit


def _check_names(found: Sequence[Variable]) -> None:
    names: set[str] = set()
    for one in found:
        if one.name in names:
            raise FMUError(f"variable {one.name}: expected one of this name, found two")
        names.add(one.name)
