"""Derivatives of outputs by dual numbers: against closed forms, and by differences."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Contact,
    Coulomb,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Model,
    Motor,
    Prismatic,
    Revolute,
    RigidBody,
    Settings,
    SmoothStep,
    Spring,
    Start,
    SteadyRotation,
    UserLaw,
    simulate,
    write_model,
)
from duhamel.solver.compiler import digests
from duhamel.solver.compiler.object_file import BuildError
from duhamel.solver.couplings.friction import JointFriction
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from duhamel.solver.derivatives import records
from duhamel.solver.derivatives.family import Differentiation
from duhamel.solver.errors import DerivativeError
from duhamel.study import (
    Parameter,
    StudyError,
    fit_model,
    optimize_model,
    sensitivities,
    sensitivities_of,
)
from duhamel.study.asked_numbers import AskedNumbers
from duhamel.study.dual_slopes import DIFFERENCES_INSTEAD, _chained, _departures
from duhamel.superelement import scaled

from ..solver.frameworks import bar
from ..solver.pressing import EDGE, block
from .test_sensitivity import bouncing, height_by_stiffness, pushed


def test_the_turn_of_a_lever_by_its_torque_and_inertia():
    parameters = {"M": "loads.0.signal", "J": "bodies.lever.inertia.2"}
    outputs = {"turn": "final angle:lever:z", "rate": "final angular_velocity:lever:z"}
    found = sensitivities(pushed(), parameters, outputs, method="dual")
    np.testing.assert_allclose(found.elasticity, [[1.0, -1.0], [1.0, -1.0]], rtol=1e-11)
    assert (found.error < 1e-10 * np.abs(found.derivative)).all()
    assert found.notes == ()
    # Values are those of the run without derivatives, to the bit.
    angle = simulate(pushed()).body("lever").angular_velocity[-1, 2]
    assert found.value[1] == angle


def test_over_time_a_derivative_is_a_series():
    outputs = ["angular_velocity:lever:z", "position:lever:x"]
    found = sensitivities(pushed(), {"M": "loads.0.signal"}, outputs, method="dual")
    series = found.series["angular_velocity:lever:z"]
    np.testing.assert_allclose(series.derivative[:, 0], series.value / 3.0, atol=1e-12)
    assert not found.series["position:lever:x"].derivative.any()


def striking(stiffness=1e5, mass=1.0, speed=1.0, exponent=1.0):
    """A ball that strikes a wall once, without gravity, and flies back."""
    ball = RigidBody(mass, [1e-3] * 3, start=Start([0, 0, 1e-4], velocity=[0, 0, -speed]))
    impact = Impact(stiffness=stiffness, exponent=exponent, restitution=1.0)
    wall = Contact(
        "wall", ["ground.wall", "ball"], "plane", ball=0.0, axis=[0, 0, 1], impact=impact
    )
    return Model(
        {"ball": ball},
        contacts=[wall],
        ground_frames={"wall": Frame([0, 0, 0])},
        settings=Settings(t_end=0.012, step=1e-5, rho_inf=0.9),
    )


def test_a_strike_by_the_stiffness_of_its_contact():
    k, m, v = 1e5, 1.0, 1.0
    outputs = {"peak": "max event:wall:peak", "end": "final event:wall:end"}
    found = sensitivities(striking, {"stiffness": k}, outputs, method="dual")
    exact = [0.5 * v * np.sqrt(m / k), -0.5 * np.pi * np.sqrt(m / k) / k]
    assert abs(found.derivative[0, 0] - exact[0]) < found.error[0, 0] < 5e-3 * exact[0]
    np.testing.assert_allclose(found.derivative[1, 0], exact[1], rtol=1e-5)
    assert found.error[1, 0] < 1e-4 * abs(exact[1])
    (note,) = found.notes
    assert note.startswith("peak by stiffness: the exact derivative varies by 0.")
    assert note.endswith("differences are taken")


def test_the_error_of_a_peak_by_hertz_covers_its_miss():
    """Small steps agree there on the slope of the discrete run, to eight digits."""
    k, m, v, n = 1e7, 1.0, 1.0, 1.5
    found = sensitivities(
        lambda stiffness: striking(stiffness, m, v, n),
        {"stiffness": k},
        {"peak": "max event:wall:peak"},
        method="dual",
    )
    peak = k * ((n + 1.0) * m * v**2 / (2.0 * k)) ** (n / (n + 1.0))
    exact = peak / k * (1.0 - n / (n + 1.0))
    assert abs(found.derivative[0, 0] - exact) < found.error[0, 0] < 1e-2 * exact


def test_errors_cover_the_kinks_of_bounces():
    key = "contacts.floor.stiffness"
    found = sensitivities(bouncing(1e-4), [key], {"z": "final position:ball:z"}, method="dual")
    miss = abs(found.derivative[0, 0] - height_by_stiffness())
    assert miss < found.error[0, 0] < 0.5 * abs(height_by_stiffness())
    assert "where in their steps forces switch; differences are taken" in found.notes[0]


def sliding(coefficient=0.3, speed=1.0):
    block = RigidBody(2.0, [1e-3] * 3, start=Start(velocity=[speed, 0, 0]))
    guide = Prismatic(
        "ground", "block", [1, 0, 0], name="guide", friction=JointFriction(Coulomb(coefficient))
    )
    return Model(
        {"block": block},
        joints=[guide],
        gravity=[0, 0, -9.80665],
        settings=Settings(t_end=0.6, step=1e-4, rho_inf=0.9),
    )


def test_the_way_of_a_slide_by_its_friction():
    outputs = ["final position:block:x"]
    found = sensitivities(sliding, {"coefficient": 0.3, "speed": 1.0}, outputs, method="dual")
    exact = np.array([-1.0 / (2.0 * 0.3**2 * 9.80665), 1.0 / (0.3 * 9.80665)])
    # The scheme itself is off by half a step.
    np.testing.assert_allclose(found.derivative[0], exact, rtol=5e-4)
    assert (found.error[0] < 1e-3 * np.abs(exact)).all()


def held(tmp_path):
    """A beam on a servo, which turns it and holds it against gravity."""
    element = bar(tmp_path, 0.3)

    def make(gain=40.0, load=0.05, limit=50.0):
        weight = RigidBody(load, [1e-4] * 3, start=Start([0.3, 0.0, 0.0]))
        turn = SmoothStep((0.0, 0.3), over=(0.0, 0.03))
        return Model(
            {"arm": FlexibleBody(element, Start([0.15, 0.0, 0.0])), "weight": weight},
            joints=[
                Revolute("ground", "arm.left", [0, 1, 0], name="pivot"),
                Revolute("arm.right", "weight", [0, 0, 1], name="hand"),
            ],
            motors=[
                Motor(
                    "servo",
                    "pivot",
                    "angle",
                    reference=turn,
                    stiffness=gain,
                    damping=0.4,
                    limit=limit,
                )
            ],
            gravity=[0, 0, -9.81],
            settings=Settings(t_end=0.05, step=2e-4),
        )

    return make


def test_a_servo_with_a_flexible_arm_is_as_by_differences(tmp_path):
    parameters = {"gain": 40.0, "load": 0.05}
    outputs = ["final position:weight:z", "max |velocity:weight|"]
    make = held(tmp_path)
    dual, other = (
        sensitivities(make, parameters, outputs, method=method)
        for method in ("dual", "differences")
    )
    assert dual.notes == ()
    np.testing.assert_allclose(dual.derivative, other.derivative, rtol=1e-6)
    assert (dual.error < 1e-9 * np.abs(dual.derivative)).all()


def test_a_start_in_equilibrium_moves_with_its_parameters():
    def hanging(stiffness, mass):
        coil = Spring("coil", "point", ["ground.top", "weight"], stiffness=stiffness, rest=[0.5])
        return Model(
            {"weight": RigidBody(mass, [0.1] * 3, start=Start([0, 0, -0.6]))},
            joints=[Prismatic("ground", "weight", [0, 0, 1], name="guide")],
            springs=[coil],
            gravity=[0, 0, -9.81],
            ground_frames={"top": Frame([0, 0, 0])},
            settings=Settings(t_end=0.1, step=1e-3, start="equilibrium"),
        )

    found = sensitivities(
        hanging, {"stiffness": 200.0, "mass": 2.0}, ["final position:weight:z"], method="dual"
    )
    exact = [[2.0 * 9.81 / 200.0**2, -9.81 / 200.0]]
    np.testing.assert_allclose(found.derivative, exact, rtol=1e-7)


def test_the_stated_error_grows_where_steps_of_seeds_are_halved():
    def made(x):
        block = RigidBody(2.0 + math.sin(2e4 * (x - 1.0) + 1.0), [1.0] * 3)
        pull = Force("block", [1.0, 0.0, 0.0], Constant(3.0))
        return Model({"block": block}, loads=[pull], settings=Settings(t_end=0.1, step=1e-2))

    found = sensitivities(made, {"x": 1.0}, ["final velocity:block:x"], method="dual")
    exact = -0.3 * 2e4 * math.cos(1.0) / (2.0 + math.sin(1.0)) ** 2
    assert abs(found.derivative[0, 0] - exact) < found.error[0, 0]
    assert 64e-11 * abs(exact) <= found.error[0, 0] < 2e-8 * abs(exact)


def orbiting(k=5e3, m=0.5, w=20.0, axis=(0.0, 0.0, 1.0), x=0.0):
    """A mass on a radial spring at the end of an arm, in steady rotation."""
    arm = RigidBody(2.0, [0.1, 0.2, 0.25], {"end": Frame([0.4, 0, 0])}, Start([x, 0, 0]))
    return Model(
        {"arm": arm, "bob": RigidBody(m, [1e-3] * 3, start=Start([x + 0.4, 0, 0]))},
        joints=[
            Revolute("ground.center", "arm", axis, name="pivot"),
            Prismatic("arm.end", "bob", [1, 0, 0], name="slide"),
        ],
        springs=[Spring("leaf", "bushing", ("arm.end", "bob"), stiffness=[k, 0, 0, 0, 0, 0])],
        ground_frames={"center": Frame([x, 0, 0])},
        settings=Settings(
            t_end=2e-3,
            step=1e-5,
            start="equilibrium",
            steady_rotation=SteadyRotation(w * np.array(axis), [x, 0, 0]),
        ),
    )


STRETCH = ["final coordinate:slide:distance"]


@pytest.mark.parametrize(
    ("w", "given", "rtol"),
    [
        (20.0, {}, 1e-7),
        (20.0, {"axis": (0.0, -0.6, 0.8)}, 1e-7),
        (20.0, {"x": 1000.0}, 1e-6),
        (95.0, {}, 1e-5),
    ],
)
def test_a_start_in_steady_rotation_moves_with_its_parameters(w, given, rtol):
    """The stretch is m r w^2 / (k - m w^2), and the critical speed 100 rad/s."""
    k, m, r = 5e3, 0.5, 0.4
    found = sensitivities(
        lambda k, m, w: orbiting(k, m, w, **given),
        {"k": k, "m": m, "w": w},
        STRETCH,
        method="dual",
    )
    away = (k - m * w**2) ** 2
    exact = [-m * r * w**2 / away, r * w**2 * k / away, 2.0 * m * r * w * k / away]
    np.testing.assert_allclose(found.derivative[0], exact, rtol=rtol)


def test_the_speed_of_a_steady_rotation_may_be_zero():
    found = sensitivities(
        lambda w: orbiting(w=w), {"w": 0.0}, STRETCH, method="dual", scales={"w": 1.0}
    )
    assert abs(found.derivative[0, 0]) < 1e-12


def test_what_dual_numbers_do_not_cover_is_refused_by_name():
    def user(parameters, memory, h, c, rate):
        return parameters[0] * math.floor(c), 0.0, 0.0, 0.0

    def pulled(mass):
        body = RigidBody(mass, [0.1] * 3, start=Start([0.3, 0, 0]))
        coil = Spring("coil", "point", ["ground.post", "body"], law=UserLaw(user, [10.0]))
        post = Frame([0.0, 0.0, 0.0])
        settings = Settings(t_end=0.1, step=1e-2)
        return Model(
            {"body": body}, springs=[coil], ground_frames={"post": post}, settings=settings
        )

    told = "spring 'coil' has a law that is a function.*; take method = \"differences\""
    with pytest.raises(StudyError, match=told):
        sensitivities(pulled, {"mass": 1.0}, ["final position:body:x"], method="dual")
    with pytest.raises(StudyError, match=r"simulation\.t_end: it changes the structure"):
        sensitivities(
            pushed(),
            ["simulation.t_end"],
            ["final angle:lever:z"],
            method="dual",
            scales={"simulation.t_end": 100.0},
        )


def test_a_study_file_names_the_method(tmp_path):
    write_model(pushed(), tmp_path / "lever.toml")
    study = tmp_path / "study.toml"
    text = (
        'model = "lever.toml"\nparameters."loads.0.signal" = 3.0\n'
        'outputs.turn = "final angle:lever:z"\nsensitivity.method = "{}"\n'
    )
    study.write_text(text.format("dual"))
    found = sensitivities_of(study)
    assert found.elasticity[0, 0] == pytest.approx(1.0, rel=1e-11)
    # Of the derivative, below which rounding of the seeds may be.
    assert found.error[0, 0] == pytest.approx(1e-11 * abs(found.derivative[0, 0]), rel=1e-3)
    study.write_text(text.format("adjoint"))
    with pytest.raises(StudyError, match=r"sensitivity\.method: .*'differences' or 'dual'"):
        sensitivities_of(study)


def test_what_is_no_number_in_one_of_both_runs_is_a_miss():
    asked = SimpleNamespace(outputs={"a": "", "b": ""}, series={}, split=lambda x: (x, {}))
    slopes, plain = np.ones((2, 1)), np.array([1.0, np.nan])
    assert not _departures(asked, plain, plain, slopes, {"p": 1.0}).any()
    shares = _departures(asked, plain + 1e-8, plain, slopes, {"p": 1.0})
    np.testing.assert_allclose(shares, [5e-9, 0.0])
    for found in ([np.nan, np.nan], [1.0, 2.0]):
        with pytest.raises(DerivativeError, match="from the run without derivatives"):
            _departures(asked, np.array(found), plain, slopes, {"p": 1.0})


@pytest.mark.parametrize("logarithmic", [False, True])
def test_a_fit_by_dual_numbers_is_that_by_differences_with_fewer_runs(logarithmic):
    model = pushed()
    results = simulate(model)
    series = {
        "angular_velocity:lever:z": (
            results.time,
            1.1 * results.body("lever").angular_velocity[:, 2],
        )
    }
    parameters = {"M": Parameter("loads.0.signal", (0.1, 100.0), logarithmic=logarithmic)}
    by = {
        one: fit_model(model, parameters, series, sigma=1e-3, derivatives=one)
        for one in ("differences", "dual")
    }
    exact = 1.1 * 3.0
    assert by["dual"].values["M"] == pytest.approx(exact, rel=1e-9)
    assert by["dual"].values["M"] == pytest.approx(by["differences"].values["M"], rel=1e-8)
    deviations = [one.parameters[0].deviation for one in by.values()]
    assert deviations[1] == pytest.approx(deviations[0], rel=1e-7)
    assert by["dual"].runs < by["differences"].runs
    assert not list(by["dual"].notes)


def test_a_search_by_dual_numbers_ends_where_that_by_differences_does():
    """The least torque for a turn: M / J / 2 >= 1 within a second."""
    by = {
        one: optimize_model(
            pushed(),
            {"M": Parameter("loads.0.signal", (0.01, 100.0))},
            {"rate": "max |angular_velocity:lever:z|"},
            minimize="M**2",
            constraints={"rate**2": (4.0, None)},
            derivatives=one,
        )
        for one in ("differences", "dual")
    }
    assert all(one.converged for one in by.values())
    assert by["dual"].values["M"] == pytest.approx(by["differences"].values["M"], rel=1e-6)
    multipliers = [one.constraints[0].multiplier for one in by.values()]
    assert multipliers[1] == pytest.approx(multipliers[0], rel=1e-5)
    assert by["dual"].runs < by["differences"].runs - 8


def test_where_something_switches_fits_and_searches_take_differences():
    key = {"k": Parameter("contacts.wall.stiffness", (5e4, 2e5))}
    results = simulate(striking(1.2e5))
    series = {"velocity:ball:z": (results.time, results.body("ball").velocity[:, 2])}
    fitted = fit_model(striking(), key, series, derivatives="dual")
    assert DIFFERENCES_INSTEAD in list(fitted.notes)
    assert fitted.values["k"] == pytest.approx(1.2e5, rel=1e-3)
    found = optimize_model(
        striking(), key, {"peak": "max event:wall:peak"}, minimize="peak", derivatives="dual"
    )
    assert DIFFERENCES_INSTEAD in found.remarks
    assert found.values["k"] == pytest.approx(5e4)


def pressed(down=1e5, across=0.0, speed=0.0, friction=0.5, t_end=2e-5):
    """A block of steel that presses its lower side on a plane."""
    floor = SurfaceContact(
        "floor", ["block.low", "ground"], shape="plane", axis=[0.0, 0.0, 1.0], friction=friction
    )
    start = Start([0.0, 0.0, 0.5 * EDGE], velocity=[speed, 0.0, 0.0])
    return Model(
        {"block": FlexibleBody(block(), start)},
        surface_contacts=(floor,),
        gravity=[across, 0.0, -down],
        settings=Settings(t_end=t_end, step=1e-6, rho_inf=0.9),
    )


def by_central_differences(make, values, outputs, steps):
    """The derivatives by each parameter; steps: of parameters."""
    found = []
    for name, step in steps.items():
        ends = [simulate(make(**values | {name: values[name] + d})) for d in (step, -step)]
        high, low = (np.array([outputs(one)]).ravel() for one in ends)
        found.append((high - low) / (2.0 * step))
    return np.array(found).T


def motion_of(results):
    block = results.body("block")
    return [block.v[-1, 0], block.v[-1, 2]]


MOTION = {"x": "final velocity:block:x", "z": "final velocity:block:z"}


@pytest.mark.parametrize(("name", "output"), [("down", "z"), ("across", "x")])
def test_a_surface_that_sticks_by_gravity(name, output):
    # Without a load across nothing moves so, and its derivative alone does.
    values = {"down": 1e5, "across": 0.0}

    def make(**changed):
        return pressed(**values | changed)

    one = {name: values[name]}
    found = sensitivities(make, one, MOTION, method="dual", scales={name: 1e3})
    exact = by_central_differences(make, one, motion_of, {name: 10.0})
    row = list(MOTION).index(output)
    np.testing.assert_allclose(found.derivative[row], exact[row], rtol=1e-6)


def test_rows_of_surfaces_that_switch_are_noticed():
    def make(speed):
        return pressed(speed=speed, friction=0.3, t_end=5e-5)

    found = sensitivities(make, {"speed": 0.5}, MOTION, method="dual")
    wide = by_central_differences(make, {"speed": 0.5}, motion_of, {"speed": 5e-3})
    assert (found.error > 1e-3 * np.abs(found.derivative)).any()
    assert (np.abs(found.derivative - wide) <= found.error).all()


def struck(radius=0.1, stiffness=1.0):
    """The block strikes a sphere that is heavier."""
    start = Start([0.0, 0.0, 0.5 * EDGE + 1e-7], velocity=[0.0, 0.0, -5.0])
    sphere = RigidBody(1e3, [1e3] * 3, {"top": Frame()}, Start([1e-4, 7e-5, -radius]))
    return Model(
        {"block": FlexibleBody(scaled(block(), stiffness=stiffness), start), "sphere": sphere},
        surface_contacts=(
            SurfaceContact("floor", ["block.low", "sphere.top"], shape="sphere", radius=radius),
        ),
        settings=Settings(t_end=2e-6, step=2e-7, rho_inf=0.9),
    )


def stacked(down=1e5, stiffness=1.0):
    """The block on a plane, and another on it, which it meets by its surface."""
    model = pressed(down=down, friction=0.9)
    other = FlexibleBody(
        scaled(block(), stiffness=stiffness), Start([1e-4, 0.0, 1.5 * EDGE], velocity=[0.1, 0, 0])
    )
    between = SurfaceContact("between", ["other.low", "block.top"], friction=0.1)
    return replace(
        model,
        bodies={**model.bodies, "other": other},
        surface_contacts=(*model.surface_contacts, between),
    )


SURFACE_FORCE = {
    "force": "final normal_force:floor",
    "pressure": "final largest_pressure:floor",
    "center": "final center_of_pressure:floor:x",
}


@pytest.mark.parametrize(
    ("make", "name", "value", "share"),
    [
        (struck, "radius", 0.1, 1e-4),
        (struck, "stiffness", 1.001, 1e-4),
        (stacked, "down", 1e5, 1e-5),
        (stacked, "stiffness", 1.001, 1e-4),
    ],
)
def test_surfaces_meet_spheres_and_surfaces(make, name, value, share):
    """To the stated least error, of differences with steps within which no row switches."""
    values = {name: value}
    plain = simulate(make(**values))
    asked = AskedNumbers.of(plain, SURFACE_FORCE)
    differentiation = Differentiation(lambda one: make(**one), values, plain, asked.numbers)
    found = differentiation.at(values)
    derivative, _ = _chained(found, asked, values)
    exact = by_central_differences(make, values, asked.numbers, {name: share * value})
    np.testing.assert_allclose(derivative, exact, rtol=found.least_errors[name])
    assert found.least_errors[name] <= 8e-4


def test_models_without_surfaces_take_code_without_them(monkeypatch):
    asked = []

    def refuse(targets):
        asked.extend(targets)
        raise BuildError("not now")

    monkeypatch.setattr(records, "object_files", refuse)
    records.entry_with_derivatives.cache_clear()
    told = "cannot be built with derivatives: not now"
    turn = {"turn": "final angle:lever:z"}
    with pytest.raises(StudyError, match=told):
        sensitivities(pushed(), {"torque": "loads.0.signal"}, turn, method="dual")
    with pytest.raises(StudyError, match=told):
        sensitivities(lambda down: pressed(down=down), {"down": 1e5}, MOTION, method="dual")
    assert asked == ["derivatives-1", "derivatives-1-surfaces"]
    assert digests.key(asked[0]) != digests.key(asked[1])


def test_surfaces_that_are_open_have_no_center():
    values = {"height": 1e-3}

    def make(height):
        return replace(
            pressed(), bodies={"block": FlexibleBody(block(), Start([0.0, 0.0, EDGE + height]))}
        )

    found = sensitivities(make, values, SURFACE_FORCE, method="dual")
    assert np.isnan(found.derivative[2]).all()
    assert "center has no number in this run" in found.notes


def test_what_has_no_dual_numbers_is_refused_by_fits_and_searches():
    model = replace(pushed(), settings=replace(pushed().settings, fixed_iterations=3))
    series = {"angular_velocity:lever:z": ([0.0, 0.5], [0.0, 1.0])}
    told = 'fixed number of iterations.*take derivatives = "differences"'
    with pytest.raises(StudyError, match=told):
        fit_model(model, {"M": "loads.0.signal"}, series, derivatives="dual")
    with pytest.raises(StudyError, match=told):
        optimize_model(
            model,
            {"M": Parameter("loads.0.signal", (1.0, 4.0))},
            minimize="final angle:lever:z",
            derivatives="dual",
        )
    with pytest.raises(
        StudyError, match="derivatives: expected differences or dual, found 'exact'"
    ):
        fit_model(model, {"M": "loads.0.signal"}, series, derivatives="exact")
