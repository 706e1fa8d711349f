"""The variables of results: one table of names, dimensions, units, descriptions and sources.

Writer, reader, documentation and the names in `recorded` follow from `QUANTITIES`. To add a
quantity takes a row of it, and the code that computes the numbers in the time loop.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..files.outputs import resolved
from ..superelement import sha256
from ..superelement.validation import Array
from .space import Space

FORMAT = "duhamel-results"
VERSION = 8
EARLIEST = 3
"""of which all that is there is the same"""


@dataclass(frozen=True)
class Dimension:
    """An axis of the arrays.

    group: what its entries belong to, as in "bodies/hub"; ragged: several entries for each owner,
    "OWNER.ENTRY", or none; entries: those that are always the same.
    """

    name: str
    description: str
    group: str = ""
    ragged: bool = False
    entries: tuple[str, ...] = ()


DIMENSIONS = {
    dimension.name: dimension
    for dimension in (
        Dimension("time", "time of each recorded step, the start included"),
        Dimension("axis", "Cartesian axes", entries=("x", "y", "z")),
        Dimension("quaternion", "components of unit quaternions", entries=("w", "x", "y", "z")),
        Dimension("body", "bodies", "bodies"),
        Dimension(
            "second_order_coordinate",
            "coordinates of second order of flexible bodies, as BODY.NUMBER",
            "bodies",
            ragged=True,
        ),
        Dimension("frame", "frames of bodies, as BODY.FRAME", "frames"),
        Dimension("joint", "joints and prescribed motions", "joints"),
        Dimension(
            "joint_constraint", "constraints of joints, as JOINT.NUMBER", "joints", ragged=True
        ),
        Dimension(
            "joint_coordinate",
            "free and driven coordinates of joints, as JOINT.COORDINATE",
            "joints",
            ragged=True,
        ),
        Dimension("coupler", "couplers of joint coordinates", "couplers"),
        Dimension("spring", "springs", "springs"),
        Dimension(
            "spring_component", "components of springs, as SPRING.NUMBER", "springs", ragged=True
        ),
        Dimension("contact_axis", "normal and tangents of a contact", entries=("n", "t1", "t2")),
        Dimension("tangent_axis", "tangents of a contact", entries=("t1", "t2")),
        Dimension("contact", "contacts", "contacts"),
        Dimension("stop", "stops of joint coordinates", "stops"),
        Dimension("motor", "motors on joint coordinates", "motors"),
        Dimension(
            "joint_with_friction", "joints with friction, as JOINT.friction", "joints", ragged=True
        ),
        Dimension("pattern", "load patterns of flexible bodies, as BODY.PATTERN", "patterns"),
        Dimension("sensor", "sensors of flexible bodies, as BODY.SENSOR", "sensors"),
        Dimension(
            "sensor_channel",
            "channels of sensors, as BODY.SENSOR.CHANNEL",
            "sensors",
            ragged=True,
        ),
        Dimension("event", "times that a contact or stop was closed, in the order of their ends"),
        Dimension("event_owner", "contacts and stops whose events are counted"),
        Dimension("flexible_body", "bodies with superelements"),
        Dimension("check", "checks of the validity of the run, as CRITERION:OWNER"),
    )
}

_FIXED = {name: dimension.entries for name, dimension in DIMENSIONS.items() if dimension.entries}


@dataclass(frozen=True)
class Axis:
    """The entries of a dimension.

    angular: True for each that is an angle or belongs to one, where some may be; of channels of
    sensors the number of its unit; rows: of each in the arrays of the time loop, which a file does
    not keep.
    """

    names: tuple[str, ...]
    angular: tuple[int, ...] = ()
    rows: tuple[int, ...] = ()
    _ranges: dict[str, tuple[int, int]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __len__(self) -> int:
        return len(self.names)

    def number(self, name: str) -> int:
        """The number of an entry, which must be there."""
        (number,) = self.range_of(name, ragged=False)
        return number

    def range_of(self, owner: str, ragged: bool = True) -> range:
        """The entries of an owner, which stand one after the other; none if it has none."""
        if not self._ranges:
            for i, name in enumerate(self.names):
                key = name.rpartition(".")[0] if ragged else name
                first, _ = self._ranges.get(key, (i, i))
                self._ranges[key] = first, i + 1
        return range(*self._ranges.get(owner, (0, 0)))

    def keep(self, chosen: Callable[[str], bool]) -> "Axis":
        """The entries whose names are chosen."""
        kept = [i for i, name in enumerate(self.names) if chosen(name)]
        return Axis(
            tuple(self.names[i] for i in kept),
            tuple(self.angular[i] for i in kept if self.angular),
            tuple(self.rows[i] for i in kept if self.rows),
        )


Axes = Mapping[str, Axis]


class Energies(NamedTuple):
    """Energies of a step [J] that others are measured from."""

    springs: float
    total: float

    @classmethod
    def of(cls, output: Any) -> "Energies":
        """Those of the first row of an output."""
        springs, *others = (getattr(output, name)[0] for name in STORED)
        return cls(float(springs), float(sum(others, springs)))


class EventRows(NamedTuple):
    """Events: numbers of their owners (m,), and their values (m, 9) in the order of `EVENTS`."""

    owner: NDArray[np.int64]
    values: Array

    @classmethod
    def none(cls) -> "EventRows":
        return cls(np.empty(0, dtype=np.int64), np.empty((0, 9)))

    @classmethod
    def joined(cls, parts: Sequence["EventRows"]) -> "EventRows":
        owners, values = zip(cls.none(), *parts, strict=True)
        return cls(np.concatenate(owners), np.concatenate(values))


class Batch(NamedTuple):
    """Steps (n,) that the time loop recorded in the first rows of its output.

    With the step size h [s], the energies of t = 0, and the contacts that ended meanwhile.
    """

    steps: Any
    h: float
    output: Any
    start: Energies
    events: EventRows = EventRows.none()


STORED = ("spring_energy", "kinetic_energy", "elastic_energy", "potential_energy")


def _time(batch: Batch) -> Array:
    time: Array = batch.h * batch.steps
    return time


def _dissipated(batch: Batch) -> Array:
    """The work of springs and dampers that springs have not stored, and what modal damping took."""
    n, output = len(batch.steps), batch.output
    stored = output.spring_energy[:n] - batch.start.springs
    dissipated: Array = output.modal_damping[:n] - output.compliance_work[:n] - stored
    return dissipated


def _numerical(batch: Batch) -> Array:
    """The work on modes that they have neither stored nor lost to their damping."""
    n, output = len(batch.steps), batch.output
    numerical: Array = output.modal_loss[:n] - output.modal_damping[:n]
    return numerical


def _balance(batch: Batch) -> Array:
    """The change of all energies, and what they lost, less the work from outside."""
    n, output = len(batch.steps), batch.output
    stored = sum((getattr(output, name)[:n] for name in STORED[1:]), getattr(output, STORED[0])[:n])
    lost = _dissipated(batch) + _numerical(batch)
    balance: Array = stored + lost - output.external_work[:n] - batch.start.total
    return balance


@dataclass(frozen=True)
class Quantity:
    """A variable of results.

    unit: in the spelling of UDUNITS; where entries are lengths or angles, that of each.
    key: "GROUP/ATTRIBUTE" of the reader; quantities with the same one are joined along the last
    axis, and "{}" stands for the name of a coordinate. source: the array of the time loop that
    holds it, by default of its own name; or else derive: the function that computes it. since: the
    version of files that has it first, where an owner had others before.
    """

    name: str
    dimensions: tuple[str, ...]
    unit: str | tuple[str, ...]
    description: str
    key: str
    source: str = ""
    derive: Callable[[Batch], Array] | None = None
    integer: bool = False
    since: int = EARLIEST

    def __post_init__(self) -> None:
        if self.derive is None and not self.source:
            object.__setattr__(self, "source", self.name)

    @property
    def group(self) -> str:
        return self.key.partition("/")[0]

    @property
    def attribute(self) -> str:
        return self.key.partition("/")[2]

    @property
    def owned(self) -> Dimension | None:
        """The dimension of its owners, or of their entries, if it has owners."""
        dimension = DIMENSIONS[self.dimensions[1]] if len(self.dimensions) > 1 else None
        return dimension if dimension and dimension.group else None

    def shape(self, axes: Axes) -> tuple[int, ...]:
        """The shape of a row."""
        return tuple(len(axes[name]) for name in self.dimensions[1:])

    def units(self, axes: Axes) -> tuple[str, ...]:
        """The unit of each entry, or the one unit."""
        if isinstance(self.unit, str):
            return (self.unit,)
        return tuple(self.unit[angular] for angular in axes[self.measured].angular)

    @property
    def measured(self) -> str:
        """The dimension along which its unit differs."""
        return self.dimensions[1] if len(self.dimensions) > 1 else "event_owner"

    def take(self, batch: Batch, axes: Axes) -> Array:
        """Its rows (n, ...) of the steps of a batch; a view where its entries stand together."""
        n = len(batch.steps)
        array: Array
        if self.derive is not None:
            return self.derive(batch)
        array = getattr(batch.output, self.source)[:n]
        return array[:, _together(axes[self.dimensions[1]].rows)] if self.owned else array


def _together(rows: Sequence[int]) -> Any:
    """Rows as an index: a slice if they are consecutive."""
    first = rows[0]
    consecutive = rows[-1] - first + 1 == len(rows)
    return slice(first, first + len(rows)) if consecutive else np.array(rows)


_BODY, _TURN = ("time", "body", "axis"), ("time", "body", "quaternion")
_FRAME, _FRAME_TURN = ("time", "frame", "axis"), ("time", "frame", "quaternion")
_JOINT, _CONSTRAINT = ("time", "joint", "axis"), ("time", "joint_constraint")
_COUPLER = ("time", "coupler")
_SPRING, _COMPONENT = ("time", "spring", "axis"), ("time", "spring_component")
_TIME, _VECTOR = ("time",), ("time", "axis")
_COORDINATE, _RUBBING = ("time", "joint_coordinate"), ("time", "joint_with_friction")
_PATTERN, _CHANNEL = ("time", "pattern"), ("time", "sensor_channel")
_CONTACT, _STOP, _MOTOR = ("time", "contact"), ("time", "stop"), ("time", "motor")


def _energy(name: str, column: str, description: str, **more: Any) -> Quantity:
    return Quantity(name, _TIME, "J", description, f"energy/{column}", **more)


QUANTITIES = (
    Quantity("time", _TIME, "s", "time of each recorded step", "/time", derive=_time),
    Quantity("body_position", _BODY, "m", "center of mass, in space", "bodies/x"),
    Quantity("body_rotation", _TURN, "1", "unit quaternion, body to space", "bodies/R"),
    Quantity(
        "body_velocity", _BODY, "m s-1", "velocity of the center of mass, in space", "bodies/v"
    ),
    Quantity(
        "body_angular_velocity", _BODY, "rad s-1", "angular velocity, in body axes", "bodies/v"
    ),
    Quantity(
        "body_acceleration",
        _BODY,
        "m s-2",
        "acceleration of the center of mass, in space",
        "bodies/v_dot",
    ),
    Quantity(
        "body_angular_acceleration",
        _BODY,
        "rad s-2",
        "angular acceleration, in body axes",
        "bodies/v_dot",
    ),
    Quantity(
        "body_second_order_force",
        ("time", "second_order_coordinate"),
        ("N", "N"),
        "force on each coordinate of second order, q over the root of the mass, a length",
        "bodies/second_order_force",
    ),
    Quantity("frame_position", _FRAME, "m", "origin of the frame, in space", "frames/position"),
    Quantity(
        "frame_rotation", _FRAME_TURN, "1", "unit quaternion, frame to space", "frames/rotation"
    ),
    Quantity(
        "frame_velocity",
        _FRAME,
        "m s-1",
        "velocity of the origin of the frame, in space",
        "frames/velocity",
    ),
    Quantity(
        "frame_angular_velocity",
        _FRAME,
        "rad s-1",
        "angular velocity, in space",
        "frames/velocity",
    ),
    Quantity(
        "frame_acceleration",
        _FRAME,
        "m s-2",
        "acceleration of the origin of the frame, in space",
        "frames/acceleration",
    ),
    Quantity(
        "frame_angular_acceleration",
        _FRAME,
        "rad s-2",
        "angular acceleration, in space",
        "frames/acceleration",
    ),
    Quantity(
        "frame_elastic_displacement",
        _FRAME,
        "m",
        "elastic displacement of the interface, in body axes",
        "frames/u",
    ),
    Quantity(
        "frame_elastic_rotation",
        _FRAME,
        "rad",
        "elastic rotation vector of the interface, in body axes",
        "frames/u",
    ),
    Quantity(
        "frame_force",
        _FRAME,
        "N",
        "force of joints, springs and loads on the body, in space",
        "frames/force",
    ),
    Quantity(
        "frame_moment",
        _FRAME,
        "N m",
        "moment of the same about the origin of the frame, in space",
        "frames/force",
    ),
    Quantity(
        "joint_force",
        _JOINT,
        "N",
        "force on the second body, in space",
        "joints/force",
        source="coupling_force",
    ),
    Quantity(
        "joint_moment",
        _JOINT,
        "N m",
        "moment on the second body, in space",
        "joints/moment",
        source="coupling_moment",
    ),
    Quantity(
        "joint_multiplier",
        _CONSTRAINT,
        ("N", "N m"),
        "Lagrange multiplier of each constraint",
        "joints/multipliers",
        source="multiplier",
    ),
    Quantity(
        "joint_position",
        _COORDINATE,
        ("m", "rad"),
        "value of each coordinate; angles go on over full turns",
        "joints/{}",
    ),
    Quantity(
        "joint_rate",
        _COORDINATE,
        ("m s-1", "rad s-1"),
        "rate of each coordinate",
        "joints/{}_rate",
    ),
    Quantity(
        "coupler_force",
        _COUPLER,
        ("N", "N m"),
        "on the first coordinate; on each other one times its ratio over the first",
        "couplers/force",
        source="multiplier",
    ),
    Quantity(
        "spring_force",
        _SPRING,
        "N",
        "force on the second body, in space",
        "springs/force",
        source="coupling_force",
    ),
    Quantity(
        "spring_moment",
        _SPRING,
        "N m",
        "moment on the second body, in space",
        "springs/moment",
        source="coupling_moment",
    ),
    Quantity(
        "spring_multiplier",
        _COMPONENT,
        ("N", "N m"),
        "force or moment of each component",
        "springs/multipliers",
        source="multiplier",
    ),
    Quantity(
        "spring_coordinate",
        _COMPONENT,
        ("m", "rad"),
        "length or angle of each component",
        "springs/coordinates",
        source="coordinate",
    ),
    Quantity(
        "joint_friction",
        _RUBBING,
        ("N", "N m"),
        "friction, on the coordinate",
        "joints/{}",
        source="friction_force",
    ),
    Quantity(
        "joint_friction_state",
        _RUBBING,
        ("1", "1"),
        "0 before the first step, 1 sticks, 2 slips",
        "joints/{}_state",
        source="friction_state",
        integer=True,
    ),
    Quantity(
        "contact_gap", _CONTACT, "m", "gap, negative where it is closed", "contacts/gap", "gap"
    ),
    Quantity(
        "contact_force",
        (*_CONTACT, "contact_axis"),
        "N",
        "force on the second body, along normal and tangents",
        "contacts/force",
    ),
    Quantity(
        "contact_normal",
        (*_CONTACT, "axis"),
        "1",
        "normal of the shape, towards the second body, in space",
        "contacts/normal",
    ),
    Quantity(
        "contact_point",
        (*_CONTACT, "axis"),
        "m",
        "point of the ball nearest to the shape, in space",
        "contacts/point",
    ),
    Quantity(
        "contact_slip",
        (*_CONTACT, "tangent_axis"),
        "m s-1",
        "rates of slip of the second body, 0 where it is open",
        "contacts/slip",
    ),
    Quantity(
        "contact_state",
        _CONTACT,
        "1",
        "0 open, 1 closed or sticks, 2 slips",
        "contacts/state",
        integer=True,
    ),
    Quantity(
        "contact_impulse",
        _CONTACT,
        "N s",
        "integral of the normal force since t = 0",
        "contacts/impulse",
        "normal_impulse",
        since=8,
    ),
    Quantity(
        "stop_gap",
        _STOP,
        ("m", "rad"),
        "distance to the nearer limit, negative beyond it",
        "stops/gap",
        "gap",
    ),
    Quantity(
        "stop_force",
        _STOP,
        ("N", "N m"),
        "force or moment on the coordinate",
        "stops/force",
        "normal_force",
    ),
    Quantity(
        "stop_state",
        _STOP,
        "1",
        "0 open, 1 closed",
        "stops/state",
        "contact_state",
        integer=True,
    ),
    Quantity(
        "stop_impulse",
        _STOP,
        ("N s", "N m s"),
        "integral of the force or moment since t = 0",
        "stops/impulse",
        "normal_impulse",
        since=8,
    ),
    Quantity("pattern_load", _PATTERN, "1", "amplitude of each load pattern", "patterns/load"),
    Quantity(
        "pattern_displacement",
        _PATTERN,
        "J",
        "elastic displacement that the amplitude 1 does work on",
        "patterns/displacement",
    ),
    Quantity(
        "sensor_value",
        _CHANNEL,
        ("m", "1", "Pa"),
        "elastic displacement, strain or stress, in body axes",
        "sensors/value",
    ),
    Quantity(
        "sensor_rate",
        _CHANNEL,
        ("m s-1", "s-1", "Pa s-1"),
        "rate of the same",
        "sensors/rate",
    ),
    Quantity(
        "sensor_acceleration",
        _CHANNEL,
        ("m s-2", "s-2", "Pa s-2"),
        "acceleration in space of a point, in body axes; second derivative of strain or stress",
        "sensors/acceleration",
    ),
    Quantity(
        "motor_torque", _MOTOR, ("N", "N m"), "force or torque on the coordinate", "motors/torque"
    ),
    Quantity(
        "motor_reference",
        _MOTOR,
        ("m", "rad"),
        "reference, 0 where no position is followed",
        "motors/reference",
    ),
    Quantity(
        "motor_error",
        _MOTOR,
        ("m", "rad"),
        "reference less coordinate, 0 where no position is followed",
        "motors/error",
    ),
    Quantity("motor_power", _MOTOR, "W", "power that it gives", "motors/power"),
    Quantity("motor_work", _MOTOR, "J", "work since t = 0", "motors/work"),
    Quantity(
        "motor_state",
        _MOTOR,
        "1",
        "-1 at the lower limit, 1 at the upper one, 0 between them",
        "motors/state",
        integer=True,
    ),
    _energy("kinetic_energy", "kinetic", "kinetic energy of the rigid motions"),
    _energy("elastic_energy", "elastic", "elastic energy of flexible bodies, vibration included"),
    _energy("spring_energy", "springs", "energy stored in springs, contacts and friction"),
    _energy("potential_energy", "potential", "potential energy of gravity"),
    _energy("external_work", "work", "work of loads, drives and motors since t = 0"),
    _energy(
        "dissipated_energy",
        "dissipated",
        "energy taken by dampers and modal damping since t = 0",
        derive=_dissipated,
    ),
    _energy(
        "numerical_dissipation",
        "numerical",
        "energy that time stepping took from the modes since t = 0",
        derive=_numerical,
    ),
    _energy(
        "energy_balance",
        "balance",
        "change of all energies since t = 0, and both dissipations, less external work",
        derive=_balance,
    ),
    Quantity(
        "linear_momentum",
        _VECTOR,
        "kg m s-1",
        "momentum of all bodies, in space",
        "momentum/linear",
    ),
    Quantity(
        "angular_momentum",
        _VECTOR,
        "kg m2 s-1",
        "angular momentum about the origin, in space",
        "momentum/angular",
    ),
    Quantity(
        "newton_iterations",
        _TIME,
        "1",
        "iterations of Newton's method",
        "solver/iterations",
        integer=True,
    ),
    Quantity(
        "newton_residual",
        _TIME,
        "1",
        "relative residual at the end of the step",
        "solver/residual",
    ),
)

SOURCES = (
    _energy("compliance_work", "compliance_work", "work of springs and dampers on bodies"),
    _energy("modal_loss", "modal_loss", "work of the loads on modes, less their energy"),
    _energy("modal_damping", "modal_damping", "energy taken by modal damping"),
)
"""further arrays of the time loop, from which quantities are derived"""


def _event(name: str, unit: str | tuple[str, ...], description: str, **more: Any) -> Quantity:
    return Quantity(f"event_{name}", ("event",), unit, description, f"events/{name}", **more)


EVENTS = (
    _event("start", "s", "time when it closed"),
    _event("end", "s", "time when it opened, or the run ended"),
    _event("steps", "1", "steps at whose end it was closed", integer=True),
    _event("peak", ("N", "N m"), "largest normal force"),
    _event("impulse", ("N s", "N m s"), "integral of the normal force over time"),
    _event("closing_speed", ("m s-1", "rad s-1"), "speed of approach; 0: closed from the start"),
    _event("opening_speed", ("m s-1", "rad s-1"), "speed of departure; no number: still closed"),
    _event("restitution", "1", "opening speed over closing speed"),
    _event("dissipated", "J", "energy that it took, friction included"),
)
"""the numbers of an event, in the order of the time loop"""
EVENT_NUMBER = Quantity("event", ("event",), "1", "number of the event", "", integer=True)
EVENT_OF = Quantity(
    "event_of", ("event",), "1", "number of its owner in event_owner, from 0", "", integer=True
)

SHARED = {
    "stop": "contact",
    "joint": "coupling",
    "spring": "coupling",
    "joint_constraint": "row",
    "spring_component": "row",
    "coupler": "row",
}
"""dimensions that couplings share in the time loop"""


def output_fields() -> dict[str, tuple[tuple[str, ...], bool]]:
    """The arrays that the time loop fills: dimensions, and True for integers, by name."""
    return {
        quantity.source: (
            tuple(SHARED.get(dimension, dimension) for dimension in quantity.dimensions),
            quantity.integer,
        )
        for quantity in (*QUANTITIES, *SOURCES)
        if quantity.source
    }


OWNERS = {
    "bodies": "body",
    "frames": "frame",
    "joints": "joint",
    "springs": "spring",
    "couplers": "coupler",
    "contacts": "contact",
    "stops": "stop",
    "patterns": "pattern",
    "sensors": "sensor",
    "motors": "motor",
}
"""the dimension of the owners of a group"""


class SuperelementFile(NamedTuple):
    """The file of a superelement, "" where there is none, with its SHA-256.

    As long as results are in memory, with the time of its last change [ns] and its size instead,
    which cost nothing.
    """

    path: str
    digest: str = ""
    stamp: tuple[int, int] | None = None

    @classmethod
    def of(cls, path: str | os.PathLike[str]) -> "SuperelementFile":
        """The file at a path as it is now."""
        path = resolved(Path(path))
        return cls(str(path), stamp=_stamp(path))

    def hashed(self) -> "SuperelementFile":
        """This file with its SHA-256."""
        return self._replace(digest=sha256(self.path), stamp=None) if self.stamp else self

    def change(self) -> str:
        """The difference of the file at the path from this one; "" if it is the same."""
        if self.stamp is not None:
            return "" if _stamp(Path(self.path)) == self.stamp else "it was written anew"
        digest = sha256(self.path)
        return "" if digest == self.digest else f"expected SHA-256 {self.digest}, found {digest}"


def _stamp(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_mtime_ns, status.st_size


@dataclass(frozen=True)
class Contents:
    """The contents of results: entries of dimensions, quantities, files of superelements, checks.

    checks: of the validity of the run, by name (validity.py). space: outlines and connections; None
    where they are in a file that is read, which has them when they are asked for.
    """

    axes: Axes
    quantities: tuple[Quantity, ...]
    superelements: Mapping[str, SuperelementFile]
    checks: tuple[str, ...] = ()
    space: Space | None = None

    @property
    def recorded(self) -> tuple[str, ...]:
        """The groups: "bodies/hub", "frames/beam.tip", "energy", ..."""
        owned = [
            f"{group}/{name}"
            for group, dimension in OWNERS.items()
            if dimension in self.axes
            for name in sorted(self.axes[dimension].names)
        ]
        groups = {quantity.group for quantity in self.quantities}
        return (*owned, *(group for group in ("energy", "momentum") if group in groups))

    def difference(self, other: "Contents") -> str:
        """The first difference of the variables of others, in words; "" if there is none."""
        names, others = ([q.name for q in c.quantities] for c in (self, other))
        if names != others:
            odd = sorted({*names} ^ {*others})
            return f"other variables are recorded: {', '.join(odd)}"
        for name in sorted({*self.axes, *other.axes}):
            axes = (self.axes.get(name, Axis(())).names, other.axes.get(name, Axis(())).names)
            if axes[0] != axes[1]:
                return f"{name}: expected {', '.join(axes[0])}, found {', '.join(axes[1])}"
        return ""


def lay_out(
    axes: Axes,
    superelements: Mapping[str, SuperelementFile],
    selects: Callable[[str], bool],
    checks: tuple[str, ...] = (),
) -> Contents:
    """The contents that are recorded of all entries and quantities, with checks of validity.

    selects: True for a group to record, "bodies/hub" or "energy".
    """
    kept = {name: Axis(entries) for name, entries in _FIXED.items()}
    for name, axis in axes.items():
        dimension = DIMENSIONS[name]
        chosen = axis.keep(
            lambda entry, d=dimension: (
                not d.group  # type: ignore[misc]
                or selects(f"{d.group}/{entry.rpartition('.')[0] if d.ragged else entry}")
            )
        )
        if len(chosen):
            kept[name] = chosen
    quantities = tuple(
        quantity
        for quantity in QUANTITIES
        if set(quantity.dimensions[1:]) <= kept.keys()
        and (quantity.owned is not None or quantity.name == "time" or selects(quantity.group))
    )
    used = {dimension for quantity in quantities for dimension in quantity.dimensions}
    kept = {name: axis for name, axis in kept.items() if name in used or name not in _FIXED}
    return Contents(kept, quantities, superelements, checks)


def attributes_of(
    axes: Axes, group: str, owner: str, quantities: Sequence[Quantity] = QUANTITIES
) -> Iterator[tuple[str, Quantity, Any]]:
    """The attributes of an owner, each with its quantity and entries of the quantity's dimension.

    An entry is a number, or a slice of those that the owner has of a ragged dimension, which may be
    none. quantities: those that there are, in a file of an earlier version fewer.
    """
    for quantity in QUANTITIES:
        dimension = quantity.owned
        if quantity.group != group or dimension is None:
            continue
        if quantity.since > EARLIEST and quantity not in quantities:
            continue
        axis = axes.get(dimension.name, Axis(()))
        if not dimension.ragged:
            yield quantity.attribute, quantity, axis.number(owner)
            continue
        entries = axis.range_of(owner)
        if "{}" not in quantity.attribute:
            yield quantity.attribute, quantity, slice(entries.start, entries.stop)
            continue
        for i in entries:
            coordinate = axis.names[i].rpartition(".")[2]
            yield quantity.attribute.format(coordinate), quantity, i


def table() -> str:
    """The variables as a table in Markdown, for the documentation."""
    lines = ["| variable | dimensions | unit | |", "|---|---|---|---|"]
    for quantity in (*QUANTITIES, EVENT_NUMBER, EVENT_OF, *EVENTS):
        unit = quantity.unit
        if not isinstance(unit, str):
            unit = " or ".join(dict.fromkeys(unit))
        lines.append(
            f"| `{quantity.name}` | {', '.join(quantity.dimensions)} | {unit} "
            f"| {quantity.description} |"
        )
    return "\n".join(lines)
