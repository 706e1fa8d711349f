"""What a run says of its own validity: values against those counted by hand, limits, warnings and
stops.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.results import Results
from duhamel.results.criteria import CRITERIA
from duhamel.results.quantities import angle
from duhamel.results.validity import Check
from duhamel.solver import (
    Constant,
    ConvergenceError,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Impulse,
    Input,
    Model,
    OutOfRangeError,
    OutputRequest,
    Polynomial,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spring,
    Start,
    SteadyRotation,
    Steps,
    TabulatedLaw,
    Torque,
    ValidityWarning,
    simulate,
    start,
)
from duhamel.solver.lower.allocation import make_output
from duhamel.solver.output.validity import ValidityMonitor
from duhamel.solver.simulation import signals
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.extremes import follow_extremes
from duhamel.solver.step.loop import advance
from duhamel.solver.step.system import Run
from duhamel.superelement import GeneralizedAlpha, Interface, Modes, Superelement, sample_kernel
from scipy.spatial.transform import Rotation

from .models import model_of

H = 1e-3
SPARSE = OutputRequest(every=1000)
OF_SECOND_ORDER = (
    "second_order_rotation",
    "second_order_displacement",
    "spin_turn",
    "inertia_taken",
)
"""criteria of bodies that the bodies here are not"""


def one_mode(omega=100.0, zeta=0.0, phi=1.0, h=H):
    """A body of 1 kg with an interface at its center: a mode along x, stiff across."""
    modes = Modes(
        np.array([omega, 1e5, 2e5]), np.full(3, zeta), np.diag([phi, 0.1, 0.1]).astype(float)
    )
    return Superelement(
        name="mass",
        mass=1.0,
        J_rot=np.eye(3) / 12.0,
        center=np.zeros(3),
        interfaces=(Interface("point", np.zeros(3), False),),
        kernel=sample_kernel(modes, h, GeneralizedAlpha(0.9), 2000),
        modes=modes,
        compliance=modes.compliance,
        accelerance=modes.accelerance,
    )


def pushed(element, signal, **settings):
    """A force along x on a free body with one mode."""
    loads = (Force("body.point", [1, 0, 0], signal),)
    settings = {"t_end": 1.0, "step": H, "rho_inf": 0.9} | settings
    return model_of({"body": FlexibleBody(element)}, loads=loads, **settings)


def walk(simulator, inputs):
    """Take all steps of a simulator."""
    for n in range(1000):
        simulator.step(inputs(n))


def value(results, criterion):
    (found,) = results.validity.values(criterion).values()
    return found


@pytest.mark.parametrize("every", [1, 1000])
@pytest.mark.parametrize("history", ["recursive", "direct", "fft"])
def test_extremes_count_every_step_in_every_history(hub_and_beam, coarse_beam, every, history):
    torque = (Torque("hub", [0, 0, 1], Steps((0.0, 0.05, 0.1), (2.0, -2.0, 0.0))),)
    model = hub_and_beam(coarse_beam, 4.0, loads=torque, t_end=0.06, history=history)
    whole = simulate(model)
    results = simulate(model.with_settings(output=OutputRequest(every=every)))
    size = coarse_beam.element.size
    for name in ("root", "tip"):
        u = whole.frame(f"beam.{name}").u
        rotation = results.validity.values("elastic_rotation")[f"beam.{name}"]
        moved = results.validity.values("elastic_displacement")[f"beam.{name}"]
        assert rotation == pytest.approx(np.linalg.norm(u[:, 3:], axis=1).max(), rel=1e-12)
        assert moved == pytest.approx(np.linalg.norm(u[:, :3], axis=1).max() / size, rel=1e-12)
    fastest = np.linalg.norm(whole.body("beam").v[:, 3:], axis=1).max()
    ratio = fastest / coarse_beam.element.modes.omega.min()
    assert value(results, "spin") == pytest.approx(ratio, rel=1e-12)


def test_the_validity_in_the_file_is_that_in_memory(hub_and_beam, coarse_beam, tmp_path):
    model = hub_and_beam(coarse_beam, 4.0, t_end=0.01, spin=(0.0, 0.0, 30.0))
    memory = simulate(model).validity
    simulate(model, output=tmp_path / "out.h5")
    read = Results.read(tmp_path / "out.h5").validity
    assert [check[:2] for check in read.checks] == [check[:2] for check in memory.checks]
    np.testing.assert_array_equal(
        [check.value for check in read.checks], [check.value for check in memory.checks]
    )
    assert [check.criterion.name for check in read.worst] == [
        name
        for name, criterion in CRITERIA.items()
        if name not in ("set_changes", "test_misfit")
        and criterion.owner not in ("spring", "contact", "motor", "free body")
        and name not in (*OF_SECOND_ORDER, "missing_stress")
    ]


def test_the_size_of_a_bar_is_its_length(coarse):
    assert coarse.size == pytest.approx(0.5, rel=0.02)


def test_a_body_known_by_its_kernel_alone_has_no_first_frequency(coarse, measured):
    body = {"beam": FlexibleBody(measured(coarse), Start(angular_velocity=[0, 0, 1e3]))}
    results = simulate(model_of(body, t_end=0.01))
    assert np.isnan(value(results, "spin"))
    assert "unknown" in str(results.validity)
    assert not [line for line in results.validity.warnings if "spin" in line]


@pytest.mark.parametrize(("factor", "warned"), [(0.999, False), (1.001, True)])
def test_the_spin_is_warned_of_beyond_its_limit(coarse, factor, warned):
    omega = factor * CRITERIA["spin"].limit * coarse.modes.omega.min()
    body = {"blade": FlexibleBody(coarse, Start(angular_velocity=[0, omega, 0]))}
    results = simulate(model_of(body, t_end=6e-4))
    assert any(line.startswith("body 'blade': spin ") for line in results.validity.warnings) == (
        warned
    )


def cantilever(beam, force, direction=(0, 1, 0), **settings):
    """The paper's beam, clamped, under a dead force on its tip, in equilibrium."""
    return model_of(
        {"beam": FlexibleBody(beam)},
        [Fixed("ground", "beam.root", name="clamp")],
        loads=(Force("beam.tip", direction, Constant(force)),),
        start="equilibrium",
        t_end=6e-4,
        **settings,
    )


