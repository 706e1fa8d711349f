"""A housing that falls on its feet: contact of a surface with the floor.

    python examples/housing.py [FOLDER]

runs examples/housing.toml, and again with half the step. Checks that momentum and energy are kept,
and that the force is right to the second order of the step. Writes results and
a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.results import series
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/housing/housing.toml"
GRAVITY = 9.81
COMPARED = 0.01
"""[s] in which forces of both steps are compared: later impacts depend on the earlier ones"""
SIDES = (-1, -1), (1, -1), (1, 1), (-1, 1)
"""of the feet along x and y, from the center of mass"""


@dataclass(frozen=True, eq=False)
class Drop:
    """time (n,) [s]; force of the floor (n,) [N]; impacts: how often it lands; heights (n, 4) of
    the feet [m], of the undeformed housing; acceleration (n,) of the board along z, within the
    band [m/s^2].
    """

    time: Array
    force: Array
    impacts: int
    heights: Array
    acceleration: Array


@dataclass(frozen=True)
class Checks:
    """Relative: error of the momentum, difference of the forces from those with half the step, and
    error of the energy with both.
    """

    momentum: float
    difference: float
    balance: float
    balance_of_half: float


def main(folder: Path) -> tuple[Drop, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/housing.toml")
    results = solver.simulate(model, output=folder / "housing.h5")
    settings = replace(model.settings, step=0.5 * model.settings.step)
    finer = solver.simulate(replace(model, settings=settings))
    found = drop(results)
    checks = compare(results, finer)
    with view.style():
        view.save(curves(found, results), folder / "housing.png")
    assert checks.momentum < 1e-4
    assert checks.difference < 0.02
    assert checks.balance < 1e-3
    assert checks.balance_of_half < 0.4 * checks.balance
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def drop(results: solver.Results) -> Drop:
    body, element = results.body("housing"), results.superelement("housing")
    X = element.surface("soles").X
    feet = [X[(np.sign(X[:, :2]) == side).all(axis=1)] for side in SIDES]
    w, x, y, z = body.rotation.T
    up = np.stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x**2 + y**2)], axis=1)
    heights = [body.x[:, 2] + (up @ foot.T).min(axis=1) for foot in feet]
    # Beyond the band there is a static rest, of which accelerations mean nothing.
    band, acceleration = element.band, results.frame("housing.board").acceleration[:, 2]
    acceleration = series.butterworth(results.time, acceleration, "lowpass", (band,)).values
    floor = results.surface_contact("floor")
    impacts = len(floor.events.start)
    return Drop(results.time, floor.normal_force, impacts, np.stack(heights, axis=1), acceleration)


def compare(results: solver.Results, finer: solver.Results) -> Checks:
    floor, body = results.surface_contact("floor"), results.body("housing")
    coarse, fine = floor.normal_force, finer.surface_contact("floor").normal_force[::2]
    gained = body.velocity[-1, 2] - body.velocity[0, 2] + GRAVITY * results.time[-1]
    momentum = results.superelement("housing").mass * gained
    early = results.time <= COMPARED
    gap = np.linalg.norm((coarse - fine)[early]) / np.linalg.norm(fine[early])
    return Checks(
        momentum=abs(float(floor.impulse[-1] / momentum) - 1.0),
        difference=float(gap),
        balance=worst(results),
        balance_of_half=worst(finer),
    )


def worst(results: solver.Results) -> float:
    return max(results.validity.values("energy_balance").values())


def curves(found: Drop, results: solver.Results) -> Figure:
    figure, (feet, floor, board, energy) = view.panels(4)
    time = 1e3 * found.time
    for number, height in enumerate(found.heights.T, 1):
        feet.plot(time, 1e3 * height, label=f"foot {number}")
    floor.plot(time, found.force)
    board.plot(time, 1e-3 * found.acceleration)
    for name in ("kinetic", "elastic", "potential", "dissipated"):
        energy.plot(time, 1e3 * getattr(results.energy, name), label=name)
    feet.set(title="height of the feet", ylabel="[mm]")
    floor.set(title="force of the floor", ylabel="[N]")
    board.set(title="acceleration of the board along z, below 10 kHz", ylabel="[km/s²]")
    energy.set(title="energy", ylabel="[mJ]", xlabel="time [ms]")
    for axes in (feet, energy):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=4)
    view.entitle(figure, "A housing that falls on its feet")
    return figure


def report(found: Drop, checks: Checks) -> None:
    print(f"board, below 10 kHz         {np.abs(found.acceleration).max():.0f} m/s^2 at most")
    print(
        f"floor                       {found.impacts} impacts, up to {found.force.max():.1f} N at "
        f"{1e3 * found.time[found.force.argmax()]:.3f} ms"
    )
    print(f"impulse of the floor        momentum of the housing within {checks.momentum:.1e}")
    print(f"half the step               force of the first 10 ms within {checks.difference:.1e}")
    print(
        f"error of the energy         {checks.balance:.1e} of the largest, with half the step "
        f"{checks.balance_of_half:.1e}"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
