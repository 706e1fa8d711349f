"""Surfaces that other bodies may touch: facets of the boundary, their nodes and normals."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement import Surface
from ...superelement.validation import Array
from ..body.body import Body
from ..errors import InterfaceError
from ..mesh.cells import FACET_TYPES
from ..mesh.facets import Patch
from ..mesh.mesh import IntArray
from ..mesh.nodes import node_dofs
from .interfaces import Attachment
from .source import Source
from .surface import surface

MIN_NODES, MAX_NODES = 10, 1000
"""of a surface: fewer resolve no contact, and more take gigabytes of compliance"""


@dataclass(frozen=True, eq=False)
class Patches:
    """The surfaces of a body, and the displacements (3 n, n_u), sparse, of all their nodes.

    fields: displacements, then stresses if asked for, of all points of the recovery, sparse; no
    rows without one.
    """

    surfaces: tuple[Surface, ...]
    rows: Any
    fields: Any


def selected_surfaces(
    body: Body, source: Source, frames: Mapping[str, Attachment], T: Any, center: Array
) -> Patches | None:
    """The surfaces of a body file, about its center of mass (3,); None where it has none.

    T (3 n, n_u): displacements of the nodes of the source. `InterfaceError` names the table of one
    that selects nothing, facets of several types, too few or too many nodes, or a rigid interface.
    """
    if not body.surfaces:
        return None
    surfaces = []
    for name, selection in body.surfaces.items():
        try:
            found = _surface(name, source.nodes.points, source.touched(selection), center)
            _check_elastic(found, frames)
        except InterfaceError as error:
            raise InterfaceError(f"{source.name}: surfaces.{name}: {error}") from error
        surfaces.append(found)
    nodes = np.concatenate([found.nodes for found in surfaces])
    fields = T[:0]
    if body.recovery is not None:
        points = source.field_points(body.recovery.stress)
        fields = sp.vstack([points.displacement_rows(T), points.stress_rows(T)], format="csr")
    return Patches(tuple(surfaces), T[node_dofs(nodes[:, None], 3).ravel()].tocsr(), fields)


def _surface(name: str, points: Array, patch: Patch, center: Array) -> Surface:
    if len(patch) > 1:
        found = " and ".join(f"{len(facets)} {kind}" for kind, facets in patch.items())
        raise InterfaceError(
            f"expected facets of one type, found {found}: select a surface of each type"
        )
    ((kind, facets),) = patch.items()
    faces = surface(points, patch)
    nodes = faces.nodes
    if not MIN_NODES <= len(nodes) <= MAX_NODES:
        raise InterfaceError(f"expected {MIN_NODES} to {MAX_NODES} nodes, found {len(nodes)}")
    # Facets by the numbers of nodes within the surface, where these ascend as in the mesh.
    local = np.searchsorted(nodes, facets)
    X = points[nodes]
    return Surface(name, nodes, X - center, local, kind, nodal_normals(X, local, kind), faces.area)


def _check_elastic(found: Surface, frames: Mapping[str, Attachment]) -> None:
    for name, frame in frames.items():
        # Nodes that cannot move against each other have a singular compliance.
        if frame.rigid and (shared := int(np.isin(found.nodes, frame.nodes).sum())):
            raise InterfaceError(
                f"expected nodes that can move against each other, found {shared} on the rigid "
                f"interface {name}"
            )


def nodal_normals(points: Array, facets: IntArray, kind: str) -> Array:
    """Unit normals (n, 3) at the points (n, 3) of facets (n_f, k) of one type.

    The mean of the normals that the facets have there, each weighted by its angle: how a surface is
    cut into facets does not matter. Source: G. Thürmer, C. A. Wüthrich, J. Graphics Tools 3 (1998)
    43-46.
    """
    import skfem

    element: skfem.Element = getattr(skfem, FACET_TYPES[kind].shapes)()
    k = facets.shape[1]
    at_nodes = element.doflocs.T
    # At the nodes of all facets of a type these are the same.
    gradients = [element.lbasis(at_nodes, i)[1] for i in range(k)]
    dN = np.array([np.broadcast_to(gradient, at_nodes.shape) for gradient in gradients])
    tangents = np.einsum("kdq,fki->dfqi", dN, points[facets])
    across = np.cross(tangents[0], tangents[1])
    unit = across / np.linalg.norm(across, axis=2, keepdims=True)
    normals = np.zeros_like(points)
    np.add.at(normals, facets, unit * _angles(points, facets, FACET_TYPES[kind].corners)[..., None])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return normals


def _angles(points: Array, facets: IntArray, corners: int) -> Array:
    """The angles (n_f, k) of facets at their nodes: pi on a side, 2 pi in the middle."""
    X = points[facets[:, :corners]]
    after, before = (np.roll(X, shift, axis=1) - X for shift in (-1, 1))
    sizes = np.linalg.norm(after, axis=2) * np.linalg.norm(before, axis=2)
    cosines = np.einsum("fki,fki->fk", after, before) / sizes
    angles = np.full(facets.shape, np.pi)
    # Rounding may leave cosines a little beyond 1.
    angles[:, :corners] = np.arccos(np.clip(cosines, -1.0, 1.0))
    angles[:, 2 * corners :] = 2.0 * np.pi
    return angles
