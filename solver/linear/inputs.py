"""What excites a linear model: loads and drives of the model, inputs, and unit loads anywhere.

    load:2                      the signal of the second load of the model
    force:beam.tip:y            a unit force on a frame, along an axis of space
    torque:hub:z                a unit torque
    drive:hinge                 the signal that drives a joint or a motion
    motor:servo                 what a motor gives without an error, [N m] or [N]
    NAME                        an `Input` signal: of all its loads and drives at once

In steady rotation directions turn with the mechanism.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..couplings.coupling import GROUND
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..model.loads import DirectedLoad, Force, Load, Torque
from ..model.model import Model
from ..signals.curves import Constant, Input
from ..step.rows import ATTITUDE
from .equations import Forcing
from .pose import Pose

AXIS_NAMES = "xyz"
LOAD_UNITS = {"force": "N", "torque": "N m"}
# [m, rad] of a drive, by which its derivative is found
DRIVE_CHANGE = 1e-4


@dataclass(frozen=True, eq=False)
class Channel:
    """An input: the loads, drives and motors, by their numbers, that it moves."""

    name: str
    loads: tuple[int, ...] = ()
    drives: tuple[int, ...] = ()
    motors: tuple[int, ...] = ()
    unit: str = ""


def with_loads(model: Model, names: Sequence[str]) -> Model:
    """The model with a load, of no size, for each unit load among the names."""
    unit_loads = (_unit_load(model, name) for name in names if _is_unit_load(name))
    return replace(model, loads=(*model.loads, *unit_loads))


def _is_unit_load(name: str) -> bool:
    return name.partition(":")[0] in LOAD_UNITS


def _unit_load(model: Model, name: str) -> Load:
    kind, *rest = name.split(":")
    if len(rest) != 2 or rest[1] not in tuple(AXIS_NAMES):
        raise ModelError(f"{name}: expected {kind}:BODY|FRAME:x|y|z")
    on, axis = rest
    if on.partition(".")[0] not in (GROUND, *model.bodies):
        raise ModelError(f"{name}: no body or frame {on!r}; there are: {', '.join(model.bodies)}")
    directed: dict[str, type[DirectedLoad]] = {"force": Force, "torque": Torque}
    return directed[kind](on, np.eye(3)[AXIS_NAMES.index(axis)], Constant(0.0))


def channels(model: Model, lowered: LoweredModel, names: Sequence[str]) -> list[Channel]:
    """The inputs of such names; model: as given, whose loads come before the unit loads."""
    found, added = [], len(model.frame_loads)
    for name in names:
        if _is_unit_load(name):
            # Unit loads were appended to the model in the order of the names.
            found.append(Channel(name, (added,), unit=LOAD_UNITS[name.partition(":")[0]]))
            added += 1
        else:
            found.append(_channel(model, lowered, name))
    return found


def _channel(model: Model, lowered: LoweredModel, name: str) -> Channel:
    kind, _, rest = name.partition(":")
    if kind == "load":
        number = int(rest) if rest.isdecimal() else 0
        if not 1 <= number <= len(model.loads):
            raise ModelError(f"{name}: expected load:1 to load:{len(model.loads)}, by their order")
        load = model.loads[number - 1]
        return Channel(name, (_numbers(model, lowered)[number - 1],), unit=load.unit)
    if kind == "motor":
        return _motor(model, name, rest)
    # A name without a kind is that of an `Input`, which may move several things at once.
    drives = _drives(lowered)
    if kind == "drive":
        if rest not in drives:
            raise ModelError(
                f"{name}: no scalar drive of {rest!r}; there are: {', '.join(drives) or 'none'}"
            )
        return Channel(name, drives=(drives[rest],))
    numbers = _numbers(model, lowered)
    loads = tuple(numbers[m] for m, load in enumerate(model.loads) if _is_input(load.signal, name))
    motors = tuple(_motors_of(model, name))
    moved = tuple(d for d, drive in enumerate(lowered.drives) if _is_input(drive, name))
    if not loads and not moved and not motors:
        raise ModelError(
            f"{name}: no such input; there are: {', '.join(_known(model, lowered)) or 'none'}, and "
            "force:FRAME:x|y|z, torque:FRAME:x|y|z"
        )
    return Channel(name, loads, moved, motors)


def _numbers(model: Model, lowered: LoweredModel) -> list[int]:
    """The number of the signal of each load: those on frames first, unit loads among them."""
    frames, patterns = iter(range(len(model.frame_loads))), len(lowered.model.frame_loads)
    spread = iter(range(patterns, patterns + len(model.pattern_loads)))
    return [next(frames if isinstance(load, Load) else spread) for load in model.loads]


def _motor(model: Model, name: str, rest: str) -> Channel:
    names = [motor.name for motor in model.motors]
    if rest not in names:
        raise ModelError(f"{name}: no motor {rest!r}; there are: {', '.join(names) or 'none'}")
    return Channel(name, motors=(names.index(rest),))


def _motors_of(model: Model, name: str) -> Iterator[int]:
    """The motors that give an input; `ModelError` where it is a reference."""
    for m, motor in enumerate(model.motors):
        if _is_input(motor.torque or motor.force, name):
            yield m
        if _is_input(motor.reference, name) or _is_input(motor.reference_rate, name):
            raise motor.error(
                f"input {name!r} is its reference: linear analyses take what it gives without an "
                f"error, motor:{motor.name}"
            )


def _is_input(signal: object, name: str) -> bool:
    return isinstance(signal, Input) and signal.name == name


def _known(model: Model, lowered: LoweredModel) -> list[str]:
    given = (motor.torque or motor.force for motor in model.motors)
    signals = [*(load.signal for load in model.loads), *lowered.drives, *given]
    names = dict.fromkeys(signal.name for signal in signals if isinstance(signal, Input))
    loads = [f"load:{m + 1}" for m in range(len(model.loads))]
    motors = [f"motor:{motor.name}" for motor in model.motors]
    return [*names, *loads, *(f"drive:{name}" for name in _drives(lowered)), *motors]


def _drives(lowered: LoweredModel) -> dict[str, int]:
    """Numbers of drives by joint or motion, with .1, .2 where one has several.

    Without attitudes, whose drives are the axes that they turn.
    """
    found: dict[str, int] = {}
    couplings = lowered.system.couplings
    ranges = pairwise(couplings.range.tolist())
    for name, (first, last) in zip(lowered.coupling_names, ranges, strict=True):
        if (couplings.rows.kind[first:last] == ATTITUDE).any():
            continue
        # A set that keeps its order: rows of a motion may share a drive.
        numbers = dict.fromkeys(d for d in couplings.drive[first:last].tolist() if d >= 0)
        for k, d in enumerate(numbers, 1):
            found[name if len(numbers) == 1 else f"{name}.{k}"] = d
    return found


def forcing(pose: Pose, inputs: Sequence[Channel]) -> Forcing:
    """Derivatives of r, pi and phi by the inputs."""
    columns = [_forcing(pose, channel) for channel in inputs]
    pose.evaluate(pose.system)
    n_r, n_l = 6 * len(pose.state.bodies.x), len(pose.system.elastic.loaded)
    n_i = len(pose.state.couplings.lam)
    whole = np.array(columns).reshape(len(inputs), n_r + n_l + n_i).T
    return Forcing(whole[:n_r], whole[n_r : n_r + n_l], whole[n_r + n_l :])


def _forcing(pose: Pose, channel: Channel) -> Array:
    """Loads are linear in their signals; drives by differences of fourth order."""
    size = DRIVE_CHANGE if channel.drives else 1.0
    near = _shifted(pose, channel, size) - _shifted(pose, channel, -size)
    if not channel.drives:
        return near / (2.0 * size)
    far = _shifted(pose, channel, 2.0 * size) - _shifted(pose, channel, -2.0 * size)
    return (8.0 * near - far) / (12.0 * size)


def _shifted(pose: Pose, channel: Channel, change: float) -> Array:
    """[r; pi; phi] where an input changes, in body axes."""
    work, state = pose.work, pose.state
    values = (work.loads.value, work.drives.value, work.motors.value)
    saved = [array.copy() for array in values]
    moved = (channel.loads, channel.drives, [3 * m for m in channel.motors])
    for array, numbers in zip(values, moved, strict=True):
        # Three values of each motor: the first is what it gives without an error.
        array[list(numbers)] += change
    pose.evaluate(pose.system)
    for array, old in zip(values, saved, strict=True):
        array[:] = old
    residual = work.bodies.residual.copy()
    # Forces in body axes, as the unknowns delta X are.
    residual[:, :3] = np.einsum("bji,bj->bi", state.bodies.R, residual[:, :3])
    pi = state.interfaces.p[pose.system.elastic.loaded]
    return np.concatenate([residual.ravel(), pi, work.couplings.phi])
