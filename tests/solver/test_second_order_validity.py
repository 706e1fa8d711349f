"""What a run says of its validity where bodies have terms of second order, and where they lack."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.preprocess.body.body import NonlinearCoordinates
from duhamel.results.criteria import CRITERIA
from duhamel.solver import FlexibleBody, Model, Settings, Start, simulate, start
from duhamel.solver.model.bodies import SecondOrder
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.second_order import inertia_taken, load_second_order

from .conftest import make_beam
from .test_validity import OF_SECOND_ORDER as SECOND

FIRST = ("elastic_rotation", "elastic_displacement", "spin")


@pytest.fixture(scope="module")
def element():
    return make_beam(rotation=NonlinearCoordinates()).element


def spun(element, spin, second_order: SecondOrder = "auto", h=1e-3, steps=20):
    start_ = Start(angular_velocity=spin)
    body = FlexibleBody(element, start_, second_order=second_order)
    return Model({"beam": body}, settings=Settings(t_end=steps * h, step=h, rho_inf=0.9))


@pytest.mark.parametrize("second_order", ["full", "off"])
def test_bodies_are_judged_by_the_criteria_of_their_order(element, second_order):
    validity = simulate(spun(element, [0.0, 0.0, 20.0], second_order)).validity
    judged = {check.criterion.name for check in validity.checks}
    expected, others = (SECOND, FIRST) if second_order == "full" else (FIRST, SECOND)
    assert judged >= {*expected}
    assert not judged & {*others}


def test_a_body_whose_stress_is_unknown_is_judged_as_it_stiffens(element):
    """As one without terms, but for what only their motion has."""
    unknown = replace(element, rotation=replace(element.rotation, kappa=np.zeros(0)))
    spin = 1.01 * CRITERIA["spin"].limit * element.modes.omega.min()
    validity = simulate(spun(unknown, [0.0, 0.0, spin])).validity
    judged = {check.criterion.name for check in validity.checks}
    assert judged >= {*FIRST, "spin_turn", "inertia_taken"}
    assert not judged & {"second_order_rotation", "second_order_displacement"}
    assert any("stiffening is missing" in warning for warning in validity.warnings)


@pytest.mark.parametrize(("h", "warned"), [(7.4e-4, False), (7.6e-4, True)])
def test_a_turn_in_a_step_is_warned_of_beyond_its_limit(element, h, warned):
    spin = 200.0
    validity = simulate(spun(element, [0.0, 0.0, spin], h=h)).validity
    found = validity.values("spin_turn")["beam"]
    assert found == pytest.approx(spin * h, rel=1e-2)
    assert any("rotation per step" in warning for warning in validity.warnings) == warned


def test_a_body_that_spins_fast_without_terms_is_told_of_rotation(element):
    spin = 1.01 * CRITERIA["spin"].limit * element.modes.omega.min()
    (warning,) = [
        warning
        for warning in simulate(spun(element, [0.0, 0.0, spin], "off")).validity.warnings
        if "spin /" in warning
    ]
    assert "[rotation]" in warning


@pytest.mark.parametrize("amplitude", [0.0, 0.1, 0.3, 1.0, 3.0, 10.0])
def test_the_inertia_that_elastic_motion_takes(random_element, amplitude):
    """All of it, or more, where the kinetic energy of turning and vibrating is not positive."""
    element = random_element(5, (True, True), second_order=3)
    model = Model({"a": FlexibleBody(element)}, settings=Settings(t_end=0.2, step=1e-3))
    initial = initialize(model)
    elastic, state, work = initial.lowered.system.elastic, initial.state, initial.work
    q = amplitude * np.array([0.3, -0.5, 0.4])
    state.interfaces.u[-3:] = q
    load_second_order(elastic, state, work)
    H = np.einsum("k,ikl->il", q, element.rotation.gyroscopic)
    mass = np.block([[work.bodies.J[0], H], [H.T, np.eye(3)]])
    taken = inertia_taken(elastic, 0, state, work)
    assert (taken >= 1.0) == (np.linalg.eigvalsh(mass).min() <= 0.0)
    left = work.bodies.J[0] - H @ H.T
    minors = [
        np.array([np.linalg.det(M[:n, :n]) for n in (1, 2, 3)]) for M in (left, element.J_rot)
    ]
    pivots = [minor / np.concatenate([[1.0], minor[:-1]]) for minor in minors]
    assert taken == pytest.approx(1.0 - (pivots[0] / pivots[1]).min(), rel=1e-10, abs=1e-14)


def test_it_is_followed_in_every_step(random_element):
    element = random_element(5, (True, True), second_order=3)
    body = FlexibleBody(element, Start(angular_velocity=[3.0, -2.0, 4.0]))
    at_rest, turning = (
        Model({"a": which}, settings=Settings(t_end=0.2, step=1e-3))
        for which in (FlexibleBody(element), body)
    )
    assert start(at_rest).validity.values("inertia_taken")["a"] == pytest.approx(0.0, abs=1e-12)
    assert 0.0 < simulate(turning).validity.values("inertia_taken")["a"] < 0.5