@pytest.mark.parametrize(("factor", "warned"), [(0.99, False), (1.01, True)])
def test_the_rotation_of_an_interface_is_warned_of_beyond_its_limit(coarse, factor, warned):
    """The elastic rotation of the root is 0.333 rad at P L^2 / EI = 1, and about in proportion."""
    unit = 5.5 / 0.25
    rotation = value_of(start(cantilever(coarse, unit)), "elastic_rotation", "beam.root")
    limit = CRITERIA["elastic_rotation"].limit
    force = unit * factor * limit / rotation
    for _ in range(4):  # the force for the rotation
        rotation = value_of(start(cantilever(coarse, force)), "elastic_rotation", "beam.root")
        force *= factor * limit / rotation
    results = start(cantilever(coarse, force))
    rotation = value_of(results, "elastic_rotation", "beam.root")
    assert rotation == pytest.approx(factor * limit, rel=1e-3)
    line = (
        f"interface 'beam.root': elastic rotation: {rotation:.3g} rad (limit < 0.3 rad): "
        "elasticity is linear: divide the body into several superelements, or check loads and units"
    )
    assert (line in results.validity.warnings) == warned


def value_of(results, criterion, owner):
    return results.validity.values(criterion)[owner]


def test_warnings_reach_who_calls(coarse):
    with pytest.warns(ValidityWarning, match=r"interface 'beam\.root': elastic rotation: 0\.\d+"):
        simulate(cantilever(coarse, 40.0))
    with pytest.warns(ValidityWarning, match="elastic rotation") as caught:
        start(cantilever(coarse, 40.0))
    assert caught[0].filename == __file__


@pytest.mark.parametrize("path", ["", "arm.toml"])
def test_a_start_far_out_of_range_is_refused(coarse, path):
    """Equilibrium under a force that pulls the beam to four times its length."""
    model = replace(cantilever(coarse, 3.0 * 2.16e7, direction=(1, 0, 0)), path=path)
    message = (
        r"stopped in step 0 \(t = 0 s\): interface 'beam\.\w+' has moved by [\d.]+ m by "
        r"elasticity, more than the size of its body, [\d.]+ m, .*: divide the body"
    )
    for run in (start, simulate, lambda model: Simulator(model, [])):
        with pytest.raises(OutOfRangeError, match=message) as error:
            run(model)
        assert str(error.value).startswith(path)
        assert "\n" not in str(error.value)


