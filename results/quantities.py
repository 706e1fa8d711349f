"""Quantities over time by name, as a user asks for them: KIND:NAME[:NAME][:AXIS].

    angular_velocity:hub:z          displacement:beam.tip:hub.rim:y          energy:kinetic

All vectors are (n, 3), one row for each recorded step, and in space unless said otherwise; those
across a contact are (n, 2), along its tangents t1 and t2.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..superelement.sensor import KINDS as KINDS_OF_SENSORS
from ..superelement.validation import Array
from .errors import QuantityError
from .motion import ContactMotion, Coupling, MotorMotion, StopMotion
from .results import Results
from .rotations import inverse, product, rotate, twists

AXES = ("x", "y", "z")
TANGENTS = ("t1", "t2")
STRESSES = KINDS_OF_SENSORS["stress"]


def position(results: Results, name: str) -> Array:
    """Position of the center of mass of a body, or of the origin of a frame [m]."""
    return results.body(name).x if _is_body(results, name) else results.frame(name).position


def rotation(results: Results, name: str) -> Array:
    """The axes of a body or a frame to space, (n, 4) unit quaternion."""
    return results.body(name).R if _is_body(results, name) else results.frame(name).rotation


def angle(results: Results, name: str) -> Array:
    """Angles by which a body or frame has turned since t = 0 about the axes of space [rad].

    They are continued over full turns, by the angular velocity, where one row is followed by the
    next after several. Each column is the twist about its axis (`twists`): for a body that turns
    about one axis, its angle.
    """
    q, omega = rotation(results, name), angular_velocity(results, name)
    steps = 0.5 * np.diff(results.time)[:, None] * (omega[1:] + omega[:-1])
    expected = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    return twists(product(q, inverse(q[0])), expected)


def velocity(results: Results, name: str) -> Array:
    """Velocity of the center of mass of a body, or of the origin of a frame [m/s]."""
    return _velocities(results, name)[:, :3]


def acceleration(results: Results, name: str) -> Array:
    """Acceleration of the center of mass of a body, or of the origin of a frame [m/s^2]."""
    return _accelerations(results, name)[:, :3]


def angular_velocity(results: Results, name: str) -> Array:
    """Angular velocity R omega of a body, or that of a frame [rad/s]."""
    return _in_space(results, name, _velocities(results, name)[:, 3:])


def angular_acceleration(results: Results, name: str) -> Array:
    """Angular acceleration d/dt (R omega) = R omega_dot of a body, or of a frame [rad/s^2]."""
    return _in_space(results, name, _accelerations(results, name)[:, 3:])


def displacement(results: Results, name: str, seen_from: str) -> Array:
    """The displacement of a body or frame in the axes D of another, since t = 0 [m].

        u(t) = s(t) - s(0),    s = D^T (r - r_reference)

    With the tip of a beam seen from the frame of the hub that carries it, this is the tip
    deflection, eq. (96).
    """
    apart = position(results, name) - position(results, seen_from)
    seen = rotate(inverse(rotation(results, seen_from)), apart)
    change: Array = seen - seen[0]
    return change


def elastic_displacement(results: Results, interface: str) -> Array:
    """Elastic displacement of an interface, in the axes of its body [m]."""
    return _elastic(results, interface)[:, :3]


def elastic_rotation(results: Results, interface: str) -> Array:
    """Elastic rotation vector of an interface, in the axes of its body [rad]."""
    return _elastic(results, interface)[:, 3:]


def force(results: Results, coupling: str) -> Array:
    """Force of a joint or spring on the second of its frames [N]."""
    return _coupling(results, coupling).force


def moment(results: Results, coupling: str) -> Array:
    """Moment of a joint or spring on the second of its frames, about it [N m]."""
    return _coupling(results, coupling).moment


def coordinate(results: Results, joint: str, name: str) -> Array:
    """A coordinate of a joint or its rate, as `angle` or `distance_rate` (n,)."""
    coordinates = results.joint(_known("joint", joint, results.joints)).coordinates
    return coordinates[_known(f"coordinate of {joint}", name, coordinates)]


def coordinate_unit(results: Results, joint: str, name: str) -> str:
    """The unit of a coordinate or of its rate."""
    return results.unit("joints", joint, name).replace(" s-1", "/s")


def gap(results: Results, contact: str) -> Array:
    """The gap of a contact, or the distance of a stop to its nearer limit (n,) [m, rad]."""
    return _contact(results, contact).gap


def normal_force(results: Results, contact: str) -> Array:
    """The force along the normal of a contact, or of a stop on its coordinate (n,) [N, N m]."""
    force = _contact(results, contact).force
    return force if force.ndim == 1 else force[:, 0]


def impulse(results: Results, contact: str) -> Array:
    """The integral of the normal force of a contact or stop since t = 0 (n,) [N s, N m s]."""
    found = _contact(results, contact).impulse
    if len(found) < len(results.time):
        raise QuantityError(
            f"{results.name} is of an earlier version, which has the impulse of each event alone"
        )
    return found


def friction_force(results: Results, contact: str) -> Array:
    """Friction of a contact on the second body, along t1 and t2 (n, 2) [N]."""
    return _touching(results, contact).force[:, 1:]


def slip(results: Results, contact: str) -> Array:
    """Rates of slip of the second body of a contact, along t1 and t2 (n, 2) [m/s]."""
    return _touching(results, contact).slip


def contact_state(results: Results, contact: str) -> Array:
    """Of a contact or stop: 0 open, 1 closed or sticks, 2 slips (n,)."""
    return _contact(results, contact).state


def coupler_force(results: Results, coupler: str) -> Array:
    """Force or moment of a coupler on its first coordinate (n,)."""
    return results.coupler(_known("coupler", coupler, results.couplers)).force


def coupler_force_unit(results: Results, coupler: str) -> str:
    return results.unit("couplers", coupler, "force")


def gap_unit(results: Results, contact: str) -> str:
    return _contact_unit(results, contact, "gap")


def normal_force_unit(results: Results, contact: str) -> str:
    return _contact_unit(results, contact, "force")


def impulse_unit(results: Results, contact: str) -> str:
    return _contact_unit(results, contact, "impulse")


def _contact_unit(results: Results, contact: str, attribute: str) -> str:
    return results.unit("stops" if contact in results.stops else "contacts", contact, attribute)


def strain(results: Results, sensor: str) -> Array:
    """The strain of a gauge (n,)."""
    return _reading(results, sensor, "strain")[:, 0]


def stress(results: Results, sensor: str) -> Array:
    """The stresses of a sensor, in the axes of its body (n, 6) [Pa]."""
    return _reading(results, sensor, "stress")


def sensor_displacement(results: Results, sensor: str) -> Array:
    """Elastic displacement of a sensor's point, in the axes of its body [m]."""
    return _reading(results, sensor, "motion")


