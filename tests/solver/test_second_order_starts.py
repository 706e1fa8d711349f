"""Starts of bodies with terms of second order: equilibrium, steady rotation, accelerations."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    Constant,
    FlexibleBody,
    Model,
    ModelError,
    Polynomial,
    Settings,
    Spherical,
    Start,
    SteadyRotation,
    Torque,
    check,
    simulate,
)

AXIS = np.array([1.0, 2.0, 2.0]) / 3.0


@pytest.fixture(scope="module")
def element(random_element):
    return random_element(5, (True, True), second_order=3)


def held(element, kind, second_order="full", **given):
    """A body on a joint at its first interface, in the origin."""
    settings = {name: given.pop(name) for name in list(given) if name not in ("angle", "loads")}
    spin = settings.pop("spin", 0.0)
    X = element.interface("i0").X
    start = Start(-X, velocity=np.cross(spin * AXIS, -X), angular_velocity=spin * AXIS)
    of_joint = {"angle": given["angle"]} if "angle" in given else {}
    axis = [AXIS] if kind == "revolute" else []
    return Model(
        {"a": FlexibleBody(element, start, second_order=second_order)},
        [JOINTS[kind]("ground", "a.i0", *axis, name="joint", **of_joint)],
        loads=given.get("loads", ()),
        gravity=9.81 * AXIS,
        settings=Settings(**({"t_end": 0.1, "step": 1e-4, "rho_inf": 0.9} | settings)),
    )


def test_a_loaded_body_rests(element):
    """Bent far enough that its terms of second order move it."""
    moments = [Torque(f"a.i{k}", s * AXIS, Constant(3e3)) for k, s in ((0, 1), (1, -1))]
    at_rest = {"loads": moments, "start": "equilibrium"}
    found = simulate(held(element, "fixed", **at_rest)).frame("a.i1").u
    linear = simulate(held(element, "fixed", "off", **at_rest)).frame("a.i1").u
    assert np.abs(found - found[0]).max() < 1e-11 * np.abs(found).max()
    assert np.abs(found - linear).max() > 1e-3 * np.abs(linear).max()


@pytest.mark.parametrize("spin", [5.0, 20.0, 60.0])
def test_a_steady_rotation_goes_on(element, spin):
    """Over 1000 steps, about a point that lets the body turn as it likes."""
    steady = {"start": "equilibrium", "steady_rotation": SteadyRotation(spin * AXIS)}
    results = simulate(held(element, "spherical", **steady))
    u, omega = results.frame("a.i1").u, results.body("a").v[:, 3:]
    assert np.abs(u - u[0]).max() < 1e-9 * np.abs(u).max()
    assert np.abs(omega - omega[0]).max() < 1e-9 * spin
    without = simulate(held(element, "spherical", "off", **steady)).frame("a.i1").u
    assert np.abs(u[0] - without[0]).max() > 1e-3 * np.abs(u[0]).max()


def test_it_is_where_a_damped_motion_ends(element):
    damped = replace(element, modes=replace(element.modes, zeta=np.full(8, 0.7)))
    driven = {"angle": Polynomial((0.0, 20.0)), "t_end": 3.0, "step": 5e-4}
    steady = {"start": "equilibrium", "steady_rotation": SteadyRotation(20.0 * AXIS)}
    started = simulate(held(damped, "revolute", spin=20.0, **driven)).frame("a.i1").u
    resting = simulate(held(damped, "revolute", **driven, **steady)).frame("a.i1").u
    assert np.abs(started[0]).max() == 0.0
    assert np.abs(started[-1] - resting[0]).max() < 1e-9 * np.abs(resting).max()


def test_what_the_spin_tears_apart_has_no_equilibrium(element):
    steady = {"start": "equilibrium", "steady_rotation": SteadyRotation(2e3 * AXIS)}
    with pytest.raises(
        ModelError, match=r"start = 'equilibrium': none found, .* is that of body 'a'"
    ):
        simulate(held(element, "spherical", **steady))


def test_accelerations_at_the_start_are_those_of_the_motion(element):
    """Those of a body that spins between two points, under the loads of its rotation at once: they
    go on without a jump.
    """
    first, second = (element.interface(name).X for name in ("i0", "i1"))
    omega = 20.0 * (second - first) / np.linalg.norm(second - first)
    start = Start(-first, velocity=np.cross(omega, -first), angular_velocity=omega)

    def jump(h):
        model = Model(
            {"a": FlexibleBody(element, start)},
            [
                Spherical("ground", "a.i0", name="near"),
                Spherical("ground", "a.i1", name="far"),
            ],
            settings=Settings(t_end=5 * h, step=h, rho_inf=0.9),
        )
        results = simulate(model)
        v, v_dot = results.body("a").v, results.body("a").v_dot[0]
        slope = (-3.0 * v[0] + 4.0 * v[1] - v[2]) / (2.0 * h)
        return np.abs(slope - v_dot).max() / np.abs(v_dot).max()

    coarse, fine = jump(2e-5), jump(1e-5)
    assert coarse < 1e-2
    assert np.log2(coarse / fine) > 1.8


def test_joints_and_frequencies_are_those_without_the_terms(element):
    """Undeformed and at rest."""
    full, off = (check(held(element, "revolute", second)) for second in ("full", "off"))
    np.testing.assert_allclose(full.frequencies, off.frequencies, rtol=1e-10)
    assert full.degrees_of_freedom == off.degrees_of_freedom == 1
    assert full.removed == off.removed == ""
