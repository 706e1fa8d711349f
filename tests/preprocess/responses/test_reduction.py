"""Truncated modes: the methods of Craig and Bampton, and of Rubin, beside dense ones made here
from the same matrices; what of them is exact, and whether the stated error is true.
"""

from itertools import pairwise

import numpy as np
import pytest
from duhamel.preprocess import MethodError, assemble, build
from duhamel.preprocess.body.body import Damping
from duhamel.preprocess.responses import held, truncated
from duhamel.preprocess.responses.band import Band
from duhamel.preprocess.responses.held import held_modes
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.preprocess.responses.reduction import craig_bampton, rubin
from duhamel.preprocess.responses.static import accelerance, compliance
from duhamel.superelement import GeneralizedAlpha, check, read, write
from scipy.linalg import eigh, null_space

NONE = Damping()
METHODS = {"craig-bampton": craig_bampton, "rubin": rubin}
SCHEME = GeneralizedAlpha(0.9)
RIGID_ENDS = {name: {"group": name, "kind": "rigid"} for name in ("root", "tip")}
MIXED = {
    "root": {"group": "root", "kind": "rigid"},
    "tip": {"group": "tip"},
    "corner": {"node": [0.2, 0.0, 0.0]},
}


@pytest.fixture(params=["beam", "beam, one interface", "solid", "corner", "two corners"])
def structure(request, beam_body, beam, solid_body, box):
    """Bodies whose interfaces are nodes of beams, rigid and averaged faces, and nodes that do not
    hold the body."""
    mesh = box("hexahedron20", (0.2, 0.05, 0.03), (4, 1, 1))
    corner, other = {"node": [0.2, 0.0, 0.0]}, {"node": [0.0, 0.0, 0.0]}
    match request.param:
        case "beam":
            return assemble(beam_body(beam(8)))
        case "beam, one interface":
            return assemble(beam_body(beam(8), interfaces={"tip": {"group": "tip"}}))
        case "solid":
            return assemble(solid_body(mesh, interfaces=MIXED))
        case "corner":
            return assemble(solid_body(mesh, interfaces={"corner": corner}))
        case "two corners":
            return assemble(solid_body(mesh, interfaces={"corner": corner, "other": other}))


@pytest.fixture(params=METHODS)
def method(request):
    return request.param


def dense(structure):
    return structure.K.toarray(), structure.M.toarray(), structure.P_C.toarray()


def frequencies_of(T, structure):
    """Elastic frequencies [rad/s] of the body in the space of the columns of T."""
    K, M, _ = dense(structure)
    left, sizes, _ = np.linalg.svd(
        T / np.sqrt(np.einsum("ik,ik->k", T, M @ T)), full_matrices=False
    )
    V = left[:, sizes > 1e-9 * sizes[0]]
    return np.sqrt(eigh(V.T @ K @ V, V.T @ M @ V, eigvals_only=True)[6:])


def relative(found, expected):
    """The largest difference of matrices, each entry on the scale of its rows."""
    scale = np.sqrt(np.diag(expected))
    return (np.abs(found - expected) / np.outer(scale, scale)).max()


def test_craig_and_bampton_as_in_their_paper(beam_body, beam, solid_body, box):
    """Interface dofs q and inner ones: T = [1 0; -K_ii^-1 K_iq, Phi], of nodes and rigid frames."""
    line = assemble(beam_body(beam(8)))
    solid = solid_body(box("tetra10", (0.2, 0.05, 0.03), (4, 1, 1)), interfaces=RIGID_ENDS)
    for structure in (line, assemble(solid)):
        K, M, P_C = dense(structure)
        q = np.flatnonzero(P_C.any(axis=0))
        i = np.setdiff1d(np.arange(len(K)), q)
        _, fixed = eigh(K[np.ix_(i, i)], M[np.ix_(i, i)])
        T = np.zeros((len(K), len(q) + 7))
        T[q, : len(q)] = np.eye(len(q))
        T[i, : len(q)] = -np.linalg.solve(K[np.ix_(i, i)], K[np.ix_(i, q)])
        T[i, len(q) :] = fixed[:, :7]
        expected = frequencies_of(T, structure)
        found = craig_bampton(structure, NONE, 7).modes.omega
        assert len(found) == len(q) + 7 - 6
        np.testing.assert_allclose(found, expected, rtol=1e-7)


