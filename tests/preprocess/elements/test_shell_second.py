"""Shells to second order: the energy of finite rotations, their inertia, and loads that stiffen."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess import Body, BodyError, assemble, build
from duhamel.preprocess.assembly.second_order import second_order
from duhamel.preprocess.elements import shell_second
from duhamel.preprocess.elements.shell_matrices import (
    condensation,
    full_stiffness,
    generalized,
    nodal_strains,
)
from duhamel.preprocess.sources.reading import read_mesh_source
from scipy.spatial.transform import Rotation

from ..differences import refined, turning
from ..rotation.steady import Steady, Support
from ..shell_cases import KINDS, Grid

ALUMINUM = {"E": 70e9, "nu": 0.3, "rho": 2700.0}


def warped(r, s):
    bumps = 0.03 * np.sin([7.0 * r + 3.0 * s, 5.0 * r - 8.0 * s, 4.0 * r + 9.0 * s])
    return np.array([0.6 * r, 0.4 * s, 0.2 * r * s]) + bumps


def model(kind, **tables):
    grid = Grid(warped, (2, 2), kind, thickness=0.02, **ALUMINUM)
    given = grid.body.model_dump(exclude_unset=True) | {"mesh": grid.source.mesh}
    body = Body.model_validate(given | tables)
    source, structure = read_mesh_source(body), assemble(body)
    return structure, second_order(structure, source, body), source


@pytest.fixture(params=KINDS)
def shell(request):
    root = {"box": {"corners": [[-1, -1, -1], [0.1, 1, 1]]}, "kind": "rigid"}
    J = {"interface": "root", "mass": 0.5, "inertia": [0.1, 0.2, 0.15]}
    return model(request.param, interfaces={"root": root}, masses={"tool": J})


def elastic(structure, r, seed=0):
    motions = np.random.default_rng(seed).normal(size=(structure.n_u, r))
    return motions - structure.U @ (structure.U.T @ (structure.M @ motions))


def test_a_turned_shell_has_the_energy_it_had(shell):
    structure, second, _ = shell
    w, motions = np.array([0.3, -0.7, 0.5]), elastic(structure, 5)
    S = turning(structure.nodes, w)
    rigid = structure.rigid.A[:, 3:] @ w
    half = motions.T @ (structure.K @ (S @ motions))
    D3 = second.third(rigid[:, None], motions)[0]
    np.testing.assert_allclose(D3, -half - half.T, rtol=0, atol=1e-12 * np.abs(half).max())


def test_few_elements_at_a_time_give_the_same(shell, monkeypatch):
    structure, second, _ = shell
    motions = elastic(structure, 4)
    expected = second.third(motions[:, :2], motions)
    monkeypatch.setattr(shell_second, "GEOMETRIC_BATCH", 1)
    found = second.third(motions[:, :2], motions)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def turned_by(rotation, vectors):
    return Rotation.from_rotvec(rotation).apply(vectors)


def finite_energy(shells, laminate):
    """The energy of Green's strains of one element, with directors turned by finite rotations."""
    shape, X, d = shells.shape, shells.X[0], shells.d[0]
    N, dN = shape.N(shape.xi), shape.dN(shape.xi)
    at = shells.frames(shape.xi)
    dA = (at.areas * shape.weights)[0]
    linear = generalized(shells, shape.xi, at)
    c = 6 * len(X)
    inner = condensation(full_stiffness(linear, laminate, dA[None]), c)[0]
    weights = np.einsum("qia,qapb->qipb", at.turn[0], shape.weights_of_ties(shape.xi))

    def metric(x, y, dN):
        """x,a . y,b (q, 2, 2)."""
        return np.einsum("kaq,ki,lbq,li->qab", dN, x, dN, y)

    def voigt(e):
        return np.stack([e[:, 0, 0], e[:, 1, 1], e[:, 0, 1] + e[:, 1, 0]], axis=1)

    def energy(q):
        u, w = q.reshape(-1, 6)[:, :3], q.reshape(-1, 6)[:, 3:]
        x, now = X + u, np.array([turned_by(*pair) for pair in zip(w, d, strict=True)])
        membrane = 0.5 * voigt(metric(x, x, dN) - metric(X, X, dN))
        bending = voigt(metric(x, now, dN) - metric(X, d, dN))
        ties, slopes = shape.N(shape.ties), shape.dN(shape.ties)
        shear = [np.einsum("kap,ki,lp,li->pa", slopes, y, ties, of) for y, of in ((x, now), (X, d))]
        strains = np.concatenate(
            [
                np.einsum("qij,qj->qi", at.in_plane[0], membrane),
                np.einsum("qij,qj->qi", at.in_plane[0], bending),
                np.einsum("qipb,pb->qi", weights, shear[0] - shear[1]),
            ],
            axis=1,
        )
        strains += linear[0, :, :, c:] @ (inner @ q)
        along = np.einsum("qia,kaq,kj->qij", at.turn[0], dN, x)
        axes = [
            np.einsum("kq,kqi->qi", N, [turned_by(turn, at.axes[0, :, i]) for turn in w])
            for i in (0, 1)
        ]
        drilling = 0.5 * np.einsum("qi,qi->q", along[:, 0], axes[1])
        drilling -= 0.5 * np.einsum("qi,qi->q", along[:, 1], axes[0])
        stiffness = shell_second.DRILLING_FACTOR * laminate.in_plane_shear
        total = np.einsum("q,qi,ij,qj->", dA, strains, laminate.stiffness, strains)
        return 0.5 * (total + stiffness * dA @ drilling**2)

    return energy


