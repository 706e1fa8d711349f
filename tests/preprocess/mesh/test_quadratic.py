"""Linear tetrahedra and wedges as quadratic tetrahedra: neighbors fit, and the body bends."""

import duhamel as du
import numpy as np
import pytest
from duhamel import preprocess
from duhamel.preprocess.mesh.facets import facets_of
from duhamel.preprocess.mesh.mesh import Group, Mesh
from duhamel.preprocess.mesh.quadratic import quadratic

E, NU, RHO = 2.1e11, 0.3, 7850.0
CYCLES = ([0, 1, 2, 3, 4, 5], [1, 2, 0, 4, 5, 3], [2, 0, 1, 5, 3, 4])
UPSIDE_DOWN = [3, 5, 4, 0, 2, 1]


def block(counts, sizes, seed=0):
    """Wedges whose triangles lie across y, their nodes in random order, on shuffled points."""
    rng = np.random.default_rng(seed)
    axes = [np.linspace(0.0, size, n + 1) for n, size in zip(counts, sizes, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape([n + 1 for n in counts])
    wedges = []
    for i, j, k in np.ndindex(*counts):
        corner = number[i : i + 2, j : j + 2, k : k + 2]
        low = [corner[0, 0, 0], corner[0, 0, 1], corner[1, 0, 1], corner[1, 0, 0]]
        high = [corner[0, 1, 0], corner[0, 1, 1], corner[1, 1, 1], corner[1, 1, 0]]
        for three in ((0, 1, 2), (0, 2, 3)):
            wedge = [*(low[m] for m in three), *(high[m] for m in three)]
            order = np.array(CYCLES[rng.integers(3)])
            order = order if rng.integers(2) else np.array(UPSIDE_DOWN)[order]
            wedges.append(np.array(wedge)[order])
    shuffled = rng.permutation(len(points))
    moved = np.empty_like(points)
    moved[shuffled] = points
    return moved, shuffled[np.array(wedges)]


def volumes(mesh):
    a, b, c, d = mesh.points[mesh.cells["tetra10"][:, :4]].transpose(1, 0, 2)
    return np.einsum("ni,ni->n", np.cross(b - a, c - a), d - a) / 6.0


@pytest.mark.parametrize("seed", range(5))
def test_the_pieces_of_wedges_fit_each_other_and_fill_the_body(seed):
    points, wedges = block((3, 2, 4), (1.0, 0.3, 0.5), seed)
    mesh = quadratic(preprocess.mesh_of((points, {"wedge": wedges})))
    assert mesh.n_elements == 3 * len(wedges)
    assert (volumes(mesh) > 0.0).all()
    assert volumes(mesh).sum() == pytest.approx(0.15, rel=1e-12)
    facets = facets_of(mesh)  # refuses neighbors that do not share their middle nodes
    (outer,) = facets.patch(np.flatnonzero(facets.boundary)).values()
    a, b, c = mesh.points[outer[:, :3]].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    assert area == pytest.approx(2.0 * (0.3 + 0.5 + 0.15), rel=1e-12)
    middles = mesh.points[mesh.cells["tetra10"][:, 4]]
    ends = mesh.points[mesh.cells["tetra10"][:, :2]]
    np.testing.assert_allclose(middles, ends.mean(axis=1), atol=1e-15)


def test_groups_keep_their_cells_facets_and_points():
    points, wedges = block((2, 1, 1), (1.0, 1.0, 1.0))
    left = np.flatnonzero(points[:, 0] == 0.0)
    face = left[np.argsort(np.arctan2(points[left, 2] - 0.5, points[left, 1] - 0.5))]
    mesh = preprocess.mesh_of((points, {"wedge": wedges, "quad": face[None, :]}))
    groups = {
        "some": Group({"wedge": np.array([1, 3])}, np.array([0])),
        "left": Group({"quad": np.array([0])}, np.zeros(0, dtype=np.int64)),
    }
    mesh = quadratic(Mesh("block", mesh.points, mesh.cells, groups, mesh.body_types))
    some = mesh.group("some")
    np.testing.assert_array_equal(some.cells["tetra10"], [3, 4, 5, 9, 10, 11])
    np.testing.assert_array_equal(some.points, [0])
    assert volumes(mesh)[some.cells["tetra10"]].sum() == pytest.approx(0.5)
    facets = mesh.cells["triangle6"][mesh.group("left").cells["triangle6"]]
    assert len(facets) == 2
    assert (mesh.points[facets][..., 0] == 0.0).all()
    assert (facets_of(mesh).matching("triangle6", facets) >= 0).all()


def tip(kind, order, nu=NU):
    """The deflection of a cantilever over that of Timoshenko's beam."""
    length, width = 1.0, 0.1
    points, wedges = block((10, 2, 2), (length, width, width))
    part = du.Part((points, {kind: wedges}), du.Material(E=E, nu=nu, rho=RHO), order=order)
    part.interface("root", du.plane(x=0.0), kind="rigid")
    part.interface("tip", du.plane(x=length))
    H = preprocess.build(part.body(step=1e-5)).compliance
    load = np.zeros(12)
    load[[2, 8, 4]] = -1.0, 1.0, length
    u = H @ load
    EI, GA = E * width**4 / 12.0, 5.0 / 6.0 * E / (2.0 * (1.0 + nu)) * width**2
    return (u[8] - u[2] + u[4] * length) / (length**3 / (3.0 * EI) + length / GA)


def test_wedges_bend_with_nodes_on_their_edges():
    assert tip("wedge", 1) == pytest.approx(0.35, abs=0.02)
    assert tip("wedge", 2) == pytest.approx(0.983, abs=0.005)
    # the clamped end of an incompressible beam is stiffer than the formula; hexahedra have 0.90
    assert tip("wedge", 2, nu=0.4999) == pytest.approx(0.913, abs=0.005)


def test_other_solids_have_one_order():
    x = np.array(np.meshgrid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], indexing="ij")).reshape(3, -1).T
    cube = [[0, 4, 6, 2, 1, 5, 7, 3]]
    part = du.Part((x, cube), du.Material(E=E, nu=NU, rho=RHO), order=2)
    part.interface("base", du.plane(z=0.0))
    with pytest.raises(preprocess.MeshError, match=r"order = 2 is for linear .*, found hexahedron"):
        part.superelement(step=1e-5)
