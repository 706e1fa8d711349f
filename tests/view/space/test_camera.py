"""The camera: what it sees, from where, and which side is up."""

import numpy as np
import pytest
from duhamel.view import PictureError
from duhamel.view.camera import Fitting, chosen_axes, following
from duhamel.view.space.film import fitted, gravity_of
from duhamel.view.space.lettering import Frame
from duhamel.view.space.stage import Stage

from .pendulum import TIME, Pendulum

ROUND = np.eye(3)


@pytest.mark.parametrize("size", [(64, 36), (36, 64)])
@pytest.mark.parametrize("view", ["iso", "xz", "3,-1,0.5"])
def test_the_camera_holds_all_points_of_all_frames_between_the_margins(view, size):
    stage = Stage(Pendulum(), TIME)
    frame = Frame(size, scale=True)
    camera = fitted(stage, chosen_axes(view, ROUND, None), frame)
    left, right, *_ = frame.margins
    wide = (size[0] - left - right) * frame.pixel(camera.height)
    found = []
    for batch in stage.batches():
        found += [positions.reshape(-1, 3) for positions in batch.positions]
        found += [places.reshape(-1, 3) for places in stage.mark_positions(batch.rows)]
    seen = (np.concatenate(found) - camera.focus) @ camera.axes.T
    assert (np.abs(seen) < [0.5 * wide, 0.5 * camera.height, camera.depth]).all()
    assert np.ptp(seen, axis=0)[:2].max() > 0.9 * min(wide, camera.height)


def test_up_is_against_gravity():
    axes = chosen_axes("", ROUND, np.array([0.0, -9.81, 0.0]))
    assert axes[1] @ [0.0, 1.0, 0.0] > 0.8
    assert chosen_axes("", ROUND, None)[1] @ [0.0, 0.0, 1.0] > 0.8


@pytest.mark.parametrize(
    ("spread", "gravity", "towards", "up"),
    [
        ([1, 1, 0], None, [0, 0, 1], [0, 1, 0]),
        ([1, 1, 0], [0, -9.81, 0], [0, 0, 1], [0, 1, 0]),
        ([1, 0, 1], [0, 0, -9.81], [0, -1, 0], [0, 0, 1]),
        ([0, 1, 1], None, [1, 0, 0], [0, 0, 1]),
    ],
)
def test_a_motion_in_a_plane_is_looked_at_from_the_front(spread, gravity, towards, up):
    fall = None if gravity is None else np.array(gravity, dtype=float)
    axes = chosen_axes("", np.diag(np.asarray(spread, dtype=float)), fall)
    assert axes[2] @ towards > 0.95
    assert axes[1] @ up > 0.95


def test_a_motion_on_the_floor_is_not_looked_at_from_above():
    axes = chosen_axes("", np.diag([1.0, 1.0, 0.0]), np.array([0.0, 0.0, -9.81]))
    assert axes[2, 2] < 0.7
    assert axes[1, 2] > 0.7


def test_axes_are_right_up_and_towards_the_eye():
    for view in ("iso", "xy", "xz", "yz", "0,0,1", "1,2,3"):
        axes = chosen_axes(view, ROUND, None)
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1.0)


@pytest.mark.parametrize("view", ["front", "1,2", "0,0,0", "nan,0,1"])
def test_a_view_that_is_none_is_refused(view):
    with pytest.raises(PictureError, match=r"--view: expected iso, xy, xz, yz or a direction"):
        chosen_axes(view, ROUND, None)


def test_gravity_is_that_of_the_model():
    np.testing.assert_array_equal(gravity_of(Pendulum(gravity="[0, -9.81, 0]")), [0, -9.81, 0])
    assert gravity_of(Pendulum()) is None


def test_a_single_point_is_seen():
    fitting = Fitting(np.eye(3))
    fitting.take(np.zeros((1, 3)))
    assert fitting.camera(1.5).height > 0.0


def travel(distance):
    """Boxes of a body of unit size that rises, and the camera that holds all of them."""
    whole, boxes = Fitting(np.eye(3)), []
    for up in np.linspace(0.0, distance, 30):
        box = np.array([0.0, up, 0.0]), np.array([1.0, up + 1.0, 1.0])
        whole.take(np.array(box))
        boxes.append(box)
    return boxes, whole.camera(1.5)


def test_a_camera_stays_where_bodies_travel_little():
    boxes, whole = travel(1.0)
    height, shifts = following(boxes, whole, 1.5)
    assert height == whole.height
    assert (shifts == 0.0).all()


def test_a_camera_follows_a_body_that_travels_far_and_holds_it():
    boxes, whole = travel(20.0)
    height, shifts = following(boxes, whole, 1.5)
    assert 1.0 < height < 0.25 * whole.height
    for (low, high), shift in zip(boxes, shifts, strict=True):
        flat = (np.array([low, high]) - whole.focus - shift)[:, :2]
        assert (np.abs(flat) < [0.75 * height, 0.5 * height]).all()
    assert (np.diff(shifts[:, 1]) > 0.0).all()
    assert np.ptp(shifts[:, 1]) < 20.0
