"""Interfaces: frames on selected nodes or facets, as rows that pick or average displacements."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..body.selection import InterfaceSelection
from ..errors import InterfaceError
from ..given.node_table import NodeTable
from ..mesh.cells import DIMENSIONS
from ..mesh.facets import Facets
from ..mesh.mesh import NONE, IntArray, Mesh
from ..mesh.nodes import Nodes

LINE = 1e-6
"""Second radius of a set of points over the first, below which they lie on a line and cannot carry
a moment.
"""
LISTED = 4
"""Nodes that a message lists."""


@dataclass(frozen=True, eq=False)
class Attachment:
    """A frame on the dofs of the mesh: u_C = rows @ u, with rows (3 or 6, n_u) sparse and the frame
    at X (3,).

    nodes: those that carry the frame; facets: the numbers of the facets that do, of `area` [m^2],
    none where nodes do. rigid: whether the nodes follow the frame as one piece, or the frame the
    nodes.
    """

    X: Array
    rows: Any
    nodes: IntArray
    facets: IntArray = field(default_factory=lambda: NONE)
    area: float = 0.0
    rigid: bool = False

    @property
    def rotates(self) -> bool:
        return bool(self.rows.shape[0] == 6)


def attachments(
    table: str,
    selections: Mapping[str, InterfaceSelection],
    mesh: Mesh,
    nodes: Nodes,
    facets: Facets | None,
) -> dict[str, Attachment]:
    """What the selections of a table of the body file pick, by name; `facets` of solids, None for
    beams.

    `InterfaceError` names the table and the key of what selects nothing, or too little to carry a
    frame.
    """

    def attachment(selection: InterfaceSelection) -> Attachment:
        _check_elements(selection, mesh)
        if selection.node is not None:
            return _nodal(_nearest_node(selection, mesh.points, mesh.size), nodes)
        if facets is None:
            return _on_beams(selection, mesh, nodes)
        return _on_solids(selection, mesh, nodes, facets)

    return _each(table, selections, attachment)


def node_attachments(
    table: str, selections: Mapping[str, InterfaceSelection], given: NodeTable, nodes: Nodes
) -> dict[str, Attachment]:
    """The same of nodes without elements: one gives its own dofs, several carry a frame of six."""

    def attachment(selection: InterfaceSelection) -> Attachment:
        if selection.node is not None:
            return _nodal(_nearest_node(selection, given.points, given.size), nodes)
        return _on_points(selection, _given_nodes(selection, given), nodes)

    return _each(table, selections, attachment)


def _each(
    table: str,
    selections: Mapping[str, InterfaceSelection],
    attachment: Callable[[InterfaceSelection], Attachment],
) -> dict[str, Attachment]:
    """The attachment of every selection; errors name the table and the key."""
    found = {}
    for name, selection in selections.items():
        try:
            found[name] = attachment(selection)
        except InterfaceError as error:
            raise InterfaceError(f"{table}.{name}: {error}") from error
    return found


def _check_elements(selection: InterfaceSelection, mesh: Mesh) -> None:
    """The nodes that a group names must be of elements, or nothing is there to carry a frame."""
    if selection.group is not None and len(loose := mesh.group(selection.group).loose):
        raise InterfaceError(
            f"group {selection.group!r} names {len(loose)} nodes that belong to no element and "
            f"have no mass, first at {loose[0].tolist()}: "
            "name the nodes or facets of the body that are to carry the frame"
        )


def _nodal(node: int, nodes: Nodes) -> Attachment:
    """The dofs of one node: three on a solid, six on a beam."""
    n_dofs = 6 if nodes.rotations[node] else 3
    columns = nodes.first[node] + np.arange(n_dofs)
    rows = sp.csr_array(
        (np.ones(n_dofs), (np.arange(n_dofs), columns)), shape=(n_dofs, nodes.n_dofs)
    )
    return Attachment(nodes.points[node], rows, np.array([node]))


def _on_beams(selection: InterfaceSelection, mesh: Mesh, nodes: Nodes) -> Attachment:
    """The frame of the one node that a group or shapes select."""
    if selection.model_fields_set & {"kind", "at"}:
        raise InterfaceError("kind and at belong to facets, of which a mesh of lines has none")
    members = _selected_nodes(selection, mesh)
    if len(members) != 1:
        listing = ", ".join(f"{node} at {mesh.points[node].tolist()}" for node in members[:LISTED])
        more = ", ..." if len(members) > LISTED else ""
        raise InterfaceError(
            f"expected one node of the lines, found {len(members)} in {selection}: "
            f"points {listing}{more}"
        )
    return _nodal(int(members[0]), nodes)


def _on_solids(
    selection: InterfaceSelection, mesh: Mesh, nodes: Nodes, facets: Facets
) -> Attachment:
    """A frame with six dofs that facets or points carry; with three, if a group names a single
    point.
    """
    from .surface import mean_motion, surface

    if _names_points(selection, mesh):
        return _on_points(selection, _selected_nodes(selection, mesh), nodes)
    numbers = _selected_facets(selection, mesh, facets)
    faces = surface(mesh.points, facets.patch(numbers))
    _check_spread(mesh.points[faces.nodes])
    X = faces.centroid if selection.at is None else np.array(selection.at)
    return Attachment(
        X, mean_motion(faces, X, nodes), faces.nodes, numbers, faces.area, selection.kind == "rigid"
    )


def _on_points(selection: InterfaceSelection, members: IntArray, nodes: Nodes) -> Attachment:
    """The dofs of a single point, or a frame with six that points carry."""
    from .surface import mean_motion_of_points

    if len(members) == 1 and not selection.model_fields_set & {"kind", "at"}:
        return _nodal(int(members[0]), nodes)
    points = nodes.points[members]
    _check_spread(points)
    X = points.mean(axis=0) if selection.at is None else np.array(selection.at)
    return Attachment(
        X, mean_motion_of_points(members, X, nodes), members, rigid=selection.kind == "rigid"
    )


def _nearest_node(selection: InterfaceSelection, points: Array, size: float) -> int:
    """The node nearest to the point of the selection; `InterfaceError` if it is farther than the
    tolerance allows.
    """
    distance = np.linalg.norm(points - np.array(selection.node), axis=1)
    node = int(distance.argmin())
    allowed = selection.tolerance * size
    if distance[node] > allowed:
        raise InterfaceError(
            f"no node at {list(selection.node or ())}: the nearest is at {points[node].tolist()}, "
            f"{distance[node]:.3g} m away; "
            f"tolerance {selection.tolerance} of the mesh size allows {allowed:.3g} m"
        )
    return node


def _names_points(selection: InterfaceSelection, mesh: Mesh) -> bool:
    """Whether the group of a selection is one of points; if not, it must be one of facets.

    Of a name that a file gives to several things, facets come first, then points, and solid
    elements do not count.
    """
    if selection.group is None:
        return False
    group = mesh.group(selection.group)
    dimensions = {DIMENSIONS.get(kind, 3) for kind in group.cells}
    if 2 in dimensions:
        return False
    if 0 in dimensions or len(group.points):
        return True
    raise InterfaceError(
        "expected a group of facets or of points, "
        f"found {', '.join(group.kinds)} in {selection.group!r}"
    )


def _selected_nodes(selection: InterfaceSelection, mesh: Mesh) -> IntArray:
    """The nodes (n,) of a group, or of the mesh, that lie in the shapes of a selection."""
    members = (
        np.arange(len(mesh.points))
        if selection.group is None
        else _group_nodes(mesh, selection.group)
    )
    found = members[selection.holds(mesh.points[members], mesh.size)]
    if not len(found):
        raise InterfaceError(f"no node lies in {selection}")
    return found


def _given_nodes(selection: InterfaceSelection, given: NodeTable) -> IntArray:
    """The rows (n,) of the nodes that labels name, or that a group and shapes have in common."""
    if selection.nodes is not None:
        labels = np.unique(selection.nodes)
        if len(unknown := given.unknown(labels)):
            raise InterfaceError(
                f"nodes: no node {unknown[0]} with stiffness or mass in {given.name}"
            )
        return given.rows(labels)
    members = np.arange(len(given.labels))
    if selection.group is not None:
        if selection.group not in given.groups:
            known = ", ".join(sorted(given.groups)) or "none"
            raise InterfaceError(
                f"no group {selection.group!r} in {given.name}; its groups are: {known}"
            )
        members = given.groups[selection.group]
    found = members[selection.holds(given.points[members], given.size)]
    if not len(found):
        raise InterfaceError(f"no node lies in {selection}")
    return found


def _selected_facets(selection: InterfaceSelection, mesh: Mesh, facets: Facets) -> IntArray:
    """The numbers (m,) of the facets of a group, or of the boundary, that lie in the shapes of a
    selection.
    """
    if selection.group is None:
        candidates = np.flatnonzero(facets.boundary)
    else:
        cells = {
            kind: rows
            for kind, rows in mesh.group(selection.group).cells.items()
            if DIMENSIONS.get(kind) == 2
        }
        candidates = np.concatenate(
            [_faces(mesh.cells[kind][rows], kind, facets) for kind, rows in cells.items()]
        )
    chosen = selection.holds(mesh.points, mesh.size)
    found = candidates[facets.within(chosen)[candidates]]
    if not len(found):
        nodes = np.unique(
            np.concatenate([part.ravel() for part in facets.patch(candidates).values()])
        )
        inside = nodes[chosen[nodes]]
        what = "facet of the boundary" if selection.group is None else "facet"
        near = f"only nodes do: {len(inside)}" if len(inside) else "nor does a node"
        raise InterfaceError(f"no {what} lies as a whole in {selection}, {near}")
    return found


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
    """The points of a group, each once; the nodes of its cells if it names no points."""
    group = mesh.group(name)
    nodes = {kind: mesh.cells[kind][rows].ravel() for kind, rows in group.cells.items()}
    points = np.unique(np.concatenate([nodes.get("vertex", NONE), group.points]))
    return points if len(points) else np.unique(np.concatenate(list(nodes.values())))


def _check_spread(points: Array) -> None:
    """Three points that are not on a line, or there is no rotation to speak of."""
    radii = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < 3 or radii[1] <= LINE * radii[0]:
        raise InterfaceError(
            f"a frame needs three nodes that are not on a line, found {len(points)} nodes from "
            f"{points.min(axis=0).tolist()} to {points.max(axis=0).tolist()}; "
            "use node for a single one"
        )
