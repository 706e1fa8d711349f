"""Matrices of solids against scikit-fem's own forms, on curved elements too; symmetry; several
types in one body.
"""

from dataclasses import dataclass, field

import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from duhamel.preprocess import MeshError, assemble
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements.element import solid_element
from duhamel.preprocess.elements.solid import GRADIENT_BATCH, solid_matrices
from duhamel.preprocess.mesh.mesh import Mesh
from skfem.helpers import ddot, dot, sym_grad

from ..blocks import mixed_mesh, named, solid_cells
from ..differences import element_references

E, NU, RHO = 2.1e11, 0.3, 7800.0
STEEL = Material(E=E, nu=NU, rho=RHO)
WOOD = Material(E=(12e9, 0.9e9, 0.5e9), nu=(0.4, 0.5, 0.7), G=(0.8e9, 0.7e9, 0.05e9), rho=450.0)


@dataclass(repr=False)
class MeshHexS2(skfem.MeshHex1):
    """Hexahedra with curved edges, which scikit-fem has the element for."""

    elem: type[skfem.Element] = field(default=skfem.ElementHexS2)


GRIDS = {
    "tetra": skfem.MeshTet1,
    "tetra10": skfem.MeshTet2,
    "hexahedron": skfem.MeshHex1,
    "hexahedron20": MeshHexS2,
    "hexahedron27": skfem.MeshHex2,
    "wedge": skfem.MeshWedge1,
}


def curved(kind, divisions=(2, 2, 1)):
    """A box bent, twisted and tapered: quadratic elements follow, the others have faces that are
    not plane.
    """
    grid, cells = solid_cells(kind, divisions)
    x, y, z = (grid / (2.0 * np.array(divisions))).T
    points = np.stack([x + 0.2 * y**2, y + 0.1 * x * z, z * (1.0 + 0.3 * x) + 0.1 * x**2], axis=1)
    return Mesh("curved", points, {kind: cells}, {}, (kind,))


def matrices(mesh, *materials, owners=None):
    return solid_matrices(
        mesh, materials, np.zeros(mesh.n_elements, dtype=np.int64) if owners is None else owners
    )


def forms(mesh, stress):
    """K and M of scikit-fem's forms, for a density of 1, on elements that share no nodes, brought
    together after.
    """
    ((kind, cells),) = mesh.elements.items()
    element = solid_element(kind)
    order = np.argsort(element.order)
    nodes = cells[:, order]
    n, k = nodes.shape
    per_cell = np.arange(n * k).reshape(n, k).T
    grid = GRIDS[kind](mesh.points[nodes].reshape(-1, 3).T, per_cell)
    mapping = skfem.MappingIsoparametric(grid, element.shapes)
    quadrature = (element.xi, element.weights)
    vector = skfem.ElementVector(element.shapes)
    basis = skfem.CellBasis(grid, vector, mapping, quadrature=quadrature, disable_doflocs=True)
    stiffness = skfem.BilinearForm(lambda u, v, _: ddot(stress(sym_grad(u)), sym_grad(v))).assemble(
        basis
    )
    mass = skfem.BilinearForm(lambda u, v, _: dot(u, v)).assemble(basis)
    together = (3 * nodes[:, :, None] + np.arange(3)).reshape(n, 3 * k).T
    gather = sp.csr_array(
        (np.ones(basis.N), (basis.element_dofs.ravel(), together.ravel())),
        shape=(basis.N, 3 * len(mesh.points)),
    )
    return gather.T @ stiffness @ gather, gather.T @ mass @ gather


def hooke(strain):
    lam, mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
    return lam * np.einsum("ii...", strain) * np.eye(3)[:, :, None, None] + 2 * mu * strain


def assert_equal(found, expected, rtol=1e-13):
    assert abs(found - expected).max() < rtol * abs(expected).max()


TURNED_WOOD = WOOD.model_copy(update={"axes": ((1.0, 2.0, 0.5), (-1.0, 1.0, 0.0))})
OF_NODES = ["tetra", "tetra10", "hexahedron20", "hexahedron27"]
"""Types whose strains are those of their nodes, where the material is compressible."""


@pytest.mark.parametrize("kind", OF_NODES)
def test_stiffnesses_are_those_of_scikit_fem(kind):
    mesh = curved(kind)
    assert_equal(matrices(mesh, STEEL)[0], forms(mesh, hooke)[0])


def test_masses_are_those_of_scikit_fem(kind):
    mesh = curved(kind)
    assert_equal(matrices(mesh, STEEL)[1], RHO * forms(mesh, hooke)[1])


@pytest.mark.parametrize("kind", OF_NODES)
def test_orthotropic_stiffnesses_are_those_of_scikit_fem(kind):
    mesh, C = curved(kind), TURNED_WOOD.elasticity_tensor
    K, _ = matrices(mesh, TURNED_WOOD)
    assert_equal(K, forms(mesh, lambda strain: np.einsum("ijkl,kl...->ij...", C, strain))[0])


