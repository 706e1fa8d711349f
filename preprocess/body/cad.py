"""What a body file says of a CAD file: sizes of elements, one of several solids, its unit."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

from pydantic import PositiveFloat

from ...cad import is_cad, knows_unit
from ...cad.picking import Pick
from ...inputs import Table, rule
from .selection import FEATURE_KEYS, Face, Hole, Selection

SELECTING_TABLES = ("interfaces", "surfaces", "masses", "loads")


class FaceSize(Table):
    """The size of elements on a hole or a face of a CAD file [m], smaller than that of the rest."""

    size: PositiveFloat
    hole: Hole | None = None
    face: Face | None = None

    @rule
    def _one_feature(self) -> None:
        found = self.given(*FEATURE_KEYS)
        if len(found) != 1:
            raise ValueError(f"expected hole or face, found {' and '.join(found) or 'neither'}")


class CadKeys(Protocol):
    """The keys of a body file that a CAD file has to do with."""

    mesh: Any
    size: float | None
    sizes: dict[str, FaceSize]
    solid: str | None

    @property
    def model_fields_set(self) -> set[str]: ...


def check_cad(body: CadKeys) -> None:
    """ValueError for keys of CAD files beside other meshes, and the other way round."""
    path = body.mesh if isinstance(body.mesh, Path) else None
    if path is None or not is_cad(path):
        found = [key for key in ("size", "sizes", "solid") if getattr(body, key)]
        found += [f"{table}.{name}.{key}" for table, name, key, _ in _features(body)]
        if found:
            mesh = "[matrices]" if body.mesh is None else path or "a mesh in memory"
            raise ValueError(
                f"{found[0]}: is for CAD files (.step, .iges, .brep), found {mesh}: select by "
                "group, plane, box, sphere or cylinder"
            )
        return
    if body.size is None:
        raise ValueError(f"size: expected that of the elements of {path.name} [m], found none")
    given = body.model_fields_set
    # Defaults are no statement of the user, and pass.
    if "order" in given:
        raise ValueError("order: CAD files are meshed by tetrahedra of ten nodes, found order too")
    if knows_unit(path) and "scale" in given:
        raise ValueError(f"scale: {path.name} says its unit of length itself: expected no scale")
    if not knows_unit(path) and "scale" not in given:
        raise ValueError(
            f"scale: {path.suffix} files do not say their unit of length: expected it [m], 1e-3 "
            "for millimeters, found none"
        )
    for name, face in body.sizes.items():
        if face.size > body.size:
            raise ValueError(
                f"sizes.{name}.size: expected at most size = {body.size:g}, found {face.size:g}"
            )


def picks_of(body: CadKeys) -> list[Pick]:
    """What a body picks of its CAD file: a group for each hole and face, and sizes."""
    picks: dict[str, Pick] = {}
    for table, name, key, selection in _features(body):
        feature = selection.feature
        assert feature is not None
        group = str(feature)
        # A hole that carries an interface and a load is one group.
        picks.setdefault(group, _pick(f"{table}.{name}.{key}", feature, group))
    sizes = [
        _pick(f"sizes.{name}.{key}", feature, "", face.size)
        for name, face in body.sizes.items()
        for key, feature in face.given(*FEATURE_KEYS).items()
    ]
    return [*picks.values(), *sizes]


def _features(body: CadKeys) -> Iterator[tuple[str, str, str, Selection]]:
    """Table, name and key of each selection of a hole or face."""
    for table in SELECTING_TABLES:
        for name, selection in getattr(body, table).items():
            for key in selection.given(*FEATURE_KEYS):
                yield table, name, key, selection


def _pick(key: str, feature: Hole | Face, group: str, size: float | None = None) -> Pick:
    if isinstance(feature, Hole):
        return Pick(key, "hole", feature.near, feature.radius, feature.tolerance, group, size)
    return Pick(key, "face", feature.near, None, feature.tolerance, group, size)
