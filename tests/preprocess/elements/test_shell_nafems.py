"""Shells in the linear and free vibration benchmarks of NAFEMS.

Targets: The Standard NAFEMS Benchmarks (1990), and J. Abbassian et al., Free Vibration Benchmarks
(1987).
"""

from itertools import pairwise

import numpy as np
import pytest
from duhamel.preprocess.body.loads import LoadPattern
from duhamel.preprocess.body.sensors import SensorPoint

from ..shell_cases import KINDS, Grid, Sheet, cells_of_grid

STEEL = {"E": 210e9, "nu": 0.3, "rho": 7800.0}
VIBRATING = {"E": 200e9, "nu": 0.3, "rho": 8000.0}


def stress(sheet, u, point):
    """Stresses xx, yy, zz, yz, xz, xy [Pa] at a point of a face."""
    rows, _ = sheet.source.readings(SensorPoint(point=tuple(point), stress=True))
    return rows @ u.ravel()


def tensor(values):
    xx, yy, zz, yz, xz, xy = values
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def elliptic_membrane(n, kind):
    """LE1: the stress yy at D (2, 0) under a pull of 10 MPa on the outer edge [Pa]."""
    t = 0.1

    def place(r, s):
        angle = 0.5 * np.pi * s
        a, b = 2.0 + 1.25 * r, 1.0 + 1.75 * r
        return a * np.cos(angle), b * np.sin(angle), 0.0

    plate = Grid(place, (n, 2 * n), kind, thickness=t, **STEEL)
    f = np.zeros((len(plate.points), 6))
    edge = plate.at(r=1.0)
    for a, b in pairwise(edge):
        along = plate.points[b] - plate.points[a]
        f[[a, b], :2] += 0.5 * 10e6 * t * np.array([along[1], -along[0]])
    held = [
        plate.dofs(plate.at(s=0.0), 1),
        plate.dofs(plate.at(s=1.0), 0),
        plate.dofs(np.arange(len(plate.points)), 2, 3, 4),
    ]
    u = plate.solve(np.unique(np.concatenate(held)), f.ravel())
    return stress(plate, u, [2.0, 0.0, 0.5 * t])[1]


@pytest.mark.parametrize(
    ("kind", "coarse", "fine"), [("quad", 0.04, 0.008), ("triangle", 0.55, 0.22)]
)
def test_the_elliptic_membrane_of_le1(kind, coarse, fine):
    found = [elliptic_membrane(n, kind) / 92.7e6 for n in (6, 24)]
    assert abs(found[0] - 1.0) < coarse
    assert abs(found[1] - 1.0) < fine


def patch_of_cylinder(n, kind, case):
    """LE2: the stress around the cylinder in the middle of its outer face: 60 MPa in both."""
    t, skew = 0.01, 0.06

    def place(r, s):
        # Skewed within, as the patch of the benchmark is.
        within = skew * np.sin(np.pi * r) * np.sin(np.pi * s)
        angle, z = np.radians(30.0) * (r + within), 0.5 * (s - within)
        return np.cos(angle), np.sin(angle), z

    patch = Grid(place, (n, n), kind, thickness=t, **STEEL)
    sides = np.concatenate([patch.at(s=0.0), patch.at(s=1.0)])
    held = np.concatenate([patch.dofs(patch.at(r=0.0)), patch.dofs(sides, 2, 3, 4)])
    edge = patch.at(r=1.0)
    weights = np.full(len(edge), 1.0)
    weights[[0, -1]] = 0.5
    weights *= 0.5 / weights.sum()
    if case == "moment":
        f = patch.load({5: -1e3}, edge, weights)
    else:
        along = {0: -np.sin(np.radians(30.0)), 1: np.cos(np.radians(30.0))}
        f = patch.load({way: 60e6 * t * part for way, part in along.items()}, edge, weights)
        box = {"corners": ((-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))}
        outward = patch.source.forces(LoadPattern(pressure=0.6e6, box=box))
        middle = outward.reshape(-1, 6)[:, :3].sum(axis=0)
        f += outward * np.sign(middle[0])
    u = patch.solve(np.unique(held), f)
    angle = np.radians(15.0)
    point = np.array([np.cos(angle), np.sin(angle), 0.25])
    node = patch.points[np.linalg.norm(patch.points - point, axis=1).argmin()]
    # A little within the face, which is flat between the nodes.
    outer = node + 0.498 * t * np.array([node[0], node[1], 0.0]) / np.hypot(node[0], node[1])
    around = np.array([-node[1], node[0], 0.0]) / np.hypot(node[0], node[1])
    return around @ tensor(stress(patch, u, outer)) @ around


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("case", ["moment", "pressure"])
def test_the_patch_of_a_cylinder_of_le2(kind, case):
    assert abs(patch_of_cylinder(8, kind, case)) / 60e6 == pytest.approx(1.0, abs=0.005)


