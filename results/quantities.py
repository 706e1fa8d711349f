"""Quantities over time by name, as a user asks for them: KIND:NAME[:NAME][:AXIS].

    angular_velocity:hub:z          displacement:beam.tip:hub.rim:y          energy:kinetic

All vectors are (n, 3), one row for each recorded step, and in space unless said otherwise; those
across a contact are (n, 2), along its tangents t1 and t2. What was recorded has the name that its
record gives it (motion.py); a few kinds more are computed here.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, NamedTuple

import numpy as np

from ..files.arrays import Array
from ..superelement.sensor import CHANNELS_OF_KIND
from .contents import attributes_of
from .dimensions import DIMENSIONS
from .errors import QuantityError
from .motion import INPUT_UNITS, OWNERS_OF_GROUP, QUANTITIES, BodyMotion, Energy, FrameMotion
from .quantity import Quantity, lacking, readable
from .results import Results
from .rotations import inverse, product, rotate, twists
from .spelling import quantity_of

AXES, TANGENTS = DIMENSIONS["axis"].entries, DIMENSIONS["tangent_axis"].entries
# Vectors in these units act about an axis; all others act along one.
UNITS_ABOUT_AXES = ("rad", "rad/s", "rad/s²", "N m", "kg m²/s")
BODY_OR_FRAME = "BODY|FRAME"


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its function of results and names, its unit, and how it is named.

    Examples
    --------
    >>> KINDS_BY_NAME["energy"].units, KINDS_BY_NAME["angle"].axes
    (('J',), ('x', 'y', 'z'))
    """

    values: Callable[..., Array]
    units: tuple[str, ...]
    """the one that it has, or those that it may have"""
    names: tuple[str, ...]
    """the meaning of each name"""
    description: str
    axes: tuple[str, ...] = AXES
    """of its components; none: a scalar"""
    unit_of: Callable[..., str] | None = None
    """of the results and the names, where it may have several"""
    words: tuple[str, ...] = ()
    """its name in a legend, if it is not this one; a second one is that of moments, where the first
    is that of forces"""
    along: str | None = None
    """what stands between that name and the axis, if not "about" or "along" by its unit"""
    states: str = ""
    """what its whole numbers mean"""
    in_peaks: bool = False
    """whether a table of peaks has it unasked"""
    section: str = ""
    """of the report that draws it unasked"""

    @property
    def preposition(self) -> str:
        """What stands between its name and the axis."""
        if self.along is not None:
            return self.along
        return "about" if self.units[0] in UNITS_ABOUT_AXES else "along"

    def unit(self, results: Results, *names: str) -> str:
        return self.unit_of(results, *names) if self.unit_of else self.units[0]


def angle(results: Results, name: str) -> Array:
    """Angles by which a body or frame has turned since t = 0 about the axes of space [rad].

    They are continued beyond full turns by the angular velocity, also where a row is several turns
    after the one before. Each column is the twist about its axis (`twists`): for a body that turns
    about one axis, its angle.

    Parameters
    ----------
    results : Results
    name : str
        Of a body or frame.

    Returns
    -------
    (n, 3) [rad]
        See `evaluate` for an example.
    """
    motion = _moving(results, name)
    q, omega = motion.rotation, motion.angular_velocity
    steps = 0.5 * np.diff(results.time)[:, None] * (omega[1:] + omega[:-1])
    expected = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    return twists(product(q, inverse(q[0])), expected)


def angular_velocity(results: Results, name: str) -> Array:
    """Angular velocity (n, 3) of a body or frame, in space [rad/s].

    See `evaluate` for an example.
    """
    return _moving(results, name).angular_velocity


def angular_acceleration(results: Results, name: str) -> Array:
    """Angular acceleration (n, 3) of a body or frame, in space [rad/s^2].

    See `evaluate` for an example.
    """
    return _moving(results, name).angular_acceleration


