"""CPU time of a step of contacts of surfaces, by nodes, closed rows and friction.

Cubes of steel of 10 mm, of n x n x n hexahedra, are pressed on a rigid plane or on another such
cube, half off it or wholly on it, by an acceleration of 2e5 m/s^2 from rest: they bounce, so that
rows close and open. One thread; without compilation, set-up and recording, that is, the time of a
run less that of one of 20 steps. Run as `python benchmarks/surface_steps.py [--only NAME]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import time
import warnings
from dataclasses import replace
from functools import cache

import duhamel as du
import numpy as np
import skfem
from duhamel.solver import Fixed, FlexibleBody, Frame, Model, Settings, Start, simulate
from duhamel.solver.couplings.surface_contacts import SurfaceContact

EDGE, STEP, GAP = 0.01, 2e-7, 1e-9
STEEL = du.Material(E=210e9, nu=0.3, rho=7800.0)
SHORT, LONG = 20, 400
"""steps of the runs of which the difference counts"""
SETTINGS = Settings(t_end=LONG * STEP, step=STEP, rho_inf=0.9)


@cache
def cube(n: int) -> du.Superelement:
    half = 0.5 * EDGE
    part = du.Part(skfem.MeshHex.init_tensor(*[np.linspace(-half, half, n + 1)] * 3), STEEL)
    part.surface("low", du.plane(z=-half))
    part.surface("top", du.plane(z=half))
    part.interface("side", du.plane(x=-half))
    return part.superelement(step=1e-6, band=4e5)


def pressed(element: du.Superelement, offset: float | None, friction: float) -> Model:
    """On a plane, or on another cube by an offset along x, over the edge."""
    more = {"friction": friction} if friction else {}
    height = 0.5 * EDGE if offset is None else EDGE
    place = [EDGE * (offset or 0.0), 0.0, height + GAP]
    bodies = {"cube": FlexibleBody(element, Start(place, velocity=[0.05, 0.0, 0.0]))}
    options = {"settings": SETTINGS, "gravity": (0.0, 0.0, -2e5)}
    if offset is None:
        contact = SurfaceContact(
            "pair", ["cube.low", "ground"], shape="plane", axis=[0.0, 0.0, 1.0], **more
        )
        return Model(bodies, surface_contacts=[contact], **options)
    bodies["other"] = FlexibleBody(element, Start())
    return Model(
        bodies,
        joints=[Fixed("ground.side", "other.side")],
        ground_frames={"side": Frame((-0.5 * EDGE, 0.0, 0.0))},
        surface_contacts=[
            SurfaceContact("pair", ["cube.low", "other.top"], geometry="flat", **more)
        ],
        **options,
    )


def measured(model: Model) -> tuple[float, float, int]:
    """CPU time of a step [ms], and the mean and the largest number of closed rows."""
    times = []
    for steps in (SHORT, SHORT, LONG):  # the first one compiles
        run = replace(model, settings=replace(SETTINGS, t_end=steps * STEP))
        start = time.process_time()
        results = simulate(run)
        times.append(time.process_time() - start)
    rows = results.surface_contact("pair").closed_rows
    return 1e3 * (times[2] - times[1]) / (LONG - SHORT), float(rows.mean()), int(rows.max())


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--only", default="", help="surfaces whose name has this")
    only = parser.parse_args().only
    warnings.simplefilter("ignore")
    print("| surfaces | friction | closed rows, mean and most | ms a step |")
    print("|---|---|---|---|")
    cases = (
        ("144 nodes on a plane", 11, None),
        ("324 nodes on a plane", 17, None),
        ("2 x 324 nodes, half off", 17, 0.53),
        ("2 x 324 nodes", 17, 0.0),
    )
    for name, n, offset in cases:
        if only not in name:
            continue
        for friction in (0.0, 0.3):
            cost, mean, most = measured(pressed(cube(n), offset, friction))
            print(f"| {name} | {friction:g} | {mean:.0f}, {most} | {cost:.2g} |", flush=True)


if __name__ == "__main__":
    main()
