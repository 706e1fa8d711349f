"""Hexahedra with 8 nodes in the usual tests: Cook's membrane and the beams of MacNeal and Harder.

R. H. MacNeal, R. L. Harder, Finite Elements in Analysis and Design 1 (1985) 3-20. All elements, and
those of CalculiX, are in docs/validation.md.
"""

import numpy as np
import pytest
import scipy.sparse.linalg as sla
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements.solid import solid_matrices
from duhamel.preprocess.elements.solid_force import traction_forces
from duhamel.preprocess.mesh.facets import facets_of
from duhamel.preprocess.mesh.mesh import Mesh

from ..preprocess.blocks import solid_cells

pytestmark = pytest.mark.validation


def block(divisions, place, kind="hexahedron"):
    grid, cells = solid_cells(kind, divisions)
    return Mesh("block", place(*(grid / (2.0 * np.array(divisions))).T), {kind: cells}, {}, (kind,))


def displacements(mesh, E, nu, tip, direction, fixed):
    """Of a unit force, spread over the facets on the nodes `tip`; fixed (n, 3)."""
    facets = facets_of(mesh)
    loaded = [
        facets.first[kind] + np.flatnonzero(tip[nodes].all(axis=1))
        for kind, nodes in facets.nodes.items()
    ]
    patch = facets.patch(np.concatenate(loaded))
    f = traction_forces(mesh.points, patch, np.array(direction, dtype=float)).ravel()
    owners = np.zeros(mesh.n_elements, dtype=np.int64)
    K = solid_matrices(mesh, [Material(E=E, nu=nu, rho=1.0)], owners)[0].tocsc()
    u, free = np.zeros(len(f)), ~fixed.ravel()
    u[free] = sla.spsolve(K[free][:, free], f[free] / np.abs(f.sum()))
    return u.reshape(-1, 3)


def everywhere(on):
    return np.repeat(on[:, None], 3, axis=1)


@pytest.mark.parametrize(("axis", "reference"), [(1, 0.1081), (2, 0.4321)])
def test_a_straight_beam_of_six_elements(axis, reference):
    mesh = block((6, 1, 1), lambda x, y, z: np.stack([6 * x, 0.2 * y, 0.1 * z], axis=1))
    x = mesh.points[:, 0]
    tip = x > 6 - 1e-9
    u = displacements(mesh, 1e7, 0.3, tip, np.eye(3)[axis], everywhere(x < 1e-9))
    assert u[tip, axis].mean() == pytest.approx(reference, rel=0.03)


@pytest.mark.parametrize(
    ("kind", "share"), [("hexahedron", 0.880), ("hexahedron20", 0.875), ("hexahedron27", 0.878)]
)
def test_a_curved_beam_of_six_elements(kind, share):
    """A radial force at its end; 0.875 is what the authors have for elements of 20 nodes."""

    def place(x, y, z):
        r, angle = 4.12 + 0.2 * y, 0.5 * np.pi * x
        return np.stack([r * np.cos(angle), r * np.sin(angle), -0.1 * z], axis=1)

    mesh = block((6, 1, 1), place, kind)
    tip = np.abs(mesh.points[:, 0]) < 1e-9
    u = displacements(mesh, 1e7, 0.25, tip, (0, 1, 0), everywhere(np.abs(mesh.points[:, 1]) < 1e-9))
    assert u[tip, 1].mean() == pytest.approx(share * 0.08734, rel=2e-3)


@pytest.mark.parametrize(("axis", "reference"), [(2, 0.005424), (1, 0.001754)])
def test_a_beam_twisted_by_a_right_angle(axis, reference):
    def place(x, y, z):
        c, s = np.cos(0.5 * np.pi * x), np.sin(0.5 * np.pi * x)
        y, z = 1.1 * (y - 0.5), 0.32 * (z - 0.5)
        return np.stack([12 * x, c * y - s * z, s * y + c * z], axis=1)

    mesh = block((12, 2, 1), place)
    x = mesh.points[:, 0]
    tip = x > 12 - 1e-9
    u = displacements(mesh, 29e6, 0.22, tip, np.eye(3)[axis], everywhere(x < 1e-9))
    assert u[tip, axis].mean() == pytest.approx(reference, rel=0.02)


def cook(n, nu, kind="hexahedron", plane_strain=False):
    """The deflection amid the far side of Cook's membrane, E = 1, by a force 1 per thickness 1."""

    def place(x, y, z):
        return np.stack([48 * x, 44 * x + y * (44 - 28 * x), z], axis=1)

    mesh = block((n, n, 1), place, kind)
    x, y, z = mesh.points.T
    fixed = np.zeros((len(x), 3), dtype=bool)
    fixed[:, :2] = (x < 1e-9)[:, None]
    fixed[:, 2] = True if plane_strain else z < 1e-9
    u = displacements(mesh, 1.0, nu, x > 48 - 1e-9, (0, 1, 0), fixed)
    return float(u[(x > 48 - 1e-9) & (np.abs(y - 52) < 1e-6), 1].mean())


def test_cooks_membrane():
    """23.96, a converged value of plane stress; the error falls with the square of the size."""
    errors = [23.96 - cook(n, 1 / 3) for n in (8, 16)]
    assert 0.0 < errors[1] < 0.005 * 23.96
    assert errors[0] / errors[1] > 2.5


def test_cooks_membrane_nearly_incompressible():
    """Linear hexahedra and quadratic ones of 27 nodes come together, from below."""
    linear = [cook(n, 0.4999, plane_strain=True) for n in (8, 16, 32)]
    quadratic = cook(16, 0.4999, "hexahedron27", plane_strain=True)
    gaps = quadratic - np.array(linear)
    assert (np.diff(gaps) < 0).all()
    assert 0.0 < gaps[-1] < 0.01 * quadratic
