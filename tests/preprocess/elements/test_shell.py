"""Shells: rigid motions, patch tests, inertia, and published problems."""

import numpy as np
import pytest
from duhamel.preprocess.body.material import Material
from duhamel.preprocess.elements.laminate import Laminate, Layer
from duhamel.preprocess.elements.shell_matrices import nodal_strains
from duhamel.preprocess.mesh.nodes import Nodes

from ..shell_cases import KINDS, Grid

STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}


def warped(r, s):
    """A grid whose quadrangles are neither flat nor rectangles."""
    bumps = 0.05 * np.sin([7.0 * r + 3.0 * s, 5.0 * r - 8.0 * s, 4.0 * r + 9.0 * s])
    return np.array([1.2 * r, s, 0.3 * r * s]) + bumps


def skewed(r, s):
    """A flat rectangle, whose inner nodes are moved."""
    inner = r * (1.0 - r) * s * (1.0 - s)
    return np.array([2.4 * r + 1.9 * inner * np.sin(9 * s), 1.2 * s - inner * np.cos(7 * r), 0.0])


def rigid_modes(grid):
    points = grid.points
    return Nodes(points, np.ones(len(points), dtype=bool)).rigid_motion(np.zeros(3))


@pytest.mark.parametrize("offset", [0.0, 0.03])
@pytest.mark.parametrize("kind", KINDS)
def test_six_rigid_motions_of_warped_shells_are_free_of_strain_and_no_others(kind, offset):
    grid = Grid(warped, (3, 2), kind, thickness=0.02, offset=offset, **STEEL)
    A = rigid_modes(grid)
    np.testing.assert_allclose(grid.K @ A, 0.0, atol=1e-13 * abs(grid.K).max() * abs(A).max())
    values = np.linalg.eigvalsh(grid.K.toarray())
    assert values[5] < 1e-13 * values[-1] < 1e-8 * values[-1] < values[6]
    assert np.linalg.eigvalsh(grid.M.toarray())[0] > 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_mass_properties_are_those_of_a_plate_as_thick_as_it_is(kind):
    a, b, t, z, rho = 1.2, 0.7, 0.1, 0.04, 7850.0
    place = lambda r, s: (a * r, b * s, 0.0)  # noqa: E731
    grid = Grid(place, (3, 2), kind, thickness=t, offset=z, **STEEL)
    A = rigid_modes(grid)
    moments = A.T @ grid.M @ A
    mass = rho * a * b * t
    height = z**2 + t**2 / 12.0
    J = mass * np.array([b**2 / 3 + height, a**2 / 3 + height, (a**2 + b**2) / 3])
    np.testing.assert_allclose(np.diag(moments), [mass, mass, mass, *J], rtol=1e-12)
    np.testing.assert_allclose(moments[0, 4], mass * z, rtol=1e-12)


FIELDS = {
    # Displacements and rotations (6,) at x, y of uniform strains and curvatures.
    "stretch": lambda x, y: [1e-3 * (x + y / 2), 1e-3 * (y + x / 2), 0, 0, 0, 0],
    "bending": lambda x, y: [0, 0, 0.5e-3 * (x * x + x * y + y * y), *turns(x, y), 0],
}


def turns(x, y):
    """The rotations w_,y and -w_,x of the normal."""
    return 0.5e-3 * (x + 2 * y), -0.5e-3 * (2 * x + y)


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("kind", KINDS)
def test_distorted_shells_pass_the_patch_test(kind, name):
    t = 0.01
    grid = Grid(skewed, (4, 3), kind, thickness=t, **STEEL)
    exact = np.array([FIELDS[name](x, y) for x, y, _ in grid.points])
    edge = np.flatnonzero(np.isin(grid.r, (0, 1)) | np.isin(grid.s, (0, 1)))
    held = grid.dofs(edge)
    u = grid.solve(held, np.zeros(exact.size), exact.ravel()[held])
    np.testing.assert_allclose(u, exact, atol=1e-9 * np.abs(exact).max())
    laminate = grid.source.laminates.values[0]
    shells = grid.source.shells[kind]
    strains, at = nodal_strains(shells, laminate, shells.shape.corners)
    cells = grid.source.mesh.cells[kind]
    found = np.einsum("nqic,nc->nqi", strains, exact[cells].reshape(len(cells), -1))
    row = [1e-3, 1e-3, 1e-3] if name == "stretch" else [-1e-3, -1e-3, -1e-3]
    tensor = np.array([[row[0], row[2] / 2], [row[2] / 2, row[1]]])
    axes = at.axes[..., :2, :2]
    local = axes @ tensor @ np.swapaxes(axes, 2, 3)
    first = 0 if name == "stretch" else 3
    np.testing.assert_allclose(found[..., first], local[..., 0, 0], rtol=1e-8)
    np.testing.assert_allclose(found[..., first + 1], local[..., 1, 1], rtol=1e-8)
    np.testing.assert_allclose(found[..., first + 2], 2 * local[..., 0, 1], atol=1e-11)


