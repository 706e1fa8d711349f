"""Elements that bend and that nearly keep their volume: patches, single elements, closed forms."""

import numpy as np
import pytest
import scipy.sparse.linalg as sla
from duhamel.preprocess import read_body
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements.bending import bending_excess
from duhamel.preprocess.elements.solid import solid_matrices
from duhamel.preprocess.elements.solid_force import pressure_forces, traction_forces
from duhamel.preprocess.elements.solid_second import SolidTensors
from duhamel.preprocess.errors import PreprocessError
from duhamel.preprocess.mesh.facets import facets_of
from duhamel.preprocess.mesh.mesh import Mesh

from ..blocks import solid_cells

STEEL = Material(E=1.0, nu=0.3, rho=1.0)  # but for units
RICH = ["hexahedron", "wedge", "tetra10", "hexahedron20", "hexahedron27"]
"""Types that are for nearly incompressible materials too."""
CORNERS = {"hexahedron": 8, "wedge": 6, "tetra10": 4, "hexahedron20": 8, "hexahedron27": 8}


def grid(kind, divisions, place=lambda x: x):
    """A unit cube whose points x (n, 3) go to `place`."""
    points, cells = solid_cells(kind, divisions)
    return Mesh("grid", place(points / (2.0 * np.array(divisions))), {kind: cells}, {}, (kind,))


def stiffness(mesh, nu, E=1.0):
    owners = np.zeros(mesh.n_elements, dtype=np.int64)
    return solid_matrices(mesh, [Material(E=E, nu=nu, rho=1.0)], owners)[0].tocsc()


def distorted(x):
    """A map that moves every inner point and leaves no face of an inner element plane."""
    a, b, c = np.pi * x.T
    bubble = np.sin(a) * np.sin(b) * np.sin(c)
    shift = np.stack([np.cos(3 * b + c), np.cos(2 * c + a), np.cos(3 * a - b)], axis=1)
    return x + 0.12 * bubble[:, None] * shift


def facets_at(mesh, on):
    """The facets all of whose nodes are where `on` (n,) says so."""
    facets = facets_of(mesh)
    found = [
        facets.first[kind] + np.flatnonzero(on[nodes].all(axis=1))
        for kind, nodes in facets.nodes.items()
    ]
    return facets.patch(np.concatenate(found))


def solve(K, f, fixed):
    u = np.zeros(len(f))
    u[~fixed] = sla.spsolve(K[~fixed][:, ~fixed], f[~fixed])
    return u.reshape(-1, 3)


@pytest.mark.parametrize("nu", [0.3, 0.4999])
@pytest.mark.parametrize("kind", RICH)
def test_patch_of_distorted_elements(kind, nu):
    """A linear displacement leaves inner nodes without force, whatever the shape of the elements;
    of quadratic ones the middle nodes move too.
    """
    mesh = grid(kind, (3, 3, 3), distorted)
    u = (mesh.points @ np.random.default_rng(0).normal(size=(3, 3)).T).ravel()
    force = (stiffness(mesh, nu) @ u).reshape(-1, 3)
    inside = ((mesh.points > 1e-9) & (mesh.points < 1 - 1e-9)).all(axis=1)
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(force).max()


@pytest.mark.parametrize("nu", [0.3, 0.49, 0.4999])
@pytest.mark.parametrize("kind", RICH)
def test_one_element_has_six_motions_without_energy(kind, nu):
    """And no seventh that nearly has none, as hourglasses would: the next one keeps a quarter and
    more of what it has at nu = 0.
    """
    skew = np.array([[1.0, 0.2, 0.0], [0.1, 1.2, 0.3], [-0.1, 0.0, 0.8]])
    mesh = grid(kind, (1, 1, 1), lambda x: x @ skew)
    nodes = mesh.cells[kind][0]
    X = mesh.points[nodes]
    if CORNERS[kind] == len(nodes):
        X = X + np.random.default_rng(2).uniform(-0.12, 0.12, X.shape)
    one = Mesh("one", X, {kind: np.arange(len(nodes))[None]}, {}, (kind,))
    values = np.linalg.eigvalsh(stiffness(one, nu).toarray())
    assert np.abs(values[:6]).max() < 1e-13 * values[-1]
    assert values[6] > 0.25 * np.linalg.eigvalsh(stiffness(one, 0.0).toarray())[6]


