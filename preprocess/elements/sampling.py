"""Rows that read displacements, their gradients and strains at a point of a mesh of solids."""

from typing import Any

import numpy as np

from ..body.material import Material
from ..mesh.mesh import Mesh
from ..mesh.nodes import node_dofs
from ..sparse import in_columns
from .assumed import assumed
from .element import solid_element
from .location import Location
from .strain import at_samples


def displacement_rows(mesh: Mesh, place: Location) -> Any:
    """Rows (3, 3 n), sparse: the displacement of a point."""
    solid, cell = solid_element(place.kind), mesh.cells[place.kind][place.row]
    N = solid.N(place.xi[:, None])[:, 0]
    blocks = np.einsum("k,ij->ikj", N, np.eye(3)).reshape(3, -1)
    return in_columns(blocks, node_dofs(cell[None], 3)[0], 3 * len(mesh.points))


def gradient_rows(mesh: Mesh, place: Location) -> Any:
    """Rows (9, 3 n), sparse: the gradient du_i / dx_j at a point, all j of the first i first."""
    solid, cell = solid_element(place.kind), mesh.cells[place.kind][place.row]
    dN = solid.dN(place.xi[:, None])[:, :, 0]
    by_place = dN @ np.linalg.inv(mesh.points[cell].T @ dN)
    blocks = np.einsum("kj,il->ijkl", by_place, np.eye(3)).reshape(9, -1)
    return in_columns(blocks, node_dofs(cell[None], 3)[0], 3 * len(mesh.points))


def point_strain_rows(mesh: Mesh, place: Location, material: Material) -> Any:
    """Rows (6, 3 n), sparse: strains at a point, in the order xx, yy, zz, 2 yz, 2 xz, 2 xy.

    By the polynomial through the strains at the samples of its element, as at the nodes of the
    surface (`strain_rows`), but of that element alone, which is of `material`.
    """
    cell, samples = mesh.cells[place.kind][place.row], solid_element(place.kind).samples
    strained = assumed(place.kind, material).on(mesh.points[cell][None], material.elasticity)
    blocks = strained.strains(samples)[0] @ at_samples(place.kind, place.xi[:, None])[0]
    return in_columns(blocks, node_dofs(cell[None], 3)[0], 3 * len(mesh.points))
