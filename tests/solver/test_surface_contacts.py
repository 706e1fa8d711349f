"""Contacts of surfaces: their parts by themselves, and small bodies that meet."""

import itertools
import math
from dataclasses import replace

import meshio
import numpy as np
import pytest
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    MissedContactError,
    Model,
    ModelError,
    PatternLoad,
    Revolute,
    RigidBody,
    Settings,
    Spring,
    Start,
    ValidityWarning,
    linearize,
    simulate,
)
from duhamel.solver.checkpoint.carried import Snapshot, carried
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from duhamel.solver.schema.tables import table_of
from duhamel.solver.step.complementarity import solve_complementarity
from duhamel.solver.step.facets import (
    facet_functions,
    point_of_facet,
    shape_target,
    walk_to_foot,
)
from duhamel.solver.step.facing import set_row_gaps
from duhamel.solver.step.frames import move_frames
from duhamel.solver.step.loop import is_contact_near
from duhamel.solver.step.planes import look_at_target
from duhamel.solver.step.rims import cut_at_rim
from duhamel.solver.step.second_order import set_slopes
from duhamel.solver.step.surfaces import measure_surfaces, press_surfaces
from duhamel.superelement import Channels, Pattern
from scipy.spatial.transform import Rotation

from .pressing import EDGE, Motion, arm, block

H, LONG = 2e-7, 1e-6
PLANE = {"shape": "plane", "axis": [0.0, 0.0, 1.0]}
FLOOR = SurfaceContact("floor", ["block.low", "ground"], **PLANE)
ON_BLOCK = SurfaceContact("floor", ["block.low", "other.top"])
MASS = 7800.0 * EDGE**3


# Linear complementarity


def solved(W, q, active=None):
    n = len(q)
    active = np.zeros(n, dtype=np.int64) if active is None else active
    factored, order = np.full(n, -1), np.zeros(n, dtype=np.int64)
    lam, y = np.zeros(n), np.zeros(n)
    count = solve_complementarity(n, W, q, False, active, factored, np.zeros((n, n)), order, lam, y)
    return count, lam, y


