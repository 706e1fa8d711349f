"""Couplers in chains, in equilibrium, in restarts, in steps of two sizes, on flexible bodies."""

import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Coupler,
    FlexibleBody,
    Force,
    Frame,
    Impact,
    Model,
    Place,
    Revolute,
    RigidBody,
    Settings,
    Simulator,
    Spring,
    Start,
    StartFrom,
    StateError,
    Stop,
    Torque,
    simulate,
)

G = 9.81


def settings(**given):
    return Settings(**{"t_end": 0.5, "step": 1e-3} | given)


def link(k):
    frames = {"near": Frame([-0.1, 0.0, 0.0]), "far": Frame([0.1, 0.0, 0.0])}
    start = Start([0.1, 0.0, 0.0]) if k == 0 else Start(place=Place("near", f"l{k - 1}.far"))
    return RigidBody(0.2, [1e-3, 2e-3, 2e-3], frames, start)


@pytest.mark.parametrize("order", [1, -1])
def test_a_chain_that_folds_by_couplers_has_one_degree_of_freedom(order):
    """Ten links, of which each turns against the last as that against the one before."""
    n = 10
    names = [f"l{k}" for k in range(n)]
    bodies = {f"l{k}": link(k) for k in range(n)}
    joints = [
        Revolute("ground" if k == 0 else f"l{k - 1}.far", f"l{k}.near", [0, 0, 1], name=f"j{k}")
        for k in range(n)
    ]
    couplers = [
        Coupler(f"c{k}", "linear", [f"j{k}", f"j{k + 1}"][::order], ratios=[1.0, 1.0])
        for k in range(n - 1)
    ]
    bodies = {name: bodies[name] for name in names[::order]}
    model = Model(
        bodies, joints[::order], couplers=couplers[::order], gravity=[0, -G, 0], settings=settings()
    )
    run = simulate(model)
    first = run.joint("j0").angle
    for k in range(n):
        np.testing.assert_allclose(run.joint(f"j{k}").angle, (-1) ** k * first, atol=1e-9)
    assert run.solver["degrees_of_freedom"] == 1
    assert np.abs(first).max() > 0.5
    energy = run.energy
    assert np.abs(energy.balance).max() < 1e-4 * np.abs(energy.potential).max()


def lever(**given):
    """A lever whose weight a torsion spring carries through a gear of four."""
    bodies = {
        "lever": RigidBody(1.0, [0.1, 0.1, 0.1], {"eye": Frame([-0.5, 0, 0])}, Start([0.5, 0, 0])),
        "wheel": RigidBody(1.0, [0.1, 0.1, 0.1], start=Start([0, 1.0, 0])),
    }
    joints = [
        Revolute("ground", "lever.eye", [0, 0, 1], name="p"),
        Revolute("ground", "wheel", [0, 0, 1], name="q"),
    ]
    springs = [
        Spring("coil", "torsion", ["ground", "wheel"], [0, 0, 1], stiffness=0.5, damping=0.1)
    ]
    couplers = [Coupler("gear", "gear", ["p", "q"], teeth=[4, 1])]
    return Model(bodies, joints, springs=springs, couplers=couplers, gravity=[0, -G, 0], **given)


def test_a_geared_lever_rests_where_spring_and_weight_balance():
    """m g L cos(p) = 4 k q with q = -4 p; and stays there."""
    run = simulate(lever(settings=settings(start="equilibrium", t_end=0.1)))
    p = run.joint("p").angle
    np.testing.assert_allclose(G * 0.5 * np.cos(p), -4 * 0.5 * 4 * p, rtol=1e-8)
    np.testing.assert_allclose(run.joint("q").angle, -4 * p, atol=1e-10)
    np.testing.assert_allclose(run.coupler("gear").force, G * 0.5 * np.cos(p[0]), rtol=1e-6)


def test_a_run_in_two_parts_is_one_to_the_bit(tmp_path):
    """A wheel that has turned by many turns meanwhile."""
    load = Torque("wheel", [0, 0, 30.0], Constant(1.0))
    model = lever(loads=[load], settings=settings(checkpoint=1e3))
    whole = simulate(model, output=tmp_path / "whole.h5")
    short = model.with_settings(t_end=0.3)
    simulate(short, output=tmp_path / "parts.h5")
    parts = simulate(model, output=tmp_path / "parts.h5", resume=True)
    assert np.abs(whole.joint("q").angle).max() > 2 * np.pi
    np.testing.assert_array_equal(parts.joint("q").angle, whole.joint("q").angle)
    np.testing.assert_array_equal(parts.coupler("gear").force, whole.coupler("gear").force)


