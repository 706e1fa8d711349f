"""A01 of the IFToMM library: a point mass on a weightless rod falls from the horizontal.

    python examples/benchmarks/pendulum.py [FOLDER]

The angle below the horizontal is known in closed form. Writes the picture to FOLDER, by default
out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk

Array = NDArray[np.float64]

L, MASS, G = 1.0, 1.0, 9.81
T_END = 10.0
STEPS = (4e-3, 2e-3, 1e-3, 5e-4)
"""[s]"""


@dataclass(frozen=True, eq=False)
class Found:
    """positions (n, 2) [m] at times (n,) with the smallest step; errors, energies: largest distance
    from the closed form [m] and change of energy [J] with each step; seconds: of the last run.
    """

    time: Array
    positions: Array
    errors: Array
    energies: Array
    seconds: float


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS)
    draw(found, folder / "pendulum.png")
    return found


def solve(steps: tuple[float, ...]) -> Found:
    runs = [simulate(step) for step in steps]
    positions = [run["bob"].x[:, :2] for run in runs]
    errors = [
        np.linalg.norm(x - exact(run.time), axis=1).max()
        for run, x in zip(runs, positions, strict=True)
    ]
    energies = [np.ptp(run.energy.kinetic + run.energy.potential) for run in runs]
    last = runs[-1]
    return Found(
        last.time,
        positions[-1],
        np.array(errors),
        np.array(energies),
        last.results.solver["seconds"],
    )


def simulate(step: float) -> du.Run:
    return mechanism().simulate(T_END, step=step)


def mechanism() -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, -G, 0.0])
    # The rod pulls at the center of mass, so that the inertia of the bob does not matter.
    bob = m.add(du.RigidBody(MASS, [1e-3] * 3), name="bob", position=[-L, 0.0, 0.0])
    m.add(du.joints.Rod(m.ground.frame("pivot"), bob))
    return m


def exact(time: Array) -> Array:
    """Positions (n, 2) [m]: sin(angle to the vertical / 2) = k sn(K + omega t), k^2 = 1/2."""
    k_squared = 0.5
    sn = ellipj(ellipk(k_squared) + np.sqrt(G / L) * time, k_squared)[0]
    angle = -2.0 * np.arcsin(np.sqrt(k_squared) * sn)
    return L * np.stack([np.sin(angle), -np.cos(angle)], axis=1)


def draw(found: Found, target: Path) -> None:
    figure, (motion, errors) = view.panels(2, share_time=False)
    with view.style():
        motion.plot(found.time, found.positions, label=["x", "y"])
        motion.set(xlabel="time [s]", ylabel="position [m]")
        motion.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        errors.loglog(STEPS, found.errors, "o-", label="largest error [m]")
        errors.loglog(STEPS, found.energies, "s-", label="change of energy [J]")
        errors.set(xlabel="step [s]", ylabel="error")
        errors.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A01 of the IFToMM library, a pendulum")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    for step, error, energy in zip(STEPS, result.errors, result.energies, strict=True):
        print(f"step {step:g} s: largest error {error:.2g} m, change of energy {energy:.2g} J")
    print(f"{result.seconds:.2f} s")
