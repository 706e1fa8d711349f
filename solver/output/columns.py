"""The output of the time loop, and the entries of results as columns of it."""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ...inputs.errors import did_you_mean
from ...results.contents import Contents, SuperelementFile, attributes_of, lay_out
from ...results.dimensions import Axis
from ...results.motion import INPUT_UNITS, OWNERS_OF_GROUP, QUANTITIES
from ...results.quantity import Quantity
from ...superelement.sensor import CHANNELS_OF_KIND
from ..arrays import Array
from ..couplings.coupling import GROUND
from ..errors import ModelError
from ..lower.lower import LoweredModel, pattern_names
from ..lower.surfaces import flexible_surfaces
from ..model.bodies import FlexibleBody
from ..model.model import Model
from ..signals.curves import Input
from ..step.system import Output

SENSOR_KINDS = tuple(CHANNELS_OF_KIND)
"""in the order of the units of `sensor_value`"""


def requested(lowered: LoweredModel, checks: tuple[str, ...] = ()) -> Contents:
    """The contents that the model requests, and checks of validity by name.

    `ModelError` for an unknown quantity.
    """
    check_request(lowered)
    files = {name: _file_of(body) for name, body in lowered.model.flexible_bodies.items()}
    return lay_out(axes_of(lowered), files, lowered.model.settings.output.selects, checks)


def _file_of(body: FlexibleBody) -> SuperelementFile:
    """The file of its superelement, and the parameters that are not those of the file."""
    variation = body.superelement.variation
    text = "" if variation is None else variation.text
    return (
        SuperelementFile.of(body.source, text)
        if body.source
        else SuperelementFile("", variation=text)
    )


def check_request(lowered: LoweredModel) -> None:
    """`ModelError` for an unknown quantity among those that the model requests."""
    request = lowered.model.settings.output
    if request.quantities is None:
        return
    axes = axes_of(lowered)
    owned = [
        f"{group}/{name}" for group, key in OWNERS_OF_GROUP.items() for name in axes[key].names
    ]
    request.check([*owned, "energy", "momentum", "solver"])


def axes_of(lowered: LoweredModel) -> dict[str, Axis]:
    """The entries of all dimensions, with their columns in the output."""
    model = lowered.model
    couplings = lowered.system.couplings
    owners: dict[str, list[tuple[int, str]]] = {
        "body": list(enumerate(lowered.body_names)),
        "frame": [(f, name) for f, name in enumerate(lowered.frame_names) if _on_body(name)],
        "joint": _numbered(model, "joint"),
        "spring": _numbered(model, "spring"),
    }
    axes = {key: _axis(entries) for key, entries in owners.items()}
    numbers = [
        f"{name}.{i + 1}"
        for name, r in zip(model.flexible_bodies, lowered.system.elastic.second.r, strict=True)
        for i in range(int(r))
    ]
    # False for each: coordinates of second order are lengths.
    axes["second_order_coordinate"] = _axis(list(enumerate(numbers)), [False] * len(numbers))
    lengths = lowered.measures_lengths.tolist()
    ranges = list(pairwise(couplings.range.tolist()))
    # Joints have different numbers of rows: theirs are one long dimension, which the names divide.
    for key, ragged in (("joint", "joint_constraint"), ("spring", "spring_component")):
        entries = [
            (row, f"{name}.{row - ranges[j][0] + 1}")
            for j, name in owners[key]
            for row in range(*ranges[j])
        ]
        axes[ragged] = _axis(entries, [not lengths[row] for row, _ in entries])
    names = [f"{joint}.{coordinate}" for joint, coordinate in lowered.observers]
    joints = {joint.name: joint for joint in model.joints}
    angular = [joints[joint].unit(name) == "rad" for joint, name in lowered.observers]
    axes["joint_coordinate"] = _axis(list(enumerate(names)), angular)
    couplers = [(int(couplings.range[j]), name) for j, name in _numbered(model, "coupler")]
    axes["coupler"] = _axis(couplers, [not lengths[row] for row, _ in couplers])
    others = _switching_axes(lowered) | _surface_axes(lowered)
    return axes | others | _channel_axes(model) | _fmu_axes(model)


