"""The start of a model with FMUs, whose first outputs are inputs of the model at t = 0."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from ..checkpoint.carried import FMUS_PREFIX
from ..checkpoint.file import StateFile
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..model.model import Model
from ..signals.curves import Input
from ..signals.signal import Signal
from ..start.initial import InitialState, initialize
from .exchange import Exchange


def start_beside(
    initial: InitialState,
    lowered: LoweredModel,
    source: StateFile | None,
    *,
    restartable: bool = False,
    recorded: bool = False,
) -> tuple[InitialState, Exchange]:
    """The start of a model with what its FMUs give at first, and these.

    initial: the start with the values of the inputs that the model declares; lowered, source: what
    it was made of. A start in equilibrium, or from another run, stays as it is: forces that FMUs
    change then act as loads that jump.
    """
    model = initial.lowered.model
    exchange = Exchange(initial.lowered, restartable=restartable)
    if not exchange:
        exchange.bind(initial.state, initial.work, recorded=recorded)
        return initial, exchange
    try:
        if source and any(name.startswith(FMUS_PREFIX) for name in source.snapshot.arrays):
            raise ModelError(
                "simulation: start: the run that it starts from has FMUs, whose states go on only "
                "where that run is continued (--continue)"
            )
        # At first beside the start without them: they need its coordinates, not its forces.
        exchange.bind(initial.state, initial.work)
        values = exchange.start()
        declared = {name: value for name, value in _inputs(model).items() if name in values}
        # Equilibrium would move with the force, and the FMU with the equilibrium.
        if source is not None or model.settings.start == "equilibrium":
            exchange.begin_from(declared)
            if values != declared:
                warnings = (*initial.warnings, *_jumps(declared, values))
                initial = replace(initial, warnings=warnings)
        elif values != declared:
            initial = _started_with(values, lowered)
        exchange.bind(initial.state, initial.work, recorded=recorded)
    except BaseException:
        exchange.close()
        raise
    return initial, exchange


def _started_with(values: Mapping[str, float], lowered: LoweredModel) -> InitialState:
    """The start with other values of inputs, by name; the model stays as it is declared."""
    # A start of its own: forces at t = 0 are in accelerations, histories and works.
    changed: Model = _with_values(lowered.model, values)
    other = replace(lowered, model=changed)
    loads: list[Signal] = [load.signal for load in other.loads]
    motors: list[Signal] = [signal for motor in changed.motors for signal in motor.signals]
    begun = initialize(changed, replace(other, load_signals=loads, motor_signals=motors))
    # States of a run belong to the model as its file has it.
    return replace(begun, lowered=replace(begun.lowered, model=lowered.model))


def _with_values(part: Any, values: Mapping[str, float]) -> Any:
    """A model, or a part of one, in which inputs have other values."""
    if isinstance(part, Input):
        return replace(part, value=values.get(part.name, part.value))
    if isinstance(part, Model):
        loads, motors = (
            tuple(_with_values(one, values) for one in group) for group in (part.loads, part.motors)
        )
        return replace(part, loads=loads, motors=motors)
    signals = {
        field.name: _with_values(getattr(part, field.name), values)
        for field in fields(part)
        if isinstance(getattr(part, field.name), Input)
    }
    return replace(part, **signals)


def _inputs(model: Model) -> dict[str, float]:
    """The values of the inputs of a model at the start, by name."""
    parts = [*model.loads, *model.motors]
    signals = [value for part in parts for value in vars(part).values()]
    return {signal.name: signal.value for signal in signals if isinstance(signal, Input)}


def _jumps(declared: Mapping[str, float], values: Mapping[str, float]) -> list[str]:
    """Lines about inputs that jump as the run begins."""
    return [
        f"input {name!r} jumps as the run begins, from {declared[name]:.6g} to {value:.6g}, which "
        f"its FMU gives: write {{input = {name!r}, value = {value:.6g}}} for a start with it"
        for name, value in values.items()
        if value != declared[name]
    ]
