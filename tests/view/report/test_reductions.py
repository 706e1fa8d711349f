"""What a report leaves out, and what it must not."""

from itertools import pairwise

import numpy as np
import pytest
from duhamel import solver
from duhamel.results.motion import BodyMotion, FrameMotion
from duhamel.superelement.figures import sphere
from duhamel.view.report.motion import WANTED_TURN, motion
from duhamel.view.report.plots import drawing, plots
from duhamel.view.report.scene import movements, scene
from duhamel.view.report.simplify import simplified
from duhamel.view.report.thinning import kept
from duhamel.view.space.stage import Stage

from .conftest import EVIL, MODEL

AWAY = np.array([1e6, 0.0, 0.0])


def test_thinned_series_keep_every_extreme():
    values = np.random.default_rng(1).normal(size=100_003)
    points = kept(values, 500)
    assert len(points) <= 2 * 500 + 2
    assert (np.diff(points) > 0).all()
    edges = np.linspace(0, len(values), 501).astype(int)
    for first, last in pairwise(edges):
        chosen = values[points[(points >= first) & (points < last)]]
        assert chosen.min() == values[first:last].min()
        assert chosen.max() == values[first:last].max()


def test_short_series_keep_all_points():
    assert kept(np.zeros(40), 20).tolist() == list(range(40))


def test_series_with_gaps_keep_their_extremes():
    values = np.sin(np.arange(10_000.0))
    values[2000:5000] = np.nan
    points = kept(values, 100)
    assert np.nanmax(values[points]) == np.nanmax(values)
    assert np.nanmin(values[points]) == np.nanmin(values)


def test_a_single_step_of_a_million_is_not_lost_in_a_plot(results):
    for _, group in plots(results):
        for plot in group:
            drawn = drawing(plot, results.time)
            for curve, line in zip(plot.curves, drawn["curves"], strict=True):
                shown = [y for y in line["y"] if y is not None]
                assert max(shown) == pytest.approx(np.nanmax(curve.values), rel=1e-6)


def test_titles_name_in_words_what_the_run_has(results):
    titles = {plot.title for _, group in plots(results) for plot in group}
    assert any(title.startswith("force of joints") for title in titles)
    assert not {title for title in titles if "_" in title or "surface" in title}


def test_simplified_surfaces_stay_where_they_were():
    ball = sphere(1.0)
    points = np.vstack([ball.points, ball.points + np.array([3.0, 0, 0])])
    triangles = np.vstack([ball.triangles, ball.triangles + len(ball.points)])
    numbers, few = simplified(points, triangles, 200)
    assert len(numbers) <= 200
    corners = points[numbers][few]
    assert corners.min() == pytest.approx(-1.0, abs=0.15)
    a, b, c = corners.transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert volume == pytest.approx(2 * ball.volume, rel=0.2)


def test_a_thin_plate_keeps_both_its_sides():
    n = 40
    x, y = (axis.ravel() for axis in np.meshgrid(*2 * [np.linspace(0, 1, n)]))
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    quads = np.column_stack([first, first + 1, first + n + 1, first + n])
    triangles = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    top = np.column_stack([x, y, np.full(n * n, 1e-3)])
    points = np.vstack([top, top - [0, 0, 1e-3]])
    both = np.vstack([triangles, triangles[:, ::-1] + n * n])
    numbers, few = simplified(points, both, 300)
    assert len(numbers) <= 300
    assert len(set(points[numbers][few][..., 2].ravel())) == 2
    a, b, c = points[numbers][few].transpose(1, 0, 2)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    assert area == pytest.approx(2.0, rel=0.2)


def test_points_of_the_animation_are_those_of_a_film(results):
    shown = motion(results)
    times = shown.deforming.times
    stage = Stage(results, times)
    assert shown.moving.magnification == stage.magnification > 1.0
    (beam,) = [shape for shape in shown.shapes if shape.name == "beam"]
    where = [int(np.abs(shown.time - t).argmin()) for t in times]
    poses = beam.poses[where]
    placed = np.einsum("kij,kpj->kpi", poses[:, :3, :3], beam.points + beam.u)
    (body,) = [body for body in stage.bodies if body.name == "beam"]
    expected = body.position(slice(0, len(times)), stage.magnification)
    numbers, _ = simplified(
        results.outline("beam").points, results.outline("beam").triangles, 10**6
    )
    np.testing.assert_allclose(placed + poses[:, None, :3, 3], expected[:, numbers], atol=1e-12)