@pytest.mark.parametrize("shape", [(2, 2, 2), (1, 1, 1)])
@pytest.mark.parametrize("along", [0, 1, 2])
def test_hexahedra_hold_pure_bending(shape, along):
    """Blocks as long as ten times their depth: the energy of the exact motion is the exact one."""
    size = np.roll([10.0, 1.0, 1.0], along)
    mesh = grid("hexahedron", shape, lambda x: x * size)
    excess = bending_excess(mesh, [STEEL], np.zeros(mesh.n_elements, dtype=np.int64))
    assert excess == pytest.approx(1.0, abs=1e-12)


def timoshenko(L, b, h, nu, E=1.0):
    """Sag of a cantilever by a unit force at its end."""
    return L**3 / (3 * E * b * h**3 / 12) + L / (5 / 6 * b * h * E / (2 * (1 + nu)))


def sags(kind, divisions, size, nu):
    """By unit forces along y and along z at the end of a cantilever."""
    mesh = grid(kind, divisions, lambda x: x * size)
    x = mesh.points[:, 0]
    tip, fixed = facets_at(mesh, x > size[0] - 1e-9), np.repeat(x < 1e-9, 3)
    for direction in np.eye(3)[1:]:
        f = traction_forces(mesh.points, tip, direction / (size[1] * size[2])).ravel()
        yield float(f @ solve(stiffness(mesh, nu), f, fixed).ravel())


@pytest.mark.parametrize(
    ("divisions", "size", "within"),
    [
        ((10, 2, 2), (1.0, 0.02, 0.02), 0.03),  # elements ten times as long as thick
        ((50, 2, 2), (1.0, 0.02, 0.02), 0.006),
        ((20, 1, 1), (1.0, 0.05, 0.05), 0.01),  # a single layer
    ],
)
def test_cantilevers_of_hexahedra_sag_as_beams(divisions, size, within):
    for found in sags("hexahedron", divisions, size, 0.3):
        assert found == pytest.approx(timoshenko(*size, 0.3), rel=within)


@pytest.mark.parametrize("divisions", [(10, 1, 1), (20, 2, 2)])
@pytest.mark.parametrize("kind", ["tetra", "wedge"])
def test_the_excess_of_bending_energy_foretells_the_sag(kind, divisions):
    """Of tetrahedra and wedges, which stay too stiff."""
    size = (1.0, 0.1, 0.1)
    mesh = grid(kind, divisions, lambda x: x * size)
    excess = bending_excess(mesh, [STEEL], np.zeros(mesh.n_elements, dtype=np.int64))
    stiffest = min(sags(kind, divisions, size, 0.3)) / timoshenko(*size, 0.3)
    assert excess > 1.5
    assert stiffest == pytest.approx(1.0 / excess, rel=0.2)


@pytest.mark.parametrize("nu", [0.3, 0.49, 0.499, 0.4999])
@pytest.mark.parametrize(
    ("kind", "n"), [("hexahedron", 8), ("hexahedron20", 4), ("hexahedron27", 4), ("tetra10", 4)]
)
def test_a_thick_cylinder_under_pressure(kind, n, nu):
    """Lame's, in plane strain: u_r = (1 + nu) p a^2 / (E (b^2 - a^2)) ((1 - 2 nu) r + b^2 / r)."""
    a, b, E, p = 3.0, 9.0, 1000.0, 1.0

    def place(x):
        r, angle = a * (b / a) ** x[:, 0], 0.5 * np.pi * x[:, 1]
        return np.stack([r * np.cos(angle), r * np.sin(angle), x[:, 2]], axis=1)

    mesh = grid(kind, (n, n, 1), place)
    r = np.hypot(*mesh.points[:, :2].T)
    f = pressure_forces(mesh.points, facets_at(mesh, r < 1.02 * a), p).ravel()
    fixed = np.zeros((len(r), 3), dtype=bool)
    fixed[:, :2] = np.abs(mesh.points[:, :2]) < 1e-9
    fixed[:, 2] = True
    u = solve(stiffness(mesh, nu, E), f, fixed.ravel())
    inner = np.flatnonzero((np.abs(r - a) < 1e-9) & (np.abs(mesh.points[:, 1]) < 1e-9))
    exact = (1 + nu) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * nu) * a + b**2 / a)
    assert u[inner, 0].mean() == pytest.approx(exact, rel=0.015)