def displacement(results: Results, name: str, seen_from: str) -> Array:
    """The displacement of a body or frame in the axes D of another, since t = 0.

        u(t) = s(t) - s(0),    s = D^T (r - r_reference)

    With the tip of a beam seen from the frame of the hub that carries it, this is the tip
    deflection, eq. (96).

    Parameters
    ----------
    results : Results
    name, seen_from : str
        Of bodies or frames.

    Returns
    -------
    (n, 3) [m]
        See `evaluate` for an example.
    """
    seen, reference = _moving(results, name), _moving(results, seen_from)
    apart = seen.position - reference.position
    found = rotate(inverse(reference.rotation), apart)
    change: Array = found - found[0]
    return change


def coordinate(results: Results, joint: str, name: str) -> Array:
    """A coordinate of a joint or its rate (n,), as `angle` or `distance_rate`.

    Parameters
    ----------
    results : Results
    joint, name : str

    Returns
    -------
    (n,) [rad, m, rad/s, m/s]
        See `evaluate` for an example.
    """
    _coordinate(results, joint, name)
    return results.joint(joint).coordinates[name]


def fmu_input(results: Results, fmu: str, name: str) -> Array:
    """An input of the model (n,) that an FMU gives. See `evaluate` for an example."""
    found = results.fmu(_known("FMU", fmu, results.fmus)).outputs
    return found[_known(f"input by {fmu}", name, found)]


def energy(results: Results, name: str) -> Array:
    """An energy over time (n,) [J], as "kinetic". See `evaluate` for an example."""
    values: Array = getattr(results.energy, _known("energy", name, sorted(results.energies)))
    return values


def _coordinate(results: Results, joint: str, name: str) -> Quantity:
    """The record of a coordinate of a joint."""
    found = _coordinates(results, _known("joint", joint, results.joints))
    return found[_known(f"coordinate of {joint}", name, found)]


def _coordinates(results: Results, joint: str) -> dict[str, Quantity]:
    """The records of the coordinates of a joint, by their names."""
    contents = results.contents
    found = attributes_of(contents.quantities, contents.axes, "joints", joint)
    return {name: quantity for name, quantity, _ in found if "{}" in quantity.attribute}


def _moving(results: Results, name: str) -> BodyMotion | FrameMotion:
    _known_in_roles(results, BODY_OR_FRAME, name)
    return results.body(name) if name in results.bodies else results.frame(name)


def _role(record: Quantity) -> str:
    """The names that a record takes in `plot`: none where it is of the whole run."""
    return record.role or (
        OWNERS_OF_GROUP[record.group].upper() if record.group in OWNERS_OF_GROUP else ""
    )


def _record(records: Sequence[Quantity], results: Results, *owner: str) -> Quantity:
    """That of the records, as those of bodies and frames, which is of an owner."""
    if owner:
        _known_in_roles(results, "|".join(map(_role, records)), *owner)
        records = [one for one in records if owner[0] in names_in_role(results, _role(one))]
    record, contents = records[0], results.contents
    if record in contents.quantities:
        return record
    if not any(one.group == record.group for one in contents.quantities):
        raise QuantityError(f"no {record.group} {record.attribute!r}; there are: none")
    raise QuantityError(lacking(results.name, contents.version, repr(record.name), record.since))


def _recorded(
    names: Iterable[str], made: Callable[[Array], Array] = lambda values: values, **more: Any
) -> Kind:
    """What was recorded as these variables, of which each is of other owners.

    made: of their values; more: what is not as the records have it.
    """
    records = [one for name in names for one in QUANTITIES if one.name == name]
    first = records[0]

    def values(results: Results, *owner: str) -> Array:
        record = _record(records, results, *owner)
        return made(results.variable(record.name, owner="".join(owner)))

    def unit_of(results: Results, *owner: str) -> str:
        record, axes = _record(records, results, *owner), results.contents.axes
        entries = record.entries(axes, *owner) if owner else slice(None)
        return readable("".join(record.units(axes, entries)[:1]))

    return Kind(
        values,
        tuple(dict.fromkeys(readable(unit) for one in records for unit in one.all_units)),
        ("|".join(map(_role, records)),) if _role(first) else (),
        **{
            "description": "; ".join(dict.fromkeys(one.description for one in records)),
            "axes": first.components,
            "unit_of": unit_of,
            "words": max(map(_words, records), key=len),
            "states": first.states,
            "in_peaks": any(one.in_peaks for one in records),
            "section": first.section,
            **more,
        },
    )


