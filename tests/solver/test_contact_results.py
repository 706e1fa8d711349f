"""What results say of contacts, stops and friction, and of each time that they were closed."""

import re
from dataclasses import replace

import numpy as np
import pytest
from duhamel.results import Results
from duhamel.solver import (
    Contact,
    Frame,
    Hertz,
    Impact,
    JointFriction,
    Model,
    ModelError,
    OutputRequest,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Start,
    Stop,
    ValidityWarning,
    check,
    simulate,
)
from duhamel.solver.lower import sizes
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.events import follow_shortest

M, R, H, G = 0.1, 0.02, 1e-4, 10.0
STIFFNESS = M * (np.pi / (40 * H)) ** 2
"""of a linear contact of 40 steps"""


def ball(height=0.01, speed=0.0, restitution=0.8, t_end=0.2, gravity=G, slide=0.0, **contact):
    """A ball above a floor, on which it bounces."""
    contact = {"impact": Impact(stiffness=STIFFNESS, restitution=restitution), **contact}
    start = Start(position=[0, 0, R + height], velocity=[slide, 0, -speed])
    return Model(
        {"ball": RigidBody(M, [0.4 * M * R**2] * 3, start=start)},
        contacts=[
            Contact("floor", ("ground.floor", "ball"), "plane", ball=R, axis=[0, 0, 1], **contact)
        ],
        ground_frames={"floor": Frame([0.3, 0, 0])},
        gravity=[0, 0, -gravity],
        settings=Settings(t_end=t_end, step=H),
    )


def pendulum(lower=-0.1, upper=np.inf, t_end=0.5, **joint):
    """A bar on a pivot that gravity drives against a stop."""
    bar = RigidBody(1.0, [1 / 12] * 3, {"pin": Frame([-0.5, 0, 0])}, Start(position=[0.5, 0, 0]))
    return Model(
        {"bar": bar},
        [Revolute("ground.pin", "bar.pin", [0, -1, 0], name="pivot", **joint)],
        stops=[Stop("rest", "pivot", "angle", [lower, upper], Impact(stiffness=5e4))],
        ground_frames={"pin": Frame()},
        gravity=[0, 0, -G],
        settings=Settings(t_end=t_end, step=2e-4),
    )


def test_events_of_a_bouncing_ball_are_those_of_the_closed_form():
    """Parabolas between impacts of m (v1 + v2 + g T); each is e times as fast as the last."""
    e = 0.8
    quick = Impact(stiffness=25 * STIFFNESS, restitution=e)
    model = ball(impact=quick).with_settings(step=H / 5)
    events = simulate(model).contact("floor").events
    first, closing, opening = np.sqrt(2 * G * 0.01), events.closing_speed, events.opening_speed
    assert len(events) >= 3
    assert events.start[0] == pytest.approx(np.sqrt(2 * 0.01 / G), abs=0.1 * H)
    assert closing[0] == pytest.approx(first, rel=1e-3)
    np.testing.assert_allclose(closing[1:], opening[:-1], rtol=2e-3)
    np.testing.assert_allclose(events.restitution, opening / closing, rtol=1e-15)
    np.testing.assert_allclose(events.restitution, e, rtol=0.02)
    lasting = events.end - events.start
    np.testing.assert_allclose(events.impulse, M * (closing + opening + G * lasting), rtol=2e-3)
    lost = 0.5 * M * (closing**2 - opening**2)
    np.testing.assert_allclose(events.dissipated, lost, rtol=0.01)
    flights = events.start[1:] - events.end[:-1]
    np.testing.assert_allclose(flights, 2 * opening[:-1] / G, rtol=2e-3)
    assert (abs(lasting / (H / 5) - events.steps) <= 1.0).all()


