"""Published benchmarks beside Exudyn: CPU time of a step, and errors, with the same steps.

Ours are the models of examples/benchmarks, and record everything; Exudyn records one point. Both
take turns, on one thread. Times of ours are those of whole calls of `simulate`.

    python benchmarks/published.py [--repeats N] [--only NAME]
"""

import argparse
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import duhamel as du
import numpy as np
from duhamel import solver
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "examples/benchmarks"))
import bennett
import bicycle
import bricard
import four_bars
import lateral_buckling
import misaligned_four_bar
from peer import published, wheels_and_loops
from peer.lateral_buckling import lateral_buckling as exudyn_buckling
from peer.run import Stopwatch

Array = NDArray[np.float64]
Measure = Callable[[], tuple[float, float]]
"""gives CPU time of a step [us], and an error"""

STEP = 1e-3
"""of rigid mechanisms [s]"""
SKEW_STEP, SKEW_ELEMENTS = 4e-3, 8
BUCKLING_STEP = 5e-4


def ours(simulate: Callable[[], object], steps: int) -> tuple[float, object]:
    watch = Stopwatch()
    with watch.running():
        run = simulate()
    return 1e6 * watch.cpu / steps, run


def linkages(n: int) -> dict[str, Measure]:
    t_end = four_bars.T_END

    def by_duhamel() -> tuple[float, float]:
        m = four_bars.linkage(n)
        cpu, run = ours(lambda: m.simulate(t_end, step=STEP), round(t_end / STEP))
        return cpu, apart(run["upright0.top"].position[:, :2], four_bars.reference(n, run.time))

    def by_exudyn() -> tuple[float, float]:
        run = published.four_bars(n, STEP, t_end)
        return run.cpu, apart(run.tip[:, :2], four_bars.reference(n, run.time))

    return {"Duhamel": by_duhamel, "Exudyn": by_exudyn}


def apart(found: Array, expected: Array) -> float:
    return float(np.linalg.norm(found - expected, axis=1).max())


def mechanism_of_bricard() -> dict[str, Measure]:
    rows = [round(t / STEP) for t in bricard.REFERENCE]
    expected = np.array(list(bricard.REFERENCE.values()))

    def by_duhamel() -> tuple[float, float]:
        m = bricard.mechanism()
        cpu, run = ours(lambda: m.simulate(10.0, step=STEP, redundant="remove"), rows[-1])
        return cpu, apart(run["rod3.end"].position[rows], expected)

    def by_exudyn() -> tuple[float, float]:
        run = published.bricard(bricard.POINTS, bricard.axes_of_hinges(), STEP, 10.0)
        return run.cpu, apart(run.tip[rows], expected)

    return {"Duhamel": by_duhamel, "Exudyn": by_exudyn}


def linkage_of_bennett() -> dict[str, Measure]:
    """The end of the first bar."""
    model, t_end = bennett, bennett.T_END

    def error(tip: Array, time: Array) -> float:
        angle = model.reference(time)
        return apart(tip[:, :2], model.A * np.stack([np.cos(angle), np.sin(angle)], axis=1))

    def by_duhamel() -> tuple[float, float]:
        m = model.linkage()
        steps = round(t_end / STEP)
        cpu, run = ours(lambda: m.simulate(t_end, step=STEP, redundant="remove"), steps)
        return cpu, error(run["bar1.end"].position, run.time)

    def by_exudyn() -> tuple[float, float]:
        run = wheels_and_loops.bennett(model, STEP, t_end)
        return run.cpu, error(run.tip, run.time)

    return {"Duhamel": by_duhamel, "Exudyn": by_exudyn}


def pushed_bicycle() -> dict[str, Measure]:
    """A point 1 m beside the frame; the reference is extrapolated from ours with finer steps.

    Exudyn comes within 1.2e-5 m of it at 0.5 ms, and goes away from it with finer steps.
    """
    speed, lean_rate, t_end = 4.6, 0.5, 5.0

    def place(run: du.Run) -> Array:
        return run["frame"].x + bicycle.left_of(run)

    coarse, fine = (
        place(bicycle.bicycle(speed, lean_rate).simulate(t_end, step=step))
        for step in (STEP / 4, STEP / 8)
    )
    expected = (4.0 * fine[::8] - coarse[::4]) / 3.0

    def by_duhamel() -> tuple[float, float]:
        m = bicycle.bicycle(speed, lean_rate)
        cpu, run = ours(lambda: m.simulate(t_end, step=STEP), round(t_end / STEP))
        return cpu, apart(place(run), expected)

    def by_exudyn() -> tuple[float, float]:
        run = wheels_and_loops.bicycle(bicycle, speed, lean_rate, STEP, t_end)
        return run.cpu, apart(run.tip, expected)

    return {"Duhamel": by_duhamel, "Exudyn": by_exudyn}


