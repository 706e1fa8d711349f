"""Runs with dual numbers: derivatives of all that is recorded, against differences of runs."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    SteadyRotation,
    UserLaw,
    simulate,
)
from duhamel.solver.derivatives.run import recorded_rows, run_with_derivatives
from duhamel.solver.derivatives.scope import check_scope, has_kinks
from duhamel.solver.derivatives.seeds import seeds_of, start_of
from duhamel.solver.errors import DerivativeError
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.lower.lower import lower
from duhamel.solver.step.loop import advance
from duhamel.solver.step.record import record
from duhamel.solver.step.system import Output, Run
from duhamel.superelement.parameters import scaled

from ..study.test_sensitivity import bouncing
from .compiler import every_part
from .frameworks import bar

NAMES = tuple(name for name, (_, kind) in Output.layout.items() if kind.dtype == np.float64)


def plain(model):
    """All numbers that a run records, by name."""
    start = start_of(model, recorded_rows)
    output = make_output(start.lowered, start.lowered.n_steps + 1)
    initial = start.initial
    run = Run(system=initial.lowered.system, state=initial.state, work=initial.work, output=output)
    record(run, 0)
    advance(run, start.inputs)
    return {name: getattr(output, name) for name in NAMES}


def with_derivatives(make, values):
    start = start_of(make(**values), recorded_rows)

    def seeds(name):
        start_at = partial(_start_by, partial(make, **values), name)
        return seeds_of(start, start_at, name, values[name], abs(values[name]) or 1.0)

    return run_with_derivatives(start, [seeds(name) for name in values], NAMES).arrays


def every_part_of(gravity=9.81, stiffness=1.0, push=20.0, mass=1.5):
    """The model of every kind of part, functions of users included."""
    model = every_part.make_model()
    springs = [
        replace(spring, stiffness=stiffness * np.asarray(spring.stiffness))
        for spring in model.springs
    ]
    bodies = dict(model.bodies)
    bodies["spherical"] = replace(bodies["spherical"], mass=mass)
    loads = (Force("modal.i1", [1.0, -2.0, 0.5], Constant(push)), *model.loads[1:])
    return replace(model, bodies=bodies, springs=springs, loads=loads, gravity=[0.0, 0.0, -gravity])


@pytest.fixture(scope="module")
def of_every_part():
    return with_derivatives(every_part_of, {"gravity": 9.81, "stiffness": 1.0, "push": 20.0})


def test_values_are_those_of_the_plain_run(of_every_part):
    for name, values in plain(every_part_of()).items():
        found = of_every_part[name][..., 0]
        np.testing.assert_allclose(
            found, values, rtol=1e-8, atol=1e-9 * np.abs(values).max(initial=0.0), err_msg=name
        )


@pytest.mark.parametrize(
    ("number", "parameter", "value"),
    [(0, "gravity", 9.81), (1, "stiffness", 1.0), (2, "push", 20.0)],
)
def test_derivatives_of_every_part_are_those_of_differences(
    of_every_part, number, parameter, value
):
    """All joints, springs, laws, motors and couplers, both histories, in space."""
    step = 1e-4 * value
    above, below = (plain(every_part_of(**{parameter: value + d})) for d in (step, -step))
    for name in NAMES:
        expected = (above[name] - below[name]) / (2.0 * step)
        found = of_every_part[name][..., 1 + number]
        largest = np.abs(expected).max(initial=0.0)
        rounding = 1e-13 * np.abs(above[name]).max(initial=0.0) / step
        np.testing.assert_allclose(
            found, expected, atol=2e-5 * largest + 1e3 * rounding, err_msg=name
        )


def test_one_derivative_is_the_first_of_four(of_every_part):
    alone = with_derivatives(every_part_of, {"gravity": 9.81})
    for name in NAMES:
        expected = of_every_part[name][..., 1]
        np.testing.assert_allclose(
            alone[name][..., 1],
            expected,
            rtol=1e-8,
            atol=1e-8 * np.abs(expected).max(initial=0.0),
            err_msg=name,
        )


def test_derivatives_go_on_where_the_motion_rests(tmp_path):
    """Newton's method ends by values, of which a load of no size across a beam moves none."""
    element = bar(tmp_path, 0.3)

    def beam(side):
        spin = Start(angular_velocity=[0.0, 30.0, 0.0])
        load = Force("beam.right", [0.0, 1.0, 0.0], Constant(side))
        return Model(
            {"beam": FlexibleBody(element, spin)},
            loads=[load],
            settings=Settings(t_end=0.04, step=2e-4),
        )

    found = with_derivatives(beam, {"side": 0.0})
    above, below = plain(beam(1e-3)), plain(beam(-1e-3))
    for name in ("body_position", "body_velocity", "frame_position"):
        expected = (above[name] - below[name]) / 2e-3
        assert np.abs(expected).max() > 1e-4
        np.testing.assert_allclose(
            found[name][..., 1], expected, atol=1e-6 * np.abs(expected).max(), err_msg=name
        )


