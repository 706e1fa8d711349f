"""Quantities over time by name, as a user asks for them: KIND:NAME[:NAME][:AXIS].

    angular_velocity:hub:z          displacement:beam.tip:hub.rim:y          energy:kinetic

A kind is a method of `Recording`; the names are its arguments. Without an axis, a vector gives the
curves of those axes along which it is not zero.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import QuantityError
from .recording import Recording
from .rotations import Array

AXES = ("x", "y", "z")

NEGLIGIBLE = 1e-6
"""a component this much smaller than the largest one is rounding, or as good as zero in a picture
"""


@dataclass(frozen=True)
class Kind:
    values: Callable[..., Any]
    unit: str | Callable[..., str]
    """or what gives it, for the same names"""
    names: tuple[str, ...]
    """what each name stands for"""
    axes: bool = True


KINDS = {
    "position": Kind(Recording.position, "m", ("BODY|FRAME",)),
    "displacement": Kind(Recording.displacement, "m", ("BODY|FRAME", "BODY|FRAME")),
    "velocity": Kind(Recording.velocity, "m/s", ("BODY|FRAME",)),
    "acceleration": Kind(Recording.acceleration, "m/s²", ("BODY|FRAME",)),
    "angle": Kind(Recording.angle, "rad", ("BODY|FRAME",)),
    "angular_velocity": Kind(Recording.angular_velocity, "rad/s", ("BODY|FRAME",)),
    "angular_acceleration": Kind(Recording.angular_acceleration, "rad/s²", ("BODY|FRAME",)),
    "elastic_displacement": Kind(Recording.elastic_displacement, "m", ("INTERFACE",)),
    "elastic_rotation": Kind(Recording.elastic_rotation, "rad", ("INTERFACE",)),
    "force": Kind(Recording.force, "N", ("JOINT|SPRING",)),
    "moment": Kind(Recording.moment, "N m", ("JOINT|SPRING",)),
    "coordinate": Kind(
        Recording.coordinate, Recording.coordinate_unit, ("JOINT", "COORDINATE"), axes=False
    ),
    "linear_momentum": Kind(Recording.linear_momentum, "kg m/s", ()),
    "angular_momentum": Kind(Recording.angular_momentum, "kg m²/s", ()),
    "energy": Kind(Recording.energy, "J", ("ENERGY",), axes=False),
}


@dataclass(frozen=True, eq=False)
class Curve:
    """One number over time. `words` tell what it is: the kind, of what, along which axis."""

    words: tuple[str, str, str]
    unit: str
    values: Array
    """(n,)"""


def curves(recording: Recording, quantity: str) -> list[Curve]:
    """The curves of a quantity; QuantityError names the quantity and lists what there is."""
    kind_name, *names = quantity.split(":")
    if kind_name not in KINDS:
        raise QuantityError(
            f"{quantity}: no quantity {kind_name!r}; there are: {', '.join(map(usage, KINDS))}"
        )
    kind = KINDS[kind_name]
    axes: tuple[str, ...] = ()
    if kind.axes and len(names) == len(kind.names) + 1:
        axes = (names.pop(),)
    if len(names) != len(kind.names) or not set(axes) <= set(AXES):
        raise QuantityError(f"{quantity}: expected {usage(kind_name)}")
    try:
        values = kind.values(recording, *names)
        unit = kind.unit if isinstance(kind.unit, str) else kind.unit(recording, *names)
    except QuantityError as error:
        raise QuantityError(f"{quantity}: {error}") from error
    title, of = kind_name.replace("_", " "), " seen from ".join(names)
    if not kind.axes:
        return [Curve((title, of, ""), unit, values)]
    return [
        Curve((title, of, axis), unit, values[:, AXES.index(axis)])
        for axis in axes or _moving_axes(values)
    ]


def usage(kind_name: str) -> str:
    """How a quantity of this kind is written."""
    kind = KINDS[kind_name]
    return ":".join([kind_name, *kind.names]) + ("[:x|y|z]" if kind.axes else "")


def _moving_axes(values: Array) -> list[str]:
    peaks = np.abs(values).max(axis=0)
    return [
        axis for axis, peak in zip(AXES, peaks, strict=True) if peak > NEGLIGIBLE * peaks.max()
    ] or list(AXES)
