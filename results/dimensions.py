"""The dimensions of results, and the entries that a run has along each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field


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
        Dimension(
            "mode",
            "modes of bodies whose surfaces are in contact, as BODY.NUMBER",
            "body_modes",
            ragged=True,
        ),
        Dimension(
            "surface_load",
            "nodes of surfaces in contact, as BODY.NODE by the rows of the superelement",
            "body_modes",
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
        Dimension("surface_contact", "contacts of surfaces", "surface_contacts"),
        Dimension(
            "surface_row",
            "rows of contacts of surfaces, as CONTACT.NODE: one for each corner of facets",
            "surface_nodes",
            ragged=True,
        ),
        Dimension(
            "surface_node",
            "nodes of the first surface of contacts of surfaces, as CONTACT.NODE",
            "surface_nodes",
            ragged=True,
        ),
        Dimension("stop", "stops of joint coordinates", "stops"),
        Dimension("motor", "motors on joint coordinates", "motors"),
        Dimension("fmu", "FMUs that give inputs of the model", "fmus"),
        Dimension("fmu_input", "inputs that FMUs give, as FMU.INPUT", "fmus", ragged=True),
        Dimension(
            "joint_with_friction", "joints with friction, as JOINT.friction", "joints", ragged=True
        ),
        Dimension("pattern", "load patterns of flexible bodies, as BODY.PATTERN", "patterns"),
        Dimension("sensor", "sensors of flexible bodies, as BODY.SENSOR", "sensors"),
        Dimension(
            "sensor_channel", "channels of sensors, as BODY.SENSOR.CHANNEL", "sensors", ragged=True
        ),
        Dimension("event", "times that a contact or stop was closed, in the order of their ends"),
        Dimension("event_owner", "contacts and stops whose events are counted"),
        Dimension("flexible_body", "bodies with superelements"),
        Dimension("check", "checks of the validity of the run, as CRITERION:OWNER"),
    )
}

# The dimensions whose entries are the same in every file.
FIXED_ENTRIES = {
    name: dimension.entries for name, dimension in DIMENSIONS.items() if dimension.entries
}


@dataclass(frozen=True)
class Axis:
    """The entries of a dimension.

    angular: True for each that is an angle or belongs to one, where some may be; of channels of
    sensors and inputs by FMUs the number of its unit; rows: of each in the arrays of the time loop,
    which a file does not keep.
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
