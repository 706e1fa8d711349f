"""Stiffness and mass of an ANSYS file .full, by ansys-mapdl-reader, an extra."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...files import in_one_line
from ..errors import MatrixError
from ..mesh.mesh import IntArray

MAX_LISTED_DOFS = 3
LAST_DIRECTION = 6  # of nodes: UX, UY, UZ, ROTX, ROTY, ROTZ; others are those of other physics


@dataclass(frozen=True, eq=False)
class FullFile:
    """K and M (n, n), sparse, of which one half is there, and label and dof (n, 2) of their rows.

    constrained (k, 2): the dofs that ANSYS has taken out of the matrices, as label and dof; their
    rows are empty.
    """

    K: Any
    M: Any
    dofs: IntArray
    constrained: IntArray

    def require_free(self) -> None:
        """`MatrixError` names dofs that are constrained."""
        if not len(self.constrained):
            return
        listed = [f"{node}.{dof}" for node, dof in self.constrained[:MAX_LISTED_DOFS].tolist()]
        more = ", ..." if len(self.constrained) > MAX_LISTED_DOFS else ""
        raise MatrixError(
            f"expected a free body, found {len(self.constrained)} constrained dofs, which ANSYS "
            f"takes out of the matrices ({', '.join(listed)}{more} as node.dof): write the file "
            "without D, CE and CP"
        )


def read_full(path: Path) -> FullFile:
    """Read both matrices of a .full file. `MatrixError` says why that cannot be done."""
    reader = _reader()
    try:
        file = reader(str(path))
        _check_length(path, file)
        dofs, K, M = file.load_km(sort=True)
        constrained = _from_one(file.const)
    except MatrixError:
        raise
    # The library has no errors of its own: whatever it stumbles over is damage.
    except Exception as error:
        raise MatrixError(
            f"not a .full file of ANSYS, or one that is not read: {in_one_line(error)}"
        ) from error
    if K is None or M is None:
        missing = "stiffness" if K is None else "mass"
        raise MatrixError(
            f"expected stiffness and mass, found no {missing}: write the file in a modal analysis"
        )
    rows = _from_one(dofs)
    if (other := rows[:, 1] > LAST_DIRECTION).any():
        node, dof = rows[other][0]
        raise MatrixError(
            f"expected UX, UY, UZ, ROTX, ROTY and ROTZ alone, found dof {dof} of node {node}, "
            "which is of another field"
        )
    return FullFile(sp.coo_array(K), sp.coo_array(M), rows, constrained)


@contextmanager
def _unchanged_theme() -> Iterator[None]:
    """The library sets colors and fonts of PyVista as it is imported: ours are to stay."""
    import pyvista

    theme = pyvista.global_theme
    kept = theme.cmap, theme.font.family, theme.title
    try:
        yield
    finally:
        theme.cmap, theme.font.family, theme.title = kept


def _reader() -> Any:
    try:
        with _unchanged_theme():
            from ansys.mapdl.reader.full import FullFile as Reader
    except ImportError as error:
        raise MatrixError(
            "reading ANSYS .full takes ansys-mapdl-reader: pip install 'duhamel[ansys]'"
        ) from error
    return Reader


def _from_one(dofs: Any) -> IntArray:
    """Label and dof (n, 2), of which the library counts dofs from 0."""
    pairs = np.asarray(dofs, dtype=np.int64).reshape(-1, 2)
    return np.column_stack([pairs[:, 0], pairs[:, 1] + 1])


def _check_length(path: Path, file: Any) -> None:
    """A file that breaks off must not reach the compiled part of the library, which trusts it."""
    words = int(file._header["ptrEND"])
    if words <= 0 or path.stat().st_size < 4 * words:
        raise MatrixError(
            f"expected {4 * words} bytes or more as its header says, found {path.stat().st_size}"
        )