def sensor_acceleration(results: Results, sensor: str) -> Array:
    """Acceleration in space of a sensor's point, in the axes of its body [m/s^2]."""
    _reading(results, sensor, "motion")
    return results.sensor(sensor).acceleration


def pattern_load(results: Results, pattern: str) -> Array:
    """The amplitude of a load pattern (n,)."""
    return results.pattern(_known("load pattern", pattern, sorted(results.patterns))).load


def motor_torque(results: Results, motor: str) -> Array:
    """The torque of a motor, or its force, on its coordinate (n,) [N m, N]."""
    return _motor(results, motor).torque


def motor_reference(results: Results, motor: str) -> Array:
    """The reference of a motor (n,) [rad, m]."""
    return _motor(results, motor).reference


def motor_error(results: Results, motor: str) -> Array:
    """The reference of a motor less its coordinate (n,) [rad, m]."""
    return _motor(results, motor).error


def motor_power(results: Results, motor: str) -> Array:
    """The power that a motor gives (n,) [W]."""
    return _motor(results, motor).power


def motor_work(results: Results, motor: str) -> Array:
    """The work of a motor since t = 0 (n,) [J]."""
    return _motor(results, motor).work


def motor_state(results: Results, motor: str) -> Array:
    """Of a motor: -1 at its lower limit, 1 at the upper one, 0 between them (n,)."""
    return _motor(results, motor).state


def motor_torque_unit(results: Results, motor: str) -> str:
    return results.unit("motors", motor, "torque")


def motor_angle_unit(results: Results, motor: str) -> str:
    return results.unit("motors", motor, "reference")


def linear_momentum(results: Results) -> Array:
    """Momentum of all bodies [kg m/s]."""
    _recorded(results, "momentum", "linear")
    return results.momentum.linear