def test_a_steady_rotation_far_out_of_range_is_refused(coarse):
    """A tip mass pulls the beam apart by more than its length."""
    tip = RigidBody(1e5, [1e3, 1e3, 1e3], start=Start([0.5, 0, 0]))
    model = Model(
        {"beam": FlexibleBody(coarse, Start([0.25, 0, 0])), "tip": tip},
        [
            Revolute("ground", "beam.root", [0, 0, 1], name="pivot"),
            Fixed("beam.tip", "tip", name="weld"),
        ],
        settings=Settings(
            t_end=1.0,
            step=6e-5,
            start="equilibrium",
            steady_rotation=SteadyRotation([0, 0, 18.0]),
        ),
    )
    with pytest.raises(OutOfRangeError, match="moved by"):
        start(model)


def test_a_run_ends_at_the_step_that_leaves_the_range(tmp_path):
    """With what it had taken; the same step however long the batches are."""
    model = pushed(one_mode(), Harmonic(2e4, 100.0 / (2 * np.pi)))
    path = tmp_path / "out.h5"
    with pytest.raises(OutOfRangeError, match=r"'body\.point' has moved by") as error:
        simulate(model, output=path)
    results = Results.read(path)
    u = np.abs(results.frame("body.point").u[:, 0])
    assert len(results.time) == error.value.step + 1
    assert u[-1] > 1.0 >= u[:-1].max()
    assert error.value.time == pytest.approx(results.time[-1])
    assert value(results, "elastic_displacement") == pytest.approx(u[-1])
    assert not results.solver["finished"]
    simulator = Simulator(model, [])
    with pytest.raises(OutOfRangeError, match=f"in step {error.value.step} "):
        walk(simulator, lambda n: [])


def test_newtons_failure_names_the_range_as_its_likely_cause():
    """A force law that flips its sign, on a body that has deformed too far before."""
    model = pushed(one_mode(), Input("push"), t_end=1.0, max_iterations=3, tolerance=1e-12)
    wall = Spring(
        "wall",
        "point",
        ("ground.wall", "body.point"),
        law=TabulatedLaw((-1.0, 0.2, 0.2001, 1.0), (0.0, 0.0, 1e9, 1e9)),
        rest=[10.0],
    )
    model = replace(model, springs=(wall,), ground_frames={"wall": Frame([-10.0, 0, 0])})
    simulator = Simulator(model, [])
    with pytest.raises(ConvergenceError, match=r"likely cause: interface 'body\.point': elastic"):
        walk(simulator, lambda n: [700.0 if n < 900 else -1e9])


@pytest.mark.parametrize("history", ["recursive", "direct"])
@pytest.mark.parametrize("steps", [7.0, 12.0, 50.0])
def test_steps_in_a_period_of_a_free_vibration(history, steps):
    """The period of the scheme: a little longer than that of the mode (1/3 (omega h / 2)^2)."""
    omega = 2.0 * np.pi / (steps * H)
    model = pushed(one_mode(omega), Impulse(1.0, 0.0), t_end=3.0, history=history)
    assert value(simulate(model), "steps_per_period") == pytest.approx(
        steps * (1.0 + (omega * H) ** 2 / 12.0), rel=0.03
    )


@pytest.mark.parametrize(("steps", "warned"), [(7.0, True), (9.0, False)])
def test_too_few_steps_in_a_period_are_warned_of(steps, warned):
    model = pushed(one_mode(2.0 * np.pi / (steps * H)), Impulse(1.0, 0.0))
    lines = [line for line in simulate(model).validity.warnings if "steps per period" in line]
    assert bool(lines) == warned
    assert all(line.startswith("body 'body': time steps per period") for line in lines)


def test_a_body_that_does_not_vibrate_has_no_frequency(coarse):
    results = simulate(model_of({"beam": FlexibleBody(coarse)}, t_end=0.01, gravity=[0, 0, -9.81]))
    assert np.isnan(value(results, "steps_per_period"))
    assert not results.validity.warnings


