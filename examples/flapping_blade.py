"""A helicopter blade on a flap hinge: droop at rest, lift-off from its stop, flap frequencies.

    python examples/flapping_blade.py [FOLDER]

runs examples/flapping_blade.toml from rest to full speed. Droop at rest and coning at speed are
compared with closed forms; then the blade is kicked at steady speeds, and its flap frequencies are
compared with nu^2 = 1 + 3/2 e / (1 - e) of a rigid blade, e the offset of the hinge over the
radius, and with those of a rotating beam. Writes results and a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, superelement, view
from duhamel.results import quantities
from matplotlib.figure import Figure
from numpy.typing import NDArray
from rotating_theory import RotatingBeam, peak_frequency

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/rotor_blade/blade.toml"
L, G = 4.75, 9.81
SPINS = np.array([15.0, 30.0, 45.0])
"""of the kicks [rad/s]"""
RINGING, STEP = 3.0, 5e-4
"""how long the blade rings at each, and in which steps [s]"""
Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class RunUp:
    """time, speed [rad/s], angle of the hinge [rad], height of the tip over the hinge and what of
    it is bending [m], moment of the stop [N m], all (n,).
    """

    time: Array
    speed: Array
    angle: Array
    height: Array
    bending: Array
    stop: Array


@dataclass(frozen=True, eq=False)
class Flap:
    """Frequencies (n, 2) [rad/s] at SPINS, and of the rotating beam; rigid (n,): by the formula."""

    found: Array
    expected: Array
    rigid: Array


@dataclass(frozen=True)
class Checks:
    """Relative differences.

    droop: of the bending at rest from q L^4 / 8 EI; coning: of the angle of the hinge in steady
    rotation from that of a rotating beam; rigid: of the first frequency from the formula; beam: of
    both from those of a rotating beam.
    """

    droop: float
    coning: float
    rigid: float
    beam: float


def main(folder: Path) -> tuple[RunUp, Flap, Checks]:
    folder.mkdir(parents=True, exist_ok=True)
    ensure_superelement()
    model = solver.read_model(ROOT / "examples/flapping_blade.toml")
    found = run_up(model, folder / "flapping-blade.h5")
    flap, coning = kicked(model)
    checks = compare(model, found, flap, coning)
    with view.style():
        view.save(curves(model, found, flap), folder / "flapping-blade.png")
    assert checks.droop < 5e-3
    assert checks.coning < 5e-3
    assert checks.rigid < 1e-3
    assert checks.beam < 1e-3
    return found, flap, checks


def ensure_superelement() -> None:
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)


def beam(model: solver.Model) -> RotatingBeam:
    section, hinge = preprocess.read_body(BODY).section, model.bodies["hub"].frames["hinge"]
    return RotatingBeam(L, section.EI_y, section.mass_per_length, hinge.position[0], hinged=True)


def run_up(model: solver.Model, target: Path) -> RunUp:
    results = solver.simulate(model, output=target)
    shaft, flap = (results.joint(name).coordinates for name in ("shaft", "flap"))
    height = quantities.position(results, "blade.tip")[:, 2]
    return RunUp(
        results.time,
        shaft["angle_rate"],
        flap["angle"],
        height,
        height - L * np.sin(flap["angle"]),
        results.stop("droop").force,
    )


def kicked(model: solver.Model) -> tuple[Flap, Array]:
    """Flap frequencies at SPINS, and the angles of the hinge (n,) [rad] before the kick."""
    expected = np.array([beam(model).flap(spin)[:2] for spin in SPINS])
    found = [ringing(model, *at) for at in zip(SPINS, expected, strict=True)]
    offset = beam(model).hub / (beam(model).hub + L)
    rigid = SPINS * np.sqrt(1.0 + 1.5 * offset / (1.0 - offset))
    return Flap(np.array([f for f, _ in found]), expected, rigid), np.array([a for _, a in found])


def ringing(model: solver.Model, spin: float, near: Array) -> tuple[list[float], float]:
    """Flap frequencies [rad/s] after a kick in steady rotation, and the angle before it [rad]."""
    shaft, flap = model.joints
    steady = replace(
        model,
        joints=(replace(shaft, angle=solver.Polynomial((0.0, spin))), flap),
        loads=(solver.Force("blade.tip", Z, solver.Pulse(20.0, 0.01, 0.03)),),
    ).with_settings(t_end=RINGING, step=STEP, steady_rotation=solver.SteadyRotation(spin * Z))
    results = solver.simulate(steady)
    angle = results.joint("flap").coordinates["angle"]
    return [peak_frequency(angle, STEP, f) for f in near], float(angle[0])


def compare(model: solver.Model, found: RunUp, flap: Flap, coning: Array) -> Checks:
    part = beam(model)
    droop = part.mass * G * L**4 / (8.0 * part.EI)
    expected = np.array([part.coning(spin, -part.mass * G) for spin in SPINS])
    return Checks(
        droop=abs(found.bending[0] / -droop - 1.0),
        coning=largest(coning / expected - 1.0),
        rigid=largest(flap.found[:, 0] / flap.rigid - 1.0),
        beam=largest(flap.found / flap.expected - 1.0),
    )


def largest(values: Array) -> float:
    return float(np.abs(values).max())


def curves(model: solver.Model, found: RunUp, flap: Flap) -> Figure:
    figure, (hinge, tip, frequencies) = view.panels(3, share_time=False)
    blue, red, green, *_ = view.COLORS
    lifted = found.time[np.flatnonzero(found.stop)[-1]]
    hinge.plot(found.time, 1e3 * found.angle, color=blue)
    tip.plot(found.time, 1e3 * found.height, color=blue, label="height over the hinge")
    tip.plot(found.time, 1e3 * found.bending, color=red, label="bending")
    for axes in (hinge, tip):
        axes.axvline(lifted, color="0.7", linewidth=0.8)
    fine = np.linspace(0.0, 50.0, 101)
    for row, color in enumerate((blue, red)):
        line = [beam(model).flap(spin)[row] for spin in fine]
        frequencies.plot(fine, line, color="0.3", linewidth=0.8)
        frequencies.plot(SPINS, flap.found[:, row], "o", color=color, label=f"flap {row + 1}")
    frequencies.plot(fine, flap.rigid[0] / SPINS[0] * fine, color=green, linestyle=(0, (4, 4)))
    hinge.set(title="angle of the flap hinge; grey: it leaves the droop stop", ylabel="[mrad]")
    tip.set(title="tip", ylabel="[mm]", xlabel="time [s]")
    frequencies.set(
        title="flap frequencies; lines: rotating beam; dashes: rigid blade",
        ylabel="[rad/s]",
        xlabel="speed [rad/s]",
    )
    tip.legend(loc="lower right")
    frequencies.legend(loc="upper left")
    view.entitle(figure, "A helicopter blade on a flap hinge")
    return figure


def report(found: RunUp, flap: Flap, checks: Checks) -> None:
    lifted = found.speed[np.flatnonzero(found.stop)[-1]]
    print(
        f"bending at rest             {-1e3 * found.bending[0]:.2f} mm, q L^4 / 8 EI within "
        f"{checks.droop:.1e}"
    )
    print(f"leaves its stop             at {lifted:.2f} rad/s")
    for spin, row, rigid in zip(SPINS, flap.found, flap.rigid, strict=True):
        print(
            f"flap at {spin:.0f} rad/s           {row[0]:.3f} and {row[1]:.3f} rad/s, "
            f"rigid blade {rigid:.3f}"
        )
    print(
        f"rigid blade, rotating beam  frequencies within {checks.rigid:.1e}, {checks.beam:.1e}, "
        f"coning of the latter {checks.coning:.1e}"
    )


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(*main(target))
    print(f"results and picture: {target}")
