"""Numbers of a model that may change between steps, and do not move its start."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from typing import NamedTuple

from ..solver.arrays import Array
from ..solver.lower.lower import LoweredModel
from ..solver.output.columns import axes_of
from .naming import structured


class Parameter(NamedTuple):
    """A number of the data of a model.

    place: a view (1,) of it.
    """

    name: str
    unit: str
    description: str
    place: Array


def parameters(lowered: LoweredModel) -> dict[str, list[Parameter]]:
    """All parameters of a model, by names as "motors/servo/stiffness".

    The gains and limits of motors, the diagonals of linear springs, the coefficients of friction,
    and gravity.
    """
    found: dict[str, list[Parameter]] = {}
    for key, unit, description, places in (
        *_of_motors(lowered),
        *_of_springs(lowered),
        *_of_friction(lowered),
        ("gravity", "m s-2", "acceleration of gravity, in space", _each(_gravity(lowered))),
    ):
        several = len(places) > 1
        found[key] = [
            Parameter(structured(key) + (f"[{i + 1}]" if several else ""), unit, description, place)
            for i, place in enumerate(places)
        ]
    return found


NamedNumbers = tuple[str, str, str, list[Array]]
"""name, unit, description, and where its numbers are"""


def _gravity(lowered: LoweredModel) -> Array:
    return lowered.system.bodies.gravity


def _each(array: Array) -> list[Array]:
    return [array[i : i + 1] for i in range(len(array))]


def _of_motors(lowered: LoweredModel) -> Iterator[NamedNumbers]:
    motors, axis = lowered.system.couplings.laws.motors, axes_of(lowered)["motor"]
    for k, (name, angular) in enumerate(zip(axis.names, axis.angular, strict=True)):
        force, length = ("N m", "rad") if angular else ("N", "m")
        for key, array, unit, description in (
            ("stiffness", motors.stiffness, f"{force} {length}-1", "gain of the error"),
            ("damping", motors.damping, f"{force} s {length}-1", "gain of its rate"),
            ("integral", motors.integral, f"{force} {length}-1 s-1", "gain of its integral"),
            ("lower_limit", motors.lower, force, "least force or torque"),
            ("upper_limit", motors.upper, force, "largest force or torque"),
        ):
            yield f"motors/{name}/{key}", unit, description, [array[k : k + 1]]


def _of_springs(lowered: LoweredModel) -> Iterator[NamedNumbers]:
    """The diagonals of linear springs: laws of single rows are none of them."""
    couplings, lengths = lowered.system.couplings, lowered.measures_lengths
    for j, coupling in enumerate(lowered.model.couplings):
        if coupling.group != "springs":
            continue
        first, stop = couplings.range[j], couplings.range[j + 1]
        for key, array, per in (
            ("stiffness", couplings.laws.stiffness, ""),
            ("damping", couplings.laws.damping, " s"),
        ):
            diagonal = [array[row, row - first : row - first + 1] for row in range(first, stop)]
            # Bushings have forces and moments: their numbers have several units, and get none.
            kinds = set(lengths[first:stop].tolist())
            units = {f"N{per} m-1" if is_length else f"N m{per} rad-1" for is_length in kinds}
            unit = units.pop() if len(units) == 1 else ""
            yield f"springs/{coupling.name}/{key}", unit, f"{key} of each component", diagonal


def _of_friction(lowered: LoweredModel) -> Iterator[NamedNumbers]:
    couplings = lowered.system.couplings
    friction = couplings.friction
    for j, coupling in enumerate(lowered.model.couplings):
        if (k := couplings.friction_of[j]) < 0:
            continue
        group = "joints" if coupling.dimension == "joint" else "contacts"
        for key, array in (("static", friction.static), ("sliding", friction.sliding)):
            name = f"{group}/{coupling.name}/{key}_friction"
            yield name, "1", f"coefficient of {key} friction", [array[k : k + 1]]


def kept_by_gains(lowered: LoweredModel, chosen: Sequence[str]) -> Iterator[str]:
    """A line for each motor with a gain among the chosen parameters that another number follows.

    The model derives its tracking time from its gains, which an export no longer does.
    """
    motors = lowered.system.couplings.laws.motors
    for k, motor in enumerate(lowered.model.motors):
        if motor.tracking_time is not None or motors.tracking[k] == 0.0:
            continue
        gains = [f"motors/{motor.name}/{key}" for key in ("stiffness", "damping", "integral")]
        if any(fnmatchcase(gain, pattern) for gain in gains for pattern in chosen):
            time = 1.0 / motors.tracking[k]
            yield f"motors/{motor.name}: tracking_time stays {time:.6g} s when its gains change"
