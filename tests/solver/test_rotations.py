"""Finite rotations against scipy and differences, from nearly no angle to more than a
whole turn.
"""

import numpy as np
import pytest
from duhamel.solver.step import rotations
from scipy.spatial.transform import Rotation

ANGLES = [0.0, 1e-12, 1e-8, 1e-4, 1e-2, 0.5, 0.999999, 1.000001, 2.0, 3.1, 4.0, 6.0]
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0


def result(function, *arguments, shape=(3, 3)):
    out = np.empty(shape)
    function(*arguments, out)
    return out


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


@pytest.mark.parametrize("angle", ANGLES)
def test_exponential(angle):
    psi = angle * AXIS
    expected = Rotation.from_rotvec(psi)
    np.testing.assert_allclose(result(rotations.exponential, psi), expected.as_matrix(), atol=4e-16)
    q = result(rotations.quaternion_exponential, psi, shape=4)
    np.testing.assert_allclose(
        result(rotations.quaternion_matrix, q), expected.as_matrix(), atol=1e-15
    )


@pytest.mark.parametrize("angle", ANGLES)
def test_tangent(angle):
    """exp(psi)^T d exp(psi) = skew(T dpsi), and its inverse."""
    psi, h = angle * AXIS, 1e-3
    T = result(rotations.tangent, psi)
    R = result(rotations.exponential, psi)
    for j, e in enumerate(np.eye(3)):
        near, far = (
            result(rotations.exponential, psi + k * h * e)
            - result(rotations.exponential, psi - k * h * e)
            for k in (1, 2)
        )
        turn = R.T @ (8 * near - far) / (12 * h)
        np.testing.assert_allclose(turn, skew(T[:, j]), atol=1e-12)
    np.testing.assert_allclose(result(rotations.tangent_inverse, psi) @ T, np.eye(3), atol=1e-13)


@pytest.mark.parametrize("angle", ANGLES)
def test_the_derivative_of_the_tangent(angle):
    w, moment, h = angle * AXIS, np.array([0.3, 2.0, -1.0]), 1e-3
    columns = []
    for e in np.eye(3):
        near, far = (
            (result(rotations.tangent, w + k * h * e) - result(rotations.tangent, w - k * h * e))
            @ moment
            for k in (1, 2)
        )
        columns.append((8 * near - far) / (12 * h))
    found = result(rotations.tangent_derivative, w, moment)
    np.testing.assert_allclose(found, np.array(columns).T, atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-10, 1e-5, 0.3, 2.0, 3.1])
def test_the_rotation_from_one_frame_to_another(angle):
    A = Rotation.from_rotvec([0.4, 1.0, -2.0])
    B = Rotation.from_rotvec(angle * AXIS) * A
    found = result(rotations.relative_rotation, A.as_matrix(), B.as_matrix(), shape=3)
    np.testing.assert_allclose(found, angle * AXIS, atol=1e-14 if angle < 3.0 else 1e-13)


def test_quaternions_of_all_turns():
    """Unit, of positive first component, and back to the matrix; products are compositions."""
    rng = np.random.default_rng(3)
    turns = [
        Rotation.from_rotvec(a * np.pi * e)
        for a in (0.5, 0.9999, 1.0, 1.5)
        for e in (*np.eye(3), AXIS)
    ]
    for turn in [*turns, *Rotation.random(20, rng)]:
        q = rotations.quaternion_of(turn.as_matrix())
        assert np.linalg.norm(q) == pytest.approx(1.0, rel=1e-14)
        assert q[0] >= 0.0
        np.testing.assert_allclose(
            result(rotations.quaternion_matrix, q), turn.as_matrix(), atol=1e-14
        )
    p, q = Rotation.random(2, rng)
    product = result(
        rotations.quaternion_product,
        p.as_quat(scalar_first=True),
        q.as_quat(scalar_first=True),
        shape=4,
    )
    np.testing.assert_allclose(
        result(rotations.quaternion_matrix, product), (p * q).as_matrix(), atol=1e-15
    )
