"""Beams to second order: Reissner's energy, finite rotations of sections, and loads that buckle."""

import numpy as np
import pytest
from duhamel.preprocess import BodyError, assemble
from duhamel.preprocess.assembly.second_order import second_order
from duhamel.preprocess.body.material import Section
from duhamel.preprocess.elements import beam_second
from duhamel.preprocess.elements.beam import beam_properties, section_motion
from duhamel.preprocess.elements.beam_second import beam_tensors
from duhamel.preprocess.mesh.reading import read_mesh
from duhamel.preprocess.sources.reading import read_source
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from ..differences import mixed, refined, six, skew, turning

SHEAR = {"GA_y": 1e3, "GA_z": 1.2e3}
SECTION = {
    "EA": 2e3,
    "EI_y": 14.0,
    "EI_z": 9.0,
    "GJ": 10.0,
    "mass_per_length": 1.2,
    "polar_inertia_per_length": 0.12,
    "rotary_inertia_y": 0.05,
    "rotary_inertia_z": 0.07,
}
FRAME = [[0, 0, 0], [1, 0, 0], [1.3, 0.6, 0], [1.2, 1, 0.7]]
J = [[0.3, 0.01, 0.02], [0.01, 0.4, -0.01], [0.02, -0.01, 0.5]]
MASSES = {
    "tip": {"interface": "tip", "mass": 0.5, "inertia": J},
    "corner": {"node": [1, 0, 0], "mass": 0.2, "inertia": [0.1, 0.2, 0.3]},
}


def model(body):
    source = read_source(body)
    structure = assemble(body)
    return structure, second_order(structure, source, body)


@pytest.fixture(params=[{}, SHEAR], ids=["euler-bernoulli", "timoshenko"])
def frame(request, beam_body, lines):
    return model(beam_body(lines(FRAME), SECTION | request.param, masses=MASSES))


def elastic(structure, r, seed=0):
    motions = np.random.default_rng(seed).normal(size=(structure.n_u, r))
    return motions - structure.U @ (structure.U.T @ (structure.M @ motions))


def test_a_turned_frame_has_the_energy_it_had(frame):
    structure, second = frame
    w, motions = np.array([0.3, -0.7, 0.5]), elastic(structure, 5)
    S = turning(structure.nodes, w)
    rigid = structure.rigid.A[:, 3:] @ w
    half = motions.T @ (structure.K @ (S @ motions))
    D3 = second.third(rigid[:, None], motions)[0]
    np.testing.assert_allclose(D3, -half - half.T, rtol=0, atol=1e-13 * np.abs(half).max())


def test_the_third_derivative_is_symmetric(frame):
    structure, second = frame
    motions = elastic(structure, 4)
    D3 = second.third(motions, motions)
    for order in ((1, 0, 2), (2, 1, 0), (0, 2, 1)):
        np.testing.assert_allclose(D3.transpose(order), D3, rtol=0, atol=1e-14 * np.abs(D3).max())
    np.testing.assert_allclose(second.cubic(motions), D3, rtol=0, atol=1e-14 * np.abs(D3).max())


def test_few_elements_at_a_time_give_the_same(frame, monkeypatch):
    structure, second = frame
    motions = elastic(structure, 4)
    expected = second.third(motions[:, :2], motions)
    monkeypatch.setattr(beam_second, "BEAM_BATCH", 1)
    found = second.third(motions[:, :2], motions)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


def reissner(section, L):
    """The energy of one element along x, of the strains R^T x' - e1 and the curvature of R."""
    p = beam_properties([section], np.array([L]))
    C = np.array([section.EA, section.GA_y, section.GA_z, section.GJ, section.EI_y, section.EI_z])
    e1 = np.array([1.0, 0.0, 0.0])
    xi, weights = beam_second.BEAM_GAUSS_POINTS

    def energy(d):
        total = 0.0
        for x, weight in zip(xi, weights, strict=True):
            motion, slope = (section_motion(x, np.array([L]), p, k)[0] @ d for k in (0, 1))
            w, W = motion[3:], skew(motion[3:])
            R = Rotation.from_rotvec(w).as_matrix()
            # the tangent of rotation vectors, I - W / 2 + W W / 6 - ...
            T = np.eye(3) - W / 2 + W @ W / 6 - W @ W @ W / 24
            strains = np.concatenate([R.T @ (e1 + slope[:3]) - e1, T @ slope[3:]])
            total += 0.5 * weight * L * strains @ (C * strains)
        return total

    return energy


def test_the_energy_of_an_element_is_reissners(save, lines):
    """Of motions that do not turn the element as a whole; those have a test of their own."""
    L, section = 0.7, Section(**SECTION, **SHEAR)
    mesh = read_mesh(save(lines([[0, 0, 0], [L, 0, 0]])))
    tensors = beam_tensors(mesh, [section], np.zeros(3))
    d = np.random.default_rng(3).normal(size=(12, 3))
    d[[1, 2, 7, 8]], d[9] = 0.0, -d[3]
    found = tensors.third(d[:, :1], d)[0]
    energy = reissner(section, L)
    for k, j in np.ndindex(3, 3):
        expected = refined(energy, [d[:, 0], d[:, k], d[:, j]], 0.005)
        assert found[k, j] == pytest.approx(expected, abs=1e-6 * np.abs(found).max())


def sections(structure, second):
    """Mass, inertia, position and the rows for displacement and rotation of all rigid pieces."""
    elements = second.elements
    pieces, motion = elements._sections(), elements._section_motions()
    dofs = np.tile(elements.dofs, (4, 1))
    for i in range(len(pieces.mass)):
        rows = np.zeros((6, structure.n_u))
        rows[:, dofs[i]] = motion[i]
        yield pieces.mass[i], pieces.inertia[i], pieces.X[i], rows
    for lumped in second.lumped:
        piece = lumped.piece
        yield piece.mass[0], piece.inertia[0], piece.X[0], lumped.frame.rows.toarray()