def test_uniform_shear_has_its_exact_energy_on_distorted_quadrangles():
    grid = Grid(skewed, (4, 3), thickness=0.1, **STEEL)
    u = np.zeros((len(grid.points), 6))
    u[:, 2] = 1e-3 * grid.points[:, 0]
    G, area = 210e9 / 2.6, 2.4 * 1.2
    assert u.ravel() @ (grid.K @ u.ravel()) == pytest.approx(5 / 6 * G * 0.1 * area * 1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_beam_on_an_offset_bends_as_far_as_its_middle_does(kind):
    """About its middle, which the nodes are beside: the offset is no stiffness."""
    t, z = 0.1, 0.07
    place = lambda r, s: (10.0 * r, 0.5 * s, 0.0)  # noqa: E731
    grid = Grid(place, (10, 1), kind, thickness=t, offset=z, E=1e9, nu=0.0)
    tip = grid.at(r=1)
    u = grid.solve(grid.dofs(grid.at(r=0)), grid.load({4: 1.0}, tip))
    curvature = 12.0 / (1e9 * 0.5 * t**3)
    np.testing.assert_allclose(u[tip, 4], 10.0 * curvature, rtol=1e-6)
    # The nodes are under the neutral surface, and so shorten or stretch.
    np.testing.assert_allclose(u[tip, 0], -z * 10.0 * curvature, rtol=1e-6)


# Published problems: R. H. MacNeal, R. L. Harder, Finite Elements in Analysis and Design 1 (1985).

SHAPES = {
    "rectangles": ([0, 1, 2, 3, 4, 5, 6], [0, 1, 2, 3, 4, 5, 6]),
    "trapezoids": ([0, 1.1, 1.9, 3.1, 3.9, 5.1, 6], [0, 0.9, 2.1, 2.9, 4.1, 4.9, 6]),
    "parallelograms": ([0, 0.9, 1.9, 2.9, 3.9, 4.9, 6], [0, 1.1, 2.1, 3.1, 4.1, 5.1, 6]),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_straight_cantilever_of_six_quadrangles(shape):
    sides = SHAPES[shape]
    place = lambda r, s: (sides[round(s)][round(6 * r)], 0.2 * s, 0.0)  # noqa: E731
    grid = Grid(place, (6, 1), thickness=0.1, E=1e7, nu=0.3)
    held, tip = grid.dofs(grid.at(r=0)), grid.at(r=1)
    published = {0: 3e-5, 1: 0.1081, 2: 0.4321}
    found = {
        which: grid.solve(held, grid.load({which: 1.0}, tip))[tip, which].mean() / deflection
        for which, deflection in published.items()
    }
    assert found[0] == pytest.approx(1.0, abs=0.01)
    assert found[2] == pytest.approx(1.0, abs=0.04)
    # Trapezoids of four nodes lock in the plane: MacNeal's theorem. QM6 of rectangles does not.
    if shape == "rectangles":
        assert found[1] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(("kind", "n"), [("quad", (12, 2)), ("triangle", (48, 8))])
@pytest.mark.parametrize(
    ("t", "force", "published"),
    [(0.32, 1.0, (5.424e-3, 1.754e-3)), (0.0032, 1e-6, (5.256e-3, 1.294e-3))],
)
def test_a_twisted_beam_of_warped_shells(kind, n, t, force, published):
    """The thin one: T. Belytschko, B. L. Wong, H. Stolarski, Int. J. Num. Meth. Eng. 28 (1989)."""

    def place(r, s):
        angle, y = 0.5 * np.pi * r, 1.1 * (s - 0.5)
        return 12.0 * r, y * np.cos(angle), y * np.sin(angle)

    grid = Grid(place, n, kind, thickness=t, E=29e6, nu=0.22)
    held, tip, middle = grid.dofs(grid.at(r=0)), grid.at(r=1), grid.at(r=1, s=0.5)
    weights = np.where(np.isin(grid.s[tip], (0, 1)), 0.5, 1.0) / n[1]
    for which, deflection in zip((2, 1), published, strict=True):
        u = grid.solve(held, grid.load({which: force}, tip, weights))
        assert u[middle[0], which] == pytest.approx(deflection, rel=0.04)


def scordelis_lo(n, kind):
    """The middle of the free edge of the roof under its weight, over the published 0.3024."""
    angle = np.radians(40.0)
    place = lambda r, s: (25 * np.sin(angle * s), 25 * r, 25 * np.cos(angle * s))  # noqa: E731
    grid = Grid(place, (n, n), kind, thickness=0.25, E=4.32e8, nu=0.0, rho=90.0 / 0.25)
    held = [
        grid.dofs(grid.at(r=0), 0, 2),
        grid.dofs(grid.at(r=1), 1, 3, 5),
        grid.dofs(grid.at(s=0), 0, 4, 5),
    ]
    weight = grid.M @ np.tile([0, 0, -1.0, 0, 0, 0], len(grid.points))
    u = grid.solve(np.unique(np.concatenate(held)), weight)
    return -u[grid.at(r=1, s=1)[0], 2] / 0.3024


def test_the_roof_of_scordelis_and_lo_converges():
    coarse, fine = scordelis_lo(4, "quad"), scordelis_lo(8, "quad")
    assert coarse == pytest.approx(1.0, abs=0.05)
    assert fine == pytest.approx(1.0, abs=0.01)
    triangles = [abs(scordelis_lo(n, "triangle") - 1.0) for n in (8, 16)]
    assert triangles[1] < 0.05
    assert triangles[1] < 0.4 * triangles[0]


@pytest.mark.parametrize("kind", KINDS)
def test_a_pinched_hemisphere_with_a_hole_bends_without_stretch(kind):
    def place(r, s):
        around, up = 0.5 * np.pi * r, np.radians(72.0) * s
        return 10 * np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])

    grid = Grid(place, (8, 8), kind, thickness=0.04, E=6.825e7, nu=0.3)
    one, other = grid.at(r=0, s=0), grid.at(r=1, s=0)
    held = [grid.dofs(grid.at(r=0), 1, 3, 5), grid.dofs(grid.at(r=1), 0, 4, 5), grid.dofs(one, 2)]
    f = grid.load({0: 1.0}, one) + grid.load({1: -1.0}, other)
    u = grid.solve(np.unique(np.concatenate(held)), f)
    assert u[one[0], 0] == pytest.approx(0.0940, rel=0.02)
    assert u[other[0], 1] == pytest.approx(-0.0940, rel=0.02)