def _of_sensor(
    kind: str, unit: str, description: str, variable: str = "sensor_value", **more: Any
) -> Kind:
    """What sensors of a kind read."""
    channels = CHANNELS_OF_KIND[kind]

    def values(results: Results, name: str) -> Array:
        _known_in_roles(results, "SENSOR", name)
        found = results.variable(variable, owner=name)
        if found.shape[1] != len(channels):
            (other,) = (
                own for own, axes in CHANNELS_OF_KIND.items() if len(axes) == found.shape[1]
            )
            raise QuantityError(f"sensor {name!r} reads {other}, not {kind}")
        return found if len(channels) > 1 else found[:, 0]

    axes = channels if len(channels) > 1 else ()
    return Kind(values, (unit,), ("SENSOR",), description, axes=axes, **more)


def _words(record: Quantity) -> tuple[str, ...]:
    if isinstance(record.words, tuple):
        return record.words
    name = record.plot or record.name
    return (record.words or name.removeprefix(f"{_role(record).lower()}_").replace("_", " "),)


def _of_records() -> dict[str, Kind]:
    """The kinds that were recorded under these names."""
    names: dict[str, list[str]] = {}
    for one in QUANTITIES:
        if one.plot:
            names.setdefault(one.plot, []).append(one.name)
    return {name: _recorded(variables) for name, variables in names.items()}


# As legends of plots have them.
ENERGY_LABELS = {one.attribute: _words(one)[0] for one in Energy.quantities}
KINDS_BY_NAME = _of_records() | {
    "displacement": Kind(
        displacement,
        ("m",),
        (BODY_OR_FRAME, BODY_OR_FRAME),
        "displacement of the first since t = 0, in the axes of the second",
    ),
    "angle": Kind(
        angle,
        ("rad",),
        (BODY_OR_FRAME,),
        "rotation since t = 0 about x, y, z; continues beyond full turns",
    ),
    "angular_velocity": Kind(
        angular_velocity, ("rad/s",), (BODY_OR_FRAME,), "angular velocity, in space"
    ),
    "angular_acceleration": Kind(
        angular_acceleration, ("rad/s²",), (BODY_OR_FRAME,), "angular acceleration, in space"
    ),
    "coordinate": Kind(
        coordinate,
        ("rad", "m", "rad/s", "m/s", "N m", "N", "1"),
        ("JOINT", "COORDINATE"),
        "`angle`, `distance_rate`, ...; `friction` on the coordinate; `friction_state`: 1 sticks, "
        "2 slips",
        axes=(),
        unit_of=lambda results, *names: readable(results.unit("joints", *names)),
    ),
    "fmu_input": Kind(
        fmu_input,
        tuple(map(readable, INPUT_UNITS)),
        ("FMU", "FMU_INPUT"),
        "input of the model that an FMU gives, by its name",
        axes=(),
        words=("input by an FMU",),
        unit_of=lambda results, *names: readable(results.unit("fmus", *names)),
    ),
    "energy": Kind(energy, ("J",), ("ENERGY",), ", ".join(ENERGY_LABELS), axes=()),
    "normal_force": _recorded(
        ("contact_force", "stop_force", "surface_contact_normal_force"),
        lambda force: force if force.ndim == 1 else force[:, 0],
        axes=(),
        description="normal force on the second body, or force on the coordinate; of surfaces the "
        "sum of all rows",
        words=("normal force", "moment"),
        in_peaks=True,
        section="Contacts",
    ),
    "friction_force": _recorded(
        ("contact_force",),
        lambda force: force[:, 1:],
        axes=TANGENTS,
        description="friction force on the second body along t1, t2",
        words=("friction force",),
    ),
    "strain": _of_sensor("strain", "1", "strain of a gauge", in_peaks=True, section="Sensors"),
    "stress": _of_sensor(
        "stress",
        "Pa",
        "stress, `xx` to `xy`, in body axes",
        along="",
        in_peaks=True,
        section="Sensors",
    ),
    "sensor_displacement": _of_sensor(
        "motion",
        "m",
        "elastic displacement of its point, in body axes",
        words=("elastic displacement",),
    ),
    "sensor_acceleration": _of_sensor(
        "motion",
        "m/s²",
        "acceleration of its point in space, in body axes",
        variable="sensor_acceleration",
        words=("acceleration",),
        along="along body",
        in_peaks=True,
    ),
}