def exact_inertia(structure, second):
    parts = list(sections(structure, second))

    def inertia(u):
        total = np.zeros((3, 3))
        for mass, j, X, rows in parts:
            x, R = X + rows[:3] @ u, Rotation.from_rotvec(rows[3:] @ u).as_matrix()
            total += mass * (x @ x * np.eye(3) - np.outer(x, x)) + R @ j @ R.T
        return six(total)

    return inertia


def exact_momentum(structure, second, u, rate, step=1e-5):
    """The angular momentum of finite motions, rates by central differences."""
    total = np.zeros(3)
    for mass, j, X, rows in sections(structure, second):
        x, v = X + rows[:3] @ u, rows[:3] @ rate
        R, before, after = (
            Rotation.from_rotvec(rows[3:] @ (u + s * rate)) for s in (0.0, -step, step)
        )
        omega = (after * before.inv()).as_rotvec() / (2 * step)
        total += mass * np.cross(x, v) + R.as_matrix() @ j @ R.as_matrix().T @ omega
    return total


def test_the_sections_add_up_to_the_rigid_body(frame):
    structure, second = frame
    inertia = exact_inertia(structure, second)
    J_rot = six(structure.rigid.J_rot)
    np.testing.assert_allclose(inertia(np.zeros(structure.n_u)), J_rot, rtol=1e-12, atol=1e-13)


def test_the_inertia_is_that_of_finite_rotations(frame):
    structure, second = frame
    inertia = exact_inertia(structure, second)
    motions = elastic(structure, 3)
    Q, first = second.inertia(motions), second.inertia_loads.T @ motions
    for k in range(3):
        expected = refined(inertia, [motions[:, k]], 1e-2)
        np.testing.assert_allclose(first[:, k], expected, rtol=0, atol=1e-7 * np.abs(first).max())
        for j in range(3):
            expected = refined(inertia, [motions[:, k], motions[:, j]], 1e-2)
            np.testing.assert_allclose(Q[:, k, j], expected, rtol=0, atol=1e-6 * np.abs(Q).max())


def test_the_momentum_is_that_of_finite_rotations(frame):
    """And elastic motion has none in first order."""
    structure, second = frame
    motions = elastic(structure, 2)
    h = second.gyroscopic(motions)
    for k, j in np.ndindex(2, 2):
        rate = motions[:, j]
        at = [exact_momentum(structure, second, s * motions[:, k], rate) for s in (-1e-3, 0, 1e-3)]
        np.testing.assert_allclose(at[1], 0.0, rtol=0, atol=1e-8 * np.abs(h).max())
        found = (at[2] - at[0]) / 2e-3
        np.testing.assert_allclose(h[:, k, j], found, rtol=0, atol=1e-5 * np.abs(h).max())


def test_nodes_of_beams_are_frames_as_they_are(frame):
    structure, second = frame
    assert not second.interfaces(elastic(structure, 3)).any()


def test_an_axial_load_stiffens_by_the_squares_of_slopes(beam_body, beam):
    """D3(u; psi, psi) = int N w'^2, but for the shear force on the stretch, EI / EA of it."""
    thin = {**SECTION, "EI_y": 1e-6, "EI_z": 1e-6, "EA": 1e3}
    structure, second = model(beam_body(beam(4, length=2.0), thin))
    pulled = np.zeros(structure.n_u)
    pulled[0::6] = 3e-3 * np.linspace(0, 2, 5)  # N = 3
    bent = np.zeros(structure.n_u)
    x = np.linspace(0, 2, 5)
    bent[1::6], bent[5::6] = x**3, 3 * x**2  # int 9 x^4 = 9/5 32
    found = second.third(pulled[:, None], bent[:, None]).item()
    assert found == pytest.approx(3.0 * 9 / 5 * 32, rel=1e-6)


def least_factor(structure, second, dof):
    """The factor of a unit load on the last node, clamped at the first, at which it buckles."""
    free, n = np.arange(6, structure.n_u), structure.n_u
    K, u = structure.K.toarray()[np.ix_(free, free)], np.zeros(n)
    load = np.zeros(n)
    load[n - 6 + dof] = -1.0
    u[free] = np.linalg.solve(K, load[free])
    geometric = second.third(u[:, None], np.eye(n)[:, free])[0]
    return -1.0 / eigh(geometric, K, eigvals_only=True).min()


@pytest.mark.parametrize("shear", [{}, {"GA_y": 1e7, "GA_z": 1e7}], ids=["without", "with"])
@pytest.mark.parametrize(
    ("dof", "exact", "order", "within"),
    [(0, np.pi**2 / 4, 4, 4e-6), (1, 4.01260 * np.sqrt(0.7), 2, 5e-3)],
    ids=["euler", "prandtl"],
)
def test_columns_and_strips_buckle(beam_body, beam, shear, dof, exact, order, within):
    """Under an axial load at Euler's, sideways under a transverse one at Prandtl's."""
    strip = SECTION | {"EA": 1e8, "EI_y": 1.0, "EI_z": 1e5, "GJ": 0.7} | shear
    errors = [
        least_factor(*model(beam_body(beam(n, length=1.0), strip)), dof) / exact - 1.0
        for n in (4, 8)
    ]
    assert abs(errors[1]) < within
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)


def test_a_quartic_energy_needs_solids(frame):
    structure, second = frame
    with pytest.raises(BodyError, match="expected solids"):
        second.quartic(elastic(structure, 2), lambda loads: loads)
    assert mixed(lambda x: x**2, [1.0, 1.0]) == 2.0
