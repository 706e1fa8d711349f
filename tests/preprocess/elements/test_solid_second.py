"""Solids to second order, against the differences of St. Venant and Kirchhoff's energy."""

import numpy as np
import pytest
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements import inertia, solid_second
from duhamel.preprocess.elements.solid import solid_matrices
from duhamel.preprocess.elements.solid_second import SolidTensors
from duhamel.preprocess.mesh.reading import read_mesh

from ..blocks import mixed_mesh
from ..differences import mixed, quartic_form, relaxed_by_modes, strain_energy

MATERIALS = [
    Material(E=2.0, nu=0.3, rho=1.5),
    Material(E=(3.0, 1.0, 2.0), nu=(0.2, 0.1, 0.3), G=(0.5, 0.7, 0.9), rho=0.5),
]


@pytest.fixture
def solids(save):
    def make(mesh):
        """Tensors of a mesh whose elements are of two materials in turn, bent a little."""
        x, y, z = mesh.points.T
        mesh.points = np.stack([x + 0.1 * y * z, y + 0.1 * x**2, z - 0.05 * x * y], axis=1)
        mesh = read_mesh(save(mesh))
        owners = np.arange(mesh.n_elements) % 2
        _, M = solid_matrices(mesh, MATERIALS, owners)
        return SolidTensors("mesh", M[::3, ::3], mesh.points, mesh, MATERIALS, owners)

    return make


def motions_of(tensors, r):
    return np.random.default_rng(4).normal(size=(3 * len(tensors.X), r))


@pytest.fixture
def solid(solids, box, kind):
    return solids(box(kind, divisions=(2, 1, 1)))


def test_the_third_derivative_of_the_strain_energy(solid):
    motions = motions_of(solid, 3)
    energy = strain_energy(solid.mesh, solid.materials, solid.owners)
    D3 = solid.third(motions, motions)
    for k, j, m in ((0, 0, 0), (0, 0, 1), (0, 1, 2), (2, 0, 1), (1, 2, 2)):
        expected = mixed(energy, [motions[:, k], motions[:, j], motions[:, m]])
        assert D3[k, j, m] == pytest.approx(expected, abs=1e-10 * np.abs(D3).max())


def test_the_fourth_derivative_of_the_strain_energy(solid):
    motions = motions_of(solid, 4)
    energy = strain_energy(solid.mesh, solid.materials, solid.owners)
    pairs = inertia.pairs(4)
    E = solid.quartic(motions, None)[0]
    assert (pairs == pairs.T).all()
    for k, j, m, n in ((0, 0, 0, 0), (0, 0, 1, 1), (0, 1, 2, 3), (2, 2, 2, 1)):
        found = (
            E[pairs[k, j], pairs[m, n]] + E[pairs[k, m], pairs[j, n]] + E[pairs[k, n], pairs[j, m]]
        ) / 3.0
        four = [motions[:, i] for i in (k, j, m, n)]
        of_modes = relaxed_by_modes(solid.mesh, solid.materials, solid.owners, four)
        expected = quartic_form(energy, four) - of_modes
        assert found == pytest.approx(expected, abs=1e-10 * np.abs(E).max())


def test_loads_of_second_order_strains_are_the_work_of_the_initial_stress(solid):
    """Q_kl^T u + Q_ul^T psi_k + Q_uk^T psi_l = D3(u; psi_k, psi_l)."""
    motions = motions_of(solid, 3)
    pairs = inertia.pairs(3)
    work = motions.T @ solid.quartic(motions, None)[1]
    D3 = solid.third(motions, motions)
    for a, k, j in np.ndindex(3, 3, 3):
        found = work[a, pairs[k, j]] + work[k, pairs[a, j]] + work[j, pairs[a, k]]
        assert found == pytest.approx(D3[a, k, j], abs=1e-11 * np.abs(D3).max())


def test_elements_of_several_types_and_few_at_a_time(solids, monkeypatch):
    solid = solids(mixed_mesh(2))
    motions = motions_of(solid, 3)
    D3, (E, Q) = solid.third(motions, motions), solid.quartic(motions, None)
    energy = strain_energy(solid.mesh, solid.materials, solid.owners)
    expected = mixed(energy, list(motions.T))
    assert D3[0, 1, 2] == pytest.approx(expected, abs=1e-10 * np.abs(D3).max())
    monkeypatch.setattr(solid_second, "PRODUCT_BATCH", 1)
    found = (solid.third(motions, motions), *solid.quartic(motions, None))
    for one, other in zip(found, (D3, E, Q), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13 * np.abs(other).max())
