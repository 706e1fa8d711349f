"""VTK (.vtk, .vtu) and other formats, read by meshio.

Groups are sets of cells and points, where a format has them, and those of arrays of integers (see
`arrays`).
"""

import io
import struct
import warnings
import zlib
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError

import meshio
import numpy as np

from ...errors import MeshError
from ..mesh import IntArray
from .arrays import mark_values
from .draft import Draft, Sequence

_KEPT = (".vtk", ".vtu")

# meshio's readers fail on damaged files wherever their parsing stumbles.
_PARSER_FAILURES = (
    meshio.ReadError,
    meshio._exceptions.CorruptionError,
    ArithmeticError,
    AssertionError,
    AttributeError,
    ImportError,
    LookupError,
    MemoryError,
    OSError,
    ParseError,
    RuntimeError,
    TypeError,
    ValueError,
    struct.error,
    zlib.error,
    DeprecationWarning,
)


def read(path: Path) -> Draft:
    """A mesh in a format that meshio knows; `MeshError` for other suffixes and damaged files."""
    mesh, complaints = _parse(path)
    draft = draft_of(mesh)
    draft.lost += complaints
    if path.suffix.lower() not in _KEPT:
        draft.lost.append(
            f"groups that meshio does not keep of {path.suffix} files, if there are any"
        )
    return draft


def draft_of(mesh: meshio.Mesh) -> Draft:
    """A mesh of meshio with its sets, and the groups of its arrays of integers."""
    points = np.zeros((len(mesh.points), 3))
    points[:, : np.shape(mesh.points)[1]] = mesh.points
    draft = Draft(points)
    sequence, firsts = Sequence(draft), []
    for block in mesh.cells:
        firsts.append(len(sequence))
        sequence.add(block.type, _cells(block.data, len(points)))

    for name, parts in mesh.cell_sets.items():
        for first, members in zip(firsts, parts, strict=False):
            if members is not None:
                sequence.mark(name, first + np.asarray(members, dtype=np.int64))
    for name, members in mesh.point_sets.items():
        draft.mark_points(name, members)

    for name, arrays in mesh.cell_data.items():
        mark_values(
            draft, name, np.concatenate([np.asarray(array) for array in arrays]), sequence.mark
        )
    for name, array in mesh.point_data.items():
        mark_values(draft, name, np.asarray(array), draft.mark_points)
    return draft


def _cells(nodes: Any, n_points: int) -> IntArray:
    cells = np.asarray(nodes, dtype=np.int64)
    if not ((cells >= 0) & (cells < n_points)).all():
        raise MeshError(
            f"expected cells of points 0 to {n_points - 1}, found {cells.min()} to {cells.max()}"
        )
    return cells


def _parse(path: Path) -> tuple[meshio.Mesh, list[str]]:
    """meshio's mesh and its warnings. Each format of the suffix is tried by name: meshio itself
    would exit.
    """
    formats = meshio.extension_to_filetypes.get(path.suffix.lower(), [])
    if not formats:
        raise MeshError(
            f"expected a mesh format that meshio reads, found the suffix {path.suffix!r}"
        )
    failures = []
    for name in formats:
        complaints = io.StringIO()
        try:
            with warnings.catch_warnings(), redirect_stderr(complaints):
                warnings.simplefilter(
                    "error", DeprecationWarning
                )  # numpy's, of text that ends too soon
                mesh = meshio._helpers.reader_map[name](str(path))
            return mesh, [text] if (text := " ".join(complaints.getvalue().split())) else []
        except _PARSER_FAILURES as error:
            failures.append(f"as {name}: {error or type(error).__name__}")
    raise MeshError(f"the mesh cannot be read ({'; '.join(failures)})")