def by_all_sets(W, q):
    """The forces of the one set of closed rows that neither pulls nor penetrates."""
    n = len(q)
    for closed in itertools.product([False, True], repeat=n):
        a, lam = np.array(closed), np.zeros(n)
        lam[a] = -np.linalg.solve(W[np.ix_(a, a)], q[a])
        if (lam >= 0.0).all() and ((q + W @ lam)[~a] >= 0.0).all():
            return lam
    raise AssertionError


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
@pytest.mark.parametrize("seed", range(5))
def test_forces_are_those_of_the_one_set_that_fits(n, seed):
    rng = np.random.default_rng(100 * n + seed)
    root = rng.normal(size=(n, n))
    W, q = root @ root.T + 1e-3 * np.eye(n), rng.normal(size=n)
    guess = rng.integers(0, 2, n)
    count, lam, y = solved(W, q, guess)
    expected = by_all_sets(W, q)
    np.testing.assert_allclose(lam, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    assert count == (lam != 0.0).sum()
    assert not (lam * y).any()


def test_rows_that_just_touch_have_no_force():
    W = np.array([[2.0, 1.0], [1.0, 2.0]])
    count, lam, _ = solved(W, np.array([-2.0, -1.0]))
    np.testing.assert_allclose(lam, [1.0, 0.0], atol=1e-15)
    assert count >= 1
    assert solved(W, np.zeros(2))[1].tolist() == [0.0, 0.0]


def test_rows_that_move_alike_share_their_force():
    root = np.random.default_rng(2).normal(size=(3, 3))
    W, q = root @ root.T, np.array([-1.0, -2.0, 3.0])
    twice = [0, 1, 1, 2, 0]
    _, alone, _ = solved(W, q)
    count, lam, y = solved(W[np.ix_(twice, twice)].copy(), q[twice].copy())
    assert count > 0
    together = np.bincount(twice, weights=lam)
    np.testing.assert_allclose(together, alone, rtol=1e-9, atol=1e-10)
    assert (lam >= -1e-3 * lam.max()).all()
    assert (y >= -1e-12).all()


def test_what_is_no_number_has_no_solution():
    assert solved(np.array([[np.nan]]), np.array([-1.0]))[0] == -1


# Facets


@pytest.mark.parametrize("kind", range(5))
def test_shape_functions_sum_to_one_and_have_their_derivatives(kind):
    N, dN, low, high = (np.zeros(9), np.zeros((2, 9)), np.zeros(9), np.zeros(9))
    rest, step = np.zeros((2, 9)), 1e-6
    for x, y in np.random.default_rng(kind).uniform(0.0, 0.5, (5, 2)):
        n = facet_functions(kind, x, y, N, dN)
        assert N[:n].sum() == pytest.approx(1.0, abs=1e-14)
        for axis, (a, b) in enumerate([(step, 0.0), (0.0, step)]):
            facet_functions(kind, x - a, y - b, low, rest)
            facet_functions(kind, x + a, y + b, high, rest)
            np.testing.assert_allclose(dN[axis, :n], (high - low)[:n] / (2 * step), atol=1e-9)


# Derivatives


def falling(element=None, **start):
    """A block that falls on what is at z = 0."""
    values = {"position": [0.0, 0.0, 0.5 * EDGE + 1e-7], "velocity": [0.0, 0.0, -1.0]}
    return FlexibleBody(element or block(), Start(**{**values, **start}))


def model(contacts=(FLOOR,), steps=100, others=None, body=None, step=H, **changes):
    bodies = {"block": body or falling(), **(others or {})}
    settings = {"t_end": steps * step, "step": step, "rho_inf": 0.9, **changes.pop("settings", {})}
    return Model(bodies, surface_contacts=contacts, settings=Settings(**settings), **changes)


def resting(element=None, **start):
    """A block below z = 0."""
    return FlexibleBody(element or block(), Start(**{"position": [0.0, 0.0, -0.5 * EDGE], **start}))


def derivative_models(with_second_order):
    turned = {"rotation": [0.02, -0.01, 0.3], "position": [1e-3, 5e-4, 0.5 * EDGE + 1.2e-4]}
    turned["angular_velocity"] = [100.0, 50.0, -80.0]
    body = falling(**turned)
    rest = {"position": [2e-3, -1e-3, -0.5 * EDGE], "rotation": [0.0, 0.0, 0.5]}
    held = Revolute("ground", "other.left", [0.0, 1.0, 0.0], name="hinge")
    carrier = {"other": resting(block(ends=True), position=[0.1, 0.0, 0.0])}
    rigid = RigidBody(1.0, [1e-3] * 3, {"top": Frame([0.0, 0.0, 0.1])}, Start([0.0, 0.0, -0.1]))
    on_rigid = SurfaceContact("floor", ["block.low", "other.top"], **PLANE)
    on_interface = SurfaceContact(
        "floor", ["block.low", "other.right"], shape="plane", axis=[0.0, 0.0, 1.0]
    )
    bent = with_second_order(block(ends=True))
    return {
        "second order": model(
            [ON_BLOCK],
            body=falling(bent, **turned | {"angular_velocity": [2000.0, 1000.0, -3000.0]}),
            others={"other": resting(with_second_order(bent, seed=2))},
            joints=[held],
            step=LONG,
        ),
        "plane": model(body=body, step=LONG),
        "frame": model([on_rigid], body=body, others={"other": rigid}, step=LONG),
        "block": model([ON_BLOCK], body=body, others={"other": resting(**rest)}, step=LONG),
        "hinged block": model(
            [ON_BLOCK],
            body=body,
            others={"other": resting(block(ends=True))},
            joints=[held],
            step=LONG,
        ),
        "interface": model([on_interface], body=body, others=carrier, step=LONG),
    }


def moved(motion, body, k, change):
    """Move a body along its coordinate k: place and rotation in its axes, active dofs."""
    state, elastic = motion.state, motion.system.elastic
    if k < 3:
        state.bodies.x[body] += change * state.bodies.R[body][:, k]
    elif k < 6:
        turn = Rotation.from_rotvec(change * np.eye(3)[k - 3]).as_matrix()
        state.bodies.R[body] = state.bodies.R[body] @ turn
    else:
        state.interfaces.u[elastic.active[_active(motion, body) + k - 6]] += change


def _active(motion, body):
    """The first active dof of a body."""
    elastic = motion.system.elastic
    return int(elastic.active_range[elastic.of_body[body]])


@pytest.mark.parametrize(
    "name", ["plane", "frame", "block", "hinged block", "interface", "second order"]
)
def test_gaps_follow_every_coordinate_as_their_derivatives_say(name, with_second_order):
    """With W dlam = -D dxi at the closed rows, whose planes stay where they are."""
    motion = Motion(derivative_models(with_second_order)[name])
    for _ in range(1000):
        assert motion.step()
        if motion.forces[-1] > 0.0:
            break
    system, state, work = motion.system, motion.state, motion.work
    out, contacts = work.surfaces, system.surfaces.contacts

    def forces():
        move_frames(system.frames, system.frames.n_acting, state, work)
        set_slopes(system.elastic, state, work)
        press_surfaces(system, state, work)
        return out.lam[out.order[0, :n]].copy()

    n = int(out.closed.sum())
    forces()
    D, order = out.D[:n].copy(), out.order[0, :n].copy()
    width = int(contacts.coordinates[0])
    K = out.stiffness[: width * width].reshape(width, width)
    np.testing.assert_allclose(K, K.T, rtol=1e-9, atol=1e-12 * np.abs(K).max())
    W = out.W[0][np.ix_(order, order)]
    live = carried(state=state, work=work)
    start = Snapshot.of(0, live)
    for body, first, own in zip(
        contacts.body, contacts.body_coordinate, contacts.body_width, strict=True
    ):
        for k in range(own):
            size = 1e-10 if k < 3 or k % 6 < 3 else 1e-8
            if k >= 6:  # changes of inertia and coordinates q in their own units
                size /= system.elastic.length[_active(motion, body) + k - 6]
            both = []
            for sign in (-1.0, 1.0):
                moved(motion, body, k, sign * size)
                both.append(forces())
                np.testing.assert_array_equal(out.order[0, :n], order)
                start.put_back(live)
            slope = -W @ (both[1] - both[0]) / (2.0 * size)
            scale = 1.0 if k < 3 else 0.01 if k < 6 else max(1.0, np.abs(D[:, first + k]).max())
            np.testing.assert_allclose(slope, D[:, first + k], atol=2e-6 * scale, err_msg=str(k))


# Motions


def test_two_blocks_meet_as_one_meets_a_wall():
    """By symmetry, with the nodes of both exactly on one another; and momentum is kept."""
    wall, pair = Motion(model()), Motion(meeting())
    assert wall.step(60)
    assert pair.step(60)
    np.testing.assert_allclose(pair.forces, wall.forces, rtol=1e-9, atol=1e-6)
    momentum = pair.state.bodies.v[:, :3].sum(axis=0)
    np.testing.assert_allclose(momentum, 0.0, atol=1e-13)
    assert wall.impulse == pytest.approx(MASS * (1.0 + wall.state.bodies.v[0, 2]), rel=1e-12)
    assert wall.closings == 1
    assert abs(wall.gain) < 0.01


def meeting(speed=1.0, gap=1e-7, other=None, **changes):
    """Two blocks that meet at z = 0."""
    place = [0.0, 0.0, 0.5 * EDGE + gap]
    first = falling(position=place, velocity=[0.0, 0.0, -speed])
    start = {"position": [-x for x in place], "velocity": [0.0, 0.0, speed]}
    return model([ON_BLOCK], body=first, others={"other": resting(**(other or start))}, **changes)


def test_a_motion_is_the_same_wherever_it_is_and_however_it_turns():
    """Places and velocities lose digits to 1 km and 100 m/s: 1e-13 m over 1e-7 m of approach."""
    start = {
        "velocity": np.array([0.3, 0.2, -1.0]),
        "angular_velocity": np.array([90.0, -60.0, 40.0]),
        "position": np.array([1e-4, 2e-4, 0.5 * EDGE + 2e-5]),
    }
    below = {"position": np.array([1e-3, 5e-4, -0.5 * EDGE]), "rotation": [0.0, 0.0, 0.4]}
    here = Motion(
        model([ON_BLOCK], body=falling(**start), others={"other": resting(**below)}, step=LONG)
    )
    turn = Rotation.from_rotvec([0.7, -1.1, 0.5])
    far, fast = np.array([600.0, -700.0, 400.0]), np.array([60.0, 70.0, -40.0])

    def carried_along(place):
        rotation = turn * Rotation.from_rotvec(place.get("rotation", np.zeros(3)))
        return {
            "position": far + turn.apply(place["position"]),
            "rotation": rotation.as_rotvec(),
            "velocity": fast + turn.apply(place.get("velocity", np.zeros(3))),
            "angular_velocity": place.get("angular_velocity", np.zeros(3)),
        }

    others = {"other": resting(**carried_along(below))}
    there = Motion(
        model([ON_BLOCK], body=falling(**carried_along(start)), others=others, step=LONG)
    )
    assert here.step(40)
    assert there.step(40)
    assert max(here.forces) > 100.0
    np.testing.assert_allclose(there.forces, here.forces, atol=1e-5 * max(here.forces))
    velocity = turn.inv().apply(there.state.bodies.v[:, :3] - fast)
    np.testing.assert_allclose(velocity, here.state.bodies.v[:, :3], atol=1e-5)
    np.testing.assert_allclose(there.state.bodies.v[:, 3:], here.state.bodies.v[:, 3:], atol=1e-2)


def test_contacts_of_two_halves_are_one_contact():
    """Rows of both at their border move alike."""
    body = falling(block(4), rotation=[1e-5, 2e-5, 0.0])
    whole = Motion(model(body=body))
    halves = [SurfaceContact(side, [f"block.{side}", "ground"], **PLANE) for side in SIDES]
    parts = Motion(model(halves, body=body))
    assert whole.step(60)
    assert parts.step(60)
    assert len(parts.system.surfaces.contacts.island_range) == 2
    np.testing.assert_allclose(parts.forces, whole.forces, atol=1e-11 * max(whole.forces))
    np.testing.assert_allclose(parts.state.bodies.v, whole.state.bodies.v, atol=1e-11)


SIDES = "west", "east"


def test_a_contact_given_twice_is_one():
    once, twice = Motion(model()), Motion(model([FLOOR, replace(FLOOR, name="again")]))
    assert once.step(40)
    assert twice.step(40)
    np.testing.assert_allclose(twice.forces, once.forces, atol=1e-10 * max(once.forces))


@pytest.mark.parametrize("lowest", ["edge", "corner"])
def test_a_block_bounces_off_an_edge_or_a_corner(lowest):
    turn = {"edge": [0.25 * np.pi, 0.0, 0.0], "corner": CORNER_DOWN}[lowest]
    reach = 0.5 * EDGE * math.sqrt({"edge": 2, "corner": 3}[lowest])
    body = falling(rotation=turn, position=[0.0, 0.0, reach + 1e-7])
    motion = Motion(model(body=body))
    assert motion.step(150)
    assert motion.forces[-1] == 0.0
    v = motion.state.bodies.v[0]
    np.testing.assert_allclose(v[[0, 1, 3, 4, 5]], 0.0, atol=1e-6)
    assert 0.98 < v[2] < 1.0
    assert motion.impulse == pytest.approx(MASS * (1.0 + v[2]), rel=1e-10)
    assert abs(motion.gain) < 2e-3


CORNER_DOWN = np.arctan(math.sqrt(2.0)) * np.array([1.0, -1.0, 0.0]) / math.sqrt(2.0)


def test_spin_about_the_normal_changes_nothing():
    still, spinning = (
        Motion(model(body=falling(angular_velocity=[0.0, 0.0, w]))) for w in (0.0, 1e4)
    )
    assert still.step(60)
    assert spinning.step(60)
    np.testing.assert_allclose(spinning.forces, still.forces, atol=1e-9 * max(still.forces))


def test_a_block_on_a_hinge_bounces_and_keeps_its_energy():
    """Of its own contact, and of the hinge that holds it at an interface."""
    hinge = Revolute("ground", "block.left", [0.0, 1.0, 0.0], name="hinge")
    body = falling(
        block(ends=True), position=[0.0, 0.0, 0.5 * EDGE + 2e-6], angular_velocity=[0.0, 250.0, 0.0]
    )
    motion = Motion(model(body=body, joints=[hinge], steps=150))
    assert motion.step(100)
    assert motion.closings == 1
    assert motion.forces[-1] == 0.0
    spin = motion.state.bodies.v[0, 4]
    assert -252.0 < spin < -240.0
    assert motion.gain < 1e-6
    assert motion.energies[-1] / motion.energies[0] > 1.0 - 2e-3


@pytest.mark.parametrize("step", [2e-6, 1e-6])
def test_a_clamped_arm_that_swings_into_a_wall_does_not_enter_it(step):
    """Its body stands still: only its deformation closes the contact."""
    body = FlexibleBody(arm(), Start([0.04, 0.0, 0.002 + 1e-5]))
    contact = SurfaceContact("floor", ["block.low", "ground"], **PLANE)
    clamped = model(
        [contact],
        body=body,
        joints=[Fixed("ground", "block.root")],
        gravity=[0.0, 0.0, -2e4],
        step=step,
        steps=400,
    )
    motion = Motion(clamped)
    X = motion.system.surfaces.patches.X
    for _ in range(400):
        assert motion.step()
        x, R = motion.state.bodies.x[0], motion.state.bodies.R[0]
        place = x + (X + motion.state.surfaces.u) @ R.T
        assert not motion.work.surfaces.awake[0] or place[:, 2].min() > -1e-12
    assert motion.closings > 1


@pytest.mark.parametrize("ratio", [2, 5])
def test_long_steps_in_flight_end_before_a_contact_closes(ratio):
    def flown(step, **settings):
        body = falling(position=[0.0, 0.0, 0.05], velocity=[0.0, 0.0, -100.0])
        return simulate(model(body=body, step=step, steps=round(6e-4 / step), settings=settings))

    short, long = flown(2e-7), flown(ratio * 2e-7, contact_step=2e-7)
    velocities = [run.body("block").velocity[-1] for run in (short, long)]
    assert velocities[0][2] > 50.0
    np.testing.assert_allclose(velocities[1], velocities[0], atol=1e-6)


def test_a_run_goes_on_from_a_closed_contact_to_the_bit():
    turned = {"angular_velocity": [3.0, 1.0, 2.0]}
    motion, again = (Motion(meeting(other=BELOW | turned)) for _ in range(2))
    assert motion.step(9)
    assert motion.forces[-1] > 0.0
    kept = Snapshot.of(9, carried(state=motion.state, work=motion.work))
    assert motion.step(30)
    kept.put_back(carried(state=again.state, work=again.work))
    assert again.step(30)
    assert again.forces[1:] == motion.forces[10:]
    np.testing.assert_array_equal(again.state.bodies.x, motion.state.bodies.x)


BELOW = {"position": [1e-3, 5e-4, -0.5 * EDGE], "rotation": [0.0, 0.0, 0.4]}


def test_bodies_that_are_far_sleep():
    others = {
        f"b{k}": resting(position=[0.1 * (k + 1), 0.0, -0.5 * EDGE - 0.01]) for k in range(20)
    }
    others["other"] = resting()
    contacts = [ON_BLOCK]
    contacts += [
        SurfaceContact(f"c{k}", [f"b{k}.low", f"b{k + 1}.top"]) for k in range(len(others) - 2)
    ]
    motion = Motion(model(contacts, others=others))
    # As many bodies: loops over eight or more are vectorized, which rounds otherwise.
    rigid = {name: RigidBody(1.0, [1e-3] * 3) for name in others if name != "other"}
    alone = Motion(model([ON_BLOCK], others={**rigid, "other": resting()}))
    assert motion.step(20)
    assert alone.step(20)
    assert motion.forces == alone.forces
    assert motion.work.surfaces.awake.sum() == 2


# Refusals


def test_a_start_that_is_deep_is_refused_and_one_that_is_not_is_told():
    with pytest.raises(ModelError, match=r"'floor': starts 0.001 m deep: .* tenth of the radius"):
        Motion(model(body=falling(position=[0.0, 0.0, 0.5 * EDGE - 1e-3])))
    motion = Motion(model(body=falling(position=[0.0, 0.0, 0.5 * EDGE - 1e-6])))
    assert motion.warnings == ("contact 'floor': starts 1e-06 m deep",)
    assert Motion(model(body=falling(position=[0.0, 0.0, 0.5 * EDGE]))).warnings == ()


@pytest.mark.parametrize("target", ["facets", "block", "sphere"])
def test_a_surface_that_passes_its_target_in_a_step_stops_the_run(target, sheet):
    body = falling(position=[0.0, 0.0, 0.02], velocity=[0.0, 0.0, -1.5e4])
    contact, others = {
        "facets": (replace(FLOOR, shape=None, axis=None, facets=sheet), None),
        "block": (ON_BLOCK, {"other": resting()}),
        "sphere": (
            SurfaceContact("floor", ["block.low", "ground"], shape="sphere", radius=0.002),
            None,
        ),
    }[target]
    with pytest.raises(
        MissedContactError, match=r"contact 'floor': stopped in step [12] .* smaller `contact_step`"
    ):
        simulate(model([contact], body=body, others=others, step=LONG, steps=10))


def test_one_that_flies_by_does_not():
    body = falling(position=[0.1, 0.0, 0.02], velocity=[0.0, 0.0, -1.5e4])
    motion = Motion(model([ON_BLOCK], body=body, others={"other": resting()}, step=LONG))
    assert motion.step(5)


def test_a_small_margin_misses_nothing():
    body = falling(position=[0.0, 0.0, 0.02], velocity=[0.0, 0.0, -1e4])
    motion = Motion(model([replace(FLOOR, margin=1e-9)], body=body, step=LONG))
    assert motion.step(4)
    assert motion.forces[-1] > 0.0 or motion.state.bodies.v[0, 2] > 0.0


REFUSED = {
    "rule": (lambda: model(settings={"rule": "paper"}), "excludes rule 'paper'"),
    "history": (lambda: model(settings={"history": "direct"}), "excludes history 'direct'"),
    "surface": (
        lambda: model([replace(FLOOR, surfaces=["block.side", "ground"])]),
        "no surface 'side' on 'block'; it has: low, top",
    ),
    "body": (
        lambda: model([replace(FLOOR, surfaces=["brick.low", "ground"])]),
        "no body 'brick'; there are: block",
    ),
    "rigid": (
        lambda: model([ON_BLOCK], others={"other": RigidBody(1.0, np.ones(3))}),
        "'other' is rigid: expected a flexible body",
    ),
    "ground": (
        lambda: model([SurfaceContact("floor", ["block.low", "ground"])]),
        "expected shape or facets on 'ground', or BODY.SURFACE, found none",
    ),
}


@pytest.mark.parametrize(("made", "message"), REFUSED.values(), ids=REFUSED)
def test_what_surfaces_do_not_do_is_refused_by_name(made, message):
    with pytest.raises(ModelError, match=message):
        Motion(made())


# Load patterns


def test_a_pattern_moves_a_surface_as_the_static_solution_of_its_mesh():
    """In long steps nothing but statics is left: H, of the factor of K, with consistent loads."""
    element = block(spread=True)
    load = PatternLoad("block", "press", Constant(1.0))
    bodies = Motion(model(body=falling(element), loads=[load], step=1.0)).system.surfaces.bodies
    low, top = element.surface("low"), element.surface("top")
    f = np.zeros((top.n, 3))
    np.add.at(f[:, 2], top.facets.ravel(), -1.0 / top.facets.size)
    H = element.surfaces.H[element.surfaces.rows("low"), element.surfaces.rows("top")]
    expected = H @ f.ravel()
    found = bodies.spread[bodies.spread_start[0] :][: 3 * low.n]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-8 * np.abs(expected).max())
    lengths = np.linalg.norm(expected.reshape(-1, 3), axis=1)
    np.testing.assert_allclose(bodies.spread_reach, [lengths.max()], rtol=1e-8)


