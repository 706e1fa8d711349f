"""Mechanisms in Python are model files in other words."""

import doctest
import importlib
import inspect
import pickle
import pkgutil

import duhamel
import duhamel as du
import numpy as np
import pytest
from duhamel import solver, superelement
from duhamel.results import QuantityError
from duhamel.results.quantities import evaluate

STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)


def beam() -> du.Superelement:
    points = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 6)
    section = du.Section.rectangle(STEEL, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    part = du.Beam(points, section=section, name="beam")
    part.interface("root", points[0])
    part.interface("tip", points[-1])
    return part.superelement(step=1e-4, duration=1e-3)


@pytest.fixture(scope="module")
def element() -> du.Superelement:
    return beam()


def pendulum(element, **more) -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, 0.0, -9.81])
    hub = m.add(du.RigidBody(2.0, [0.01] * 3, {"rim": [0.1, 0.0, 0.0]}), name="hub", **more)
    rod = m.add(element, name="rod", place={"root": hub["rim"]})
    hinge = m.add(du.joints.Revolute(m.ground, hub, axis="y", name="hinge"))
    m.add(du.joints.Fixed(hub["rim"], rod["root"]))
    m.add(du.loads.Force(rod["tip"], "z", du.signals.HalfSine(50.0, 1e-3)))
    m.add(du.springs.torsion(m.ground, hub, "y", stiffness=5.0, name="spring"))
    m.add(du.stops.stop(hinge, "angle", (-0.5, 0.5), stiffness=1e4), name="stop")
    m.add(du.motors.drive(hinge, "angle", du.signals.Constant(0.1), limit=1.0, name="motor"))
    return m


MODEL = """
[simulation]
t_end = 0.02
gravity = [0.0, 0.0, -9.81]

[bodies.hub]
mass = 2.0
inertia = [0.01, 0.01, 0.01]
frames.rim = {position = [0.1, 0.0, 0.0]}

[bodies.rod]
superelement = "rod.h5"
place = {frame = "root", on = "hub.rim"}

[[joints]]
type = "revolute"
name = "hinge"
between = ["ground", "hub"]
axis = [0.0, 1.0, 0.0]

[[joints]]
type = "fixed"
between = ["hub.rim", "rod.root"]

[[loads]]
type = "force"
on = "rod.tip"
direction = [0.0, 0.0, 1.0]
signal = {half_sine = 50.0, duration = 1e-3}

[[springs]]
name = "spring"
type = "torsion"
between = ["ground", "hub"]
axis = [0.0, 1.0, 0.0]
stiffness = 5.0

[[stops]]
name = "stop"
joint = "hinge"
coordinate = "angle"
range = [-0.5, 0.5]
stiffness = 1e4

[[motors]]
name = "motor"
joint = "hinge"
coordinate = "angle"
torque = 0.1
limit = 1.0
"""


def same(a: solver.Results, b: solver.Results) -> None:
    for body in a.bodies:
        np.testing.assert_array_equal(a.body(body).x, b.body(body).x)
        np.testing.assert_array_equal(a.body(body).v, b.body(body).v)
    np.testing.assert_array_equal(a.energy.kinetic, b.energy.kinetic)


def test_a_mechanism_moves_as_its_model_file(element, tmp_path):
    superelement.write(element, tmp_path / "rod.h5")
    (tmp_path / "model.toml").write_text(MODEL)
    expected = solver.simulate(solver.read_model(tmp_path / "model.toml"))
    same(pendulum(element).simulate(0.02).results, expected)
    same(du.Mechanism.read(tmp_path / "model.toml").simulate().results, expected)


def test_a_mechanism_is_written_with_its_superelements_and_settings(element, tmp_path):
    m = pendulum(element)
    run = m.simulate(0.01, step=5e-5, rho_inf=0.8)
    m.write(tmp_path / "pendulum.toml")
    assert (tmp_path / "pendulum-rod.h5").is_file()
    again = du.Mechanism.read(tmp_path / "pendulum.toml")
    assert again.settings.rho_inf == 0.8
    assert m.settings.rho_inf is None
    same(again.simulate().results, run.results)


def test_a_simulation_leaves_no_settings_to_the_next(element):
    m = pendulum(element)
    first = m.simulate(2e-3)
    m.simulate(1e-3, step=2.5e-5, rho_inf=0.5)
    same(m.simulate(2e-3).results, first.results)
    assert m.check(1e-3).step == pytest.approx(1e-4)
    assert m.check(1e-3, step=5e-5).step == pytest.approx(5e-5)


def test_a_model_does_not_change_with_its_mechanism(element):
    m = pendulum(element)
    model = m.model()
    m.add(du.RigidBody(1.0, [1.0] * 3), name="late")
    assert set(model.bodies) == {"hub", "rod"}


def test_handles_name_bodies_frames_and_couplings(element):
    m = pendulum(element)
    assert repr(m["rod"]) == "<body 'rod', frames: root, tip>"
    assert m["rod"]["tip"].frame_name == "rod.tip"
    assert m["hinge"].type == "revolute"
    assert m["fixed 1"].between == ("hub.rim", "rod.root")
    wall = m.ground.frame("wall", [0.0, 0.0, 1.0])
    assert wall == m.ground["wall"]
    assert m.add(du.RigidBody(1.0, [1.0] * 3)).name == "body1"
    assert m.add(element).name == "beam"
    assert repr(m).startswith("<Mechanism: bodies hub, rod, body1, beam; 2 joints; 1 spring;")


