"""Design parameters of a body file, by which a superelement has derivatives."""

from pathlib import Path
from typing import Any, Protocol, TypeVar

from ...inputs import Table, quoted, read_part, rule
from .any_mesh import AnyMesh
from .impulse import Impulse
from .selection import FEATURE_KEYS, SHAPE_KEYS

TableT = TypeVar("TableT", bound=Table)
PARAMETER_TABLES = ("section", "sections", "material", "materials", "shell", "shells", "masses")
"""whose numbers may be parameters: those of stiffness and mass"""
# Tables whose arrays depend on parameters in ways that no derivative here has.
TABLES_WITHOUT_DERIVATIVES = ("matrices", "surfaces", "loads", "sensors", "rotation", "measured")
DAMPING_KEY = "loss_factor"


class Derivative(Table):
    """A parameter of the body, by which its superelement has derivatives: one of three kinds.

    key: of a number of a section, material, shell or mass in this file, which is the parameter;
    powers: several such keys, that grow as these powers of the parameter, which is 1 here; mesh:
    another mesh with the same cells and other points, toward which the points move as the parameter
    grows from 0; it would be 1 there.
    """

    key: str | None = None
    powers: dict[str, float] | None = None
    mesh: AnyMesh | None = None

    @rule
    def _one_kind(self) -> None:
        found = list(self.given("key", "powers", "mesh"))
        if len(found) != 1:
            raise ValueError(
                f"expected one of key, powers and mesh, found {' and '.join(found) or 'none'}"
            )
        if self.powers is not None and not self.powers:
            raise ValueError("powers: expected keys of the body file, found none")

    @property
    def keys(self) -> dict[str, float]:
        """The keys that vary with the parameter, and their powers of it."""
        return {self.key: 1.0} if self.key is not None else dict(self.powers or {})

    def value(self, body: Table) -> float:
        """The parameter of a body as it is."""
        if self.key is not None:
            return number_at(body, self.key)
        return 1.0 if self.mesh is None else 0.0

    def scale(self, body: Table) -> float:
        """The size of the parameter, by which its steps are counted."""
        return abs(self.value(body)) or 1.0

    def relative_to(self, folder: Path) -> "Derivative":
        if not isinstance(self.mesh, Path):
            return self
        return self.model_copy(update={"mesh": folder / self.mesh})


def number_at(body: object, key: str) -> float:
    """The number of a section, material, shell or mass; ValueError for what is none."""
    table, *path = key.split(".")
    found: Any = getattr(body, table, None) if table in PARAMETER_TABLES else None
    for name in path:
        found = _entries(found).get(name)
    if not path or not isinstance(found, int | float) or isinstance(found, bool):
        raise ValueError(
            f"expected the key of a number in {', '.join(PARAMETER_TABLES)}, as "
            f"'section.EI_z', found {quoted(key)}"
        )
    if path[-1] == DAMPING_KEY or found == 0.0:
        raise ValueError(
            f"{key}: expected a stiffness, a size or a mass other than 0, found {found:g}"
        )
    return float(found)


def with_numbers(body: TableT, values: dict[str, float]) -> TableT:
    """The body with other numbers at keys; `InputError` for those that it cannot have."""
    for key, value in values.items():
        body = _with_number(body, key.split("."), value)
    return body


def _with_number(part: Any, path: list[str], value: float) -> Any:
    name, *rest = path
    inner = _with_number(_entries(part)[name], rest, value) if rest else value
    if isinstance(part, Table):
        changed = part.model_copy(update={name: inner})
        if isinstance(inner, Table | dict):
            return changed
        # A table of numbers, as a material, may not allow the new one.
        return read_part(changed.model_dump(exclude_unset=True), type(part))
    if isinstance(part, tuple):
        return tuple(inner if str(i) == name else entry for i, entry in enumerate(part))
    return {**part, name: inner}


def _entries(part: Any) -> dict[str, Any]:
    """What is inside a table, an array or a group of tables, by name or number."""
    if isinstance(part, Table):
        return {name: getattr(part, name) for name in type(part).model_fields}
    if isinstance(part, tuple):
        return {str(i): entry for i, entry in enumerate(part)}
    return part if isinstance(part, dict) else {}


class DerivedKeys(Protocol):
    """The keys of a body file that derivatives have to do with."""

    derivatives: dict[str, Derivative]
    impulse: Impulse

    @property
    def loss_factors(self) -> dict[str, float]: ...


def check_derivatives(body: DerivedKeys) -> None:
    """ValueError for parameters that are none, and for what has no derivative here."""
    if not body.derivatives:
        return
    for table in TABLES_WITHOUT_DERIVATIVES:
        if getattr(body, table):
            raise ValueError(f"derivatives: expected no [{table}], of which they have nothing")
    if body.impulse.method == "march":
        raise ValueError(
            "derivatives: need modes, which impulse.method march does not find: "
            "use auto, krylov, modal, craig-bampton or rubin"
        )
    if len(set(body.loss_factors.values())) > 1:
        raise ValueError("derivatives: expected one loss factor for all materials, found several")
    for name, derivative in body.derivatives.items():
        for key in derivative.keys:
            try:
                number_at(body, key)
            except ValueError as error:
                raise ValueError(f"derivatives.{name}: {error}") from error
        if derivative.mesh is not None:
            _check_morph(body, name)


def _check_morph(body: DerivedKeys, name: str) -> None:
    # What shapes select may be other nodes of a mesh that has moved.
    for table in ("interfaces", "masses"):
        for label, selection in getattr(body, table).items():
            moving = selection.given("node", *FEATURE_KEYS, *SHAPE_KEYS)
            if moving:
                raise ValueError(
                    f"derivatives.{name}.mesh: expected {table} by group, which moves with the "
                    f"mesh, found {table}.{label} by {next(iter(moving))}"
                )
