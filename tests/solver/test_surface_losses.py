"""Contacts of surfaces of bodies whose material loses energy: impact, creep, stress."""

from dataclasses import replace
from functools import cache

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel.results.recovery import RecordedModes
from duhamel.solver import (
    Constant,
    FlexibleBody,
    MissedContactError,
    Model,
    ModelError,
    PatternLoad,
    Settings,
    Start,
    simulate,
)
from duhamel.solver.checkpoint.carried import Snapshot, carried
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from duhamel.superelement import Chain, GeneralizedAlpha, stressed
from duhamel.superelement.chain import Springs

from .pressing import EDGE, Motion, quietly

MASS = 1200.0 * EDGE**3
FLOOR = SurfaceContact("floor", ["block.low", "ground"], shape="plane", axis=[0.0, 0.0, 1.0])


@cache
def block(loss_factor, low=1e3, high=2e5):
    """A cube of plastic with the surface `low`, and `press`, 1 N down on its top."""
    half = 0.5 * EDGE
    plastic = du.Material(E=2e9, nu=0.35, rho=1200.0, loss_factor=loss_factor)
    part = du.Part(skfem.MeshHex.init_tensor(*[np.linspace(-half, half, 4)] * 3), plastic)
    part.surface("low", du.plane(z=-half))
    part.load("press", du.plane(z=half), pressure=1.0 / EDGE**2)
    part.damping(band=[low, high])
    return quietly(part, step=1e-6, band=1e5)


def model(element, step, t_end, gap=1e-7, speed=1.0, loads=(), contacts=(FLOOR,)):
    place = {"position": [0.0, 0.0, 0.5 * EDGE + gap], "velocity": [0.0, 0.0, -speed]}
    return Model(
        {"block": FlexibleBody(element, Start(**place))},
        surface_contacts=contacts,
        loads=loads,
        settings=Settings(t_end=t_end, step=step, rho_inf=0.9),
    )


def test_the_energy_that_an_impact_loses_is_that_of_the_material():
    first, second = (simulate(model(block(0.1), step, 4e-4)) for step in (4e-7, 2e-7))
    balances = [max(run.validity.values("energy_balance").values()) for run in (first, second)]
    assert balances[0] < 2e-4
    assert balances[1] < 0.35 * balances[0]
    # What is not lost is left: no tenth of it may be numerical.
    assert second.energy.dissipated[-1] > 0.3 * 0.5 * MASS
    assert second.energy.dissipated[-1] == pytest.approx(first.energy.dissipated[-1], rel=0.02)


def test_a_few_steps_that_create_energy_end_the_run():
    with pytest.raises(
        MissedContactError, match=r"'floor': .* touched for 2 steps of 5e-06 s at the"
    ):
        simulate(model(block(0.001), 5e-6, 1e-3))


def test_a_body_creeps_under_a_load_with_all_of_its_compliance():
    """Modes and rest: the center of mass sinks by C f J(t), with the creep J of the material."""
    element = block(0.1, low=1.0, high=1e3)
    loads = [PatternLoad("block", "press", Constant(1.0))]
    still = model(element, 1e-4, 0.2, gap=0.0, speed=0.0, loads=loads)
    results = simulate(still)
    sunk = 0.5 * EDGE - results.body("block").position[:, 2]
    springs, creep = Springs(element.modes.chain, 1), [0.0]
    springs.set_step(1e-4)
    for _ in range(2000):
        old = np.array([creep[-1]])
        # 1 = J + sum a q, where the springs of the step before carry a part.
        new = (1.0 - springs.carried(old)) / (1.0 + springs.hardening)
        springs.follow(new - old)
        creep.append(float(new[0]))
    late = np.arange(100, 2000)
    expected = np.array(creep)[late] / creep[-1]
    assert expected[0] < 0.85
    np.testing.assert_allclose(sunk[late] / sunk[-1], expected, rtol=2e-3)


def test_a_run_goes_on_from_a_contact_of_a_lossy_body_to_the_bit():
    motion, again = (Motion(model(block(0.1), 2e-7, 4e-4)) for _ in range(2))
    assert motion.step(20)
    assert motion.forces[-1] > 0.0
    kept = Snapshot.of(20, carried(state=motion.state, work=motion.work))
    assert motion.step(30)
    kept.put_back(carried(state=again.state, work=again.work))
    assert again.step(30)
    assert again.forces[1:] == motion.forces[21:]


@pytest.mark.parametrize("h", [1e-5, np.tile([1e-5, 3e-5], 50)])
def test_stresses_of_recorded_modes_are_those_of_steps(h):
    modes = block(0.1).modes
    modes = replace(modes, phi=np.ones((1, len(modes.omega))))
    loads = np.random.default_rng(0).standard_normal(101)
    made = list(stressed(modes, h, GeneralizedAlpha(0.9), loads[1:]))
    eta, stress = (np.array(parts) for parts in zip(*made, strict=True))
    steps_taken = h if np.ndim(h) == 0 else h[: len(eta) - 1]
    recorded = RecordedModes(modes, eta, steps_taken, np.empty((len(eta), 0)))
    steps = np.arange(len(eta))
    np.testing.assert_array_equal(recorded.at(steps), eta)
    np.testing.assert_allclose(recorded.at(steps, stress=True), stress, rtol=1e-12, atol=1e-20)


def test_materials_that_lose_differently_are_refused():
    element = block(0.1)
    chain = element.modes.chain
    apart = Chain(chain.tau, np.tile(chain.amplitude[:, None], len(element.modes.omega)))
    mixed = replace(element, modes=replace(element.modes, chain=apart))
    with pytest.raises(ModelError, match="excludes loss factors that differ between its materials"):
        Motion(model(mixed, 2e-7, 1e-5))
