"""Jacobians, tangents and the Newton matrix against central differences on the manifold, far from
the start.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    LOADS,
    Bearing,
    Constant,
    ConstantVelocity,
    ConvergenceError,
    Coupler,
    Cylindrical,
    Drag,
    Fixed,
    FlexibleBody,
    Force,
    Frame,
    Harmonic,
    Model,
    Planar,
    Polynomial,
    Revolute,
    RigidBody,
    Rod,
    Screw,
    Settings,
    Spherical,
    Spring,
    Start,
    TabulatedLaw,
    Torque,
    Universal,
    simulate,
)
from duhamel.solver.lower.lower import LoweredModel
from duhamel.solver.start.initial import initialize
from duhamel.solver.start.jacobian import coupling_jacobian
from duhamel.solver.start.matrices import dense_of
from duhamel.solver.step.bodies import set_rotations
from duhamel.solver.step.equations import assemble, convective_terms, evaluate, linearize
from duhamel.solver.step.newton import correct, renew
from duhamel.solver.step.system import State, System, Workspace
from scipy.spatial.transform import Rotation

from .laws import LAWS
from .matrices import in_space
from .models import model_of

AXIS, SECOND = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, -2.0, 1.0]) / 3.0
BENT = np.array([2.0, 2.0, 1.0]) / 3.0
SWAY_2 = Polynomial((0.1, 0.3, -0.2))
EVERY_JOINT = {
    "fixed": {},
    "spherical": {},
    "revolute": {"axis": AXIS},
    "universal": {"axis": AXIS, "second_axis": SECOND},
    "cylindrical": {"axis": AXIS},
    "prismatic": {"axis": AXIS},
    "planar": {"axis": AXIS},
    "driven revolute": {"axis": AXIS, "angle": Harmonic(0.8, 1.0, 0.5)},
    "driven prismatic": {"axis": AXIS, "distance": Polynomial((0.0, 0.4))},
    "driven cylindrical": {
        "axis": AXIS,
        "angle": Constant(0.4),
        "distance": Polynomial((0.0, 0.4)),
    },
    "rod": {},
    "driven rod": {"distance": Polynomial((0.6, 0.4))},
    "screw": {"axis": AXIS, "lead": 0.7, "reference_coordinates": {"distance": 0.3}},
    "driven screw": {"axis": AXIS, "lead": -0.7, "angle": Harmonic(0.8, 1.0, 0.5)},
    "constant_velocity": {"axis": AXIS, "second_axis": BENT},
    "point_on_line": {"axis": AXIS},
    "driven point_on_line": {"axis": AXIS, "distance": Polynomial((0.0, 0.4))},
    "point_on_plane": {"axis": AXIS},
    "driven universal": {
        "axis": AXIS,
        "second_axis": SECOND,
        "angle": Harmonic(0.8, 1.0, 0.5),
        "second_angle": Constant(0.4),
    },
    "turned spherical": {"rotation_vector": [Harmonic(0.8, 1.0, 0.5), Constant(0.4), SWAY_2]},
    "tilted spherical": {"cardan_angles": [Harmonic(0.8, 1.0, 0.5), Constant(1.4), SWAY_2]},
}

SWAY = Harmonic(0.8, 1.0, 0.5)


def symmetric(seed, size):
    """A full positive matrix (6, 6)."""
    half = np.random.default_rng(seed).normal(size=(6, 6))
    return size * half @ half.T


PAIRS = [("rigid", "rigid"), ("rigid", "flexible"), ("flexible", "flexible")]


@dataclass
class Point:
    """A model far from its start: everything that can be random is."""

    lowered: LoweredModel
    state: State
    work: Workspace

    @property
    def system(self) -> System:
        return self.lowered.system

    @property
    def n_q(self) -> int:
        return 6 * len(self.state.bodies.x)

    @property
    def active(self) -> np.ndarray:
        return self.system.elastic.active

    @classmethod
    def of(cls, model, seed=0):
        """Rotations of any size, elastic displacements of centimeters, elastic rotations up to 0.3
        rad.
        """
        rng = np.random.default_rng(seed)
        initial = initialize(model)
        lowered, state, work = initial.lowered, initial.state, initial.work
        state.bodies.x[:] += rng.uniform(-0.5, 0.5, state.bodies.x.shape)
        work.bodies.quaternion_n[:] = Rotation.random(len(state.bodies.x), rng).as_quat(
            scalar_first=True
        )
        work.bodies.psi[:] = rng.uniform(-0.6, 0.6, work.bodies.psi.shape)
        state.bodies.v[:] = rng.uniform(-3.0, 3.0, state.bodies.v.shape)
        state.bodies.v_dot[:] = rng.uniform(-3.0, 3.0, state.bodies.v_dot.shape)
        state.couplings.lam[:] = rng.uniform(-2.0, 2.0, len(state.couplings.lam))
        state.interfaces.u[:] = rng.uniform(-0.17, 0.17, len(state.interfaces.u))
        work.interfaces.history[:] = rng.uniform(-0.1, 0.1, len(work.interfaces.history))
        work.loads.value[:] = rng.uniform(1, 2, len(model.loads))
        work.drives.value[:] = rng.uniform(-1, 1, len(lowered.drives))
        point = cls(lowered, state, work)
        set_rotations(state, work)
        return point.evaluated()

    def evaluated(self):
        evaluate(self.system, self.state, self.work)
        return self

    def forces(self):
        """Generalized forces on the bodies and on the active interface dofs."""
        return np.concatenate(
            [self.work.bodies.force.ravel(), self.state.interfaces.p[self.active]]
        )

    def coordinates(self):
        """Of all rows, with their terms."""
        hard, work = self.system.couplings.compliant == 0, self.work.couplings
        return np.where(hard, work.phi, work.coordinate)

    def moved(self, z):
        """Forces and coordinates of rows after delta x, delta Theta of every body and delta u; the
        point stays.
        """
        x, R, u = (
            self.state.bodies.x.copy(),
            self.state.bodies.R.copy(),
            self.state.interfaces.u.copy(),
        )
        rigid = z[: self.n_q].reshape(-1, 6)
        self.state.bodies.x[:] += rigid[:, :3]
        self.state.bodies.R[:] = R @ Rotation.from_rotvec(rigid[:, 3:]).as_matrix()
        self.state.interfaces.u[self.active] += z[self.n_q :]
        self.evaluated()
        forces, coordinates = self.forces(), self.coordinates()
        self.state.bodies.x[:], self.state.bodies.R[:], self.state.interfaces.u[:] = x, R, u
        return forces, coordinates


def difference(f, n, h=1e-3):
    """The derivative of f: R^n -> (R^m, R^k) at 0 as matrices, by central differences of order
    four.
    """
    columns = []
    for e in np.eye(n):
        near = [a - b for a, b in zip(f(h * e), f(-h * e), strict=True)]
        far = [a - b for a, b in zip(f(2 * h * e), f(-2 * h * e), strict=True)]
        columns.append([(8 * a - b) / (12 * h) for a, b in zip(near, far, strict=True)])
    return [np.array(part).T for part in zip(*columns, strict=True)]


def assert_tangents(model, seed=0):
    """K = d forces / dz and B = d coordinates / dz."""
    point = Point.of(model, seed)
    n = point.n_q + len(point.active)
    K, B = difference(point.moved, n)
    point.evaluated()
    linearize(point.system, point.state, point.work)
    tangent = in_space(point.system, point.state, point.work.matrix.S)[:n, :n]
    np.testing.assert_allclose(tangent, K, rtol=0, atol=1e-9 * max(1.0, np.abs(K).max()))
    if len(B):
        gradients = dense_of(coupling_jacobian(point.system, point.state, point.work))
        np.testing.assert_allclose(gradients, B, rtol=0, atol=1e-9 * np.abs(B).max())
        # and the forces are B^T lambda
        if not model.loads:
            np.testing.assert_allclose(
                point.forces(), B.T @ point.state.couplings.lam, rtol=0, atol=1e-9
            )


@pytest.fixture(scope="module")
def make_body(random_element):
    """A body whose frame `i0` starts at the origin, with axes of its own."""

    def make(kind, seed, omega=(50.0, 5000.0), **start):
        rng = np.random.default_rng(seed)
        rotation = rng.uniform(-1, 1, 3)
        if kind == "flexible":
            element = random_element(seed, (True, False), omega=omega)
            X = element.interface("i0").X
            position = -(Rotation.from_rotvec(rotation).as_matrix() @ X)
            return FlexibleBody(element, Start(position, rotation, **start))
        X = rng.normal(size=3)
        frame = Frame(X, rng.uniform(-1, 1, 3))
        position = -(Rotation.from_rotvec(rotation).as_matrix() @ X)
        return RigidBody(
            1.5,
            [1.0, 2.0, 1.5],
            {"i0": frame, "i1": Frame(rng.normal(size=3))},
            Start(position, rotation, **start),
        )

    return make


@pytest.fixture(scope="module")
def make_pair(make_body):
    def make(kinds, joints=(), **settings):
        bodies = {
            name: make_body(kind, seed)
            for seed, (name, kind) in enumerate(zip("ab", kinds, strict=True), 5)
        }
        return model_of(bodies, joints, **{"step": 1e-2, "rho_inf": 0.8} | settings)

    return make


def ends_of(name):
    """Two frames that coincide at the start, but of a rod."""
    return ("a.i0", "b.i1") if "rod" in name else ("a.i0", "b.i0")


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
@pytest.mark.parametrize("name", EVERY_JOINT)
def test_rows_of_a_joint(make_pair, name, kinds):
    """Jacobian, wrench and derivative of B^T lambda."""
    joint = JOINTS[name.split()[-1]](*ends_of(name), name="joint", **EVERY_JOINT[name])
    assert_tangents(make_pair(kinds, (joint,), assemble=True))


@pytest.mark.parametrize("name", EVERY_JOINT)
def test_rows_of_a_joint_to_the_ground(make_pair, name):
    ends = ends_of(name)[1].replace("b", "a")
    ground = "ground" if ends == "a.i0" else "ground.post"
    for between in ((ground, ends), (ends, ground)):
        joint = JOINTS[name.split()[-1]](*between, name="joint", **EVERY_JOINT[name])
        post = {"post": Frame([0.2, -0.1, 0.3])} if ground != "ground" else {}
        model = make_pair(("flexible", "rigid"), (joint,), ground_frames=post, assemble=True)
        assert_tangents(model, seed=3)


@pytest.mark.parametrize("follower", [False, True], ids=["dead", "follower"])
@pytest.mark.parametrize("kind", ["force", "torque"])
@pytest.mark.parametrize("on", ["a.i0", "b.i0", "b"])
def test_the_tangent_of_a_load(make_pair, on, kind, follower):
    """On an interface, a frame of a rigid body and its origin."""
    load = LOADS[kind](on, [1.0, -2.0, 0.5], Constant(1.0), follower)
    assert_tangents(make_pair(("flexible", "rigid"), loads=(load,)))


def test_the_tangent_of_many_joints_and_loads_on_shared_frames(make_pair):
    model = make_pair(
        ("flexible", "flexible"),
        (
            Revolute("a.i0", "b.i0", AXIS, name="one"),
            Universal("ground", "a.i0", AXIS, SECOND, name="two"),
        ),
        loads=(
            Force("b.i1", [1.0, 0.0, 2.0], Constant(1.0), follower=True),
            Torque("a.i0", [0.0, 1.0, 2.0], Constant(1.0)),
        ),
    )
    assert_tangents(model, seed=4)


COUPLED = ["one.second_angle", "two.distance", "three.angle", "two.angle"]


def coupled(make_body, **settings):
    """A coupler of a row's own frames and three other pairs, two of them of one joint."""
    bodies = {
        "a": make_body("flexible", 5),
        "b": make_body("rigid", 6),
        "c": make_body("flexible", 7),
        "d": make_body("rigid", 8),
    }
    joints = (
        Universal("ground", "a.i0", AXIS, SECOND, name="one"),
        Cylindrical("a.i0", "b.i0", AXIS, name="two"),
        Revolute("c.i0", "d.i0", SECOND, name="three"),
    )
    couplers = (Coupler("mix", "linear", COUPLED, ratios=[1.0, 2.0, -0.5, 3.0]),)
    return model_of(bodies, joints, couplers=couplers, **{"step": 1e-2, "rho_inf": 0.8} | settings)


