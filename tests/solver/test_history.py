"""Two evaluators of one convolution: modes that carry the history, and the sum over all past loads."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import Constant, FlexibleBody, Harmonic, Joint, Load, Model, ModelError, RigidBody, Start, simulate
from duhamel.superelement import StepWarning

STEPS = 200


def tangle(first, second, third, **settings):
    """Three flexible bodies with different interfaces and a rigid one, joined, loaded from t = 0 on."""
    place = Start(position=[0.0, 0.0, 0.0])
    bodies = {
        "a": FlexibleBody(first, Start(angular_velocity=[0.5, -1.0, 2.0])),
        "block": RigidBody(1.5, [1.0, 2.0, 1.5], {}, place),
        "b": FlexibleBody(second, Start(position=first.interface("i0").X - second.interface("i1").X)),
        "c": FlexibleBody(third, Start(position=first.interface("i1").X - third.interface("i0").X)),
    }
    return Model(
        bodies=bodies,
        joints=(
            Joint("ab", "revolute", ("a.i0", "b.i1"), [0.3, 0.5, 1.0]),
            Joint("ac", "spherical", ("a.i1", "c.i0")),
            Joint("weld", "cylindrical", ("block", "c.i2"), third.interface("i2").X + bodies["c"].start.position),
        ),
        loads=(
            Load("force", "b.i0", [1.0, -2.0, 0.5], Constant(3.0)),
            Load("torque", "a.i0", [0.2, 0.0, 1.0], Harmonic(2.0, 40.0, 1.0), follower=True),
            Load("force", "c.i1", [0.0, 1.0, 0.0], Harmonic(5.0, 13.0, 1.0)),
        ),
        t_end=STEPS * 1e-3,
        gravity=[0.0, 0.0, -9.81],
        step=1e-3,
        rho_inf=0.9,
        tolerance=1e-13,
        **settings,
    )


def state(results):
    """Positions and elastic displacements over time. (Multipliers follow from them, over h^2.)"""
    return (
        np.hstack([results.body(name).x for name in "abc"]),
        np.hstack([results.frame(f"{name}.i{k}").u for name in "abc" for k in (0, 1)]),
    )


@pytest.fixture(scope="module")
def elements(random_element):
    return (
        random_element(1, (True, False)),
        random_element(2, (False, True), modes=5),
        random_element(3, (False, False, True), modes=12),
    )


@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_recursion_and_direct_sum_agree(elements, measured, rule):
    recursive = state(simulate(tangle(*elements, rule=rule, history="recursive")))
    for direct in (
        simulate(tangle(*elements, rule=rule, history="direct")),
        simulate(tangle(*(measured(element) for element in elements), rule=rule)),
        simulate(tangle(elements[0], measured(elements[1]), elements[2], rule=rule)),
    ):
        for found, expected in zip(state(direct), recursive, strict=True):
            assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()


def test_the_rules_differ(elements):
    (_, consistent), (_, paper) = (state(simulate(tangle(*elements, rule=rule))) for rule in ("consistent", "paper"))
    assert np.abs(consistent - paper).max() > 1e-3 * np.abs(consistent).max()


def test_a_body_without_modes_cannot_be_recursive(elements, measured):
    model = tangle(*(measured(element) for element in elements), history="recursive")
    with pytest.raises(ModelError, match=r"body 'a': history 'recursive' needs modes, and .*'random 1' has none"):
        simulate(model)


@pytest.mark.parametrize("history", ["recursive", "direct"])
def test_a_step_finer_than_the_modes_hold_for_is_told_once(history, random_element):
    """Two bodies of one superelement, at rest."""
    element = random_element(0, (True,))
    element = replace(element, modes=replace(element.modes, h_min=1e-3))
    bodies = {name: FlexibleBody(element, Start(position=[0.0, 0.0, 0.0])) for name in ("a", "b")}
    model = Model(bodies=bodies, t_end=1e-3, step=5e-4, rho_inf=0.9, history=history)
    with pytest.warns(StepWarning, match=r"modes for steps down to 0\.001 s.* asked for steps of 0\.0005 s") as told:
        simulate(model)
    assert len(told) == 1
