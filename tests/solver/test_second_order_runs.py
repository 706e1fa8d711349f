"""Runs of bodies with terms of second order: in parts, one after the other, in two sizes of steps,
step by step, and their fields.
"""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    RecoveryError,
    Results,
    Revolute,
    Settings,
    Simulator,
    Start,
    StateError,
    SteadyRotation,
    simulate,
)
from duhamel.solver.lower.lower import lower
from duhamel.solver.start.initial import initialize
from duhamel.solver.step.sizes import change_size
from duhamel.superelement import Recovery, read, write

from .frameworks import bar
from .test_contact_step import LENGTH, falling_bar
from .test_handover import FIRST, LAST, first_run
from .test_restart import H, assert_same, in_parts, machine


@pytest.fixture(scope="module")
def element(coarse, with_second_order):
    return with_second_order(coarse)


@pytest.fixture(scope="module")
def thick(tmp_path_factory, with_second_order):
    return with_second_order(bar(tmp_path_factory.mktemp("bar"), LENGTH, 12, step=1e-5, steps=4))


def without(model, name="beam"):
    """The model with the terms of a body left out."""
    body = replace(model.bodies[name], second_order="off")
    return replace(model, bodies={**model.bodies, name: body})


def test_the_terms_tell(element):
    """In the machine of these tests, whose motion they change by far more than it would differ."""
    full, off = (simulate(m) for m in (machine(element), without(machine(element))))
    difference = full.frame("beam.tip").u - off.frame("beam.tip").u
    assert np.abs(difference).max() > 5e-3 * np.abs(off.frame("beam.tip").u).max()


@pytest.mark.parametrize("ends", [(1, 80), (40, 80), (1, 2, 7, 31, 64, 80)])
def test_a_run_in_parts_is_that_in_one_to_the_bit(element, ends, tmp_path):
    model = machine(element)
    simulate(model, output=tmp_path / "whole.h5")
    in_parts(model, tmp_path / "parts.h5", *ends)
    assert_same(tmp_path / "parts.h5", tmp_path / "whole.h5")


def test_a_state_of_other_terms_is_refused_by_the_key(element, tmp_path):
    model = machine(element)
    in_parts(model, tmp_path / "run.h5", 37)
    with pytest.raises(StateError, match=r"bodies\.beam\.second_order: was True, is False"):
        simulate(without(model), output=tmp_path / "run.h5", resume=True)
    start = first_run(model, tmp_path / "first.h5")
    with pytest.raises(StateError, match="body 'beam': second_order: in use in only one"):
        simulate(without(model).with_settings(start=start))


def test_another_run_goes_on_from_the_state(element, tmp_path):
    model = machine(element, LAST)
    whole = simulate(model)
    second = simulate(model.with_settings(start=first_run(model, tmp_path / "first.h5")))
    for found, expected in (
        (second.body("beam").v, whole.body("beam").v),
        (second.frame("beam.tip").u, whole.frame("beam.tip").u),
        (second.joint("clamp").force, whole.joint("clamp").force),
    ):
        np.testing.assert_allclose(found, expected[FIRST:], atol=1e-8 * np.abs(expected).max())
    balance = np.abs(second.energy.balance)
    assert balance.max() < 3.0 * np.abs(whole.energy.balance).max()


def test_step_by_step_is_simulate_to_the_last_bit(element):
    model = machine(element, steps=40)
    expected = simulate(model)
    outputs = ["frames/beam.tip/u", "joints/clamp/force", "energy/kinetic"]
    simulator = Simulator(model, outputs)
    found = [simulator.outputs, *(simulator.step([]) for _ in range(40))]
    columns = expected.frame("beam.tip").u, expected.joint("clamp").force, expected.energy.kinetic
    np.testing.assert_array_equal(found, np.column_stack(columns))
    assert simulator.time == 40 * H


def test_a_bar_strikes_as_in_short_steps_alone(thick):
    both = simulate(falling_bar(thick, 1e-5, 1e-6))
    short = simulate(falling_bar(thick, 1e-6))
    assert both.solver["steps"] < 0.4 * short.solver["steps"]
    v, expected = both.body("bar").v[-1], short.body("bar").v[-1]
    np.testing.assert_allclose(v, expected, atol=0.02 * np.abs(expected).max())
    total = both.energy.kinetic + both.energy.elastic + both.energy.springs
    assert total.max() < total[0] * (1.0 + 1e-4)


