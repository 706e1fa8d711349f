"""A four-bar linkage whose third hinge is skew by 5 degrees, so that its bars must bend and twist.

    python examples/benchmarks/misaligned_four_bar.py [FOLDER]

With rigid bars it could not move. The first bar is driven at 0.6 rad/s, here from rest within half
a second (O. A. Bauchau and others, Validation of flexible multibody dynamics beam formulations
using benchmark problems, Multibody System Dynamics 37 (2016) 29-48). The reference are
geometrically exact beams in Exudyn. Writes the picture to FOLDER, by default out/.
"""

import sys
import warnings
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import solver, view
from numpy.typing import NDArray

Array = NDArray[np.float64]

A, B, C, D = np.array([[0, 0, 0], [0, 0.12, 0], [0.24, 0.12, 0], [0.24, 0, 0]])
SKEW = np.radians(5.0)
SPEED, RUN_UP, T_END = -0.6, 0.5, 12.0
THICK = (52.99e6, 16.88e6, 733.5, 1131.0, 1.997, 42.6e-6)
THIN = (13.25e6, 4.22e6, 45.84, 70.66, 0.4992, 2.662e-6)
"""EA, GA, GJ, EI, mass per length, rho I: 16 x 16 and 8 x 8 mm of steel"""
TIMES = np.array([1.0, 2.0, 4.0, 6.0, 10.0, 12.0])
"""[s]"""
DEFLECTIONS = 1e-3 * np.array([-1.53046, -3.46140, -2.89934, 0.89693, 1.34001, -2.60070])
"""of C out of the plane at TIMES [m], in Exudyn, extrapolated from 8, 16, 8 and twice as many"""
TORQUES = np.array([-2.41110, -5.35858, 4.82668, -1.26416, 1.79883, -4.18360])
"""of the drive at TIMES [N m], the same"""


@dataclass(frozen=True, eq=False)
class Found:
    """deflections (n,) [m] of C out of the plane and torques (n,) [N m] of the drive over time;
    errors over the largest of DEFLECTIONS and TORQUES; seconds.
    """

    time: Array
    deflections: Array
    torques: Array
    deflection_error: float
    torque_error: float
    seconds: float


def main(folder: Path) -> dict[str, Found]:
    folder.mkdir(parents=True, exist_ok=True)
    found = {
        "one body each": solve(1, 1e-3),
        "one of second order": solve(1, 1e-3, rotation=True),
        "two bodies each": solve(2, 1e-3),
    }
    draw(found, folder / "misaligned-four-bar.png")
    return found


def solve(n: int, step: float, t_end: float = T_END, rotation: bool = False) -> Found:
    """n bodies in each bar."""
    m, end = mechanism(n, rotation)
    with warnings.catch_warnings():
        # The thin bar carries a tenth of its Euler load, which one linear body does not feel.
        warnings.simplefilter("ignore", solver.ValidityWarning)
        run = m.simulate(t_end, step=step, rho_inf=0.5)
    deflections, torques = run[end].position[:, 2], run["drive"].moment[:, 2]
    reached = t_end + 1e-9 > TIMES
    rows = np.round(TIMES[reached] / step).astype(int)
    return Found(
        run.time,
        deflections,
        torques,
        error(deflections[rows], DEFLECTIONS[reached]),
        error(torques[rows], TORQUES[reached]),
        run.results.solver["seconds"],
    )


def error(found: Array, expected: Array) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def mechanism(n: int, rotation: bool) -> tuple[du.Mechanism, str]:
    """With the name of the frame at C."""
    m = du.Mechanism()
    first, end_of_first = add_bar(m, "crank", A, B, THICK, n, rotation)
    second, end_of_second = add_bar(m, "coupler", B, C, THICK, n, rotation)
    third, end_of_third = add_bar(m, "rocker", C, D, THIN, n, rotation)
    speed = du.signals.SmoothStep((0.0, SPEED), over=(0.0, RUN_UP))
    m.add(du.joints.Revolute(m.ground, first, "z", name="drive", angular_velocity=speed))
    m.add(du.joints.Revolute(end_of_first, second, "z"))
    m.add(du.joints.Revolute(end_of_second, third, [np.sin(SKEW), 0.0, np.cos(SKEW)]))
    m.add(du.joints.Revolute(m.ground, end_of_third, "z"))
    return m, end_of_second.frame_name


def add_bar(
    m: du.Mechanism,
    name: str,
    start: Array,
    end: Array,
    section: tuple[float, ...],
    n: int,
    rotation: bool,
) -> tuple[du.mechanism.FrameHandle, du.mechanism.FrameHandle]:
    """Its first and its last frame."""
    along = (end - start) / n
    points = np.linspace(start, start + along, 9)
    EA, GA, GJ, EI, mass, inertia = section
    bending = {"EI_y": EI, "EI_z": EI, "GA_y": GA, "GA_z": GA}
    inertias = {"rotary_inertia_y": inertia, "rotary_inertia_z": inertia}
    part = du.Beam(
        points,
        section=du.Section(
            EA=EA,
            GJ=GJ,
            mass_per_length=mass,
            polar_inertia_per_length=2 * inertia,
            **bending,
            **inertias,
        ),
    )
    part.interface("start", points[0])
    part.interface("end", points[-1])
    if rotation:
        part.rotation()
    piece = part.superelement(step=1e-5)
    bodies = [m.add(piece, f"{name}{k}", position=start + (k + 0.5) * along) for k in range(n)]
    for one, other in pairwise(bodies):
        m.add(du.joints.Fixed(one["end"], other["start"]))
    return bodies[0]["start"], bodies[-1]["end"]


def draw(found: dict[str, Found], target: Path) -> None:
    figure, (deflection, torque) = view.panels(2)
    with view.style():
        for name, one in found.items():
            deflection.plot(one.time, 1e3 * one.deflections, label=name)
            torque.plot(one.time, one.torques, label=name)
        deflection.plot(TIMES, 1e3 * DEFLECTIONS, ".", color="0.3", label="Exudyn", zorder=3)
        torque.plot(TIMES, TORQUES, ".", color="0.3", zorder=3)
        deflection.set(ylabel="C out of the plane [mm]")
        torque.set(xlabel="time [s]", ylabel="torque of the drive [N m]")
        deflection.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A four-bar linkage with a skew hinge")
    view.save(figure, target)


if __name__ == "__main__":
    results = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    for name, result in results.items():
        print(
            f"{name}: out of the plane {result.deflection_error:.2g}, torque "
            f"{result.torque_error:.2g}, {result.seconds:.2f} s"
        )
