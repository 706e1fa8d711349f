"""What is on stage: positions, magnification, colors, marks."""

import numpy as np
import pytest
from duhamel.view import PictureError
from duhamel.view.space.stage import Stage, magnification

from .pendulum import BEND, TIME, Pendulum, spun

TIMES = TIME[::20]


def of(stage, name):
    """The positions of a body at all times, in space."""
    number = [body.name for body in stage.bodies].index(name)
    parts = [batch.positions[number] for batch in stage.batches()]
    return np.concatenate(parts) + stage.middle


def test_points_move_as_the_results_say():
    run = Pendulum()
    stage = Stage(run, TIMES, magnify=1.0)
    X = run.outline("bar").points
    moved = X + np.array([0.5, 0.0, 0.0]) + run.outline_displacement("bar", TIMES)
    np.testing.assert_allclose(of(stage, "bar"), spun(TIMES, moved), atol=1e-6)


def test_rigid_bodies_are_never_exaggerated():
    plain = Stage(Pendulum(), TIMES, magnify=1.0)
    large = Stage(Pendulum(), TIMES, magnify=1000.0)
    np.testing.assert_allclose(of(plain, "post"), of(large, "post"), atol=1e-7)


def test_deformation_is_magnified_as_seen_from_where_the_body_hangs():
    """The root stays; the tip is off by b t 1^2 times the factor."""
    stage = Stage(Pendulum(), TIMES, magnify=50.0)
    bar, true = of(stage, "bar"), of(Stage(Pendulum(), TIMES, magnify=1.0), "bar")
    at_root = Pendulum().outline("bar").points[:, 0] < 0.0
    np.testing.assert_allclose(bar[:, at_root], true[:, at_root], atol=1e-6)
    off = np.linalg.norm(bar - true, axis=-1)[:, ~at_root]
    np.testing.assert_allclose(off, np.repeat(49.0 * BEND * TIMES[:, None], 4, axis=1), atol=1e-6)


@pytest.mark.parametrize(
    ("largest", "factor"),
    [(0.02, 1.0), (0.019, 2.0), (0.01, 5.0), (1e-3, 50.0), (3e-5, 1000.0), (0.0, 1.0), (1e-9, 1.0)],
)
def test_small_deformation_is_magnified_to_what_is_seen(largest, factor):
    assert magnification(2.0 * largest, 2.0) == factor


def test_colors_show_what_flexible_bodies_know():
    run = Pendulum()
    assert Stage(run, TIMES).field == "displacement"
    run.known = ("displacement", "velocity", "von_mises")
    assert Stage(run, TIMES).field == "von_mises"
    assert Stage(run, TIMES, field="none").field == ""


def test_the_scale_ends_at_the_largest_value_of_all_frames():
    stage = Stage(Pendulum(), TIMES, field="displacement")
    assert stage.largest == pytest.approx(BEND)  # seen from the pin


def test_an_unknown_field_is_refused_with_its_reason():
    with pytest.raises(PictureError, match="von_mises: body 'bar': no von_mises"):
        Stage(Pendulum(), TIMES, field="von_mises")
    known = "expected displacement, velocity, von_mises, pressure, none"
    with pytest.raises(PictureError, match=known):
        Stage(Pendulum(), TIMES, field="strain")


def test_a_run_without_bodies_cannot_be_drawn():
    run = Pendulum()
    run.recorded = ("frames/bar.tip",)
    with pytest.raises(PictureError, match="recorded the motion of no body"):
        Stage(run, TIMES)


def test_frames_are_the_same_in_many_batches(monkeypatch):
    whole = of(Stage(Pendulum(), TIMES), "bar")
    monkeypatch.setattr("duhamel.view.space.stage.BATCH_POINT_FRAMES", 40)
    stage = Stage(Pendulum(), TIMES)
    assert len(list(stage.batches())) > 1
    np.testing.assert_array_equal(of(stage, "bar"), whole)


def test_a_kilometer_away_nothing_is_rounded_off():
    near = of(Stage(Pendulum(), TIMES), "bar")
    far = of(Stage(Pendulum(origin=(1000.0, 0, 0)), TIMES), "bar")
    np.testing.assert_allclose(far - [1000.0, 0.0, 0.0], near, atol=1e-6)


def test_the_longest_arrow_is_the_largest_force_and_all_have_one_scale():
    stage = Stage(Pendulum(), TIMES)
    assert stage.largest_force == pytest.approx(3.0)
    lengths = [
        np.linalg.norm(mark.A[:, :, 2], axis=1) for mark in stage.marks if mark.kind == "forces"
    ]
    np.testing.assert_allclose(lengths[0] / lengths[0].max(), TIMES, atol=1e-12)


def test_a_joint_lies_where_its_body_is_and_along_its_axis():
    (joint,) = [mark for mark in Stage(Pendulum(), TIMES).marks if mark.kind == "joints"]
    np.testing.assert_allclose(joint.x[:, 2], 0.0, atol=1e-9)
    np.testing.assert_allclose(joint.A[:, :2, 2], 0.0, atol=1e-12)
    assert (joint.A[:, 2, 2] > 0.0).all()


def test_without_marks_there_are_bodies_alone():
    assert Stage(Pendulum(), TIMES, marks=False).marks == ()


def test_what_was_not_recorded_has_no_mark():
    run = Pendulum()
    run.recorded = ("bodies/post", "bodies/bar")
    assert Stage(run, TIMES).marks == ()
