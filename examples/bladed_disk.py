"""A bladed disk that runs up: stresses in its blades, and how far their tips stretch.

    python examples/bladed_disk.py [FOLDER]

runs examples/bladed_disk.toml. At full speed the tension along a blade is compared with the closed
form rho Omega^2 (R^2 - r^2) / 2, the stretch of its tip and the inertia with those of the finite
element mesh under centrifugal loads, solved without the superelement, and the speed with what the
torque has brought. Writes results and pictures to FOLDER, by default out/.
"""

import sys
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from duhamel import preprocess, solver, superelement, view
from duhamel.preprocess import assemble
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/disk/wheel.toml"
STRAIGHT, TIP = 0.14, 0.20
"""radii from which on the tension along a blade is that of a bar, and of its tip [m]"""
ANGULAR_MOMENTUM = 65.24
"""what the torque brings, 652.4 N m, rising and falling for 0.1 s each [N m s]"""
ENLARGED = 60.0
"""displacements in the picture"""


@dataclass(frozen=True, eq=False)
class Wheel:
    """time, speed [rad/s] and stretch of a tip [m], all (n,); at full speed the tension (k,) [Pa]
    at points of a blade at radii (k,) [m].
    """

    time: Array
    speed: Array
    stretch: Array
    radii: Array
    tension: Array

    @property
    def expected_tension(self) -> Array:
        rho = preprocess.read_body(BODY).material.rho
        return 0.5 * rho * self.speed[-1] ** 2 * (TIP**2 - self.radii**2)


@dataclass(frozen=True)
class Checks:
    """Relative differences.

    tension: from the closed form, over its largest; stretch: of the tip, from the finite element
    mesh; speed: from the angular momentum over the inertia of that mesh as it is widened.
    """

    tension: float
    stretch: float
    speed: float


def main(folder: Path) -> tuple[Wheel, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/bladed_disk.toml")
    target = folder / "bladed-disk.h5"
    solver.simulate(model, output=target)
    results = solver.Results.read(target)
    found = wheel(results)
    checks = compare(found)
    with view.style():
        view.save(curves(found, without_second_order(model)), folder / "bladed-disk.png")
        view.save(stresses(results), folder / "bladed-disk-stress.png")
    assert checks.tension < 5e-3
    assert checks.stretch < 1e-6
    assert checks.speed < 1e-6
    return found, checks


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def wheel(results: solver.Results) -> Wheel:
    """Points of the first blade, which lies along x in body axes."""
    end, points = results.time[-1], results.superelement("wheel").recovery.points
    blade = np.flatnonzero((points[:, 0] >= STRAIGHT) & (np.abs(points[:, 1]) < 0.01))
    return Wheel(
        results.time,
        results.body("wheel").v[:, 5],
        results.frame("wheel.tip").u[:, 0],
        points[blade, 0],
        results.stress("wheel", end)[blade, 0],
    )


def without_second_order(model: solver.Model) -> Wheel:
    """The same with a linear body."""
    warnings.simplefilter("ignore", solver.ValidityWarning)
    linear = replace(model.bodies["wheel"], second_order="off")
    return wheel(solver.simulate(replace(model, bodies={"wheel": linear})))


def compare(found: Wheel) -> Checks:
    speed, expected = found.speed[-1], found.expected_tension
    stretch, inertia = widened(speed)
    return Checks(
        tension=float(np.abs(found.tension - expected).max() / expected.max()),
        stretch=abs(found.stretch[-1] / stretch - 1.0),
        speed=abs(speed * inertia / ANGULAR_MOMENTUM - 1.0),
    )


def widened(speed: float) -> tuple[float, float]:
    """How far a tip moves out [m], and the inertia about the axis [kg m^2], by the mesh alone:

    K u + P^T lambda = Omega^2 M X,  P u = 0 on average over the bore,   X across the axis
    """
    structure = assemble(preprocess.read_body(BODY))
    X = structure.nodes.points * [1.0, 1.0, 0.0]
    load, (bore, tip) = structure.M @ X.ravel(), (structure.P_C[:6], structure.P_C[6:])
    K = sp.block_array([[structure.K, bore.T], [bore, None]], format="csc")
    u = spsolve(K, np.concatenate([speed**2 * load, np.zeros(6)]))[:-6]
    return float((tip @ u)[0]), float(load @ X.ravel() + 2.0 * load @ u)


def curves(found: Wheel, without: Wheel) -> Figure:
    figure, (speed, tip, tension) = view.panels(3, share_time=False)
    blue, red, *_ = view.COLORS
    speed.plot(found.time, found.speed, color=blue)
    for each, color, label in ((found, blue, "wheel"), (without, red, "without second order")):
        tip.plot(each.time, 1e3 * each.stretch, color=color, label=label)
        tension.plot(1e3 * each.radii, 1e-6 * each.tension, ".", color=color, label=label)
    order = np.argsort(found.radii)
    tension.plot(
        1e3 * found.radii[order], 1e-6 * found.expected_tension[order], color="0.3", label="bar"
    )
    speed.set(title="speed", ylabel="[rad/s]")
    tip.set(title="a tip moves out", ylabel="[mm]", xlabel="time [s]")
    tension.set(title="tension along a blade at full speed", ylabel="[MPa]", xlabel="radius [mm]")
    for axes in (tip, tension):
        axes.legend(loc="center left")
    view.entitle(figure, "A bladed disk runs up")
    return figure


def stresses(results: solver.Results) -> Figure:
    """The wheel at full speed, its blades as they have turned and stretched."""
    end, recovery = results.time[-1], results.superelement("wheel").recovery
    points = recovery.points + ENLARGED * results.displacement("wheel", end)
    field = view.Field(points, recovery.cells, results.von_mises("wheel", end))
    return view.draw_fields([field], "von Mises stress [MPa]", 1e-6)


def report(found: Wheel, checks: Checks) -> None:
    print(
        f"speed                       {found.speed[-1]:.2f} rad/s, that of the widened mesh within "
        f"{checks.speed:.1e}"
    )
    print(
        f"a tip moves out             {1e6 * found.stretch[-1]:.2f} um, that of the mesh within "
        f"{checks.stretch:.1e}"
    )
    print(
        f"tension along a blade       {1e-6 * found.tension.max():.1f} MPa at 140 mm, that of a "
        f"bar within {checks.tension:.1e}"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