@pytest.mark.parametrize("material", [STEEL, TURNED_WOOD], ids=["steel", "wood"])
@pytest.mark.parametrize("kind", ["hexahedron", "wedge"])
def test_stiffnesses_with_modes_are_those_of_their_least_energy(kind, material):
    """Modes and projected dilatation, point by point, on elements of any shape."""
    mesh = curved(kind, (2, 1, 1))
    K, _ = matrices(mesh, material)
    expected = np.zeros(K.shape)
    owners = np.zeros(mesh.n_elements, dtype=np.int64)
    for nodes, element in element_references(mesh, [material], owners):
        units = np.eye(3 * len(nodes)).reshape(-1, len(nodes), 3)
        strains = [element.linear(element.moved(unit)) for unit in units]
        dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
        expected[np.ix_(dofs, dofs)] += [[element.work(a, b) for a in strains] for b in strains]
    assert_equal(K.toarray(), expected, rtol=1e-12)


def test_matrices_are_symmetric_to_the_last_bit(kind):
    for matrix in matrices(curved(kind), WOOD):
        assert (matrix != matrix.T).nnz == 0
        assert matrix.has_canonical_format


def test_tied_faces_and_masses_leave_them_symmetric(solid_body, box, kind):
    interfaces = {"root": {"group": "root", "kind": "rigid"}, "tip": {"group": "tip"}}
    masses = {"tool": {"interface": "tip", "mass": 0.7, "inertia": [1.0, 2.0, 2.5]}}
    structure = assemble(solid_body(box(kind), interfaces=interfaces, masses=masses))
    for matrix in (structure.K, structure.M):
        assert matrix.format == "csc"
        assert (matrix != matrix.T).nnz == 0


def test_batches_and_materials_add_up():
    """More elements than a batch holds, in two materials by turns: the sum of both parts by
    themselves.
    """
    mesh = curved("tetra", (12, 12, 4))
    assert mesh.n_elements > GRADIENT_BATCH / (3 * 4 * 4)
    owners = np.arange(mesh.n_elements) % 2
    K, M = matrices(mesh, STEEL, WOOD, owners=owners)
    cells = mesh.cells["tetra"]
    parts = [
        matrices(Mesh("part", mesh.points, {"tetra": cells[owners == i]}, {}, ("tetra",)), material)
        for i, material in enumerate((STEEL, WOOD))
    ]
    assert_equal(K, parts[0][0] + parts[1][0], rtol=1e-15)
    assert_equal(M, parts[0][1] + parts[1][1], rtol=1e-15)


def l_shape(solid_body, divisions=1, **changes):
    interfaces = {"tip": {"plane": {"point": [2, 0, 0], "normal": [1, 0, 0]}}}
    return solid_body(mixed_mesh(divisions), **({"interfaces": interfaces} | changes))


def test_a_patch_of_several_types(solid_body):
    """Tetrahedra, wedges and hexahedra: a linear displacement has its exact energy, and leaves
    inner nodes unloaded.
    """
    structure = assemble(l_shape(solid_body, 2))
    gradient = np.random.default_rng(0).normal(size=(3, 3))
    points = structure.nodes.points
    u = (points @ gradient.T).ravel()
    strain = 0.5 * (gradient + gradient.T)
    density = 0.5 * np.sum(hooke(strain[:, :, None, None])[:, :, 0, 0] * strain)
    assert 0.5 * u @ (structure.K @ u) == pytest.approx(3 * density, rel=1e-12)
    x, y, z = points.T
    inside = (x > 0) & (x < 2) & (y > 0) & (y < 1) & (z > 0) & (z < 2) & ~((x >= 1) & (z <= 1))
    force = (structure.K @ u).reshape(-1, 3)
    assert inside.sum() == 5
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(force).max()
    assert structure.rigid.mass == pytest.approx(3 * RHO, rel=1e-13)
    np.testing.assert_allclose(structure.rigid.center, [5 / 6, 0.5, 7 / 6], rtol=1e-13)


def test_materials_of_several_types(solid_body):
    """Elements are counted through the types, whichever order the materials come in."""
    materials = {
        kind: {"E": E, "nu": NU, "rho": rho}
        for kind, rho in (("hexahedron", 1), ("tetra", 2), ("wedge", 4))
    }
    structure = assemble(l_shape(solid_body, 2, material=None, materials=materials))
    assert structure.rigid.mass == pytest.approx(7, rel=1e-13)
    expected = (
        1 * np.array([1.5, 0.5, 1.5])
        + 2 * np.array([0.5, 0.5, 0.5])
        + 4 * np.array([0.5, 0.5, 1.5])
    ) / 7
    np.testing.assert_allclose(structure.rigid.center, expected, rtol=1e-13)