@pytest.mark.parametrize("held", [False, True])
def test_a_pattern_presses_a_body_on_the_floor_as_the_same_force_does(held):
    """A force of a frame is an unknown, with T; a pattern of the same displacements none, with B.

    Where the frame is held by a spring its dofs are unknowns in both, and B has its second term.
    """
    element, force = block(ends=True), np.array([0.0, 0.0, -200.0])
    interface = element.interface("right")
    shape = force @ element.modes.phi[element.rows("right")][:3]
    pattern = Pattern("same", force, np.cross(interface.X, force))
    spread = replace(element, channels=Channels((pattern,), (), shape[None]))
    signal = Constant(1.0)
    soft = [1e5] * 3 + [0.0] * 3
    springs = [Spring("hold", "bushing", ("ground", "block.left"), stiffness=soft)] if held else []
    start = {"velocity": [0.0, 0.0, 0.0]}
    by_pattern = Motion(
        model(
            body=falling(spread, **start),
            loads=[PatternLoad("block", "same", signal)],
            springs=springs,
        )
    )
    by_force = Motion(
        model(
            body=falling(element, **start),
            loads=[Force("block.right", force, signal, follower=True)],
            springs=springs,
        )
    )
    assert by_pattern.step(400)
    assert by_force.step(400)
    found, expected = np.array(by_pattern.forces), np.array(by_force.forces)
    assert by_force.closings >= 1
    # Their levers differ by the displacements of the interface.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-3 * expected.max())
    assert by_pattern.work.surfaces.awake[0]
    np.testing.assert_allclose(by_pattern.energies, by_force.energies, rtol=1e-3, atol=1e-7)
    works = [motion.state.energies.work[0] for motion in (by_pattern, by_force)]
    assert works[0] == pytest.approx(works[1], rel=1e-3)