def test_a_run_has_its_parts_by_name_and_by_handle(element):
    m = pendulum(element)
    run = m.simulate(0.01)
    results = run.results
    np.testing.assert_array_equal(run["hinge"].angle, results.joint("hinge").angle)
    np.testing.assert_array_equal(run[m["hinge"]].angle, results.joint("hinge").angle)
    np.testing.assert_array_equal(run["rod.tip"].u, results.frame("rod.tip").u)
    np.testing.assert_array_equal(run[m["rod"]["tip"]].u, results.frame("rod.tip").u)
    np.testing.assert_array_equal(run[m["rod"]].x, results.body("rod").x)
    assert run["stop"].gap.shape == run["motor"].torque.shape == run.time.shape
    with pytest.raises(QuantityError, match=r"; did you mean run\['hinge'\].angle\? there are: "):
        run["hinge.angle"]
    with pytest.raises(QuantityError, match=r"; did you mean run\['rod.tip'\].u\? there are: "):
        run["rod.tip.u.x"]
    with pytest.raises(QuantityError, match=r"nothing is named 'hinge.angel'; there are: "):
        run["hinge.angel"]
    with pytest.raises(QuantityError, match=r"nothing is named 'leg'; there are: .*hinge.*rod.tip"):
        run["leg"]


@pytest.mark.parametrize(
    ("words", "quantity"),
    [
        ("hinge.angle", "coordinate:hinge:angle"),
        ("hinge.angle_rate", "coordinate:hinge:angle_rate"),
        ("hinge.force.x", "force:hinge:x"),
        ("rod.tip.elastic_displacement.z", "elastic_displacement:rod.tip:z"),
        ("hub.angle.y", "angle:hub:y"),
        ("energy.kinetic", "energy:kinetic"),
        ("angular_velocity:hub:y", "angular_velocity:hub:y"),
    ],
)
def test_quantities_are_named_by_owner_and_attribute(element, words, quantity):
    run = pendulum(element).simulate(1e-3)
    assert run._quantity(words) == quantity
    assert run.plot(words).figure.axes
    if words != quantity:
        with pytest.raises(QuantityError, match=f"did you mean '{quantity}'"):
            evaluate(run.results, words)
    with pytest.raises(QuantityError, match="nothing is named so"):
        run.plot("leg.angle")


def test_pictures_are_saved_and_shown_in_notebooks(element, tmp_path):
    run = pendulum(element).simulate(5e-3)
    picture = run.plot("hinge.angle", "rod.tip.elastic_displacement.z, rod.root.position.z")
    assert picture.save(tmp_path / "run.png").stat().st_size > 10_000
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert run.plot().figure.axes
    found = run.peaks("hinge.angle")
    assert [peak.quantity for peak in found] == ["coordinate:hinge:angle"]
    assert str(found).startswith("quantity ")
    assert "coordinate:hinge:angle  rad " in str(found)


def test_a_mechanism_is_drawn_at_its_start(element, tmp_path):
    pytest.importorskip("pyvista")
    m = pendulum(element)
    assert m.draw(tmp_path / "start.png").stat().st_size > 5_000
    shown = m._repr_html_()
    assert shown.startswith('<img src="data:image/png;base64,')
    assert "rod" in shown
    assert du.Mechanism()._repr_html_() == "<p>Mechanism without bodies</p>"


def test_linear_analyses_are_those_of_the_model(element):
    m = du.Mechanism()
    rod = m.add(element, name="rod")
    m.add(du.joints.Fixed(m.ground, rod["root"]))
    first = m.modes(3).frequencies[0]
    E, rho, height = 210e9, 7850.0, 0.01
    clamped = 1.875104**2 / (2.0 * np.pi) * np.sqrt(E * height**2 / 12.0 / rho)
    assert first == pytest.approx(clamped, rel=2e-4)
    response = m.frf(["force:rod.tip:z"], ["rod.tip.position.z"], [1e-3])
    EI = E * 0.02 * height**3 / 12.0
    assert abs(response.values.ravel()[0]) == pytest.approx(1.0 / (3.0 * EI), rel=1e-3)
    assert m.check().constraints == 6


def test_a_campbell_diagram_turns_about_the_axis_asked_for(element):
    m = du.Mechanism()
    rod = m.add(element, name="rod")
    m.add(du.joints.Fixed(m.ground, rod["root"]))
    with pytest.raises(solver.ModelError):
        m.campbell([0.0, 10.0])  # what is fixed in space does not turn
    m = du.Mechanism()
    hub = m.add(du.RigidBody(1.0, [1.0] * 3, {"rim": [0.1, 0.0, 0.0]}), name="hub")
    rod = m.add(element, name="rod", place={"root": hub["rim"]})
    m.add(du.joints.Revolute(m.ground, hub, "z"))
    m.add(du.joints.Fixed(hub["rim"], rod["root"]))
    diagram = m.campbell([0.0, 1.0, 2.0], "z", n=2)
    assert list(diagram.spins) == [0.0, 1.0, 2.0]


