"""Doubts about models: told of what is unlike any machine, on one side of each limit alone."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Chirp,
    Constant,
    Contact,
    Delayed,
    FlexibleBody,
    Force,
    Frame,
    HalfSine,
    Harmonic,
    Hertz,
    LogarithmicChirp,
    Model,
    Motor,
    Noise,
    Polynomial,
    PrescribedDisplacement,
    PrescribedRotation,
    Prismatic,
    Pulse,
    Revolute,
    RigidBody,
    Settings,
    ShapedNoise,
    Simulator,
    Spline,
    Spring,
    Start,
    Steps,
    Stop,
    Sum,
    Table,
    ValidityWarning,
    check,
    plausibility_warnings,
    simulate,
)
from duhamel.solver.couplings.impact import Impact

BALL = RigidBody(2.0, [0.1, 0.1, 0.1], {"tip": Frame([0.5, 0, 0])})
HINGE = Revolute("ground", "hub", [0, 0, 1], name="pivot")
H = 1e-3


def model(hub=BALL, **changes):
    settings = Settings(t_end=0.1, step=H)
    return Model({"hub": hub}, settings=settings, **changes)


def told(model, severe=None):
    found = plausibility_warnings(model)
    if severe is not None:
        assert all(doubt.severe == severe for doubt in found)
    return [doubt.text for doubt in found]


def only(texts, start):
    """One line that begins so, or none where the beginning is empty."""
    assert len(texts) == bool(start), texts
    assert all(text.startswith(start) for text in texts)
    assert all("\n" not in text for text in texts)


def test_an_ordinary_model_raises_none():
    assert told(model(joints=[HINGE], gravity=[0, 0, -9.81])) == []


@pytest.mark.parametrize(
    ("gravity", "unit"),
    [
        (9.81, ""),
        (1.62, ""),
        (50 * 9.81, ""),
        (9810, "mm/s^2"),
        (9850, ""),
        (981, "cm/s^2"),
        (386.09, "in/s^2"),
        (384.9, ""),
        (32.17, "ft/s^2"),
        (9.81e-3, "km/s^2"),
    ],
)
def test_gravity_in_other_units_is_doubted(gravity, unit):
    turned = np.array([0.6, 0.0, -0.8]) * gravity
    found = told(model(gravity=turned), severe=True)
    only(found, unit and f"simulation.gravity is {gravity:g} m/s^2, on Earth it is 9.81: is it in")
    assert all(unit in text for text in found)


@pytest.mark.parametrize(("angle", "doubted"), [(6.28, False), (6.29, True), (-90.0, True)])
@pytest.mark.parametrize(
    ("key", "parts"),
    [
        ("joints.pivot.start.angle", lambda a: {"joints": [replace(HINGE, start={"angle": a})]}),
        ("joints.pivot.angle", lambda a: {"joints": [replace(HINGE, angle=Constant(a))]}),
        (
            "joints.pivot.angle.polynomial[0]",
            lambda a: {"joints": [replace(HINGE, angle=Polynomial([a, 100.0]))]},
        ),
        (
            "joints.pivot.angle.amplitude",
            lambda a: {"joints": [replace(HINGE, angle=Harmonic(a, 5.0))]},
        ),
        (
            "joints.pivot.reference_coordinates.angle",
            lambda a: {"joints": [replace(HINGE, reference_coordinates={"angle": a})]},
        ),
        (
            "motions.m.angle.amplitude",
            lambda a: {"motions": [PrescribedRotation("m", "hub", [0, 0, 1], Harmonic(a, 5.0))]},
        ),
    ],
)
def test_angles_above_a_turn_are_doubted(key, parts, angle, doubted):
    found = told(model(**parts(angle)), severe=True)
    only(found, f"{key} is {angle:g} rad" if doubted else "")


@pytest.mark.parametrize(("angle", "doubted"), [(6.28, False), (45.0, True)])
def test_rotations_of_bodies_and_frames_above_a_turn_are_doubted(angle, doubted):
    vector = angle * np.array([0.0, 0.6, 0.8])
    body = replace(BALL, frames={"tip": Frame([0.5, 0, 0], vector)}, start=Start(rotation=vector))
    found = told(model(body, ground_frames={"wall": Frame([0, 0, 0], vector)}))
    keys = ("bodies.hub.rotation", "bodies.hub.frames.tip.rotation", "ground.frames.wall.rotation")
    assert [text.split(" is ")[0] for text in found] == [*keys] * doubted


@pytest.mark.parametrize(("limit", "doubted"), [(6.28, False), (90.0, True), (np.inf, False)])
def test_stops_of_angles_above_a_turn_are_doubted(limit, doubted):
    stop = Stop("end", "pivot", "angle", [-1.0, limit], Impact(stiffness=1e5))
    only(told(model(joints=[HINGE], stops=[stop])), "stops.end.range is 90 rad" if doubted else "")


@pytest.mark.parametrize(("rest", "doubted"), [(6.28, False), (30.0, True)])
def test_a_torsion_spring_at_rest_beyond_a_turn_is_doubted(rest, doubted):
    spring = Spring(
        "coil", "torsion", ("ground", "hub"), axis=[0, 0, 1], stiffness=1.0, rest=[rest]
    )
    only(told(model(springs=[spring])), "springs.coil.rest is 30 rad" if doubted else "")


@pytest.mark.parametrize(
    ("reference", "key"),
    [
        (Constant(11.5), "motors.servo.reference is 11.5 rad"),
        (Steps((0.0, 0.01), (3.0, -8.5)), "motors.servo.reference, its largest jump is 11.5 rad"),
        (Steps((0.0, 0.01, 0.02), (6.0, 12.0, 18.0)), ""),
        (Constant(6.2), ""),
    ],
)
def test_references_of_servos_above_a_turn_are_doubted(reference, key):
    motor = Motor("servo", "pivot", "angle", reference=reference, stiffness=1.0, damping=1.0)
    only(told(model(joints=[HINGE], motors=[motor]), severe=True), key)


@pytest.mark.parametrize(
    ("signal", "begins"),
    [
        (Pulse(1.0, 0.1, 0.2), "0.1 s"),
        (HalfSine(1.0, start=0.3, duration=0.05), "0.3 s"),
        (Delayed(0.2, Pulse(1.0, 0.0, 0.1)), "0.2 s"),
        (Pulse(1.0, 0.09, 0.2), ""),
        (Steps((0.2,), (0.0,)), "0.2 s"),
        (Table((0.2, 0.3), (1.0, 2.0)), ""),
        (Constant(0.0), ""),
    ],
)
def test_loads_that_begin_after_the_end_are_doubted(signal, begins):
    """A table is constant before its first time, and so does act."""
    text = f"loads.0.signal begins at {begins}, and the run ends at t_end = 0.1 s" if begins else ""
    push = Force("hub", [1, 0, 0], signal)
    only(told(model(loads=[push]), severe=True), text)


def test_lengths_and_turns_of_long_drives_are_not_angles():
    slide = Prismatic("ground", "hub", [0, 0, 1], name="slide", start={"distance": 90})
    assert told(model(joints=[slide])) == []
    spun = replace(HINGE, angle=Spline([0.0, 1.0, 2.0], [0.0, 50.0, 300.0]))
    assert told(model(joints=[spun])) == []
    path = PrescribedDisplacement("m", "hub", [0, 0, 1], Harmonic(90.0, 5.0))
    assert told(model(motions=[path])) == []


@pytest.mark.parametrize(("radius", "doubted"), [(49.0, False), (51.0, True)])
def test_an_inertia_far_larger_than_the_model_is_doubted(radius, doubted):
    """tr J = 2 m r^2; the model is 0.5 m large."""
    body = RigidBody(2.0, [4.0 / 3.0 * radius**2] * 3, BALL.frames)
    found = told(model(body), severe=False)
    only(found, "bodies.hub.inertia: a radius of gyration" if doubted else "")


@pytest.mark.parametrize(("share", "doubted"), [(1.1e-3, False), (0.9e-3, True)])
def test_a_mass_denser_than_any_solid_is_doubted(share, doubted):
    """A ball of 0.1 m of osmium weighs 104.7 kg, and has J = 2/5 m r^2 about each axis."""
    mass = 25e3 * 4.0 / 3.0 * np.pi * 0.1**3
    body = RigidBody(mass, [share * 0.4 * mass * 0.1**2] * 3, BALL.frames)
    found = told(model(body), severe=False)
    only(found, "bodies.hub.inertia: 104.72 kg with a radius of gyration" if doubted else "")


@pytest.mark.parametrize(
    ("start", "key"),
    [
        (Start(velocity=[0, 4999, 0]), ""),
        (Start(velocity=[0, 5001, 0]), "bodies.hub.velocity makes 5e+03 m/s"),
        (Start(angular_velocity=[0, 0, 9999]), ""),
        (Start(angular_velocity=[0, 0, 10001]), "bodies.hub.angular_velocity makes 5e+03 m/s"),
    ],
)
def test_speeds_above_that_of_sound_in_steel_are_doubted(start, key):
    """The frame of the hub is 0.5 m from its center."""
    only(told(model(replace(BALL, start=start)), severe=False), key)


@pytest.mark.parametrize(("frequency", "doubted"), [(249.0, False), (251.0, True)])
@pytest.mark.parametrize("key", ["loads.0.signal", "joints.pivot.angle", "motions.m.displacement"])
def test_oscillations_that_the_step_does_not_resolve_are_doubted(key, frequency, doubted):
    signal = Harmonic(1.0, frequency)
    parts = {
        "loads.0.signal": {"loads": [Force("hub", [1, 0, 0], signal)]},
        "joints.pivot.angle": {"joints": [replace(HINGE, angle=signal)]},
        "motions.m.displacement": {
            "motions": [PrescribedDisplacement("m", "hub", [1, 0, 0], signal)]
        },
    }
    found = told(model(**parts[key]), severe=True)
    only(found, f"{key}: its highest frequency, 251 Hz, has 4 steps" if doubted else "")


@pytest.mark.parametrize(("frequency", "doubted"), [(249.0, False), (251.0, True)])
@pytest.mark.parametrize(
    "signal",
    [
        lambda f: Chirp(1.0, [1.0, f], [0.0, 1.0]),
        lambda f: LogarithmicChirp(1.0, [1.0, f], [0.0, 1.0]),
        lambda f: Noise(1.0, [1.0, f], 1.0),
        lambda f: ShapedNoise([[1.0, 1.0], [f, 2.0]], 1.0),
        lambda f: Sum([Constant(1.0), Harmonic(1.0, f)]),
    ],
    ids=["chirp", "logarithmic", "noise", "shaped", "sum"],
)
def test_the_highest_frequency_of_a_band_counts(signal, frequency, doubted):
    load = Force("hub", [1, 0, 0], signal(frequency))
    found = told(model(loads=[load]), severe=True)
    only(found, "loads.0.signal: its highest frequency, 251 Hz" if doubted else "")


@pytest.mark.parametrize(("duration", "doubted"), [(4.1e-3, False), (3.9e-3, True)])
def test_pulses_of_few_steps_are_doubted(duration, doubted):
    load = Force("hub", [1, 0, 0], HalfSine(1.0, duration))
    found = told(model(loads=[load]), severe=False)
    only(found, "loads.0.signal: a pulse of 0.0039 s has 3.9 steps of 0.001 s" if doubted else "")


@pytest.mark.parametrize(("phase", "doubted"), [(6.28, False), (90.0, True)])
def test_phases_in_degrees_are_doubted(phase, doubted):
    load = Force("hub", [1, 0, 0], Harmonic(1.0, 5.0, phase))
    only(told(model(loads=[load])), "loads.0.signal.phase is 90 rad" if doubted else "")


@pytest.mark.parametrize(("factor", "doubted"), [(0.99, False), (1.01, True)])
def test_a_step_too_long_for_any_mode_of_a_body_is_doubted(factor, doubted, beam):
    h = factor * 5.0 / float(beam.element.modes.frequencies.min())
    flying = Model({"beam": FlexibleBody(beam.element)}, settings=Settings(t_end=1.0, step=h))
    only(told(flying, severe=False), "bodies.beam: its first elastic frequency" if doubted else "")


def sized(element, radius):
    """A superelement of this radius of gyration [m], sqrt(tr J / 2 m)."""
    J = element.J_rot * (2.0 * element.mass * radius**2 / np.trace(element.J_rot))
    return FlexibleBody(replace(element, J_rot=J))


@pytest.mark.parametrize(("radius", "doubted"), [(99, 0), (101, 1), (1.1e-5, 0), (0.9e-5, 1)])
def test_superelements_from_meshes_in_other_units_are_doubted(radius, doubted, random_element):
    body = sized(random_element(0, (True, False)), radius)
    found = told(Model({"b": body}, settings=Settings(t_end=1.0, step=1e-7)))
    found = [text for text in found if "denser" not in text]
    only(found, "bodies.b.superelement has a radius of gyration of" if doubted else "")


@pytest.mark.parametrize(("ratio", "doubted"), [(990.0, False), (1010.0, True)])
def test_two_superelements_of_sizes_far_apart_are_doubted(ratio, doubted, random_element):
    element = random_element(0, (True, False))
    bodies = {"a": sized(element, 50.0), "b": sized(element, 50.0 / ratio)}
    found = told(Model(bodies, settings=Settings(t_end=1.0, step=1e-7)))
    only(found, "bodies.b.superelement has a radius of gyration of 0.0495 m" if doubted else "")


def test_a_body_with_one_interface_at_its_center_raises_none(random_element):
    element = random_element(0, (True,))
    middle = replace(element.interfaces[0], X=[1e-16, 0, 0])
    body = sized(replace(element, interfaces=(middle,)), 0.2)
    assert told(Model({"b": body}, settings=Settings(t_end=1.0, step=1e-7))) == []


def test_check_tells_the_doubts_among_its_warnings():
    asked = model(gravity=[0, 0, -9810])
    assert plausibility_warnings(asked)[0].text in check(asked).warnings


@pytest.mark.parametrize("run", [simulate, lambda model: Simulator(model, [])])
def test_every_run_warns_of_what_makes_its_numbers_meaningless(run):
    with pytest.warns(ValidityWarning, match=r"^simulation.gravity is 9810 m/s\^2"):
        run(model(gravity=[0, 0, -9810]))


@pytest.mark.parametrize(("radius", "start"), [(0.0106, ""), (0.0101, "contacts.bore.hertz: ")])
def test_a_ball_in_a_tight_bore_is_told_the_force_up_to_which_hertz_holds(radius, start):
    """1 % of clearance: the patch is 0.17 of the radius around the bore at 2.3 kN."""
    bore = Contact(
        "bore",
        ("ground.hole", "hub"),
        "cylinder",
        0.01,
        [0, 0, 1],
        radius=radius,
        hollow=True,
        hertz=Hertz([2.1e11, 2.1e11], [0.3, 0.3]),
    )
    texts = told(model(contacts=[bore], ground_frames={"hole": Frame()}), severe=False)
    only(texts, start)
    if start:
        depth = (0.17 / bore.patch_over_radius) ** 2
        assert f"holds up to {bore.law().stiffness * depth**1.5:.3g} N" in texts[0]
        assert "a clearance of 1 %" in texts[0]