def test_what_rates_add_to_accelerations_survives_a_change_of_steps(thick):
    lowered = lower(falling_bar(thick, 1e-5, 2.5e-6))
    initial = initialize(lowered.model, lowered)
    state, rng = initial.state, np.random.default_rng(3)
    state.modes.acceleration[:] = rng.normal(size=len(state.modes.eta))
    phi = lowered.system.elastic.modes.phi.reshape(len(state.interfaces.u), -1)
    added = rng.normal(size=len(state.interfaces.u))
    state.interfaces.acceleration[:] = phi @ state.modes.acceleration + added
    change_size(lowered.system, lowered.flight, state, initial.work)
    np.testing.assert_allclose(state.interfaces.a, phi @ state.modes.a + added, rtol=1e-10)


def telling(element):
    """With points, in single precision or not, whose displacements are the modal coordinates."""
    m = len(element.modes.omega)
    points = np.zeros((m // 3, 3))
    shapes = np.eye(m).reshape(m // 3, 3, m)
    return replace(element, recovery=Recovery(points, [[0, 1]], shapes, None))


def recovered(results, body="beam"):
    eta = results.displacement(body, results.time)
    return eta.reshape(len(eta), -1)


def assert_recovered(results, element, body="beam"):
    """What interfaces move by is that of the modes, with what is quadratic in q."""
    eta = recovered(results, body)
    q, A = eta @ element.rotation.T.T, element.rotation.A_interface
    names = [f"{body}.{interface.name}" for interface in element.interfaces]
    recorded = np.hstack([results.frame(name).u for name in names])
    quadratic = 0.5 * np.einsum("ckl,nk,nl->nc", A, q, q)
    linear = eta @ element.modes.phi.T
    scale = np.abs(recorded).max()
    assert np.abs(linear + quadratic - recorded).max() < 1e-9 * scale
    assert np.abs(quadratic).max() > 1e-6 * scale


def with_element(model, element, name="beam", **changes):
    body = replace(model.bodies[name], superelement=element, **changes)
    return replace(model, bodies={**model.bodies, name: body})


def test_fields_are_driven_by_the_loads_of_rotation(element):
    model = machine(telling(element))
    assert_recovered(simulate(model), element)
    with_terms, linear = (recovered(simulate(m)) for m in (model, without(model)))
    assert np.abs(with_terms - linear).max() > 1e-3 * np.abs(linear).max()


def test_so_are_those_of_a_steady_rotation(element):
    model = Model(
        {"beam": FlexibleBody(telling(element), Start(position=[0.25, 0, 0]))},
        [Revolute("ground", "beam.root", [0, 0, 1], name="pivot")],
        [Force("beam.tip", [0, 0, 1], Harmonic(2.0, 30.0, offset=2.0))],
        settings=Settings(
            t_end=0.02, step=2e-4, start="equilibrium", steady_rotation=SteadyRotation([0, 0, 30.0])
        ),
    )
    assert_recovered(simulate(model), element)


def test_results_that_are_read_know_what_drove_them(element, tmp_path):
    write(tmp_path / "beam.h5", telling(element))
    model = with_element(
        machine(element, steps=20), read(tmp_path / "beam.h5"), source=str(tmp_path / "beam.h5")
    )
    for number, run in enumerate((model, without(model))):
        expected = recovered(simulate(run))
        path = tmp_path / f"{number}.h5"
        simulate(run, output=path)
        np.testing.assert_allclose(recovered(Results.read(path)), expected, rtol=0, atol=1e-15)
    assert Results.read(tmp_path / "1.h5").body("beam").second_order_force.shape == (21, 0)
    plain = replace(telling(element), rotation=None)
    with pytest.raises(RecoveryError, match=r"expected 3 coordinates of second order, .* found 0"):
        Results.read(tmp_path / "0.h5", superelements={"beam": plain}).displacement("beam", 0.0)


def test_fields_of_a_run_that_goes_on_from_another_are_refused(element, tmp_path):
    """Its modes do not start at rest, and results do not tell how."""
    model = machine(telling(element), LAST)
    start = first_run(model, tmp_path / "first.h5")
    results = simulate(model.with_settings(start=start))
    with pytest.raises(RecoveryError, match=r"fields need a run from its start; .*first.h5"):
        results.displacement("beam", results.time[-1])