def test_the_row_of_a_coupler(make_body):
    assert_tangents(coupled(make_body), seed=2)


def test_the_newton_matrix_of_a_coupler(make_body):
    assert_newton_matrix(Point.of(coupled(make_body), seed=2))


SPRINGS = {
    "point": {"stiffness": 30.0, "damping": 2.0, "rest": 0.3},
    "torsion": {
        "axis": AXIS,
        "stiffness": 5.0,
        "damping": 0.4,
        "law": TabulatedLaw((-1.0, 0.0, 1.0), (-3.0, 0.0, 8.0)),
    },
    "bushing": {"axis": AXIS, "stiffness": symmetric(1, 50.0), "damping": symmetric(2, 3.0)},
}


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
@pytest.mark.parametrize("name", SPRINGS)
def test_rows_of_a_spring(make_pair, name, kinds):
    """Wrenches and their derivatives at constant multipliers, of distances, angles and
    displacements.
    """
    spring = Spring(
        "spring", name, ("a.i0", "b.i1" if name == "point" else "b.i0"), **SPRINGS[name]
    )
    assert_tangents(make_pair(kinds, springs=(spring,)))


@pytest.mark.parametrize("turns", [-3, -1, 0, 2])
def test_the_rows_of_an_angle_go_on_over_full_turns(make_pair, turns):
    """The value of the branch nearest to the expected one, with the same gradient."""
    spring = Spring("spring", "torsion", ("a.i0", "b.i0"), AXIS, stiffness=1.0)
    point = Point.of(make_pair(("flexible", "rigid"), springs=(spring,)))
    value, gradient = point.work.couplings.coordinate[0], point.work.couplings.gradient[0].copy()
    point.work.couplings.near[0] = value + 2 * np.pi * turns + 3.0
    point.evaluated()
    assert point.work.couplings.coordinate[0] == pytest.approx(value + 2 * np.pi * turns, abs=1e-13)
    np.testing.assert_array_equal(point.work.couplings.gradient[0], gradient)


