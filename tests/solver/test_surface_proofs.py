"""Contacts of surfaces beside computations of their own: dense steps, brute force, other places."""

from dataclasses import replace

import numpy as np
import pytest
from duhamel.solver import (
    FlexibleBody,
    Frame,
    Model,
    Revolute,
    RigidBody,
    Settings,
    Start,
    SurfaceContact,
    simulate,
)
from duhamel.solver.step.facing import face_target
from duhamel.solver.step.frames import move_frames
from duhamel.solver.step.surfaces import measure_surfaces
from scipy.spatial.transform import Rotation

from .pressing import EDGE, Motion, arm, block
from .transformed import turned

H = 2e-7
RHO = 0.9
DOWN = [0.0, 0.0, -1.0]
FLOOR = SurfaceContact("floor", ["block.low", "ground"], shape="plane", axis=[0.0, 0.0, 1.0])


def falling(element, rotation=(0.0, 0.0, 0.0), height=1e-7, x=0.0, **start):
    return FlexibleBody(
        element,
        Start([x, 0.0, 0.5 * EDGE + height], rotation=rotation, velocity=[0.0, 0.0, -1.0], **start),
    )


def on_floor(bodies, contacts=(FLOOR,), **changes):
    settings = Settings(t_end=1e-3, step=H, rho_inf=RHO)
    return Model(bodies, surface_contacts=contacts, settings=settings, **changes)


