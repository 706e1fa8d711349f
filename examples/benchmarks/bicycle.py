"""The bicycle of the IFToMM library and of Meijaard, Papadopoulos, Ruina and Schwab.

    python examples/benchmarks/bicycle.py [FOLDER]

Two wheels with sharp rims roll without slip. The rider is part of the rear frame, and nobody
steers. The paper (Proceedings of the Royal Society A 463 (2007) 1955-1982) has the linear equations
of lean and steer. Here their eigenvalues are found from what the time steps do to small motions:
states T apart follow x(t + T) = e^(A T) x(t). Writes the picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import NDArray
from scipy.linalg import logm
from scipy.optimize import brentq

Array = NDArray[np.float64]

G = 9.81
BASE, TRAIL, TILT = 1.02, 0.08, np.pi / 10
"""distance of the wheels, trail [m], angle of the steering axis to the vertical [rad]"""
REAR_RADIUS, FRONT_RADIUS = 0.3, 0.35
"""[m]"""
REAR = (2.0, [0.0603, 0.12, 0.0603])
FRONT = (3.0, [0.1405, 0.28, 0.1405])
"""mass [kg] and principal moments of inertia [kg m^2] of the wheels, about their axles y"""
FRAME = (85.0, [[9.2, 0.0, -2.4], [0.0, 11.0, 0.0], [-2.4, 0.0, 2.8]])
HANDLE = (4.0, [[0.05892, 0.0, 0.00756], [0.0, 0.06, 0.0], [0.00756, 0.0, 0.00708]])
"""of the rear frame with the rider and of the front frame; x forward, z up"""
FRAME_AT, HANDLE_AT = np.array([0.3, 0.0, 0.9]), np.array([0.9, 0.0, 0.7])
"""centers of mass from the point where the rear wheel touches [m]"""

MASS = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
DAMPING = np.array([[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
STIFFNESS = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
BY_SPEED = np.array([[0.0, 76.59734589573222], [0.0, 2.65431523794604]])
"""of the paper: M q'' + v C1 q' + (g K0 + v^2 K2) q = 0, q = (lean, steer)"""
WEAVE, CAPSIZE = 4.29238253634111, 6.02426201538837
"""speeds between which the bicycle is stable [m/s], of the paper"""

SMALL = 1e-5
"""rates at the start [rad/s]"""
APART = 0.05
"""T [s]"""
STEPS = (2e-3, 1e-3, 5e-4)
"""[s]"""
SPEEDS = (1.0, 3.0, 5.0)
"""at which errors are measured [m/s]"""


@dataclass(frozen=True, eq=False)
class Push:
    """angles (n, 2) [rad] of lean and steer over time (n,) [s]; energy: its change over the kinetic
    energy; seconds.
    """

    time: Array
    angles: Array
    energy: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Found:
    """errors (steps,): of all eigenvalues at SPEEDS, over the largest magnitude of each speed;
    weave, capsize [m/s]; speeds (n,), eigenvalues (n, 4) [1/s] with the smallest step; push.
    """

    errors: Array
    weave: float
    capsize: float
    speeds: Array
    eigenvalues: NDArray[np.complex128]
    push: Push


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS, np.arange(0.5, 10.01, 0.5))
    draw(found, folder / "bicycle.png")
    return found


def solve(steps: tuple[float, ...], speeds: Array) -> Found:
    return Found(
        np.array([error(step) for step in steps]),
        stability_limit(4.0, 4.6, steps[-1]),
        stability_limit(5.5, 6.5, steps[-1]),
        speeds,
        np.array([eigenvalues(speed, steps[-1]) for speed in speeds]),
        pushed(steps[-1]),
    )


def pushed(step: float) -> Push:
    """It leans at 0.5 rad/s at the start, at 4.6 m/s."""
    run = bicycle(4.6, lean_rate=0.5).simulate(5.0, step=step)
    energy = run.energy.kinetic + run.energy.potential
    share = float(np.ptp(energy) / run.energy.kinetic[0])
    return Push(run.time, states_of(run)[:, :2], share, run.results.solver["seconds"])