def whole_matrix(point):
    """The derivative of the residuals by (dr, du, dlambda), in space, from the blocks of the
    iteration matrix.
    """
    system, state, work = point.system, point.state, point.work
    linearize(system, state, work)
    assemble(system, state, work)
    h2, n_a = system.scheme.h**2, len(point.active)
    rows = np.concatenate(
        [
            np.full(point.n_q, 1.0 / h2),
            np.full(n_a, -1.0),
            np.where(system.couplings.compliant == 1, 1.0 / h2, 1.0),
        ]
    )
    columns = np.ones(len(rows))
    columns[point.n_q + n_a :] = h2
    return rows[:, None] * in_space(system, state, work.matrix.S) * columns


def step_residuals(point, z):
    """Of equilibrium, displacements and rows, with accelerations and rates that follow the
    increments; it stays.
    """
    state, work, scheme = point.state, point.work, point.system.scheme
    kept = [
        array.copy()
        for array in (
            state.bodies.x,
            state.bodies.v,
            state.bodies.v_dot,
            state.interfaces.u,
            state.couplings.lam,
            work.bodies.psi,
        )
    ]
    n_q, n_a = point.n_q, len(point.active)
    rigid = z[:n_q].reshape(-1, 6)
    for b, step in enumerate(rigid):
        # psi after exp(psi) exp(delta Theta), not to first order alone
        turned = Rotation.from_rotvec(work.bodies.psi[b]) * Rotation.from_rotvec(step[3:])
        change = np.concatenate([step[:3], turned.as_rotvec() - work.bodies.psi[b]])
        state.bodies.x[b] += change[:3]
        work.bodies.psi[b] += change[3:]
        state.bodies.v[b] += scheme.gamma_prime * change
        state.bodies.v_dot[b] += scheme.beta_prime * change
    set_rotations(state, work)
    state.interfaces.u[point.active] += z[n_q : n_q + n_a]
    state.couplings.lam[:] += z[n_q + n_a :]
    point.evaluated()
    parts = (
        work.bodies.residual.ravel().copy(),
        work.interfaces.residual.copy(),
        work.couplings.phi.copy(),
    )
    for array, old in zip(
        (
            state.bodies.x,
            state.bodies.v,
            state.bodies.v_dot,
            state.interfaces.u,
            state.couplings.lam,
            work.bodies.psi,
        ),
        kept,
        strict=True,
    ):
        array[:] = old
    set_rotations(state, work)
    return parts


