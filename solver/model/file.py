"""Model files: what users write to run a simulation, as a `Model` and back."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, overload

from pydantic import ConfigDict, Field, PositiveFloat, create_model

from ...files import object_and_path, renamed_when_whole
from ...files.outputs import AnyPath
from ...inputs import Table, Vector, document_of, quoted, read_table, rule, toml_of
from ...inputs.file_kinds import MODEL_FILE
from ...superelement import Superelement, read, with_parameters
from ..couplings.bearings import Bearing
from ..couplings.contacts import Contact
from ..couplings.couplers import Coupler
from ..couplings.friction import FRICTION_COEFFICIENTS
from ..couplings.joints import JOINTS
from ..couplings.motions import PrescribedDisplacement, PrescribedOrientation, PrescribedRotation
from ..couplings.motors import Motor
from ..couplings.springs import Spring
from ..couplings.stops import Stop
from ..couplings.surface_contacts import SurfaceContact
from ..errors import ModelError, about
from ..laws.law import FORCE_LAWS
from ..schema.entry import Entry, filled
from ..schema.json_schema import definition
from ..schema.paths import beside, relative
from ..schema.tables import (
    entry_of,
    keys_of,
    present_keys,
    table_in_file,
    table_of,
    table_of_kinds,
    tables_by_key,
    tables_of,
    value_of,
)
from ..schema.values import ZERO_VECTOR
from ..signals.signal import SIGNAL_FORMS
from .bodies import Body, FlexibleBody, Frame, RigidBody, RigidSuperelement, SecondOrder, Start
from .body_shapes import BODY_SHAPES
from .fmus import FMU
from .loads import LOADS
from .model import Model
from .output_request import OutputRequest
from .settings import INTERVAL_FORMS, Settings, StartFrom

MOTION_CLASSES = PrescribedDisplacement, PrescribedRotation, PrescribedOrientation


class _Scale(Table):
    """Factors of the superelement of a body: of all its stiffness, mass, and damping."""

    stiffness: PositiveFloat = 1.0
    density: PositiveFloat = 1.0
    damping: PositiveFloat = 1.0


class _Body(Table):
    """The table of a rigid or a flexible body.

    rigid: whether a body is to have the mass, inertia, interfaces and outline of its superelement
    without its elasticity. scale: factors of what the file of the superelement has; design: values
    of its design parameters, by the names of its derivatives.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "anyOf": [{"required": ["superelement"]}, {"required": ["mass", "inertia"]}]
        }
    )

    superelement: Annotated[Path, Field(strict=False)] | None = None
    rigid: bool | None = None
    second_order: SecondOrder | None = None
    scale: _Scale | None = None
    design: dict[str, float] | None = None

    @rule
    def _rigid_or_flexible(self) -> None:
        # Those that a rigid body alone has; keys of the start belong to both kinds.
        keys, brought = present_keys(self), keys_of(RigidBody).keys() - keys_of(Start).keys()
        if self.superelement is not None and (both := [key for key in keys if key in brought]):
            raise ValueError(
                f"the superelement already gives {', '.join(both)}: leave these keys out"
            )
        if self.superelement is None and self.second_order is not None:
            raise ValueError("second_order belongs to flexible bodies, found no superelement")
        if self.superelement is None and self.scale is not None:
            raise ValueError("scale belongs to bodies with a superelement, found none")
        if self.superelement is None and self.design is not None:
            raise ValueError("design belongs to bodies with a superelement, found none")
        if self.superelement is None and self.rigid is not None:
            raise ValueError(
                "rigid belongs to bodies with a superelement, found none: a body with mass and "
                "inertia is rigid"
            )
        if self.rigid and self.second_order is not None:
            raise ValueError("second_order belongs to flexible bodies, found rigid = true")
        if self.superelement is not None and not str(self.superelement).isprintable():
            raise ValueError(
                f"superelement: expected a path, found {quoted(str(self.superelement))}"
            )
        if self.superelement is None and not {"mass", "inertia"} <= keys.keys():
            raise ValueError("expected mass and inertia of a rigid body, or superelement")


