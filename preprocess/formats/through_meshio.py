"""VTK (.vtk, .vtu), XDMF (.xdmf, .xmf) and other formats, read by meshio.

Groups are sets of cells and points, where a format has them, and the arrays of integers on cells or points: those where
the array NAME has the value 7 are the group "NAME 7"; where it has only 0 and 1, those with 1 are the group NAME too.
An array that numbers the cells or points, all values being different, makes no groups.
"""

import io
import struct
import warnings
import zlib
from collections.abc import Callable
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import ParseError

import meshio
import numpy as np

from ..errors import MeshError
from ..mesh import IntArray
from .draft import Draft

MOST = 1000
"""Values of an array beyond which it is not taken to tell groups."""
_KEPT = (".vtk", ".vtu", ".xdmf", ".xmf")

# meshio's readers fail on damaged files wherever their parsing stumbles.
_PARSER_FAILURES = (
    meshio.ReadError,
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
    """A mesh in a format that meshio knows by the suffix; `MeshError` if there is none, or the file is damaged."""
    mesh, complaints = _parse(path)
    points = np.zeros((len(mesh.points), 3))
    points[:, : np.shape(mesh.points)[1]] = mesh.points
    draft = Draft(points, complaints)
    if path.suffix.lower() not in _KEPT:
        draft.lost.append(f"groups that meshio does not keep of {path.suffix} files, if there are any")
    blocks = [(block.type, draft.add(block.type, _cells(block.data, len(points)))) for block in mesh.cells]

    for name, parts in mesh.cell_sets.items():
        for (kind, rows), members in zip(blocks, parts, strict=False):
            if members is not None:
                draft.mark(name, kind, rows[np.asarray(members, dtype=np.int64)])
    for name, members in mesh.point_sets.items():
        draft.mark_points(name, members)

    def mark_cells(name: str, cells: IntArray) -> None:
        first = 0
        for kind, rows in blocks:
            draft.mark(name, kind, rows[cells[(first <= cells) & (cells < first + len(rows))] - first])
            first += len(rows)

    for name, arrays in mesh.cell_data.items():
        _mark_values(draft, name, np.concatenate([np.asarray(array) for array in arrays]), mark_cells)
    for name, array in mesh.point_data.items():
        _mark_values(draft, name, np.asarray(array), draft.mark_points)
    return draft


def _mark_values(draft: Draft, name: str, values: Any, mark: Callable[[str, IntArray], None]) -> None:
    """The groups of an array with one integer for each cell or point."""
    if values.dtype.kind not in "iub" or values.size != len(values):
        return
    distinct, which = np.unique(values.ravel().astype(np.int64), return_inverse=True)
    if len(distinct) == len(values) > 2:
        return
    if len(distinct) > MOST:
        draft.lost.append(f"groups of the array {name!r}, which has {len(distinct)} values, more than {MOST}")
        return
    for place, value in enumerate(distinct.tolist()):
        mark(f"{name} {value}", np.flatnonzero(which == place))
    if set(distinct.tolist()) <= {0, 1}:
        mark(name, np.flatnonzero(values.ravel()))


def _cells(nodes: Any, n_points: int) -> IntArray:
    cells = np.asarray(nodes, dtype=np.int64)
    if not ((cells >= 0) & (cells < n_points)).all():
        raise MeshError(f"expected cells of points 0 to {n_points - 1}, found {cells.min()} to {cells.max()}")
    return cells


def _parse(path: Path) -> tuple[meshio.Mesh, list[str]]:
    """meshio's mesh and what it says of it. Each format of the suffix is tried by name: meshio itself would exit."""
    formats = meshio.extension_to_filetypes.get(path.suffix.lower(), [])
    if not formats:
        raise MeshError(f"expected a mesh format that meshio reads, found the suffix {path.suffix!r}")
    failures = []
    for name in formats:
        complaints = io.StringIO()
        try:
            with warnings.catch_warnings(), redirect_stderr(complaints):
                warnings.simplefilter("error", DeprecationWarning)  # numpy's, of text that ends too soon
                mesh = meshio._helpers.reader_map[name](str(path))
            return mesh, [text] if (text := " ".join(complaints.getvalue().split())) else []
        except _PARSER_FAILURES as error:
            failures.append(f"as {name}: {error or type(error).__name__}")
    raise MeshError(f"the mesh cannot be read ({'; '.join(failures)})")
