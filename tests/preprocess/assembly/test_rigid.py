"""Rigid modes, mass properties and the projector, for every element."""

import numpy as np
import pytest
from duhamel.preprocess import assemble
from duhamel.preprocess.assembly.rigid import project, relieve
from scipy.spatial.transform import Rotation

SIZE = np.array([0.3, 0.2, 0.1])


def check_rigid(structure):
    """K U = 0, U^T M U = I, A^T M A = diag(m, J), P idempotent, P^T relieved of rigid work."""
    K, M, U, A = structure.K, structure.M, structure.U, structure.rigid.A
    scale = abs(K).sum(axis=1).max() * np.abs(U).max()
    assert np.abs(K @ U).max() < 1e-14 * scale
    np.testing.assert_allclose(U.T @ (M @ U), np.eye(6), rtol=0, atol=1e-12)
    moments = A.T @ (M @ A)
    expected = np.zeros((6, 6))
    expected[:3, :3] = structure.rigid.mass * np.eye(3)
    expected[3:, 3:] = structure.rigid.J_rot
    np.testing.assert_allclose(moments, expected, rtol=0, atol=1e-13 * structure.rigid.mass)
    w = np.random.default_rng(0).normal(size=(structure.n_u, 3))
    once = project(w, U, M)
    np.testing.assert_allclose(project(once, U, M), once, rtol=0, atol=1e-12 * np.abs(once).max())
    relieved = relieve(w, U, M)
    assert np.abs(U.T @ relieved).max() < 1e-12 * np.abs(U.T @ w).max()
    # w^T P^T f = (P w)^T f
    np.testing.assert_allclose(
        w.T @ relieved, once.T @ w, rtol=0, atol=1e-10 * np.abs(w.T @ w).max()
    )


def test_a_box_of_every_solid_element(solid_body, box, kind):
    mesh = box(kind, size=tuple(SIZE), divisions=(3, 2, 2))
    structure = assemble(solid_body(mesh))
    check_rigid(structure)
    mass = 7800.0 * SIZE.prod()
    inertia = mass / 12 * (SIZE @ SIZE - SIZE**2)
    assert structure.rigid.mass == pytest.approx(mass, rel=1e-13)
    np.testing.assert_allclose(structure.rigid.center, SIZE / 2, rtol=1e-13)
    if kind in ("tetra", "hexahedron"):
        # linear elements integrate N^T N of rigid rotations exactly too: their shapes hold every
        # linear field
        np.testing.assert_allclose(
            structure.rigid.J_rot, np.diag(inertia), rtol=0, atol=1e-12 * inertia.max()
        )
    np.testing.assert_allclose(
        structure.rigid.J_rot, np.diag(inertia), rtol=0, atol=1e-12 * inertia.max()
    )


def test_a_turned_and_moved_box(solid_body, box, kind):
    R, move = Rotation.random(random_state=3).as_matrix(), np.array([5.0, -3.0, 2.0])
    mesh = box(kind, size=tuple(SIZE))
    mesh.points = mesh.points @ R.T + move
    structure = assemble(solid_body(mesh))
    check_rigid(structure)
    mass = 7800.0 * SIZE.prod()
    inertia = R @ np.diag(mass / 12 * (SIZE @ SIZE - SIZE**2)) @ R.T
    np.testing.assert_allclose(
        structure.rigid.J_rot, inertia, rtol=0, atol=1e-12 * np.abs(inertia).max()
    )
    np.testing.assert_allclose(structure.rigid.center, R @ SIZE / 2 + move, rtol=1e-13)


def test_a_curved_quadratic_body_stays_free_of_strain(solid_body, box, kind):
    """Isoparametric elements hold rigid motions exactly however they are bent."""
    mesh = box(kind, divisions=(3, 2, 2))
    x, y, z = mesh.points.T
    mesh.points = np.stack([(1 + 0.3 * y) * np.sin(x), y + 0.2 * x**2, z + 0.1 * x * y], axis=1)
    check_rigid(assemble(solid_body(mesh)))


def test_a_rigid_interface_changes_no_mass(solid_body, box, kind):
    mesh = box(kind, size=tuple(SIZE))
    rigid = {
        "root": {"group": "root", "kind": "rigid"},
        "tip": {"group": "tip", "kind": "rigid", "at": [0.5, 0, 0]},
    }
    structure = assemble(solid_body(mesh, interfaces=rigid))
    check_rigid(structure)
    free = assemble(solid_body(mesh))
    assert structure.rigid.mass == pytest.approx(free.rigid.mass, rel=1e-13)
    np.testing.assert_allclose(structure.rigid.J_rot, free.rigid.J_rot, rtol=0, atol=1e-13)
    np.testing.assert_allclose(structure.rigid.center, free.rigid.center, rtol=1e-12)


def test_a_frame_of_beams_at_random(beam_body, lines):
    points = np.random.default_rng(5).normal(size=(8, 3))
    structure = assemble(beam_body(lines(points)))
    check_rigid(structure)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert structure.rigid.mass == pytest.approx(0.0858 * lengths.sum(), rel=1e-13)


def test_the_inertia_of_the_papers_beam(beam_body, beam):
    rigid = assemble(beam_body(beam(10))).rigid
    assert rigid.mass == pytest.approx(0.0429, rel=1e-13)
    np.testing.assert_allclose(np.diag(rigid.J_rot), [2.2e-8, 8.9375e-4, 8.9375e-4], rtol=1e-12)
    np.testing.assert_allclose(rigid.center, [0.25, 0, 0], rtol=0, atol=1e-15)