@pytest.mark.parametrize("nu", [0.3, 0.4999])
@pytest.mark.parametrize("kind", RICH)
def test_second_order_energy_knows_no_turn(kind, nu):
    """W(u + w x (X + u)) = W(u) for small turns w: D3(w x X; u, v) = -u.K (w x v) - v.K (w x u)."""
    mesh = grid(kind, (2, 1, 1), distorted)
    owners = np.zeros(mesh.n_elements, dtype=np.int64)
    material = Material(E=1.0, nu=nu, rho=1.0)
    K, M = solid_matrices(mesh, [material], owners)
    tensors = SolidTensors("grid", M[::3, ::3], mesh.points, mesh, [material], owners)
    generator = np.random.default_rng(5)
    w, motions = generator.normal(size=3), generator.normal(size=(3 * len(mesh.points), 2))
    turn = np.cross(w, mesh.points).reshape(-1, 1)
    turned = np.cross(w, motions.reshape(-1, 3, 2), axisb=1, axisc=1).reshape(-1, 2)
    work = motions.T @ (K @ turned)
    expected = -(work + work.T)
    found = tensors.third(turn, motions)[0]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("kind", "divisions"),
    [
        ("hexahedron", (10, 4, 4)),
        ("hexahedron20", (5, 2, 2)),
        ("hexahedron27", (5, 2, 2)),
        ("tetra10", (8, 3, 3)),
    ],
)
def test_a_clamped_bar_of_rubber(kind, divisions):
    """nu = 0.4999, all of one end held: 0.948 of Timoshenko's sag, by 12 x 5 x 5 elements of 27
    nodes. Plain elements of 20 nodes reach 0.817.
    """
    size = (0.4, 0.1, 0.1)
    for found in sags(kind, divisions, size, 0.4999):
        assert found / timoshenko(*size, 0.4999) == pytest.approx(0.948, rel=0.06)


def test_a_spinning_blade_of_hexahedra_stiffens_as_a_beam():
    """Southwell's coefficient of the first flapwise mode of a uniform blade, 1.193: omega^2 grows
    by it times the square of the spin.
    """
    mesh = grid("hexahedron", (40, 2, 2), lambda x: x * [1.0, 0.02, 0.01])
    owners = np.zeros(mesh.n_elements, dtype=np.int64)
    K, M = (matrix.tocsc() for matrix in solid_matrices(mesh, [STEEL], owners))
    free = np.repeat(mesh.points[:, 0] > 1e-9, 3)
    mode, stretch = np.zeros((len(free), 1)), np.zeros((len(free), 1))
    start = np.ones(free.sum())
    K_free, M_free = K[free][:, free], M[free][:, free]
    mode[free] = sla.eigsh(K_free, 1, M_free, sigma=0, v0=start)[1]
    load = M @ (mesh.points * [1.0, 0.0, 0.0]).ravel()
    stretch[free, 0] = sla.spsolve(K_free, load[free])
    tensors = SolidTensors("blade", M[::3, ::3], mesh.points, mesh, [STEEL], owners)
    assert tensors.third(stretch, mode)[0, 0, 0] == pytest.approx(1.193, rel=0.005)


@pytest.mark.parametrize("nu", [0.49991, 0.499999])
def test_materials_that_keep_their_volume_are_refused(nu, tmp_path):
    path = tmp_path / "body.toml"
    path.write_text(
        f'name = "b"\nmesh = "m.msh"\n[material]\nE = 1e6\nnu = {nu}\nrho = 1e3\n'
        '[interfaces.a]\ngroup = "a"\n[impulse]\nstep = 1e-5\nsteps = 10\n'
    )
    with pytest.raises(
        PreprocessError, match=rf"material.*nu: expected at most 0.4999, found {nu}"
    ):
        read_body(path)
    assert Material(E=1e6, nu=0.4999, rho=1e3).nearly_incompressible