class Dense:
    """A block over the plane z = 0, by dense matrices, one node of its surface for each row.

    Modes up to the band move with the share W of their displacements, and all else of the static
    flexibility H of the surface follows its forces:

        u = phi eta + F f,   phi = sqrt(W) phi_0,   F = H - sum_j W_j phi_j phi_j^T / omega_j^2
        eta'' + omega^2 eta = phi^T f,   m x'' = e_z sum P,   J omega' + omega x J omega = moment
        0 <= P_i  _|_  z_i >= 0

    Generalized-alpha with all of it at the end of the step, by fixed points from the last step.
    """

    def __init__(self, element, body, h):
        surfaces, modes = element.surfaces, element.modes
        (patch,) = [p for p in surfaces.patches if p.name == "low"]
        own = surfaces.rows("low")
        s = np.minimum(modes.omega * h, 1.0)
        s = np.maximum(s, np.minimum(modes.omega / (2.0 * np.pi * element.band), 1.0))
        share = (1.0 - s**8) / (1.0 + (2.0 * s) ** 4)
        shapes = surfaces.phi[own]
        still = np.where(1.0 - share > 1e-9, 1.0 - share, 0.0)
        moving = share > 1e-9
        self.F = surfaces.H[own, own] - (shapes / modes.omega**2) @ shapes.T
        self.F += (shapes * still / modes.omega**2) @ shapes.T
        self.phi = shapes[:, moving] * np.sqrt(share[moving])
        self.omega = modes.omega[moving]
        self.X, self.mass, self.J = patch.X, body.mass, np.asarray(body.inertia)
        self.h = h
        m, f = (2.0 * RHO - 1.0) / (RHO + 1.0), RHO / (RHO + 1.0)
        self.gamma = 0.5 - m + f
        self.beta = 0.25 * (1.0 - m + f) ** 2
        self.m, self.f = m, f
        self.x, self.R = np.array(body.start.position), Rotation.from_rotvec(body.start.rotation)
        self.v, self.a = np.zeros(6), np.zeros(6)
        self.v[:3], self.v[3:] = body.start.velocity, body.start.angular_velocity
        self.v_dot = np.zeros(6)
        self.v_dot[3:] = self._angular(np.zeros(3), self.v[3:])
        self.a[:] = self.v_dot
        n = len(self.omega)
        self.eta, self.rate, self.accel, self.pseudo = np.zeros((4, n))
        self.P = np.zeros(len(self.X))

    def _angular(self, moment, omega):
        return np.linalg.solve(self.J, moment - np.cross(omega, self.J @ omega))

    def _end(self, v_dot, v_dot_n, a_n):
        return ((1 - self.f) * v_dot + self.f * v_dot_n - self.m * a_n) / (1 - self.m)

    def _moved(self, rate, a_n, a):
        return self.h * rate + self.h**2 * ((0.5 - self.beta) * a_n + self.beta * a)

    def step(self):
        h, v_dot = self.h, self.v_dot.copy()
        # a mode at the end of the step is affine in its load: what it is without, and per load
        ratio = (1 - self.f) / (1 - self.m)
        free = self.eta + self._moved(
            self.rate, self.pseudo, self._end(0.0, self.accel, self.pseudo)
        )
        slope = self.beta * h * h * ratio / (1.0 + self.beta * h * h * ratio * self.omega**2)
        unloaded = free - slope * self.omega**2 * free
        G = (self.phi * slope) @ self.phi.T + self.F
        for _ in range(80):
            a = self._end(v_dot, self.v_dot, self.a)
            change = self._moved(self.v, self.a, a)
            v = self.v + h * ((1 - self.gamma) * self.a + self.gamma * a)
            x, R = self.x + change[:3], self.R * Rotation.from_rotvec(change[3:])
            n = R.as_matrix()[2]  # R^T e_z
            B = np.kron(np.eye(len(self.X)), n)
            u_free = (self.phi @ unloaded).reshape(-1, 3)
            P = self._contact(x[2] + (self.X + u_free) @ n, B @ G @ B.T)
            u = u_free + (G @ (B.T @ P)).reshape(-1, 3)
            moment = np.cross(self.X + u, P[:, None] * n).sum(axis=0)
            v_dot = np.append([0.0, 0.0, P.sum() / self.mass], self._angular(moment, v[3:]))
        self.x, self.R, self.v, self.a, self.v_dot, self.P = x, R, v, a, v_dot, P
        eta = unloaded + slope * (self.phi.T @ (B.T @ P))
        accel = self.phi.T @ (B.T @ P) - self.omega**2 * eta
        pseudo = self._end(accel, self.accel, self.pseudo)
        self.rate = self.rate + h * ((1 - self.gamma) * self.pseudo + self.gamma * pseudo)
        self.eta, self.accel, self.pseudo = eta, accel, pseudo

    def _contact(self, gap, W):
        """P >= 0 of the closed rows: whole sets change sides until none is wrong."""
        closed = self.P > 0.0
        for _ in range(50):
            P = np.zeros(len(gap))
            P[closed] = np.linalg.solve(W[np.ix_(closed, closed)], -gap[closed])
            wrong = np.where(closed, P < 0.0, gap + W @ P < 0.0)
            if not wrong.any():
                return P
            closed ^= wrong
        raise AssertionError("no set of rows fits")


@pytest.mark.parametrize("rotation", [(0.0, 0.0, 0.0), (2e-4, -1e-4, 0.3)], ids=["flat", "tilted"])
def test_an_impact_is_that_of_a_dense_computation(rotation):
    element = block()
    body = falling(element, rotation, height=1e-7 if rotation[0] == 0.0 else 1.5e-6)
    motion, dense = Motion(on_floor({"block": body})), Dense(element, body, H)
    forces = []
    for _ in range(90):
        assert motion.step()
        dense.step()
        forces.append(motion.state.surfaces.force - dense.P)
        np.testing.assert_allclose(motion.state.bodies.x[0], dense.x, rtol=0.0, atol=1e-15)
    largest = max(motion.forces)
    assert largest > 1e3
    assert motion.forces[-1] == 0.0
    assert np.abs(forces).max() < 1e-11 * largest
    np.testing.assert_allclose(motion.state.bodies.v[0], dense.v, rtol=0.0, atol=1e-9)


