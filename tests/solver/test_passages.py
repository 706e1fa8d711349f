"""Balls that are faster than a step can see: found by the path of each within a step."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Contact,
    Frame,
    Impact,
    MissedContactError,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Start,
    simulate,
)

SPEED, STEP = 50.0, 1e-3
BALL, RADIUS = 0.004, 0.006
SIZE = BALL + RADIUS
CIRCLE = np.linspace(0.0, 2.0 * np.pi, 17)
SHAPES = {
    "sphere": {"radius": RADIUS},
    "cylinder": {"radius": RADIUS, "axis": [0, 0, 1]},
    "profile": {
        "points": RADIUS * np.column_stack([np.cos(CIRCLE), np.sin(CIRCLE % CIRCLE[-1])]),
        "axis": [0, 0, 1],
    },
}
SHAPES["profile"]["points"][-1] = SHAPES["profile"]["points"][0]


def shot(shape, offset, angle=0.3, turning=0.0, when=1.5 * STEP, stiffness=1e8, **settings):
    """A ball that flies past a shape of the same mass at a distance, both ends of the step off it.

    when: the time when the ball is nearest; turning: spin of the shape's body about z, whose frame
    is then off its center by 0.1 m and rests at the origin.
    """
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    aside = np.array([-along[1], along[0], 0.0])
    length = 0.1 if turning else 0.0
    arm = length * np.array([np.cos(turning * when), np.sin(turning * when), 0.0])
    velocity = -np.cross([0, 0, turning], arm)
    start = Start(
        position=-arm - when * velocity, velocity=velocity, angular_velocity=[0, 0, turning]
    )
    target = RigidBody(1.0, [1e-3] * 3, {"frame": Frame([length, 0, 0])}, start)
    middle = -SPEED * when * along
    ball = RigidBody(
        1.0, [1e-3] * 3, start=Start(position=middle + offset * aside, velocity=SPEED * along)
    )
    contact = Contact(
        "blow",
        ("target.frame", "ball"),
        shape,
        BALL,
        impact=Impact(stiffness=stiffness),
        **SHAPES[shape],
    )
    settings = Settings(t_end=4 * STEP, step=STEP, rho_inf=0.9, **settings)
    return Model({"target": target, "ball": ball}, contacts=[contact], settings=settings)


@pytest.mark.parametrize("turning", [0.0, 60.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_ball_passes_unseen_only_where_it_does_not_touch(shape, turning):
    """In a straight line at a distance below the radii of both it touches, else it does not."""
    for k, offset in enumerate(np.array([-0.99, -0.7, 0.0, 0.4, 0.99]) * SIZE):
        model = shot(shape, offset, angle=0.3 + k, turning=turning)
        with pytest.raises(
            MissedContactError, match=r"^contact 'blow': stopped in step 2 "
        ) as error:
            simulate(model)
        assert (error.value.contact, error.value.time) == ("blow", pytest.approx(2 * STEP))
        assert "expected a `contact_step` (or `step`) of " in str(error.value)
    for k, offset in enumerate(np.array([-1.2, -1.01, 1.01, 1.2]) * SIZE):
        results = simulate(shot(shape, offset, angle=0.3 + k, turning=turning))
        np.testing.assert_allclose(np.linalg.norm(results.body("ball").v[-1]), SPEED, rtol=1e-12)


@pytest.mark.parametrize("tilt", [0.3, 0.8])
def test_a_ball_that_crosses_a_short_cylinder_aslant_is_found(tilt):
    """It is beyond an end both before and after the step, where the gap counts both distances."""
    along = np.array([np.cos(tilt), 0.0, np.sin(tilt)])
    velocity = 4.0 * SPEED * along
    start = Start(position=-1.5 * STEP * velocity, velocity=velocity)
    ball, model = RigidBody(1.0, [1e-3] * 3, start=start), shot("cylinder", 0.0)
    pin = replace(model.contacts[0], length=4.0 * RADIUS)
    with pytest.raises(MissedContactError, match="in step 2 "):
        simulate(replace(model, bodies={**model.bodies, "ball": ball}, contacts=[pin]))


def test_short_steps_take_the_place_of_the_long_one_that_passes():
    """Two equal balls exchange their velocities along the line of their centers."""
    for offset in (0.0, 0.5 * SIZE):
        results = simulate(shot("sphere", offset, stiffness=1e11, contact_step=2e-7))
        assert len(results.contact("blow").events) == 1
        lost = SPEED * np.sqrt(1.0 - (offset / SIZE) ** 2)
        got = np.linalg.norm(results.body("ball").v[0, :3] - results.body("ball").v[-1, :3])
        assert got == pytest.approx(lost, rel=1e-2)


def test_a_contact_step_that_is_too_long_is_an_error_too():
    with pytest.raises(MissedContactError, match=r"within one step of 0.0005 s, at 50 m/s"):
        simulate(shot("sphere", 0.0, when=1.25 * STEP, contact_step=5e-4))


def test_a_simulator_stops_as_well():
    simulator = Simulator(shot("cylinder", 0.0), ["bodies/ball/x"])
    simulator.step([])
    with pytest.raises(MissedContactError, match="in step 2 "):
        simulator.step([])


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize(("gap", "passes"), [(-5e-4, True), (5e-4, False)])
def test_a_pendulum_passes_a_peg_by_the_arc_of_its_bob(side, gap, passes):
    """A tenth of a radian a step: the chord is 1.25 mm off the arc. side: of the arc."""
    length, spin, h = 1.0, 10.0, 1e-2
    bob = RigidBody(
        1.0,
        [1e-2] * 3,
        {"pin": Frame([0, 0, length])},
        Start(
            position=[0, 0, -length], velocity=[-spin * length, 0, 0], angular_velocity=[0, spin, 0]
        ),
    )
    angle = 0.15  # in the middle of the second step
    place = (length + side * (SIZE + gap)) * np.array([-np.sin(angle), 0.0, -np.cos(angle)])
    model = Model(
        {"bob": bob},
        [Revolute("ground.pin", "bob.pin", [0, 1, 0], name="pin")],
        contacts=[
            Contact(
                "peg",
                ("ground.peg", "bob"),
                "sphere",
                BALL,
                impact=Impact(stiffness=1e6),
                radius=RADIUS,
            )
        ],
        ground_frames={"pin": Frame(), "peg": Frame(place)},
        settings=Settings(t_end=5 * h, step=h, rho_inf=0.9),
    )
    if passes:
        with pytest.raises(MissedContactError, match="in step 2 "):
            simulate(model)
    else:
        simulate(model)


def test_what_bounces_on_one_corner_has_not_passed_with_another():
    """The velocity of the far end turns round within a step, as if it had been below the floor."""
    rod = RigidBody(
        1.0,
        [1e-4, 1e-2, 1e-2],
        {"left": Frame([-0.1, 0, 0]), "right": Frame([0.1, 0, 0])},
        Start(position=[0, 0, 1.0e-2], velocity=[0, 0, -20.0]),
    )
    feet = [
        Contact(name, ("ground.floor", f"rod.{name}"), "plane", 0.0, [0, 0, 1], impact=law)
        for name, law in (("left", Impact(stiffness=1e7)), ("right", Impact(stiffness=1e7)))
    ]
    model = Model(
        {"rod": rod},
        contacts=feet,
        ground_frames={"floor": Frame()},
        settings=Settings(t_end=2e-2, step=1e-3),
    )
    tilted = replace(rod, start=replace(rod.start, rotation=[0, -1e-3, 0]))
    simulate(replace(model, bodies={"rod": tilted}))