def plate_frequencies(kind, n, count, held):
    """Of a square of 10 m, NAFEMS' plate: 0.05 m thick, with held (grid -> dofs)."""
    place = lambda r, s: (10.0 * r, 10.0 * s, 0.0)  # noqa: E731
    steel = {"E": 200e9, "nu": 0.3, "rho": 8000.0}
    grid = Grid(place, (n, n), kind, thickness=0.05, **steel)
    return grid.frequencies(held(grid), count)


def clamped(grid):
    """Every edge."""
    return grid.dofs(np.flatnonzero(np.isin(grid.r, (0, 1)) | np.isin(grid.s, (0, 1))))


def cantilevered(grid):
    """One edge."""
    return grid.dofs(grid.at(r=0))


def flat(grid):
    """Nothing but motions in the plane."""
    return grid.dofs(np.arange(len(grid.points)), 0, 1, 5)


D_OF_PLATE = 200e9 * 0.05**3 / 12 / (1 - 0.3**2)
LEISSA = np.array([35.99, 73.41, 73.41, 108.27, 131.64, 132.25])
"""A. W. Leissa, Vibration of Plates, NASA SP-160 (1969): omega a^2 sqrt(rho t / D), clamped"""
PLATES = {
    # The Standard NAFEMS Benchmarks (1990): FV16, and FV12 after its three rigid motions.
    "clamped": (clamped, 0, LEISSA * np.sqrt(D_OF_PLATE / 400.0) / (2 * np.pi * 100.0)),
    "FV16": (cantilevered, 0, np.array([0.421, 1.029, 2.582, 3.306, 3.753, 6.555])),
    "FV12": (flat, 3, np.array([1.622, 2.360, 2.922, 4.233, 4.233, 7.416])),
}