def test_the_error_of_a_tested_part_is_a_misfit():
    element = one_mode(2.0 * np.pi * 50.0)
    element = replace(
        element,
        kernel=replace(element.kernel, error=0.06),
        provenance=replace(element.provenance, method="measured with 1 modes, misfit 0.06"),
    )
    results = simulate(pushed(element, Impulse(1.0, 0.0)))
    assert value(results, "test_misfit") == 0.06
    assert not results.validity.values("kernel_error")
    assert not [line for line in results.validity.warnings if "misfit" in line]


def test_the_error_and_the_band_of_a_kernel_are_those_of_its_superelement():
    element = one_mode(2.0 * np.pi * 50.0)
    element = replace(element, kernel=replace(element.kernel, error=0.06, band=40.0), modes=None)
    results = simulate(pushed(element, Impulse(1.0, 0.0)))
    assert value(results, "kernel_error") == 0.06
    assert value(results, "kernel_band") == pytest.approx(50.0 / 40.0, rel=0.03)
    assert [line.split(":")[1] for line in results.validity.warnings] == [
        " error of impulse responses",
        " fastest vibration / band of the superelement",
    ]


@pytest.mark.parametrize(("error", "band", "warned"), [(0.051, 48.0, 2), (0.049, 54.0, 0)])
def test_a_kernel_is_warned_of_beyond_its_limits(error, band, warned):
    """It vibrates with 50 Hz."""
    element = one_mode(2.0 * np.pi * 50.0)
    kernel = replace(element.kernel, error=error, band=band)
    results = simulate(pushed(replace(element, kernel=kernel, modes=None), Impulse(1.0, 0.0)))
    assert len(results.validity.warnings) == warned


@pytest.mark.parametrize(("rho_inf", "warned"), [(0.3, True), (0.6, False)])
def test_energy_that_time_stepping_takes_from_modes_is_warned_of(rho_inf, warned):
    """More than a tenth of a free vibration with 20 steps in a period, or a hundredth of it."""
    model = pushed(one_mode(2.0 * np.pi / (20.0 * H)), Impulse(1.0, 0.0), rho_inf=rho_inf)
    results = simulate(model)
    lines = [line for line in results.validity.warnings if "numerical dissipation" in line]
    assert bool(lines) == warned
    vibration = (results.energy.kinetic + results.energy.elastic).max()
    assert (results.energy.numerical[-1] > 0.1 * vibration) == warned


def test_a_kernel_that_is_cut_off_adds_its_error():
    element = one_mode(zeta=0.1)
    model = pushed(element, Impulse(1.0, 0.0), t_end=1.5, history="direct", kernel_length=1)
    results = simulate(model)
    assert value(results, "kernel_error") == results.solver["truncation"] > 0.0


def falling_on(stiffness, h):
    """1 kg that hits a wall with 10 m/s, and at a step of 1 ms meets it with the whole next one."""
    wall = Spring(
        "wall",
        "point",
        ("ground.below", "ball"),
        law=TabulatedLaw((-1.0, 0.0, 1.0), (-stiffness, 0.0, 0.0)),
        rest=[1.0],
    )
    flying = RigidBody(1.0, [0.1] * 3, start=Start([0, 0, 1.00999], velocity=[0, 0, -10.0]))
    return Model(
        {"ball": flying},
        springs=[wall],
        ground_frames={"below": Frame()},
        settings=Settings(t_end=0.02, step=h),
    )


def test_a_law_that_is_too_stiff_for_the_step_is_named_with_the_energy_that_it_made():
    """A tabulated contact of 1e9 N/m gives the ball three times its speed back."""
    with pytest.warns(ValidityWarning) as caught:
        results = simulate(falling_on(1e9, 1e-3))
    assert results.body("ball").v[-1, 2] > 20.0
    made, kinetic = -results.energy.dissipated.min(), results.energy.kinetic
    moved = (kinetic + np.abs(kinetic - kinetic[0])).max()
    share = results.validity.values("created_energy")["wall"]
    assert made > 380.0
    assert share == pytest.approx(made / moved, rel=0.01)
    lines = [str(warning.message) for warning in caught]
    assert any(
        line.startswith("spring 'wall': energy created by the force law / total energy")
        and line.endswith("take a smaller step in [simulation]")
        for line in lines
    )