def test_energy_and_momentum_of_a_block_that_bounces_for_1e5_steps():
    """Between a floor and a ceiling 40 um above it, some hundred times."""
    ceiling = SurfaceContact("ceiling", ["block.top", "ground.top"], shape="plane", axis=DOWN)
    tops = {"top": Frame((0.0, 0.0, EDGE + 4e-5))}
    body = falling(block(), (1e-3, 5e-4, 0.2), height=2e-5)
    motion = Motion(on_floor({"block": body}, [FLOOR, ceiling], ground_frames=tops))
    impulse, steps = 0.0, 0
    # up to a flight, in which the filter of the scheme has forgotten the last contact
    while steps < 100_000 or any(motion.forces[-100:]):
        assert motion.step()
        impulse += H * float(motion.state.surfaces.total_force[:, 2].sum())
        steps += 1
    assert motion.closings > 100
    assert motion.gain < 0.03
    assert motion.energies[-1] > 0.5 * motion.energies[0]
    change = body.mass * (motion.state.bodies.v[0, 2] + 1.0)
    assert change == pytest.approx(impulse, abs=1e-9 * body.mass)


def test_gaps_between_boxes_are_those_of_brute_force():
    """Of rows that are wholly above the other box or wholly beside it, in 200 poses."""
    element, rng = block(4), np.random.default_rng(5)
    contact = SurfaceContact("pair", ["block.low", "other.top"], geometry="flat")
    bodies = {"block": falling(element), "other": FlexibleBody(element, Start([0.0, 0.0, -0.01]))}
    motion = Motion(on_floor(bodies, [contact]))
    system, state, work = motion.system, motion.state, motion.work
    patches, facets = system.surfaces.patches, system.surfaces.facets
    rows = int(patches.row[1] - patches.row[0])
    n_facets, per = int(facets.range[1] - facets.range[0]), int(facets.points[0])
    # Cells reach at most so far from their points, in a facet that is turned by 45 degrees.
    half, cell, covered_rows, far_rows = 0.5 * EDGE, 0.08 * EDGE, 0, 0
    for _ in range(200):
        for b in range(2):
            state.bodies.R[b] = Rotation.random(random_state=rng).as_matrix()
        tilt = Rotation.from_rotvec(rng.uniform(-0.3, 0.3, 3)).as_matrix()
        state.bodies.R[0] = state.bodies.R[1] @ tilt
        offset = np.append(rng.uniform(-0.9, 0.9, 2) * EDGE, EDGE + rng.uniform(-5e-4, 3e-3))
        state.bodies.x[1] = rng.uniform(-1.0, 1.0, 3)
        state.bodies.x[0] = state.bodies.x[1] + state.bodies.R[1] @ offset
        move_frames(system.frames, system.frames.n_acting, state, work)
        measure_surfaces(system, state, work)
        x = offset + patches.X[: patches.node[1]] @ tilt.T
        points = np.empty((n_facets, per, 3))
        for f in range(n_facets):
            nodes = facets.nodes[f, : facets.n_nodes[0]]
            N = patches.N[f * per : (f + 1) * per, : len(nodes)]
            points[f] = N @ x[nodes]
        inside = (np.abs(points[..., :2]) < half - cell).all(axis=2)
        beside = (np.abs(points[..., :2]) > half + cell).any(axis=2)
        height = points[..., 2] - half
        for i in range(rows):
            own = np.argwhere(facets.rows[:n_facets, : facets.corners[0]] == i)
            if all(inside[f].all() for f, _ in own):
                w = [patches.weight[f * per : (f + 1) * per] for f, _ in own]
                psi = [patches.dual[f * per : (f + 1) * per, z] for f, z in own]
                total = sum(
                    (w * p * height[f]).sum() for w, p, (f, _) in zip(w, psi, own, strict=True)
                )
                area = sum((w * p).sum() for w, p in zip(w, psi, strict=True))
                assert state.surfaces.gap[i] == pytest.approx(total / area, abs=1e-15)
                covered_rows += 1
            elif all(beside[f].all() for f, _ in own):
                assert np.isnan(state.surfaces.gap[i])
                far_rows += 1
    assert covered_rows > 300
    assert far_rows > 500


