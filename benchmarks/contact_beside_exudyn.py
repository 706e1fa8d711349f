"""Impacts beside Exudyn's contact elements: forces, and the cost of a step.

A rod on a wall and Timoshenko's sphere on a beam, in Exudyn of ANCF cables with
`ObjectContactCoordinate`, of as many elements as our superelements have; a solid bar of steel whose
end, a ball, meets a ball of the ground, in Exudyn a body in a floating frame on modes of Hurty,
Craig and Bampton with `ObjectContactSphereSphere`, on four nodes of the end. Both have the same
laws, steps and generalized-alpha of spectral radius 0.9, and a tolerance of Newton's method that
leaves forces within 1e-3. CPU time of a step on one thread, medians of repeats in which the codes
take turns; ours records everything, Exudyn what the force follows from. Needs the extra
`validation`. Run as `python benchmarks/contact_beside_exudyn.py [--repeats N]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib import metadata
from pathlib import Path
from statistics import median

from duhamel.preprocess import build
from duhamel.solver import ValidityWarning, simulate
from impact import exact, models
from impact.bodies import reducible_beam, reducible_rod
from impact.exact import Array, Rod, timoshenko

sys.path.insert(0, str(Path(__file__).parents[1]))
from peer import impacts
from peer.bar import Bar
from peer.reduced_body import reduced_body
from peer.run import Run, Stopwatch

ROD = Rod(length=1.0, EA=2.1e11 * 1e-4, mass_per_length=7800.0 * 1e-4)
ROD_ELEMENTS, BEAM_ELEMENTS = 160, 40
SPEED = 1.0
STEPS = 5000
"""of both codes: the impact and what follows; a shorter run is no measure of cost"""
BEAM_STEP, CASES = 1e-6, (1, 2)
TOLERANCE = 1e-7
"""of Exudyn's Newton's method, which leaves forces within 1e-3"""
STEEL = {"E": 2.1e11, "nu": 0.3, "rho": 7800.0}
BAR = Bar(0.5, 0.06, (24, 3, 3), STEEL, step=4e-6)
RADII = (0.05, 0.05)
"""of the ball at the end of the bar, and of that on the ground [m]"""
MODES = (8, 16, 32, 64)
"""of Exudyn's reduced bodies"""


@dataclass(frozen=True, eq=False)
class Impacted:
    """Microseconds of CPU and iterations a step; the force (n,) [N] at the times (n,) [s]."""

    cpu: float
    iterations: float
    time: Array
    force: Array


Entrant = Callable[[], Impacted]


def ours(blow: models.Blow, t_end: float) -> Impacted:
    """The cost of the steps: of a run less that of one of a single step."""
    start, whole = Stopwatch(), Stopwatch()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        with start.running():
            simulate(blow.model.with_settings(t_end=1e-9))
        with whole.running():
            results = simulate(blow.model.with_settings(t_end=t_end))
    steps = len(results.time) - 2
    force = results.contact(models.TOUCH).force[:, 0]
    cpu = 1e6 * (whole.cpu - start.cpu) / steps
    return Impacted(cpu, float(results.iterations[1:].mean()), results.time, force)


def theirs(run: Callable[[], tuple[Run, Array]]) -> Impacted:
    found, force = run()
    return Impacted(found.cpu, found.iterations, found.time, force)


def race(title: str, entrants: Mapping[str, Entrant], repeats: int) -> None:
    """A row for each, ours first; before it counts every one has run once."""
    for entrant in entrants.values():
        entrant()
    rounds = [[entrant() for entrant in entrants.values()] for _ in range(repeats)]
    own = median(turn[0].cpu for turn in rounds)
    for name, runs in zip(entrants, zip(*rounds, strict=True), strict=True):
        found = exact.contacts(runs[0].time, runs[0].force)
        cpu = median(run.cpu for run in runs)
        cells = [
            title,
            name,
            f"{max(blow.peak for blow in found):.5g} N",
            f"{sum(blow.impulse for blow in found):.5g} N s",
            str(len(found)),
            f"{runs[0].iterations:.1f}",
            f"{cpu:.1f}",
            f"{cpu / own:.1f}",
        ]
        print("| " + " | ".join(cells) + " |", flush=True)


def rod_entrants() -> dict[str, Entrant]:
    answer, h = exact.rod_on_wall(ROD, SPEED), models.rod_step(ROD, ROD_ELEMENTS)
    element = reducible_rod(ROD, ROD_ELEMENTS).whole
    blow = models.rod_on_wall(ROD, element, answer, SPEED, h, models.RHO_INF)
    K = models.rod_contact(ROD.impedance, h).stiffness
    t_end = STEPS * h
    cables = partial(impacts.rod_on_wall, ROD, ROD_ELEMENTS, SPEED, K, h, t_end, TOLERANCE)
    return {"ours": partial(ours, blow, t_end), "ANCF cables": partial(theirs, cables)}


def beam_entrants(case: int) -> dict[str, Entrant]:
    impact, t_end = timoshenko(case), STEPS * BEAM_STEP
    element = reducible_beam(impact, BEAM_ELEMENTS).whole
    blow = models.sphere_on_beam(impact, element, t_end, BEAM_STEP)
    cables = partial(impacts.sphere_on_beam, impact, BEAM_ELEMENTS, BEAM_STEP, t_end, TOLERANCE)
    return {"ours": partial(ours, blow, t_end), "ANCF cables": partial(theirs, cables)}


def bar_entrants(folder: Path) -> Iterator[tuple[str, Entrant]]:
    body = BAR.body(folder)
    h, area = BAR.step, BAR.side**2
    rod = Rod(BAR.length, STEEL["E"] * area, STEEL["rho"] * area)
    K = rod.impedance / (models.RISE * h)
    t_end = STEPS * h
    blow = models.bar_on_sphere(build(body), RADII, SPEED, K, t_end, h)
    yield "ours", partial(ours, blow, t_end)
    for modes in MODES:
        bar = reduced_body(body, ["tip"], modes)
        run = partial(impacts.bar_on_sphere, bar, BAR.length, RADII, SPEED, K, h, t_end, TOLERANCE)
        yield f"reduced body, {modes} modes", partial(theirs, run)


def main() -> None:
    parser = argparse.ArgumentParser(description="Impacts beside Exudyn's contact elements.")
    parser.add_argument("--repeats", type=int, default=5, help="of every measurement")
    chosen = parser.parse_args()
    packages = ("duhamel", "numba", "numpy", "exudyn")
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in packages)
    print(versions, f"load {os.getloadavg()[0]:.1f}", sep=", ")
    head = ["impact", "", "peak", "impulse", "blows", "iterations", "CPU, us a step", "ratio"]
    print("", "| " + " | ".join(head) + " |", "|" + "---|" * len(head), sep="\n")
    race("rod on a wall", rod_entrants(), chosen.repeats)
    for case in CASES:
        race(f"sphere on beam, case {case}", beam_entrants(case), chosen.repeats)
    with tempfile.TemporaryDirectory() as name:
        race("solid bar on a ball", dict(bar_entrants(Path(name))), chosen.repeats)


if __name__ == "__main__":
    main()