def test_deformations_are_enlarged_until_they_are_seen(results):
    shown = motion(results)
    (beam,) = [shape for shape in shown.shapes if shape.name == "beam"]
    assert shown.moving.magnification > 1.0
    size = np.ptp(beam.points, axis=0).max()
    assert 0.01 * size < np.linalg.norm(beam.u, axis=-1).max() <= 0.04 * size


def test_the_scale_ends_at_the_largest_value_of_all(results):
    shown = motion(results, "displacement")
    times = shown.deforming.times
    stage = Stage(results, times, "displacement")
    (body,) = [body for body in stage.bodies if body.name == "beam"]
    largest = body.values(slice(0, len(times)), "displacement").max()
    assert shown.largest == pytest.approx(largest, rel=1e-12)


def test_marks_stand_at_their_frames_on_bodies_as_they_are_drawn(results):
    shown = motion(results)
    named = dict(shown.named)
    rim = results.frame("hub.rim").position
    rows = np.searchsorted(results.time, shown.time)
    np.testing.assert_allclose(named["clamp"], rim[rows], atol=1e-12)
    assert set(named) >= {"clamp", EVIL}
    *_, clamp = [mark for mark in shown.moving.marks if mark.kind == "joints"]
    np.testing.assert_allclose(clamp.x, named["clamp"], atol=1e-12)


def test_marks_that_are_not_seen_can_be_inverted(results):
    """An arrow without a force is of size 0, which K3D would turn by what is no number."""
    shown = motion(results)
    marks = shown.moving.marks
    moved = [*movements(shown)][-len(marks) :]
    arrows = [number for number, mark in enumerate(marks) if mark.kind == "forces"]
    assert any((marks[number].A == 0.0).all(axis=(1, 2)).any() for number in arrows)
    for number in arrows:
        assert (np.linalg.det(moved[number].matrices.astype(np.float32)) > 0.0).all()


def test_marks_move_at_all_instants_where_a_large_body_deforms_at_fewer(results, monkeypatch):
    every = motion(results)
    monkeypatch.setattr(
        "duhamel.view.report.motion.MAX_POINT_INSTANTS", 30 * len(every.shapes[1].points)
    )
    few = motion(results)
    assert len(few.deforming.times) == 30 < len(few.time) == len(every.time)
    assert few.moving.magnification == every.moving.magnification
    for mark, same in zip(few.moving.marks, every.moving.marks, strict=True):
        np.testing.assert_allclose(mark.x, same.x, atol=1e-12)


def test_far_from_the_origin_positions_keep_their_precision(results):
    moved = _Moved(results)
    near, far = motion(results), motion(moved)
    assert np.linalg.norm(far.origin - AWAY) < 1.0
    at_origin = [shape.poses[:, :3, 3] for shape in near.shapes]
    there = [shape.poses[:, :3, 3] + far.origin - AWAY for shape in far.shapes]
    np.testing.assert_allclose(there, at_origin, atol=1e-9)
    assert np.abs(far.box).max() < 2.0


class _Moved:
    """Results a thousand kilometers along x."""

    def __init__(self, results):
        self._results = results

    def __getattr__(self, name):
        return getattr(self._results, name)

    def body(self, name):
        motion = self._results.body(name)
        return BodyMotion(vars(motion) | {"x": motion.x + AWAY})

    def frame(self, name):
        motion = self._results.frame(name)
        return FrameMotion(vars(motion) | {"position": motion.position + AWAY})


def test_a_run_of_one_step_has_a_scene(beam_file):
    model = beam_file.with_name("short.toml")
    model.write_text(MODEL.replace("t_end = 0.03", "t_end = 1e-9\nstep = 1e-9"))
    shown = motion(solver.simulate(solver.read_model(model)))
    assert len(shown.time) == 2
    assert len(scene(shown)) > 1000


def test_a_fast_wheel_has_more_instants_than_a_slow_one(results):
    slow = motion(results)
    spinning = _Spinning(results)
    fast = motion(spinning)
    assert len(fast.time) > 2 * len(slow.time)
    assert fast.turn < 2 * WANTED_TURN


class _Spinning(_Moved):
    """Results whose bodies turn fast."""

    def body(self, name):
        motion = self._results.body(name)
        return BodyMotion(vars(motion) | {"v": motion.v + np.array([0, 0, 0, 0, 0, 3000.0])})

    frame = property(lambda self: self._results.frame)