def test_events_and_rows_tell_the_same():
    results = simulate(ball())
    contact, energy = results.contact("floor"), results.energy
    events = contact.events
    force, t = contact.force[:, 0], results.time
    for k in range(len(events)):
        during = (t > events.start[k]) & (t < events.end[k])
        assert events.steps[k] == during.sum() == (contact.state[during] == 1).sum()
        assert events.peak[k] == force[during].max()
        assert events.impulse[k] == pytest.approx(H * force[during].sum(), rel=1e-12)
        last = np.flatnonzero(during)[-1] + 1
        assert energy.dissipated[last] == pytest.approx(events.dissipated[: k + 1].sum(), rel=1e-9)
    closed = contact.state > 0
    assert events.steps.sum() == closed.sum()
    assert (contact.gap[closed] < 0.0).all()
    assert (contact.gap[~closed] >= 0.0).all()
    assert not contact.force[~closed].any()


def test_an_elastic_contact_stores_its_energy_in_springs_and_dissipates_none():
    results = simulate(ball(restitution=1.0, gravity=0.0, speed=1.0, t_end=0.01 + 60 * H))
    deepest = results.contact("floor").gap.min()
    assert results.energy.springs.max() == pytest.approx(0.5 * STIFFNESS * deepest**2, rel=1e-9)
    assert results.energy.springs.max() == pytest.approx(0.5 * M, rel=2e-3)
    assert abs(results.energy.dissipated[-1]) < 1e-3 * 0.5 * M


@pytest.mark.parametrize("every", [1, 7, 10**6])
def test_every_step_counts_whatever_is_recorded(every, tmp_path):
    request = OutputRequest(every, ("energy",))
    expected = simulate(ball()).events["floor"]
    model = ball().with_settings(output=request)
    for results in (simulate(model), simulate(model, output=tmp_path / "out.h5")):
        assert results.contacts == ()
        for name, column in vars(results.events["floor"]).items():
            np.testing.assert_array_equal(column, getattr(expected, name), err_msg=name)


def test_more_events_than_the_loop_has_room_for_are_all_there(monkeypatch, tmp_path):
    model = ball(height=1e-6, speed=1.0, restitution=1.0, gravity=500.0, t_end=0.5)
    expected = simulate(model).events["floor"]
    assert len(expected) > 50
    monkeypatch.setattr(sizes, "EVENT_CAPACITY", 2)
    for results in (simulate(model), simulate(model, output=tmp_path / "out.h5")):
        for name, column in vars(results.events["floor"]).items():
            np.testing.assert_array_equal(column, getattr(expected, name), err_msg=name)


def test_what_is_closed_at_the_end_and_from_the_start():
    """A ball at rest on the floor that is pulled off; and one that stays."""
    sunk = M * G / STIFFNESS
    rest = ball(height=-sunk, restitution=1.0, t_end=0.05)
    stays = simulate(rest).contact("floor").events
    assert len(stays) == 1
    assert stays.impacts == 0
    assert stays.shortest is None
    assert stays.still_closed.tolist() == [True]
    assert (stays.start[0], stays.closing_speed[0]) == (0.0, 0.0)
    assert stays.end[0] == pytest.approx(0.05, rel=1e-12)
    assert stays.steps[0] == 500
    assert stays.impulse[0] == pytest.approx(M * G * 0.05, rel=1e-9)
    assert abs(stays.dissipated[0]) < 1e-12
    leaves = simulate(replace(rest, gravity=[0, 0, 0.1 * G])).contact("floor").events
    assert not leaves.still_closed.any()
    assert leaves.impacts == 0
    assert leaves.peak[0] == pytest.approx(M * G, rel=1e-9)
    assert abs(leaves.dissipated[0]) < 1e-2 * 0.5 * STIFFNESS * sunk**2
    falling = simulate(ball(t_end=np.sqrt(2 * 0.01 / G) + 10 * H)).contact("floor").events
    assert falling.still_closed.tolist() == [True]
    assert falling.impacts == 1
    assert np.isnan(falling.restitution[0])