def _optional(keys: Mapping[str, Any]) -> dict[str, Any]:
    return {key: (kind, None) for key, (kind, _) in keys.items()}


def _table_of_bodies() -> Any:
    table: Any = create_model("Body", __base__=_Body, **_optional(keys_of(RigidBody)))
    table.documented = RigidBody, Start, FlexibleBody, _Body
    return dict[str, table]


def _table_of_motion() -> Any:
    """Motions have no key `type`: all keys are optional here, and `_motion` finds the kind by
    them.
    """
    keys = {key: kind for motion in MOTION_CLASSES for key, kind in keys_of(motion).items()}
    table: Any = create_model(
        "Motion", __base__=Table, **_optional(keys) | {"name": (str, ""), "on": (str, ...)}
    )
    table.documented = MOTION_CLASSES
    return table


def _table_of_simulation() -> Any:
    # In files `output` is a table of its own, not a key of [simulation].
    keys = {key: kind for key, kind in keys_of(Settings).items() if key != "output"}
    table: Any = create_model("Simulation", __base__=Table, **keys, gravity=(Vector, ZERO_VECTOR))
    table.documented = (Settings,)
    return table


def _table_of_ground() -> Any:
    frames: Any = dict[str, table_of(Frame)], Field(default_factory=dict)  # type: ignore[misc]
    return create_model("Ground", __base__=Table, frames=frames)


TABLES_OF_ARRAYS: dict[str, Callable[[Sequence[str]], Any]] = {
    "joints": lambda tags: table_of_kinds(JOINTS, tags),
    "springs": lambda tags: table_of(Spring),
    "motions": lambda tags: _table_of_motion(),
    "loads": lambda tags: table_of_kinds(LOADS, tags),
    "contacts": lambda tags: tables_by_key(Contact, surfaces=SurfaceContact),
    "stops": lambda tags: table_of(Stop),
    "motors": lambda tags: table_of(Motor),
    "couplers": lambda tags: table_of(Coupler),
    "bearings": lambda tags: table_of(Bearing),
    "fmus": lambda tags: table_of(FMU),
}
"""the arrays of tables, in the order in which they are written, and what makes the table of an item
with one of some values of the key `type`
"""
KINDS_BY_TYPE = {"joints": JOINTS, "loads": LOADS}


def table_of_any_model() -> Any:
    """The table of a model file, with all that one may have."""
    return table_of_model(dict.fromkeys(TABLES_OF_ARRAYS))


def table_of_model(content: Mapping[str, Any]) -> Any:
    """The table of a model file, as far as it has arrays and kinds of joints and loads.

    To make the tables of all kinds takes longer than to read most files.
    """
    arrays = tuple(
        (name, _tags(name, content[name])) for name in TABLES_OF_ARRAYS if name in content
    )
    # Read now: programs may have added kinds since this module was imported.
    return _table_of_arrays(arrays, (*JOINTS.values(), *LOADS.values()))


def _tags(array: str, items: Any) -> tuple[str, ...]:
    """The kinds in an array of tables, by `type`; all that are known if it has another."""
    known = [*KINDS_BY_TYPE.get(array, ())]
    tables = items if isinstance(items, list) else []
    found = [item.get("type") if isinstance(item, Mapping) else None for item in tables]
    # The message about a wrong kind lists all right ones.
    are_known = found and all(tag in known for tag in found)
    return tuple(tag for tag in known if tag in found) if are_known else tuple(known)


@cache
def _table_of_arrays(
    arrays: tuple[tuple[str, tuple[str, ...]], ...], known: tuple[type[Entry], ...]
) -> Any:
    """The table of a model file with some arrays, each with the kinds in it.

    known: all kinds; a program may have given a tag to another class.
    """
    present = dict(arrays)
    items: dict[str, Any] = {
        name: (tuple[table(present[name]) if name in present else Any, ...], ())  # type: ignore[misc]
        for name, table in TABLES_OF_ARRAYS.items()
    }
    output, ground = table_of(OutputRequest), _table_of_ground()
    return create_model(
        "ModelFile",
        __base__=Table,
        simulation=(_table_of_simulation(), ...),
        output=(output, Field(default_factory=output)),
        bodies=(_table_of_bodies(), Field(min_length=1)),
        ground=(ground, Field(default_factory=ground)),
        **items,
    )