@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_the_newton_matrix_entry_by_entry(make_body, rule):
    """With springs and dampers of all kinds, a driven joint, followers, and elastic rates."""
    bodies = {
        "a": make_body("flexible", 5),
        "b": make_body("flexible", 6),
        "c": make_body("rigid", 7),
    }
    springs = (
        Spring(
            "bush",
            "bushing",
            ("a.i0", "b.i0"),
            stiffness=symmetric(1, 50.0),
            damping=symmetric(2, 0.5),
        ),
        Spring("turn", "torsion", ("b.i0", "c.i0"), **SPRINGS["torsion"]),
        Spring("tie", "point", ("c.i1", "a.i1"), **SPRINGS["point"]),
    )
    loads = (
        Force("a.i0", [1.0, 2.0, -1.0], Constant(1.0), follower=True),
        Torque("b.i0", [1.0, -2.0, 3.0], Constant(1.0), follower=True),
        Torque("a.i0", [0.0, 1.0, 2.0], Constant(1.0)),
        Drag("b.i0", quadratic=0.7, linear=0.2),
        Drag("c.i1", quadratic=0.4),
    )
    joints = (Revolute("c.i0", "a.i0", AXIS, name="motor", angle=Harmonic(0.8, 1.0, 0.5)),)
    point = Point.of(
        Model(
            bodies,
            joints,
            loads,
            springs,
            settings=Settings(t_end=1.0, step=1e-2, rho_inf=0.8, rule=rule),
        ),
        seed=11,
    )
    rng = np.random.default_rng(12)
    point.work.interfaces.u_predicted[:] = point.state.interfaces.u
    point.work.interfaces.rate_predicted[:] = rng.uniform(-1.0, 1.0, len(point.state.interfaces.u))
    point.evaluated()
    assert_newton_matrix(point, h=1e-4)  # drag is no polynomial of the velocity


