"""Runs with two step sizes, long in flight and short in contact, against short steps alone."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.results.recovery import ModalSteps, interface_loads, stepping
from duhamel.solver import (
    Contact,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Hertz,
    Impact,
    Impulse,
    Input,
    Model,
    ModelError,
    OutputRequest,
    Pulse,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Start,
    Steps,
    Stop,
    Torque,
    simulate,
)
from duhamel.solver.lower.lower import lower
from duhamel.solver.start.initial import initialize, modes_of
from duhamel.solver.step.sizes import change_size
from duhamel.superelement import Chain

from .frameworks import bar
from .test_restart import assert_same

MASS, RADIUS = 0.1, 0.02
STEEL = Hertz([2.1e11, 2.1e11], [0.3, 0.3])
LENGTH, BALL = 0.3, 0.01


def dropped(step, contact_step=None, t_end=0.6, height=0.3, restitution=0.8, **settings):
    """A steel ball on a plane; contacts of 70 us."""
    ball = RigidBody(
        MASS, [0.4 * MASS * RADIUS**2] * 3, start=Start(position=[0, 0, RADIUS + height])
    )
    floor = Contact(
        "floor",
        ["ground.floor", "ball"],
        "plane",
        ball=RADIUS,
        axis=[0, 0, 1],
        hertz=STEEL,
        impact=Impact(restitution=restitution),
    )
    return Model(
        {"ball": ball},
        contacts=[floor],
        ground_frames={"floor": Frame()},
        gravity=[0, 0, -9.81],
        settings=Settings(t_end=t_end, step=step, contact_step=contact_step, **settings),
    )


def pendulum(step, ratio=None, t_end=0.4):
    """Driven, with a stop."""
    bob = RigidBody(
        1.0, [0.01, 0.02, 0.02], {"pin": Frame([-0.4, 0, 0])}, Start(position=[0.4, 0, 0])
    )
    return Model(
        {"bob": bob},
        [Revolute("ground.wall", "bob.pin", [0, 0, 1], name="pin")],
        loads=[Torque("bob", [0, 0, 1], Harmonic(1.0, 3.0))],
        stops=[Stop("stop", "pin", "angle", [-1.0, np.inf], Impact(stiffness=2e4))],
        ground_frames={"wall": Frame()},
        gravity=[0, -9.81, 0],
        settings=Settings(t_end=t_end, step=step, contact_step=ratio and step / ratio),
    )


@pytest.fixture(scope="module")
def element(tmp_path_factory):
    return bar(tmp_path_factory.mktemp("bar"), LENGTH, 12, step=1e-5, steps=4)


def falling_bar(element, step, contact_step=None, t_end=6e-3, angle=0.3, **settings):
    """On a corner, then on the other; it rings."""
    height = BALL + 0.5 * LENGTH * np.sin(angle) + 1e-3
    start = Start(position=[0, 0, height], rotation=[0, angle, 0], velocity=[0, 0, -1.0])
    ends = [
        Contact(
            name,
            ["ground.floor", f"bar.{name}"],
            "plane",
            ball=BALL,
            axis=[0, 0, 1],
            impact=Impact(stiffness=2e6),
        )
        for name in ("left", "right")
    ]
    return Model(
        {"bar": FlexibleBody(element, start)},
        contacts=ends,
        ground_frames={"floor": Frame()},
        settings=Settings(t_end=t_end, step=step, contact_step=contact_step, **settings),
    )


def test_a_ball_bounces_as_in_short_steps_alone():
    both = simulate(dropped(1e-4, 1.25e-6))
    short = simulate(dropped(1.25e-6, output=OutputRequest(every=80)))
    assert both.solver["steps"] == len(both.time) - 1 < 6300
    expected = short.body("ball")
    assert both.body("ball").v[-1, 2] == pytest.approx(expected.v[-1, 2], rel=1e-8)
    assert both.body("ball").x[-1, 2] == pytest.approx(expected.x[-1, 2], rel=1e-8)


def test_it_does_so_at_every_scale_of_flight():
    ends = [simulate(dropped(1.25e-6 * n, 1.25e-6)).body("ball").v[-1, 2] for n in (8, 80, 800)]
    np.testing.assert_allclose(ends, ends[0], rtol=1e-8)


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
def test_momentum_is_kept_to_rounding(rho_inf):
    """That of two balls, whatever the filter of the scheme holds at a change of steps."""
    inertia = [0.4 * MASS * RADIUS**2] * 3
    balls = {
        "a": RigidBody(MASS, inertia, start=Start(velocity=[3.0, 0.2, 0])),
        "b": RigidBody(2.0 * MASS, inertia, start=Start(position=[0.05, 0.005, 0])),
    }
    hit = Contact(
        "hit", ["a", "b"], "sphere", radius=RADIUS, ball=RADIUS, hertz=STEEL, impact=Impact()
    )
    settings = Settings(t_end=0.01, step=1e-4, contact_step=4e-6, rho_inf=rho_inf)
    results = simulate(Model(balls, contacts=[hit], settings=settings))
    momentum = results.momentum.linear
    assert np.ptp(results.body("a").v[:, 0]) > 1.0
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(momentum), 1)), atol=1e-14)


def test_the_error_is_of_second_order():
    exact = simulate(pendulum(2.5e-5, 4)).joint("pin").coordinates["angle"][-1]
    errors = [
        abs(simulate(pendulum(h, 4)).joint("pin").coordinates["angle"][-1] - exact)
        for h in (8e-4, 4e-4, 2e-4)
    ]
    assert errors[0] / errors[2] > 10.0
    assert errors[2] < 1e-5


def test_a_bar_strikes_as_in_short_steps_alone(element):
    both = simulate(falling_bar(element, 1e-5, 1e-6))
    short = simulate(falling_bar(element, 1e-6))
    force, expected = (abs(r.frame("bar.right").force[:, 2]) for r in (both, short))
    first = both.time < 1.5e-3
    assert force[first].max() == pytest.approx(expected[short.time < 1.5e-3].max(), rel=1e-4)
    assert both.solver["steps"] < 0.4 * short.solver["steps"]
    v, expected_v = both.body("bar").v[-1], short.body("bar").v[-1]
    np.testing.assert_allclose(v, expected_v, atol=0.02 * np.abs(expected_v).max())


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9])
@pytest.mark.parametrize("step", [1e-5, 1e-4])
def test_energy_never_grows(element, rho_inf, step):
    """Neither where steps in flight resolve the vibration, nor where they do not."""
    results = simulate(falling_bar(element, step, 1e-6, t_end=0.01, rho_inf=rho_inf))
    energy = results.energy
    total = energy.kinetic + energy.elastic + energy.springs
    assert total.max() < total[0] * (1.0 + 1e-4)
    assert total[-1] > (0.95 if rho_inf == 0.9 else 0.85) * total[0]


def test_nothing_jumps_at_a_change(element):
    model = falling_bar(element, 1e-4, 1e-6, t_end=3e-3)
    initial = initialize(model)
    lowered, state, work = initial.lowered, initial.state, initial.work
    rng = np.random.default_rng(0)
    modes, interfaces = state.modes, state.interfaces
    modes.eta[:], modes.acceleration[:] = rng.normal(size=(2, len(modes.eta)))
    phi = modes_of(lowered, 0)
    kept = [array.copy() for array in (state.bodies.x, modes.eta, interfaces.u, state.bodies.v)]
    change_size(lowered.system, lowered.flight, state, work)
    for array, before in zip(
        (state.bodies.x, modes.eta, interfaces.u, state.bodies.v), kept, strict=True
    ):
        np.testing.assert_array_equal(array, before)
    np.testing.assert_allclose(interfaces.a, phi @ modes.a)
    resolved = lowered.superelements[0].modes.omega * 1e-4 < 0.1
    np.testing.assert_allclose(modes.a[resolved], modes.acceleration[resolved], rtol=0.01)
    stiffest = np.argmax(lowered.superelements[0].modes.omega)
    assert abs(modes.a[stiffest]) < 0.01 * abs(modes.acceleration[stiffest])


@pytest.mark.parametrize("step", [1e-4, 2e-4])
@pytest.mark.parametrize("chain", [None, Chain([1e-4, 1e-3], [0.01, 0.02])], ids=["", "lossy"])
def test_displacements_are_those_of_the_modes_all_along(element, chain, step):
    """Where G_0 changes with the step, u = phi eta does not; so fields may follow from the rows.

    Nor does a first long step that is taken back change anything, as one of 2e-4 is.
    """
    element = replace(element, modes=replace(element.modes, chain=chain))
    model = falling_bar(element, step, 1e-6)
    results = simulate(model)
    loads, u = [], []
    for interface in element.interfaces:
        frame = results.frame(f"bar.{interface.name}")
        loads.append(interface_loads(results.body("bar").R, frame.u, frame.force, True))
        u.append(frame.u)
    run = stepping("", results.solver, results.time)
    assert set(np.unique(run.h)) == {results.solver["h"], results.solver["contact_h"]}
    eta = ModalSteps(element.modes, np.hstack(loads), run).at(np.arange(len(results.time)))
    expected = np.hstack(u)
    np.testing.assert_allclose(
        eta @ element.modes.phi.T, expected, atol=1e-12 * np.abs(expected).max()
    )


def test_a_contact_that_nobody_could_foresee_takes_a_step_back():
    """At rest just above the floor the rate is zero: the step that falls into it is not kept."""
    fall = {"t_end": 0.05, "height": 1e-4, "restitution": 1.0}
    both, short = simulate(dropped(5e-3, 2.5e-6, **fall)), simulate(dropped(2.5e-6, **fall))
    assert both.solver["steps"] < 0.8 * short.solver["steps"]
    assert both.time[1] == pytest.approx(2.5e-6)
    assert both.body("ball").x[-1, 2] == pytest.approx(short.body("ball").x[-1, 2], rel=1e-9)


@pytest.mark.parametrize(
    "signal",
    [Impulse(0.01, 0.0210437), Pulse(3.0, 0.0210437, 0.0231), Steps((0.0210437,), (0.5,))],
    ids=["impulse", "pulse", "steps"],
)
def test_loads_that_jump_keep_their_area(signal):
    """Beside a change of steps as elsewhere: once, not twice, and not half of it."""
    ends = []
    for step, contact_step in ((1e-3, 1e-5), (1e-5, None)):
        model = dropped(step, contact_step, t_end=0.03)
        push = Force("ball", [1, 0, 0], signal)
        results = simulate(replace(model, loads=[push]))
        ends.append(results.body("ball").v[-1, 0])
    assert ends[0] == pytest.approx(ends[1], rel=1e-10)
    area = {Impulse: 0.01, Pulse: 3.0 * 0.0020563, Steps: 0.5 * 0.0089563}[type(signal)]
    assert MASS * ends[0] == pytest.approx(area, rel=1e-6)


def test_rows_of_both_sizes_follow_each_other():
    every = simulate(dropped(1e-4, 2.5e-6, output=OutputRequest(every=7)))
    all_rows = simulate(dropped(1e-4, 2.5e-6))
    steps = np.diff(all_rows.time)
    assert np.all(np.isclose(steps, 1e-4) | np.isclose(steps, 2.5e-6))
    assert np.all(np.diff(every.time) > 0.0)
    assert every.time[-1] == all_rows.time[-1] == pytest.approx(0.6)
    known = np.searchsorted(all_rows.time, every.time)
    np.testing.assert_array_equal(every.time, all_rows.time[known])
    np.testing.assert_array_equal(every.body("ball").x, all_rows.body("ball").x[known])
    assert len(all_rows.time) / len(every.time) == pytest.approx(7.0, rel=0.05)


@pytest.fixture(scope="module", params=[1, 3])
def whole(request, element, tmp_path_factory):
    """A model that records every so many steps, and the file of its run."""
    model = falling_bar(element, 1e-4, 1e-6, t_end=4e-3, output=OutputRequest(every=request.param))
    file = tmp_path_factory.mktemp("whole") / "whole.h5"
    simulate(model, output=file)
    return model, file


@pytest.mark.parametrize("part", [0.8e-3, 1.1e-3, 2.3e-3])
def test_a_run_in_parts_is_that_in_one_to_the_bit(whole, part, tmp_path):
    """The state is kept in flight, and while a contact is closed."""
    model, file = whole
    kept = replace(model, settings=replace(model.settings, checkpoint=60.0))
    simulate(kept.with_settings(t_end=part), output=tmp_path / "parts.h5")
    simulate(kept, output=tmp_path / "parts.h5", resume=True)
    assert_same(tmp_path / "parts.h5", file)


def test_so_is_one_that_was_interrupted_in_contact(element, monkeypatch, tmp_path):
    model = falling_bar(element, 1e-4, 1e-6, t_end=4e-3)
    simulate(model, output=tmp_path / "whole.h5")
    kept = replace(model, settings=replace(model.settings, checkpoint=60.0))
    stop_at = int(1.13e-3 / 1e-6)

    def interrupt(lowered, state, done):
        if done > stop_at:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("duhamel.solver.simulation.check_range", interrupt)
        with pytest.raises(KeyboardInterrupt):
            simulate(kept, output=tmp_path / "parts.h5")
    simulate(kept, output=tmp_path / "parts.h5", resume=True)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_another_model_goes_on_from_its_end(element, tmp_path):
    model = falling_bar(element, 1e-4, 1e-6, t_end=4e-3)
    whole = simulate(model)
    first = replace(model, settings=replace(model.settings, t_end=2e-3, checkpoint=60.0))
    simulate(first, output=tmp_path / "first.h5")
    start = {"from": str(tmp_path / "first.h5")}
    second = simulate(replace(model, settings=replace(model.settings, start=start)))
    np.testing.assert_array_equal(second.time, whole.time[whole.time >= 2e-3])
    np.testing.assert_allclose(second.body("bar").x[-1], whole.body("bar").x[-1], atol=1e-14)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"contact_step": 3e-5},
            "whole fraction of the step, 0.0001 s, got 3e-05; the nearest is 3.33333333e-05$",
        ),
        ({"contact_step": 1e-4}, "got 0.0001"),
        ({"contact_step": 1e-3}, "got 0.001"),
        ({"contact_step": 1e-5, "history": "fft"}, "needs recursive history.*got history = 'fft'"),
        ({"contact_step": 1e-5, "history": "direct"}, "got history = 'direct'"),
    ],
)
def test_a_step_that_does_not_fit_is_refused(changes, message):
    model = dropped(1e-4)
    with pytest.raises(ModelError, match=f"contact_step: .*{message}"):
        simulate(replace(model, settings=replace(model.settings, **changes)))


def test_it_is_refused_without_contacts():
    model = replace(dropped(1e-4, 1e-5), contacts=())
    with pytest.raises(ModelError, match="contact_step: the model has no contacts or stops"):
        simulate(model)


def test_it_is_refused_without_modes(element):
    without = replace(element, modes=None)
    with pytest.raises(ModelError, match="body 'bar': contact_step needs modes"):
        lower(falling_bar(without, 1e-5, 1e-6, t_end=5e-5))


def test_a_simulator_refuses_it():
    model = dropped(1e-4, 1e-5)
    loads = [Force("ball", [0, 0, 1], Input("push"))]
    with pytest.raises(ModelError, match="contact_step: a Simulator takes steps of one size"):
        Simulator(replace(model, loads=loads), [])