def test_linear_analyses_leave_surfaces_open_and_say_so():
    """And list each mode once, which the time loop divides."""
    given = model(step=LONG)
    free = replace(given, surface_contacts=())
    with pytest.warns(ValidityWarning, match="contact 'floor': contacts of surfaces are open"):
        found = linearize(given).modes(12)
    np.testing.assert_array_equal(found.frequencies, linearize(free).modes(12).frequencies)


# Facets of files


def write_facets(path, points, triangles):
    meshio.Mesh(np.array(points, dtype=float), [("triangle", np.array(triangles))]).write(path)
    return str(path)


SHEET = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]]
TETRAHEDRON = (
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [
        [0, 2, 1],
        [0, 1, 3],
        [1, 2, 3],
        [0, 3, 2],
    ],
)


@pytest.fixture
def sheet(tmp_path):
    return write_facets(tmp_path / "sheet.vtk", 0.02 * np.array(SHEET[0]), SHEET[1])


@pytest.mark.parametrize("geometry", ["smooth", "flat"])
def test_flat_facets_are_a_plane(sheet, geometry):
    plane = Motion(model())
    contact = replace(FLOOR, shape=None, axis=None, facets=sheet, geometry=geometry)
    facets = Motion(model([contact]))
    assert plane.step(40)
    assert facets.step(40)
    np.testing.assert_allclose(facets.forces, plane.forces, atol=1e-9 * max(plane.forces))