def assert_newton_matrix(point, tolerance=1e-9, h=1e-3):
    """Entry by entry, against differences of the residuals."""
    n = point.n_q + len(point.active) + len(point.state.couplings.lam)
    differences = difference(lambda z: step_residuals(point, z), n, h)
    point.evaluated()
    matrix = np.split(whole_matrix(point), np.cumsum([len(part) for part in differences])[:-1])
    columns = np.cumsum([point.n_q, len(point.active)])
    for rows, expected in zip(matrix, differences, strict=True):
        for block, wanted in zip(
            np.split(rows, columns, 1), np.split(expected, columns, 1), strict=True
        ):
            np.testing.assert_allclose(
                block, wanted, rtol=0, atol=tolerance * max(1.0, np.abs(wanted).max())
            )


def chain(make_body, omega=(50.0, 5000.0), **settings):
    """Two flexible bodies and a rigid one, hinged together, spinning, with a follower."""
    spin = {"angular_velocity": [2.0, -3.0, 4.0]}
    bodies = {
        "a": make_body("flexible", 5, omega, **spin),
        "b": make_body("flexible", 6, omega, **spin),
        "c": make_body("rigid", 7, **spin),
    }
    return model_of(
        bodies,
        (
            Revolute("a.i0", "b.i0", AXIS, name="ab"),
            Universal("b.i0", "c.i0", AXIS, SECOND, name="bc"),
        ),
        loads=(Force("a.i0", [1.0, 2.0, -1.0], Constant(60.0), follower=True),),
        **{"gravity": [0, 0, -9.81], "step": 1e-2, "rho_inf": 0.8} | settings,
    )


