"""Shells of second order, divided into those of first order between their nodes."""

from dataclasses import replace

import numpy as np

from ..errors import MeshError
from .cells import SHELL_CELLS
from .mesh import Group, IntArray, Mesh

MIDDLE_OF_SIDES = np.array([-0.25] * 4 + [0.5] * 4)
"""weights of the nodes of a quadrangle with eight nodes in its middle"""
CELL_DIVISIONS = {
    "triangle6": ("triangle", np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])),
    "quad9": ("quad", np.array([[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]])),
}
"""what a cell becomes, and the nodes (4, k) of its four parts"""


def divided(mesh: Mesh) -> Mesh:
    """The same shells in triangles and quadrangles of their corners alone, four for each cell.

    All nodes are kept, and with them the curvature; quadrangles with eight nodes get a ninth one in
    the middle of their surface. Groups keep what they have. `MeshError` where shells of first and
    of second order meet, which do not share the nodes on their sides.
    """
    of_second = [kind for kind in mesh.body_types if kind not in SHELL_CELLS]
    if not of_second:
        return mesh
    # A node on one side only would leave a slit between both.
    if len(of_second) < len(mesh.body_types):
        raise MeshError(
            f"{mesh.name}: expected shells of one order, found {', '.join(mesh.body_types)}, which "
            "do not share the nodes on their sides"
        )
    whole = _with_middles(mesh)
    cells = {kind: nodes for kind, nodes in whole.cells.items() if kind not in CELL_DIVISIONS}
    rows: dict[str, tuple[str, IntArray]] = {}
    for kind in (kind for kind in whole.body_types if kind in CELL_DIVISIONS):
        into, parts = CELL_DIVISIONS[kind]
        pieces = whole.cells[kind][:, parts]
        first = len(cells.get(into, ()))
        pieces_flat = pieces.reshape(-1, pieces.shape[2])
        cells[into] = np.vstack([cells[into], pieces_flat]) if into in cells else pieces_flat
        rows[kind] = into, first + np.arange(len(pieces_flat)).reshape(-1, len(parts))
    groups = {name: _group(group, rows) for name, group in whole.groups.items()}
    kinds = tuple(kind for kind in SHELL_CELLS if kind in cells)
    return replace(whole, cells=cells, groups=groups, body_types=kinds)


def _with_middles(mesh: Mesh) -> Mesh:
    """Quadrangles with eight nodes as ones with nine."""
    if "quad8" not in mesh.body_types:
        return mesh
    nodes = mesh.cells["quad8"]
    middles = np.einsum("k,nki->ni", MIDDLE_OF_SIDES, mesh.points[nodes])
    nine = np.column_stack([nodes, len(mesh.points) + np.arange(len(nodes))])
    before = mesh.cells.get("quad9", np.zeros((0, 9), dtype=np.int64))
    cells = {kind: rows for kind, rows in mesh.cells.items() if kind != "quad8"}
    cells["quad9"] = np.vstack([before, nine])

    def moved(group: Group) -> Group:
        found = {kind: rows for kind, rows in group.cells.items() if kind != "quad8"}
        if "quad8" in group.cells:
            own = found.get("quad9", np.zeros(0, dtype=np.int64))
            found["quad9"] = np.concatenate([own, len(before) + group.cells["quad8"]])
        return replace(group, cells=found)

    labels = mesh.labels
    if labels is not None:
        # Numbers of no node of the file, so that none of these is mistaken for one.
        labels = np.concatenate([labels, np.full(len(nodes), -1, dtype=labels.dtype)])
    kinds = tuple(kind for kind in mesh.body_types if kind not in ("quad8", "quad9"))
    return replace(
        mesh,
        points=np.vstack([mesh.points, middles]),
        cells=cells,
        groups={name: moved(group) for name, group in mesh.groups.items()},
        body_types=(*kinds, "quad9"),
        labels=labels,
    )


def _group(group: Group, rows: dict[str, tuple[str, IntArray]]) -> Group:
    cells = {kind: found for kind, found in group.cells.items() if kind not in rows}
    for kind, (into, parts) in rows.items():
        if kind in group.cells:
            own = cells.get(into, np.zeros(0, dtype=np.int64))
            cells[into] = np.concatenate([own, parts[group.cells[kind]].ravel()])
    return replace(group, cells=cells)