def test_a_law_that_the_step_resolves_is_not():
    results = simulate(falling_on(1e5, 1e-5))
    assert results.validity.values("created_energy")["wall"] < 1e-3
    assert not results.validity.warnings


def test_energy_that_a_law_gives_back_after_damping_counts():
    """The damper of another spring does not hide it."""
    model = falling_on(1e9, 1e-3)
    damper = Spring("damper", "point", ("ground.above", "ball"), damping=5.0)
    model = replace(
        model,
        springs=(*model.springs, damper),
        ground_frames={"below": Frame(), "above": Frame([0, 0, 3.0])},
    )
    created = simulate(model).validity.values("created_energy")
    assert created["wall"] > 0.1
    assert created["damper"] < 1e-12


def test_the_balance_is_measured_against_the_energy_that_moves():
    """And not against that of a spring that is preloaded, and at rest."""
    ball = RigidBody(1.0, [0.1] * 3, start=Start([0, 0, 1.0], velocity=[0.1, 0, 0]))
    preload = Spring("preload", "point", ("ground.a", "ball"), stiffness=1e4, rest=[0.0])
    model = Model(
        {"ball": ball},
        springs=[preload],
        ground_frames={"a": Frame()},
        settings=Settings(t_end=0.2, step=2e-3),
    )
    results = simulate(model)
    energy = results.energy
    compliance = energy.dissipated + energy.springs - energy.springs[0]
    moved = (energy.kinetic + np.abs(compliance)).max()
    expected = np.abs(energy.balance).max() / moved
    assert value(results, "energy_balance") == pytest.approx(expected, rel=1e-6)


def test_a_model_at_rest_is_in_balance(coarse):
    results = simulate(cantilever(coarse, 1.0))
    assert value(results, "energy_balance") < 1e-6
    assert not results.validity.warnings


def test_an_open_joint_is_named(hub_and_beam, coarse_beam):
    """One iteration for each of some large steps leaves joints open."""
    torque = (Torque("hub", [0, 0, 1], Constant(2.0)),)
    model = hub_and_beam(coarse_beam, 4.0, loads=torque, t_end=0.3, step=1e-2)
    closed = simulate(model).validity.values("joint_opening")
    left = simulate(model.with_settings(fixed_iterations=1)).validity
    assert max(closed.values()) < 1e-9
    opening = left.values("joint_opening")
    assert opening["clamp"] > CRITERIA["joint_opening"].limit
    assert any(
        line.startswith("joint 'clamp': joint constraint violation") for line in left.warnings
    )


def test_validity_is_indifferent_to_the_frame(hub_and_beam, coarse_beam):
    """Of a model that is turned and moved as a whole."""
    torque = Steps((0.0, 0.05, 0.1), (2.0, -2.0, 0.0))
    values = []
    for turn in (np.zeros(3), np.array([0.3, -1.0, 2.0])):
        Q, shift = Rotation.from_rotvec(turn), 10.0 * turn
        model = hub_and_beam(coarse_beam, 4.0, pivot="revolute", t_end=0.06)
        hub = replace(model.bodies["hub"], start=Start(shift, turn))
        axis = Q.apply([0, 0, 1])
        moved = Model(
            {"hub": hub, "beam": model.bodies["beam"]},
            [
                Revolute("ground", "hub", axis, name="pivot"),
                Fixed("hub.rim", "beam.root", name="clamp"),
            ],
            [Torque("hub", axis, torque)],
            settings=model.settings,
        )
        checks = simulate(moved).validity.checks
        of_rounding = ("joint_opening", "force_noise", "missed_turn")
        values.append([c.value for c in checks if c.criterion.name not in of_rounding])
    np.testing.assert_allclose(values[0], values[1], rtol=1e-5, atol=1e-12)


def test_interpreted_and_compiled_extremes_agree(hub_and_beam, coarse_beam):
    """The slow path, Python, of the same functions."""
    torque = (Torque("hub", [0, 0, 1], Constant(2.0)),)
    initial = initialize(hub_and_beam(coarse_beam, 4.0, loads=torque, t_end=0.06))
    lowered, state, work = initial.lowered, initial.state, initial.work
    run = Run(system=lowered.system, state=state, work=work, output=make_output(lowered, 1))
    advance(run, signals(lowered, 1, np.full(20, -1)))
    before = [array.copy() for array in state.extremes.arrays()]
    advance(run, signals(lowered, 21, np.full(1, -1)))
    after = [array.copy() for array in state.extremes.arrays()]
    for array, old in zip(state.extremes.arrays(), before, strict=True):
        array[...] = old
    follow_extremes(lowered.system, state, work)
    for array, new in zip(state.extremes.arrays(), after, strict=True):
        np.testing.assert_allclose(array, new, rtol=1e-12, atol=1e-15)