def test_a_run_goes_on_with_its_gear_and_with_one_that_is_new(tmp_path):
    """A new one has the turns of its joints, and must fit them."""
    load = Torque("wheel", [0, 0, 30.0], Constant(1.0))
    model = lever(loads=[load], settings=settings(checkpoint=1e3))
    first = simulate(model, output=tmp_path / "first.h5")
    onwards = model.with_settings(start=StartFrom(tmp_path / "first.h5"), t_end=0.6)
    second = simulate(onwards)
    p, q = second.joint("p").angle, second.joint("q").angle
    np.testing.assert_allclose(q, -4 * p, atol=1e-9)
    assert q[0] == pytest.approx(first.joint("q").angle[-1])
    renamed = [Coupler("other", "linear", ["q", "p"], ratios=[1.0, 4.0])]
    again = Model(
        model.bodies,
        model.joints,
        model.loads,
        model.springs,
        couplers=renamed,
        gravity=model.gravity,
        settings=onwards.settings,
    )
    third = simulate(again)
    np.testing.assert_allclose(third.joint("q").angle, q, atol=1e-6)
    wrong = [Coupler("other", "linear", ["q", "p"], ratios=[1.0, 5.0])]
    misfit = Model(
        model.bodies,
        model.joints,
        model.loads,
        model.springs,
        couplers=wrong,
        gravity=model.gravity,
        settings=onwards.settings,
    )
    with pytest.raises(StateError, match="coupler 'other': is open by"):
        simulate(misfit)


def test_a_simulator_goes_back_with_a_coupler():
    simulator = Simulator(lever(settings=settings()), outputs=["joints/q/angle"])
    before = [simulator.step({}) for _ in range(20)]
    moment = simulator.save()
    after = [np.copy(simulator.step({})) for _ in range(20)]
    simulator.restore(moment)
    again = [np.copy(simulator.step({})) for _ in range(20)]
    assert before
    np.testing.assert_array_equal(after, again)


def test_a_geared_lever_hits_a_stop_in_steps_of_two_sizes():
    """As in short steps alone."""

    def run(**given):
        stop = Stop("end", "q", "angle", [-1.0, np.inf], Impact(stiffness=200.0))
        return simulate(lever(stops=[stop], settings=settings(t_end=0.4, **given)))

    mixed, fine = run(step=1e-3, contact_step=1e-4), run(step=1e-4)
    at = np.interp(mixed.time, fine.time, fine.joint("q").angle)
    assert mixed.joint("q").angle.max() > 0.0
    np.testing.assert_allclose(mixed.joint("q").angle, at, atol=2e-3)


@pytest.mark.parametrize("history", ["direct", "fft"])
def test_gears_on_flexible_bodies_are_the_same_with_every_history(random_element, history):
    """Between interfaces of two bodies; and no energy comes from nowhere."""
    elements = [random_element(k, (True, True), omega=(100.0, 900.0)) for k in (3, 4)]
    bodies = {
        name: FlexibleBody(element, Start(np.array([0, 2.0 * k, 0]) - element.interface("i0").X))
        for k, (name, element) in enumerate(zip("ab", elements, strict=True))
    }
    joints = [
        Revolute("ground", "a.i0", [0, 0, 1], name="p"),
        Revolute("ground", "b.i0", [0, 0, 1], name="q"),
    ]
    couplers = [Coupler("gear", "gear", ["p", "q"], teeth=[1, 2])]
    loads = [Force("a.i1", [1.0, 2.0, 0.5], Constant(1.0))]
    model = Model(bodies, joints, loads, couplers=couplers)

    def run(kind):
        return simulate(model, settings(t_end=0.05, step=5e-4, history=kind))

    recursive, other = run("recursive"), run(history)
    force = recursive.coupler("gear").force
    np.testing.assert_allclose(other.coupler("gear").force, force, rtol=0, atol=1e-6)
    p, q = recursive.joint("p").angle, recursive.joint("q").angle
    np.testing.assert_allclose(p, -2 * q, atol=1e-10)
    energy = recursive.energy
    assert np.abs(energy.balance).max() < 0.01 * np.abs(energy.work).max()