def test_normal_point_force_and_slip_are_those_of_the_bodies():
    """A ball that slides inside a hollow cylinder, seen from the frames."""
    model = ball(height=1e-4, slide=1.0, t_end=0.05, friction=0.2, tangential_stiffness=STIFFNESS)
    drum = Contact(
        "floor",
        ("ground.axle", "ball"),
        "cylinder",
        axis=[0, 1, 0],
        radius=0.1,
        hollow=True,
        ball=R,
        impact=model.contacts[0].impact,
        friction=0.2,
        tangential_stiffness=STIFFNESS,
    )
    frames = {"axle": Frame([0, 0, 0.1])}
    results = simulate(replace(model, contacts=[drum], ground_frames=frames))
    contact, body = results.contact("floor"), results.body("ball")
    arm = body.x - [0, 0, 0.1]
    arm[:, 1] = 0.0
    distance = np.linalg.norm(arm, axis=1)
    np.testing.assert_allclose(contact.normal, -arm / distance[:, None], atol=1e-12)
    np.testing.assert_allclose(contact.gap, 0.1 - distance - R, atol=1e-14)
    np.testing.assert_allclose(contact.point, body.x - R * contact.normal, atol=1e-14)
    touching = contact.state > 0
    slipping = contact.state == 2
    assert set(contact.state) >= {0, 2}
    spin = body.v[:, 3:]  # about y alone: the same in space
    slip = body.v[:, :3] + np.cross(spin, -R * contact.normal)
    np.testing.assert_allclose(
        np.linalg.norm(contact.slip[touching], axis=1),
        np.linalg.norm(slip - (slip * contact.normal).sum(1)[:, None] * contact.normal, axis=1)[
            touching
        ],
        rtol=1e-9,
    )
    assert not contact.slip[~touching].any()
    pull = M * body.v_dot[:, :3] + [0, 0, M * G]
    np.testing.assert_allclose((pull * contact.normal).sum(1), contact.force[:, 0], atol=1e-6)
    across = np.linalg.norm(contact.force[:, 1:], axis=1)
    np.testing.assert_allclose(
        across[slipping], 0.2 * contact.force[slipping, 0], rtol=1e-6, atol=1e-6
    )
    works_against = (contact.force[:, 1:] * contact.slip).sum(1)
    assert (works_against[slipping] <= 0.0).all()


def test_slip_without_friction_is_told_too():
    contact = simulate(ball(slide=3.0)).contact("floor")
    touching = contact.state > 0
    np.testing.assert_allclose(np.linalg.norm(contact.slip[touching], axis=1), 3.0, rtol=1e-12)
    assert not contact.force[:, 1:].any()


@pytest.mark.parametrize("upwards", [False, True])
def test_a_stop_tells_its_gap_and_its_moment_on_the_coordinate(upwards):
    model = pendulum(-0.1, np.inf)
    if upwards:
        model = replace(pendulum(-np.inf, 0.1), gravity=[0, 0, G])
    results = simulate(model)
    stop, sign = results.contact("rest"), -1.0 if upwards else 1.0
    angle = results.joint("pivot").angle
    np.testing.assert_allclose(stop.gap, sign * angle + 0.1, atol=1e-14)
    assert stop.events.impacts >= 2
    assert (sign * stop.force).max() == pytest.approx(stop.events.peak.max(), rel=1e-12)
    assert (sign * stop.force).min() == 0.0
    np.testing.assert_array_equal(stop.state, stop.gap < 0.0)
    rate = results.joint("pivot").angle_rate
    np.testing.assert_allclose(stop.events.closing_speed[0], abs(rate).max(), rtol=0.02)
    assert results.unit("events", "rest", "peak") == "N m"
    assert results.unit("stops", "rest", "gap") == "rad"


def test_friction_of_a_joint_is_told_with_what_it_does():
    friction = JointFriction(coefficient=0.3, radius=0.02)
    results = simulate(replace(pendulum(friction=friction), stops=()))
    joint = results.joint("pivot")
    assert set(joint.friction_state[1:]) <= {1, 2}
    np.testing.assert_array_equal(abs(joint.friction), abs(joint.multipliers[:, -1]))
    slipping = (joint.friction_state == 2) & (abs(joint.angle_rate) > 0.1)
    assert slipping.sum() > 100
    normal = np.linalg.norm(joint.multipliers[:, :2], axis=1) + abs(joint.multipliers[:, 2])
    np.testing.assert_allclose(
        abs(joint.friction[slipping]), 0.3 * 0.02 * normal[slipping], rtol=1e-6
    )
    assert (joint.friction * joint.angle_rate)[slipping].max() < 0.0
    assert results.unit("joints", "pivot", "friction") == "N m"
    assert results.contacts == results.stops == ()
    assert results.events == {}


