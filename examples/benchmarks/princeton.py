"""The Princeton beam: a cantilever whose tip moves by 0.39 of its length, by the number of bodies.

    python examples/benchmarks/princeton.py [FOLDER]

A dead force at the tip points between the stiff and the soft direction of the section, so that the
beam bends both ways and twists (O. A. Bauchau and others, Validation of flexible multibody dynamics
beam formulations using benchmark problems, Multibody System Dynamics 37 (2016) 29-48). Elasticity
is linear within a body: one body must fail, and a beam of several converges. Writes the picture to
FOLDER, by default out/.
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

L, HEIGHT, THICKNESS = 0.508, 12.377e-3, 3.2024e-3
"""length and section: stiff along y of the tables, soft along z [m]"""
ALUMINIUM = du.Material(E=71.7e9, nu=0.31, rho=2700.0)
SECTION = du.Section.rectangle(
    ALUMINIUM, width=THICKNESS, height=HEIGHT, orientation=(0.0, 1.0, 0.0)
)
"""soft along local y, which is that of the mesh"""
STEP = 2e-6
"""[s]; equilibrium does not depend on it"""
FORCES = (8.896, 13.345)
"""[N]"""
ANGLES = np.arange(0.0, 91.0, 15.0)
"""of the force from the stiff direction [deg]"""
NUMBERS = (1, 2, 4, 8, 16)
"""of bodies"""
SOLIDS = {
    8.896: (
        (0.01069752828, 0.01057180106, 0.009938278, 0.008686787, 0.006500006, 0.003482, 0.0),
        (0.0, 0.04101166, 0.07696749, 0.105976311, 0.127251299, 0.139594740, 0.143848652),
    ),
    13.345: (
        (0.01603701, 0.01637026, 0.01640441, 0.01485055, 0.01127173, 0.006062462, 0.0),
        (0.0, 0.06270700, 0.113752002, 0.153554457, 0.179978534, 0.192972233, 0.197669499),
    ),
}
"""displacements of the tip along y and z [m] by the force, of solids in ANSYS (Exudyn's tests)"""
BEAMS = (0.008837226, 0.108987937)
"""the same at 45 degrees, 8.896 N, of beams in ANSYS"""
CONVERGED = (0.0088888, 0.1090415)
"""the same of geometrically exact beams in Exudyn, extrapolated from 16 and 32 elements"""


@dataclass(frozen=True, eq=False)
class Found:
    """tips (numbers, forces, angles, 2) [m]: displacements along y and z; errors (numbers,): at 45
    degrees and 8.896 N, difference from CONVERGED over the deflection.
    """

    tips: Array
    errors: Array


def main(folder: Path) -> Found:
    folder.mkdir(parents=True, exist_ok=True)
    found = solve(NUMBERS)
    draw(found, folder / "princeton.png")
    return found


def solve(numbers: tuple[int, ...]) -> Found:
    tips = np.array(
        [
            [[tip(beam, n, force, angle) for angle in ANGLES] for force in FORCES]
            for n in numbers
            for beam in [piece(n)]
        ]
    )
    at_45 = tips[:, 0, ANGLES == 45.0][:, 0]
    errors = np.linalg.norm(at_45 - CONVERGED, axis=1) / np.linalg.norm(CONVERGED)
    return Found(tips, errors)


def piece(n: int) -> du.Superelement:
    """One of n equal pieces; beam elements carry forces at their nodes exactly at rest."""
    points = np.linspace([0.0, 0.0, 0.0], [L / n, 0.0, 0.0], max(2, 32 // n) + 1)
    beam = du.Beam(points, section=SECTION)
    beam.interface("root", points[0])
    beam.interface("tip", points[-1])
    return beam.superelement(step=STEP)


def tip(beam: du.Superelement, n: int, force: float, angle: float) -> Array:
    """Displacements along the stiff and the soft direction (2,) [m], in equilibrium."""
    m = du.Mechanism()
    end: object = m.ground
    for k in range(n):
        body = m.add(beam, f"piece{k}", position=[(k + 0.5) * L / n, 0.0, 0.0])
        m.add(du.joints.Fixed(end, body["root"]))
        end = body["tip"]
    direction = [0.0, np.sin(np.radians(angle)), np.cos(np.radians(angle))]
    m.add(du.loads.Force(end, direction, du.signals.Constant(force)))
    with warnings.catch_warnings():
        # One body and two bodies are beyond the limits of the method, as the run says.
        warnings.simplefilter("ignore", solver.ValidityWarning)
        run = m.simulate(STEP, step=STEP, start="equilibrium")
    at: Array = run[f"piece{n - 1}.tip"].position[0]
    return at[[2, 1]]


def draw(found: Found, target: Path) -> None:
    figure, (stiff, soft, errors) = view.panels(3, share_time=False)
    beside = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
    with view.style():
        for k, (axes, name) in enumerate(((stiff, "stiff"), (soft, "soft"))):
            for n, tips in zip(NUMBERS, found.tips[:, 1, :, k], strict=True):
                if n in (1, 2, 16):
                    axes.plot(ANGLES, 1e3 * tips, label=f"{n} bodies" if n > 1 else "1 body")
            axes.plot(ANGLES, 1e3 * np.array(SOLIDS[13.345][k]), ".", color="0.3", label="ANSYS")
            axes.set(ylabel=f"tip, {name} direction [mm]")
            axes.legend(**beside)
        soft.set(xlabel="direction of the force of 13.345 N [degrees]")
        errors.loglog(NUMBERS, found.errors, "o-")
        errors.set(xlabel="number of bodies", ylabel="error at 45 degrees")
        view.entitle(figure, "The Princeton beam")
    view.save(figure, target)


if __name__ == "__main__":
    result = main(Path(sys.argv[1] if len(sys.argv) > 1 else "out"))
    print("45 degrees, 8.896 N: error over the deflection")
    for n, error in zip(NUMBERS, result.errors, strict=True):
        print(f"  {n:2d} bodies: {error:.2g}")
    for force, tips in zip(FORCES, result.tips[-1], strict=True):
        ratios = tips[1:-1] / np.array(SOLIDS[force]).T[1:-1] - 1
        print(f"{force} N, 16 bodies beside solids in ANSYS, 15 to 75 degrees:")
        print(f"  stiff {100 * ratios[:, 0].min():.1f} to {100 * ratios[:, 0].max():.1f} %")
        print(f"  soft {100 * ratios[:, 1].min():.1f} to {100 * ratios[:, 1].max():.1f} %")