def of_file(path, **changes):
    return SurfaceContact("floor", ["block.low", "ground"], facets=str(path), **changes)


def test_closed_facets_have_their_normals_outside_unless_they_are_hollow(tmp_path):
    points, outward = TETRAHEDRON
    inward = np.array(outward)[:, ::-1]
    out, turned = (
        write_facets(tmp_path / f"{name}.vtk", points, facets)
        for name, facets in (("out", outward), ("in", inward))
    )
    with pytest.raises(
        ModelError, match=r"in\.vtk: expected normals that point out .* hollow = true"
    ):
        of_file(turned)
    outside, inside = of_file(out).rigid_surface, of_file(turned, hollow=True).rigid_surface
    np.testing.assert_array_equal(of_file(out, hollow=True).rigid_surface.normals, -outside.normals)
    np.testing.assert_array_equal(inside.normals, -outside.normals)
    np.testing.assert_array_equal(np.sort(inside.facets), np.sort(outside.facets))


def test_facets_that_turn_their_backs_on_each_other_are_refused(tmp_path):
    points, facets = SHEET
    path = write_facets(tmp_path / "mixed.vtk", points, [facets[0], facets[1][::-1]])
    with pytest.raises(ModelError, match=r"mixed\.vtk: .* on one side .* facet 1 against"):
        of_file(path)
    path = write_facets(tmp_path / "open.vtk", points, facets)
    with pytest.raises(ModelError, match=r"open\.vtk: hollow: expected a closed surface"):
        of_file(path, hollow=True)
    path = write_facets(tmp_path / "flat.vtk", points, [*facets, [0, 1, 1]])
    with pytest.raises(
        ModelError, match=r"flat\.vtk: expected facets with an area, found 1 without"
    ):
        of_file(path)


