"""What no mechanism can do: move itself, push without being pushed, make energy of nothing."""

import numpy as np
from hypothesis import given

from .bounds import bounds, rotations
from .mechanisms import mechanisms, run


def arms(results, name, body):
    """Of the frames of a body: lever (n, 3), force (n, 3) and moment (n, 3), in space."""
    center = results.body(name).x
    for frame in body.frames:
        found = results.frame(f"{name}.{frame}")
        yield found.position - center, found.force[:, :3], found.force[:, 3:]


@given(mechanisms())
def test_bodies_obey_newton_and_euler(model):
    """m x'' = F + m g and J omega' + omega x J omega = M, of what acts on the frames of a body."""
    results = run(model)
    limits = bounds(model, results)
    for name, body in model.bodies.items():
        motion, force, moment = results.body(name), body.mass * model.gravity, 0.0
        for lever, push, turn in arms(results, name, body):
            force, moment = force + push, moment + turn + np.cross(lever, push)
        J = body.inertia
        omega, omega_dot = motion.v[:, 3:], motion.v_dot[:, 3:]
        spin = omega_dot @ J + np.cross(omega, omega @ J)
        assert np.abs(body.mass * motion.v_dot[:, :3] - force).max() <= limits.force
        assert np.abs(rotations(motion).apply(spin) - moment).max() <= limits.size * limits.force


@given(mechanisms(friction=False))
def test_what_acts_on_one_body_acts_back_on_another(model):
    """Wrenches on frames are those of joints and springs, once with each sign, and of loads."""
    results = run(model)
    limits = bounds(model, results)
    total = {name: np.zeros((len(results.time), 6)) for name in results.frames}
    couplings = [(results.joint(j.name), j.between) for j in model.joints]
    couplings += [(results.spring(s.name), s.between) for s in model.springs]
    wrenches = [(c.force, c.moment, between) for c, between in couplings]
    for contact in model.contacts:
        found = results.contact(contact.name)
        force = found.force[:, :1] * found.normal
        wrenches.append((force, np.zeros_like(force), contact.between))
    for force, moment, (first, second) in wrenches:
        if second in total:
            total[second] += np.hstack([force, moment])
        if first in total:
            lever = results.frame(second).position - results.frame(first).position
            total[first] -= np.hstack([force, moment + np.cross(lever, force)])
    for load in model.loads:
        total[load.on] += applied(load, results)
    for name, wrench in total.items():
        found = results.frame(name).force
        assert np.abs(found - wrench)[:, :3].max() <= limits.force, name
        assert np.abs(found - wrench)[:, 3:].max() <= limits.size * limits.force, name


def applied(load, results):
    """The wrench (n, 6) of a load on its frame, in space."""
    vector = np.outer([load.signal(t) for t in results.time], load.direction)
    if load.follower:
        vector = rotations(results.frame(load.on), "rotation").apply(vector)
    zero = np.zeros_like(vector)
    return np.hstack([vector, zero] if load.type == "force" else [zero, vector])


@given(mechanisms(free=True))
def test_a_mechanism_that_flies_keeps_its_linear_momentum(model):
    results = run(model)
    momentum = results.momentum.linear
    mass = sum(body.mass for body in model.bodies.values())
    assert np.abs(momentum - momentum[0]).max() <= mass * bounds(model, results).velocity


def halved(model):
    return model.with_settings(step=0.5 * model.settings.step)


def order_two(errors, floor):
    """An error that falls by four with half the step; by two while terms of higher order show."""
    coarse, fine = errors
    return fine <= max(0.5 * coarse, floor)


@given(mechanisms(free=True))
def test_a_mechanism_that_flies_keeps_its_angular_momentum(model):
    """To the order of the scheme."""
    drifts = []
    for finer in (model, halved(model)):
        results = run(finer)
        momentum = results.momentum.angular
        drifts.append(np.abs(momentum - momentum[0]).max())
    limits = bounds(halved(model), results)
    mass = sum(body.mass for body in model.bodies.values())
    assert order_two(drifts, mass * limits.size * limits.velocity), drifts


@given(mechanisms(conservative=True))
def test_no_energy_is_made(model):
    """Beyond the order of the scheme, by gravity, springs and elastic bodies."""
    gains = []
    for finer in (model, halved(model)):
        results = run(finer)
        gains.append(max(0.0, np.max(results.energy.balance)))
    limits = bounds(halved(model), results)
    work = limits.force * limits.size
    assert order_two(gains, work), gains
