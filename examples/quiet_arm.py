"""The motion of a drive that leaves a flexible arm at rest.

    python examples/quiet_arm.py [FOLDER]

Optimizes the points of examples/arm_move.toml's acceleration as examples/quiet_arm.toml asks for,
and runs both motions. What is left of the vibration is compared with before. A motion leaves a
mode at rest if its acceleration has nothing at that frequency: that holds for the first mode, and
what is left is the second one. Writes the optimized model and a picture to FOLDER, by default out/.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from duhamel import preprocess, solver, study, superelement, view
from matplotlib.figure import Figure
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parent.parent
BODY = ROOT / "meshes/beam/beam.toml"
STUDY = ROOT / "examples/quiet_arm.toml"
END_OF_MOVE = 0.15
"""[s]"""
EI, MASS_PER_LENGTH, L = 5.5, 0.0858, 0.5
CLAMPED_ROOTS = 1.875104, 4.694091
"""of cos x cosh x = -1, for the modes of a clamped beam"""


@dataclass(frozen=True, eq=False)
class Moves:
    """What a search found, and the runs before and after."""

    optimum: study.Optimum
    before: solver.Results
    after: solver.Results

    @property
    def ratio(self) -> float:
        """What is left of the vibration after the move, before over after."""
        return left_over(self.before) / left_over(self.after)

    def excitation(self, results: solver.Results) -> Array:
        """What acceleration excites the first two modes with, over that at the frequency 0."""
        model = solver.read_model(STUDY.with_name("arm_move.toml"))
        times = model.joints[0].angular_acceleration.times
        t = np.linspace(times[0], times[-1], 4001)
        hub = results.body("hub").angular_acceleration[:, 2]
        alpha = np.interp(t, results.time, hub)
        waves = np.exp(-2j * np.pi * np.outer(frequencies(), t))
        found = np.abs(np.trapezoid(waves * alpha, t, axis=1))
        return found / np.trapezoid(np.abs(alpha), t)


def main(folder: Path) -> Moves:
    folder.mkdir(parents=True, exist_ok=True)
    if not (target := BODY.with_suffix(".h5")).exists():
        superelement.write(preprocess.build(preprocess.read_body(BODY)), target)
    optimized = folder / "quiet-arm.toml"
    optimum = study.optimize(STUDY, optimized)
    models = (STUDY.with_name("arm_move.toml"), optimized)
    before, after = (solver.simulate(solver.read_model(path)) for path in models)
    found = Moves(optimum, before, after)
    view.save(picture(found), folder / "quiet-arm.png")
    assert optimum.converged
    assert found.ratio > 1000.0
    assert found.excitation(after)[0] < 1e-3 * found.excitation(before)[0]
    return found


def frequencies() -> Array:
    """The first two of a beam that is clamped to a driven hub [Hz]."""
    roots = np.array(CLAMPED_ROOTS)
    found: Array = roots**2 / (2.0 * np.pi * L**2) * np.sqrt(EI / MASS_PER_LENGTH)
    return found


def deflection(results: solver.Results) -> Array:
    """Of the tip, seen from the hub (n,) [m]."""
    tip, rim = (results.frame(name) for name in ("beam.tip", "hub.rim"))
    angle = results.joint("pivot").angle
    across = np.stack([-np.sin(angle), np.cos(angle), np.zeros_like(angle)], axis=1)
    found: Array = ((tip.position - rim.position) * across).sum(axis=1)
    return found


def left_over(results: solver.Results) -> float:
    """The root mean square of the deflection after the move [m]."""
    after = deflection(results)[results.time >= END_OF_MOVE]
    return float(np.sqrt(np.mean(after**2)))


def picture(found: Moves) -> Figure:
    figure, (drive, tip, rest) = view.panels(3)
    with view.style():
        for results, label in ((found.before, "before"), (found.after, "optimized")):
            time = 1e3 * results.time
            alpha = results.body("hub").angular_acceleration[:, 2]
            drive.plot(time, alpha, label=label)
            tip.plot(time, 1e3 * deflection(results), label=label)
            rest.semilogy(time, 1e3 * np.abs(deflection(results)) + 1e-9, linewidth=0.8)
        drive.set(title="angular acceleration of the hub", ylabel="[rad/s²]")
        tip.set(title="deflection of the tip", ylabel="[mm]")
        rest.set(title="its magnitude", ylabel="[mm]", xlabel="time [ms]", ylim=(1e-5, 30.0))
        for axes in (drive, tip, rest):
            axes.axvline(1e3 * END_OF_MOVE, color="0.3", linestyle="--", linewidth=0.9)
        drive.legend(loc="upper right")
    view.entitle(figure, "A flexible arm that a motion leaves at rest")
    return figure


def report(found: Moves) -> None:
    print(
        f"left of the vibration: {1e3 * left_over(found.before):.3g} mm before, "
        f"{1e3 * left_over(found.after):.3g} mm after, a ratio of {found.ratio:.0f}"
    )
    excitation = zip(
        frequencies(),
        found.excitation(found.before),
        found.excitation(found.after),
        strict=True,
    )
    for frequency, before, after in excitation:
        print(f"excitation at {frequency:.2f} Hz: {before:.2g} before, {after:.2g} after")
    print(f"{found.optimum.state}; {found.optimum.runs} runs")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out"
    report(main(target))
    print(f"model and picture: {target}")
