"""A CAD file in gmsh: its solids, by name and in one unit of length."""

import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import gmsh
import numpy as np

from .errors import CadError

SEWING_TOLERANCE = 1e-5
"""Width of gaps between the faces of IGES that are closed, relative to the size of the part."""
STEP_SUFFIXES = (".step", ".stp")
SESSION_OPTIONS = {
    "General.Terminal": 0,
    # More threads would number nodes in an order of their own in each run.
    "General.NumThreads": 1,
    "Geometry.OCCImportLabels": 1,
}


@contextmanager
def open_solids(path: Path) -> Iterator[dict[str, int]]:
    """The solids of a file in a session of gmsh, by name; `CadError` for a file without any."""
    # Files of the user's folder would change meshes from one machine to the next.
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        for option, value in SESSION_OPTIONS.items():
            gmsh.option.setNumber(option, value)
        with _in_utf8(path) as readable:
            _import(readable)
        yield _solids()
    finally:
        gmsh.finalize()


@contextmanager
def _in_utf8(path: Path) -> Iterator[Path]:
    """The file, or a copy in UTF-8 of a STEP file in Latin-1, whose names gmsh would garble."""
    # Columns of IGES count bytes: a longer name would move what is behind it.
    data = path.read_bytes() if path.suffix.lower() in STEP_SUFFIXES else b""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder, path.name)
            copy.write_bytes(data.decode("latin-1").encode("utf-8"))
            yield copy
    else:
        yield path


def solid_size(entity: int, dimension: int = 3) -> float:
    """The diagonal of the bounding box of a solid."""
    low, high = np.split(np.array(gmsh.model.getBoundingBox(dimension, entity)), 2)
    return float(np.linalg.norm(high - low))


def _import(path: Path) -> None:
    gmsh.model.occ.importShapes(str(path))
    gmsh.model.occ.synchronize()
    if gmsh.model.getEntities(3):
        return
    faces = gmsh.model.getEntities(2)
    if faces:
        # IGES has loose faces; a solid is what they close.
        gmsh.model.occ.healShapes(
            tolerance=SEWING_TOLERANCE * solid_size(-1, dimension=-1),
            fixDegenerated=False,
            fixSmallEdges=False,
            fixSmallFaces=False,
        )
        gmsh.model.occ.synchronize()
    if not gmsh.model.getEntities(3):
        found = f"{len(faces)} faces that close none" if faces else "none"
        raise CadError(f"expected a solid, found {found}: export the part as a solid, in STEP")


def _solids() -> dict[str, int]:
    """Numbers of solids by the last part of their labels; the same ones are counted."""
    # Files number instances of a part, or not: labels alone do not tell them apart.
    names: dict[str, int] = {}
    counts: Counter[str] = Counter()
    for _, tag in gmsh.model.getEntities(3):
        label = _label(tag)
        counts[label] += 1
        name = label if counts[label] == 1 else f"{label}-{counts[label]}"
        while name in names:
            counts[label] += 1
            name = f"{label}-{counts[label]}"
        names[name] = tag
    return names


def _label(solid: int) -> str:
    """The last part of a label as Shapes/ASSEMBLY/PART; numbers stand where names are missing.

    Shapes without a name are SOLID there, and references to parts =>[0:1:1:3].
    """
    parts = [part.strip() for part in gmsh.model.getEntityName(3, solid).split("/")]
    named = [part for part in parts if part and part != "SOLID" and not part.startswith("=>[")]
    return named[-1] if named else "solid"


def keep_alone(solids: dict[str, int], name: str | None) -> tuple[str, int]:
    """Keep one solid of the session; `CadError` unless it is named where there are several."""
    known = ", ".join(solids)
    if name is None and len(solids) > 1:
        raise CadError(
            f"expected one solid, found {len(solids)}: name one by `solid`, of {known}, or make "
            "files of all by `duhamel import`"
        )
    if name is not None and name not in solids:
        raise CadError(f"solid: no {name!r}, the file has: {known}")
    kept = name or next(iter(solids))
    # Gone before features are looked for: inside and outside are those of one solid.
    others = [(3, tag) for other, tag in solids.items() if other != kept]
    if others:
        gmsh.model.occ.remove(others, recursive=True)
        gmsh.model.occ.synchronize()
    return kept, solids[kept]
