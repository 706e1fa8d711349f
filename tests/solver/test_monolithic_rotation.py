"""Bodies with the second order of their elastic motion against all modes as unknowns: equal to
rounding, whatever the tensors.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Place,
    Polynomial,
    RigidBody,
    Start,
    Torque,
    simulate,
)
from duhamel.superelement import Chain

from .models import model_of
from .monolithic_rotation import RotatingReference

H, STEPS = 2e-3, 200
MODES, R = 8, 4
RIM = np.array([0.3, -0.1, 0.2])


@pytest.fixture
def body(random_element):
    """A body of random numbers that is soft enough to be deformed by its rotation."""

    def make(seed, stress=False):
        element = random_element(seed, (True, True), MODES, omega=(8.0, 150.0), second_order=R)
        modes, rotation = element.modes, element.rotation
        return replace(
            element,
            modes=replace(modes, phi=0.5 * modes.phi),
            compliance=0.25 * element.compliance,
            accelerance=0.25 * element.accelerance,
            J_rot=element.J_rot + 2.0 * np.eye(3),
            rotation=replace(
                rotation,
                A_inertia=10.0 * rotation.A_inertia,
                cubic=1e3 * rotation.cubic if stress else None,
                quartic=1e4 * rotation.quartic if stress else None,
            ),
        )

    return make


def carousel(element, spin, loads, pivot, **settings):
    """A hub on a pivot with the body on its rim."""
    center = RIM - element.interface("i0").X
    start = Start(
        place=Place("i0", "hub.rim"), velocity=np.cross(spin, center), angular_velocity=spin
    )
    hub = RigidBody(0.5, [0.6, 0.7, 0.8], {"rim": Frame(RIM)}, Start(angular_velocity=spin))
    axis = [[0, 0, 1]] if pivot == "revolute" else []
    return model_of(
        bodies={"hub": hub, "body": FlexibleBody(element, start)},
        joints=(
            JOINTS[pivot]("ground", "hub", *axis, name="pivot"),
            Fixed("hub.rim", "body.i0", name="clamp"),
        ),
        loads=loads,
        t_end=STEPS * H,
        step=H,
        tolerance=1e-13,
        **settings,
    )


def assert_equal_motions(model, element, pivot, lift):
    settings = model.settings
    hub = model.bodies["hub"]
    reference = RotatingReference(
        element,
        hub.inertia,
        hub.mass,
        RIM,
        settings.step,
        settings.rho_inf,
        revolute=pivot == "revolute",
        gravity=np.asarray(model.gravity, dtype=float),
    )
    results = simulate(model)
    torque = 0.3 * results.time
    tip_force = np.outer(torque, lift) / 0.3
    _, u, v, _ = reference.run(torque, tip_force, spin=hub.start.angular_velocity)
    found_u = np.hstack([results.frame(f"body.{name}").u for name in ("i0", "i1")])
    pairs = {
        "displacements": (found_u, u),
        "spin": (results.body("body").v[:, 3:], v[:, 9:12]),
        "velocity": (results.body("body").v[:, :3], v[:, 6:9]),
        "spin of the hub": (results.body("hub").v[:, 3:], v[:, 3:6]),
    }
    errors = {
        name: np.abs(found - expected).max() / np.abs(expected).max()
        for name, (found, expected) in pairs.items()
    }
    assert np.abs(u).max() > 0.01
    assert max(errors.values()) < 1e-10, errors


LIFT = np.array([0.3, -0.5, 1.0])


def ramps():
    """From zero on, so that the start has no load."""
    return (
        Torque("hub", [0, 0, 0.3], Polynomial((0.0, 1.0))),
        Force("body.i1", LIFT, Polynomial((0.0, 1.0))),
    )


@pytest.mark.parametrize("rho_inf", [0.9, 0.5])
@pytest.mark.parametrize(
    ("pivot", "spin"), [("revolute", (0.0, 0.0, 4.0)), ("spherical", (1.0, 2.0, 3.0))]
)
def test_a_body_that_turns_fast_moves_like_all_its_modes(body, pivot, spin, rho_inf):
    element = body(3)
    model = carousel(
        element, np.array(spin), ramps(), pivot, rho_inf=rho_inf, gravity=[0.3, -3.0, -2.0]
    )
    assert_equal_motions(model, element, pivot, LIFT)


def test_the_same_where_the_material_loses_energy(body):
    element = body(3)
    chain = Chain(np.array([1e-3, 0.1]), np.array([0.2, 0.3]))
    element = replace(element, modes=replace(element.modes, chain=chain))
    model = carousel(element, np.array([1.0, 2.0, 3.0]), ramps(), "spherical", rho_inf=0.8)
    assert_equal_motions(model, element, "spherical", LIFT)


def test_a_strain_energy_beyond_the_second_order_is_that_of_all_modes(body):
    element = body(4, stress=True)
    model = carousel(element, np.array([1.0, 2.0, 3.0]), ramps(), "spherical", rho_inf=0.8)
    assert_equal_motions(model, element, "spherical", LIFT)


def test_without_its_second_order_the_body_moves_otherwise(body):
    """The terms count: a motion without them is off by a hundredth and more."""
    element = body(3)
    model = carousel(element, np.array([1.0, 2.0, 3.0]), ramps(), "spherical", rho_inf=0.9)
    plain = replace(element, rotation=None)
    without = carousel(plain, np.array([1.0, 2.0, 3.0]), ramps(), "spherical", rho_inf=0.9)
    u, other = (simulate(m).frame("body.i1").u for m in (model, without))
    assert np.abs(u - other).max() > 0.01 * np.abs(u).max()