@pytest.mark.parametrize("kind", KINDS)
def test_the_energy_of_an_element_is_that_of_finite_rotations(kind, monkeypatch):
    # As large as all else, so that no term of it is lost in the tolerance.
    for module in ("shell_second", "shell_matrices"):
        monkeypatch.setattr(f"duhamel.preprocess.elements.{module}.DRILLING_FACTOR", 0.5)
    grid = Grid(warped, (1, 1), kind, thickness=0.2, **ALUMINUM)
    shells = grid.source.shells[kind]
    laminate = grid.source.laminates.values[0]
    first = replace(shells, X=shells.X[:1], d=shells.d[:1], axis=shells.axis[:1])
    d = np.random.default_rng(3).normal(size=(6 * shells.X.shape[1], 3))
    batch = shell_second._Batch(np.arange(len(d))[None], first, laminate)
    G = batch.geometric(d[None])[0]
    D = np.einsum("ck,rcd,dl->rkl", d, G, d)
    found = D + D.transpose(1, 0, 2) + D.transpose(1, 2, 0)
    energy = finite_energy(first, laminate)
    for k, j in np.ndindex(3, 3):
        expected = refined(energy, [d[:, 0], d[:, k], d[:, j]], 0.005)
        assert found[0, k, j] == pytest.approx(expected, abs=1e-5 * np.abs(found).max())
    strains, _ = nodal_strains(first, laminate, first.shape.xi)
    assert strains.shape[2] == 8


def points_of(second, structure, q):
    """The places of all points of mass of the source after finite motions, and their masses."""
    moved = (second.T @ q).reshape(-1, 6)
    for piece in second.elements._pieces():
        nodes = piece.dofs[:, ::6] // 6
        w = moved[nodes, 3:]
        turned = Rotation.from_rotvec(w.reshape(-1, 3)).apply(piece.d.reshape(-1, 3))
        change = turned.reshape(piece.d.shape) - piece.d
        place = piece.moments / piece.mass[..., None]
        place = place + np.einsum("pk,nki->npi", piece.N, moved[nodes, :3])
        place = place + piece.heights[..., None] * np.einsum("pk,nki->npi", piece.N, change)
        yield piece.mass.ravel(), place.reshape(-1, 3)


