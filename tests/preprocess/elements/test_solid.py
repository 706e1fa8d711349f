"""Solid elements: patch tests, groups of materials, and the errors of bad elements."""

import numpy as np
import pytest
from duhamel.preprocess import MeshError, assemble
from duhamel.preprocess.mesh.cells import FACET_TYPES
from duhamel.preprocess.mesh.facets import facets_of
from duhamel.preprocess.mesh.reading import read_mesh

E, NU = 2.1e11, 0.3

TETRA = [((0, 1), 4), ((1, 2), 5), ((2, 0), 6), ((0, 3), 7), ((1, 3), 8), ((2, 3), 9)]
MIDDLES = {"tetra": [], "tetra10": TETRA, "hexahedron": [], "wedge": []}


def energy_density(strain: np.ndarray) -> float:
    lam, mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
    return 0.5 * lam * np.trace(strain) ** 2 + mu * np.sum(strain * strain)


def perturbed(mesh, kind, amount=0.06):
    """Inner nodes moved at random; middle nodes with them, so that edges stay straight."""
    points, cells = mesh.points.copy(), mesh.cells[-1].data
    corners = np.unique(cells[:, : {"tetra10": 4}.get(kind, cells.shape[1])])
    inner = corners[((points[corners] > 1e-9) & (points[corners] < 1 - 1e-9)).all(axis=1)]
    shift = np.zeros_like(points)
    shift[inner] = np.random.default_rng(2).uniform(-amount, amount, (len(inner), 3))
    for edge, middle in MIDDLES[kind]:
        shift[cells[:, middle]] = 0.5 * (shift[cells[:, edge[0]]] + shift[cells[:, edge[1]]])
    mesh.points = points + shift
    return mesh


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron", "wedge"])
def test_patch_of_distorted_elements(solid_body, box, kind):
    """A linear displacement has its exact energy, and leaves inner nodes without force."""
    structure = assemble(solid_body(perturbed(box(kind, divisions=(3, 3, 3)), kind)))
    gradient = np.random.default_rng(0).normal(size=(3, 3))
    points = structure.nodes.points
    u = (points @ gradient.T).ravel()
    strain = 0.5 * (gradient + gradient.T)
    assert 0.5 * u @ (structure.K @ u) == pytest.approx(energy_density(strain), rel=1e-12)
    inside = ((points > 1e-9) & (points < 1 - 1e-9)).all(axis=1)
    force = (structure.K @ u).reshape(-1, 3)
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(force).max()


def test_energy_of_every_constant_strain(solid_body, box, kind):
    structure = assemble(solid_body(box(kind)))
    points = structure.nodes.points
    for i in range(3):
        for j in range(i, 3):
            gradient = np.zeros((3, 3))
            gradient[i, j] = 1.0
            u = (points @ gradient.T).ravel()
            expected = energy_density(0.5 * (gradient + gradient.T))
            assert 0.5 * u @ (structure.K @ u) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("kind", ["hexahedron", "tetra10", "hexahedron20", "hexahedron27"])
def test_hexahedra_and_quadratic_elements_hold_pure_bending(solid_body, box, kind):
    """u = (xy, -x^2/2 - nu (y^2 - z^2)/2, -nu yz) has stress E y along x alone: energy E int y^2 /
    2.
    """
    structure = assemble(solid_body(box(kind)))
    x, y, z = (structure.nodes.points - [0.0, 0.5, 0.5]).T
    u = np.stack([x * y, -(x**2) / 2 - NU * (y**2 - z**2) / 2, -NU * y * z], axis=1).ravel()
    assert 0.5 * u @ (structure.K @ u) == pytest.approx(E / 24, rel=1e-12)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron20", "hexahedron27"])
def test_the_volume_of_a_curved_body(solid_body, box, kind):
    """Quadratic elements hold a quadratic map exactly; this one has a unit determinant."""
    mesh = box(kind)
    x, y, z = mesh.points.T
    mesh.points = np.stack([x + y**2 / 3, y, z + 0.2 * x**2], axis=1)
    assert assemble(solid_body(mesh)).rigid.mass == pytest.approx(7800.0, rel=1e-12)