class Covered:
    """Rows of the surface `low` of a block over the flat facets of another, by brute force.

    The top of the other is a square about its axis. Its sides cut the cells of the points, which
    count by what is left, with the functions and the height of the middle of that.
    """

    def __init__(self, low, top, depth):
        ends = np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
        self.points = np.array([[a, b] for a in ends for b in ends])
        bounds = np.array([[-1.0, -4.0 / 9.0], [-4.0 / 9.0, 4.0 / 9.0], [4.0 / 9.0, 1.0]])
        cells = [[[x, y] for x in a for y in b] for a in bounds for b in bounds]
        self.cells = np.array(cells) - self.points[:, None]
        self.rows = np.searchsorted(low.corner_nodes, low.corners)
        x = low.X[low.corners]
        areas = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 3] - x[:, 0]), axis=1)
        along = np.array([5.0, 8.0, 5.0]) / 18.0
        self.w = areas[:, None] * np.outer(along, along).ravel()
        self.low, self.depth = low, depth
        self.area = self._summed(self.w[:, :, None] * self._functions(self.points))
        self.level = top.X[0, 2]
        self.half = np.abs(top.X[:, :2]).max(axis=0)

    @staticmethod
    def _functions(at):
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        return 0.25 * (1.0 + at[..., None, :] * corners).prod(axis=-1)

    def gaps(self, offset, turn):
        """Gaps of rows, which are not a number where they do not act, and their parts of areas."""
        corners = (offset + self.low.X @ turn.T)[self.low.corners]
        weights, heights = [], []
        for x, w in zip(corners, self.w, strict=True):
            tangents = 0.5 * np.stack([x[1] - x[0], x[3] - x[0]])
            cells = self.cells @ tangents[:, :2]
            parts, ways = np.ones(9), np.zeros((9, 2))
            for side in (1.0, -1.0):
                low, high = (side * cells).min(axis=1), (side * cells).max(axis=1)
                excess = side * (self._functions(self.points) @ x)[:, :2] - self.half
                within = np.clip((0.0 - excess - low) / (high - low), 0.0, 1.0)
                parts *= within.prod(axis=1)
                ways -= 0.5 * side * (1.0 - within) * (high - low)
            ways = np.hstack([ways, np.zeros((9, 1))]) @ np.linalg.pinv(tangents)
            L = self._functions(self.points + ways)
            height = (L @ x)[:, 2] - self.level
            parts *= height >= -self.depth
            weights.append(self._weights(w, parts, L))
            heights.append(height)
        area = self._summed(np.array(weights))
        total = self._summed(np.array(weights) * np.array(heights)[:, :, None])
        acts = area > 3e-3 * self.area
        return np.where(acts, total / np.where(acts, area, 1.0), np.nan), area / self.area

    def _weights(self, w, parts, L):
        """w psi of the points of a facet, of which parts are left with functions L."""
        if not parts.any():
            return np.zeros_like(L)
        cut = 1.0 - (w @ parts) / w.sum()
        e, w = cut / (1.0 + 2.0 * cut) + 2.0 / 3.0 * cut**8, w * parts
        D = np.diag(w @ L)
        M = (1.0 - e) * (w[:, None] * L).T @ L + e * D
        return w[:, None] * np.linalg.solve(M, L.T).T @ D

    def _summed(self, weights):
        """Sums over the points around each row."""
        total = np.zeros(len(self.low.corner_nodes))
        np.add.at(total, self.rows, weights.sum(axis=1))
        return total


