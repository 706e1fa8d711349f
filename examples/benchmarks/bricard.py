"""A04 of the IFToMM library: Bricard's mechanism, which moves though it has no degree of freedom.

    python examples/benchmarks/bricard.py [FOLDER]

Five rods and six hinges make a loop in space. Counting constraints leaves no degree of freedom; one
of them is redundant and left out. The reference are numbers of an integration of the one coordinate
with a tolerance of 1e-11. Writes the picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import view
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

L, SIDE, MASS, G = 1.0, 0.1, 1.0, 9.81
POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]]) * L
"""of the hinges [m]"""
REFERENCE = {
    1.0: (0.51050146, -1.6491676, 0.14012311),
    2.0: (-0.96934034, -1.2212469, 0.75427801),
    5.0: (1.000000, -1.00006726, 0.99993274),
    10.0: (0.99999996, -1.00026901, 0.99973095),
}
"""positions of the fourth hinge [m] by time [s]"""
STEPS = (4e-3, 2e-3, 1e-3)
"""[s]"""


@dataclass(frozen=True, eq=False)
class Found:
    """positions (n, 3) [m] of the fourth hinge over time with the smallest step; errors (steps, k)
    [m] at the k times of REFERENCE that are reached; energies: its change with each step [J];
    removed: the constraint left out; seconds: of the last run.
    """

    time: Array
    positions: Array
    errors: Array
    energies: Array
    removed: str
    seconds: float


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(STEPS)
    draw(found, folder / "bricard.png")
    return found


def solve(steps: tuple[float, ...], t_end: float = 10.0) -> Found:
    m = mechanism()
    runs = [m.simulate(t_end, step=step, redundant="remove") for step in steps]
    last = runs[-1]
    return Found(
        last.time,
        last["rod3.end"].position,
        np.array([errors(run) for run in runs]),
        np.array([np.ptp(run.energy.kinetic + run.energy.potential) for run in runs]),
        last.results.solver["removed"],
        last.results.solver["seconds"],
    )


def mechanism() -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, -G, 0.0])
    across = MASS * (L**2 + SIDE**2) / 12.0
    rod = du.RigidBody(
        MASS,
        [MASS * SIDE**2 / 6.0, across, across],
        {"start": [-L / 2, 0, 0], "end": [L / 2, 0, 0]},
    )
    rods = []
    for k, (start, end) in enumerate(pairwise(POINTS)):
        turn = Rotation.align_vectors([end - start], [[L, 0, 0]])[0].as_rotvec()
        rods.append(m.add(rod, f"rod{k + 1}", position=(start + end) / 2, rotation=turn))
    axes = axes_of_hinges()
    m.add(du.joints.Revolute(m.ground, rods[0]["start"], axes[0]))
    for one, other, axis in zip(rods[:-1], rods[1:], axes[1:-1], strict=True):
        m.add(du.joints.Revolute(one["end"], other["start"], axis))
    m.add(du.joints.Revolute(m.ground, rods[-1]["end"], axes[-1]))
    return m


def axes_of_hinges() -> list[Array]:
    """Each is perpendicular to both rods; the ground is the sixth rod, from the last point."""
    rods = np.diff(np.vstack([POINTS[-1], POINTS, POINTS[0]]), axis=0)
    return [np.cross(one, other) for one, other in pairwise(rods)]


def errors(run: du.Run) -> list[float]:
    positions = run["rod3.end"].position
    return [
        float(np.linalg.norm(positions[int(np.argmin(np.abs(run.time - t)))] - reference))
        for t, reference in REFERENCE.items()
        if t <= run.time[-1] + 1e-9
    ]


def draw(found: Found, target: Path) -> None:
    figure, (motion, wrong) = view.panels(2, share_time=False)
    with view.style():
        motion.plot(found.time, found.positions, label=["x", "y", "z"])
        for t, reference in REFERENCE.items():
            motion.plot([t] * 3, reference, ".", color="0.3", label="reference" if t == 1 else "")
        motion.set(xlabel="time [s]", ylabel="fourth hinge [m]")
        for t, error in zip(REFERENCE, found.errors.T, strict=True):
            wrong.loglog(STEPS, error, "o-", label=f"after {t:g} s")
        wrong.set(xlabel="step [s]", ylabel="error [m]")
        motion.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        wrong.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A04 of the IFToMM library, Bricard's mechanism")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    print(f"left out: {result.removed}")
    for step, wrong, energy in zip(STEPS, result.errors, result.energies, strict=True):
        at = ", ".join(f"{t:g} s {error:.2g} m" for t, error in zip(REFERENCE, wrong, strict=True))
        print(f"step {step:g} s: {at}; change of energy {energy:.2g} J")
    print(f"{result.seconds:.2f} s")
