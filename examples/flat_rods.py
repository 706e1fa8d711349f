"""Two flat-ended rods that meet face on face, beside the waves of the theory of rods.

    python examples/flat_rods.py [FOLDER]

runs examples/flat_rods.toml, in which all nodes of both faces may touch. Checks the force and its
duration, the velocities after the impact, the momentum, and that the pressure is even. Writes
results and a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/flat_rod/flat_rod.toml"
E, RHO, LENGTH, AREA, SPEED = 200e9, 7800.0, 0.1, 6.4e-5, 2.0
WAVE = (E / RHO) ** 0.5
"""velocity of long waves in a rod [m/s]"""
PLATEAU = 0.25, 0.75
"""part of the contact in which forces and pressures are those of the theory"""


@dataclass(frozen=True, eq=False)
class Impact:
    """time (n,) [s]; force (n,) of the faces and that of the theory, expected (n,) [N]; velocities
    (2, n) of striker and struck [m/s].
    """

    time: Array
    force: Array
    expected: Array
    velocities: Array


@dataclass(frozen=True)
class Checks:
    """Relative: errors of force and duration against the theory; velocity of the striker after the
    impact over that before; error of the momentum; spread of the pressures of the face.
    """

    force: float
    duration: float
    left: float
    momentum: float
    pressure: float


def main(folder: Path) -> tuple[Impact, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/flat_rods.toml")
    results = solver.simulate(model, output=folder / "flat_rods.h5")
    found, checks = impact(results), compare(results)
    with view.style():
        view.save(curves(found), folder / "flat-rods.png")
    assert checks.force < 0.01
    assert checks.duration < 0.03
    assert abs(checks.left) < 0.02
    assert checks.momentum < 1e-10
    assert checks.pressure < 0.1
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def impact(results: solver.Results) -> Impact:
    faces, time = results.surface_contact("faces"), results.time
    start = float(faces.events.start[0])
    during = (time >= start) & (time < start + 2.0 * LENGTH / WAVE)
    velocities = [results.body(name).velocity[:, 0] for name in ("striker", "struck")]
    return Impact(time, faces.normal_force, during * plateau(), np.array(velocities))


def plateau() -> float:
    """rho c A v / 2: equal rods share the jump of the velocity."""
    return 0.5 * RHO * WAVE * AREA * SPEED


def compare(results: solver.Results) -> Checks:
    faces, time = results.surface_contact("faces"), results.time
    start, end = float(faces.events.start[0]), float(faces.events.end[0])
    low, high = (start + part * (end - start) for part in PLATEAU)
    on = (time > low) & (time < high)
    before, after = (
        sum(results.body(name).velocity[row, 0] for name in ("striker", "struck"))
        for row in (0, -1)
    )
    pressures = faces.pressure[on].mean(axis=0)
    return Checks(
        force=abs(float(faces.normal_force[on].mean()) / plateau() - 1.0),
        duration=abs((end - start) / (2.0 * LENGTH / WAVE) - 1.0),
        left=float(results.body("striker").velocity[-1, 0]) / SPEED,
        momentum=abs(after / before - 1.0),
        pressure=float(np.ptp(pressures) / pressures.mean()),
    )


def curves(found: Impact) -> Figure:
    figure, (force, velocity) = view.panels(2)
    time = 1e6 * found.time
    force.plot(time, 1e-3 * found.expected, label="theory of rods")
    force.plot(time, 1e-3 * found.force, label="faces of the meshes")
    for values, name in zip(found.velocities, ("striker", "struck"), strict=True):
        velocity.plot(time, values, label=name)
    force.set(title="force of the faces", ylabel="[kN]")
    velocity.set(title="velocity of the center of mass", ylabel="[m/s]", xlabel="time [µs]")
    for axes in (force, velocity):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=2)
    view.entitle(figure, "Two rods that meet face on face")
    return figure


def report(found: Impact, checks: Checks) -> None:
    print(f"force                       {plateau():.0f} N, in the middle within {checks.force:.1e}")
    print(f"duration                    2 L / c within {checks.duration:.1e}")
    print(f"striker                     keeps {checks.left:.1e} of its velocity")
    print(f"momentum                    kept within {checks.momentum:.1e}")
    print(f"pressures of the face       differ by {checks.pressure:.1e} in the mean")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