def test_rows_that_are_covered_in_part_are_those_of_brute_force():
    """And bodies at rest push where these gaps are below zero by 1 nm, not above it."""
    element, rng = block(4), np.random.default_rng(7)
    contact = SurfaceContact("pair", ["block.low", "other.top"], geometry="flat")

    def pair(offset, turn, x, R):
        above = Start(x + R.apply(offset), (R * turn).as_rotvec())
        below = Start(x, R.as_rotvec())
        starts = {"block": above, "other": below}
        bodies = {name: FlexibleBody(element, start) for name, start in starts.items()}
        return Motion(on_floor(bodies, [contact]))

    apart = np.array([0.0, 0.0, EDGE + 0.01])
    motion = pair(apart, Rotation.identity(), np.zeros(3), Rotation.identity())
    system, state, work = motion.system, motion.state, motion.work
    covered = Covered(element.surface("low"), element.surface("top"), EDGE / np.sqrt(8.0))
    acting, in_part, tried, overlaps = 0, 0, 0, 0
    for _ in range(200):
        tilt = Rotation.from_rotvec(np.append(rng.uniform(-0.3, 0.3, 2), 0.0))
        turn = tilt * Rotation.from_rotvec([0.0, 0.0, rng.uniform(-np.pi, np.pi)])
        offset = np.append(rng.uniform(-0.9, 0.9, 2) * EDGE, EDGE + rng.uniform(-1e-3, 2e-3))
        x, R = rng.uniform(-1.0, 1.0, 3), Rotation.random(random_state=rng)
        state.bodies.x[:] = x + R.apply(offset), x
        state.bodies.R[:] = (R * turn).as_matrix(), R.as_matrix()
        move_frames(system.frames, system.frames.n_acting, state, work)
        measure_surfaces(system, state, work)
        gaps, parts = covered.gaps(offset, turn.as_matrix())
        np.testing.assert_allclose(state.surfaces.gap, gaps, rtol=0.0, atol=1e-15)
        acts = np.isfinite(gaps)
        acting += acts.sum()
        in_part += (acts & (parts < 0.99)).sum()
        if acts.any():
            offset[2] += rng.choice([-1e-9, 1e-9]) - gaps[acts].min()
            touching = pair(offset, turn, x, R)
            overlap = bool((covered.gaps(offset, turn.as_matrix())[0] < 0.0).any())
            assert touching.step()
            assert (touching.forces[-1] > 0.0) == overlap
            tried += 1
            overlaps += overlap
    assert in_part > 1500
    assert acting - in_part > 500
    assert tried > 150
    assert 0.35 < overlaps / tried < 0.65


def test_gradients_of_rows_that_are_cut_are_those_of_differences():
    """By the motion of the body over the other one, which changes what is left of cells."""
    element, rng, e = block(4), np.random.default_rng(3), 1e-9
    contact = SurfaceContact("pair", ["block.low", "other.top"], geometry="flat")
    starts = {"block": Start([0.0, 0.0, EDGE + 0.01]), "other": Start()}
    bodies = {name: FlexibleBody(element, start) for name, start in starts.items()}
    motion = Motion(on_floor(bodies, [contact]))
    system, state, work = motion.system, motion.state, motion.work
    patches = system.surfaces.patches

    def gaps(x):
        state.bodies.x[0] = x
        move_frames(system.frames, system.frames.n_acting, state, work)
        measure_surfaces(system, state, work)
        return state.surfaces.gap.copy()

    cut, turned_far = 0, 0
    for _ in range(40):
        tilt = Rotation.from_rotvec(np.append(rng.uniform(-0.3, 0.3, 2), 0.0))
        turn = tilt * Rotation.from_rotvec([0.0, 0.0, rng.uniform(-np.pi, np.pi)])
        state.bodies.R[0] = turn.as_matrix()
        x = np.append(rng.uniform(-0.9, 0.9, 2) * EDGE, EDGE + rng.uniform(-1e-3, 2e-3))
        y, gradients = gaps(x), {}
        part = work.surfaces.area / patches.area[: len(y)]
        for i in map(int, np.flatnonzero(np.isfinite(y) & (part < 0.999))):
            face_target(system.surfaces, 0, i, work)
            own = slice(patches.support_range[i], patches.support_range[i + 1])
            gradients[i] = work.surfaces.facing[own].sum(axis=0)
        slopes = np.array([(gaps(x + e * d) - gaps(x - e * d)) / (2.0 * e) for d in np.eye(3)])
        for i, gradient in gradients.items():
            # A row that begins to act between the two places has no difference.
            if np.isfinite(slopes[:, i]).all():
                np.testing.assert_allclose(gradient, slopes[:, i], rtol=0.0, atol=1e-6)
                turned_far += np.hypot(*gradient[:2]) > 0.1
                cut += 1
    assert cut > 300
    assert turned_far > 100


