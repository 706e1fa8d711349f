"""Rigid mechanisms by the equations of Newton and Euler, integrated apart from the solver.

    x' = v    q' = 1/2 (0, w) q    [ M  -B^T ] [ v', w' ]   [ f, m - w x J w ]
                                   [ B    0  ] [ lambda ] = [ -c             ]

x, v: of the centers of mass; q, w: quaternions and angular velocities, all in space. Constraints
are differentiated twice (index 1): B is their Jacobian, c what is left of their accelerations where
no body accelerates. Where rows depend on one another the least lambda is taken; wrenches of joints
are unique unless the joints themselves depend on one another. Angles are integrated beside the
positions. DOP853 of scipy integrates to 1e-11, so that constraints that are only differentiated
stay closed.

It reads the entries of a `Model` (rigid bodies, joints, springs, loads, gravity), and shares no
equation with the solver.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

RTOL, ATOL = 1e-11, 1e-12
LONGEST = 0.004
"""[s], a step from which a trial does not leave all range"""
DEPENDENT = 1e-7
"""singular values, over the largest, of rows that depend on one another, as far as they drift"""


def cross(a, b):
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


@dataclass
class Vector:
    """A vector that a body carries, its rate, and its acceleration without that of the body."""

    now: np.ndarray
    rate: np.ndarray
    convective: np.ndarray

    @classmethod
    def carried(cls, R, w, local):
        now = R @ local
        rate = cross(w, now)
        return cls(now, rate, cross(w, rate))


@dataclass
class Row:
    """A coordinate of two bodies: value, rate, convective term, gradient (12,) by v, w of both."""

    value: float
    rate: float
    convective: float
    gradient: np.ndarray


class Pair:
    """Two frames at an instant, and coordinates between them."""

    def __init__(self, reference, numbers, levers, state):
        (a, b), (X_a, X_b) = numbers, levers
        self.a, self.b = reference.body(a, state), reference.body(b, state)
        self.s_a, self.s_b = self.carried_by_a(X_a), self.carried_by_b(X_b)
        self.w = self.b.w - self.a.w
        self.d = Vector(
            self.b.x + self.s_b.now - self.a.x - self.s_a.now,
            self.b.v + self.s_b.rate - self.a.v - self.s_a.rate,
            self.s_b.convective - self.s_a.convective,
        )

    def carried_by_a(self, local):
        return Vector.carried(self.a.R, self.a.w, local)

    def carried_by_b(self, local):
        return Vector.carried(self.b.R, self.b.w, local)

    def dot(self, e, f):
        """e . f of an axis of each body."""
        turn = cross(e.now, f.now)
        return Row(
            e.now @ f.now,
            e.rate @ f.now + e.now @ f.rate,
            e.convective @ f.now + 2.0 * e.rate @ f.rate + e.now @ f.convective,
            np.concatenate([np.zeros(3), turn, np.zeros(3), -turn]),
        )

    def along(self, e):
        """e . d of an axis of the first body."""
        d, by_turn = self.d, cross(e.now, self.d.now)
        return Row(
            e.now @ d.now,
            e.rate @ d.now + e.now @ d.rate,
            e.convective @ d.now + 2.0 * e.rate @ d.rate + e.now @ d.convective,
            np.concatenate(
                [-e.now, by_turn - cross(self.s_a.now, e.now), e.now, cross(self.s_b.now, e.now)]
            ),
        )

    def components(self):
        """d in space: three rows."""
        rows = []
        for k, e in enumerate(np.eye(3)):
            by_turn = [-e, -cross(self.s_a.now, e), e, cross(self.s_b.now, e)]
            d = self.d
            rows.append(Row(d.now[k], d.rate[k], d.convective[k], np.concatenate(by_turn)))
        return rows

    def length(self):
        d = self.d
        L = np.sqrt(d.now @ d.now)
        n = d.now / L
        rate = n @ d.rate
        return Row(
            L,
            rate,
            (d.rate @ d.rate + d.now @ d.convective - rate**2) / L,
            np.concatenate([-n, -cross(self.s_a.now, n), n, cross(self.s_b.now, n)]),
        )

    def angle(self, e, value):
        """The angle about an axis of the first body, of which the value is integrated."""
        return Row(
            value,
            self.w @ e.now,
            self.w @ e.rate,
            np.concatenate([np.zeros(3), -e.now, np.zeros(3), e.now]),
        )


@dataclass
class Body:
    x: np.ndarray
    R: np.ndarray
    v: np.ndarray
    w: np.ndarray


GROUND = Body(np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))


class Reference:
    """The motion of a model of rigid bodies."""

    def __init__(self, model):
        self.model, self.names = model, list(model.bodies)
        bodies = list(model.bodies.values())
        self.n = len(bodies)
        self.mass = np.array([body.mass for body in bodies])
        self.inertia = np.array([np.asarray(body.inertia, dtype=float) for body in bodies])
        self.start = [
            (body.start.position, Rotation.from_rotvec(body.start.rotation)) for body in bodies
        ]
        self.joints = [self._geometry(joint) for joint in model.joints]
        self.springs = [self._geometry(spring) for spring in model.springs]
        # screws, driven angles and torsion springs: angles that are integrated
        self.angles = {}
        for entry in (*model.joints, *model.springs):
            turns = entry.type in ("screw", "torsion")
            if turns or getattr(entry, "angle", None) is not None:
                self.angles[entry.name] = len(self.angles)
        x = np.array([x for x, _ in self.start])
        q = np.array([R.as_quat(scalar_first=True) for _, R in self.start])
        v = np.array([body.start.velocity for body in bodies])
        w = np.array(
            [
                R.apply(body.start.angular_velocity)
                for (_, R), body in zip(self.start, bodies, strict=True)
            ]
        )
        angles = [
            entry.angle(0.0) if getattr(entry, "angle", None) is not None else 0.0
            for entry in (*model.joints, *model.springs)
            if entry.name in self.angles
        ]
        self.rest = [self._rest(spring, angles, x, q) for spring in model.springs]
        y = np.concatenate([x.ravel(), q.ravel(), v.ravel(), w.ravel(), angles])
        self.y0 = self._consistent(y)

    def _frame(self, reference, other):
        """The number of a body, -1 the ground, and the place of a frame in it."""
        name, _, frame = reference.partition(".")
        if name == "ground":
            if frame:
                return -1, np.asarray(self.model.ground_frames[frame].position)
            number, X = self._frame(other, reference)
            x, R = self.start[number]
            return -1, x + R.apply(X)
        X = np.asarray(self.model.bodies[name].frames[frame].position) if frame else np.zeros(3)
        return self.names.index(name), X

    def _geometry(self, entry):
        """Bodies, levers, and axes e1 e2 e3 carried by either body (3, 3) as columns."""
        first, second = entry.between
        a, X_a = self._frame(first, second)
        b, X_b = self._frame(second, first)
        given = getattr(entry, "axis", None)
        axis = np.eye(3)[2] if given is None else np.asarray(given)
        second_axis = getattr(entry, "second_axis", None)
        if second_axis is None:
            second_axis = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
            second_axis /= np.linalg.norm(second_axis)
        E = np.column_stack([axis, second_axis, np.cross(axis, second_axis)])
        R_a = np.eye(3) if a < 0 else self.start[a][1].as_matrix()
        R_b = np.eye(3) if b < 0 else self.start[b][1].as_matrix()
        return (a, b), (X_a, X_b), (R_a.T @ E, R_b.T @ E)

    def _bushing_axes(self, spring):
        """Axes e_1, e_2, e_3 of a bushing that has none of its own: those of its first frame."""
        name, _, frame = spring.between[0].partition(".")
        turn = Rotation.from_rotvec(self.model.frames_of(name)[frame].rotation)
        if name != "ground":
            turn = self.start[self.names.index(name)][1] * turn
        return turn.as_matrix()

    def body(self, number, state):
        if number < 0:
            return GROUND
        x, R, v, w = state[:4]
        return Body(x[number], R[number], v[number], w[number])

    def split(self, y):
        n = self.n
        x, q, v, w = (
            part.reshape(n, -1) for part in np.split(y[: 13 * n], np.cumsum([3 * n, 4 * n, 3 * n]))
        )
        R = Rotation.from_quat(q, scalar_first=True).as_matrix()
        return x, R, v, w, y[13 * n :], q

    def _joint_rows(self, k, state):
        joint, (numbers, levers, (E_a, E_b)) = self.model.joints[k], self.joints[k]
        pair = Pair(self, numbers, levers, state)
        a = [pair.carried_by_a(E_a[:, i]) for i in range(3)]
        b = [pair.carried_by_b(E_b[:, i]) for i in range(3)]
        parallel = [pair.dot(a[1], b[0]), pair.dot(a[2], b[0])]
        same = [*parallel, pair.dot(a[1], b[2])]
        on_axis = [pair.along(a[1]), pair.along(a[2])]
        rows = {
            "spherical": lambda: pair.components(),
            "fixed": lambda: pair.components() + same,
            "revolute": lambda: pair.components() + parallel,
            "universal": lambda: [*pair.components(), pair.dot(a[0], b[1])],
            "cylindrical": lambda: on_axis + parallel,
            "prismatic": lambda: on_axis + same,
            "planar": lambda: [pair.along(a[0]), *parallel],
            "point_on_line": lambda: on_axis,
            "point_on_plane": lambda: [pair.along(a[0])],
            "rod": lambda: [pair.length()],
            "constant_velocity": lambda: [*pair.components(), self._homokinetic(pair, a, b)],
            "screw": lambda: on_axis + parallel + [self._screw(joint, pair, a, state)],
        }[joint.type]()
        goals = np.zeros((len(rows), 2))
        if "angle" in joint.drives:
            rows.append(pair.angle(a[0], state[4][self.angles[joint.name]]))
            goals = np.vstack([goals, self.drive])
        return rows, goals, pair

    def _homokinetic(self, pair, a, b):
        one, two = pair.dot(a[1], b[2]), pair.dot(a[2], b[1])
        return Row(
            one.value - two.value,
            one.rate - two.rate,
            one.convective - two.convective,
            one.gradient - two.gradient,
        )

    def _screw(self, joint, pair, a, state):
        along = pair.along(a[0])
        angle = pair.angle(a[0], state[4][self.angles[joint.name]])
        lead = joint.lead / (2.0 * np.pi)
        return Row(
            0.0,
            along.rate - lead * angle.rate,
            along.convective - lead * angle.convective,
            along.gradient - lead * angle.gradient,
        )

    def _spring_rows(self, k, state):
        spring, (numbers, levers, (E_a, _)) = self.model.springs[k], self.springs[k]
        pair = Pair(self, numbers, levers, state)
        if spring.type == "point":
            return [pair.length()]
        if spring.type == "torsion":
            return [pair.angle(pair.carried_by_a(E_a[:, 0]), state[4][self.angles[spring.name]])]
        D = self._bushing_axes(spring)
        R_a = np.eye(3) if numbers[0] < 0 else self.start[numbers[0]][1].as_matrix()
        R_b = np.eye(3) if numbers[1] < 0 else self.start[numbers[1]][1].as_matrix()
        a = [pair.carried_by_a(R_a.T @ D[:, i]) for i in range(3)]
        b = [pair.carried_by_b(R_b.T @ D[:, i]) for i in range(3)]
        turns = [pair.dot(a[i], b[j]) for i, j in ((2, 1), (0, 2), (1, 0))]
        return [*(pair.along(e) for e in a), *turns]

    def _rest(self, spring, angles, x, q):
        if spring.rest is not None:
            return np.asarray(spring.rest)
        R = Rotation.from_quat(q, scalar_first=True).as_matrix()
        none = np.zeros_like(x)
        k = list(self.model.springs).index(spring)
        return np.array([row.value for row in self._spring_rows(k, (x, R, none, none, angles))])

    def _scatter(self, rows, numbers):
        B = np.zeros((len(rows), 6 * self.n))
        for i, row in enumerate(rows):
            for half, number in enumerate(numbers):
                if number >= 0:
                    B[i, 6 * number : 6 * number + 6] += row.gradient[6 * half : 6 * half + 6]
        return B

    def _at(self, t, y):
        """The state, and of all joints B, c, the rates at which they open, and their rows."""
        state = self.split(y)
        B, c, rates, blocks = [], [], [], []
        for k, joint in enumerate(self.model.joints):
            if "angle" in joint.drives:
                self.drive = np.array(joint.angle.derivatives(t))
            rows, goals, pair = self._joint_rows(k, state)
            B.append(self._scatter(rows, self.joints[k][0]))
            c += [row.convective - goal[1] for row, goal in zip(rows, goals, strict=True)]
            rates += [row.rate - goal[0] for row, goal in zip(rows, goals, strict=True)]
            blocks.append((rows, pair))
        B = np.vstack([np.zeros((0, 6 * self.n)), *B])
        return state, B, np.array(c), np.array(rates), blocks

    def _inverse_root(self, R):
        """W with W W^T = M^-1 in space (6 n, 6 n)."""
        W = np.zeros((6 * self.n, 6 * self.n))
        for b in range(self.n):
            W[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = np.eye(3) / np.sqrt(self.mass[b])
            root = np.linalg.cholesky(np.linalg.inv(self.inertia[b]))
            W[6 * b + 3 : 6 * b + 6, 6 * b + 3 : 6 * b + 6] = R[b] @ root
        return W

    def _consistent(self, y):
        """The velocities changed least, in the metric of mass, to what the joints allow."""
        state, B, _, rates, _ = self._at(0.0, y)
        if len(B):
            W = self._inverse_root(state[1])
            A = B @ W
            length = np.linalg.norm(A, axis=1)
            change = W @ (np.linalg.pinv(A / length[:, None], rcond=DEPENDENT) @ (rates / length))
            n = self.n
            y[7 * n : 10 * n] -= change.reshape(n, 6)[:, :3].ravel()
            y[10 * n : 13 * n] -= change.reshape(n, 6)[:, 3:].ravel()
        return y

    def _forces(self, t, state):
        R, w = state[1], state[3]
        f = np.zeros((self.n, 6))
        f[:, :3] = self.mass[:, None] * self.model.gravity
        for b in range(self.n):
            J = R[b] @ self.inertia[b] @ R[b].T
            f[b, 3:] -= cross(w[b], J @ w[b])
        for load in self.model.loads:
            b, X = self._frame(load.on, "")
            frame = self.model.bodies[self.names[b]].frames[load.on.partition(".")[2]]
            vector = load.signal(t) * np.asarray(load.direction)
            if load.follower:
                vector = R[b] @ Rotation.from_rotvec(frame.rotation).apply(vector)
            if load.type == "force":
                f[b, :3] += vector
                f[b, 3:] += cross(R[b] @ X, vector)
            else:
                f[b, 3:] += vector
        f = f.ravel()
        for k, spring in enumerate(self.model.springs):
            rows = self._spring_rows(k, state)
            c, rate = np.array([[row.value, row.rate] for row in rows]).T
            law = -spring.stiffness @ (c - self.rest[k]) - spring.damping @ rate
            f = f + self._scatter(rows, self.springs[k][0]).T @ law
        return f

    def dynamics(self, t, y):
        """Accelerations, and wrenches of the joints on their second frames (n_joints, 6)."""
        state, B, c, _, blocks = self._at(t, y)
        W = self._inverse_root(state[1])
        free = W.T @ self._forces(t, state)
        wrenches = np.zeros((len(blocks), 6))
        if len(B):
            A = B @ W
            length = np.linalg.norm(A, axis=1)
            length[length == 0.0] = 1.0
            A, c = A / length[:, None], c / length
            inverse = np.linalg.pinv(A, rcond=DEPENDENT)
            z = free - inverse @ (c + A @ free)
            lam = (inverse.T @ (z - free)) / length
            first = 0
            for k, (rows, pair) in enumerate(blocks):
                G = np.array([row.gradient[6:] for row in rows])
                on_b = lam[first : first + len(rows)] @ G
                on_b[3:] -= cross(pair.s_b.now, on_b[:3])
                wrenches[k] = on_b
                first += len(rows)
        else:
            z = free
        return (W @ z).reshape(-1, 6), wrenches

    def _rhs(self, t, y):
        state, n = self.split(y), self.n
        v_dot, _ = self.dynamics(t, y)
        _, _, v, w, _, q = state
        q_dot = np.empty((n, 4))
        q_dot[:, 0] = -0.5 * np.einsum("ij,ij->i", w, q[:, 1:])
        q_dot[:, 1:] = 0.5 * (q[:, :1] * w + np.cross(w, q[:, 1:]))
        rates = np.zeros(len(self.angles))
        for entries, geometry in (
            (self.model.joints, self.joints),
            (self.model.springs, self.springs),
        ):
            for entry, (numbers, _, (E_a, _)) in zip(entries, geometry, strict=True):
                if entry.name in self.angles:
                    A, B = (self.body(number, state) for number in numbers)
                    rates[self.angles[entry.name]] = (B.w - A.w) @ A.R @ E_a[:, 0]
        return np.concatenate(
            [v.ravel(), q_dot.ravel(), v_dot[:, :3].ravel(), v_dot[:, 3:].ravel(), rates]
        )

    def run(self, times):
        """States (times, ...) and wrenches of joints (times, n_joints, 6)."""
        span, tolerances = (0.0, times[-1]), {"rtol": RTOL, "atol": ATOL}
        with np.errstate(over="ignore", invalid="ignore"):  # of trial steps, which are taken back
            solution = solve_ivp(
                self._rhs, span, self.y0, "DOP853", times, max_step=LONGEST, **tolerances
            )
        assert solution.success, solution.message
        states = [self.split(y) for y in solution.y.T]
        wrenches = [self.dynamics(t, y)[1] for t, y in zip(times, solution.y.T, strict=True)]
        return (
            np.array([state[0] for state in states]),
            np.array([state[1] for state in states]),
            np.array([state[2] for state in states]),
            np.array([state[3] for state in states]),
            np.array(wrenches),
        )

    def degrees_of_freedom(self):
        _, B, _, _, _ = self._at(0.0, self.y0)
        return 6 * self.n - (np.linalg.matrix_rank(B, tol=1e-8) if len(B) else 0)

    def determined(self):
        """The joints, by number, that are in no dependence of constraints at the start."""
        _, B, _, _, blocks = self._at(0.0, self.y0)
        owner = np.repeat(np.arange(len(blocks)), [len(rows) for rows, _ in blocks])
        if not len(B):
            return []
        left, values, _ = np.linalg.svd(B / np.linalg.norm(B, axis=1)[:, None])
        null = left[:, np.count_nonzero(values > 1e-8) :]
        involved = owner[np.abs(null).max(axis=1, initial=0.0) > 1e-8]
        return sorted(set(range(len(blocks))) - set(involved.tolist()))
