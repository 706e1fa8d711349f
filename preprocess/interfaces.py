"""Interfaces: what the body file selects on the mesh, as rows that pick or average displacements."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..superelement.validation import Array
from .errors import InterfaceError
from .facets import Facets
from .mesh import DIMENSIONS, NONE, IntArray, Mesh
from .nodes import Nodes
from .selection import InterfaceSelection

LINE = 1e-6
"""Second radius of a set of points over the first, below which they lie on a line and cannot carry a moment."""


@dataclass(frozen=True, eq=False)
class Attachment:
    """A frame on the dofs of the mesh: u_C = rows @ u, with rows (3 or 6, n_u) sparse and the frame at X (3,).

    `tied` are the nodes that follow the frame as one rigid piece; none where the frame follows the nodes.
    """

    X: Array
    rows: Any
    tied: IntArray

    @property
    def rotates(self) -> bool:
        return bool(self.rows.shape[0] == 6)


def nodal(node: int, nodes: Nodes) -> Attachment:
    """The dofs of one node: three on a solid, six on a beam."""
    n_dofs = 6 if nodes.rotations[node] else 3
    columns = nodes.first[node] + np.arange(n_dofs)
    rows = sp.csr_array((np.ones(n_dofs), (np.arange(n_dofs), columns)), shape=(n_dofs, nodes.n_dofs))
    return Attachment(nodes.points[node], rows, tied=np.zeros(0, dtype=np.int64))


def beam_attachment(selection: InterfaceSelection, mesh: Mesh, nodes: Nodes) -> Attachment:
    """A frame of a beam: the node nearest to a point, or the one node of a group."""
    if selection.model_fields_set & {"kind", "at"}:
        raise InterfaceError("kind and at belong to facets, of which a mesh of lines has none")
    if selection.node is not None:
        return nodal(nearest_node(selection, mesh), nodes)
    if selection.group is None:
        raise InterfaceError("a mesh of lines has no facets to select by a plane; use node or group")
    members = _group_nodes(mesh, selection.group)
    if len(members) != 1:
        raise InterfaceError(
            f"expected a group of one node on a mesh of lines, found {len(members)} nodes in {selection.group!r}"
        )
    return nodal(int(members[0]), nodes)


def nearest_node(selection: InterfaceSelection, mesh: Mesh) -> int:
    """The node nearest to the point of the selection; `InterfaceError` if it is farther than the tolerance allows."""
    distance = np.linalg.norm(mesh.points - np.array(selection.node), axis=1)
    node = int(distance.argmin())
    allowed = selection.tolerance * mesh.size
    if distance[node] > allowed:
        raise InterfaceError(
            f"no node at {list(selection.node or ())}: the nearest is at "
            f"{mesh.points[node].tolist()}, {distance[node]:.3g} m away; tolerance {selection.tolerance} "
            f"of the mesh size allows {allowed:.3g} m"
        )
    return node


def solid_attachment(selection: InterfaceSelection, mesh: Mesh, nodes: Nodes, facets: Facets) -> Attachment:
    """A frame of a solid: a node with three dofs, or a frame with six that facets or points carry."""
    from .surface import mean_motion, mean_motion_of_points, surface

    if selection.node is not None:
        return nodal(nearest_node(selection, mesh), nodes)
    chosen = _selected_facets(selection, mesh, facets)
    if len(chosen):
        faces = surface(mesh.points, facets.patch(chosen))
        members = faces.nodes
        X = faces.centroid if selection.at is None else np.array(selection.at)
        _check_spread(mesh.points[members])
        rows = mean_motion(faces, X, nodes)
    else:
        members = _group_nodes(mesh, selection.group or "")
        if len(members) == 1 and not selection.model_fields_set & {"kind", "at"}:
            return nodal(int(members[0]), nodes)
        X = mesh.points[members].mean(axis=0) if selection.at is None else np.array(selection.at)
        _check_spread(mesh.points[members])
        rows = mean_motion_of_points(members, X, nodes)
    tied = members if selection.kind == "rigid" else members[:0]
    return Attachment(X, rows, tied)


def _selected_facets(selection: InterfaceSelection, mesh: Mesh, facets: Facets) -> IntArray:
    """The numbers (m,) of the facets of a plane or a group; none if the group is of points."""
    if selection.plane is not None:
        plane = selection.plane
        distance = plane.tolerance * mesh.size
        normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
        found = facets.boundary_within(np.abs((mesh.points - plane.point) @ normal) <= distance)
        if not len(found):
            raise InterfaceError(
                f"no facet of the boundary lies within {distance:.3g} m of the plane through "
                f"{list(plane.point)} with normal {list(plane.normal)}"
            )
        return found
    group = mesh.group(selection.group or "")
    dimensions = {DIMENSIONS.get(kind, 3) for kind in group.cells}
    if dimensions == {2}:
        return np.concatenate([_faces(mesh.cells[kind][rows], kind, facets) for kind, rows in group.cells.items()])
    if dimensions <= {0}:
        return NONE
    raise InterfaceError(
        f"expected a group of facets or of points, found {', '.join(group.kinds)} in {selection.group!r}"
    )


def _faces(cells: IntArray, kind: str, facets: Facets) -> IntArray:
    """The numbers (m,) of the facets that the cells of a group name."""
    found = facets.matching(kind, cells)
    if (found < 0).any():
        raise InterfaceError(
            f"{(found < 0).sum()} of {len(cells)} {kind} cells are no face of an element, "
            f"first that of points {cells[int(np.argmin(found))].tolist()}"
        )
    return found


def _group_nodes(mesh: Mesh, name: str) -> IntArray:
    """All nodes of a group, each once."""
    group = mesh.group(name)
    parts = [mesh.cells[kind][rows].ravel() for kind, rows in group.cells.items()]
    return np.unique(np.concatenate([*parts, group.points]))


def _check_spread(points: Array) -> None:
    """Three points that are not on a line, or there is no rotation to speak of."""
    radii = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < 3 or radii[1] <= LINE * radii[0]:
        raise InterfaceError(
            f"a frame needs three nodes that are not on a line, found {len(points)} nodes "
            f"from {points.min(axis=0).tolist()} to {points.max(axis=0).tolist()}; use node for a single one"
        )