def test_frames_on_faces_of_two_types(solid_body):
    """The top of the L has triangles of wedges and quadrilaterals of hexahedra; its frame stands at
    its middle.
    """
    interfaces = {"top": {"plane": {"point": [0, 0, 2], "normal": [0, 0, 1]}}}
    structure = assemble(l_shape(solid_body, 2, interfaces=interfaces))
    (top,) = structure.interfaces
    np.testing.assert_allclose(top.X + structure.rigid.center, [1, 0.5, 2], rtol=1e-13)
    A = structure.nodes.rigid_motion(top.X + structure.rigid.center)
    np.testing.assert_allclose(structure.P_C @ A, np.eye(6), rtol=0, atol=1e-13)


def test_a_bad_element_of_a_second_type_is_named(solid_body):
    mesh = mixed_mesh(2)
    wedges = mesh.cells[1].data
    wedges[3] = wedges[3][[1, 0, 2, 4, 3, 5]]
    with pytest.raises(
        MeshError, match=r"mesh.msh: wedge element 3 of group wedge is inverted.* 1 of 72 elements"
    ):
        assemble(solid_body(mesh, interfaces={"tip": {"node": [2, 1, 2]}}))


def stacked(lower, upper):
    """One unit cube of a type on one of another, which share the nodes where they touch."""
    (below, cells), (above, others) = (solid_cells(kind, (1, 1, 1)) for kind in (lower, upper))
    above[:, 2] += 2
    corners = np.concatenate([below[cells].reshape(-1, 3), above[others].reshape(-1, 3)])
    grid, numbers = np.unique(corners, axis=0, return_inverse=True)
    numbers = numbers.ravel()
    parts = [("a", lower, numbers[: cells.size].reshape(cells.shape))]
    return named(grid / 2.0, [*parts, ("b", upper, numbers[cells.size :].reshape(others.shape))])


def test_a_quadrilateral_bounded_by_triangles(solid_body):
    message = (
        r"mesh.msh: 1 quadrilateral faces are bounded by triangles .* at \[0.5, 0.5, 1.0\].*; "
        "put wedges between"
    )
    with pytest.raises(MeshError, match=message):
        assemble(
            solid_body(stacked("tetra", "hexahedron"), interfaces={"tip": {"node": [0, 0, 0]}})
        )


@pytest.mark.parametrize(
    ("lower", "upper", "faces"),
    [
        ("hexahedron20", "hexahedron27", "quad8, quad9"),
        ("hexahedron", "hexahedron20", "quad, quad8"),
        ("tetra10", "wedge", "triangle6, triangle, quad"),
    ],
)
def test_elements_of_different_order_do_not_fit(solid_body, lower, upper, faces):
    message = (
        f"expected elements that fit each other, found {lower}, {upper}, "
        f"whose faces are {faces}: mesh all"
    )
    with pytest.raises(MeshError, match=message):
        assemble(solid_body(stacked(lower, upper), interfaces={"tip": {"node": [0, 0, 0]}}))


@pytest.mark.parametrize("number", ["1", "2"])
def test_pieces_and_threads_change_no_bit(monkeypatch, number, kind):
    """Rows in many pieces, elements in many batches, on one thread and two."""
    mesh = curved(kind, (3, 3, 2))
    expected = matrices(mesh, WOOD)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: range(2), raising=False)
    monkeypatch.setenv("OMP_NUM_THREADS", number)
    monkeypatch.setattr("duhamel.preprocess.elements.assembly_map.BLOCKS_PER_PIECE", 50)
    for found, whole in zip(matrices(mesh, WOOD), expected, strict=True):
        assert (found != whole).nnz == 0
        assert found.nnz == whole.nnz
        assert found.has_canonical_format


def test_matrices_are_the_sums_of_those_of_elements(kind):
    """Nodes that no element has are left with empty rows."""
    mesh = curved(kind)
    cells = mesh.cells[kind]
    points = np.vstack([mesh.points[:2], mesh.points])
    moved = Mesh("moved", points, {kind: cells + 2}, {}, (kind,))
    sums = [np.zeros((3 * len(points),) * 2) for _ in range(2)]
    for nodes in cells + 2:
        alone = Mesh("alone", points[nodes], {kind: np.arange(len(nodes))[None]}, {}, (kind,))
        dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
        for total, one in zip(sums, matrices(alone, STEEL), strict=True):
            total[np.ix_(dofs, dofs)] += one.toarray()
    for found, total in zip(matrices(moved, STEEL), sums, strict=True):
        np.testing.assert_allclose(found.toarray(), total, rtol=0, atol=1e-14 * abs(total).max())
        assert np.diff(found.indptr)[:6].tolist() == [0] * 6
