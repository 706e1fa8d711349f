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
import math
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial, reduce
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import duhamel as du
import meshio
import numba
import numpy as np
import skfem
from duhamel.preprocess import assemble
from duhamel.solver import FlexibleBody, Model, Settings, Start, ValidityWarning, simulate
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from numpy.typing import NDArray
from scipy.sparse import bsr_array, diags_array
from scipy.sparse.linalg import eigsh

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from surface_bodies import STEEL, dome, graded

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
FINE, CONTACT = 8e-6, 10
"""of the flanks of teeth where they meet: size of facets [m], how many there are to each side"""
LONGER = 40
"""duration of the long run over that of the impact"""


def script(folder: str) -> ModuleType:
    """The script that makes the mesh of an example."""
    path = Path(__file__).parents[1] / "meshes" / folder / "make_mesh.py"
    spec = spec_from_file_location(folder, path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@dataclass(frozen=True)
class Case:
    """Parts with one surface each, of which the first moves along a way, and the runs.

    It meets a plane across its way, or the second part, which is at rest.
    """

    name: str
    parts: tuple[du.Part, ...]
    surface: str
    band: float
    layer: float
    """[N/m^3]"""
    t_end: float
    steps: tuple[float, ...]
    """of the superelements [s], the shortest first"""
    way: tuple[float, float, float] = (0.0, 0.0, -1.0)


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
    the dofs, and the largest stable step [s]; of several parts one after the other.
    """

    blocks: Array
    columns: Index
    starts: Index
    mass: Array
    stable: float


@dataclass(frozen=True, eq=False)
class Gaps:
    """The gaps (m,) between nodes and what is opposite: g = gap + n . (u_node - sum_j w_j u_j).

    nodes (m,); opposite (m, k) nodes with weights (m, k), none of a plane; normal (m, 3); areas
    (m,) of the nodes.
    """

    nodes: Index
    gap: Array
    normal: Array
    opposite: Index
    weights: Array
    area: Array


def cases() -> Iterator[Case]:
    yield Case(
        "domed block",
        (dome(8e-5, 7, 6, 5.6e-4),),
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
        (rod,),
        "end",
        band=3.5e5,
        layer=STEEL.rho * speed / (3.0 * step),
        t_end=9e-5,
        steps=(step,),
    )
    mesh = script("housing").housing(fine=7.7e-4, coarse=2e-3)
    housing = du.Part(mesh, PLASTIC, name="housing")
    housing.surface("soles", du.box([0.0, 0.0, -0.007], [0.1, 0.07, -0.005]))
    yield Case(
        "housing", (housing,), "soles", band=2e4, layer=1e13, t_end=1e-3, steps=(2.5e-6, 5e-6)
    )
    teeth, way = gear_teeth()
    yield Case(
        "gear teeth",
        teeth,
        "flank",
        band=4e5,
        layer=3e14,
        t_end=4e-5,
        steps=(1.25e-7, 2.5e-7),
        way=way,
    )


def gear_teeth() -> tuple[tuple[du.Part, du.Part], tuple[float, float, float]]:
    """A tooth of each of two gears in mesh, `GAP` apart on the line of action, and its direction.

    The upper flank of a tooth on the line of centers meets the next tooth of the other gear, a
    quarter of the base pitch from the pitch point.
    """
    gear = script("spur_gear")
    angle, pitch = gear.PRESSURE_ANGLE, 2.0 * np.pi / gear.TEETH
    way = np.array([np.sin(angle), np.cos(angle)])
    place = np.array([gear.PITCH, 0.0]) + 0.25 * pitch * gear.BASE * way
    center = np.array([gear.CENTERS, 0.0])
    radii = np.linalg.norm([place, place - center], axis=1)
    # Half the backlash is between these flanks; the second tooth comes up to the gap.
    shift = center - (0.5 * gear.BACKLASH - GAP) * way
    parts = (
        tooth(gear, radii[0], 0.0, np.zeros(2), 8),
        tooth(gear, radii[1], np.pi - 0.5 * pitch, shift, 7),
    )
    return parts, (float(way[0]), float(way[1]), 0.0)


def tooth(gear: ModuleType, radius: float, turn: float, shift: Array, layers: int) -> du.Part:
    """A tooth on its part of the rim, turned about z and then shifted (2,).

    Finer at a radius of the flank at positive angles.
    """
    below = radius - graded(FINE, CONTACT, 1.5, radius - gear.ROOT)[:0:-1]
    above = radius + graded(FINE, CONTACT, 1.5, gear.TIP - radius)
    r = np.concatenate([np.linspace(gear.BORE, gear.ROOT, 7)[:-1], below, above])[:, None]
    half = gear.half_angle(np.maximum(r, gear.ROOT))
    s = 1.0 - graded(1.5 * FINE, CONTACT, 1.5, 2.0 * gear.MODULE)[::-1] / gear.MODULE
    grid = gear.polar(*np.broadcast_arrays(r, half * s)).reshape(-1, 2)
    numbers = np.arange(len(grid)).reshape(len(r), len(s))
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    quads = np.stack(corners, axis=2).reshape(-1, 4)
    # Above the root.
    side = numbers[np.searchsorted(r[:, 0], gear.ROOT) :, -1]
    edges = np.column_stack([side[:-1], side[1:]])
    c, s = np.cos(turn), np.sin(turn)
    flat = grid @ np.array([[c, s], [-s, c]]) + shift
    heights = np.linspace(-0.5 * gear.WIDTH, 0.5 * gear.WIDTH, layers + 1)
    n = len(flat)
    solid = np.concatenate([np.column_stack([flat, np.full(n, z)]) for z in heights])
    levels = n * np.arange(layers)[:, None, None]
    bricks = (levels + np.hstack([quads, quads + n])).reshape(-1, 8)
    sides = (levels + np.column_stack([edges, edges[:, ::-1] + n])).reshape(-1, 4)
    mesh = meshio.Mesh(
        solid,
        [("hexahedron", bricks), ("quad", sides)],
        cell_sets={"flank": [np.empty(0, dtype=np.int64), np.arange(len(sides))]},
    )
    part = du.Part(mesh, STEEL, name="tooth")
    part.surface("flank", du.group("flank"))
    return part


def mesh_of(part: du.Part) -> Mesh:
    structure = assemble(part.body(step=1e-6, band=1e5))
    order = structure.nodes.displacements.ravel()
    K = bsr_array(structure.K.tocsr()[order][:, order], blocksize=(3, 3))
    K.sort_indices()
    mass = np.asarray(structure.M.sum(axis=1)).ravel()[order]
    root = diags_array(1.0 / np.sqrt(mass))
    largest = eigsh(root @ K @ root, 1, which="LM", return_eigenvectors=False, tol=1e-4)[0]
    rows = np.repeat(np.arange(len(K.indptr) - 1), np.diff(K.indptr))
    lower = K.indices <= rows
    return Mesh(
        np.ascontiguousarray(K.data[lower]),
        K.indices[lower].astype(np.int64),
        np.concatenate([[0], np.cumsum(np.bincount(rows[lower]))]),
        mass,
        float(2.0 / np.sqrt(largest)),
    )


def both(first: Mesh, second: Mesh) -> Mesh:
    """Two bodies as one mesh."""
    n, blocks = len(first.mass) // 3, len(first.blocks)
    return Mesh(
        np.concatenate([first.blocks, second.blocks]),
        np.concatenate([first.columns, second.columns + n]),
        np.concatenate([first.starts, second.starts[1:] + blocks]),
        np.concatenate([first.mass, second.mass]),
        min(first.stable, second.stable),
    )


def gaps_of(case: Case, elements: list[du.Superelement], n_first: int) -> Gaps:
    """n_first: nodes of the first mesh."""
    first = elements[0].surface(case.surface)
    m, area = first.n, node_areas(first.X, first.facets)
    nodes = np.asarray(first.nodes, dtype=np.int64)
    if len(elements) == 1:
        height = first.X[:, 2] - first.X[:, 2].min() + GAP
        normal = np.tile([0.0, 0.0, 1.0], (m, 1))
        return Gaps(nodes, height, normal, np.empty((m, 0), dtype=np.int64), np.empty((m, 0)), area)
    second = elements[1].surface(case.surface)
    X, Y = first.X + elements[0].center, second.X + elements[1].center
    # Bilinear facets of cylinders, of which the nearest is opposite.
    found = [nearest(x, Y[facet]) for x in X for facet in second.facets]
    gap, normal, weights = (np.array(values) for values in zip(*found, strict=True))
    chosen = np.arange(m), np.abs(gap).reshape(m, -1).argmin(axis=1)
    return Gaps(
        nodes,
        gap.reshape(m, -1)[chosen],
        normal.reshape(m, -1, 3)[chosen],
        second.nodes[second.facets[chosen[1]]] + n_first,
        weights.reshape(m, -1, 4)[chosen],
        area,
    )


def nearest(x: Array, corners: Array) -> tuple[float, Array, Array]:
    """Gap of a point over a rectangle, its normal and the weights of its corners (4,).

    The gap is infinite where the foot is outside.
    """
    along, across = corners[1] - corners[0], corners[3] - corners[0]
    normal = np.cross(along, across)
    normal /= np.linalg.norm(normal)
    s, t = ((x - corners[0]) @ edge / (edge @ edge) for edge in (along, across))
    weights = np.array([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
    inside = min(s, t, 1.0 - s, 1.0 - t) > -1e-9
    return float(normal @ (x - corners[0])) if inside else np.inf, normal, weights


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
    gap: Array,
    normal: Array,
    opposite: Index,
    weights: Array,
    stiffness: Array,
    u: Array,
    v: Array,
    force: Array,
) -> None:
    """Fill force (n,) with that on the first body before each step; factor: step / mass."""
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
        x = y = z = 0.0
        for k in range(len(nodes)):
            i, depth = nodes[k], -gap[k]
            for c in range(3):
                moved = u[i, c]
                for j in range(opposite.shape[1]):
                    moved -= weights[k, j] * u[opposite[k, j], c]
                depth -= normal[k, c] * moved
            if depth > 0.0:
                push = stiffness[k] * depth
                for c in range(3):
                    f[i, c] -= push * normal[k, c]
                    for j in range(opposite.shape[1]):
                        f[opposite[k, j], c] += weights[k, j] * push * normal[k, c]
                x += push * normal[k, 0]
                y += push * normal[k, 1]
                z += push * normal[k, 2]
        force[n] = math.sqrt(x * x + y * y + z * z)
        for i in range(len(u)):
            for x in range(3):
                v[i, x] -= factor[i, x] * f[i, x]
                u[i, x] += step * v[i, x]


def run_explicit(case: Case, mesh: Mesh, gaps: Gaps, n_first: int) -> Run:
    step = COURANT * mesh.stable
    n = round(case.t_end / step)
    cpu = 0.0
    for count in (0, n):  # none first, which compiles
        u, v = np.zeros((2, len(mesh.mass) // 3, 3))
        v[:n_first] = SPEED * np.array(case.way)
        force = np.zeros(count)
        begin = time.process_time()
        central_differences(
            mesh.blocks,
            mesh.columns,
            mesh.starts,
            step,
            step / mesh.mass.reshape(-1, 3),
            gaps.nodes,
            gaps.gap,
            gaps.normal,
            gaps.opposite,
            gaps.weights,
            case.layer * gaps.area,
            u,
            v,
            force,
        )
        cpu = time.process_time() - begin
    return Run(step * np.arange(n), force, cpu)


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