@pytest.mark.parametrize("tilt", [0.02, 0.1])
def test_an_edge_hits_a_face_whichever_of_the_two_has_the_rows(tilt):
    """In the middle of large facets, by a quarter of the block, while it slides off."""
    height = EDGE + 0.25 * EDGE * np.sin(tilt) + 2e-5
    start = {"rotation": Rotation.from_rotvec([0.0, tilt, 0.3]).as_rotvec()}
    start |= {"velocity": [0.3, 0.1, -1.0]}
    bodies = {
        "block": FlexibleBody(block(4), Start([0.75 * EDGE, 0.03 * EDGE, height], **start)),
        "other": FlexibleBody(block(4), Start()),
    }

    def run(*surfaces):
        contact = SurfaceContact("pair", surfaces, geometry="flat")
        return simulate(
            replace(
                on_floor(bodies, [contact]), settings=Settings(t_end=5e-4, step=4e-7, rho_inf=RHO)
            )
        )

    runs = [run("block.low", "other.top"), run("other.top", "block.low")]
    forces = [results.contact("pair").normal_force.max() for results in runs]
    impulses = [results.contact("pair").impulse[-1] for results in runs]
    for results in runs:
        energy = results.energy
        assert np.abs(energy.balance).max() < 1e-4 * energy.kinetic[0]
    assert forces[0] == pytest.approx(forces[1], rel=0.06)
    assert impulses[0] == pytest.approx(impulses[1], rel=0.02)


def test_two_hundred_bodies_fall_as_one_does():
    bodies = {f"b{k}": falling(block(), (1e-4, 0.0, 0.0), x=0.02 * k) for k in range(200)}
    contacts = [replace(FLOOR, name=name, surfaces=[f"{name}.low", "ground"]) for name in bodies]
    many = Motion(on_floor(bodies, contacts))
    alone = Motion(on_floor({"block": falling(block(), (1e-4, 0.0, 0.0))}))
    assert many.step(8)
    assert alone.step(8)
    expected = alone.state.surfaces.normal_force[0]
    assert expected > 100.0
    np.testing.assert_allclose(many.state.surfaces.normal_force, expected, rtol=1e-11)


def test_a_hundred_pairs_meet_as_one_does():
    """Row by row, over a whole impact of blocks that are off each other's edges."""

    def forces(n):
        place = {"rotation": [0.0, 0.0, 0.4]}
        bodies, contacts = {}, []
        for k in range(n):
            bodies[f"a{k}"] = falling(block(), (1e-4, 0.0, 0.0), x=0.02 * k)
            below = Start([0.02 * k + 1e-3, 5e-4, -0.5 * EDGE], **place)
            bodies[f"b{k}"] = FlexibleBody(block(), below)
            contacts.append(SurfaceContact(f"c{k}", [f"a{k}.low", f"b{k}.top"]))
        motion, found = Motion(on_floor(bodies, contacts)), []
        for _ in range(60):
            assert motion.step()
            found.append(motion.state.surfaces.force.reshape(n, -1).copy())
        return np.array(found)

    alone = forces(1)
    assert alone.sum(axis=2).max() > 1e3
    assert not alone[-1].any()
    # Of the largest, for they are at up to 2 m, where coordinates are rounded to 2e-16 m.
    error = np.abs(forces(100) - alone).max()
    assert error < 1e-10 * alone.max()