def test_a_spinning_bar_with_terms_of_second_order_is_as_by_differences(tmp_path):
    element = bar(tmp_path, 0.3, rotation=True)

    def make(spin):
        start = Start(angular_velocity=[0.0, 0.0, spin])
        load = Force("beam.right", [0.0, 0.3, 1.0], Constant(0.5), follower=True)
        return Model(
            {"beam": FlexibleBody(element, start)},
            loads=[load],
            settings=Settings(t_end=0.02, step=2e-4),
        )

    found = with_derivatives(make, {"spin": 40.0})
    above, below = plain(make(40.004)), plain(make(39.996))
    for name in ("body_position", "body_velocity", "frame_elastic_displacement"):
        expected = (above[name] - below[name]) / 8e-3
        np.testing.assert_allclose(
            found[name][..., 1], expected, atol=1e-5 * np.abs(expected).max(), err_msg=name
        )


def test_a_lamina_has_the_derivative_of_the_side_on_which_it_is_valid():
    def spinning(inertia):
        flat = RigidBody(1.0, [0.1, 0.2, inertia], start=Start(angular_velocity=[1.0, 2.0, 3.0]))
        return Model({"flat": flat}, settings=Settings(t_end=0.1, step=1e-3))

    found = with_derivatives(spinning, {"inertia": 0.3})["body_angular_velocity"][-1, 0, :, 1]
    ends = [plain(spinning(0.3 - d))["body_angular_velocity"][-1, 0] for d in (0.0, 1e-4, 2e-4)]
    expected = (3.0 * ends[0] - 4.0 * ends[1] + ends[2]) / 2e-4
    np.testing.assert_allclose(found, expected, rtol=1e-5)
    start = start_of(spinning(0.3), recorded_rows)
    seeds = seeds_of(start, lambda x: start_of(spinning(x), recorded_rows), "inertia", 0.3, 0.3)
    assert seeds.one_sided == -1


def test_what_changes_more_than_numbers_is_refused():
    def falling(step=1e-2, t_end=0.1, bodies=1.0):
        body = RigidBody(1.0, [1.0, 1.0, 1.0], frames={"top": Frame([0, 0, bodies])})
        return Model({"body": body}, settings=Settings(t_end=t_end, step=step))

    for name, value in (("step", 1e-2), ("t_end", 0.1)):
        make = partial(_start_by, falling, name)
        with pytest.raises(DerivativeError, match=f"{name}: it changes the structure or the steps"):
            seeds_of(make(value), make, name, value, 100.0 * value)


def _start_by(make, name, value):
    return start_of(make(**{name: value}), recorded_rows)


def seeds_by_mass(mass):
    """Seeds of a body of mass(x) at x = 1."""

    def start(x):
        body = RigidBody(mass(x - 1.0), [1.0, 1.0, 1.0])
        settings = Settings(t_end=0.1, step=1e-2)
        return start_of(Model({"body": body}, settings=settings), recorded_rows)

    return seeds_of(start(1.0), start, "x", 1.0, 1.0)


@pytest.mark.parametrize(
    "change",
    [
        abs,
        lambda d: abs(d - 3e-5),
        lambda d: 0.01 * abs(d + 1.3e-4),
        lambda d: max(d, 0.0),
        lambda d: 1e-4 * (d > 0.0),
        lambda d: 1e-4 * (d > -1.7e-4),
        lambda d: 1e-4 * (d == 0.0),
    ],
)
def test_a_kink_or_a_jump_at_or_beside_the_value_is_noticed(change):
    with pytest.raises(
        DerivativeError, match=r"kink or a jump at or beside its value \(system/bodies/mass"
    ):
        seeds_by_mass(lambda d: 1.0 + d + change(d))


@pytest.mark.parametrize("slope", [0.0, 1e-3])
def test_what_is_smooth_may_be_stationary(slope):
    seeds = seeds_by_mass(lambda d: 2.0 + slope * d + d**2 + 5.0 * d**3)
    found = seeds.arrays["system"]["bodies/mass"]
    np.testing.assert_allclose(found, slope, atol=1e-10)