ENTRY_FAMILIES = SIGNAL_FORMS, FORCE_LAWS, FRICTION_COEFFICIENTS, INTERVAL_FORMS, BODY_SHAPES


def model_schema() -> dict[str, Any]:
    """The JSON schema of model files, by which editors complete and check them.

    Returns
    -------
    dict

    Examples
    --------
    >>> model_schema()["title"]
    'A model file of Duhamel'
    """
    tables = {family: tables_of(family) for family in ENTRY_FAMILIES}
    families = {family.title: definition(family, own) for family, own in tables.items()}
    members = [table for own in tables.values() for table in own.values()]
    return document_of(table_of_any_model(), "A model file of Duhamel", families, members)


def read_model(path: str | os.PathLike[str]) -> Model:
    """Read a model file and the superelements that it names.

    Parameters
    ----------
    path : path
        Paths of superelements are relative to it. One that several bodies name is read once.

    Returns
    -------
    Model

    Raises
    ------
    ModelError
        Names the file, the key and the value found there. See `write_model` for an example.
    """
    path = Path(path)
    file, text = read_table(path, table_of_model, ModelError, MODEL_FILE)
    # Paths in a model are relative to its file, wherever the program was started.
    with about(path), beside(path.parent):
        return model_of_tables(file, path, {}, text)


@overload
def write_model(model: Model, path: AnyPath, /) -> None: ...
@overload
def write_model(path: AnyPath, model: Model, /) -> None: ...
def write_model(model: Any, path: Any, /) -> None:
    """Write a model as a file that reads back to an equal one; it appears whole or not at all.

    `write_model(path, model)` is understood too.

    Parameters
    ----------
    model : Model
    path : path
        Superelements, and the run that the model starts from, are named by paths relative to it.

    Raises
    ------
    ModelError
        Names a body whose superelement is in no file; a load, joint, motion or motor that follows a
        Python function; or a file that cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from duhamel.solver import Model, RigidBody, Settings
    >>> model = Model({"ball": RigidBody(1.0, [0.1] * 3)}, settings=Settings(t_end=1.0, step=0.1))
    >>> with TemporaryDirectory() as folder:
    ...     write_model(model, f"{folder}/ball.toml")
    ...     read_model(f"{folder}/ball.toml").bodies["ball"].mass
    1.0
    """
    model, path = object_and_path(model, path)
    path = Path(path)
    # The document is complete before the file is opened: a model that cannot be written leaves
    # none.
    with beside(path.parent):
        document = document_of_model(model, path.parent)
    with renamed_when_whole(path, failure=ModelError) as temporary:
        temporary.write_text(toml_of(document), encoding="utf-8")


def model_of_tables(
    file: Any, path: Path, superelements: dict[Path, Superelement], text: str = ""
) -> Model:
    """The model of a validated file; superelements: those that are known already, by their path."""
    simulation = present_keys(file.simulation)
    gravity = simulation.pop("gravity", ZERO_VECTOR)
    settings = entry_of(Settings, simulation | {"output": file.output})
    if isinstance(settings.start, StartFrom):
        settings = replace(settings, start=settings.start.beside(path.parent))
    # Motions have no table of their kind, and files have both kinds of contacts in one array.
    named = (name for name in TABLES_OF_ARRAYS if name not in ("motions", "contacts"))
    entries = {name: value_of(getattr(file, name)) for name in named}
    varied: dict[tuple[Path, str], Superelement] = {}
    return Model(
        bodies={
            name: _body(name, present_keys(body), path.parent, superelements, varied)
            for name, body in file.bodies.items()
        },
        **entries,
        motions=tuple(_motion(present_keys(motion)) for motion in file.motions),
        contacts=_contacts(file, Contact),
        surface_contacts=_contacts(file, SurfaceContact),
        gravity=gravity,
        ground_frames=value_of(file.ground.frames),
        settings=settings,
        source=text,
        path=str(path),
    )


