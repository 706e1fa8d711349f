"""Nodes and facets that a selection of the body file picks on a mesh or in a table of nodes."""

import numpy as np

from ...superelement.validation import Array
from ..body.selection import Selection
from ..errors import InterfaceError
from ..given.node_table import NodeTable
from ..mesh.cells import CELL_DIMENSIONS
from ..mesh.facets import Facets
from ..mesh.mesh import NO_NODES, IntArray, Mesh


def check_elements(selection: Selection, mesh: Mesh) -> None:
    """The nodes that a group names must be of elements, or nothing is there to carry a frame."""
    if selection.group is not None and len(loose := mesh.group(selection.group).loose):
        raise InterfaceError(
            f"group {selection.group!r} names {len(loose)} nodes that belong to no element and "
            f"have no mass, first at {loose[0].tolist()}: "
            "name the nodes or facets of the body that are to carry the frame"
        )


def nearest_node(selection: Selection, points: Array, size: float) -> int:
    """The node nearest to a point; `InterfaceError` if it is farther than the tolerance."""
    distance = np.linalg.norm(points - np.array(selection.node), axis=1)
    node = int(distance.argmin())
    # Relative to the mesh: the coordinates in a body file are rounded as the user has them.
    allowed = selection.tolerance * size
    if distance[node] > allowed:
        raise InterfaceError(
            f"no node at {list(selection.node or ())}: the nearest is at {points[node].tolist()}, "
            f"{distance[node]:.3g} m away; "
            f"tolerance {selection.tolerance} of the mesh size allows {allowed:.3g} m"
        )
    return node


def names_points(selection: Selection, mesh: Mesh) -> bool:
    """True for a group of points, false for one of facets; `InterfaceError` for other groups.

    A name may stand for several kinds of things: facets come first, then points; solid elements do
    not count.
    """
    if selection.group is None:
        return False
    group = mesh.group(selection.group)
    dimensions = {CELL_DIMENSIONS.get(kind, 3) for kind in group.cells}
    if 2 in dimensions:
        return False
    if 0 in dimensions or len(group.points):
        return True
    raise InterfaceError(
        "expected a group of facets or of points, "
        f"found {', '.join(group.kinds)} in {selection.group!r}"
    )


def mesh_nodes(selection: Selection, mesh: Mesh) -> IntArray:
    """The nodes (n,) of a group, or of the mesh, that lie in the shapes of a selection."""
    members = (
        np.arange(len(mesh.points))
        if selection.group is None
        else _nodes_of_group(mesh, selection.group)
    )
    inside = members[selection.holds(mesh.points[members], mesh.size)]
    if not len(inside):
        raise InterfaceError(f"no node lies in {selection}")
    return inside


def table_nodes(selection: Selection, table: NodeTable) -> IntArray:
    """The rows (n,) of the nodes that labels name, or that a group and shapes have in common."""
    if selection.nodes is not None:
        labels = np.unique(selection.nodes)
        if len(unknown := table.unknown(labels)):
            raise InterfaceError(
                f"nodes: no node {unknown[0]} with stiffness or mass in {table.name}"
            )
        return table.rows(labels)
    members = np.arange(len(table.labels))
    if selection.group is not None:
        if selection.group not in table.groups:
            known = ", ".join(sorted(table.groups)) or "none"
            raise InterfaceError(
                f"no group {selection.group!r} in {table.name}; its groups are: {known}"
            )
        members = table.groups[selection.group]
    inside = members[selection.holds(table.points[members], table.size)]
    if not len(inside):
        raise InterfaceError(f"no node lies in {selection}")
    return inside


def mesh_facets(selection: Selection, mesh: Mesh, facets: Facets) -> IntArray:
    """The facets (m,) of a group, or of the boundary, that lie in the shapes of a selection."""
    group = selection.facet_group
    if group is None:
        candidates = np.flatnonzero(facets.boundary)
    else:
        cells = {
            kind: rows
            for kind, rows in mesh.group(group).cells.items()
            if CELL_DIMENSIONS.get(kind) == 2
        }
        candidates = np.concatenate(
            [_faces(mesh.cells[kind][rows], kind, facets) for kind, rows in cells.items()]
        )
    chosen = selection.holds(mesh.points, mesh.size)
    numbers = candidates[facets.within(chosen)[candidates]]
    if not len(numbers):
        nodes = np.unique(
            np.concatenate([part.ravel() for part in facets.patch(candidates).values()])
        )
        # Facets cut by a shape are the usual mistake, so the message says that nodes are there.
        inside = nodes[chosen[nodes]]
        what = "facet of the boundary" if group is None else "facet"
        near = f"only nodes do: {len(inside)}" if len(inside) else "nor does a node"
        raise InterfaceError(f"no {what} lies as a whole in {selection}, {near}")
    return numbers


def _faces(cells: IntArray, kind: str, facets: Facets) -> IntArray:
    """The numbers (m,) of the facets that the cells of a group name."""
    numbers = facets.matching(kind, cells)
    if (numbers < 0).any():
        raise InterfaceError(
            f"{(numbers < 0).sum()} of {len(cells)} {kind} cells are no face of an element, "
            f"first that of points {cells[int(np.argmin(numbers))].tolist()}"
        )
    return numbers


def _nodes_of_group(mesh: Mesh, name: str) -> IntArray:
    """The points of a group, each once; the nodes of its cells if it names no points."""
    group = mesh.group(name)
    nodes = {kind: mesh.cells[kind][rows].ravel() for kind, rows in group.cells.items()}
    # A name often stands for points and for the facets around them; points are meant then.
    points = np.unique(np.concatenate([nodes.get("vertex", NO_NODES), group.points]))
    return points if len(points) else np.unique(np.concatenate(list(nodes.values())))