# Feet on facets


def feet(motion, points, first):
    """Facets, feet and whether they are covered, of points above the target of a contact."""
    system, out = motion.system, motion.work.surfaces
    facets, t = system.surfaces.facets, int(system.surfaces.contacts.target[0])
    shape_target(facets, t, system.surfaces.patches.X, out)
    found = []
    for point in points:
        f, *at = walk_to_foot(facets, t, tuple(point), int(facets.range[t]) + first, out)
        foot, _, _ = point_of_facet(facets, t, f, *at[:2], out)
        # of a facet without size, whose cells are covered wholly or not at all
        out.place[facets.nodes[0]] = 0.0
        part, _, _ = cut_at_rim(facets, t, f, tuple(at), (0, 0), (0.0, 0.0, 0.5), out)
        found.append((*foot, part))
    return np.array(found)


@pytest.mark.parametrize("first", [0, 5, 10, 15])
def test_feet_are_below_points_also_on_edges_and_corners_of_facets(first):
    """Of a flat grid of 4 x 4 facets, from any facet on; points beyond the rim are not covered."""
    motion = Motion(model([ON_BLOCK], others={"other": resting(block(4))}))
    lines = np.linspace(-0.5, 0.5, 9) * EDGE
    inner = lines[1:-1]
    shift = 1e-16 * np.random.default_rng(first).integers(-5, 6, (49, 2))
    points = np.array([[x, y] for x in inner for y in inner]) + shift
    level = np.full((len(points), 1), 0.5 * EDGE)
    found = feet(motion, np.hstack([points, level + 1e-5]), first)
    np.testing.assert_allclose(found[:, :3], np.hstack([points, level]), atol=1e-12)
    assert (found[:, 3] == 1.0).all()
    beyond = [[0.6 * EDGE, y, 0.5 * EDGE] for y in lines]
    assert not feet(motion, beyond, first)[:, 3].any()