@pytest.mark.parametrize("kind", KINDS)
def test_the_inertia_is_that_of_finite_rotations(kind):
    structure, second, _ = model(kind)
    elements, motions = second.elements, elastic(structure, 3)

    def inertia(q):
        total = np.zeros((3, 3))
        for mass, x in points_of(second, structure, motions @ q):
            total += np.sum(mass * (x**2).sum(axis=1)) * np.eye(3) - (mass[:, None] * x).T @ x
        return total[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]

    h = 1e-4
    e = np.eye(3)
    F = elements.inertia_loads().T @ motions
    at_rest = inertia(np.zeros(3))
    J = structure.rigid.J_rot
    expected = J[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
    np.testing.assert_allclose(at_rest, expected, atol=1e-9 * J.max())
    for k in range(3):
        slope = (inertia(h * e[k]) - inertia(-h * e[k])) / (2 * h)
        np.testing.assert_allclose(F[:, k], slope, atol=1e-6 * np.abs(F).max())
    Q = elements.inertia(motions)
    for k, j in ((0, 0), (0, 1), (1, 2)):
        signs = ((1, 1), (1, -1), (-1, 1), (-1, -1))
        mixed = sum(a * b * inertia(h * (a * e[k] + b * e[j])) for a, b in signs) / (4 * h * h)
        np.testing.assert_allclose(Q[:, k, j], mixed, atol=1e-4 * np.abs(Q).max())


@pytest.mark.parametrize("kind", KINDS)
def test_the_momentum_is_that_of_finite_rotations(kind):
    structure, second, _ = model(kind)
    motions = elastic(structure, 2)

    def momentum(q, rate):
        h, total = 1e-5, np.zeros(3)
        now, ahead, behind = (
            points_of(second, structure, motions @ (q + step * rate)) for step in (0.0, h, -h)
        )
        for (mass, x), (_, after), (_, before) in zip(now, ahead, behind, strict=True):
            total += np.sum(mass[:, None] * np.cross(x, (after - before) / (2 * h)), axis=0)
        return total

    found, size = second.elements.gyroscopic(motions), 1e-3
    for k, j in np.ndindex(2, 2):
        q, rate = size * np.eye(2)[k], np.eye(2)[j]
        slope = (momentum(q, rate) - momentum(-q, rate)) / (2 * size)
        np.testing.assert_allclose(found[:, k, j], slope, atol=1e-4 * np.abs(found).max())


FLAP = (4.7973, 3.5160)
"""The first flap frequency of a cantilever that turns by 3, and at rest, sqrt(EI / (m L^4))"""


@pytest.mark.parametrize("kind", KINDS)
def test_a_rotating_strip_stiffens_as_a_beam(kind):
    """Flat in the plane of rotation, so that it flaps across; wide ones err by their plates."""
    t = 0.02
    n = (20, 2)
    material = {"E": 70e9, "nu": 0.0, "rho": 2700.0}
    grid = Grid(lambda r, s: (r, 0.04 * (s - 0.5), 0.0), n, kind, thickness=t, **material)
    root = {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}, "kind": "rigid"}
    given = grid.body.model_dump(exclude_unset=True) | {"mesh": grid.source.mesh}
    impulse = {"step": 1e-5, "steps": 4, "method": "rubin", "modes": 12}
    given |= {"interfaces": {"root": root}, "rotation": {"modes": 4}, "impulse": impulse}
    element = build(Body.model_validate(given))
    unit = np.sqrt(70e9 * t**2 / 12.0 / 2700.0)
    squares = [
        (Steady(element, [Support(0)], [0, 0, w]).solve().frequencies()[0] / unit) ** 2
        for w in (0.0, 3.0 * unit)
    ]
    flap = [values.min() for values in squares]
    assert np.sqrt(flap[0]) == pytest.approx(FLAP[1], rel=5e-3)
    assert flap[1] - flap[0] == pytest.approx(FLAP[0] ** 2 - FLAP[1] ** 2, rel=0.01)


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"interfaces": {"edge": {"box": {"corners": [[-1, -1, -1], [0.1, 1, 1]]}}}}, "an average"),
        ({"shell": {"thickness": 0.01, "offset": 0.001}}, "no offset"),
    ],
)
def test_what_second_order_does_not_know_is_refused(tables, words):
    with pytest.raises(BodyError, match=words):
        model("quad", **tables)
