"""Impacts of surfaces beside an explicit code of the same meshes: forces, and CPU time.

A domed block and a flat-ended rod of steel hit a rigid plane, and so does the housing of
meshes/housing, with all four feet at once and a finer mesh. The explicit code is our own: central
differences with lumped masses, on the stiffness of the same mesh, three by three blocks of one
triangle of the matrix, compiled. Both codes have the same law on the same nodes: a layer of a
stiffness per area. The superelement also runs without a layer, with exact rows. CPU time of one
thread, least of repeats in which the codes take turns, without compilation. That of `simulate` has
set-up and recording, that of its loop is less that of a run of one step; the explicit code is timed
in its loop alone. The last row is a run 40 times as long, in which the body flies and rings after
the impact; the explicit time is then extrapolated. Run as
`python benchmarks/beside_explicit.py [--repeats N] [--cases NAME ...]`.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import argparse
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import duhamel as du
import numba
import numpy as np
import skfem
from duhamel.preprocess import assemble
from duhamel.solver import FlexibleBody, Model, Settings, Start, ValidityWarning, simulate
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from numpy.typing import NDArray
from scipy.sparse import bsr_array, diags_array
from scipy.sparse.linalg import eigsh

sys.path.insert(0, str(Path(__file__).parents[1] / "meshes" / "housing"))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
import make_mesh
from surface_bodies import STEEL, dome

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PLASTIC = du.Material(E=2.4e9, nu=0.35, rho=1100.0)
SPEED = 1.0
"""of the impacts [m/s]"""
GAP = 1e-6
"""at the start [m]"""
COURANT = 0.9
"""step of the explicit code over the largest stable one"""
SMOOTHED = 2e-7
"""[s] over which its force is averaged, before it is compared"""
RHO_INF = 0.9
LONGER = 40
"""duration of the long run over that of the impact"""


@dataclass(frozen=True)
class Case:
    """A part with one surface that falls along -z, the layer [N/m^3], and the runs."""

    name: str
    part: du.Part
    surface: str
    band: float
    layer: float
    t_end: float
    steps: tuple[float, ...]
    """of the superelement [s], the shortest first"""


@dataclass(frozen=True, eq=False)
class Run:
    """Force (n,) [N] at times (n,) [s], CPU time [s] and number of steps."""

    time: Array
    force: Array
    cpu: float

    @property
    def impulse(self) -> float:
        return float(np.trapezoid(self.force, self.time))


@dataclass(frozen=True, eq=False)
class Mesh:
    """The lower triangle of K in blocks (n, 3, 3), their columns and row starts, masses (3N,) of
    the dofs, and the nodes of the surface, with their heights over its lowest point and areas.
    """

    blocks: Array
    columns: Index
    starts: Index
    mass: Array
    nodes: Index
    height: Array
    area: Array
    stable: float
    """largest stable step [s]"""


def cases() -> Iterator[Case]:
    yield Case(
        "domed block",
        dome(8e-5, 7, 6, 5.6e-4),
        "dome",
        band=4e5,
        layer=3e15,
        t_end=2.6e-5,
        steps=(2.5e-7, 1e-6),
    )
    across, along = np.linspace(-0.005, 0.005, 9), np.linspace(0.0, 0.15, 121)
    rod = du.Part(skfem.MeshHex.init_tensor(across, across, along), STEEL, name="rod")
    rod.surface("end", du.plane(z=0.0))
    size, speed = along[1], float(np.sqrt(STEEL.E / STEEL.rho))
    step = size / speed
    yield Case(
        "flat-ended rod",
        rod,
        "end",
        band=3.5e5,
        layer=STEEL.rho * speed / (3.0 * step),
        t_end=9e-5,
        steps=(step,),
    )
    mesh = make_mesh.housing(fine=7.7e-4, coarse=2e-3)
    housing = du.Part(mesh, PLASTIC, name="housing")
    housing.surface("soles", du.box([0.0, 0.0, -0.007], [0.1, 0.07, -0.005]))
    yield Case("housing", housing, "soles", band=2e4, layer=1e13, t_end=1e-3, steps=(2.5e-6, 5e-6))


def mesh_of(part: du.Part, element: du.Superelement) -> Mesh:
    structure = assemble(part.body(step=1e-6, band=1e5))
    order = structure.nodes.displacements.ravel()
    K = bsr_array(structure.K.tocsr()[order][:, order], blocksize=(3, 3))
    K.sort_indices()
    mass = np.asarray(structure.M.sum(axis=1)).ravel()[order]
    root = diags_array(1.0 / np.sqrt(mass))
    largest = eigsh(root @ K @ root, 1, which="LM", return_eigenvectors=False, tol=1e-4)[0]
    rows = np.repeat(np.arange(len(K.indptr) - 1), np.diff(K.indptr))
    lower = K.indices <= rows
    assert element.surfaces is not None
    (surface,) = element.surfaces.patches
    height = surface.X[:, 2]
    return Mesh(
        np.ascontiguousarray(K.data[lower]),
        K.indices[lower].astype(np.int64),
        np.concatenate([[0], np.cumsum(np.bincount(rows[lower]))]),
        mass,
        np.asarray(surface.nodes, dtype=np.int64),
        height - height.min(),
        node_areas(surface.X, surface.facets),
        float(2.0 / np.sqrt(largest)),
    )


def node_areas(X: Array, facets: Index) -> Array:
    """The part of each node of the area of its bilinear facets: int N dA, by 2 x 2 points."""
    areas = np.zeros(len(X))
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for point in signs / np.sqrt(3.0):
        N = np.prod(1.0 + signs * point, axis=1) / 4.0
        dN = signs * (1.0 + signs * point)[:, ::-1] / 4.0
        tangents = np.einsum("kd,fkx->fdx", dN, X[facets])
        weights = np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
        np.add.at(areas, facets, weights[:, None] * N)
    return areas


@numba.njit(fastmath=True)
def central_differences(
    blocks: Array,
    columns: Index,
    starts: Index,
    step: float,
    factor: Array,
    nodes: Index,
    height: Array,
    stiffness: Array,
    u: Array,
    v: Array,
    force: Array,
) -> None:
    """Fill force (n,) with the force of the plane before each step; factor: step / mass."""
    f = np.zeros_like(u)
    for n in range(len(force)):
        f[:] = 0.0
        for i in range(len(starts) - 1):
            a, b, c = u[i, 0], u[i, 1], u[i, 2]
            x = y = z = 0.0
            last = starts[i + 1] - 1
            for k in range(starts[i], last):
                j, K = columns[k], blocks[k]
                d, e, g = u[j, 0], u[j, 1], u[j, 2]
                x += K[0, 0] * d + K[0, 1] * e + K[0, 2] * g
                y += K[1, 0] * d + K[1, 1] * e + K[1, 2] * g
                z += K[2, 0] * d + K[2, 1] * e + K[2, 2] * g
                f[j, 0] += K[0, 0] * a + K[1, 0] * b + K[2, 0] * c
                f[j, 1] += K[0, 1] * a + K[1, 1] * b + K[2, 1] * c
                f[j, 2] += K[0, 2] * a + K[1, 2] * b + K[2, 2] * c
            K = blocks[last]  # of the node itself
            f[i, 0] += x + K[0, 0] * a + K[0, 1] * b + K[0, 2] * c
            f[i, 1] += y + K[1, 0] * a + K[1, 1] * b + K[1, 2] * c
            f[i, 2] += z + K[2, 0] * a + K[2, 1] * b + K[2, 2] * c
        total = 0.0
        for k in range(len(nodes)):
            depth = -(height[k] + u[nodes[k], 2])
            if depth > 0.0:
                push = stiffness[k] * depth
                f[nodes[k], 2] -= push
                total += push
        force[n] = total
        for i in range(len(u)):
            for x in range(3):
                v[i, x] -= factor[i, x] * f[i, x]
                u[i, x] += step * v[i, x]


def run_explicit(case: Case, mesh: Mesh) -> Run:
    step = COURANT * mesh.stable
    n = round(case.t_end / step)
    cpu = 0.0
    for count in (0, n):  # none first, which compiles
        u, v = np.zeros((2, len(mesh.mass) // 3, 3))
        v[:, 2] = -SPEED
        force = np.zeros(count)
        begin = time.process_time()
        central_differences(
            mesh.blocks,
            mesh.columns,
            mesh.starts,
            step,
            step / mesh.mass.reshape(-1, 3),
            mesh.nodes,
            mesh.height + GAP,
            case.layer * mesh.area,
            u,
            v,
            force,
        )
        cpu = time.process_time() - begin
    return Run(step * np.arange(n), force, cpu)


def run_superelement(
    case: Case, element: du.Superelement, step: float, layer: float | None, t_end: float
) -> Run:
    assert element.surfaces is not None
    (surface,) = element.surfaces.patches
    start = Start(
        position=np.array([0.0, 0.0, GAP - surface.X[:, 2].min()]),
        velocity=np.array([0.0, 0.0, -SPEED]),
    )
    contact = SurfaceContact(
        name="wall",
        surfaces=(f"body.{case.surface}", "ground"),
        shape="plane",
        axis=np.array([0.0, 0.0, 1.0]),
        layer=layer,
    )
    model = Model(
        bodies={"body": FlexibleBody(element, start)},
        surface_contacts=(contact,),
        settings=Settings(t_end=t_end, step=step, rho_inf=RHO_INF),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)  # of runs shorter than a few periods
        begin = time.process_time()
        results = simulate(model)
        cpu = time.process_time() - begin
    return Run(results.time, element.mass * results.body("body").acceleration[:, 2], cpu)


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
        element = case.part.superelement(step=case.steps[0], band=case.band)
        made = time.process_time() - begin
        mesh = mesh_of(case.part, element)
        assert element.surfaces is not None
        assert element.modes is not None
        runs = [(h, layer) for layer in (case.layer, None) for h in case.steps]
        first = runs[0]

        def ours(h: float, layer: float | None, t_end: float) -> Callable[[], Run]:
            return partial(run_superelement, case, element, h, layer, t_end)  # noqa: B023

        explicit, *impacts = least(
            repeats,
            partial(run_explicit, case, mesh),
            *(ours(h, layer, case.t_end) for h, layer in runs),
            *(ours(h, layer, h) for h, layer in runs),
            ours(*first, LONGER * case.t_end),
        )
        long_run = impacts.pop()
        starts = impacts[len(runs) :]
        n = len(explicit.time)
        top = smoothed(explicit, SMOOTHED, explicit.time).max()
        print(
            f"{case.name}: {len(mesh.mass)} unknowns, {len(mesh.nodes)} nodes of the surface, "
            f"{len(element.modes.omega)} modes to {case.band:.3g} Hz, layer {case.layer:.3g} N/m3; "
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