def globe(path, radius, n=12):
    """A sphere of triangles: the faces of a cube, inflated."""
    side = np.tan(np.linspace(-0.25, 0.25, n + 1) * np.pi)
    a, b = (x.ravel() for x in np.meshgrid(side, side, indexing="ij"))
    points, triangles, one = [], [], np.ones_like(a)
    for axis in range(3):
        for sign in (1.0, -1.0):
            face = np.roll(np.column_stack([sign * one, a, sign * b]), axis, axis=1)
            for i, k in itertools.product(range(n), range(n)):
                p = len(points) * (n + 1) ** 2 + i * (n + 1) + k
                triangles += [[p, p + n + 1, p + n + 2], [p, p + n + 2, p + 1]]
            points.append(face)
    x = np.concatenate(points)
    return write_facets(path, radius * x / np.linalg.norm(x, axis=1)[:, None], triangles)


def test_a_sphere_of_triangles_is_nearly_the_sphere(tmp_path):
    """Its arcs are as high as those of the circle; flat facets miss the height of a chord."""
    radius = 0.02
    path = globe(tmp_path / "globe.vtk", radius)
    center = [1.3e-4, -2.1e-4, -radius]
    rigid = RigidBody(1.0, [1e-3] * 3, {"top": Frame()}, Start(center))
    # Weighted gaps of these large facets are smaller than gaps by a sixth of s^2 / R.
    body = falling(block(4), position=[0.0, 0.0, 0.5 * EDGE + 5e-5])

    def motion(**shape):
        contact = SurfaceContact("floor", ["block.low", "other.top"], **shape)
        run = Motion(model([contact], body=body, others={"other": rigid}))
        assert run.warnings == ()
        assert run.step(400)
        return run

    exact = motion(shape="sphere", radius=radius)
    smooth, flat = (motion(facets=path, geometry=how) for how in ("smooth", "flat"))
    rises = smooth.lowered.system.surfaces.facets.rise
    assert exact.closings == 1
    assert max(smooth.forces) == pytest.approx(max(exact.forces), rel=1e-3)
    assert smooth.impulse == pytest.approx(exact.impulse, rel=1e-3)
    first, late, lower = ((np.array(run.forces) > 0.0).argmax() for run in (exact, smooth, flat))
    # 1 m/s: heights of 2e-7 m, and of a part of those of the arcs, 4e-5 m
    assert late - first <= 1
    assert 20 < lower - first < 200
    patch = smooth.lowered.system.surfaces
    t = int(patch.contacts.target[0])
    first, last = patch.facets.range[t : t + 2]
    corners = patch.patches.X[patch.facets.nodes[first:last, :3]]
    chords = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    heights = radius - np.sqrt(radius**2 - 0.25 * chords**2)
    # The mean normals of irregular facets are not quite those of the sphere.
    ratios = rises[first:last, :3] / heights
    assert np.median(ratios) == pytest.approx(1.0, abs=0.02)
    assert 0.6 < ratios.min() < ratios.max() < 1.4