def skew_four_bar() -> dict[str, Measure]:
    model = misaligned_four_bar
    rows = np.round(model.TIMES / SKEW_STEP).astype(int)

    def by_duhamel() -> tuple[float, float]:
        m, end = model.mechanism(1, False)
        cpu, run = ours(lambda: m.simulate(model.T_END, step=SKEW_STEP, rho_inf=0.5), rows[-1])
        return cpu, model.error(run[end].position[rows, 2], model.DEFLECTIONS)

    def by_exudyn() -> tuple[float, float]:
        run, _ = exudyn_skew_four_bar(SKEW_ELEMENTS)
        return run.cpu, model.error(run.tip[rows, 2], model.DEFLECTIONS)

    return {"Duhamel": by_duhamel, "Exudyn": by_exudyn}


def buckling() -> dict[str, Measure]:
    """As many bodies as elements."""
    model, n = lateral_buckling, 32
    row = round(model.AT / BUCKLING_STEP)

    def by_duhamel() -> tuple[float, float]:
        m = model.mechanism(n)
        steps = round(model.T_END / BUCKLING_STEP)
        cpu, run = ours(lambda: m.simulate(model.T_END, step=BUCKLING_STEP, rho_inf=0.9), steps)
        return cpu, abs(run[f"piece{n // 2}.start"].position[row, 1] / model.SIDEWAYS - 1)

    def by_exudyn() -> tuple[float, float]:
        run = exudyn_buckling(n, BUCKLING_STEP, model.T_END)
        return run.cpu, abs(run.tip[row, 1] / model.SIDEWAYS - 1)

    return {"Duhamel": by_duhamel, "Exudyn": by_exudyn}


def exudyn_skew_four_bar(elements: int) -> tuple[published.Run, Array]:
    """And the torque of its drive (n,) [N m]."""
    model = misaligned_four_bar
    sections = [
        published.beam_section([EA, GA, GA, GJ, EI, EI], mass, [2 * inertia, inertia, inertia])
        for EA, GA, GJ, EI, mass, inertia in (model.THICK, model.THICK, model.THIN)
    ]
    points = np.array([model.A, model.B, model.C, model.D])
    return published.skew_four_bar(
        points, sections, model.SKEW, angle_of_drive, elements, SKEW_STEP, model.T_END
    )


def angle_of_drive(t: float) -> float:
    """The integral of its speed, which rises by 10 s^3 - 15 s^4 + 6 s^5."""
    model = misaligned_four_bar
    s = min(t / model.RUN_UP, 1.0)
    rise = 2.5 * s**4 - 3.0 * s**5 + s**6
    return float(model.SPEED * (model.RUN_UP * rise + max(t - model.RUN_UP, 0.0)))


def main() -> None:
    parser = argparse.ArgumentParser(description="Published benchmarks beside Exudyn.")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--only", default="", help="problems whose name has this")
    options = parser.parse_args()
    repeats = options.repeats
    warnings.simplefilter("ignore", solver.ValidityWarning)
    problems = {
        "2 linkages": lambda: linkages(2),
        "40 linkages": lambda: linkages(40),
        "Bricard": mechanism_of_bricard,
        "Bennett": linkage_of_bennett,
        "bicycle": pushed_bicycle,
        "skew four-bar": skew_four_bar,
        "lateral buckling": buckling,
    }
    print("| problem | | CPU, us a step | error |", "|---|---|---|---|", sep="\n")
    for problem, made in problems.items():
        if options.only not in problem:
            continue
        programs = made()
        measured: dict[str, list[tuple[float, float]]] = {name: [] for name in programs}
        for _ in range(repeats):
            for name, measure in programs.items():
                measured[name].append(measure())
        for name, pairs in measured.items():
            least, most = min(pairs)[0], max(pairs)[0]
            print(
                f"| {problem} | {name} | {least:.0f} to {most:.0f} | {pairs[0][1]:.2g} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
