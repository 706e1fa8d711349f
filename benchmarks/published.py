"""Published benchmarks beside Exudyn: CPU time of a step, and errors, with the same steps.

Ours are the models of examples/benchmarks, and record everything; Exudyn records one point. Both
take turns, on one thread. Times of ours are those of whole calls of `simulate`.

    python benchmarks/published.py [--repeats N]
"""

import argparse
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from duhamel import solver
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "examples/benchmarks"))
import bricard
import four_bars
import lateral_buckling
import misaligned_four_bar
from peer import published
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
    repeats = parser.parse_args().repeats
    warnings.simplefilter("ignore", solver.ValidityWarning)
    problems = {
        "2 linkages": linkages(2),
        "40 linkages": linkages(40),
        "Bricard": mechanism_of_bricard(),
        "skew four-bar": skew_four_bar(),
        "lateral buckling": buckling(),
    }
    print("| problem | | CPU, us a step | error |", "|---|---|---|---|", sep="\n")
    for problem, programs in problems.items():
        measured: dict[str, list[tuple[float, float]]] = {name: [] for name in programs}
        for _ in range(repeats):
            for name, measure in programs.items():
                measured[name].append(measure())
        for name, pairs in measured.items():
            print(f"| {problem} | {name} | {min(pairs)[0]:.0f} | {pairs[0][1]:.2g} |", flush=True)


if __name__ == "__main__":
    main()
