"""The deformation between interfaces: theirs there, rigid where they are, a cubic in between."""

import numpy as np
import pytest
from duhamel.results.blend import Blend
from duhamel.superelement import Outline
from duhamel.superelement.figures import sphere


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def around(places):
    """An outline with points at some places, and others."""
    return Outline(np.vstack([places, sphere(1.0).points]), np.empty((0, 3), dtype=int))


@pytest.mark.parametrize("n", [1, 2, 5])
def test_it_is_the_motion_of_an_interface_there(n, rng):
    places, u, theta = rng.normal(size=(3, n, 3))
    moved = Blend(around(places), places, [True] * n).displacement(u[None], theta[None])[0]
    np.testing.assert_allclose(moved[:n], u, atol=1e-9)


def test_close_to_an_interface_it_turns_with_it(rng):
    places, u, theta = rng.normal(size=(3, 4, 3))
    step = 1e-6 * rng.normal(size=3)
    moved = Blend(around(places + step), places, [True] * 4).displacement(u[None], theta[None])[0]
    np.testing.assert_allclose(moved[:4] - u, np.cross(theta, step), atol=1e-9)


@pytest.mark.parametrize("turns", [[True] * 4, [False] * 4, [True, False, False, True]])
def test_rigid_motions_are_exact(turns, rng):
    places, (shift, turn) = rng.normal(size=(4, 3)), rng.normal(size=(2, 3))
    outline, u = around(places), shift + np.cross(turn, places)
    theta = np.where(np.array(turns)[:, None], turn, 0.0)
    moved = Blend(outline, places, turns).displacement(u[None], theta[None])[0]
    np.testing.assert_allclose(moved, shift + np.cross(turn, outline.points), atol=1e-9)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_few_interfaces_without_rotations_move_as_they_do(n, rng):
    places, u = rng.normal(size=(2, n, 3))
    moved = Blend(around(places), places, [False] * n).displacement(u[None], 0.0 * u[None])[0]
    np.testing.assert_allclose(moved[:n], u, atol=1e-9)


def test_between_two_interfaces_of_a_line_it_is_the_cubic_of_a_beam():
    """A cantilever under a force at its tip: w = s^2 (3 - s) / 2, w' = 3/2 at the tip."""
    s = np.linspace(0.0, 1.0, 11)
    points = np.column_stack([s, 0.0 * s, 0.0 * s])
    places, u = points[[0, -1]], np.array([[[0.0, 0, 0], [0, 0, 1.0]]])
    theta = np.array([[[0.0, 0, 0], [0, -1.5, 0]]])
    line = Outline(points, [[i, i + 1] for i in range(10)])
    moved = Blend(line, places, [True, True]).displacement(u, theta)[0]
    np.testing.assert_allclose(moved[:, 2], s**2 * (3.0 - s) / 2.0, atol=1e-9)
    np.testing.assert_allclose(moved[:, :2], 0.0, atol=1e-9)


def test_sections_of_beams_stay_plane_and_keep_their_size(rng):
    nodes = np.array([[0.0, 0, 0], [0.5, 0, 0], [1.0, 0, 0]])
    ring = 0.1 * np.array([[0, 1, 1], [0, -1, 1], [0, -1, -1], [0, 1, -1]])
    outline = Outline(
        (nodes[:, None] + ring).reshape(-1, 3), [[0, 1, 2, 3]], np.repeat([0, 1, 2], 4)
    )
    u, theta = 1e-6 * rng.normal(size=(2, 1, 2, 3))
    moved = Blend(outline, nodes[[0, 2]], [True, True]).displacement(u, theta)[0].reshape(3, 4, 3)
    middle = moved.mean(axis=1)
    np.testing.assert_allclose(middle[[0, 2]], u[0], atol=1e-15)
    np.testing.assert_allclose(moved[0] - middle[0], np.cross(theta[0, 0], ring), atol=1e-15)
    arms = ring + moved[1] - middle[1]
    np.testing.assert_allclose(np.linalg.norm(arms, axis=1), 0.1 * np.sqrt(2.0), rtol=1e-9)


def test_points_are_taken_in_batches(monkeypatch, rng):
    places, u, theta = rng.normal(size=(3, 3, 3))
    blend = Blend(around(places), places, [True] * 3)
    whole = blend.displacement(u[None], theta[None])
    monkeypatch.setattr("duhamel.results.blend.TABLE_BATCH_NUMBERS", 1000)
    np.testing.assert_array_equal(blend.displacement(u[None], theta[None]), whole)