@pytest.mark.parametrize("law", LAWS)
def test_the_newton_matrix_of_force_laws(make_body, law):
    """By themselves and in sum, on distances, angles and axes of a bushing, after a past."""
    bodies = {"a": make_body("flexible", 5), "b": make_body("rigid", 7)}
    both = (LAWS[law], LAWS["Maxwell"])
    springs = (
        Spring("tie", "point", ("b.i1", "a.i1"), stiffness=3.0, law=LAWS[law]),
        Spring("turn", "torsion", ("a.i0", "b.i0"), AXIS, damping=2.0, law=both),
        Spring("bush", "bushing", ("a.i0", "b.i0"), law={"y": both, "rx": LAWS[law]}),
    )
    settings = Settings(t_end=1.0, step=1e-2, rho_inf=0.8)
    point = Point.of(Model(bodies, springs=springs, settings=settings), seed=13)
    memory = point.state.couplings.memory
    memory[:] = np.random.default_rng(14).uniform(-0.5, 0.5, len(memory))
    point.work.couplings.elapsed[0] = 1e-2
    point.state.bodies.v[:] *= 4.0  # rates away from 0, where dampers have a kink
    point.work.interfaces.u_predicted[:] = point.state.interfaces.u
    point.evaluated()
    assert_newton_matrix(point, 1e-8)  # laws bend within the differences


def test_the_newton_matrix_of_bearings(make_body):
    """Constant, and by a table over the rate of an angle, both with cross coupling."""
    bodies = {"a": make_body("flexible", 5), "b": make_body("rigid", 7)}
    cross, table = [[5.0, 2.0], [-1.0, 7.0]], np.arange(8.0).reshape(2, 4)
    bearings = (
        Bearing("still", ("b.i1", "a.i1"), AXIS, stiffness=cross, damping=[[0.3, 0.1], [0.2, 0]]),
        Bearing("film", ("a.i0", "b.i0"), AXIS, table, table[::-1] ** 2, speeds=[-40.0, 50.0]),
    )
    settings = Settings(t_end=1.0, step=1e-2, rho_inf=0.8)
    point = Point.of(Model(bodies, bearings=bearings, settings=settings), seed=4)
    assert_newton_matrix(point, h=1e-4)  # the rate of an angle is no polynomial


@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_newtons_correction_removes_the_residuals_to_first_order(make_body, rule):
    """d r / d(correction) = -r for equilibrium, constraints and interface displacements."""
    point = Point.of(chain(make_body, rule=rule), seed=8)
    state, work = point.state, point.work

    def unknowns():
        return [
            state.bodies.x.copy(),
            work.bodies.psi.copy(),
            state.bodies.v.copy(),
            state.bodies.v_dot.copy(),
            state.interfaces.u.copy(),
            state.couplings.lam.copy(),
        ]

    def residuals(start, change, share):
        for array, value, part in zip(
            (
                state.bodies.x,
                work.bodies.psi,
                state.bodies.v,
                state.bodies.v_dot,
                state.interfaces.u,
                state.couplings.lam,
            ),
            start,
            change,
            strict=True,
        ):
            array[:] = value + share * part
        set_rotations(state, work)
        point.evaluated()
        return [
            part.copy().ravel()
            for part in (work.bodies.residual, work.couplings.phi, work.interfaces.residual)
        ]

    start = unknowns()
    here = residuals(start, start, 0.0)
    assert renew(point.system, state, work)
    correct(point.system, state, work)
    change = [after - before for after, before in zip(unknowns(), start, strict=True)]
    step = 1e-3 / max(1.0, np.abs(change[1]).max(), np.abs(change[0]).max())
    plus, minus, far, farther = (
        residuals(start, change, share) for share in (step, -step, 2 * step, -2 * step)
    )
    for r, a, b, c, d in zip(here, plus, minus, far, farther, strict=True):
        slope = (8 * (a - b) - (c - d)) / (12 * step)
        np.testing.assert_allclose(slope, -r, rtol=0, atol=1e-7 * np.abs(r).max())


def newton_residuals(model):
    """The relative residual after 1, 2, ... iterations of the first step."""
    found = []
    for iterations in range(1, 12):
        try:
            simulate(model.with_settings(max_iterations=iterations))
        except ConvergenceError as error:
            found.append(error.residual)
        else:
            return np.array(found)
    raise AssertionError("no convergence in eleven iterations")


