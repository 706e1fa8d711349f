"""A robot of two flexible arms that two servos move: how soon it comes to rest.

    python examples/robot_arm.py [FOLDER]

runs examples/robot_arm.toml with three dampings of the arms, and with softer servos. The path of
the load is compared with that of a chain of rigid segments with springs and dampers between them
and the same servos, integrated by scipy; how fast it comes to rest with the eigenvalues of that
chain about its last pose. Writes results and a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/beam/arm.toml"
L = 0.5
"""of an arm [m]"""
SEGMENTS = 8
"""of an arm of the reference, between which its bending lies"""
DAMPING = (1e-4, 5e-4, 2e-3)
"""of the arms, stress by rate of strain over stress by strain [s]"""
SOFT = 9.0
"""stiffness of the servos of the model over that of softer ones, of the same damping ratio"""
BAND = 1e-3
"""distance of the load from its goal at which the robot has settled [m]"""
RINGING, LEAST = 1.5, 1e-6
"""from when on, and down to which distance, its decay is measured [s, m]"""
COMPARED = 1.0
"""until when the path is compared [s]"""


@dataclass(frozen=True, eq=False)
class Chain:
    """A plane chain of rigid segments at the angles theta from the x axis.

        sum_j a_ij (cos(theta_i - theta_j) theta_j'' + sin(theta_i - theta_j) theta_j'^2) = Q_i

    a_ij: length_i length_j times the mass that both carry, and inertias on the diagonal. Arms are
    halves of a segment at both ends, and whole ones between; a spring between two of them has the
    stiffness EI / length, and is damped by `damping` times that. Source: E. Wittbrodt, I.
    Adamiec-Wojcik, S. Wojciech: Dynamics of Flexible Multibody Systems (2006), rigid finite
    elements.
    """

    model: solver.Model
    damping: float

    @cached_property
    def lengths(self) -> Array:
        one = np.full(SEGMENTS + 1, L / SEGMENTS)
        one[[0, -1]] *= 0.5
        return np.concatenate([one, one])

    @cached_property
    def inertia(self) -> Array:
        """a (n, n)"""
        section, n = preprocess.read_body(BODY).section, len(self.lengths)
        mass = section.mass_per_length * self.lengths
        a = np.diag(mass * self.lengths**2 / 12.0)
        for k, own in enumerate(mass):
            reach = np.where(np.arange(n) < k, self.lengths, 0.0)
            reach[k] = 0.5 * self.lengths[k]
            a += own * np.outer(reach, reach)
        for name, last in (("motor", n // 2 - 1), ("load", n - 1)):
            body = self.model.bodies[name]
            reach = np.where(np.arange(n) <= last, self.lengths, 0.0)
            a += body.mass * np.outer(reach, reach)
            a[last, last] += body.inertia[2, 2]
        return a

    @cached_property
    def coordinates(self) -> Array:
        """Angles of springs and joints by theta (n, n): rows 0 and n / 2 are the joints."""
        n = len(self.lengths)
        return np.eye(n) - np.eye(n, k=-1)

    @cached_property
    def gains(self) -> tuple[Array, Array]:
        """Stiffness and damping of each coordinate (n,)."""
        n = len(self.lengths)
        bending = preprocess.read_body(BODY).section.EI_z / (L / SEGMENTS)
        stiffness = np.full(n, bending)
        damping = self.damping * stiffness
        for motor, i in zip(self.model.motors, (0, n // 2), strict=True):
            stiffness[i], damping[i] = motor.stiffness, motor.damping
        return stiffness, damping

    def references(self, t: float) -> tuple[Array, Array]:
        """The coordinates without a force, and their rates (n,)."""
        n = len(self.lengths)
        value, rate = np.zeros((2, n))
        for motor, i in zip(self.model.motors, (0, n // 2), strict=True):
            value[i], rate[i] = motor.reference(t), motor.reference.derivatives(t)[0]
        return value, rate

    def slope(self, t: float, y: Array) -> Array:
        theta, rate = np.split(y, 2)
        apart = theta[:, None] - theta
        B, (k, d), (r, r_rate) = self.coordinates, self.gains, self.references(t)
        torque = k * (r - B @ theta) + d * (r_rate - B @ rate)
        right = B.T @ torque - self.inertia * np.sin(apart) @ rate**2
        return np.concatenate([rate, np.linalg.solve(self.inertia * np.cos(apart), right)])

    def path(self, time: Array) -> Array:
        """Positions of the load (n, 2) [m]."""
        start = np.zeros(2 * len(self.lengths))
        options = {"t_eval": time, "rtol": 1e-6, "atol": 1e-8}
        y = solve_ivp(self.slope, (0.0, time[-1]), start, method="Radau", **options).y
        theta = y[: len(self.lengths)].T
        return np.stack([np.cos(theta) @ self.lengths, np.sin(theta) @ self.lengths], axis=1)

    @property
    def goal(self) -> Array:
        """theta at rest (n,)."""
        r, _ = self.references(1e3)
        return np.cumsum(r)

    @property
    def decay(self) -> float:
        """-Re s of the slowest vibration about the goal [1/s]."""
        n, B, (k, d) = len(self.lengths), self.coordinates, self.gains
        M = self.inertia * np.cos(self.goal[:, None] - self.goal)
        forces = np.hstack([B.T @ (k[:, None] * B), B.T @ (d[:, None] * B)])
        A = np.vstack([np.eye(n, 2 * n, k=n), -np.linalg.solve(M, forces)])
        return float(-np.linalg.eigvals(A).real.max())


@dataclass(frozen=True, eq=False)
class Move:
    """What a robot does: time (n,), path (n, 2) of its load, distance (n,) from the goal [m],
    torques (n, 2) of the servos [N m].

    settled: when it stays within BAND [s]; decay: of the distance, and that of the chain [1/s].
    """

    time: Array
    path: Array
    distance: Array
    torques: Array
    settled: float
    decay: float
    expected: float


@dataclass(frozen=True, eq=False)
class Found:
    """Moves by damping of the arms, the one with softer servos, and the path of the chain (m, 2)
    with the last of DAMPING, until the end of the move and some time after.
    """

    moves: dict[float, Move]
    soft: Move
    chain: Array

    @property
    def apart(self) -> Array:
        """Of the load from that of the chain (m,) [m]."""
        path = self.moves[DAMPING[-1]].path[: len(self.chain)]
        return np.linalg.norm(path - self.chain, axis=1)


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/robot_arm.toml")
    models = {damping: damped(model, damping) for damping in DAMPING}
    target = {DAMPING[1]: folder / "robot-arm.h5"}
    moves = {d: move(models[d], d, target.get(d)) for d in DAMPING}
    soft = move(softer(models[DAMPING[0]]), DAMPING[0])
    last = moves[DAMPING[-1]]
    chain = Chain(models[DAMPING[-1]], DAMPING[-1]).path(last.time[last.time < COMPARED])
    found = Found(moves, soft, chain)
    with view.style():
        view.save(curves(found), folder / "robot-arm.png")
    assert found.apart.max() < 2e-4
    for each in (*moves.values(), soft):
        assert abs(each.decay / each.expected - 1.0) < 0.01
    assert soft.settled < 0.7 * moves[DAMPING[-1]].settled
    return found


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def damped(model: solver.Model, damping: float) -> solver.Model:
    """The robot with arms of another damping."""
    body = preprocess.read_body(BODY)
    rayleigh = body.damping.rayleigh.model_copy(update={"stiffness": damping})
    changed = body.damping.model_copy(update={"rayleigh": rayleigh})
    element = preprocess.build(body.model_copy(update={"damping": changed}))
    arms = {
        name: replace(model.bodies[name], superelement=element) for name in model.flexible_bodies
    }
    return replace(model, bodies={**model.bodies, **arms})


def softer(model: solver.Model) -> solver.Model:
    motors = (
        replace(m, stiffness=m.stiffness / SOFT, damping=m.damping / np.sqrt(SOFT))
        for m in model.motors
    )
    return replace(model, motors=tuple(motors))


def move(model: solver.Model, damping: float, target: Path | None = None) -> Move:
    results, chain = solver.simulate(model, output=target), Chain(model, damping)
    time, path = results.time, results.body("load").x[:, :2]
    goal = np.array([np.cos(chain.goal), np.sin(chain.goal)]) @ chain.lengths
    distance = np.linalg.norm(path - goal, axis=1)
    torques = [results.motor(name).torque for name in results.motors]
    return Move(
        time,
        path,
        distance,
        np.transpose(torques),
        float(time[np.flatnonzero(distance > BAND)[-1]]),
        decay_of(time, distance),
        chain.decay,
    )


def decay_of(time: Array, distance: Array) -> float:
    """The rate of decay of the peaks of a distance, when only the slowest vibration is left."""
    peaks = 1 + np.flatnonzero((distance[1:-1] > distance[:-2]) & (distance[1:-1] > distance[2:]))
    peaks = peaks[(time[peaks] > RINGING) & (distance[peaks] > LEAST)]
    slope, _ = np.polyfit(time[peaks], np.log(distance[peaks]), 1)
    return float(-slope)


def curves(found: Found) -> Figure:
    figure, (path, torque) = view.panels(2)
    for (damping, each), color in zip(found.moves.items(), view.COLORS, strict=False):
        label = f"damping of the arms {1e3 * damping:g} ms"
        path.semilogy(each.time, each.distance, color=color, label=label, linewidth=0.8)
    path.semilogy(found.soft.time, found.soft.distance, color="0.4", label="softer servos")
    path.axhline(BAND, color="0.7", linewidth=0.8)
    last = found.moves[DAMPING[-1]]
    for number, name in enumerate(("shoulder", "elbow")):
        torque.plot(last.time, last.torques[:, number], label=name, color=view.COLORS[number])
    path.set(title="distance of the load from its goal", ylabel="[m]", ylim=(1e-5, 3.0))
    torque.set(
        title=f"torque of the servos, arms of {1e3 * DAMPING[-1]:g} ms",
        xlabel="time [s]",
        ylabel="[N m]",
    )
    for axes in (path, torque):
        axes.legend(loc="upper right")
    view.entitle(figure, "A robot of two flexible arms that comes to rest")
    return figure


def report(found: Found) -> None:
    for damping, each in (*found.moves.items(), ("soft", found.soft)):
        name = "softer servos" if damping == "soft" else f"damping {damping:g} s"
        print(
            f"{name:16}settled after {each.settled:.3f} s; decays by {each.decay:.4f}/s, "
            f"the chain by {each.expected:.4f}/s"
        )
    print(f"path of the load: up to {1e3 * found.apart.max():.3f} mm from that of the chain")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"results and picture: {target}")