def hemisphere(n, kind):
    """LE3: the displacement of A [m], an eighth of a sphere in three patches."""
    radius = 10.0
    corners = np.eye(3)
    middles = {(i, j): corners[i] + corners[j] for i in range(3) for j in range(3)}
    parts = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        r, s = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
        r, s = r.ravel()[:, None], s.ravel()[:, None]
        flat = (1 - r) * (1 - s) * corners[i] + r * (1 - s) * 0.5 * middles[i, j]
        flat = flat + r * s * corners.sum(axis=0) / 3.0 + (1 - r) * s * 0.5 * middles[i, k]
        parts.append(radius * flat / np.linalg.norm(flat, axis=1, keepdims=True))
    points = np.concatenate(parts)
    _, first, number = np.unique(
        np.round(points, 8), axis=0, return_index=True, return_inverse=True
    )
    grids = number.reshape(3, n + 1, n + 1)
    cells = np.concatenate([cells_of_grid(numbers, kind) for numbers in grids])
    shell = Sheet(points[first], kind, cells, thickness=0.04, E=68.25e9, nu=0.3)
    X = shell.points
    a, c, e = (int(np.linalg.norm(X - radius * corners[i], axis=1).argmin()) for i in range(3))
    held = [
        shell.dofs(np.flatnonzero(np.abs(X[:, 1]) < 1e-9), 1, 3, 5),
        shell.dofs(np.flatnonzero(np.abs(X[:, 0]) < 1e-9), 0, 4, 5),
        shell.dofs([e], 2),
    ]
    f = np.zeros((len(X), 6))
    f[a, 0], f[c, 1] = 2e3, -2e3
    return shell.solve(np.unique(np.concatenate(held)), f.ravel())[a, 0]


@pytest.mark.parametrize("kind", KINDS)
def test_the_hemisphere_of_le3(kind):
    assert hemisphere(12, kind) / 0.185 == pytest.approx(1.0, abs=0.01)


def skew_plate(n, kind):
    """LE6: the largest stress in the middle of the lower face [Pa] under 0.7 kPa."""
    c, s30 = np.cos(np.radians(30.0)), np.sin(np.radians(30.0))
    plate = Grid(lambda r, s: (r + s * c, s * s30, 0.0), (n, n), kind, thickness=0.01, **STEEL)
    edges = np.unique(np.concatenate([plate.at(r=0), plate.at(r=1), plate.at(s=0), plate.at(s=1)]))
    whole = {"corners": ((-1.0, -1.0, -1.0), (3.0, 3.0, 3.0))}
    f = plate.source.forces(LoadPattern(pressure=700.0, box=whole))
    corner, other = plate.at(r=0, s=0), plate.at(r=1, s=0)
    held = [plate.dofs(edges, 2), plate.dofs(corner, 0, 1), plate.dofs(other, 1)]
    u = plate.solve(np.unique(np.concatenate(held)), f)
    found = stress(plate, u, [0.5 + 0.5 * c, 0.5 * s30, -0.005])
    return np.linalg.eigvalsh(tensor(found))[-1]


@pytest.mark.parametrize(("kind", "within"), [("quad", 0.02), ("triangle", 0.065)])
def test_the_skew_plate_of_le6(kind, within):
    assert skew_plate(24, kind) / 0.802e6 == pytest.approx(1.0, abs=within)


def tapered_membrane(n, kind):
    """FV32: frequencies in its plane [Hz]."""
    membrane = Grid(
        lambda r, s: (10.0 * r, (5.0 - 4.0 * r) * (s - 0.5), 0.0),
        (2 * n, n),
        kind,
        thickness=0.05,
        **VIBRATING,
    )
    everywhere = np.arange(len(membrane.points))
    held = [membrane.dofs(everywhere, 2, 3, 4), membrane.dofs(membrane.at(r=0.0), 0, 1)]
    return membrane.frequencies(np.unique(np.concatenate(held)), 6)


FV32 = np.array([44.623, 130.03, 162.70, 246.05, 379.90, 391.44])


@pytest.mark.parametrize(("kind", "within"), [("quad", 5e-4), ("triangle", 0.015)])
def test_the_tapered_membrane_of_fv32(kind, within):
    coarse, fine = (tapered_membrane(n, kind) / FV32 for n in (8, 16))
    np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, 1.0, atol=within)


def rhombic_plate(n, kind, thickness):
    """FV15 (thin) and FV22 (thick): frequencies across its plane [Hz], clamped at all edges."""
    c = np.sqrt(0.5)
    plate = Grid(
        lambda r, s: (10.0 * (r + s * c), 10.0 * s * c, 0.0),
        (n, n),
        kind,
        thickness=thickness,
        **VIBRATING,
    )
    edges = np.concatenate([plate.at(r=0), plate.at(r=1), plate.at(s=0), plate.at(s=1)])
    held = [plate.dofs(np.arange(len(plate.points)), 0, 1, 5), plate.dofs(np.unique(edges))]
    return plate.frequencies(np.unique(np.concatenate(held)), 6)


FV15 = np.array([7.938, 12.835, 17.941, 19.133, 24.009, 27.922])
FV22 = np.array([133.95, 201.41, 265.81, 282.74, 334.45])


@pytest.mark.parametrize(("kind", "within"), [("quad", 0.035), ("triangle", 0.1)])
@pytest.mark.parametrize(("thickness", "target"), [(0.05, FV15), (1.0, FV22)])
def test_the_rhombic_plates_of_fv15_and_fv22(kind, within, thickness, target):
    coarse, fine = (
        np.abs(rhombic_plate(n, kind, thickness)[: len(target)] / target - 1.0) for n in (12, 24)
    )
    assert fine.max() < within
    assert (fine < 0.45 * coarse).all()