TURNS = 2.0 * np.pi * 700.0
"""0.7 turns a step"""


@pytest.mark.parametrize("driven", [False, True])
def test_angles_keep_their_turns_where_a_step_turns_more_than_half_a_one(driven):
    signal = Polynomial([0.0, TURNS]) if driven else None
    hinge = Revolute("ground", "wheel", [0, 0, 1], name="hinge", angle=signal)
    wheel = RigidBody(1.0, [1.0, 1.0, 1.0], start=Start(angular_velocity=[0, 0, TURNS]))
    model = Model({"wheel": wheel}, [hinge], settings=Settings(t_end=0.1, step=H))
    results = simulate(model)
    np.testing.assert_allclose(results.joint("hinge").angle, TURNS * results.time, atol=1e-6)
    assert value(results, "missed_turn") < 1e-6
    every = simulate(model.with_settings(output=OutputRequest(every=7)))
    np.testing.assert_allclose(angle(every, "wheel")[:, 2], TURNS * every.time, atol=1e-6)


def test_a_torsion_spring_keeps_its_turns_where_a_step_turns_more_than_half_a_one():
    """And so its moment, of a spring too soft to brake."""
    wheel = RigidBody(1.0, [1.0, 1.0, 1.0], start=Start(angular_velocity=[0, 0, TURNS]))
    spring = Spring("spring", "torsion", ("ground", "wheel"), axis=[0, 0, 1], stiffness=1e-3)
    model = Model({"wheel": wheel}, springs=[spring], settings=Settings(t_end=0.1, step=H))
    results = simulate(model)
    coordinate = results.spring("spring").coordinates["coordinates"][:, 0]
    np.testing.assert_allclose(coordinate, TURNS * results.time, rtol=1e-5, atol=1e-6)


def test_turns_that_the_rate_cannot_count_are_warned_of():
    """As where the last step's rate says two radians, and the angle moved by none."""
    wheel = RigidBody(1.0, [1.0, 1.0, 1.0])
    hinge = Revolute("ground", "wheel", [0, 0, 1], name="hinge")
    initial = initialize(Model({"wheel": wheel}, [hinge], settings=Settings(t_end=0.1, step=H)))
    lowered, state = initial.lowered, initial.state
    output = make_output(lowered, 1)
    run = Run(system=lowered.system, state=state, work=initial.work, output=output)
    state.observers.rate[:] = 4.0 / H
    advance(run, signals(lowered, 1, np.full(1, -1)))
    validity = ValidityMonitor(lowered).validity(state, 1)
    assert validity.values("missed_turn") == {"hinge.angle": pytest.approx(2.0)}
    assert validity.warnings == (
        "angle 'hinge.angle': joint angle increment minus rate prediction: 2 rad (limit < 1.57 rad)"
        ": its full turns may be miscounted: take a smaller step in [simulation]",
    )


@pytest.mark.parametrize("name", CRITERIA)
def test_a_value_is_judged_and_warned_of_by_the_limits_of_its_criterion(name):
    """Good up to one limit, fair up to the other, poor just beyond."""
    criterion = CRITERIA[name]
    side = -1.0 if criterion.least else 1.0
    near = 1e-9 * side
    values = [
        criterion.good * (1.0 - near),
        criterion.good * (1.0 + near),
        criterion.limit * (1.0 - near),
        criterion.limit * (1.0 + near),
        np.nan,
    ]
    verdicts = [Check(criterion, "x", value).verdict for value in values]
    assert verdicts == ["good", "fair", "fair", "poor", "unknown"]
    warning = Check(criterion, "it", values[3]).warning
    assert warning.startswith(f"{criterion.owner} 'it': {criterion.quantity}: ")
    assert f"{criterion.limit:.3g}" in warning
    assert warning.endswith(criterion.advice)