def test_craig_and_bampton_with_averaged_frames(structure):
    """P_C u = 0 by its null space, and constraint modes from the saddle point system. Without
    support, rigid motions of the held body are no modes."""
    K, M, P_C = dense(structure)
    Z = null_space(P_C)
    squares, y = eigh(Z.T @ K @ Z, Z.T @ M @ Z)
    first = int((squares < 1e-9 * squares[-1]).sum())
    saddle = np.block([[K, P_C.T], [P_C, np.zeros((len(P_C), len(P_C)))]])
    unit = np.vstack([np.zeros((len(K), len(P_C))), np.eye(len(P_C))])
    constraint = (
        np.linalg.lstsq(saddle, unit, rcond=1e-15)[0][: len(K)]
        if first
        else (np.linalg.solve(saddle, unit)[: len(K)])
    )
    T = np.hstack([structure.U, constraint, Z @ y[:, first : first + 5]])
    found = craig_bampton(structure, NONE, 5).modes.omega
    np.testing.assert_allclose(found, frequencies_of(T, structure), rtol=1e-6)


def test_rubin_as_in_his_paper(structure):
    """Free modes and residual attachment modes, with inertia relief, by a pseudo-inverse."""
    K, M, P_C = dense(structure)
    squares, shapes = eigh(K, M)
    elastic = shapes[:, 6:]
    attachment = elastic @ ((P_C @ elastic) / squares[6:]).T
    residual = attachment - elastic[:, :5] @ ((P_C @ elastic[:, :5]) / squares[6:11]).T
    expected = frequencies_of(np.hstack([structure.U, elastic[:, :5], residual]), structure)
    found = rubin(structure, NONE, 5).modes.omega
    assert len(found) == 5 + len(P_C)
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_rubins_low_modes_and_compliance_are_exact(structure):
    every, modes = elastic_shapes(structure, NONE)[0], rubin(structure, NONE, 6).modes
    np.testing.assert_allclose(modes.omega[:6], every.omega[:6], rtol=1e-8)
    assert relative(modes.compliance, compliance(structure)) < 1e-10


def test_craig_and_bamptons_compliance_is_exact_for_loads_in_balance(structure):
    """Not for inertia relief, whose loads act inside: one mode of a beam misses a quarter of the
    axial one, 1/4 for 1/3 of L / EA."""
    modes, exact = craig_bampton(structure, NONE, 1).modes, compliance(structure)
    balanced = null_space((structure.P_C @ structure.U).T, rcond=1e-9)
    found, expected = (balanced.T @ H @ balanced for H in (modes.compliance, exact))
    np.testing.assert_allclose(
        found, expected, rtol=0, atol=1e-9 * np.abs(expected).max(initial=1e-300)
    )
    assert relative(modes.compliance, exact) > 1e-6


def test_the_axial_compliance_of_a_rod_by_craig_and_bampton(beam_body, beam):
    structure = assemble(beam_body(beam(8)))
    found = craig_bampton(structure, NONE, 1).modes.compliance[0, 0]
    assert found == pytest.approx(0.5 / 2.16e7 / 4, rel=1e-9)
    assert compliance(structure)[0, 0] == pytest.approx(0.5 / 2.16e7 / 3, rel=1e-2)


def test_all_modes_of_either_method_are_those_of_the_mesh(structure, method):
    every = elastic_shapes(structure, NONE)[0]
    n_c, loose = (
        len(structure.P_C.toarray()),
        6 - np.linalg.matrix_rank(structure.P_C @ structure.U, rtol=1e-9),
    )
    count = len(every.omega) + (6 - n_c - loose if method == "craig-bampton" else 0)
    modes = METHODS[method](structure, NONE, count).modes
    np.testing.assert_allclose(modes.omega, every.omega, rtol=1e-7)
    assert relative(modes.compliance, every.compliance) < 1e-8
    assert relative(modes.accelerance, accelerance(structure)) < 1e-8
    with pytest.raises(MethodError, match=rf"modes: expected 1 to {count}, all of .*{count + 1}"):
        METHODS[method](structure, NONE, count + 1)


def test_modes_converge_from_above_as_their_number_grows(structure, method):
    """Ritz: spaces that hold each other have frequencies that never rise, and end at the exact."""
    exact = elastic_shapes(structure, NONE)[0].omega[:5]
    errors = [
        METHODS[method](structure, NONE, count).modes.omega[:5] / exact - 1.0
        for count in (5, 8, 13, 21, 34)
    ]
    assert all((more <= few + 1e-9).all() for few, more in pairwise(errors))
    assert (errors[-1] >= -1e-9).all()
    assert errors[-1].max() < 3e-3


def test_lanczos_finds_what_the_dense_solver_finds(solid_body, box, monkeypatch, method):
    """A square bar: all modes of bending are twofold."""
    structure = assemble(solid_body(box("hexahedron20", (0.2, 0.03, 0.03), (6, 1, 1))))
    expected = METHODS[method](structure, NONE, 21).modes
    monkeypatch.setattr(held, "FULL_MODAL_UNKNOWNS", 0)
    called = []
    monkeypatch.setattr(held, "_of_all", lambda *_: called.append(1))
    found = METHODS[method](structure, NONE, 21).modes
    assert not called
    np.testing.assert_allclose(found.omega, expected.omega, rtol=1e-8)
    assert relative(found.compliance, expected.compliance) < 1e-8
    assert relative(found.accelerance, expected.accelerance) < 1e-6