@pytest.mark.parametrize("plate", PLATES)
@pytest.mark.parametrize("kind", KINDS)
def test_frequencies_of_square_plates_converge_to_published_ones(kind, plate):
    """With the square of the size of elements, so that two meshes foretell a third one."""
    held, first, published = PLATES[plate]
    coarse, fine = (plate_frequencies(kind, n, first + 6, held)[first:] for n in (12, 24))
    np.testing.assert_allclose(fine, published, rtol=0.035)
    np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, published, rtol=0.0151)


def z_section(kind, n):
    """NAFEMS LE5: the axial stress [MPa] in the middle of a flange, 2.5 m from the clamped end.

    A cantilever of 10 m of two flanges of 1 m and a web of 2 m, 0.1 m thick, which is twisted.
    """
    corners = np.array([[-1.0, 1.0], [0.0, 1.0], [0.0, -1.0], [1.0, -1.0]])

    def place(r, s):
        y = [np.interp(4.0 * s, [0, 1, 3, 4], corner) for corner in corners.T]
        return 10.0 * r, *y

    grid = Grid(place, (8 * n, 4 * n), kind, thickness=0.1, E=210e9, nu=0.3)
    tip = grid.at(r=1)
    y, z = grid.points[tip, 1:].T
    f = 0.0
    for flange, force in ((z > 1.0 - 1e-9, -0.6e6), (z < -1.0 + 1e-9, 0.6e6)):
        nodes, at = tip[flange], np.abs(y[flange])
        weights = np.where((at < 1e-9) | (at > 1 - 1e-9), 0.5, 1.0) / n
        f = f + grid.load({1: force}, nodes, weights)
    u = grid.solve(grid.dofs(grid.at(r=0)), f).ravel()
    A = np.flatnonzero(np.linalg.norm(grid.points - [2.5, -1.0, 1.0], axis=1) < 1e-9)[0]
    points = grid.source.field_points(stress=True)
    stress = points.by_displacements @ u.reshape(-1, 6)[:, :3].ravel()
    stress += points.by_rotations @ u.reshape(-1, 6)[:, 3:].ravel()
    return stress.reshape(-1, 6)[points.nodes == A, 0].mean() / 1e6


def test_the_twisted_z_section_has_the_axial_stress_of_nafems_le5():
    """Abaqus' S4 has -110.36 MPa on both meshes, as its guide of benchmarks says."""
    assert z_section("quad", 1) == pytest.approx(-108.0, rel=0.03)
    assert z_section("quad", 2) == pytest.approx(-108.0, rel=0.03)


CARBON = {
    "E": [140e9, 9e9, 9e9],
    "nu": [0.3, 0.3, 0.4],
    "G": [5e9, 5e9, 3.2e9],
    "rho": 1600.0,
}


def laminate(plies, materials):
    """Plies as (material, thickness, angle in degrees), about the middle of all."""
    total, z, layers = sum(t for _, t, _ in plies), 0.0, []
    for name, t, angle in plies:
        heights = (z - 0.5 * total, z + t - 0.5 * total)
        layers.append(Layer(Material(**materials[name]), heights, np.radians(angle)))
        z += t
    return Laminate(layers)


def test_plies_of_one_material_are_the_plate_that_they_make():
    whole = laminate([("steel", 0.01, 0.0)], {"steel": STEEL}).stiffness
    plies = [("steel", t, angle) for t, angle in ((0.002, 0.0), (0.003, 30.0), (0.005, -70.0))]
    np.testing.assert_allclose(laminate(plies, {"steel": STEEL}).stiffness, whole, atol=1e-7)
    D, G = 210e9 * 0.01**3 / 12 / 0.91, 210e9 / 2.6
    np.testing.assert_allclose(np.diag(whole)[[3, 5, 6, 7]], [D, 0.35 * D, *(G / 120.0,) * 2])