def test_contacts_are_neither_joints_nor_springs():
    results = simulate(ball(t_end=0.01))
    assert results.joints == results.springs == ()
    assert results.contacts == ("floor",)
    assert "contacts/floor" in results.recorded
    with pytest.raises(KeyError, match="no contacts/wall; there are: floor"):
        results.contact("wall")


def test_too_few_steps_in_a_contact_are_warned_of_by_name():
    few = Impact(stiffness=STIFFNESS * 36)
    with pytest.warns(
        ValidityWarning, match=r"^contact 'floor': time steps of the shortest.*: [67] "
    ):
        results = simulate(ball(impact=few))
    assert results.validity.values("contact_steps")["floor"] == results.events["floor"].shortest
    bar = pendulum()
    stiff = replace(bar.stops[0], impact=Impact(stiffness=1e7))
    with pytest.warns(ValidityWarning, match=r"^stop 'rest': time steps of the shortest"):
        simulate(replace(bar, stops=[stiff]))
    assert not simulate(ball()).validity.warnings
    assert np.isnan(simulate(ball(t_end=0.01)).validity.values("contact_steps")["floor"])


def test_the_warning_of_too_few_steps_names_the_key_and_its_value():
    """That with which the shortest contact has its 40 steps: taken as it stands, it runs."""
    for key, contact_step in (("step", None), ("contact_step", 5e-5)):
        model = ball(impact=Impact(stiffness=STIFFNESS * (36 if contact_step is None else 600)))
        model = model.with_settings(contact_step=contact_step)
        few = "contact 'floor': time steps of the shortest"
        (line,) = (w for w in simulate(model).validity.warnings if w.startswith(few))
        value = float(re.search(rf": {key} = (\S+) s \(now (\S+) s\)$", line)[1])
        results = simulate(model.with_settings(**{key: value}))
        assert not any(line.startswith(few) for line in results.validity.warnings)
        assert 36 <= results.validity.values("contact_steps")["floor"] <= 60


def test_a_ball_deeper_than_its_radius_is_warned_of():
    soft = simulate(ball(impact=Impact(stiffness=1e3), speed=2.5))
    depth = -soft.contact("floor").gap.min() / R
    assert depth > 1.0
    assert soft.validity.values("contact_depth")["floor"] == pytest.approx(depth, rel=1e-3)
    told = "the center of the ball is beyond the surface"
    assert any(told in line for line in soft.validity.warnings)


@pytest.mark.parametrize(("part", "warned"), [(0.5, False), (1.0, False), (3.0, True)])
def test_a_ball_that_its_weight_holds_closed_is_not_warned_of(part, warned):
    """At its static depth m g / K it rests; three times as deep it is thrown up."""
    model = ball(height=0.0)
    mass, law = model.bodies["ball"].mass, Impact(stiffness=1e4, damping=1.0)
    model = ball(height=-part * mass * G / 1e4, impact=law, t_end=2e-3)
    assert bool(check(model).warnings) == warned


def test_a_graze_is_no_short_contact():
    """Contacts whose peak is below 5 % of the largest do not count, whichever came first."""
    state = initialize(ball()).state
    for peak, steps, shortest in (
        (100.0, 50, 50),
        (4.0, 3, 50),
        (1e4, 80, 80),
        (400.0, 7, 80),
        (600.0, 60, 60),
        (2e4, 70, 70),
    ):
        state.contacts.peak[0], state.contacts.steps[0] = peak, steps
        follow_shortest(state, 0)
        assert state.extremes.shortest[0] == shortest


