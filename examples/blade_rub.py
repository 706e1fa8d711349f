"""A fan blade that rubs on a casing with two lobes: contact of a surface in fast rotation.

    python examples/blade_rub.py [FOLDER]

runs examples/blade_rub.toml, and its first rub again with half the step. Checks where the blade
touches first, which its stretch by the centrifugal force decides, what friction takes, and that
forces are right to the second order of the step. Writes results and a picture to FOLDER, by default
out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/fan_blade/fan_blade.toml"
SPIN, FRICTION = 1000.0, 0.05
RIM, LENGTH, E, RHO = 0.05, 0.1, 200e9, 7850.0
"""of the blade: radius of its root and length [m], modulus [Pa], density [kg/m^3]"""
CLEARANCE, LOBE = 50e-6, 30e-6
"""of the casing from the blade at rest: in the mean, and how far its lobes change that [m]"""
FIRST = 0.0025
"""when the first rub is over [s]"""


@dataclass(frozen=True, eq=False)
class Rub:
    """turns (n,) of the rotor; normal force (n,) [N]; bending (n,) of the middle of the blade in
    the plane of rotation [m]; torque (n,) of the drive [N m].
    """

    turns: Array
    force: Array
    bending: Array
    torque: Array


@dataclass(frozen=True)
class Checks:
    """Relative: error of the angle at which the blade touches first, of what friction takes; and
    difference of the forces of the first rub from those with half the step.
    """

    first_touch: float
    friction: float
    difference: float
    balance: float


def main(folder: Path) -> tuple[Rub, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/blade_rub.toml")
    results = solver.simulate(model, output=folder / "blade_rub.h5")
    settings = replace(model.settings, step=0.5 * model.settings.step, t_end=FIRST)
    finer = solver.simulate(replace(model, settings=settings))
    checks = compare(results, finer)
    found = rub(results)
    with view.style():
        view.save(curves(found), folder / "blade-rub.png")
    assert checks.first_touch < 0.01
    assert checks.friction < 0.01
    assert checks.difference < 0.01
    assert checks.balance < 1e-5
    return found, checks


def ensure_superelement() -> Path:
    target = BODY.with_suffix(".h5")
    if not target.exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    return target


def rub(results: solver.Results) -> Rub:
    return Rub(
        turns=results.time * SPIN / (2.0 * np.pi),
        force=results.surface_contact("casing").normal_force,
        bending=results.frame("blade.middle").u[:, 1],
        torque=results.joint("shaft").moment[:, 2],
    )


def compare(results: solver.Results, finer: solver.Results) -> Checks:
    casing = results.surface_contact("casing")
    touched = SPIN * casing.events.start[0]
    taken = FRICTION * SPIN * (RIM + LENGTH) * casing.impulse[-1] / np.hypot(1.0, FRICTION)
    coarse = casing.normal_force[results.time <= FIRST]
    fine = finer.surface_contact("casing").normal_force[::2]
    n = min(len(coarse), len(fine))
    gap = np.linalg.norm(coarse[:n] - fine[:n]) / np.linalg.norm(fine[:n])
    return Checks(
        first_touch=abs(touched / angle_of_first_touch() - 1.0),
        friction=abs(float(results.energy.dissipated[-1] / taken) - 1.0),
        difference=float(gap),
        balance=max(results.validity.values("energy_balance").values()),
    )


def angle_of_first_touch() -> float:
    """Where the casing is as wide as the blade is long, stretched by

    u = rho omega^2 / E (rim length^2 / 2 + length^3 / 3)
    """
    stretch = RHO * SPIN**2 / E * (0.5 * RIM * LENGTH**2 + LENGTH**3 / 3.0)
    return float(0.5 * np.arccos((stretch - CLEARANCE) / LOBE))


def curves(found: Rub) -> Figure:
    figure, (force, bending, torque) = view.panels(3)
    force.plot(found.turns, found.force)
    bending.plot(found.turns, 1e6 * found.bending)
    torque.plot(found.turns, found.torque)
    force.set(title="normal force of the casing", ylabel="[N]")
    bending.set(title="bending of the middle of the blade", ylabel="[µm]")
    torque.set(title="torque of the drive", ylabel="[N m]", xlabel="turns")
    view.entitle(figure, "A fan blade that rubs on its casing")
    return figure


def report(found: Rub, checks: Checks) -> None:
    print(f"casing                      up to {found.force.max():.0f} N")
    print(f"bending                     up to {1e6 * np.abs(found.bending).max():.0f} um")
    print(f"first touch                 {checks.first_touch:.1e} from that of the stretched blade")
    print(f"taken by friction           {checks.friction:.1e} from coefficient, force and speed")
    print(f"half the step               force of the first rub within {checks.difference:.1e}")
    print(f"error of the energy         {checks.balance:.1e} of the largest")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and pictures: {target}")
