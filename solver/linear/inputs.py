"""What excites a linear model: loads and drives of the model, inputs, and unit loads anywhere.

    load:2                      the signal of the second load of the model
    force:beam.tip:y            a unit force on a frame, along an axis of space
    torque:hub:z                a unit torque
    drive:hinge                 the signal that drives a joint or a motion
    NAME                        an `Input` signal: of all its loads and drives at once

In steady rotation directions turn with the mechanism.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..model.curves import Constant, Input
from ..model.loads import AnyLoad, Load, PatternLoad
from ..model.model import GROUND, Model
from .pose import Pose

AXES = "xyz"
UNITS = {"force": "N", "torque": "N m"}
TURN = 1e-4
"""change of a drive [m, rad] by which its derivative is found"""


@dataclass(frozen=True, eq=False)
class Channel:
    """An input: the loads and drives, by their numbers, that it moves."""

    name: str
    loads: tuple[int, ...] = ()
    drives: tuple[int, ...] = ()
    unit: str = ""


def with_loads(model: Model, names: Sequence[str]) -> Model:
    """The model with a load, of no size, for each unit load among the names."""
    unit_loads = (_unit_load(model, name) for name in names if _is_unit_load(name))
    return replace(model, loads=(*model.loads, *unit_loads))


def _is_unit_load(name: str) -> bool:
    return name.partition(":")[0] in UNITS


def _unit_load(model: Model, name: str) -> Load:
    kind, *rest = name.split(":")
    if len(rest) != 2 or rest[1] not in tuple(AXES):
        raise ModelError(f"{name}: expected {kind}:BODY|FRAME:x|y|z")
    on, axis = rest
    if on.partition(".")[0] not in (GROUND, *model.bodies):
        raise ModelError(f"{name}: no body or frame {on!r}; there are: {', '.join(model.bodies)}")
    return Load(kind, on, np.eye(3)[AXES.index(axis)], Constant(0.0))


def channels(model: Model, lowered: LoweredModel, names: Sequence[str]) -> list[Channel]:
    """The inputs of such names; model: as given, whose loads come before the unit loads."""
    found, added = [], len(model.frame_loads)
    for name in names:
        if _is_unit_load(name):
            found.append(Channel(name, (added,), unit=UNITS[name.partition(":")[0]]))
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
        load = _on_a_frame(model.loads[number - 1], name)
        return Channel(name, (_number(model, load),), unit=UNITS[load.type])
    drives = _drives(lowered)
    if kind == "drive":
        if rest not in drives:
            raise ModelError(
                f"{name}: nothing drives {rest!r}; driven are: {', '.join(drives) or 'none'}"
            )
        return Channel(name, drives=(drives[rest],))
    fed = [load for load in model.loads if _is_input(load.signal, name)]
    loads = tuple(_number(model, _on_a_frame(load, name)) for load in fed)
    moved = tuple(d for d, drive in enumerate(lowered.drives) if _is_input(drive, name))
    if not loads and not moved:
        raise ModelError(
            f"{name}: no such input; there are: {', '.join(_known(model, lowered)) or 'none'}, and "
            "force:FRAME:x|y|z, torque:FRAME:x|y|z"
        )
    return Channel(name, loads, moved)


def _on_a_frame(load: AnyLoad, name: str) -> Load:
    """A load on a frame; `ModelError` for a load pattern, which is no input yet."""
    if isinstance(load, PatternLoad):
        raise ModelError(f"{name}: {load.owner}: linear analysis takes loads on frames as inputs")
    return load


def _number(model: Model, load: Load) -> int:
    """The number of a load among those on frames, as the solver has them."""
    return next(m for m, other in enumerate(model.frame_loads) if other is load)


def _is_input(signal: object, name: str) -> bool:
    return isinstance(signal, Input) and signal.name == name


def _known(model: Model, lowered: LoweredModel) -> list[str]:
    signals = [*(load.signal for load in model.loads), *lowered.drives]
    names = dict.fromkeys(signal.name for signal in signals if isinstance(signal, Input))
    loads = [f"load:{m + 1}" for m in range(len(model.loads))]
    return [*names, *loads, *(f"drive:{name}" for name in _drives(lowered))]


def _drives(lowered: LoweredModel) -> dict[str, int]:
    """Numbers of drives by joint or motion, with .1, .2 where one has several."""
    found: dict[str, int] = {}
    couplings = lowered.system.couplings
    ranges = pairwise(couplings.range.tolist())
    for name, (first, last) in zip(lowered.coupling_names, ranges, strict=True):
        # those of an attitude are components of axes, and no inputs by themselves
        driven = couplings.drive[first:last][couplings.rows.axis[first:last] < 0]
        numbers = dict.fromkeys(d for d in driven.tolist() if d >= 0)
        for k, d in enumerate(numbers, 1):
            found[name if len(numbers) == 1 else f"{name}.{k}"] = d
    return found


def forcing(pose: Pose, inputs: Sequence[Channel]) -> Array:
    """Derivatives of [r; pi; phi] by the inputs (n_r + n_a + n_i, n_in)."""
    columns = [_forcing(pose, channel) for channel in inputs]
    pose.evaluate(pose.system)
    return np.array(columns).T


def _forcing(pose: Pose, channel: Channel) -> Array:
    """Loads are linear in their signals; drives by differences of fourth order."""
    size = TURN if channel.drives else 1.0
    near = shifted(pose, channel, size) - shifted(pose, channel, -size)
    if not channel.drives:
        return near / (2.0 * size)
    far = shifted(pose, channel, 2.0 * size) - shifted(pose, channel, -2.0 * size)
    return (8.0 * near - far) / (12.0 * size)


def shifted(pose: Pose, channel: Channel, change: float) -> Array:
    """[r; pi; phi] where an input changes, in body axes."""
    work, state = pose.work, pose.state
    loads, drives = work.loads.value.copy(), work.drives.value.copy()
    work.loads.value[list(channel.loads)] += change
    work.drives.value[list(channel.drives)] += change
    pose.evaluate(pose.system)
    work.loads.value[:], work.drives.value[:] = loads, drives
    residual = work.bodies.residual.copy()
    residual[:, :3] = np.einsum("bji,bj->bi", state.bodies.R, residual[:, :3])
    pi = state.interfaces.p[pose.system.elastic.active]
    return np.concatenate([residual.ravel(), pi, work.couplings.phi])
