"""Numerical dissipation that constraints need: without it their forces grow from rounding."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Frame,
    Model,
    ModelError,
    PrescribedDisplacement,
    Revolute,
    RigidBody,
    Settings,
    Spherical,
    Spring,
    Start,
    simulate,
)

Z, RADIUS = [0, 0, 1], 0.99


def pendulum(**settings):
    rod = RigidBody(1.0, [0.01, 0.09, 0.09], {"eye": Frame([-0.5, 0, 0])}, Start([0.5, 0, 0]))
    pivot = Revolute("ground", "rod.eye", Z, name="pivot")
    return Model({"rod": rod}, [pivot], gravity=[0, -9.81, 0], settings=Settings(**settings))


def two_bodies(**settings):
    spin = Start(velocity=[0, 0.1, 0], angular_velocity=[0, 0, 1])
    bodies = {
        "a": RigidBody(1.0, [0.01, 0.02, 0.03], {"end": Frame([0.5, 0, 0])}, spin),
        "b": RigidBody(1.0, [0.03, 0.02, 0.01], {"end": Frame([-0.5, 0, 0])}, Start([1.0, 0, 0])),
    }
    ball = Spherical("a.end", "b.end", name="ball")
    return Model(bodies, [ball], settings=Settings(**settings))


@pytest.mark.parametrize("rho_inf", [0.991, 0.999, 1.0])
def test_constraints_refuse_a_scheme_without_dissipation(rho_inf):
    message = (
        r"simulation: rho_inf: expected at most 0\.99 in a model with joints or motions "
        rf"\(joint 'pivot'\), whose forces would grow from rounding, got {rho_inf:g}$"
    )
    with pytest.raises(ModelError, match=message):
        simulate(pendulum(t_end=1.0, step=1e-3, rho_inf=rho_inf))


def test_motions_are_constraints_too():
    hold = PrescribedDisplacement("hold", "rod", [1, 0, 0], Constant(0.0))
    model = replace(pendulum(t_end=1.0, step=1e-3, rho_inf=1.0), joints=(), motions=(hold,))
    with pytest.raises(ModelError, match=r"rho_inf: .* \(motion 'hold'\)"):
        simulate(model)


def test_springs_need_no_dissipation():
    """Of an oscillator, which keeps its energy over 1600 periods."""
    spring = Spring("pull", "point", ("ground.post", "rod"), stiffness=1e4, rest=[0.4])
    model = replace(
        pendulum(t_end=100.0, step=1e-3, rho_inf=1.0),
        joints=(),
        springs=(spring,),
        ground_frames={"post": Frame()},
        gravity=[0, 0, 0],
    )
    x = simulate(model).body("rod").x[:, 0]
    assert np.abs(x[-1000:] - 0.4).max() == pytest.approx(0.1, rel=1e-3)


@pytest.mark.parametrize("make", [pendulum, two_bodies])
def test_forces_stay_clean_for_1e5_steps_at_the_largest_radius(make):
    """The second difference of a smooth force is of order (omega h)^2; what alternates shows."""
    model = make(t_end=100.0, step=1e-3, rho_inf=RADIUS)
    every = model.with_settings(output=replace(model.settings.output, quantities=("joints",)))
    force = simulate(every).joint(model.joints[0].name).force
    assert np.abs(np.diff(force[-5000:], 2, axis=0)).max() < 1e-4 * np.abs(force).max()
