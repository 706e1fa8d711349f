"""Interfaces: frames on selected nodes or facets, as rows that pick or average displacements."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..body.selection import Selection
from ..errors import InterfaceError
from ..mesh.mesh import NO_NODES, IntArray
from ..mesh.nodes import Nodes
from .surface import (
    Fit,
    Surface,
    fit_of_points,
    fit_of_surface,
    mean_motion,
    mean_motion_of_points,
    mean_motion_of_sections,
)

MIN_RADIUS_RATIO = 1e-6
"""Second radius of a set of points over the first, below which they lie on a line and cannot carry
a moment.
"""


@dataclass(frozen=True, eq=False)
class Attachment:
    """A frame on the dofs of the mesh, u_C = rows @ u, with rows (3 or 6, n_u) sparse.

    X (3,): the position of the frame [m]; nodes: those that carry it; facets: the numbers of the
    facets that do, of `area` [m^2], none where nodes do. rigid: true where the nodes follow the
    frame as one piece, false where the frame follows the mean motion of the nodes.
    """

    X: Array
    rows: Any
    nodes: IntArray
    facets: IntArray = field(default_factory=lambda: NO_NODES)
    area: float = 0.0
    rigid: bool = False
    fit: Fit | None = None

    @property
    def rotates(self) -> bool:
        """True for a frame with rotations beside its displacements."""
        return bool(self.rows.shape[0] == 6)


class Attaches(Protocol):
    """A model that turns selections into frames on its dofs."""

    def attachment(self, selection: Selection) -> Attachment: ...


def attachments(
    table: str, selections: Mapping[str, Selection], model: Attaches
) -> dict[str, Attachment]:
    """The frames that the selections of a table of the body file pick, by name.

    `InterfaceError` names the table and the key of a selection that picks nothing, or too little to
    carry a frame.
    """
    frames = {}
    for name, selection in selections.items():
        try:
            frames[name] = model.attachment(selection)
        except InterfaceError as error:
            raise InterfaceError(f"{table}.{name}: {error}") from error
    return frames


def nodal_frame(node: int, nodes: Nodes) -> Attachment:
    """The dofs of one node: three displacements, and three rotations if it has them."""
    n_dofs = 6 if nodes.rotations[node] else 3
    columns = nodes.first[node] + np.arange(n_dofs)
    rows = sp.csr_array(
        (np.ones(n_dofs), (np.arange(n_dofs), columns)), shape=(n_dofs, nodes.n_dofs)
    )
    return Attachment(nodes.points[node], rows, np.array([node]))


def point_frame(selection: Selection, members: IntArray, nodes: Nodes) -> Attachment:
    """A frame with six dofs that points carry; the dofs of a single point."""
    # One point carries no moment; with a position or kind of its own a frame was meant.
    if len(members) == 1 and not selection.model_fields_set & {"kind", "at"}:
        return nodal_frame(int(members[0]), nodes)
    points = nodes.points[members]
    check_spread(points)
    X = points.mean(axis=0) if selection.at is None else np.array(selection.at)
    rows = mean_motion_of_points(members, X, nodes)
    fit = fit_of_points(members, nodes)
    return Attachment(X, rows, members, rigid=selection.rigid, fit=fit)


def section_frame(
    selection: Selection, members: IntArray, nodes: Nodes, radius: float
) -> Attachment:
    """A frame with six dofs that nodes of shells carry, also those of a straight edge.

    radius: of gyration of the sections there [m].
    """
    if len(members) == 1 and not selection.model_fields_set & {"kind", "at"}:
        return nodal_frame(int(members[0]), nodes)
    X = nodes.points[members].mean(axis=0) if selection.at is None else np.array(selection.at)
    rows = mean_motion_of_sections(members, X, nodes, radius)
    return Attachment(X, rows, members, rigid=selection.rigid)


def facet_frame(
    selection: Selection,
    numbers: IntArray,
    faces: Surface,
    nodes: Nodes,
    place: Array | None = None,
) -> Attachment:
    """A frame with six dofs that the surface of facets `numbers` carries.

    place (3,): where it stands unless `at` says it, by default at their centroid.
    """
    check_spread(nodes.points[faces.nodes])
    X = faces.centroid if place is None else place
    X = X if selection.at is None else np.array(selection.at)
    rows = mean_motion(faces, X, nodes)
    fit = fit_of_surface(faces, nodes)
    return Attachment(X, rows, faces.nodes, numbers, faces.area, selection.rigid, fit)


def check_spread(points: Array) -> None:
    """`InterfaceError` unless there are three points that are not on a line."""
    # The second singular value is the extent across the line that fits best.
    radii = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < 3 or radii[1] <= MIN_RADIUS_RATIO * radii[0]:
        raise InterfaceError(
            f"a frame needs three nodes that are not on a line, found {len(points)} nodes from "
            f"{points.min(axis=0).tolist()} to {points.max(axis=0).tolist()}; "
            "use node for a single one"
        )
