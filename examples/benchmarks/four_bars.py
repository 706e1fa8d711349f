"""A02 of the IFToMM library: N four-bar linkages in a row, which pass singular positions.

    python examples/benchmarks/four_bars.py [FOLDER]

All bars are 1 m long and have 1 kg. They start upright, the upper pins at 1 m/s. Whenever all bars
lie on a line the constraints lose rank, and the linkage could fold. The parallel linkage has one
degree of freedom, whose equation is integrated here to 1e-12. Writes the picture to FOLDER, by
default out/.
"""

import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

L, MASS, G = 1.0, 1.0, 9.81
SPEED = 1.0
"""of the upper pins at the start [m/s]"""
T_END = 10.0
BAR = [0.0, MASS * L**2 / 12.0, MASS * L**2 / 12.0]
"""principal moments of inertia of a thin bar along x [kg m^2]"""
THIN = 1e-6
"""moment of inertia about the bar [kg m^2], which planar motion does not feel"""


@dataclass(frozen=True, eq=False)
class Found:
    """positions and expected (n, 2) [m]: of the first upper pin; error: their largest distance;
    energy: largest change [J]; seconds.
    """

    time: Array
    positions: Array
    expected: Array
    error: float
    energy: float
    seconds: float


def main(folder: Path) -> dict[int, Found]:
    folder.mkdir(parents=True, exist_ok=True)
    found = {n: solve(n, 1e-3) for n in (2, 40)}
    draw(found, folder / "four-bars.png")
    return found


def solve(n: int, step: float, t_end: float = T_END) -> Found:
    m = linkage(n)
    run = m.simulate(t_end, step=step)
    positions = run["upright0.top"].position[:, :2]
    expected = reference(n, run.time)
    energy = run.energy.kinetic + run.energy.potential
    return Found(
        run.time,
        positions,
        expected,
        float(np.linalg.norm(positions - expected, axis=1).max()),
        float(np.ptp(energy)),
        run.results.solver["seconds"],
    )


def linkage(n: int) -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, -G, 0.0])
    moments = [THIN, *BAR[1:]]
    spin = -SPEED / L
    uprights = []
    for i in range(n + 1):
        bar = du.RigidBody(MASS, moments, {"foot": [-L / 2, 0, 0], "top": [L / 2, 0, 0]})
        upright = m.add(
            bar,
            name=f"upright{i}",
            position=[i * L, L / 2, 0],
            rotation=[0, 0, np.pi / 2],
            velocity=[SPEED / 2, 0, 0],
            angular_velocity=[0, 0, spin],
        )
        m.add(du.joints.Revolute(m.ground, upright["foot"], "z"))
        uprights.append(upright)
    for i, (left, right) in enumerate(pairwise(uprights)):
        bar = du.RigidBody(MASS, moments, {"left": [-L / 2, 0, 0], "right": [L / 2, 0, 0]})
        coupler = m.add(
            bar, name=f"coupler{i}", position=[(i + 0.5) * L, L, 0], velocity=[SPEED, 0, 0]
        )
        m.add(du.joints.Revolute(left["top"], coupler["left"], "z"))
        # The other hinges keep all bars in the plane. One more would be redundant out of it.
        m.add(du.joints.PointOnLine(coupler["right"], right["top"], "z"))
    return m


def reference(n: int, time: Array) -> Array:
    """Positions (n, 2) [m] of the upper pin: ((N + 1) / 3 + N) m L^2 angle'' = moment of weight."""
    inertia = ((n + 1) / 3.0 + n) * MASS * L**2
    moment = ((n + 1) / 2.0 + n) * MASS * G * L

    def rate(_: float, state: Array) -> Array:
        return np.array([state[1], -moment / inertia * np.cos(state[0])])

    start = [np.pi / 2, -SPEED / L]
    solution = solve_ivp(
        rate, (0.0, time[-1]), start, "DOP853", t_eval=time, rtol=1e-12, atol=1e-12
    )
    angle = solution.y[0]
    return L * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def draw(found: dict[int, Found], target: Path) -> None:
    figure, (motion, errors) = view.panels(2)
    with view.style():
        for n, one in found.items():
            motion.plot(one.time, one.positions[:, 0], label=f"{n} linkages")
            errors.semilogy(
                one.time[1:],
                np.linalg.norm(one.positions - one.expected, axis=1)[1:],
                label=f"{n} linkages",
            )
        motion.set(ylabel="x of the first pin [m]")
        errors.set(xlabel="time [s]", ylabel="error [m]")
        motion.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A02 of the IFToMM library, linkages in a row")
    view.save(figure, target)


if __name__ == "__main__":
    results = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    for n, result in results.items():
        print(
            f"{n} linkages: largest error {result.error:.2g} m, change of energy "
            f"{result.energy:.2g} J, {result.seconds:.2f} s"
        )