def test_a_mode_that_lanczos_missed_is_found_beside_the_others(solid_body, box, monkeypatch):
    structure = assemble(solid_body(box("hexahedron20", (0.2, 0.03, 0.03), (6, 1, 1))))
    rows = (structure.M @ structure.U).T
    expected = held_modes(structure, rows, 6, 1e7)
    lanczos, calls = held._lanczos, []

    def forgetful(structure, solve, count, shift):
        """Leaves out the second mode, the first time."""
        calls.append(count)
        if len(calls) > 1:
            return lanczos(structure, solve, count, shift)
        found = lanczos(structure, solve, count + 1, shift)
        kept = np.arange(count + 1) != 1
        return held.HeldModes(found.squares[kept], found.shapes[:, kept])

    monkeypatch.setattr(held, "FULL_MODAL_UNKNOWNS", 0)
    monkeypatch.setattr(held, "_lanczos", forgetful)
    found = held_modes(structure, rows, 6, 1e7)
    assert len(calls) > 2
    np.testing.assert_allclose(found.squares, expected.squares, rtol=1e-8)


def test_more_modes_than_there_is_time_for(structure, monkeypatch):
    monkeypatch.setattr(held, "FULL_MODAL_UNKNOWNS", 10)
    monkeypatch.setattr(held, "MODAL_LIMIT", 10)
    with pytest.raises(MethodError, match=r"modes: expected up to \d+ of a mesh of \d+ unknowns, "):
        rubin(structure, NONE, structure.n_u // 2)


@pytest.mark.parametrize("count", [2, 12, 40])
@pytest.mark.parametrize("small", [0, 4000])
def test_the_stated_error_is_that_beside_all_modes(
    solid_body, box, method, count, small, monkeypatch
):
    """Looked at on frequencies of its own, in the band that the file states."""
    monkeypatch.setattr(truncated, "FULL_MODAL_UNKNOWNS", small)
    body = solid_body(box("hexahedron20", (0.2, 0.05, 0.03), (5, 1, 1)))
    impulse = body.impulse.model_copy(update={"step": 1e-5, "steps": 200})
    body = body.model_copy(update={"impulse": impulse}).with_modes(method, count)
    element = build(body)
    every = elastic_shapes(assemble(body), NONE)[0]
    band = Band(1e-5, SCHEME, element.kernel.band)
    assert element.modes.h_min == pytest.approx(0.25 / element.kernel.band)
    assert 0.0 < element.kernel.band <= 25e3
    true = band._error_inside(element.modes, every, None)
    assert 0.0 < true <= 1.001 * element.kernel.error


def test_more_modes_are_right_in_a_wider_band(solid_body, box, method):
    impulse = {"step": 5e-6, "steps": 20}
    body = solid_body(box("hexahedron20", (0.2, 0.05, 0.03), (5, 1, 1)), impulse=impulse)
    found = [build(body.with_modes(method, count)).kernel for count in (16, 64)]
    assert all(b.band > a.band for a, b in pairwise(found))
    assert all(kernel.error <= truncated.TRUNCATION_ERROR for kernel in found)


def test_too_few_modes_say_that_they_are_wrong_everywhere(beam_body, beam):
    """Without one axial mode of the held beam a quarter of the compliance is missing."""
    kernel = build(beam_body(beam(8)).with_modes("craig-bampton", 2)).kernel
    assert kernel.error == pytest.approx(0.25, rel=0.02)


@pytest.mark.parametrize("solid", [True, False])
def test_a_file_of_truncated_modes_is_sound(
    solid, solid_body, beam_body, box, beam, method, tmp_path
):
    changes = {"damping": {"modal": 0.01}, "recovery": {"stress": solid}}
    body = (
        solid_body(box("hexahedron20"), interfaces=RIGID_ENDS, **changes)
        if solid
        else beam_body(beam(8), **changes)
    )
    element = build(body.with_modes(method, 12))
    write(tmp_path / "body.h5", element)
    again = read(tmp_path / "body.h5")
    assert [str(c) for c in check(again) if not c.holds] == []
    assert again.provenance.method == f"{method} with 12 modes"
    assert again.recovery.phi.shape[2] == len(again.modes.omega)
    assert '"modes":12' in again.provenance.body
    assert again.kernel.error > 0.0
    np.testing.assert_array_equal(again.modes.zeta, 0.01)


def test_fields_count_in_the_error_where_they_are_kept(solid_body, box):
    mesh, impulse = box("hexahedron20", (0.2, 0.05, 0.03), (5, 1, 1)), {"step": 5e-6, "steps": 20}
    bare, kept = (
        build(solid_body(mesh, impulse=impulse, **changes).with_modes("rubin", 16)).kernel
        for changes in ({}, {"recovery": {}})
    )
    assert kept.band < bare.band
