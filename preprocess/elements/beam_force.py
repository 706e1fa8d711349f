"""Nodal forces of loads along lines, consistent with the shapes of beams."""

import numpy as np

from ...superelement.validation import Array
from ..body.material import Section
from ..mesh.mesh import IntArray, Mesh
from .beam import BEAM_GAUSS_POINTS, beam_properties, lengths_and_axes, section_motion


def line_forces(mesh: Mesh, sections: list[Section], rows: IntArray, density: Array) -> Array:
    """Forces and moments (n_points, 6) of a force per length (3,) on some lines, in mesh axes.

    f = int N^T density ds, with the shapes of the elements: of uniform bending loads deflections
    and rotations are then exact at the nodes.
    """
    L, axes = lengths_and_axes(mesh, sections)
    local = np.zeros((len(L), 12))
    properties = beam_properties(sections, L)
    along = np.einsum("eij,j->ei", axes, density)
    for xi, weight in zip(*BEAM_GAUSS_POINTS, strict=True):
        motion = section_motion(float(xi), L, properties)[:, :3]
        local += (weight * L)[:, None] * np.einsum("eij,ei->ej", motion, along)
    parts = local.reshape(-1, 4, 3)
    forces = np.einsum("eij,eki->ekj", axes, parts).reshape(-1, 2, 6)
    total = np.zeros((len(mesh.points), 6))
    lines = mesh.cells["line"][rows]
    np.add.at(total, lines.ravel(), forces[rows].reshape(-1, 6))
    return total