position = KINDS_BY_NAME["position"].values
"""Position of the center of mass of a body, or of the origin of a frame [m]."""
velocity = KINDS_BY_NAME["velocity"].values
"""Velocity of the center of mass of a body, or of the origin of a frame [m/s]."""
acceleration = KINDS_BY_NAME["acceleration"].values
"""Acceleration of the center of mass of a body, or of the origin of a frame [m/s^2]."""
elastic_displacement = KINDS_BY_NAME["elastic_displacement"].values
"""Elastic displacement of an interface, in the axes of its body [m]."""
elastic_rotation = KINDS_BY_NAME["elastic_rotation"].values
"""Elastic rotation vector of an interface, in the axes of its body [rad]."""
force = KINDS_BY_NAME["force"].values
"""Force of a joint or spring on the second of its frames [N]."""
moment = KINDS_BY_NAME["moment"].values
"""Moment of a joint or spring on the second of its frames, about it [N m]."""
linear_momentum = KINDS_BY_NAME["linear_momentum"].values
"""Momentum of all bodies [kg m/s]."""
angular_momentum = KINDS_BY_NAME["angular_momentum"].values
"""Angular momentum of all bodies about the origin [kg m^2/s]."""


class Evaluated(NamedTuple):
    """A quantity over time: values (n, axes), or (n,) of a scalar or of one axis.

    See `evaluate` for an example.
    """

    kind: str
    names: tuple[str, ...]
    axis: str
    unit: str
    values: Array
    states: str = ""
    """what its whole numbers mean"""


def _meant(results: Results, kind: str) -> str:
    """The quantities that a name which is none may stand for, as a question."""
    roles = {role for one in KINDS_BY_NAME.values() for role in "|".join(one.names).split("|")}
    owners = [name for role in roles - {""} for name in names_in_role(results, role)]

    def coordinates(joint: str) -> Collection[str]:
        return _coordinates(results, joint) if joint in results.joints else ()

    with suppress(QuantityError):
        meant = quantity_of(kind, KINDS_BY_NAME, owners, coordinates)
        if meant.partition(":")[0] in KINDS_BY_NAME:
            return f"did you mean {meant!r}? "
    begun = [known for known in KINDS_BY_NAME if kind and known.startswith(kind)]
    near = begun or get_close_matches(kind, KINDS_BY_NAME, cutoff=0.75)
    return f"did you mean {' or '.join(map(repr, near[:3]))}? " if near else ""


def evaluate(results: Results, quantity: str) -> Evaluated:
    """A quantity by the name that `plot` and studies take, KIND:NAME[:NAME][:AXIS].

    Parameters
    ----------
    results : Results
    quantity : str

    Returns
    -------
    Evaluated

    Raises
    ------
    QuantityError
        Names the quantity, and lists what the results have.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> speed = evaluate(results, "velocity:ball:z")
    >>> round(float(speed.values[-1]), 6), speed.unit
    (-10.0, 'm/s')
    >>> evaluate(results, "energy:kinetic").values.shape
    (11,)
    >>> evaluate(results, "angle:ball").values.shape
    (11, 3)
    """
    kind_name, *names = quantity.split(":")
    if kind_name == "von_mises":
        raise QuantityError(
            f"{quantity}: a field on the surface of a body, not one number over time: "
            f"`duhamel peaks RESULTS.h5 von_mises:BODY` tells its largest value, and "
            f"`duhamel plot RESULTS.h5 --field von_mises:BODY` draws it"
        )
    if kind_name not in KINDS_BY_NAME:
        raise QuantityError(
            f"{quantity}: no quantity {kind_name!r}; {_meant(results, kind_name)}there are: "
            f"{', '.join(map(usage, KINDS_BY_NAME))}"
        )
    kind = KINDS_BY_NAME[kind_name]
    names, axis = _divided(results, kind, names)
    if len(names) != len(kind.names) or axis not in ("", *kind.axes):
        raise QuantityError(f"{quantity}: expected {usage(kind_name)}")
    try:
        values = kind.values(results, *names)
        unit = kind.unit(results, *names)
    except QuantityError as error:
        raise QuantityError(f"{quantity}: {error}") from error
    states = _coordinate(results, *names).states if kind_name == "coordinate" else kind.states
    if axis:
        values = values[:, kind.axes.index(axis)]
    return Evaluated(kind_name, tuple(names), axis, unit, values, states)