def bicycle(speed: float, lean_rate: float = 0.0, steer_rate: float = 0.0) -> du.Mechanism:
    """Upright at a speed [m/s], with rates [rad/s] as far as the wheels allow them."""
    m = du.Mechanism(gravity=[0.0, 0.0, -G])
    rear_at, front_at = np.array([0.0, 0.0, REAR_RADIUS]), np.array([BASE, 0.0, FRONT_RADIUS])
    head = np.array([BASE + TRAIL, 0.0, 0.0])
    lean = np.array([lean_rate, 0.0, 0.0])

    def add(name: str, body: du.RigidBody, at: Array, spin: float = 0.0) -> du.mechanism.BodyHandle:
        velocity = np.array([speed, 0.0, 0.0]) + np.cross(lean, at)
        omega = lean + np.array([0.0, spin, 0.0])
        return m.add(body, name, position=at, velocity=velocity, angular_velocity=omega)

    points = {"axle": rear_at - FRAME_AT, "head": head - FRAME_AT}
    frame = add("frame", du.RigidBody(*FRAME, points), FRAME_AT)
    points = {"axle": front_at - HANDLE_AT, "head": head - HANDLE_AT}
    handle = add("handle", du.RigidBody(*HANDLE, points), HANDLE_AT)
    rear = add("rear", du.RigidBody(*REAR), rear_at, speed / REAR_RADIUS)
    front = add("front", du.RigidBody(*FRONT), front_at, speed / FRONT_RADIUS)
    m.add(du.joints.Revolute(frame["axle"], rear, "y"))
    m.add(du.joints.Revolute(handle["axle"], front, "y"))
    # Downwards, so that a turn to the right is positive, as a lean to the right is about x.
    axis, start = [np.sin(TILT), 0.0, -np.cos(TILT)], {"angle_rate": steer_rate}
    m.add(du.joints.Revolute(frame["head"], handle["head"], axis, name="steer", start=start))
    road = m.ground.frame("road")
    m.add(du.joints.RollingDisc(road, rear, "z", "y", radius=REAR_RADIUS))
    m.add(du.joints.RollingDisc(road, front, "z", "y", radius=FRONT_RADIUS))
    return m


def states_of(run: du.Run) -> Array:
    """Sine of the lean, steer [rad] and their rates [rad/s] (n, 4)."""
    left, steer = left_of(run), run["steer"]
    # The bicycle leans to the right as far as its left side rises.
    rises = np.cross(run["frame"].angular_velocity, left)[:, 2]
    return np.stack([left[:, 2], steer.angle, rises, steer.angle_rate], axis=1)


def left_of(run: du.Run) -> Array:
    """The y axis of the frame, which points to the left at the start (n, 3)."""
    w, x, y, z = run["frame"].R.T
    return np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)


def error(step: float) -> float:
    """Of all eigenvalues at SPEEDS."""
    worst = 0.0
    for speed in SPEEDS:
        expected = published(speed)
        apart = np.abs(expected[:, None] - eigenvalues(speed, step))
        worst = max(worst, float(apart.min(axis=1).max() / np.abs(expected).max()))
    return worst


def eigenvalues(speed: float, step: float) -> NDArray[np.complex128]:
    """Of x' = A x, with e^(A T) that fits best all pairs of states T apart in two small motions."""
    before, after, k = [], [], round(APART / step)
    for rates in ((SMALL, 0.0), (0.0, SMALL)):
        # What the first steps excite beside the motion has to decay.
        x = states_of(bicycle(speed, *rates).simulate(8 * APART, step=step))[k:]
        before.append(x[:-k])
        after.append(x[k:])
    over = np.linalg.lstsq(np.concatenate(before), np.concatenate(after), rcond=None)[0]
    return np.linalg.eigvals(logm(over.T) / APART)


def published(speed: float) -> NDArray[np.complex128]:
    inverse = np.linalg.inv(MASS)
    K = G * STIFFNESS + speed**2 * BY_SPEED
    lower = np.hstack([-inverse @ K, -inverse @ (speed * DAMPING)])
    return np.linalg.eigvals(np.vstack([np.eye(2, 4, 2), lower]))


def stability_limit(low: float, high: float, step: float) -> float:
    """The speed at which the largest real part vanishes [m/s]."""
    return float(brentq(lambda v: eigenvalues(v, step).real.max(), low, high, xtol=1e-5))


def draw(found: Found, target: Path) -> None:
    figure, (poles, motion) = view.panels(2, share_time=False)
    with view.style():
        fine = np.linspace(0.3, 10.0, 300)
        lines = np.array([np.sort(published(speed).real) for speed in fine])
        poles.plot(fine, lines, "-", color="0.6")
        poles.plot(found.speeds, found.eigenvalues.real, ".", color="C0")
        poles.plot([], [], "-", color="0.6", label="paper")
        poles.plot([], [], ".", color="C0", label="from time steps")
        for speed in (found.weave, found.capsize):
            poles.axvline(speed, color="0.8", linewidth=0.8)
        poles.axhline(0.0, color="0.8", linewidth=0.8)
        poles.set(xlabel="speed [m/s]", ylabel="real part [1/s]", ylim=(-12.0, 7.0))
        motion.plot(found.push.time, found.push.angles, label=["lean", "steer"])
        motion.set(xlabel="time [s]", ylabel="angle at 4.6 m/s [rad]")
        for axes in (poles, motion):
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "The bicycle of Meijaard and others, without hands")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    for step, wrong in zip(STEPS, result.errors, strict=True):
        print(f"step {step:g} s: eigenvalues {wrong:.2g} of the largest")
    print(f"weave {result.weave:.5f} m/s, of the paper {WEAVE:.5f}")
    print(f"capsize {result.capsize:.5f} m/s, of the paper {CAPSIZE:.5f}")
    print(f"change of energy {result.push.energy:.2g}, {result.push.seconds:.2f} s")