def _surface_axes(lowered: LoweredModel) -> dict[str, Axis]:
    """The entries of contacts of surfaces, their rows, nodes of first surfaces, modes and loads."""
    rows: list[str] = []
    nodes: list[str] = []
    for contact in lowered.model.surface_contacts:
        element = lowered.model.flexible_bodies[contact.body].superelement
        surface = element.surface(contact.surface)
        rows += [f"{contact.name}.{i + 1}" for i in surface.corner_nodes.tolist()]
        nodes += [f"{contact.name}.{i + 1}" for i in range(surface.n)]
    names = [contact.name for contact in lowered.model.surface_contacts]
    surfaces = lowered.system.surfaces.bodies
    modes = [
        f"{lowered.body_names[int(lowered.system.elastic.body[e])]}.{i + 1}"
        for e, n in zip(surfaces.flexible.tolist(), np.diff(surfaces.recorded), strict=True)
        for i in range(int(n))
    ]
    loads = []
    for body, name, _ in flexible_surfaces(lowered.model):
        of_body = lowered.model.flexible_bodies[body].superelement.surfaces
        assert of_body is not None
        own = of_body.rows(name)
        loads += [f"{body}.{row // 3 + 1}" for row in range(own.start, own.stop, 3)]
    return {
        "surface_contact": _axis(list(enumerate(names))),
        # False for each: gaps and displacements are lengths.
        "surface_row": _axis(list(enumerate(rows)), [False] * len(rows)),
        "surface_node": _axis(list(enumerate(nodes)), [False] * len(nodes)),
        "mode": _axis(list(enumerate(modes)), [False] * len(modes)),
        "surface_load": _axis(list(enumerate(loads)), [False] * len(loads)),
    }


def _channel_axes(model: Model) -> dict[str, Axis]:
    """The entries of load patterns and sensors."""
    sensors, channels, units = [], [], []
    for body, flexible in model.flexible_bodies.items():
        for sensor in flexible.superelement.sensors:
            sensors.append(f"{body}.{sensor.name}")
            channels += [f"{sensors[-1]}.{channel}" for channel in sensor.channels]
            units += [SENSOR_KINDS.index(sensor.kind)] * len(sensor.channels)
    return {
        "pattern": _axis(list(enumerate(pattern_names(model)))),
        "sensor": _axis(list(enumerate(sensors))),
        "sensor_channel": _axis(list(enumerate(channels)), units),
    }


def _fmu_axes(model: Model) -> dict[str, Axis]:
    """The entries of FMUs and of the inputs that they give."""
    # By inputs, not by variables of the FMU: those may have dots, which divide names of entries.
    given = [(fmu.name, name) for fmu in model.fmus for name in fmu.outputs.values()]
    units = [INPUT_UNITS.index(unit_of_input(model, name)) for _, name in given]
    return {
        "fmu": _axis([(k, fmu.name) for k, fmu in enumerate(model.fmus) if fmu.outputs]),
        "fmu_input": _axis([(i, ".".join(one)) for i, one in enumerate(given)], units),
    }


def unit_of_input(model: Model, name: str) -> str:
    """The unit in which loads and motors take an input, in the spelling of UDUNITS.

    "1" where they are several, or where it is not known.
    """
    units = {unit if unit in INPUT_UNITS else "1" for unit in _units_of_input(model, name)}
    return units.pop() if len(units) == 1 else "1"


def _units_of_input(model: Model, name: str) -> Iterator[str]:
    def is_it(signal: object) -> bool:
        return isinstance(signal, Input) and signal.name == name

    for load in model.loads:
        if is_it(load.signal):
            yield load.unit
    joints = {joint.name: joint for joint in model.joints}
    for motor in model.motors:
        turns = joints[motor.joint].unit(motor.coordinate) == "rad"
        length, force = ("rad", "N m") if turns else ("m", "N")
        for signal, unit in (
            (motor.torque or motor.force, force),
            (motor.reference, length),
            (motor.reference_rate, f"{length} s-1"),
        ):
            if is_it(signal):
                yield unit