@pytest.mark.parametrize(
    ("shift", "tolerance"), [([0.3, -0.4, 0.2], 1e-8), ([600.0, -700.0, 400.0], 1e-5)]
)
def test_joints_and_friction_do_not_depend_on_the_frame(shift, tolerance):
    """An arm on a hinge that swings on to a floor, on which its end slides."""
    hinge = Revolute("ground.post", "arm.root", [0.0, 1.0, 0.0], name="hinge")
    contact = SurfaceContact(
        "floor", ["arm.low", "ground.floor"], shape="plane", axis=[0.0, 0.0, 1.0], friction=0.3
    )
    swinging = Start([0.0, 0.0, 0.0], angular_velocity=[0.0, 20.0, 0.0])
    model = Model(
        {"arm": FlexibleBody(arm(), replace(swinging, velocity=[0.0, 0.0, -0.8]))},
        joints=[hinge],
        surface_contacts=(contact,),
        ground_frames={
            "post": Frame((-0.04, 0.0, 0.0)),
            "floor": Frame((0.0, 0.0, -0.0021)),
        },
        settings=Settings(t_end=1e-4, step=1e-6, rho_inf=RHO),
    )
    turn = Rotation.from_rotvec([0.7, -1.1, 0.5])
    here, there = simulate(model, force=True), simulate(turned(model, turn, shift), force=True)
    a, b = here.contact("floor").force, there.contact("floor").force
    largest = np.abs(a).max()
    assert np.abs(a[:, 0]).max() > 0.1 * largest  # it slides
    np.testing.assert_allclose(b, turn.apply(a), atol=tolerance * largest)
    a, b = here.joint("hinge").force, there.joint("hinge").force
    np.testing.assert_allclose(b, turn.apply(a), atol=tolerance * np.abs(a).max())


@pytest.mark.parametrize(
    ("shift", "tolerance"), [([0.3, -0.4, 0.2], 1e-8), ([600.0, -700.0, 400.0], 1e-5)]
)
def test_joints_and_friction_do_not_depend_on_a_flight_at_100_m_per_s(shift, tolerance):
    """An arm that swings on a hinge of a carrier, on to the floor of it, where its end slides.

    At 1 km places are rounded to 1e-13 m: over h^2, of 0.02 kg, 2e-3 N of the hinge's 400 N.
    """

    def forces(turn, shift, velocity):
        def start(place, own, spin):
            own = turn.apply(own) + velocity
            return Start(
                turn.apply(place) + shift, turn.as_rotvec(), velocity=own, angular_velocity=spin
            )

        frames = {"post": Frame((-0.04, 0.0, 0.0)), "floor": Frame((0.0, 0.0, -0.0021))}
        still, up = [0.0, 0.0, 0.0], turn.apply([0.0, 0.0, 1.0])
        carrier = RigidBody(5.0, [1e-2] * 3, frames, start(still, still, still))
        swinging = start(still, [0.0, 0.0, -0.8], [0.0, 20.0, 0.0])
        hinge = Revolute("carrier.post", "arm.root", turn.apply([0.0, 1.0, 0.0]), name="hinge")
        keys = ["arm.low", "carrier.floor"]
        contact = SurfaceContact("floor", keys, shape="plane", axis=up, friction=0.3)
        model = Model(
            {"carrier": carrier, "arm": FlexibleBody(arm(), swinging)},
            joints=[hinge],
            surface_contacts=[contact],
            settings=Settings(t_end=2e-4, step=1e-6, rho_inf=RHO),
        )
        results = simulate(model, force=True)
        found = results.contact("floor").force, results.joint("hinge").force
        return [turn.inv().apply(force) for force in found]

    here = forces(Rotation.identity(), np.zeros(3), np.zeros(3))
    turn, velocity = Rotation.from_rotvec([0.7, -1.1, 0.5]), np.array([60.0, 70.0, -40.0])
    there = forces(turn, np.array(shift), velocity)
    contact = here[0]
    closed = np.abs(contact[:, 2]) > 0.0
    ratio = np.abs(contact[closed, 0] / contact[closed, 2])
    assert closed.sum() > 20
    assert ratio.max() == pytest.approx(0.3, rel=1e-4)  # it slides, and the carrier turns a little
    for a, b in zip(here, there, strict=True):
        np.testing.assert_allclose(b, a, rtol=0.0, atol=tolerance * np.abs(a).max())