@pytest.mark.parametrize("rule", ["consistent", "paper"])
def test_newtons_method_converges_quadratically_with_flexible_bodies(make_body, rule):
    """In a step of a tenth of a second at 5 rad/s, at the end of which an elastic rotation is 0.04
    rad or more.
    """
    settings = {"step": 0.1, "t_end": 0.1, "rule": rule, "omega": (10.0, 100.0)}
    residuals = newton_residuals(chain(make_body, tolerance=1e-14, **settings))
    end = simulate(chain(make_body, **settings)).frame("a.i0").u[-1]
    assert np.linalg.norm(end[3:]) > 0.04
    digits = -np.log10(residuals)
    assert (digits[2:] > 1.8 * digits[1:-1]).all(), residuals


def test_the_convective_term_of_every_kind_of_row(make_body):
    """The second time derivative of rows where no body accelerates, against differences in time.

    Of constraints, of driven lengths and angles, and of the distances and angles of springs.
    """
    bodies = {
        "a": make_body("flexible", 5),
        "b": make_body("rigid", 6),
        "c": make_body("flexible", 7),
        "d": make_body("rigid", 8),
        **{name: make_body("rigid", seed) for seed, name in enumerate("efgh", 9)},
    }
    joints = (
        Universal("ground", "a.i0", AXIS, SECOND, name="wrist"),
        Fixed("a.i0", "b.i0", name="fixed"),
        Cylindrical("b.i0", "c.i0", AXIS, name="motor", angle=SWAY, distance=SWAY),
        Spherical("c.i0", "d.i0", name="ball", rotation_vector=[SWAY, SWAY_2, SWAY]),
        Screw("c.i0", "e.i0", AXIS, name="bolt", lead=0.7),
        ConstantVelocity("e.i0", "f.i0", AXIS, BENT, name="shaft"),
        Universal("ground", "g.i0", AXIS, SECOND, name="arm", angle=SWAY, second_angle=SWAY),
        Planar("ground", "h.i0", AXIS, name="table"),
        Rod("ground.post", "h.i1", name="strut", distance=Polynomial((1.5, 0.2, 0.1))),
    )
    couplers = (
        Coupler(
            "mix",
            "linear",
            ["bolt.angle", "table.angle", "table.distance", "wrist.second_angle"],
            ratios=[2.0, -3.0, 0.5, 1.5],
        ),
    )
    springs = (
        Spring("tie", "point", ("a.i1", "c.i1"), **SPRINGS["point"]),
        Spring("turn", "torsion", ("b.i0", "c.i0"), **SPRINGS["torsion"]),
    )
    settings = Settings(
        t_end=1.0, step=1e-2, rho_inf=0.8, redundant="remove", assemble=True, start="given"
    )
    ground = {"post": Frame([0.2, -0.1, 0.3])}
    model = Model(
        bodies, joints, (), springs, couplers=couplers, settings=settings, ground_frames=ground
    )
    rng = np.random.default_rng(3)
    point = Point.of(model, seed=4)
    state, work = point.state, point.work
    state.bodies.v_dot[:] = 0.0
    work.drives.rate[:] = rng.uniform(-2.0, 2.0, len(work.drives.rate))
    work.drives.acceleration[:] = rng.uniform(-2.0, 2.0, len(work.drives.rate))
    point.evaluated()
    state.interfaces.acceleration[:] = 0.0
    convective_terms(point.system, state, work)
    convective = work.couplings.convective.copy()

    x, R, u = state.bodies.x.copy(), state.bodies.R.copy(), state.interfaces.u.copy()
    v, rate, drive = state.bodies.v.copy(), state.interfaces.rate.copy(), work.drives.value.copy()
    s_1, s_2 = work.drives.rate.copy(), work.drives.acceleration.copy()

    def rows(t):
        state.bodies.x[:] = x + t * v[:, :3]
        state.bodies.R[:] = R @ Rotation.from_rotvec(t * v[:, 3:]).as_matrix()
        state.interfaces.u[:] = u + t * rate
        work.drives.value[:] = drive + t * s_1 + 0.5 * t**2 * s_2
        point.evaluated()
        return point.coordinates()

    h = 1e-3
    near, far = rows(h) + rows(-h), rows(2 * h) + rows(-2 * h)
    second = (16 * near - far - 30 * rows(0.0)) / (12 * h**2)
    np.testing.assert_allclose(convective, second, rtol=0, atol=1e-6 * np.abs(second).max())
