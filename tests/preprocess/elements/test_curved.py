"""Curved bodies: volume and inertia of a ring converge to their closed forms with the order of the
geometry.
"""

import numpy as np
import pytest
from duhamel.preprocess.assembly.rigid import rigid_modes
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements.solid import solid_matrices
from duhamel.preprocess.mesh.mesh import Mesh
from duhamel.preprocess.mesh.nodes import Nodes

from ..blocks import solid_cells

INNER, OUTER, HEIGHT, RHO = 0.6, 1.0, 0.5, 3.0
ORDERS = {
    "tetra": 2,
    "tetra10": 4,
    "hexahedron": 2,
    "hexahedron20": 4,
    "hexahedron27": 4,
    "wedge": 2,
}


def ring(kind, n):
    """A box rolled up into a ring of n elements round and n/8 through, whose ends are the same
    nodes.
    """
    divisions = (n // 8, n, 1)
    grid, cells = solid_cells(kind, divisions)
    grid[:, 1] %= 2 * n
    grid, merged = np.unique(grid, axis=0, return_inverse=True)
    radius = INNER + (OUTER - INNER) * grid[:, 0] / (2.0 * divisions[0])
    angle = np.pi * grid[:, 1] / n
    points = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), HEIGHT * grid[:, 2] / 2.0], axis=1
    )
    return Mesh("ring", points, {kind: merged.ravel()[cells]}, {}, (kind,))


def errors(mesh):
    """Of mass, axial and transverse inertia, relative."""
    materials = [Material(E=1.0, nu=0.0, rho=RHO)]
    _, M = solid_matrices(mesh, materials, np.zeros(mesh.n_elements, dtype=np.int64))
    rigid = rigid_modes(Nodes(mesh.points, np.zeros(len(mesh.points), dtype=bool)), M)
    mass = RHO * np.pi * (OUTER**2 - INNER**2) * HEIGHT
    axial = 0.5 * mass * (OUTER**2 + INNER**2)
    transverse = 0.5 * axial + mass * HEIGHT**2 / 12
    np.testing.assert_allclose(rigid.center, [0, 0, HEIGHT / 2], rtol=0, atol=1e-3)
    found = np.array([rigid.mass, rigid.J_rot[2, 2], rigid.J_rot[0, 0]])
    return np.abs(found / [mass, axial, transverse] - 1)


def test_mass_and_inertia_of_a_ring(kind):
    coarse, fine = errors(ring(kind, 16)), errors(ring(kind, 32))
    order = np.log2(coarse / fine)
    np.testing.assert_allclose(order, ORDERS[kind], rtol=0, atol=0.1)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron20", "hexahedron27"])
def test_curved_elements_are_far_closer_than_straight_ones(kind):
    """24 elements round: the error of chords is (2 pi / 24)^2 / 6, that of parabolas below a
    hundredth of it.
    """
    assert errors(ring(kind, 24))[0] < 0.01 * (2 * np.pi / 24) ** 2 / 6
