"""Friction of surfaces: Coulomb's law at rows by itself, and blocks that stick and slide."""

import warnings
from dataclasses import replace

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel.solver import FlexibleBody, Model, ModelError, OutputRequest, Settings, Start, simulate
from duhamel.solver.couplings.friction import Stribeck
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from duhamel.solver.step.cone import solve_cone

from .pressing import Motion

G, H = 9.81, 4e-5
SIZE = 0.1, 0.1, 0.06
PLANE = {"shape": "plane", "axis": [0.0, 0.0, 1.0]}


@pytest.mark.parametrize("static", [1.0, 1.6])
@pytest.mark.parametrize("sliding", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("seed", range(8))
def test_forces_obey_coulombs_law(static, sliding, seed):
    """Also where the coefficient falls with the slip, and where it is large."""
    rng = np.random.default_rng(seed)
    rows = 4
    n = 3 * rows
    root = rng.normal(size=(n, n))
    W, q = root @ root.T + 0.1 * np.eye(n), rng.normal(size=n)
    q[::3] -= 1.0
    law = np.tile([[static * sliding, sliding, 0.3], *2 * [[-1.0, sliding, 0.3]]], (rows, 1))
    lam, y, trial = np.zeros((3, n))
    active, order, pivots = np.zeros((3, n), dtype=np.int64)
    made = np.full(n, -1)
    scratch = np.zeros((n, n)), order, pivots, made, lam, y, np.zeros((n, 6)), trial
    assert solve_cone(n, W, q, law, active, *scratch) == (active > 0).sum()
    P, T = lam[::3], lam.reshape(-1, 3)[:, 1:]
    gap, slip = (q + W @ lam)[::3], (q + W @ lam).reshape(-1, 3)[:, 1:]
    scale = P.max()
    assert (P >= 0.0).all()
    assert (gap >= -1e-9).all()
    assert np.abs(P * gap).max() < 1e-9 * scale
    mu = sliding * (1.0 + (static - 1.0) * np.exp(-((np.linalg.norm(slip, axis=1) / 0.3) ** 2)))
    size, way = np.linalg.norm(T, axis=1), np.linalg.norm(slip, axis=1)
    assert (size <= mu * P + 1e-9 * scale).all()
    # what slips is held by all the friction there is, against its way
    taken = -(T * slip).sum(axis=1)
    np.testing.assert_allclose(
        taken, mu * P * way, rtol=0.0 if static == 1.0 else 5e-3, atol=1e-8 * scale
    )
    assert (taken >= sliding * P * way - 1e-8 * scale).all()


def soft_block():
    """A soft block of 0.6 kg, whose modes are damped so that sliding does not flutter."""
    ends = [np.linspace(-s / 2.0, s / 2.0, n + 1) for s, n in zip(SIZE, (4, 4, 3), strict=True)]
    part = du.Part(skfem.MeshHex.init_tensor(*ends), du.Material(E=1e8, nu=0.3, rho=1000.0))
    part.surface("low", du.plane(z=-SIZE[2] / 2.0))
    with warnings.catch_warnings():
        # of the few elements in a wave: the block slides as a whole
        warnings.simplefilter("ignore", du.preprocess.PlausibilityWarning)
        element = part.superelement(step=H, band=4e3)
    zeta = np.full(len(element.modes.omega), 0.1)
    return replace(element, modes=replace(element.modes, zeta=zeta))


@pytest.fixture(scope="module")
def on_incline():
    element = soft_block()

    def model_of(degrees, speed, t_end, friction=0.3):
        angle = np.deg2rad(degrees)
        start = Start(position=[0.0, 0.0, SIZE[2] / 2.0], velocity=[speed, 0.0, 0.0])
        return Model(
            {"block": FlexibleBody(element, start)},
            surface_contacts=(
                SurfaceContact("floor", ["block.low", "ground"], friction=friction, **PLANE),
            ),
            settings=Settings(t_end=t_end, step=H, rho_inf=0.9),
            gravity=G * np.array([np.sin(angle), 0.0, -np.cos(angle)]),
        )

    def run(degrees, speed, t_end, friction=0.3):
        motion, forces = Motion(model_of(degrees, speed, t_end, friction)), []
        for _ in range(round(t_end / H)):
            assert motion.step()
            forces.append(motion.state.surfaces.total_force[0].copy())
        return motion, np.array(forces)

    run.model_of = model_of
    return run


def test_the_energies_of_results_count_what_friction_takes(on_incline):
    model = on_incline.model_of(0.0, 0.15, 0.04)
    results = simulate(model, force=True)
    mass, way = model.bodies["block"].mass, results.body("block").x[-1, 0]
    # the block rings as its weight comes on, which damping takes as well
    assert results.energy.dissipated[-1] == pytest.approx(0.3 * mass * G * way, rel=2e-2)
    moved = 0.5 * mass * 0.15**2
    assert np.abs(results.energy.balance).max() < 5e-3 * moved


def test_a_block_slides_in_short_steps_as_in_others(on_incline):
    model = on_incline.model_of(0.0, 0.15, 0.02)
    short = model.with_settings(step=4.0 * H, contact_step=H)
    ends = [simulate(one, force=True).body("block").v[-1, 0] for one in (model, short)]
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)


