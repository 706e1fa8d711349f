"""A shaft with an eccentric disk that runs through its critical speed, by one body or two.

    python examples/benchmarks/rotating_shaft.py [FOLDER]

A tube of 6 m carries a disk of 70.6 kg, 50 mm off its axis. It is driven to 48 rad/s within half a
second, and from 1 to 1.25 s through its critical speed to 72 rad/s, under its weight. The disk
leaves the axis by up to 0.28 m (O. A. Bauchau and others, Validation of flexible multibody dynamics
beam formulations using benchmark problems, Multibody System Dynamics 37 (2016) 29-48). Writes the
picture to FOLDER, by default out/.
"""

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import solver, view
from numpy.typing import NDArray

Array = NDArray[np.float64]

L, G = 6.0, 9.81
SECTION = du.Section(
    EA=313.4e6,
    GA_y=60.5e6,
    GA_z=60.5e6,
    GJ=272.7e3,
    EI_y=354.5e3,
    EI_z=354.5e3,
    mass_per_length=11.64,
    polar_inertia_per_length=2 * 13.17e-3,
    rotary_inertia_y=13.17e-3,
    rotary_inertia_z=13.17e-3,
)
DISK, DISK_INERTIA, ECCENTRICITY = 70.573, (2.0325, 1.0163, 1.0163), 0.05
SPEED = du.signals.Sum(
    [
        du.signals.Haversine((0.0, 48.0), over=(0.0, 0.5)),
        du.signals.Haversine((0.0, 24.0), over=(1.0, 1.25)),
    ]
)
"""of the left end [rad/s]"""
T_END, STEP = 2.5, 2e-4
TIMES = np.array([0.75, 1.0, 1.25, 1.5, 1.75, 2.0])
"""[s]"""
REFERENCE = 1e-3 * np.array(
    [
        [122.41, 66.23],
        [55.18, 26.98],
        [220.43, -12.41],
        [-91.50, 45.34],
        [-219.75, -153.29],
        [13.46, -106.11],
    ]
)
"""places of the middle at TIMES [m], of exact beams in Exudyn, extrapolated from 32 and 64 elements
and from steps of 1 and 0.5 ms
"""


@dataclass(frozen=True, eq=False)
class Found:
    """middle (n, 2) [m]: y and z over time; error: largest distance from REFERENCE over the largest
    deflection there; seconds.
    """

    time: Array
    middle: Array
    error: float
    seconds: float


def main(folder: Path) -> dict[str, Found]:
    folder.mkdir(parents=True, exist_ok=True)
    found = {
        "two of second order": solve(2, rotation=True),
        "two of first order": solve(2, rotation=False),
        "one of second order": solve(1, rotation=True),
        "one of first order": solve(1, rotation=False),
    }
    draw(found, folder / "rotating-shaft.png")
    return found


def solve(n: int, rotation: bool, step: float = STEP, t_end: float = T_END) -> Found:
    """One body with an interface in its middle, or two halves."""
    m = mechanism(n, rotation)
    with warnings.catch_warnings():
        # Without terms of second order the shaft spins too fast, as the run says.
        warnings.simplefilter("ignore", solver.ValidityWarning)
        run = m.simulate(t_end, step=step, rho_inf=0.5)
    middle = run["disk.hub"].position[:, 1:]
    reached = t_end + 1e-9 > TIMES
    apart = middle[np.round(TIMES[reached] / step).astype(int)] - REFERENCE[reached]
    largest = np.linalg.norm(REFERENCE[reached], axis=1).max()
    return Found(
        run.time,
        middle,
        float(np.linalg.norm(apart, axis=1).max() / largest),
        run.results.solver["seconds"],
    )


def mechanism(n: int, rotation: bool) -> du.Mechanism:
    m = du.Mechanism(gravity=[0.0, 0.0, -G])
    hub = {"hub": [0.0, 0.0, -ECCENTRICITY]}
    disk = m.add(du.RigidBody(DISK, DISK_INERTIA, hub), "disk", position=[L / 2, 0.0, ECCENTRICITY])
    piece = shaft(n, rotation)
    left = m.add(piece, "left", position=[L / 2 / n, 0.0, 0.0])
    end = left["end"]
    if n == 2:
        right = m.add(piece, "right", position=[3 * L / 4, 0.0, 0.0])
        m.add(du.joints.Fixed(left["end"], right["start"]))
        end = right["end"]
    m.add(du.joints.Fixed(left["middle" if n == 1 else "end"], disk["hub"]))
    m.add(du.joints.Revolute(m.ground, left["start"], "x", name="drive", angular_velocity=SPEED))
    m.add(du.joints.Cylindrical(m.ground, end, "x"))
    return m


def shaft(n: int, rotation: bool) -> du.Superelement:
    points = np.linspace([0.0, 0.0, 0.0], [L / n, 0.0, 0.0], 32 // n + 1)
    part = du.Beam(points, section=SECTION)
    part.interface("start", points[0])
    if n == 1:
        part.interface("middle", points[16])
    part.interface("end", points[-1])
    if rotation:
        part.rotation()
    return part.superelement(step=5e-5)


def draw(found: dict[str, Found], target: Path) -> None:
    figure, panels = view.panels(2)
    with view.style():
        for k, (axes, name) in enumerate(zip(panels, "yz", strict=True)):
            for words, one in found.items():
                if words != "one of first order":
                    axes.plot(one.time, 1e3 * one.middle[:, k], label=words)
            axes.plot(TIMES, 1e3 * REFERENCE[:, k], ".", color="0.3", label="Exudyn", zorder=3)
            axes.set(ylabel=f"{name} of the middle [mm]")
        panels[0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        panels[1].set(xlabel="time [s]")
        view.entitle(figure, "A shaft through its critical speed")
    view.save(figure, target)


if __name__ == "__main__":
    for name, result in main(Path(sys.argv[1] if len(sys.argv) > 1 else "out")).items():
        print(f"{name}: error {result.error:.2g}, {result.seconds:.2f} s")