def agree(make, values, steps, reads):
    """Check values of a run with derivatives, and these against central differences.

    steps: of each parameter, of its value; reads: of results, by the names of arrays.
    """
    found = with_derivatives(make, values)
    run = simulate(make(**values))
    for name, read in reads.items():
        expected = read(run)
        size = np.abs(expected).max()
        np.testing.assert_allclose(found[name][..., 0], expected, atol=1e-10 * size, err_msg=name)
    for number, (parameter, value) in enumerate(values.items()):
        d = steps * value
        ends = [simulate(make(**{**values, parameter: value + end})) for end in (d, -d)]
        for name, read in reads.items():
            expected = (read(ends[0]) - read(ends[1])) / (2.0 * d)
            size = np.abs(expected).max()
            derivative = found[name][..., 1 + number]
            np.testing.assert_allclose(
                derivative, expected, atol=2e-6 * size, err_msg=f"{name} by {parameter}"
            )


def of_bodies(*names):
    return {
        "body_position": lambda run: np.stack([run.body(n).position for n in names], axis=1),
        "body_velocity": lambda run: np.stack([run.body(n).velocity for n in names], axis=1),
    }


def displacement(run):
    frames = ("beam.right", "beam.left")
    return np.stack([run.frame(name).elastic_displacement for name in frames], axis=1)


def branch(parameters, memory, h, c, rate):
    """Stiffness and time of relaxation; it remembers deformation and force."""
    k, tau = parameters[0], parameters[-1]
    x = h / tau
    decay = np.exp(-x)
    slope = k if x == 0.0 else k * (1.0 - decay) / x
    force = decay * memory[1] + slope * (c - memory[0])
    return force, slope, 0.0, 0.5 * force**2 / k


def remember(parameters, memory, h, c, rate):
    k, tau = parameters[0], parameters[-1]
    x = h / tau
    decay = np.exp(-x)
    slope = k if x == 0.0 else k * (1.0 - decay) / x
    memory[1] = decay * memory[1] + slope * (c - memory[0])
    memory[0] = c


def pulled(*laws, mass=2.0, t_end=0.2):
    body = RigidBody(mass, [0.1] * 3, start=Start([0.3, 0, 0], velocity=[1.0, 0.0, 0.4]))
    coil = Spring("coil", "point", ["ground.post", "body"], law=laws)
    return Model(
        {"body": body},
        springs=[coil],
        ground_frames={"post": Frame([0.0, 0.0, 0.0])},
        settings=Settings(t_end=t_end, step=1e-3),
    )


def test_functions_of_users_have_derivatives_by_their_numbers():
    """With a memory; one is made anew for each value, of the same code."""

    def make(mass, k, tau):
        def hardening(parameters, memory, h, c, rate):
            drag = math.tanh(rate)
            force = 30.0 * c**3 + 0.3 * drag
            return force, 90.0 * c**2, 0.3 * (1.0 - drag**2), 7.5 * c**4

        relaxing = UserLaw(branch, [k, tau], [0.0, 0.0], remember)
        return pulled(UserLaw(hardening), relaxing, mass=mass)

    agree(make, {"mass": 2.0, "k": 200.0, "tau": 0.05}, 1e-5, of_bodies("body"))


def test_a_function_that_changes_with_a_parameter_is_refused():
    def make(k):
        def linear(parameters, memory, h, c, rate):
            return k * c, k, 0.0, 0.5 * k * c**2

        return pulled(UserLaw(linear))

    with pytest.raises(DerivativeError, match="k: spring 'coil' has a law whose function changes"):
        with_derivatives(make, {"k": 3.0})


def test_steps_of_two_sizes_are_those_of_the_plain_run():
    """A ball that bounces three times; each state that is taken back has its derivatives too."""

    def make(mass, gravity, stiffness):
        impact = Impact(stiffness=stiffness, restitution=1.0, exponent=1.5)
        model = bouncing(1e-3).with_settings(contact_step=1e-4, t_end=0.3)
        return replace(
            model,
            bodies={"ball": replace(model.bodies["ball"], mass=mass)},
            contacts=[replace(model.contacts[0], impact=impact)],
            gravity=[0.0, 0.0, -gravity],
        )

    values = {"mass": 1.0, "gravity": 9.81, "stiffness": 1e7}
    assert lower(make(**values)).ratio == 10
    agree(make, values, 1e-6, of_bodies("ball"))


@pytest.mark.parametrize("history", ["fft", "direct"])
def test_histories_that_are_convolved_between_steps_have_derivatives(tmp_path, history):
    """By a load and by a kernel, whose size is that of stiffness and mass."""
    element = bar(tmp_path, 0.3)

    def make(load, size):
        body = FlexibleBody(scaled(element, stiffness=size, density=size))
        force = Force("beam.right", [0.0, 1.0, 0.0], Constant(load))
        settings = Settings(t_end=0.06, step=2e-4, history=history)
        return Model({"beam": body}, loads=[force], settings=settings)

    values = {"load": 2.0, "size": 1.0}
    assert lower(make(**values)).n_steps == 300
    agree(make, values, 1e-5, {"frame_elastic_displacement": displacement})