@pytest.mark.parametrize(
    ("key", "why"),
    [("restitution", "without a law of force"), ("tangential_stiffness", "no spring")],
)
def test_keys_of_contacts_of_balls_are_refused_with_the_reason(key, why):
    keys = {"name": "floor", "surfaces": ["a.low", "ground"], "shape": "plane", "axis": [0, 0, 1]}
    with pytest.raises(ValueError, match=why):
        table_of(SurfaceContact).model_validate({**keys, key: 0.5})


def test_what_is_near_goes_by_the_parts_of_a_surface():
    """A face that lies flat above the ground is near at a third of its radius, not at all of it."""
    motion = Motion(model(body=falling(position=[0.0, 0.0, EDGE])))
    system, state, work = motion.system, motion.state, motion.work
    state.bodies.v[:] = 0.0
    X, ball = system.surfaces.patches.X, system.surfaces.patches.ball
    assert len(ball) == 8
    inside = np.linalg.norm(X[:, None] - ball[:, :3], axis=2) <= ball[:, 3] + 1e-12
    assert inside.any(axis=1).all()
    radius = system.surfaces.patches.radius[0]

    def is_near_at(height):
        lowest = (X @ state.bodies.R[0].T)[:, 2].min()
        state.bodies.x[0] = [0.3, -0.2, height - lowest]
        return is_contact_near(system, 1e-6, state, work)

    assert is_near_at(0.3 * radius)
    assert not is_near_at(0.6 * radius)
    for rotation in Rotation.random(200, random_state=1).as_matrix():
        state.bodies.R[0] = rotation
        assert is_near_at(1e-9)
        assert not is_near_at(2.0 * radius)


@pytest.mark.parametrize("shape", ["plane", "sphere", "hollow sphere"])
def test_rows_of_far_facets_are_those_with_gaps_beyond_the_margin(shape):
    """Beside the rows that all facets give."""
    target = {
        "plane": PLANE,
        "sphere": {"shape": "sphere", "radius": 0.02},
        "hollow sphere": {"shape": "sphere", "radius": 0.02, "hollow": True},
    }[shape]
    height = {"plane": 0.0, "sphere": 0.02, "hollow sphere": -0.02}[shape]
    contact = SurfaceContact("floor", ["block.low", "ground"], **target)
    start = {"position": [1e-3, 2e-3, height + EDGE], "rotation": [0.05, -0.03, 0.4]}
    motion = Motion(model([contact], body=falling(block(6), **start), step=LONG))
    system, state, work = motion.system, motion.state, motion.work
    for _ in range(5):  # down to a gap of 10 um
        measure_surfaces(system, state, work)
        state.bodies.x[0, 2] -= np.nanmin(state.surfaces.gap) - 1e-5
        move_frames(system.frames, system.frames.n_acting, state, work)
    measure_surfaces(system, state, work)
    every, unknown = state.surfaces.gap.copy(), []
    for margin in (0.0, 5e-5, 2e-4):
        look_at_target(system, 0, margin, work)
        set_row_gaps(system.surfaces, 0, state, work)
        near = every < margin
        np.testing.assert_allclose(state.surfaces.gap[near], every[near], rtol=1e-12)
        unknown.append(int(np.isnan(state.surfaces.gap).sum()))
    assert unknown[0] > unknown[-1]
