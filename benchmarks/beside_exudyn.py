"""Cost of a step beside Exudyn: the paper's Case 1, a solid pendulum, and chains of solids.

CPU time on one thread, and time on the clock beside it, medians over repeats in which the codes
take turns. Exudyn records the position of one tip at every step, ours all that it records unless
asked for less, in memory. Both integrate by generalized-alpha of spectral radius 0.9, with the same
steps. `left`: how far Newton's method leaves the tip from where the least tolerance gets it; `from
ours`: the largest distance between the tips of the codes. Needs the extra `validation`. Run as
`python benchmarks/beside_exudyn.py [--large | --small] [--repeats N]`; `--large` adds a pendulum of
286 875 unknowns, `--small` leaves pendulums and chains of more than one bar out.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import metadata
from pathlib import Path
from statistics import median

from duhamel.preprocess import build, read_body
from duhamel.solver import (
    FlexibleBody,
    Model,
    Place,
    Revolute,
    Settings,
    Start,
    read_model,
    simulate,
)
from duhamel.superelement import Superelement, write

sys.path.insert(0, str(Path(__file__).parents[1]))
from peer import chain, rotor
from peer.bar import Bar
from peer.reduced_body import Index, ReducedBody, reduced_body
from peer.run import Run, Stopwatch
from peer.system import TIGHT

ROOT = Path(__file__).parents[1]
OUR_ELEMENTS = 10
"""of the beam behind the superelement of Case 1"""
LOOSEST = 1e-6
"""tolerance of Exudyn's Newton's method in whole calls"""
MODES = 16
"""of Exudyn's reduced bodies"""
ELEMENTS = 20
"""of the beam of Case 1 in both codes"""
STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7800.0}
ALUMINIUM = {"E": 5.5 / 7.5e-11, "nu": 0.33, "rho": 2860.0}
"""with which a square bar of 3e-5 m^2 has the EI = E A^2 / 12 and the mass per length of the
paper's beam
"""
CASE_1_BAR = Bar(0.5, 3e-5**0.5, (100, 1, 1), ALUMINIUM, step=6e-5)
SMALL, MIDDLE, LARGE = (
    Bar(0.5, 0.06, boxes, STEEL, step=1e-4) for boxes in ((24, 3, 3), (47, 6, 6), (76, 12, 12))
)
CHAINS = (1, 2, 4, 8, 16)
GRAVITY = [0.0, -9.81, 0.0]
STEPS, THEIR_STEPS, LEAST_STEPS = 20000, 4000, 1000
"""with one bar; with n bars the n-th part, or the least"""
ENOUGH = 1e-6
"""how far Newton's method of Exudyn may leave the tip from where it would get [m]"""


@dataclass(frozen=True)
class Entrant:
    """A code with a model; the tolerance of its Newton's method leaves the tip so far off [m]."""

    name: str
    run: Callable[[], Run]
    tolerance: float
    left: float


def ours(model: Model, tip: str) -> Entrant:
    """With the tolerance that models have."""
    run = partial(our_run, model, tip)
    left = run(model.settings.tolerance).apart(run(1e-13))
    return Entrant("ours", partial(run, model.settings.tolerance), model.settings.tolerance, left)


def theirs(models: Mapping[str, Callable[[float], Run]]) -> list[Entrant]:
    """Models of the same equations, with the loosest tolerance with which the first leaves no more
    than ENOUGH.
    """
    first = next(iter(models.values()))
    exact = first(TIGHT)
    for tolerance in (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, TIGHT):
        left = first(tolerance).apart(exact)
        if left <= ENOUGH:
            break
    return [Entrant(name, partial(run, tolerance), tolerance, left) for name, run in models.items()]


def our_run(model: Model, tip: str, tolerance: float) -> Run:
    """Cost of the steps: a run less one of a single step."""
    model = model.with_settings(tolerance=tolerance)
    start, whole = Stopwatch(), Stopwatch()
    with start.running():
        simulate(model.with_settings(t_end=1e-9))
    with whole.running():
        results = simulate(model)
    steps = len(results.time) - 1
    seconds = (whole.cpu - start.cpu, whole.wall - start.wall)
    iterations = float(results.iterations[1:].mean())
    return Run(
        *(1e6 * s / (steps - 1) for s in seconds),
        iterations,
        results.time,
        results.frame(tip).position,
    )


def race(first: str, entrants: Sequence[Entrant], repeats: int) -> None:
    """A row for each, ours first; the time of a step is the median of its repeats."""
    rounds = [[entrant.run() for entrant in entrants] for _ in range(repeats)]
    own = median(turn[0].cpu for turn in rounds)
    for entrant, runs in zip(entrants, zip(*rounds, strict=True), strict=True):
        cpu, wall = median(run.cpu for run in runs), median(run.wall for run in runs)
        cells = [
            first,
            entrant.name,
            f"{cpu:.1f}",
            f"{wall:.1f}",
            f"{runs[0].iterations:.1f}",
            f"{entrant.tolerance:.0e}",
        ]
        cells += [
            f"{entrant.left:.1g} m",
            f"{runs[0].apart(rounds[0][0]):.1g} m",
            f"{cpu / own:.1f}",
        ]
        print("| " + " | ".join(cells) + " |", flush=True)


def case_1_model() -> Model:
    beam = ROOT / "meshes/beam/beam.h5"
    if not beam.exists():
        write(beam, build(read_body(beam.with_suffix(".toml"))))
    return read_model(ROOT / "examples/case1.toml")