def words(kind_name: str, unit: str) -> str:
    """The name of a kind in a legend, of a quantity that has this unit.

    Examples
    --------
    >>> words("normal_force", "N"), words("normal_force", "N m")
    ('normal force', 'moment')
    """
    given = KINDS_BY_NAME[kind_name].words or (kind_name.replace("_", " "),)
    return given["N m" in unit and len(given) > 1]


def usage(kind_name: str) -> str:
    """The form of a quantity of this kind.

    Examples
    --------
    >>> usage("displacement")
    'displacement:BODY|FRAME:BODY|FRAME[:x|y|z]'
    """
    kind = KINDS_BY_NAME[kind_name]
    return ":".join([kind_name, *kind.names]) + (f"[:{'|'.join(kind.axes)}]" if kind.axes else "")


def table() -> str:
    """The kinds as a table in Markdown, for the documentation.

    Examples
    --------
    >>> table().splitlines()[0]
    '| written | unit | what |'
    """
    lines = ["| written | unit | what |", "|---|---|---|"]
    for name, kind in KINDS_BY_NAME.items():
        roles = [role.split("|") for role in kind.names]
        written = ":".join([name, *(first for first, *_ in roles)])
        forms = " or ".join(f"`{form}`" for form in (written, *(roles[0][1:] if roles else ())))
        lines.append(f"| {forms} | {' or '.join(kind.units)} | {kind.description} |")
    return "\n".join(lines)


def _divided(results: Results, kind: Kind, parts: list[str]) -> tuple[list[str], str]:
    """The names and the axis, "" if none, of the parts of a quantity.

    Files of earlier versions have names with colons: there the first name takes the parts that are
    too many.
    """
    # A name that is also an axis is the axis if it stands last.
    axis = parts[-1] if parts and parts[-1] in kind.axes else ""
    names = parts[: len(parts) - bool(axis)]
    surplus = len(names) - len(kind.names)
    if kind.names and surplus > 0:
        first = ":".join(names[: surplus + 1])
        if any(first in names_in_role(results, role) for role in kind.names[0].split("|")):
            return [first, *names[surplus + 1 :]], axis
    # One part too many can only be a misspelled axis; the caller reports it.
    if kind.axes and len(parts) == len(kind.names) + 1:
        return parts[:-1], parts[-1]
    return parts, ""


def names_in_role(results: Results, role: str) -> tuple[str, ...]:
    """The names of everything that has a role, as BODY or COORDINATE.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism()
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> names_in_role(m.simulate(0.1, step=0.1).results, "BODY")
    ('ball',)
    """
    if role == "COORDINATE":
        every = [name for joint in results.joints for name in _coordinates(results, joint)]
        return tuple(dict.fromkeys(every))
    if role == "FMU_INPUT":
        given = [name for fmu in results.fmus for name in results.fmu(fmu).outputs]
        return tuple(dict.fromkeys(given))
    plural = {"BODY": "bodies", "ENERGY": "energies"}.get(role, f"{role.lower()}s")
    names: tuple[str, ...] = getattr(results, plural)
    return names


def _known_in_roles(results: Results, roles: str, name: str) -> None:
    """QuantityError for a name that nothing has in one of the roles, as "BODY|FRAME"."""
    every = [known for role in roles.split("|") for known in sorted(names_in_role(results, role))]
    _known(roles.lower().replace("|", " or ").replace("_", " "), name, every)


def _known(role: str, name: str, names: Iterable[str]) -> str:
    if name not in names:
        raise QuantityError(f"no {role} {name!r}; there are: {', '.join(names) or 'none'}")
    return name
