"""A thin beam that a crank bends in its stiff direction until it buckles sideways, by its bodies.

    python examples/benchmarks/lateral_buckling.py [FOLDER]

The crank lifts the tip by 0.05 m within 0.2 s, with three times the force at which the beam
buckles at rest, and an eccentricity of 0.1 mm. Buckling multiplies all errors: that of the
stiffness of a chain of linear bodies delays it (O. A. Bauchau and others, Validation of flexible
multibody dynamics beam formulations using benchmark problems, Multibody System Dynamics 37 (2016)
29-48). Writes the picture to FOLDER, by default out/.
"""

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import preprocess, solver, view
from numpy.typing import NDArray

Array = NDArray[np.float64]

L, LINK, CRANK, OFFSET = 1.0, 0.25, 0.05, 1e-4
TURN, DURATION, T_END = -np.pi, 0.4, 0.5
"""of the crank [rad, s], by half a cosine"""
BEAM_SECTION = (73e6, 5.025e6, 23.40e6, 877.2, 60830.0, 608.3, 2.68, 2233e-6, 22.33e-6)
LINK_SECTION = (33.02e6, 10.81e6, 10.81e6, 914.5, 1189.0, 1189.0, 1.212, 43.65e-6, 43.65e-6)
CRANK_SECTION = (132.1e6, 43.22e6, 43.22e6, 14630.0, 19020.0, 19020.0, 4.85, 698.3e-6, 698.3e-6)
"""EA, GA_y, GA_z, GJ, EI_y, EI_z, mass per length, rho I_y, rho I_z: 10 x 100 mm, rods of 24, 48"""
AT = 0.15
"""when it has buckled [s]"""
SIDEWAYS, UPWARDS = -34.57e-3, 8.392e-3
"""of the middle at AT [m], of exact beams in Exudyn, extrapolated from 32 and 64 elements"""
NUMBERS = (4, 8, 16, 32)
"""of bodies"""
STEP = 1e-4


@dataclass(frozen=True, eq=False)
class Found:
    """sideways, upwards (n,) [m]: of the middle over time; error: of the first at AT, relative;
    seconds.
    """

    time: Array
    sideways: Array
    upwards: Array
    error: float
    seconds: float


def main(folder: Path) -> dict[int, Found]:
    folder.mkdir(parents=True, exist_ok=True)
    found = {n: solve(n) for n in NUMBERS}
    draw(found, folder / "lateral-buckling.png")
    return found


def solve(n: int, step: float = STEP, t_end: float = T_END) -> Found:
    """With an even number of bodies."""
    m = mechanism(n)
    with warnings.catch_warnings():
        # The beam carries more than its load of buckling; that is the problem.
        warnings.simplefilter("ignore", solver.ValidityWarning)
        run = m.simulate(t_end, step=step, rho_inf=0.9)
    middle = run[f"piece{n // 2}.start"].position
    at = middle[round(AT / step)]
    return Found(
        run.time,
        middle[:, 1],
        middle[:, 2],
        float(abs(at[1] / SIDEWAYS - 1.0)),
        run.results.solver["seconds"],
    )


def mechanism(n: int) -> du.Mechanism:
    m = du.Mechanism()
    tip = add_beam(m, n)
    # A lug carries the ball of the link beside the axis of the beam.
    lug = m.add(
        du.RigidBody(1e-3, [1e-6] * 3, {"ball": [0.0, OFFSET, 0.0]}), "lug", place={"": tip}
    )
    m.add(du.joints.Fixed(tip, lug))
    top, bottom = np.array([L, OFFSET, 0.0]), np.array([L, OFFSET, -LINK])
    pivot = bottom - [CRANK, 0.0, 0.0]
    link = m.add(rod(top, bottom, LINK_SECTION, 8), "link", position=(top + bottom) / 2)
    crank = m.add(rod(pivot, bottom, CRANK_SECTION, 4), "crank", position=(pivot + bottom) / 2)
    m.add(du.joints.Spherical(lug["ball"], link["start"]))
    m.add(du.joints.Revolute(link["end"], crank["end"], "y"))
    turn = du.signals.Haversine((0.0, TURN), over=(0.0, DURATION))
    m.add(du.joints.Revolute(m.ground, crank["start"], "y", name="drive", angle=turn))
    return m


def add_beam(m: du.Mechanism, n: int) -> du.mechanism.FrameHandle:
    """Clamped, along x; its tip."""
    length = np.array([L / n, 0.0, 0.0])
    piece = rod(np.zeros(3), length, BEAM_SECTION, max(2, 16 // n))
    end: object = m.ground
    for k in range(n):
        body = m.add(piece, f"piece{k}", position=(k + 0.5) * length)
        m.add(du.joints.Fixed(end, body["start"]))
        end = body["end"]
    return body["end"]


def rod(start: Array, end: Array, section: tuple[float, ...], elements: int) -> du.Superelement:
    EA, GA_y, GA_z, GJ, EI_y, EI_z, mass, inertia_y, inertia_z = section
    points = np.linspace(start, end, elements + 1)
    part = du.Beam(
        points,
        section=du.Section(
            EA=EA,
            GA_y=GA_y,
            GA_z=GA_z,
            GJ=GJ,
            EI_y=EI_y,
            EI_z=EI_z,
            mass_per_length=mass,
            polar_inertia_per_length=inertia_y + inertia_z,
            rotary_inertia_y=inertia_y,
            rotary_inertia_z=inertia_z,
            orientation=(0.0, 1.0, 0.0),
        ),
    )
    part.interface("start", points[0])
    part.interface("end", points[-1])
    with warnings.catch_warnings():
        # Pieces that are shorter than their section is high are meant here.
        warnings.simplefilter("ignore", preprocess.PlausibilityWarning)
        return part.superelement(step=5e-6)


def draw(found: dict[int, Found], target: Path) -> None:
    figure, (sideways, upwards) = view.panels(2)
    with view.style():
        for n, one in found.items():
            sideways.plot(one.time, 1e3 * one.sideways, label=f"{n} bodies")
            upwards.plot(one.time, 1e3 * one.upwards)
        sideways.plot(AT, 1e3 * SIDEWAYS, ".", color="0.3", label="Exudyn", zorder=3)
        upwards.plot(AT, 1e3 * UPWARDS, ".", color="0.3", zorder=3)
        sideways.set(ylabel="middle, sideways [mm]")
        upwards.set(xlabel="time [s]", ylabel="middle, upwards [mm]")
        sideways.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        view.entitle(figure, "A thin beam that buckles sideways")
    view.save(figure, target)


if __name__ == "__main__":
    for n, result in main(Path(sys.argv[1] if len(sys.argv) > 1 else "out")).items():
        print(f"{n:2d} bodies: error at {AT} s {result.error:.2g}, {result.seconds:.2f} s")