def case_1(folder: Path, repeats: int) -> None:
    model, step = case_1_model(), CASE_1_BAR.step
    cables = theirs({"ANCF cables": partial(rotor.cables, ELEMENTS, step)})
    exact = theirs({"geometrically exact beams": partial(rotor.exact_beams, ELEMENTS, step)})
    race("beam", [ours(model, "beam.tip"), *cables, *exact], repeats)

    body = CASE_1_BAR.body(folder)
    solid = replace(model.bodies["beam"], superelement=build(body))
    model = replace(model, bodies={**model.bodies, "beam": solid})
    bar = reduced_body(body, ["root"], MODES)
    reduced = theirs(
        {name: partial(rotor.reduced, bar, grip, step) for name, grip in grips(bar).items()}
    )
    race("solid", [ours(model, "beam.tip"), *reduced], repeats)


def whole_calls(repeats: int) -> None:
    """Case 1 from the model to its results in memory, start included.

    Ours records everything and ends Newton's method as models do; Exudyn builds its model, solves
    and records one tip, with its fastest beams, as many elements as ours and the loosest tolerance.
    """
    model, step = case_1_model(), CASE_1_BAR.step
    print("", "| Case 1, whole call | steps | CPU, us a step | clock | ratio |", sep="\n")
    print("|---|---|---|---|---|")
    for steps in (500, 5000):
        short = model.with_settings(t_end=steps * step)
        calls: dict[str, Callable[[], object]] = {
            "ours, everything recorded": partial(simulate, short),
            "ANCF cables, one tip": partial(
                rotor.cables, OUR_ELEMENTS, step, LOOSEST, steps * step
            ),
        }
        watches: dict[str, list[Stopwatch]] = {name: [] for name in calls}
        for _ in range(max(repeats, 7)):
            for name, call in calls.items():
                watch = Stopwatch()
                with watch.running():
                    call()
                watches[name].append(watch)
        own = 0.0
        for name, runs in watches.items():
            cpu, wall = (
                1e6 / steps * median(getattr(run, kind) for run in runs) for kind in ("cpu", "wall")
            )
            own = own or cpu
            print(f"| {name} | {steps} | {cpu:.1f} | {wall:.1f} | {cpu / own:.2f} |", flush=True)


def grips(bar: ReducedBody) -> dict[str, Callable[[float], Index]]:
    """The nodes that joints take hold of: as few nodes of a rigid end as it takes, or all
    of them.
    """
    return {
        "reduced body, joints on 4 nodes": bar.corners,
        f"reduced body, joints on {len(bar.section(0.0))}": bar.section,
    }


def chains(bar: Bar, numbers: Sequence[int], folder: Path, repeats: int) -> None:
    body = bar.body(folder)
    superelement = build(body)
    for n in numbers:
        # Where both ends have joints, six of the modes are the static ones of the second.
        reduced = reduced_body(body, ["root", "tip"][: min(n, 2)], MODES)
        end, their_end = (bar.step * max(steps // n, LEAST_STEPS) for steps in (STEPS, THEIR_STEPS))
        models = {
            name: partial(chain.chain, reduced, grip, n, bar.length, GRAVITY, their_end, bar.step)
            for name, grip in grips(reduced).items()
        }
        first = f"{n} of {bar.unknowns:,}".replace(",", " ")
        race(
            first,
            [ours(our_chain(superelement, n, end), f"bar{n - 1}.tip"), *theirs(models)],
            repeats,
        )


def our_chain(bar: Superelement, n: int, t_end: float) -> Model:
    root = bar.interface("root")
    starts = [
        Start(position=-root.X),
        *(Start(place=Place("root", f"bar{i}.tip")) for i in range(n - 1)),
    ]
    supports = ["ground", *(f"bar{i}.tip" for i in range(n - 1))]
    return Model(
        bodies={f"bar{i}": FlexibleBody(bar, start) for i, start in enumerate(starts)},
        joints=tuple(
            Revolute(support, f"bar{i}.root", [0, 0, 1], name=f"joint{i}")
            for i, support in enumerate(supports)
        ),
        gravity=GRAVITY,
        settings=Settings(t_end=t_end),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description="The cost of a step beside Exudyn.")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--large", action="store_true", help="a pendulum of 286 875 unknowns too")
    size.add_argument("--small", action="store_true", help="Case 1 and one bar alone")
    parser.add_argument("--repeats", type=int, default=3, help="of every measurement")
    chosen = parser.parse_args()
    packages = ("duhamel", "numba", "numpy", "exudyn")
    print(
        ", ".join(f"{name} {metadata.version(name)}" for name in packages),
        f"load {os.getloadavg()[0]:.1f}",
        sep=", ",
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole_calls(chosen.repeats)
        heading("Case 1")
        case_1(folder, chosen.repeats)
        if not chosen.small:
            heading("pendulum, unknowns")
        for bar in (MIDDLE, LARGE)[: 1 - chosen.small + chosen.large]:
            chains(bar, (1,), folder, chosen.repeats)
        heading("chain, unknowns")
        chains(SMALL, CHAINS[:1] if chosen.small else CHAINS, folder, chosen.repeats)


def heading(first: str) -> None:
    cells = [
        first,
        "",
        "CPU, us a step",
        "clock",
        "iterations",
        "tolerance",
        "left",
        "from ours",
        "ratio",
    ]
    print("", "| " + " | ".join(cells) + " |", "|" + "---|" * len(cells), sep="\n")


if __name__ == "__main__":
    main()