@pytest.mark.parametrize("degrees", [18.0, 25.0])
def test_a_block_slides_down_an_incline(on_incline, degrees):
    motion, forces = on_incline(degrees, 0.0, 0.06)
    angle = np.deg2rad(degrees)
    late = 0.06 * G * (np.sin(angle) - 0.3 * np.cos(angle))
    assert -forces[-300:, 0].sum() / forces[-300:, 2].sum() == pytest.approx(0.3, rel=1e-4)
    # the weight comes on in the first steps, and the block rings
    assert motion.state.bodies.v[0, 0] == pytest.approx(late, abs=1.1e-3)
    assert motion.state.extremes.balance[0] < 1e-3 * motion.state.extremes.moved[0]


def test_a_block_comes_to_rest_on_an_incline(on_incline):
    motion, _ = on_incline(10.0, 0.15, 0.15)
    angle = np.deg2rad(10.0)
    way = 0.15**2 / (2.0 * G * (0.3 * np.cos(angle) - np.sin(angle)))
    there = motion.state.bodies.x[0, 0]
    assert there == pytest.approx(way, rel=2e-3)
    assert motion.step(250)
    assert motion.state.bodies.x[0, 0] == pytest.approx(there, abs=1e-7)


def test_a_block_starts_to_slide_where_its_coefficient_falls_at_once(on_incline):
    """From rest, steeper than sticks: the coefficient falls to the sliding one within a step."""
    motion, forces = on_incline(28.8, 0.0, 0.06, Stribeck(0.5, 0.3, 1e-3))
    angle = np.deg2rad(28.8)
    late = 0.06 * G * (np.sin(angle) - 0.3 * np.cos(angle))
    assert -forces[-300:, 0].sum() / forces[-300:, 2].sum() == pytest.approx(0.3, rel=1e-3)
    assert motion.state.bodies.v[0, 0] == pytest.approx(late, rel=0.03)


def test_python_gives_a_coefficient():
    contact = du.contacts.surface("a.low", "b.top", friction=0.3)
    assert contact.friction.static == contact.friction.sliding == 0.3
    assert du.contacts.surface("a.low", "b.top").friction is None


def test_a_coefficient_below_zero_is_refused():
    with pytest.raises(ModelError, match="friction"):
        SurfaceContact("floor", ["block.low", "ground"], friction=-0.1, **PLANE)


def test_a_spring_of_friction_is_no_key_of_surfaces():
    with pytest.raises(TypeError, match="tangential_stiffness"):
        SurfaceContact("floor", ["a.b", "ground"], tangential_stiffness=1.0, **PLANE)


def test_traction_is_the_friction_of_each_row(on_incline):
    """Of a block that is pushed aside: mu times its pressure, against the way, at its speed."""
    model = on_incline.model_of(0.0, 0.5, 40 * H)
    run = simulate(model.with_settings(output=OutputRequest(nodes=True)))
    floor, speed = run.contact("floor"), run.body("block").v[:, 0]
    late = slice(5, None)
    pressure, traction = floor.pressure[late], floor.traction[late]
    assert (pressure > 0.0).any()
    np.testing.assert_allclose(
        np.linalg.norm(traction, axis=2), 0.3 * pressure, rtol=1e-6, atol=1e-9
    )
    assert (traction[..., 0] <= 0.0).all()
    closed = pressure > 0.0
    slip = floor.slip_speed[late]
    assert (slip[~closed] == 0.0).all()
    np.testing.assert_allclose(
        slip[closed], np.broadcast_to(speed[late, None], slip.shape)[closed], rtol=0.05
    )


def test_rows_that_stick_do_not_slip(on_incline):
    run = simulate(
        on_incline.model_of(10.0, 0.0, 200 * H).with_settings(output=OutputRequest(nodes=True))
    )
    floor = run.contact("floor")
    closed = floor.pressure[-1] > 0.0
    sticking = closed & (np.linalg.norm(floor.traction[-1], axis=1) < 0.299 * floor.pressure[-1])
    assert sticking.any()
    assert floor.slip_speed[-1][sticking].max() < 1e-12
