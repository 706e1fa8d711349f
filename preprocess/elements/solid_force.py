"""Nodal forces of loads that are spread over facets and over volumes of solids."""

from collections.abc import Mapping

import numpy as np

from ...superelement.validation import Array
from ..mesh.facets import Patch
from ..mesh.mesh import IntArray, Mesh
from .element import cofactors, solid_element
from .facet import facet_shapes


def pressure_forces(points: Array, patch: Patch, pressure: float) -> Array:
    """Forces (n_points, 3) of a pressure against the outward normals of facets.

    f_i = -pressure int N_i n dA,   n dA = (x,1 x x,2) d(xi)
    """
    total = np.zeros_like(points)
    for kind, facets in patch.items():
        N, weights, normals = facet_shapes(points, kind, facets)
        forces = -pressure * np.einsum("kq,fqi->fki", N, normals * weights[:, None])
        # Facets share nodes: an indexed sum would keep the last facet alone.
        np.add.at(total, facets.ravel(), forces.reshape(-1, 3))
    return total


def traction_forces(points: Array, patch: Patch, traction: Array) -> Array:
    """Forces (n_points, 3) of a traction (3,) on facets, f_i = traction int N_i dA."""
    total = np.zeros_like(points)
    for kind, facets in patch.items():
        N, weights, normals = facet_shapes(points, kind, facets)
        areas = np.linalg.norm(normals * weights[:, None], axis=2) @ N.T
        np.add.at(total, facets.ravel(), areas.ravel()[:, None] * traction)
    return total


def volume_forces(mesh: Mesh, elements: Mapping[str, IntArray], density: Array) -> Array:
    """Forces (n_points, 3) of a force per volume (3,) in some elements, f_i = density int N_i dV.

    elements: their rows among the cells of each type.
    """
    total = np.zeros_like(mesh.points)
    for kind, rows in elements.items():
        solid, cells = solid_element(kind), mesh.cells[kind][rows]
        _, det = cofactors(solid.dN(solid.xi), mesh.points[cells])
        volumes = (det * solid.weights) @ solid.N(solid.xi).T
        np.add.at(total, cells.ravel(), volumes.ravel()[:, None] * density)
    return total
