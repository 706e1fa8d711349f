"""The surface of a mesh, with what modes displace there and what stresses they leave."""

from dataclasses import dataclass

import numpy as np

from ..superelement import Recovery
from ..superelement.validation import Array
from .assembly.structure import Structure, materials_of
from .body.body import Body
from .body.material import Material
from .errors import BodyError, MethodError
from .mesh.cells import LINES
from .mesh.facets import facets_of
from .mesh.mesh import IntArray, Mesh
from .responses.modal import Shapes

BATCH = 2**10
"""Points at which stresses are made at once, lest strains and stresses of all of them take memory
twice.
"""


def check_recovery(body: Body, mesh: Mesh) -> None:
    """Before anything expensive: `BodyError` for stresses of lines, `MethodError` for a method
    without modes.
    """
    if body.recovery is None:
        return
    if body.recovery.stress and mesh.body_types == LINES:
        raise BodyError(
            f"recovery.stress: expected a mesh of solids, found {mesh.name}, one of lines"
        )
    if body.impulse.method == "march":
        raise MethodError(
            "[recovery] needs modes, which impulse.method march does not find: use auto, "
            "krylov or modal"
        )


def recover(body: Body, mesh: Mesh, structure: Structure, shapes: Shapes) -> Recovery:
    """Modes at the points of lines or at the nodes of the surface of solids, and stresses there if
    asked for.

        phi = T shapes,   stress = C strain(T shapes)

    Facets keep all their nodes and turn outwards. A node where materials meet is a point for each
    of them, with stresses of its own. `shapes` gives the mode shapes of what is linear in the dofs
    of the structure.
    """
    if mesh.body_types == LINES:
        nodes, cells, stress = np.arange(len(mesh.points)), mesh.cells["line"], None
    else:
        materials, owners = materials_of(body, mesh)
        surface = surface_of(mesh, owners)
        nodes, cells = surface.nodes, surface.cells
        wanted = body.recovery is not None and body.recovery.stress
        stress = _stresses(mesh, surface, materials, structure, shapes) if wanted else None
    dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
    phi = shapes(structure.T[dofs]).reshape(len(nodes), 3, -1)
    return Recovery(mesh.points[nodes] - structure.rigid.center, cells, phi, stress)


@dataclass(frozen=True, eq=False)
class SolidSurface:
    """The boundary of a mesh of solids as points, one for each node and material that bounds there.

    nodes (p,) and owners (p,): the node and the material of each point; cells (n, k): facets as
    points, -1 filling short rows; places: by type of element (n_elements, k), the point that each
    node is, -1 for none.
    """

    nodes: IntArray
    owners: IntArray
    cells: IntArray
    places: dict[str, IntArray]


def surface_of(mesh: Mesh, owners: IntArray) -> SolidSurface:
    """The surface of a mesh whose elements (n_elements,) are of the materials `owners`."""
    facets = facets_of(mesh)
    owner = np.empty(facets.count, dtype=np.int64)
    for kind, sides in facets.sides.items():
        owner[sides] = _of(owners, mesh, kind)[:, None]
    outer = np.flatnonzero(facets.boundary)
    patch = facets.patch(outer).values()
    width = max(nodes.shape[1] for nodes in patch)
    cells = np.vstack(
        [
            np.pad(nodes, ((0, 0), (0, width - nodes.shape[1])), constant_values=-1)
            for nodes in patch
        ]
    )
    # A node of a material is one number, node + n_nodes * material, until points are counted.
    n_nodes = len(mesh.points)
    cells = np.where(cells >= 0, cells + n_nodes * owner[outer][:, None], -1)
    keys = np.unique(cells[cells >= 0])
    point = np.full(n_nodes * (1 + int(owners.max())), -1)
    point[keys] = np.arange(len(keys))
    places = {
        kind: point[cells + n_nodes * _of(owners, mesh, kind)[:, None]]
        for kind, cells in mesh.elements.items()
    }
    return SolidSurface(
        keys % n_nodes, keys // n_nodes, np.where(cells >= 0, point[cells], -1), places
    )


def _of(per_element: IntArray, mesh: Mesh, kind: str) -> IntArray:
    """The part of (n_elements,) that belongs to a type of element."""
    return per_element[mesh.first[kind] :][: len(mesh.cells[kind])]


def _stresses(
    mesh: Mesh,
    surface: SolidSurface,
    materials: list[Material],
    structure: Structure,
    shapes: Shapes,
) -> Array:
    """sigma = C strain of every mode at every point of the surface (p, 6, m), in the order of
    `STRESSES`.
    """
    from .elements.strain import strain_rows

    rows = (strain_rows(mesh, surface.places) @ structure.T).tocsr()
    C = np.array([material.elasticity for material in materials])
    parts = []
    for first in range(0, len(surface.nodes), BATCH):
        owners = surface.owners[first : first + BATCH]
        strains = shapes(rows[6 * first : 6 * (first + len(owners))]).reshape(len(owners), 6, -1)
        parts.append(C[owners] @ strains)
    return np.concatenate(parts)
