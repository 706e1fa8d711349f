"""The shapes of contacts: where they are drawn, in the file as in memory, on bodies that turn."""

import numpy as np
import pytest
from duhamel import solver
from duhamel.results import Results
from duhamel.view.report.motion import motion, poses
from duhamel.view.space.stage import Stage

MODEL = """
[simulation]
t_end = 0.02
step = 1e-3

[ground.frames]
bore = {position = [0, 0, 0]}
cam = {position = [0.5, 0, 0]}
anvil = {position = [1, 0, 0]}

[bodies.wheel]
mass = 1
inertia = [0.01, 0.01, 0.01]
position = [1.5, 0, 0]
angular_velocity = [0, 40, 0]
frames.ring = {position = [0.1, 0, 0]}

[bodies.ball]
mass = 1
inertia = [0.01, 0.01, 0.01]
position = [0, 0, 0.3]

[[contacts]]
name = "rub"
between = ["ground.bore", "ball"]
shape = "cylinder"
axis = [1, 0, 0]
radius = 0.4
length = 0.2
hollow = true
ball = 0.01
stiffness = 1e4

[[contacts]]
name = "cam"
between = ["ground.cam", "ball"]
shape = "profile"
axis = [1, 0, 0]
points = [[0.2, 0.1], [0.1, 0.02], [0, 0.04], [-0.1, 0.02], [-0.2, 0.1]]
ball = 0.01
stiffness = 1e4

[[contacts]]
name = "anvil"
between = ["ground.anvil", "ball"]
shape = "sphere"
radius = 0.2
ball = 0.01
stiffness = 1e4

[[contacts]]
name = "groove"
between = ["wheel.ring", "ball"]
shape = "cylinder"
axis = [0, 0, 1]
radius = 0.05
ball = 0.01
stiffness = 1e4
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    model = tmp_path_factory.mktemp("shapes") / "model.toml"
    model.write_text(MODEL)
    solver.simulate(solver.read_model(model), output=model.with_suffix(".h5"))
    return Results.read(model.with_suffix(".h5"))


@pytest.fixture(scope="module")
def shapes(results):
    stage = Stage(results, results.time[[0, -1]])
    marks = [mark for mark in stage.marks if mark.kind == "shapes"]
    return [mark.position(slice(None)) for mark in marks]


def test_fixed_shapes_are_where_balls_meet_them(shapes):
    bore, cam, anvil, _ = shapes
    assert np.ptp(bore[..., 0]) == pytest.approx(0.2)
    np.testing.assert_allclose(np.linalg.norm(bore[..., 1:], axis=-1), 0.4)
    np.testing.assert_allclose(np.linalg.norm(anvil - [1, 0, 0], axis=-1), 0.2)
    # axis along x: e1 is y, e2 = axis x e1 is z
    for y, z in [(0.2, 0.1), (0.1, 0.02), (0, 0.04), (-0.1, 0.02), (-0.2, 0.1)]:
        assert np.linalg.norm(cam[0, :, 1:] - [y, z], axis=1).min() < 1e-12


def test_the_shape_of_a_body_turns_with_it(results, shapes):
    *_, groove = shapes
    ring = results.frame("wheel.ring")
    for row, points in zip([0, -1], groove, strict=True):
        w, _, y, _ = ring.rotation[row]
        turned = 2.0 * np.arctan2(y, w)
        axis = np.array([np.sin(turned), 0.0, np.cos(turned)])
        apart = points - ring.position[row]
        across = apart - np.outer(apart @ axis, axis)
        np.testing.assert_allclose(np.linalg.norm(across, axis=1), 0.05, rtol=1e-9)
    assert np.abs(groove[1] - groove[0]).max() > 0.05


def test_reports_show_the_same_shapes(results, shapes):
    marks = [mark for mark in motion(results).moving.marks if mark.kind == "shapes"]
    for mark, points in zip(marks, shapes, strict=True):
        pose = poses(mark.x, mark.A)[-1]
        placed = mark.glyph.points @ pose[:3, :3].T + pose[:3, 3]
        np.testing.assert_allclose(placed, points[-1], atol=1e-9)


def test_in_memory_they_are_as_in_the_file(results):
    again = solver.simulate(solver.read_model(results.name.replace(".h5", ".toml")))
    for ours, theirs in zip(again.couplings, results.couplings, strict=True):
        for name in ("radius", "length", "across", "curve"):
            found, expected = getattr(theirs.shape, name), getattr(ours.shape, name)
            np.testing.assert_array_equal(found, expected)
