"""MED files of Salome and Code_Aster (.med): HDF5 with families of nodes and elements.

Source: MED data model, as the files of Gmsh and Salome show it: /ENS_MAA/MESH/STEP/{NOE,MAI},
/FAS/MESH/{NOEUD,ELEME}.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ....files.hdf5 import decoded, opened, whole
from ....superelement.validation import Array
from ...errors import MeshError
from ..cells import NODES_PER_CELL
from ..mesh import IntArray
from .draft import Draft

# Types of cells.
_KINDS = {
    "PO1": "vertex",
    "SE2": "line",
    "SE3": "line3",
    "TR3": "triangle",
    "TR6": "triangle6",
    "QU4": "quad",
    "QU8": "quad8",
    "QU9": "quad9",
    "TE4": "tetra",
    "T10": "tetra10",
    "HE8": "hexahedron",
    "H20": "hexahedron20",
    "H27": "hexahedron27",
    "PE6": "wedge",
    "P15": "wedge15",
    "PY5": "pyramid",
    "P13": "pyramid13",
}
_EDGES = [11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17]
# MED numbers solids as seen in a mirror. The corners in meshio's order, and the middles of edges
# and faces after them.
_MIRRORED = {
    "tetra": [0, 2, 1, 3],
    "tetra10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
    "wedge": [0, 2, 1, 3, 5, 4],
    "hexahedron": [0, 3, 2, 1, 4, 7, 6, 5],
    "hexahedron20": [0, 3, 2, 1, 4, 7, 6, 5, *_EDGES],
    "hexahedron27": [0, 3, 2, 1, 4, 7, 6, 5, *_EDGES, 21, 23, 24, 22, 20, 25, 26],
}
# Next to the first corner: its neighbors, counted to the right about the direction inwards.
_NEIGHBOURS = {"tetra": [1, 2, 3], "wedge": [1, 2, 3], "hexahedron": [1, 3, 4]}


@dataclass(frozen=True)
class _Support:
    """The nodes or the cells of one type, and the family (n,) of each; family 0 is none."""

    values: Any
    families: IntArray


def read(path: Path) -> Draft:
    """A mesh of MED; `MeshError` if the file is damaged or holds more than one mesh."""
    with opened(path, MeshError) as file:
        nodes, cells, groups = _contents(file)
    draft = Draft(nodes.values)
    for family, names in groups["NOEUD"].items():
        for name in names:
            draft.mark_points(name, np.flatnonzero(nodes.families == family))
    for code, support in cells.items():
        if code not in _KINDS:
            raise MeshError(f"unsupported cells of MED's type {code}")
        kind = _KINDS[code]
        k = NODES_PER_CELL[kind]
        if (
            support.values.shape[1] != k
            or not ((support.values >= 0) & (support.values < len(nodes.values))).all()
        ):
            raise MeshError(
                f"cells of MED's type {code}: expected {k} numbers of nodes, "
                f"1 to {len(nodes.values)}"
            )
        rows = draft.add(kind, _turned(kind, support.values, nodes.values))
        for family, names in groups["ELEME"].items():
            for name in names:
                draft.mark(name, kind, rows[support.families == family])
    return draft


def _contents(file: Any) -> tuple[_Support, dict[str, _Support], dict[str, dict[int, list[str]]]]:
    """Nodes, cells by type with their nodes from 0, and the names of the groups of every family."""
    name = _only(file["ENS_MAA"], "mesh")
    mesh = file["ENS_MAA"][name]
    # Meshes that move have one group for each time step; those of meshio have none.
    step = mesh if "NOE" in mesh else mesh[_only(mesh, "time step")]
    nodes = _support(step["NOE"], "COO", "f")
    if not 1 <= nodes.values.shape[1] <= 3:
        raise MeshError(
            f"NOE/COO: expected 1 to 3 coordinates of a node, found {nodes.values.shape[1]}"
        )
    points = np.zeros((len(nodes.values), 3))
    points[:, : nodes.values.shape[1]] = nodes.values
    cells = {code: _support(group, "NOD") for code, group in step["MAI"].items()}
    families = file["FAS"][name] if name in file.get("FAS", {}) else {}
    groups = {what: _groups(families.get(what, {})) for what in ("NOEUD", "ELEME")}
    numbered = {
        code: _Support(cell.values.astype(np.int64) - 1, cell.families)
        for code, cell in cells.items()
    }
    return _Support(points, nodes.families), numbered, groups


def _only(group: Any, what: str) -> str:
    names = list(group)
    if len(names) != 1:
        raise MeshError(f"expected one {what} in the file, found {', '.join(names) or 'none'}")
    return str(names[0])


def _support(group: Any, dataset: str, kinds: str = "iu") -> _Support:
    """The nodes or cells of one type: a dataset column by column, and their families, 0 without
    any.

    kinds: those of numpy that the numbers may be of.
    """
    count, values = int(group[dataset].attrs["NBR"]), whole(group[dataset])
    if values.ndim != 1 or count < 1 or values.size % count:
        raise MeshError(
            f"{group.name}/{dataset}: expected values for {count} entries, found {values.size}"
        )
    if values.dtype.kind not in kinds:
        raise MeshError(f"{group.name}/{dataset}: expected numbers, found {values.dtype}")
    families = whole(group["FAM"]) if "FAM" in group else np.zeros(count, dtype=np.int64)
    if families.shape != (count,) or families.dtype.kind not in "iu":
        raise MeshError(
            f"{group.name}/FAM: expected {count} families, found {families.dtype} "
            f"of shape {families.shape}"
        )
    return _Support(values.reshape(-1, count).T, families.astype(np.int64))


def _groups(families: Any) -> dict[int, list[str]]:
    return {
        int(family.attrs["NUM"]): [
            decoded("the name of a group", bytes(name).rstrip(b"\0 "))
            for name in whole(family["GRO"]["NOM"]).view("u1")
        ]
        for family in families.values()
        if "GRO" in family
    }


def _turned(kind: str, cells: IntArray, points: Array) -> IntArray:
    """Cells in meshio's order. Some programs, meshio among them, do not mirror: theirs have a
    volume as they are.
    """
    if kind not in _MIRRORED:
        return cells
    corners = points[cells]
    a, b, c = (corners[:, i] - corners[:, 0] for i in _NEIGHBOURS[kind.rstrip("0123456789")])
    mirrored = np.einsum("ni,ni->n", np.cross(a, b), c) < 0.0
    return np.where(mirrored[:, None], cells[:, _MIRRORED[kind]], cells)
