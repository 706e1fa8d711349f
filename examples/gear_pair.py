"""Two spur gears of POM whose teeth rattle in their backlash, beside the geometry of involutes.

    python examples/gear_pair.py [FOLDER]

runs examples/gear_pair.toml. Checks the arm of the contact force about the shaft of the wheel
against the radius of the base circle, the way between both flanks against the backlash, the
stiffness of the teeth against ISO 6336, and the energy. Writes results and a picture to FOLDER, by
default out/.
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
BODY = ROOT / "meshes/spur_gear/spur_gear.toml"
CENTERS, SPEED, WIDTH = 0.04, 100.0, 0.003
BASE = 0.5 * CENTERS * np.cos(np.deg2rad(20.0))
BACKLASH = 6e-5
"""along the line of action [m]"""
ISO_STIFFNESS = 14e9 * 2.9e9 / 2.06e11
"""of a pair of teeth, by the width: 14 N/(mm um) of steel, in proportion to the moduli [N/m^2]"""
CONTACT_RATIO = 1.56
"""mean number of pairs of teeth in contact"""
LOADED = 5.0
"""normal force from which on arms are looked at [N]"""


@dataclass(frozen=True, eq=False)
class Rattle:
    """time (n,) [s]; normal force (n,) of the teeth [N]; way (n,) of the wheel along the line of
    action, over that of the pinion; arm (n,) of the contact force about the shaft of the wheel,
    not a number where there is next to no force [m].
    """

    time: Array
    force: Array
    way: Array
    arm: Array


@dataclass(frozen=True)
class Checks:
    """Relative errors of the mean arm against the radius of the base circle, with its rms scatter,
    and of the free way between both flanks against the backlash; stiffness of the teeth by their
    width [N/m^2]; error of the energy balance.
    """

    arm: float
    scatter: float
    backlash: float
    stiffness: float
    balance: float


def main(folder: Path) -> tuple[Rattle, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/gear_pair.toml")
    results = solver.simulate(model, output=folder / "gear_pair.h5")
    found = rattle(results)
    checks = compare(found, results)
    with view.style():
        view.save(curves(found), folder / "gear-pair.png")
    assert abs(checks.arm) < 0.003
    assert checks.scatter < 0.01
    # Flat facets touch before the flanks do, by a sixth of the height of their arcs on each side.
    assert -0.08 < checks.backlash < 0.0
    mean = ISO_STIFFNESS * (0.75 * CONTACT_RATIO + 0.25)
    assert 0.9 * ISO_STIFFNESS < checks.stiffness < 1.1 * mean
    assert checks.balance < 1e-3
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def rattle(results: solver.Results) -> Rattle:
    contact = results.surface_contact("teeth")
    force = contact.normal_force
    to_wheel = contact.center_of_pressure - [CENTERS, 0.0, 0.0]
    moment = np.cross(to_wheel, -contact.force)[:, 2]
    loaded = force > LOADED
    arm = np.divide(moment, force, out=np.full(len(force), np.nan), where=loaded)
    turned = results.joint("bearing").angle + SPEED * results.time
    return Rattle(results.time, force, BASE * turned, arm)


def compare(found: Rattle, results: solver.Results) -> Checks:
    arms = np.abs(found.arm[np.isfinite(found.arm)]) / BASE
    closed = found.force > 0.0
    left, right = (found.way[closed & (side * found.way > 0.0)] for side in (1.0, -1.0))
    peak = int(found.force.argmax())
    deep = abs(found.way[peak]) - 0.5 * BACKLASH
    return Checks(
        arm=float(arms.mean()) - 1.0,
        scatter=float(arms.std()),
        backlash=float(left.min() - right.max()) / BACKLASH - 1.0,
        stiffness=float(found.force[peak] / deep) / WIDTH,
        balance=max(results.validity.values("energy_balance").values()),
    )


def curves(found: Rattle) -> Figure:
    figure, (force, way, arm) = view.panels(3)
    time = 1e3 * found.time
    force.plot(time, found.force)
    way.plot(time, 1e6 * found.way)
    for side in (1.0, -1.0):
        way.axhline(
            0.5e6 * side * BACKLASH,
            color="0.5",
            linestyle="--",
            label="flanks" if side > 0 else None,
        )
    arm.plot(time, 1e3 * np.abs(found.arm))
    arm.axhline(1e3 * BASE, color="0.5", linestyle="--", label="base circle")
    arm.set_ylim(1e3 * BASE - 1.0, 1e3 * BASE + 1.0)
    force.set(title="normal force of the teeth", ylabel="[N]")
    way.set(title="wheel over pinion along the line of action", ylabel="[µm]")
    arm.set(title="arm of the force about the wheel", ylabel="[mm]", xlabel="time [ms]")
    for axes in (way, arm):
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    view.entitle(figure, "Gears that rattle in their backlash")
    return figure


def report(found: Rattle, checks: Checks) -> None:
    mean = 0.75 * CONTACT_RATIO + 0.25
    print(f"arm of the force            {100.0 * checks.arm:+.2f} % of the base circle's radius")
    print(f"its scatter                 {100.0 * checks.scatter:.2f} % rms")
    print(f"way between the flanks      {100.0 * checks.backlash:+.1f} % of the backlash")
    print(f"stiffness of the teeth      {1e-9 * checks.stiffness:.3f} N/(mm um)")
    print(f"    by ISO 6336, one pair   {1e-9 * ISO_STIFFNESS:.3f} N/(mm um)")
    print(f"    in the mean             {1e-9 * ISO_STIFFNESS * mean:.3f} N/(mm um)")
    print(f"largest force               {found.force.max():.1f} N")
    print(f"error of the energy         {checks.balance:.1e} of the largest")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