def angular_momentum(results: Results) -> Array:
    """Angular momentum of all bodies about the origin [kg m^2/s]."""
    _recorded(results, "momentum", "angular")
    return results.momentum.angular


def energy(results: Results, name: str) -> Array:
    """An energy over time, as "kinetic" (n,) [J]."""
    values: Array = getattr(results.energy, _known("energy", name, sorted(results.energies)))
    return values


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its function of results and names, and its unit."""

    values: Callable[..., Array]
    unit: str | Callable[..., str]
    """or a function of the results and the names"""
    names: tuple[str, ...]
    """the meaning of each name"""
    axes: tuple[str, ...] = AXES
    """of its components; none: a scalar"""


KINDS = {
    "position": Kind(position, "m", ("BODY|FRAME",)),
    "displacement": Kind(displacement, "m", ("BODY|FRAME", "BODY|FRAME")),
    "velocity": Kind(velocity, "m/s", ("BODY|FRAME",)),
    "acceleration": Kind(acceleration, "m/s²", ("BODY|FRAME",)),
    "angle": Kind(angle, "rad", ("BODY|FRAME",)),
    "angular_velocity": Kind(angular_velocity, "rad/s", ("BODY|FRAME",)),
    "angular_acceleration": Kind(angular_acceleration, "rad/s²", ("BODY|FRAME",)),
    "elastic_displacement": Kind(elastic_displacement, "m", ("INTERFACE",)),
    "elastic_rotation": Kind(elastic_rotation, "rad", ("INTERFACE",)),
    "force": Kind(force, "N", ("JOINT|SPRING",)),
    "moment": Kind(moment, "N m", ("JOINT|SPRING",)),
    "coordinate": Kind(coordinate, coordinate_unit, ("JOINT", "COORDINATE"), axes=()),
    "coupler_force": Kind(coupler_force, coupler_force_unit, ("COUPLER",), axes=()),
    "gap": Kind(gap, gap_unit, ("CONTACT|STOP",), axes=()),
    "normal_force": Kind(normal_force, normal_force_unit, ("CONTACT|STOP",), axes=()),
    "impulse": Kind(impulse, impulse_unit, ("CONTACT|STOP",), axes=()),
    "friction_force": Kind(friction_force, "N", ("CONTACT",), axes=TANGENTS),
    "slip": Kind(slip, "m/s", ("CONTACT",), axes=TANGENTS),
    "contact_state": Kind(contact_state, "1", ("CONTACT|STOP",), axes=()),
    "strain": Kind(strain, "1", ("SENSOR",), axes=()),
    "stress": Kind(stress, "Pa", ("SENSOR",), axes=STRESSES),
    "sensor_displacement": Kind(sensor_displacement, "m", ("SENSOR",)),
    "sensor_acceleration": Kind(sensor_acceleration, "m/s²", ("SENSOR",)),
    "pattern_load": Kind(pattern_load, "1", ("PATTERN",), axes=()),
    "motor_torque": Kind(motor_torque, motor_torque_unit, ("MOTOR",), axes=()),
    "motor_reference": Kind(motor_reference, motor_angle_unit, ("MOTOR",), axes=()),
    "motor_error": Kind(motor_error, motor_angle_unit, ("MOTOR",), axes=()),
    "motor_power": Kind(motor_power, "W", ("MOTOR",), axes=()),
    "motor_work": Kind(motor_work, "J", ("MOTOR",), axes=()),
    "motor_state": Kind(motor_state, "1", ("MOTOR",), axes=()),
    "linear_momentum": Kind(linear_momentum, "kg m/s", ()),
    "angular_momentum": Kind(angular_momentum, "kg m²/s", ()),
    "energy": Kind(energy, "J", ("ENERGY",), axes=()),
}


class Evaluated(NamedTuple):
    """A quantity over time: values (n, axes), or (n,) of a scalar or of one axis."""

    kind: str
    names: tuple[str, ...]
    axis: str
    unit: str
    values: Array


def evaluate(results: Results, quantity: str) -> Evaluated:
    """A quantity by name; QuantityError names it and lists what there is."""
    kind_name, *names = quantity.split(":")
    if kind_name not in KINDS:
        raise QuantityError(
            f"{quantity}: no quantity {kind_name!r}; there are: {', '.join(map(usage, KINDS))}"
        )
    kind = KINDS[kind_name]
    names, axis = _divided(results, kind, names)
    if len(names) != len(kind.names) or axis not in ("", *kind.axes):
        raise QuantityError(f"{quantity}: expected {usage(kind_name)}")
    try:
        values = kind.values(results, *names)
        unit = kind.unit if isinstance(kind.unit, str) else kind.unit(results, *names)
    except QuantityError as error:
        raise QuantityError(f"{quantity}: {error}") from error
    if axis:
        values = values[:, kind.axes.index(axis)]
    return Evaluated(kind_name, tuple(names), axis, unit, values)


def usage(kind_name: str) -> str:
    """The form of a quantity of this kind, as in "force:JOINT|SPRING[:x|y|z]"."""
    kind = KINDS[kind_name]
    return ":".join([kind_name, *kind.names]) + (f"[:{'|'.join(kind.axes)}]" if kind.axes else "")


def _divided(results: Results, kind: Kind, parts: list[str]) -> tuple[list[str], str]:
    """The names and the axis, "" if none, of the parts of a quantity.

    Files of earlier versions have names with colons: there the first name takes the parts that are
    too many.
    """
    axis = parts[-1] if parts and parts[-1] in kind.axes else ""
    names = parts[: len(parts) - bool(axis)]
    surplus = len(names) - len(kind.names)
    if kind.names and surplus > 0:
        first = ":".join(names[: surplus + 1])
        if any(first in names_in_role(results, role) for role in kind.names[0].split("|")):
            return [first, *names[surplus + 1 :]], axis
    if kind.axes and len(parts) == len(kind.names) + 1:
        return parts[:-1], parts[-1]
    return parts, ""


def names_in_role(results: Results, role: str) -> tuple[str, ...]:
    """The names of all that has a role, as BODY or COORDINATE."""
    if role == "COORDINATE":
        every = [name for joint in results.joints for name in results.joint(joint).coordinates]
        return tuple(dict.fromkeys(every))
    plural = {"BODY": "bodies", "ENERGY": "energies"}.get(role, f"{role.lower()}s")
    names: tuple[str, ...] = getattr(results, plural)
    return names


def _is_body(results: Results, name: str) -> bool:
    bodies, frames = results.bodies, results.frames
    return _known("body or frame", name, (*sorted(bodies), *sorted(frames))) in bodies


def _velocities(results: Results, name: str) -> Array:
    return results.body(name).v if _is_body(results, name) else results.frame(name).velocity


def _accelerations(results: Results, name: str) -> Array:
    return results.body(name).v_dot if _is_body(results, name) else results.frame(name).acceleration


def _in_space(results: Results, name: str, vectors: Array) -> Array:
    """Vectors that results give in body axes for bodies, in space for frames."""
    return rotate(rotation(results, name), vectors) if _is_body(results, name) else vectors


def _coupling(results: Results, name: str) -> Coupling:
    known = (*sorted(results.joints), *sorted(results.springs))
    _known("joint or spring", name, known)
    return results.joint(name) if name in results.joints else results.spring(name)


def _contact(results: Results, name: str) -> ContactMotion | StopMotion:
    known = (*sorted(results.contacts), *sorted(results.stops))
    return results.contact(_known("contact or stop", name, known))


def _reading(results: Results, name: str, kind: str) -> Array:
    """The values of a sensor of a kind (n, channels)."""
    value = results.sensor(_known("sensor", name, sorted(results.sensors))).value
    (found,) = (
        own for own, channels in KINDS_OF_SENSORS.items() if len(channels) == value.shape[1]
    )
    if found != kind:
        raise QuantityError(f"sensor {name!r} reads {found}, not {kind}")
    return value


def _touching(results: Results, name: str) -> ContactMotion:
    motion = results.contact(_known("contact", name, sorted(results.contacts)))
    assert isinstance(motion, ContactMotion)
    return motion


def _motor(results: Results, name: str) -> MotorMotion:
    return results.motor(_known("motor", name, sorted(results.motors)))


def _elastic(results: Results, interface: str) -> Array:
    return results.frame(_known("interface", interface, sorted(results.interfaces))).u


def _recorded(results: Results, group: str, name: str) -> None:
    if group not in results.recorded:
        raise QuantityError(f"no {group} {name!r}; there are: none")


def _known(role: str, name: str, names: Iterable[str]) -> str:
    if name not in names:
        raise QuantityError(f"no {role} {name!r}; there are: {', '.join(names) or 'none'}")
    return name
