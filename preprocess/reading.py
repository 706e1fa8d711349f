"""Mesh files and their named groups, read through meshio."""

import io
import os
import struct
import warnings
from contextlib import redirect_stderr
from pathlib import Path

import meshio
import numpy as np

from .errors import MeshError
from .mesh import LINES, PARTS, SOLIDS, Group, IntArray, Mesh

# meshio's readers fail on damaged files wherever their parsing stumbles.
_PARSER_FAILURES = (
    meshio.ReadError,
    ValueError,
    LookupError,
    TypeError,
    AssertionError,
    OSError,
    struct.error,
    DeprecationWarning,
)


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Read a mesh in any format of meshio. Groups are its cell sets, point sets and the physical groups of Gmsh.

    `MeshError` if the file cannot be read, or holds cells that are neither lines nor solids.
    """
    path = Path(path)
    raw = _parse(path)
    if not len(raw.points):
        raise MeshError(f"{path}: the mesh has no points")
    points = np.zeros((len(raw.points), 3))
    points[:, : np.shape(raw.points)[1]] = raw.points
    cells = {
        kind: np.concatenate([np.asarray(block.data, dtype=np.int64) for block in raw.cells if block.type == kind])
        for kind in dict.fromkeys(block.type for block in raw.cells)
    }
    return Mesh(path.name, points, cells, _groups(raw), _body_types(path.name, list(cells)))


def _parse(path: Path) -> meshio.Mesh:
    """meshio's mesh; each format of the suffix is tried by name, for meshio itself would print and exit on failure."""
    if not path.is_file():
        raise MeshError(f"{path}: no such mesh file")
    formats = meshio.extension_to_filetypes.get(path.suffix.lower(), [])
    if not formats:
        raise MeshError(f"{path}: expected a mesh format that meshio reads, found the suffix {path.suffix!r}")
    failures = []
    for name in formats:
        try:
            return _parse_as(name, path)
        except _PARSER_FAILURES as error:
            failures.append(f"as {name}: {error or type(error).__name__}")
    raise MeshError(f"{path}: the mesh cannot be read ({'; '.join(failures)})")


def _parse_as(name: str, path: Path) -> meshio.Mesh:
    """meshio's mesh in one format; a file that breaks off is a `ReadError`, where meshio and numpy only complain."""
    complaints = io.StringIO()
    with warnings.catch_warnings(), redirect_stderr(complaints):
        warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
        mesh = meshio._helpers.reader_map[name](str(path))
    text = " ".join(complaints.getvalue().split())
    if "not closed by" in text:
        raise meshio.ReadError(f"the file breaks off: {text}")
    if text:
        warnings.warn(f"{path}: meshio says: {text}", stacklevel=2)
    return mesh


def _body_types(name: str, kinds: list[str]) -> tuple[str, ...]:
    """The types of the cells that make the body: the solid ones, else lines."""
    unsupported = [kind for kind in kinds if kind not in (*SOLIDS, *PARTS)]
    if unsupported:
        raise MeshError(f"{name}: unsupported cells {', '.join(unsupported)}; bodies are made of {_supported()}")
    solids = tuple(kind for kind in kinds if kind in SOLIDS)
    if solids:
        return solids
    if "line" in kinds and all(kind in ("vertex", "line") for kind in kinds):
        return LINES
    raise MeshError(f"{name}: no body in cells of type {', '.join(kinds) or 'none'}; bodies are made of {_supported()}")


def _supported() -> str:
    return ", ".join((*LINES, *SOLIDS))


def _groups(raw: meshio.Mesh) -> dict[str, Group]:
    """All groups by name, whichever way the format says them."""
    blocks = [block.type for block in raw.cells]
    firsts = np.array([sum(len(b.data) for b in raw.cells[:i] if b.type == kind) for i, kind in enumerate(blocks)])
    members: dict[str, dict[str, list[IntArray]]] = {}

    def add(name: str, block: int, rows: IntArray) -> None:
        if len(rows):
            members.setdefault(name, {}).setdefault(blocks[block], []).append(rows + firsts[block])

    for name, per_block in raw.cell_sets.items():
        if not name.startswith("gmsh:"):
            for block, rows in enumerate(per_block):
                add(name, block, np.asarray(rows if rows is not None else [], dtype=np.int64))
    tags = raw.cell_data.get("gmsh:physical", [])
    for name, (tag, dimension) in raw.field_data.items():
        for block, block_tags in enumerate(tags):
            if raw.cells[block].dim == dimension:
                add(name, block, np.flatnonzero(np.asarray(block_tags) == tag))

    points = {name: np.asarray(rows, dtype=np.int64) for name, rows in raw.point_sets.items()}
    none = np.zeros(0, dtype=np.int64)
    return {
        name: Group(
            {kind: np.unique(np.concatenate(rows)) for kind, rows in members.get(name, {}).items()},
            points.get(name, none),
        )
        for name in {**members, **points}
    }
