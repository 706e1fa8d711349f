"""Terms of second order: inertia, foreshortening and stiffening of bodies that turn fast."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    ModelError,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Spring,
    Start,
    simulate,
)

from .test_tangents import Point, assert_newton_matrix, symmetric

AXIS = np.array([1.0, 2.0, 2.0]) / 3.0


@pytest.fixture(scope="module")
def bodies(random_element):
    """Two bodies with terms of second order, whose first interfaces meet, and a rigid one."""

    def body(seed, r):
        element = random_element(seed, (True, False), second_order=r)
        return FlexibleBody(element, Start(-element.interface("i0").X))

    return {"a": body(5, 3), "b": body(6, 4), "c": RigidBody(1.5, [1.0, 2.0, 1.5])}


def test_the_newton_matrix(bodies):
    """Entry by entry, with a bushing, a hinge that is driven, and loads that follow."""
    bushing = Spring(
        "bush",
        "bushing",
        ("a.i0", "b.i0"),
        stiffness=symmetric(1, 50.0),
        damping=symmetric(2, 0.5),
    )
    model = Model(
        bodies,
        (Revolute("ground", "a.i0", AXIS, name="hinge", angle=Harmonic(0.8, 1.0, 0.5)),),
        (Force("b.i1", [1.0, 2.0, -1.0], Constant(1.0), follower=True),),
        (bushing,),
        settings=Settings(t_end=1.0, step=1e-2, rho_inf=0.8),
    )
    point = Point.of(model, seed=11)
    rng = np.random.default_rng(12)
    work, interfaces = point.work, point.state.interfaces
    work.interfaces.u_predicted[:] = interfaces.u + rng.uniform(-1e-3, 1e-3, len(interfaces.u))
    work.interfaces.rate_predicted[:] = rng.uniform(-1.0, 1.0, len(interfaces.u))
    point.evaluated()
    assert_newton_matrix(point)


def tumbling(element, h, rho_inf=0.9, **choice):
    """Two of a body, hinged together, that tumble in gravity."""
    spin = {"angular_velocity": [4.0, -3.0, 5.0]}
    X = element.interface("i0").X
    bodies = {
        name: FlexibleBody(
            element, Start(-X, velocity=np.cross([4.0, -3.0, 5.0], -X), **spin), **choice
        )
        for name in "ab"
    }
    joint = Spherical("a.i0", "b.i0", name="hinge")
    settings = Settings(t_end=0.2, step=h, rho_inf=rho_inf)
    return Model(bodies, (joint,), gravity=[0.0, 0.0, -9.81], settings=settings)


@pytest.fixture(scope="module")
def stiff(random_element):
    """A body whose vibration is resolved, without damping, with terms that are not small."""
    element = random_element(3, (True, False), omega=(8.0, 80.0), second_order=4)
    modes = replace(element.modes, zeta=np.zeros(len(element.modes.omega)))
    quartic = np.einsum("i,j,k,l->ijkl", *4 * [np.array([3.0, -2.0, 1.0, 4.0])])
    return replace(element, modes=modes, rotation=replace(element.rotation, quartic=quartic))


@pytest.mark.parametrize("rho_inf", [0.99, 0.8])
def test_energy_and_momentum_are_of_second_order(stiff, rho_inf):
    errors = []
    for h in (2e-3, 1e-3, 5e-4):
        results = simulate(tumbling(stiff, h, rho_inf))
        energy, momentum = results.energy, np.asarray(results.momentum.angular)
        about = np.cross(results.body("a").x + results.body("b").x, [0.0, 0.0, -9.81])
        scale = np.linalg.norm(momentum[0])
        moment = stiff.mass * np.concatenate(
            [np.zeros((1, 3)), np.cumsum(0.5 * h * (about[1:] + about[:-1]), axis=0)]
        )
        drift = np.abs(momentum - momentum[0] - moment).max() / scale
        errors.append([np.abs(energy.balance).max() / energy.kinetic[0], drift])
        assert energy.elastic.max() > 1e-3 * energy.kinetic[0]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert (orders > 1.8).all(), (errors, orders)


def test_without_them_a_body_is_that_of_a_superelement_that_has_none(stiff):
    off = simulate(tumbling(stiff, 1e-3, second_order="off"))
    none = simulate(tumbling(replace(stiff, rotation=None), 1e-3))
    np.testing.assert_array_equal(off.frame("a.i1").position, none.frame("a.i1").position)


def test_terms_that_vanish_change_nothing(stiff):
    terms = stiff.rotation
    empty = replace(
        terms,
        phi_inertia=0.0 * terms.phi_inertia,
        A_interface=0.0 * terms.A_interface,
        A_inertia=0.0 * terms.A_inertia,
        gyroscopic=0.0 * terms.gyroscopic,
        cubic=None,
        quartic=None,
    )
    full = simulate(tumbling(replace(stiff, rotation=empty), 1e-3, second_order="full"))
    none = simulate(tumbling(stiff, 1e-3, second_order="off"))
    x, expected = full.frame("a.i1").position, none.frame("a.i1").position
    np.testing.assert_allclose(x, expected, rtol=0, atol=1e-10)
    assert np.abs(simulate(tumbling(stiff, 1e-3)).frame("a.i1").position - expected).max() > 1e-3


def test_what_has_no_terms_is_refused(stiff):
    with pytest.raises(ModelError, match=r"second_order = .full.: .* needs \[rotation\]"):
        FlexibleBody(replace(stiff, rotation=None), second_order="full")
    model = tumbling(stiff, 1e-3)
    for change, named in (
        ({"rule": "paper"}, "rule 'paper'"),
        ({"history": "direct"}, "history 'direct'"),
        ({"kernel_length": 0.1}, "memory"),
    ):
        with pytest.raises(ModelError, match=f"body 'a': {named}.*second_order = 'off'"):
            simulate(replace(model, settings=replace(model.settings, **change)))