def test_models_without_derivatives_are_named():
    def rounded(parameters, memory, h, c, rate):
        return math.floor(c), 0.0, 0.0, 0.0

    with pytest.raises(DerivativeError, match=r"'coil' has a law that is a function.*floor"):
        check_scope(lower(pulled(UserLaw(rounded))))
    with pytest.raises(DerivativeError, match="a fixed number of iterations"):
        check_scope(lower(every_part_of().with_settings(fixed_iterations=3)))
    assert has_kinks(lower(every_part_of()))


@pytest.mark.parametrize("steps", [400, 2000])
def test_a_kernel_of_many_periods_has_derivatives_by_stiffness(tmp_path, steps):
    """Its phase moves too far over a first step; differences of kernels are extrapolated."""
    element = bar(tmp_path, 0.3, 3)

    def make(size):
        body = FlexibleBody(scaled(element, stiffness=size))
        force = Force("beam.right", [1.0, 1.0, 0.0], Constant(2.0))
        settings = Settings(t_end=2e-4 * steps, step=2e-4, history="direct")
        return Model({"beam": body}, loads=[force], settings=settings)

    def kernel(size):
        return lower(make(size)).system.elastic.kernels.g

    seeds = seeds_of(_start_by(make, "size", 1.0), partial(_start_by, make, "size"), "size", 1, 1.0)
    wide, narrow = ((kernel(1.0 + d) - kernel(1.0 - d)) / (2.0 * d) for d in (2e-6, 1e-6))
    expected = (4.0 * narrow - wide) / 3.0
    found = seeds.arrays["system"]["elastic/kernels/g"]
    size = np.abs(expected).max()
    assert size > 30.0 * np.abs(kernel(1.0)).max()
    assert np.abs(found - expected).max() < 5e-9 * size
    assert 1e-11 < seeds.error < 1e-8
    if steps == 400:
        agree(make, {"size": 1.0}, 2e-6, {"frame_elastic_displacement": displacement})


def test_what_changes_too_fast_is_told_from_kinks():
    with pytest.raises(DerivativeError, match=r"changes too fast with it .*\(system/bodies/mass"):
        seeds_by_mass(lambda d: 2.0 + math.sin(6e4 * d + 1.0))
    seeds = seeds_by_mass(lambda d: 2.0 + math.sin(2e4 * d + 1.0))
    found = seeds.arrays["system"]["bodies/mass"]
    np.testing.assert_allclose(found, 2e4 * math.cos(1.0), rtol=seeds.error)
    assert 64e-11 <= seeds.error < 2e-8


def test_a_blade_in_steady_rotation_has_derivatives(tmp_path):
    """A superelement with terms of second order, stretched and bent at the start."""
    element = bar(tmp_path, 0.3, 3, rotation=True)

    def make(spin, mass, density, stiffness, load):
        hub = RigidBody(0.5, [1e-3, 1e-3, 2e-3], {"rim": Frame([0.05, 0, 0])})
        blade = scaled(element, stiffness=stiffness, density=density)
        weight = RigidBody(mass, [1e-5] * 3, start=Start([0.35, 0, 0]))
        rotation = SteadyRotation([0.0, 0.0, spin])
        return Model(
            {"hub": hub, "blade": FlexibleBody(blade, Start([0.2, 0, 0])), "weight": weight},
            joints=[
                Revolute("ground", "hub", [0, 0, 1], name="pivot"),
                Fixed("hub.rim", "blade.left", name="root"),
                Fixed("blade.right", "weight", name="tip"),
            ],
            loads=[Force("weight", [0, 0, 1.0], Constant(load))],
            settings=Settings(t_end=0.01, step=2e-4, start="equilibrium", steady_rotation=rotation),
        )

    values = {"spin": 40.0, "mass": 0.05, "density": 1.0, "stiffness": 1.0}
    reads = of_bodies("hub", "blade", "weight")
    # Velocities are next to those of the rotation, whatever the masses are.
    del reads["body_velocity"]
    agree(partial(make, load=2.0), values, 3e-4, reads)
    alone = with_derivatives(lambda load: make(**values, load=load), {"load": 2.0})
    ends = [simulate(make(**values, load=2.0 + d)).body("weight").position for d in (1e-3, -1e-3)]
    expected = (ends[0] - ends[1]) / 2e-3
    np.testing.assert_allclose(
        alone["body_position"][:, 2, :, 1], expected, atol=1e-6 * np.abs(expected).max()
    )