def test_a_simulator_steps_the_same_motion(element):
    m = pendulum(element)
    run = m.simulate(1e-3)
    with m.simulator(["joints/hinge/angle"], 1e-3) as simulator:
        for _ in range(10):
            simulator.step([])
        assert simulator.outputs[0] == run["hinge"].angle[-1]


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda m: m["rod"]["leg"], "no frame 'leg' on 'rod'; it has: root, tip"),
        (lambda m: m.ground["wall"], "no frame 'wall' on 'ground'; it has: none"),
        (lambda m: m["leg"], "nothing is named 'leg'; there are: hub, rod, hinge"),
        (lambda m: m.add(du.RigidBody(1.0, [1.0] * 3), name="hub"), "named 'hub' is there already"),
        (
            lambda m: m.add(du.RigidBody(1.0, [1.0] * 3), name="hinge"),
            "'hinge' is there already, and",
        ),
        (
            lambda m: m.add(du.joints.Fixed(m.ground, m["hub"], name="rod")),
            "'rod' is there already",
        ),
        (lambda m: m.add(du.RigidBody(1.0, [1.0] * 3), name="ground"), "cannot be named 'ground'"),
        (lambda m: m.add(du.joints.Fixed(m.ground, m["hub"], name="hinge")), "'hinge' is there"),
        (lambda m: m.add(du.joints.Revolute(m.ground, m["hub"], "q")), "axis: expected three"),
        (lambda m: m.add(du.joints.Fixed(m.ground, 3.0)), "frame_b: expected the name of a frame"),
        (lambda m: m.add(m["hinge"], name="h", velocity=[1, 0, 0]), "expected no start, found vel"),
        (lambda m: m.add(3.0), "expected a Superelement, a RigidBody, or a joint"),
        (lambda m: m.add("no.h5"), "no.h5"),
        (lambda m: m.add(m["rod"].body, place={"root": m["hub"], "tip": m["hub"]}), "{FRAME: fr"),
        (lambda m: m.simulate(1.0, stepp=1.0), "unknown setting 'stepp'; known are t_end, step"),
        (lambda m: m.simulate(-1.0), "t_end: expected a positive time"),
    ],
)
def test_what_cannot_be_is_one_line(element, spoil, message):
    m = pendulum(element)
    with pytest.raises(ValueError) as failure:  # noqa: PT011 - its words are compared below
        spoil(m)
    assert message in str(failure.value)
    assert "\n" not in str(failure.value)


def test_a_handle_of_another_mechanism_is_refused(element):
    m, other = pendulum(element), pendulum(element)
    wall = other.ground.frame("wall")
    m.ground.frame("wall")
    stop = {"stiffness": 1e4, "name": "second"}
    named = pytest.raises(solver.ModelError, match=r"is of another mechanism, <Mechanism: bodies")
    for foreign in (
        lambda: m.add(du.joints.Fixed(m["hub"], other["rod"]["tip"], name="weld")),
        lambda: m.add(du.joints.Fixed(wall, m["rod"]["tip"], name="weld")),
        lambda: m.add(du.loads.Force(other["hub"], "z", du.signals.Constant(1.0))),
        lambda: m.add(du.stops.stop(other["hinge"], "angle", (-1.0, 1.0), **stop)),
        lambda: m.add(element, name="blade", place={"root": other["hub"]["rim"]}),
    ):
        with named:
            foreign()
    # Names are those of any mechanism, and so is what has names alone.
    load = du.loads.Force("rod.tip", "z", du.signals.Constant(1.0))
    assert m.add(other.add(load)).on == "rod.tip"
    assert pickle.loads(pickle.dumps(m.model())).joints[0].name == "hinge"


def test_joints_show_what_they_take():
    assert list(inspect.signature(du.joints.Prismatic).parameters)[:4] == [
        "frame_a",
        "frame_b",
        "axis",
        "name",
    ]
    assert list(inspect.signature(solver.Joint).parameters)[:2] == ["name", "type"]


def test_a_part_is_no_body_yet():
    part = du.Beam([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], section=du.Section.circle(STEEL, 0.01))
    with pytest.raises(solver.ModelError, match="part 'beam': expected its superelement"):
        du.Mechanism().add(part)


def test_the_top_level_is_small_and_complete():
    assert len(duhamel.__all__) <= 28
    assert set(duhamel.__all__) < set(dir(duhamel))
    for name in duhamel.__all__:
        assert getattr(duhamel, name).__doc__, name
    with pytest.raises(AttributeError, match="module 'duhamel' has no attribute 'Prat'"):
        duhamel.Prat  # noqa: B018


@pytest.mark.parametrize(
    "module",
    [
        found.name
        for found in pkgutil.iter_modules(duhamel.__path__)
        if not found.ispkg and not found.name.startswith("__")
    ],
)
def test_examples_in_docstrings_run(module):
    assert doctest.testmod(importlib.import_module(f"duhamel.{module}")).failed == 0