def test_energy_that_a_contact_creates_is_of_a_contact():
    hard = Impact(stiffness=1e4 * STIFFNESS)
    with pytest.warns(ValidityWarning, match="^contact 'floor': energy created by the force law"):
        simulate(ball(impact=hard, speed=3.0))


@pytest.mark.parametrize(("speed", "warned"), [(1.0, False), (2000.0, True)])
def test_a_patch_too_large_for_hertz_is_warned_of(speed, warned):
    model = ball(speed=speed, t_end=1e-4, gravity=0.0, height=0.0)
    steel = Hertz([2.1e11, 2.1e11], [0.3, 0.3])
    contact = replace(model.contacts[0], hertz=steel, impact=Impact())
    model = replace(model, contacts=[contact]).with_settings(step=2e-7)
    results = simulate(model)
    deepest = -results.contact("floor").gap.min()
    ratio = results.validity.values("hertz_radius")["floor"]
    assert ratio == pytest.approx(np.sqrt(deepest / R), rel=1e-12)
    told = "contact 'floor': contact patch semi-axis / surface radius"
    assert any(line.startswith(told) for line in results.validity.warnings) == warned


def test_a_start_in_contact_is_warned_of_with_its_depth():
    with pytest.warns(ValidityWarning, match=r"^contact 'floor': starts 0.0001 m deep$"):
        simulate(ball(height=-1e-4, t_end=0.01))
    with pytest.warns(ValidityWarning, match=r"^stop 'rest': starts 0.05 rad deep$"):
        simulate(pendulum(0.05, t_end=0.01))
    assert check(ball(height=-1e-4)).warnings == ("contact 'floor': starts 0.0001 m deep",)
    assert (
        "contact 'floor': ball of 0.02 m at ball, on a plane at ground.floor; gap at the "
        "start 0.01 m" in str(check(ball()))
    )
    assert "stop 'rest': angle of joint 'pivot' in [-0.1, inf]; gap at the start 0.1 rad" in str(
        check(pendulum())
    )
    model = ball(height=-1e-4).with_settings(start="equilibrium")
    assert not check(model).warnings


@pytest.mark.parametrize(
    ("depth", "radius", "of"), [(0.021, R, "the radius of its ball"), (0.07, 0.0, "a tenth of the")]
)
def test_a_start_that_is_too_deep_is_refused(depth, radius, of):
    model = ball(height=radius - R - depth)
    model = replace(model, contacts=[replace(model.contacts[0], ball=radius)])
    message = rf"^contact 'floor': starts {depth:g} m deep: expected at most {of}"
    with pytest.raises(ModelError, match=message):
        simulate(model)


def test_a_simulator_gives_contacts_and_never_runs_out_of_room(monkeypatch):
    monkeypatch.setattr(sizes, "EVENT_CAPACITY", 1)
    model = ball(height=1e-6, speed=1.0, restitution=1.0, gravity=500.0, t_end=0.1)
    expected = simulate(model).contact("floor")
    simulator = Simulator(model, outputs=["contacts/floor/gap", "contacts/floor/state"])
    rows, ended = np.empty((1000, 2)), []
    for k in range(1000):
        rows[k] = simulator.step([])
        ended += simulator.events["floor"].end.tolist()
    np.testing.assert_array_equal(rows[:, 0], expected.gap[1:])
    np.testing.assert_array_equal(rows[:, 1], expected.state[1:])
    whole = ~expected.events.still_closed
    np.testing.assert_array_equal(ended, expected.events.end[whole])
    assert len(ended) > 5


def test_a_file_reads_as_memory(tmp_path):
    model = ball(friction=0.3, tangential_stiffness=STIFFNESS, slide=0.1)
    memory = simulate(model).contact("floor")
    simulate(model, output=tmp_path / "out.h5")
    read = Results.read(tmp_path / "out.h5").contact("floor")
    for name in ("gap", "force", "normal", "point", "slip", "state"):
        np.testing.assert_array_equal(getattr(read, name), getattr(memory, name))
    assert str(read.events) == str(memory.events)
    assert str(read.events).splitlines()[0].split()[:3] == ["start", "end", "steps"]