def test_cross_plies_have_the_stiffness_of_classical_lamination_theory():
    """J. N. Reddy, Mechanics of Laminated Composite Plates and Shells (2003), 3.5."""
    t = 1e-3
    stiff, soft = 140e9 / (1 - 0.09 * 9 / 140), 9e9 / (1 - 0.09 * 9 / 140)
    C = laminate([("c", t, 0.0), ("c", t, 90.0)], {"c": CARBON}).stiffness
    assert C[0, 0] == pytest.approx(t * (stiff + soft))
    assert C[0, 3] == pytest.approx(-0.5 * t**2 * (stiff - soft))
    assert C[3, 3] == pytest.approx(t**3 / 3 * (stiff + soft))
    balanced = laminate([("c", t, a) for a in (45.0, -45.0, -45.0, 45.0)], {"c": CARBON}).stiffness
    np.testing.assert_allclose(balanced[:3, 3:6], 0.0, atol=1e-6 * t * balanced[0, 0])
    assert abs(balanced[0, 2]) < 1e-9 * balanced[0, 0]
    # Fibers along the diagonal couple bending and twist, more of the outer plies.
    assert balanced[3, 5] > 0.1 * balanced[3, 3]


LIGHT = STEEL | {"rho": 1000.0}


@pytest.mark.parametrize(
    ("plies", "sided"),
    [
        ([("c", 1.0), ("c", 91.0), ("c", 1.0)], True),
        ([("c", 0.0), ("c", 90.0), ("c", 0.0)], False),
        ([("c", 45.0), ("c", -45.0), ("c", -45.0), ("c", 45.0)], True),
        ([("s", 30.0)], False),
        ([("s", 0.0), ("light", 0.0)], True),
    ],
)
def test_laminates_that_turn_with_their_normal(plies, sided):
    """Plies at an angle, also symmetric ones, and a mass beside the middle."""
    materials = {"c": CARBON, "s": STEEL, "light": LIGHT}
    assert laminate([(name, 1e-3, a) for name, a in plies], materials).sided == sided


def test_waves_of_bending_are_those_about_the_neutral_axis():
    """Wherever the nodes are: of steel and of two plies that stretch as they bend."""
    for plies in ([("s", 0.004)], [("s", 0.001), ("c", 0.003)]):
        waves = []
        for z in (-0.01, 0.0, 0.02):
            layers = []
            for name, thickness in plies:
                material = Material(**{"s": STEEL, "c": CARBON}[name])
                layers.append(Layer(material, (z, z + thickness)))
                z += thickness
            waves.append(Laminate(layers).shortest_wave(1e3))
        np.testing.assert_allclose(waves, waves[0], rtol=1e-9)
    D = 210e9 * 0.004**3 / 12 / 0.91
    exact = 2 * np.pi * (D / (7850.0 * 0.004 * (2e3 * np.pi) ** 2)) ** 0.25
    found = laminate([("s", 0.004, 0.0)], {"s": STEEL}).shortest_wave(1e3)
    assert found == pytest.approx(exact)


def test_a_sandwich_gives_way_in_its_core():
    """Thin faces: G (h + t)^2 / h. Five sixths of the mean modulus would be stiffer by hundreds."""
    foam = {"E": 1e7, "nu": 0.3, "rho": 60.0}
    h, t = 0.02, 0.0005
    plies = [("steel", t, 0.0), ("foam", h, 0.0), ("steel", t, 0.0)]
    S = laminate(plies, {"steel": STEEL, "foam": foam}).stiffness[6:, 6:]
    assert S[0, 0] == pytest.approx(1e7 / 2.6 * (h + t) ** 2 / h, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_fibers_askew_shear_a_strip_as_their_compliance_says(kind):
    """Stretched along x, whatever way its elements are turned: strains are A^-1 N."""
    body = {"plies": [{"thickness": 0.002, "angle": 30.0}], "orientation": [1.0, 0.0, 0.0]}
    grid = Grid(skewed, (4, 3), kind, thickness=None, material=CARBON, **body)
    A = laminate([("c", 0.002, 30.0)], {"c": CARBON}).stiffness[:3, :3]
    e = np.linalg.solve(A, [1e5, 0.0, 0.0])
    x, y, o = *grid.points[:, :2].T, np.zeros(len(grid.points))
    exact = np.stack([e[0] * x + e[2] / 2 * y, e[1] * y + e[2] / 2 * x, o, o, o, o], axis=1)
    f = (grid.K @ exact.ravel()).reshape(-1, 6)
    sides = grid.at(r=1)
    assert f[sides, 0].sum() == pytest.approx(1e5 * 1.2)
    np.testing.assert_allclose(f[:, 1], 0.0, atol=1e-6 * 1e5)
    assert abs(e[2]) > 0.5 * abs(e[0])
