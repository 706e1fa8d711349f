"""Equilibrium of bodies whose surfaces are in contact."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Frame,
    Model,
    ModelError,
    PatternLoad,
    Revolute,
    Settings,
    Start,
    SurfaceContact,
    check,
    simulate,
)

from .pressing import EDGE, Motion, arm, block

G = 9.81
H = 1e-6
UP = [0.0, 0.0, 1.0]
DOWN = [0.0, 0.0, -G]
ON_FLOOR = {"shape": "plane", "axis": UP}
FLOOR = SurfaceContact("floor", ["block.low", "ground"], **ON_FLOOR)
# what positions of 4 mm, rounded, times the stiffness of a steel block are of its weight
ROUNDED = 2e-5


def resting(bodies, contacts=(FLOOR,), gravity=DOWN, **changes):
    settings = Settings(t_end=200 * H, step=H, rho_inf=0.9, start="equilibrium")
    return Model(bodies, surface_contacts=contacts, gravity=gravity, settings=settings, **changes)


def placed(height=0.5 * EDGE, x=0.0, element=None, rotation=(0.0, 0.0, 0.0)):
    return FlexibleBody(element or block(), Start([x, 0.0, height], rotation=rotation))


def force_of(motion):
    return motion.state.surfaces.total_force.copy()


def stays(motion, steps=200):
    """Whether nothing moves, by more than rounding, in steps of time."""
    x, force = motion.state.bodies.x.copy(), force_of(motion)
    assert motion.step(steps)
    assert np.abs(motion.state.bodies.x - x).max() < 1e-12
    np.testing.assert_allclose(force_of(motion), force, atol=ROUNDED * np.abs(force).max())
    return True


@pytest.mark.parametrize("gap", [-1e-6, 0.0, 1e-7, 1e-3])
@pytest.mark.parametrize("rotation", [(0.0, 0.0, 0.0), (0.02, 0.03, 0.5)])
def test_a_block_rests_on_the_floor_with_its_weight(gap, rotation):
    motion = Motion(resting({"block": placed(0.5 * EDGE + gap, rotation=rotation)}))
    weight = block().mass * G
    np.testing.assert_allclose(force_of(motion), [[0.0, 0.0, weight]], atol=ROUNDED * weight)
    assert motion.state.bodies.x[0, 2] == pytest.approx(0.5 * EDGE, abs=1e-10)
    assert motion.state.surfaces.force.min() >= 0.0
    assert stays(motion)


def test_a_block_on_its_edge_tips_over_on_to_its_face():
    """A long way, in steps in which rows close and open."""
    contact = replace(FLOOR, friction=0.3)
    motion = Motion(resting({"block": placed(0.0055, rotation=(0.0, 0.6, 0.0))}, [contact]))
    assert motion.state.bodies.x[0, 2] == pytest.approx(0.5 * EDGE, abs=1e-10)
    assert motion.state.surfaces.normal_force[0] == pytest.approx(block().mass * G, rel=ROUNDED)
    assert stays(motion)


def test_the_start_is_where_a_damped_block_comes_to_rest():
    element = block()
    modes = replace(element.modes, zeta=np.full(len(element.modes.omega), 0.5))
    damped = placed(element=replace(element, modes=modes))
    pressed = resting({"block": damped}, gravity=[0.0, 0.0, -1e5])
    start = Motion(pressed)
    # in steps that resolve the modes, whose damping takes the vibration
    settled = Motion(pressed.with_settings(start="given", step=0.1 * H))
    assert settled.step(5000)
    found, expected = start.state, settled.state
    largest = np.abs(expected.surfaces.u).max()
    np.testing.assert_allclose(found.surfaces.u, expected.surfaces.u, atol=1e-6 * largest)
    np.testing.assert_allclose(found.bodies.x, expected.bodies.x, atol=1e-6 * largest)
    largest = expected.surfaces.force.max()
    np.testing.assert_allclose(found.surfaces.force, expected.surfaces.force, atol=1e-6 * largest)


def test_the_energies_of_a_body_at_rest_are_those_of_its_deformation():
    results = simulate(resting({"block": placed()}, gravity=[0.0, 0.0, -1e5]), force=True)
    energy = results.energy
    assert energy.elastic[0] > 0.0
    np.testing.assert_allclose(energy.elastic, energy.elastic[0], rtol=1e-6)
    assert np.abs(energy.balance).max() < 1e-6 * energy.elastic[0]
    assert np.abs(energy.kinetic).max() < 1e-12 * energy.elastic[0]


def test_a_layer_is_pressed_by_the_weight():
    layer = 1e9
    motion = Motion(resting({"block": placed()}, [replace(FLOOR, layer=layer)]))
    depth = 0.5 * EDGE - motion.state.bodies.x[0, 2]
    assert depth == pytest.approx(block().mass * G / (layer * EDGE**2), rel=1e-4)
    assert stays(motion)


@pytest.mark.parametrize("friction", [None, 0.3])
def test_blocks_rest_on_one_another(friction):
    bodies, contacts = {}, []
    for k in range(4):
        below = "ground" if k == 0 else f"{k - 1}.top"
        keys = ON_FLOOR if k == 0 else {}
        bodies[f"{k}"] = placed((k + 0.5) * EDGE + 1e-7 * (k + 1), 3e-4 * k * (-1) ** k)
        contacts.append(SurfaceContact(f"on {k}", [f"{k}.low", below], friction=friction, **keys))
    motion = Motion(resting(bodies, contacts))
    weights = block().mass * G * np.arange(4, 0, -1)
    np.testing.assert_allclose(motion.state.surfaces.normal_force, weights, rtol=ROUNDED)
    assert stays(motion)


def inclined(degrees, friction=0.3):
    angle = np.deg2rad(degrees)
    gravity = [G * np.sin(angle), 0.0, -G * np.cos(angle)]
    contact = replace(FLOOR, friction=friction)
    return resting({"block": placed(0.5 * EDGE + 1e-7)}, [contact], gravity)


@pytest.mark.parametrize("degrees", [0.0, 10.0, 16.0])
def test_friction_holds_a_block_on_an_incline(degrees):
    motion = Motion(inclined(degrees))
    weight, angle = block().mass * G, np.deg2rad(degrees)
    expected = [[-weight * np.sin(angle), 0.0, weight * np.cos(angle)]]
    np.testing.assert_allclose(force_of(motion), expected, atol=ROUNDED * weight)
    assert motion.state.bodies.x[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert stays(motion)


def test_a_block_that_slides_is_refused():
    with pytest.raises(ModelError, match="'floor': closed, but nothing comes to rest there"):
        Motion(inclined(20.0))


def test_a_block_beyond_an_edge_is_refused():
    bodies = {"block": placed(), "upper": placed(1.5 * EDGE, 0.6 * EDGE)}
    on_block = SurfaceContact("edge", ["upper.low", "block.top"])
    with pytest.raises(ModelError, match="'edge': closed, but nothing comes to rest there"):
        Motion(resting(bodies, [FLOOR, on_block]))


def test_a_body_without_its_contact_falls_freely():
    with pytest.raises(ModelError, match=r"body 'block' has moved .* without coming to rest"):
        Motion(resting({"block": placed()}, gravity=[0.0, 0.0, G]))


def test_the_place_in_space_changes_nothing():
    far = np.array([1000.0, -500.0, 200.0])
    floor = replace(FLOOR, surfaces=["block.low", "ground.floor"])
    body = FlexibleBody(block(), Start(far + np.array([0.0, 0.0, 0.5 * EDGE + 1e-7])))
    motion = Motion(resting({"block": body}, [floor], ground_frames={"floor": Frame(tuple(far))}))
    weight = block().mass * G
    # Positions of a kilometer are rounded to 1e-13 m, which is some 1e-4 N at this stiffness.
    np.testing.assert_allclose(force_of(motion), [[0.0, 0.0, weight]], atol=0.01 * weight)


def test_an_arm_on_a_hinge_leans_on_the_floor():
    body = FlexibleBody(arm(), Start([0.0, 0.0, 0.0]))
    hinge = Revolute("ground", "arm.root", [0.0, 1.0, 0.0], name="hinge")
    contact = SurfaceContact("floor", ["arm.low", "ground.floor"], **ON_FLOOR)
    below = {"floor": Frame((0.0, 0.0, -0.0025))}
    motion = Motion(resting({"arm": body}, [contact], joints=[hinge], ground_frames=below))
    place, force = motion.state.surfaces.center[0], force_of(motion)[0]
    weight, middle = arm().mass * G, motion.state.bodies.x[0, 0]
    root = motion.work.frames.r[motion.lowered.frame_names.index("arm.root"), 0]
    assert place[0] > 0.02
    assert force[2] * (place[0] - root) == pytest.approx(weight * (middle - root), rel=1e-6)
    assert stays(motion)


def test_a_pattern_presses_with_its_force():
    load = PatternLoad("block", "press", Constant(0.5))
    model = resting({"block": placed(element=block(spread=True))}, loads=[load])
    weight = block().mass * G
    results = simulate(model, force=True)
    force = results.contact("floor").force
    np.testing.assert_allclose(force[:, 2], 0.5 + weight, rtol=ROUNDED)
    x = results.body("block").x
    assert np.abs(x - x[0]).max() < 1e-12


def test_checks_know_a_body_that_rests_on_a_surface():
    found = check(resting({"block": placed()}))
    assert "contact 'floor'" in "".join(found.contacts)
