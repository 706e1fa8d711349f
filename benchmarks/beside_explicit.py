"""Impacts of surfaces beside an explicit code of the same meshes: forces, and CPU time.

A domed block and a flat-ended rod of steel hit a rigid plane, and so does the housing of
meshes/housing, with all four feet at once and a finer mesh; a tooth of the gear of meshes/spur_gear
hits that of another one. The explicit code is our own: central differences with lumped masses, on
the stiffness of the same meshes, three by three blocks of one triangle of the matrix, compiled.
Both codes have a layer of the same stiffness per area; between teeth the explicit code has the
gaps of nodes to the facets that are opposite at the start. The superelement also runs without a
layer, with exact rows. CPU time of one thread, least of repeats in which the codes take turns,
without compilation. That of `simulate` has set-up and recording, that of its loop is less that of a
run of one step; the explicit code is timed in its loop alone. The last row is a run 40 times as
long, in which the body flies and rings after the impact; the explicit time is then extrapolated.
Run as `python benchmarks/beside_explicit.py [--repeats N] [--cases NAME ...]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial, reduce
from pathlib import Path
from typing import Any

import duhamel as du
import numpy as np
from duhamel.solver import FlexibleBody, Model, Settings, Start, ValidityWarning, simulate
from duhamel.solver.couplings.surface_contacts import SurfaceContact

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))  # for the parts of surfaces
from surfaces.cases import GAP, SPEED, Array, Case, cases
from surfaces.explicit import Run, both, gaps_of, mesh_of, run_explicit

SMOOTHED = 2e-7
"""[s] over which the force of the explicit code is averaged, before it is compared"""
RHO_INF = 0.9
LONGER = 40
"""duration of the long run over that of the impact"""


def run_superelement(
    case: Case, elements: list[du.Superelement], step: float, layer: float | None, t_end: float
) -> Run:
    lowest = elements[0].surface(case.surface).X[:, 2].min()
    places = [element.center for element in elements]
    if len(elements) == 1:
        places = [np.array([0.0, 0.0, GAP - lowest])]
    speeds = [SPEED * np.array(case.way), np.zeros(3)]
    bodies = {
        f"body_{i}": FlexibleBody(element, Start(position=X, velocity=v))
        for i, (element, X, v) in enumerate(zip(elements, places, speeds, strict=False))
    }
    first = f"body_0.{case.surface}"
    law: dict[str, Any] = {"name": "wall", "layer": layer}
    if len(elements) == 1:
        axis = np.array([0.0, 0.0, 1.0])
        contact = SurfaceContact(surfaces=(first, "ground"), shape="plane", axis=axis, **law)
    else:
        contact = SurfaceContact(surfaces=(first, f"body_1.{case.surface}"), **law)
    model = Model(
        bodies=bodies,
        surface_contacts=(contact,),
        settings=Settings(t_end=t_end, step=step, rho_inf=RHO_INF),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # of runs shorter than a few periods
        begin = time.process_time()
        results = simulate(model)
        cpu = time.process_time() - begin
    force = elements[0].mass * results.body("body_0").acceleration
    return Run(results.time, np.linalg.norm(force, axis=1), cpu)


def smoothed(run: Run, over: float, times: Array) -> Array:
    """The force at times, as the mean of the interval `over` around each."""
    impulse = np.concatenate([[0.0], np.cumsum(run.force) * run.time[1]])
    edges = run.time[1] * (np.arange(len(impulse)) - 0.5)
    after, before = (np.interp(times + s * 0.5 * over, edges, impulse) for s in (1.0, -1.0))
    result: Array = (after - before) / over
    return result


def difference(run: Run, explicit: Run) -> float:
    reference = smoothed(explicit, SMOOTHED, run.time)
    return float(np.linalg.norm(run.force - reference) / np.linalg.norm(reference))


def least(repeats: int, *measure: Callable[[], Run]) -> list[Run]:
    """The runs of each function, with the least CPU time of repeats in turns."""
    rounds = [[one() for one in measure] for _ in range(repeats + 1)][1:]  # the first loads code
    return [min(runs, key=lambda run: run.cpu) for runs in zip(*rounds, strict=True)]


def main(repeats: int, chosen: list[str]) -> None:
    for case in cases():
        if chosen and case.name not in chosen:
            continue
        begin = time.process_time()
        elements = [part.superelement(step=case.steps[0], band=case.band) for part in case.parts]
        made = time.process_time() - begin
        meshes = [mesh_of(part) for part in case.parts]
        n_first, mesh = len(meshes[0].mass) // 3, reduce(both, meshes)
        gaps = gaps_of(case, elements, n_first)
        modes = sum(len(element.modes.omega) for element in elements if element.modes)
        runs = [(h, layer) for layer in (case.layer, None) for h in case.steps]
        first = runs[0]

        def ours(h: float, layer: float | None, t_end: float) -> Callable[[], Run]:
            return partial(run_superelement, case, elements, h, layer, t_end)  # noqa: B023

        explicit, *impacts = least(
            repeats,
            partial(run_explicit, case, mesh, gaps, n_first),
            *(ours(h, layer, case.t_end) for h, layer in runs),
            *(ours(h, layer, h) for h, layer in runs),
            ours(*first, LONGER * case.t_end),
        )
        long_run = impacts.pop()
        starts = impacts[len(runs) :]
        n = len(explicit.time)
        top = smoothed(explicit, SMOOTHED, explicit.time).max()
        print(
            f"{case.name}: {len(mesh.mass)} unknowns, {len(gaps.nodes)} nodes of the surface, "
            f"{modes} modes to {case.band:.3g} Hz, layer {case.layer:.3g} N/m3; "
            f"preprocessing {made:.1f} s\n\n"
            "| | step [us] | steps | peak [N] | impulse [N s] | L2 difference | simulate [ms] | "
            "ratio | loop [ms] | ratio |\n|---|---|---|---|---|---|---|---|---|---|\n"
            f"| explicit | {1e6 * explicit.time[1]:.4f} | {n} | {explicit.force.max():.1f}, "
            f"smoothed {top:.1f} | {explicit.impulse:.6f} | | | | {1e3 * explicit.cpu:.0f} "
            f"({1e6 * explicit.cpu / n:.0f} us a step) | |"
        )
        for (h, layer), run, start in zip(runs, impacts, starts, strict=False):
            law = "exact" if layer is None else "layer"
            print(
                f"| superelement, {law} | {1e6 * h:.4f} | {len(run.time) - 1} | "
                f"{run.force.max():.1f} | {run.impulse:.6f} | {difference(run, explicit):.1e} | "
                + costs(run, start, explicit.cpu)
            )
        print(
            f"| the first, {LONGER} times as long | {1e6 * first[0]:.4f} | "
            f"{len(long_run.time) - 1} | | | | "
            + costs(long_run, starts[0], LONGER * explicit.cpu)
            + "\n"
        )


def costs(run: Run, start: Run, explicit: float) -> str:
    """Cells of CPU times [ms], and how many times as long the explicit code takes."""
    loop = run.cpu - start.cpu
    return (
        f"{1e3 * run.cpu:.1f} | {explicit / run.cpu:.0f} | {1e3 * loop:.1f} "
        f"({1e6 * loop / (len(run.time) - 2):.0f} us a step) | {explicit / loop:.0f} |"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--cases", nargs="*", default=[])
    main(parser.parse_args().repeats, parser.parse_args().cases)