def _body(
    name: str,
    values: dict[str, Any],
    folder: Path,
    superelements: dict[Path, Superelement],
    varied: dict[tuple[Path, str], Superelement],
) -> Body:
    """superelements: by their files; varied: those made from them, by their parameters too."""
    try:
        if "superelement" not in values:
            return entry_of(RigidBody, values)
        source = folder / values["superelement"]
        # Bodies of the same superelement share it, and so the memory of its kernels.
        if source not in superelements:
            # Fields of the surface are large, and no step needs them: results read them when asked.
            superelements[source] = read(source, recovery=False)
        tables = _parameters(values)
        if (key := (source, str(tables))) not in varied:
            varied[key] = with_parameters(superelements[source], tables)
        element = varied[key]
        start = entry_of(Start, values)
        if values.get("rigid", False):
            return RigidSuperelement(element, start, str(source))
        second_order = values.get("second_order", "auto")
        return FlexibleBody(element, start, str(source), second_order)
    except ValueError as error:
        raise ModelError(f"bodies.{name}: {error}") from error


def _parameters(values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """The parameters of the superelement of a body, by its table."""
    tables = {"design": dict(values.get("design", {}))}
    return tables | ({"scale": present_keys(values["scale"])} if "scale" in values else {})


def _contacts(file: Any, kind: type[Entry]) -> tuple[Any, ...]:
    return tuple(value_of(table) for table in file.contacts if table.entry is kind)


def _motion(values: dict[str, Any]) -> Any:
    """A motion of the kind that has these keys."""
    values = {"name": ""} | values
    for kind in MOTION_CLASSES:
        known = keys_of(kind)
        needed = {key for key, (_, default) in known.items() if default is ...}
        # `start` and `name` stand in all kinds: only a driven coordinate tells them apart.
        driven = any(key in values for key in kind.keys)
        if driven and needed <= values.keys() <= known.keys():
            return entry_of(kind, values)
    present = " and ".join(key for key in values if key not in ("name", "on", "start")) or "none"
    raise ModelError(
        f"{filled(MOTION_CLASSES[0].label, values)}: expected direction and displacement, or axis "
        f"and angle, found {present}; or angles of three signals; instead of displacement, angle "
        "or angles their velocity or acceleration"
    )


def document_of_model(model: Model, folder: Path) -> dict[str, Any]:
    """The tables of the file of a model in a folder."""
    settings = table_in_file(model.settings)
    if isinstance(start := model.settings.start, StartFrom):
        settings["start"] = {"from": relative(start.path, folder)}
    output = settings.pop("output", {})
    if model.gravity.any():
        settings["gravity"] = model.gravity.tolist()
    document = {
        "simulation": settings,
        "output": output,
        "ground": {"frames": _frames(model.ground_frames)} if model.ground_frames else {},
        "bodies": {name: _body_in_file(name, body, folder) for name, body in model.bodies.items()},
        **{
            name: [table_in_file(entry) for entry in _entries(model, name)]
            for name in TABLES_OF_ARRAYS
        },
    }
    # Empty tables are left out: a file says only what is not the default.
    return {key: table for key, table in document.items() if table}


def _entries(model: Model, group: str) -> tuple[Any, ...]:
    """The entries of an array of tables."""
    entries: tuple[Any, ...] = getattr(model, group)
    return (*entries, *model.surface_contacts) if group == SurfaceContact.group else entries


def _frames(frames: Mapping[str, Frame]) -> dict[str, Any]:
    return {name: table_in_file(frame) for name, frame in frames.items()}


def _body_in_file(name: str, body: Body, folder: Path) -> dict[str, Any]:
    if isinstance(body, RigidBody):
        return table_in_file(body)
    if not body.source:
        raise ModelError(f"body {name!r}: its superelement is not in a file: write it to one first")
    chosen: dict[str, Any] = {}
    if isinstance(body, RigidSuperelement):
        chosen = {"rigid": True}
    elif body.second_order != "auto":
        chosen = {"second_order": body.second_order}
    if (variation := body.superelement.variation) is not None:
        chosen |= variation.tables
    return {"superelement": relative(body.source, folder), **chosen, **table_in_file(body.start)}