def test_sides_have_their_middles_between_their_corners(save, box, kind):
    mesh = read_mesh(save(box(kind, divisions=(2, 1, 1))))
    facets = facets_of(mesh)
    numbers = np.arange(facets.count)
    for facet, nodes in facets.patch(numbers).items():
        c, points = FACET_TYPES[facet].corners, mesh.points
        ring = points[nodes[:, :c]]
        if nodes.shape[1] >= 2 * c:
            middles = 0.5 * (ring + np.roll(ring, -1, axis=1))
            np.testing.assert_allclose(points[nodes[:, c : 2 * c]], middles, rtol=0, atol=1e-15)
        if nodes.shape[1] == 9:
            np.testing.assert_allclose(points[nodes[:, 8]], ring.mean(axis=1), rtol=0, atol=1e-15)
    middle = np.array([0.5, 0.5, 0.5])
    for facet, nodes in facets.patch(numbers[facets.boundary]).items():
        ring = mesh.points[nodes[:, : FACET_TYPES[facet].corners]]
        outward = np.cross(ring[:, 1] - ring[:, 0], ring[:, 2] - ring[:, 1])
        assert (np.einsum("fi,fi->f", outward, ring.mean(axis=1) - middle) > 0).all()


def test_materials_by_group(solid_body, box):
    mesh = box("hexahedron", size=(2.0, 1.0, 1.0), divisions=(2, 1, 1))
    block = mesh.cells[2]
    mesh.cells[2:] = [type(block)("hexahedron", block.data[[i]]) for i in (0, 1)]
    mesh.cell_data = {
        key: [*data[:2], np.array([3]), np.array([4])] for key, data in mesh.cell_data.items()
    }
    del mesh.field_data["box"]
    mesh.field_data |= {"left": np.array([3, 3]), "right": np.array([4, 3])}
    light, heavy = {"E": E, "nu": NU, "rho": 1.0}, {"E": E / 2, "nu": NU, "rho": 3.0}
    structure = assemble(solid_body(mesh, material=None, materials={"left": light, "right": heavy}))
    assert structure.rigid.mass == pytest.approx(4.0, rel=1e-14)
    assert structure.rigid.center[0] == pytest.approx((0.5 + 3 * 1.5) / 4, rel=1e-14)
    u = np.zeros((12, 3))
    u[:, 0] = structure.nodes.points[:, 0]
    strain = np.diag([1.0, 0.0, 0.0])
    expected = energy_density(strain) * 1.5
    assert 0.5 * u.ravel() @ (structure.K @ u.ravel()) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("kind", ["tetra", "tetra10", "hexahedron", "wedge"])
def test_an_inverted_element_is_named(solid_body, box, kind):
    mesh = box(kind)
    cells = mesh.cells[-1].data
    cells[3, [0, 1]] = cells[3, [1, 0]]
    with pytest.raises(
        MeshError,
        match=rf"mesh.msh: {kind} element 3 of group box is inverted.* 1 of {len(cells)} el",
    ):
        assemble(solid_body(mesh))


def test_a_mirrored_mesh_is_inverted_throughout(solid_body, box, kind):
    mesh = box(kind)
    mesh.points = mesh.points * [1, 1, -1]
    n = len(mesh.cells[-1].data)
    with pytest.raises(
        MeshError,
        match=rf"mesh.msh: {kind} element 0 of group box is inverted.* {n} of {n} elements",
    ):
        assemble(solid_body(mesh))


def test_flat_elements_are_degenerate(solid_body, box, kind):
    mesh = box(kind)
    mesh.points[:, 2] = 0.0
    with pytest.raises(MeshError, match=rf"{kind} element 0 of group box is degenerate"):
        assemble(solid_body(mesh))


def test_neighbors_must_share_their_middle_nodes(solid_body, box):
    mesh = box("tetra10", divisions=(1, 1, 1))
    cells = mesh.cells[-1].data
    twin = len(mesh.points)
    mesh.points = np.vstack([mesh.points, mesh.points[cells[0, 6]]])
    mesh.point_data = {}
    cells[0, 6] = twin
    with pytest.raises(
        MeshError, match=r"share their corners but not their middle nodes.*element \d+, at"
    ):
        assemble(solid_body(mesh))
