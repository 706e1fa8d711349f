"""Interfaces: what the body file selects on the mesh, as rows that pick or average displacements."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..superelement.validation import Array
from .body import InterfaceSelection
from .errors import InterfaceError
from .mesh import IntArray, Mesh
from .nodes import Nodes


@dataclass(frozen=True, eq=False)
class Attachment:
    """An interface on the dofs of the mesh: u_C = rows @ u, with rows (3 or 6, n_u) sparse and the frame at X (3,).

    `slaves` are the nodes that follow the frame as one rigid piece; None where nothing is tied.
    """

    name: str
    X: Array
    rows: Any
    slaves: IntArray | None = None

    @property
    def n_dofs(self) -> int:
        return int(self.rows.shape[0])


def nodal(name: str, node: int, nodes: Nodes) -> Attachment:
    """The dofs of one node: three on a solid, six on a beam."""
    n_dofs = 6 if nodes.rotations[node] else 3
    columns = nodes.first[node] + np.arange(n_dofs)
    rows = sp.csr_array((np.ones(n_dofs), (np.arange(n_dofs), columns)), shape=(n_dofs, nodes.n_dofs))
    return Attachment(name, nodes.points[node], rows)


def beam_attachment(name: str, selection: InterfaceSelection, mesh: Mesh, nodes: Nodes) -> Attachment:
    """An interface of a beam: the node nearest to a point, or the one node of a group."""
    if selection.node is not None:
        return nodal(name, nearest_node(name, selection, mesh), nodes)
    if selection.group is None:
        raise InterfaceError(
            f"interfaces.{name}: a mesh of lines has no facets to select by a plane; use node or group"
        )
    members = group_nodes(mesh, selection.group)
    if len(members) != 1:
        raise InterfaceError(
            f"interfaces.{name}: expected a group of one node on a mesh of lines, found {len(members)} nodes "
            f"in {selection.group!r}"
        )
    return nodal(name, int(members[0]), nodes)


def nearest_node(name: str, selection: InterfaceSelection, mesh: Mesh) -> int:
    """The node nearest to the point of the selection; `InterfaceError` if it is farther than the tolerance allows."""
    distance = np.linalg.norm(mesh.points - np.array(selection.node), axis=1)
    node = int(distance.argmin())
    allowed = selection.tolerance * mesh.size
    if distance[node] > allowed:
        raise InterfaceError(
            f"interfaces.{name}: no node at {list(selection.node or ())}: the nearest is at "
            f"{mesh.points[node].tolist()}, {distance[node]:.3g} m away; tolerance {selection.tolerance} "
            f"of the mesh size allows {allowed:.3g} m"
        )
    return node


def group_nodes(mesh: Mesh, name: str) -> IntArray:
    """All nodes of a group, each once."""
    group = mesh.group(name)
    parts = [mesh.cells[kind][rows].ravel() for kind, rows in group.cells.items()]
    return np.unique(np.concatenate([*parts, group.points]))
