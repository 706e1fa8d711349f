"""Static compliance and accelerance against closed forms and the sums over all modes."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import MeshError, assemble, build
from duhamel.preprocess.body.body import Damping
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.preprocess.responses.static import (
    _solved_by_gradients,
    accelerance,
    compliance,
    initial_accelerations,
    slow_chain,
)
from scipy.sparse.linalg import eigsh

L, EI, EA, GJ = 0.5, 5.5, 2.16e7, 4.0


def relative(found, expected):
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    return np.abs((found - expected) / scale).max()


@pytest.mark.parametrize("n", [10, 40])
def test_closed_forms_of_a_free_beam(beam_body, beam, n):
    """Inertia-relieved bending of a uniform beam; the defect of the consistent mass falls with N^2
    and faster.
    """
    H = compliance(assemble(beam_body(beam(n))))
    near = 1e-3 / n**2
    for end, sign in ((0, 1.0), (6, -1.0)):
        uy, uz, ry, rz = end + 1, end + 2, end + 4, end + 5
        assert H[uy, uy] == pytest.approx(L**3 / (105 * EI), rel=10 * near)
        assert H[uz, uz] == pytest.approx(L**3 / (105 * EI), rel=10 * near)
        assert H[uy, rz] == pytest.approx(-sign * 11 * L**2 / (210 * EI), rel=10 * near)
        assert H[uz, ry] == pytest.approx(sign * 11 * L**2 / (210 * EI), rel=10 * near)
        assert H[rz, rz] == pytest.approx(13 * L / (35 * EI), rel=10 * near)
        assert H[ry, ry] == pytest.approx(13 * L / (35 * EI), rel=10 * near)
    assert H[1, 7] == pytest.approx(L**3 / (140 * EI), rel=10 * near)
    assert H[2, 8] == pytest.approx(L**3 / (140 * EI), rel=10 * near)


@pytest.mark.parametrize("n", [10, 40])
def test_stretch_and_twist_of_linear_bars(beam_body, beam, n):
    """L / 3EA and L / 3GJ, less the part 1 / 4N^2 that linear bars with consistent mass miss."""
    H = compliance(assemble(beam_body(beam(n))))
    assert H[0, 0] == pytest.approx(L / (3 * EA) * (1 - 0.25 / n**2), rel=1e-10)
    assert H[3, 3] == pytest.approx(L / (3 * GJ) * (1 - 0.25 / n**2), rel=1e-10)


def test_the_compliance_is_the_sum_over_elastic_modes(beam_body, lines):
    """phi omega^-2 phi^T, which knows nothing of held dofs; the accelerance is phi phi^T."""
    structure = assemble(beam_body(lines(np.random.default_rng(1).normal(size=(6, 3)))))
    modes = elastic_shapes(structure, Damping())[0]
    assert relative(compliance(structure), (modes.phi / modes.omega**2) @ modes.phi.T) < 1e-8
    assert relative(accelerance(structure), modes.phi @ modes.phi.T) < 1e-10


def test_the_same_of_solids_with_both_kinds_of_interface(solid_body, box, kind):
    interfaces = {
        "root": {"group": "root", "kind": "rigid"},
        "tip": {"group": "tip"},
        "corner": {"node": [0, 1, 1]},
    }
    mesh = box(kind, divisions=(2, 1, 1))
    mesh.points = mesh.points * [3.0, 1.0, 1.0]
    interfaces["corner"] = {"node": [3, 1, 1]}
    structure = assemble(solid_body(mesh, interfaces=interfaces))
    modes = elastic_shapes(structure, Damping())[0]
    assert relative(compliance(structure), (modes.phi / modes.omega**2) @ modes.phi.T) < 1e-9
    assert relative(accelerance(structure), modes.phi @ modes.phi.T) < 1e-10


def test_loads_that_balance_themselves_see_plain_elasticity(beam_body, beam):
    """p^T H p = p^T P_C K^+ P_C^T p for loads p without resultant, which need no inertia."""
    structure = assemble(beam_body(beam(10)))
    frames = structure.P_C @ structure.rigid.A
    _, _, basis = np.linalg.svd(frames.T)
    balanced = basis[6:].T
    pseudo = np.linalg.pinv(structure.K.toarray(), rcond=1e-13, hermitian=True)
    plain = balanced.T @ structure.P_C @ pseudo @ structure.P_C.T @ balanced
    relieved = balanced.T @ compliance(structure) @ balanced
    np.testing.assert_allclose(relieved, plain, rtol=0, atol=1e-8 * np.abs(plain).max())


def test_ritz_modes_know_the_compliance(solid_body, box):
    """What superelements of Krylov modes state, without a factorization of the held stiffness."""
    body = solid_body(
        box("tetra10", size=(0.4, 0.05, 0.05), divisions=(16, 2, 2)),
        impulse={"step": 5e-6, "steps": 100, "method": "krylov", "tolerance": 1e-9},
    )
    assert relative(build(body).compliance, compliance(assemble(body))) < 1e-8


def test_initial_accelerations_of_every_mass_matrix(beam_body, lines, solid_body, box):
    """By conjugate gradients on solids; on beams askew, whose little polar inertia stops these, by
    factorization.
    """
    askew = assemble(
        beam_body(lines(np.cumsum(np.random.default_rng(1).normal(size=(60, 3)), axis=0)))
    )
    assert _solved_by_gradients(askew.M.tocsr(), askew.loads) is None
    solid = assemble(solid_body(box("tetra10", divisions=(3, 3, 3))))
    assert _solved_by_gradients(solid.M.tocsr(), solid.loads) is not None
    for structure in (askew, solid):
        expected = np.linalg.solve(structure.M.toarray(), structure.loads)
        found = initial_accelerations(structure)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_iterations_do_not_grow_with_the_mesh(solid_body, box):
    """Wathen's bound is that of one element; so the limit on iterations holds for meshes of any
    size.
    """
    for n in (2, 4, 8):
        M = assemble(solid_body(box("tetra10", size=(1.0, 0.2, 0.1), divisions=(n, n, n)))).M
        scale = sp.diags_array(1.0 / np.sqrt(M.diagonal()))
        least, most = (
            eigsh(scale @ M @ scale, 1, which=which, return_eigenvectors=False, tol=1e-3)[0]
            for which in ("SA", "LA")
        )
        assert most / least < 40.0


@pytest.mark.parametrize("seed", range(8))
def test_a_mechanism_has_no_compliance(beam_body, beam, seed):
    """K - K v v^T K / (v^T K v) lets v happen without any force: a seventh zero mode."""
    structure = assemble(beam_body(beam(4)))
    force = structure.K @ (v := np.random.default_rng(seed).normal(size=structure.n_u))
    loose = structure.K - sp.csc_array(np.outer(force, force) / (v @ force))
    with pytest.raises(MeshError, match="the body is a mechanism"):
        compliance(replace(structure, K=loose))


def test_slow_responses_to_rotation_take_the_memory_of_their_columns(solid_body, box):
    """A few blocks of six, not a square of all unknowns: 176 GB for a part of 51 000 nodes."""
    structure = assemble(solid_body(box("hexahedron", divisions=(12, 8, 8))))
    loads = np.random.default_rng(3).normal(size=(structure.n_u, 6))
    structure = replace(structure, inertia=loads)
    tracemalloc.start()
    blocks = slow_chain(structure)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert [block.shape for block in blocks] == [(structure.n_u, 6)] * 5
    assert peak < 0.2 * structure.n_u**2 * 8