def _switching_axes(lowered: LoweredModel) -> dict[str, Axis]:
    """The entries of contacts, stops and friction."""
    model, couplings = lowered.model, lowered.system.couplings
    angular = ~lowered.measures_lengths

    def turns(owners: list[tuple[int, str]]) -> list[bool]:
        return [bool(angular[couplings.range[j]]) for j, _ in owners]

    contacts, stops = _numbered(model, "contact"), _numbered(model, "stop")
    # They are no couplings: their events follow those of these.
    surfaces = [(-1, contact.name) for contact in model.surface_contacts]
    rubbing = [(j, n) for j, n in _numbered(model, "joint") if couplings.friction_of[j] >= 0]
    first = couplings.friction.first
    friction = [(int(couplings.friction_of[j]), f"{name}.friction") for j, name in rubbing]
    return {
        "contact": _axis([(int(couplings.contact_of[j]), name) for j, name in contacts]),
        "stop": _axis([(int(couplings.contact_of[j]), name) for j, name in stops], turns(stops)),
        "joint_with_friction": _axis(friction, [bool(angular[first[r]]) for r, _ in friction]),
        "motor": _axis(
            list(enumerate(motor.name for motor in model.motors)),
            angular[couplings.laws.motors.row].tolist(),
        ),
        "event_owner": _axis(
            [*contacts, *stops, *surfaces], turns([*contacts, *stops]) + [False] * len(surfaces)
        ),
    }


def _numbered(model: Model, dimension: str) -> list[tuple[int, str]]:
    """The couplings that results record along a dimension, with their numbers."""
    return [(j, c.name) for j, c in enumerate(model.couplings) if c.dimension == dimension]


def _on_body(frame: str) -> bool:
    """True for a frame of a body; False for a body itself and for a frame fixed in space."""
    return "." in frame and not frame.startswith(f"{GROUND}.")


def _axis(entries: list[tuple[int, str]], angular: Iterable[int] = ()) -> Axis:
    return Axis(
        tuple(name for _, name in entries), tuple(angular), tuple(row for row, _ in entries)
    )


def check_names(lowered: LoweredModel, names: Iterable[str]) -> None:
    """`ModelError` for an output of a step, as "joints/pivot/angle", that there is not."""
    known = available(lowered)
    for name in names:
        if name not in known:
            raise ModelError(f"outputs: no {name!r}{did_you_mean(name, known, n=3)}")


class Cell(NamedTuple):
    """A number of an output: its quantity, its unit, and a view (1,) of it in the output."""

    quantity: Quantity
    unit: str
    place: Array


def views(lowered: LoweredModel, name: str, output: Output) -> list[Array]:
    """Views (n,) of the output of one step that make up a quantity, as "joints/pivot/angle"."""
    check_names(lowered, [name])
    return [view.reshape(-1) for _, _, view in _views(axes_of(lowered), name, output)]


def cells(lowered: LoweredModel, name: str, output: Output) -> list[Cell]:
    """The numbers of a quantity, in the order of `views`."""
    check_names(lowered, [name])
    axes, found = axes_of(lowered), list[Cell]()
    for quantity, entries, view in _views(axes, name, output):
        numbers = view.reshape(-1)
        units = quantity.units(axes, entries)
        # Units differ from entry to entry, which may have several components each.
        of_each = np.repeat(np.array(units, dtype=object), numbers.size // max(len(units), 1))
        found += [
            Cell(quantity, str(unit), numbers[i : i + 1])
            for i, unit in enumerate(of_each[: numbers.size])
        ]
    return found


def available(lowered: LoweredModel) -> dict[str, None]:
    """The names of all outputs of a step."""
    axes = axes_of(lowered)
    names = [quantity.key for quantity in QUANTITIES if quantity.source and not quantity.owned]
    for group, dimension in OWNERS_OF_GROUP.items():
        for owner in axes[dimension].names:
            attributes = [name for name, _, _ in attributes_of(QUANTITIES, axes, group, owner)]
            names += [f"{group}/{owner}/{attribute}" for attribute in attributes]
    return dict.fromkeys(names)


def _views(
    axes: dict[str, Axis], name: str, output: Output
) -> Iterator[tuple[Quantity, Any, Array]]:
    """Views of the output, each with its quantity and the entries of that."""
    key, _, attribute = name.rpartition("/")
    group, _, owner = key.partition("/")
    if group in OWNERS_OF_GROUP:
        for name_of_owner, quantity, entries in attributes_of(QUANTITIES, axes, group, owner):
            if name_of_owner == attribute:
                rows = axes[quantity.dimensions[1]].rows[entries]
                if isinstance(rows, tuple):
                    # A slice is a view into the output; an index by a tuple would be a copy that no
                    # step changes.
                    rows = slice(rows[0], rows[-1] + 1) if rows else slice(0)
                yield quantity, entries, getattr(output, quantity.source)[:1, rows]
    for quantity in QUANTITIES:
        if quantity.key == name and not quantity.owned:
            yield quantity, slice(None), getattr(output, quantity.source)[:1]
