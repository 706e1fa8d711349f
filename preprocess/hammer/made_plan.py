"""A plan for a hammer test of a mesh: sensors and hits around its interfaces, and a few elsewhere.

Around an interface the hits are those, one after the other, that add most to the determinant of
W^T W, W (n, 6) their wrenches with lengths over the reach of the interface (D-optimal designs: V.
V. Fedorov, Theory of Optimal Experiments, Academic Press, 1972); sensors likewise, by the motions
that they read. The reach grows until both tell all six motions well.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...files.arrays import Array, IntArray
from ..assembly.interfaces import Attachment
from ..errors import MeasurementError
from ..measured.coordinates import rigid_rows, space_rows
from ..mesh.mesh import NO_NODES
from ..sources.solids import SolidSource

SENSORS_OF_INTERFACE, HITS_OF_INTERFACE = 3, 9
FURTHER_SENSORS, FURTHER_HITS = 2, 3
REACH_AT_FIRST, REACH_GROWS_BY = 1.2, 1.25
"""of the farthest node of an interface, for sensors and hits beside it"""
LARGEST_CONDITION_OF_PLAN = 20.0
"""of wrenches and motions with lengths over the reach; errors of places grow with it"""


@dataclass(frozen=True, eq=False)
class FacetMiddles:
    """Middles of facets (n, 3) [m] on the surface of a mesh, and unit normals (n, 3) into it."""

    points: Array
    inwards: Array


@dataclass(frozen=True, eq=False)
class PlannedInterface:
    """The points of sensors and hits around an interface, which is at (3,) [m]."""

    at: Array
    sensors: IntArray
    hits: IntArray


@dataclass(frozen=True, eq=False)
class MadePlan:
    """Where a part is to be measured and hit.

    interfaces by name; sensors and hits: further points of the surface.
    """

    surface: FacetMiddles
    interfaces: dict[str, PlannedInterface]
    sensors: IntArray
    hits: IntArray


def made_plan(source: SolidSource, frames: Mapping[str, Attachment]) -> MadePlan:
    """A plan for the interfaces of a body; `MeasurementError` for one that cannot be reached."""
    surface = facet_middles(source)
    size = float(np.linalg.norm(np.ptp(surface.points, axis=0)))
    interfaces = {}
    for name, frame in frames.items():
        if not frame.rotates:
            raise MeasurementError(
                f"interfaces.{name}: a node has three dofs, whose sensors and hits would have to "
                "be at that point: expected facets, or a plan of your own, by --plan"
            )
        nodes = source.nodes.points[frame.nodes]
        own = float(np.linalg.norm(nodes - frame.X, axis=1).max())
        reach = REACH_AT_FIRST * max(own, 1e-2 * size)
        # Of a flat one the nearest facets all push in one direction.
        while (planned := _around(surface, frame.X, reach)) is None:
            reach *= REACH_GROWS_BY
            if reach > size:
                raise MeasurementError(
                    f"interfaces.{name}: no hits on the surface push and turn it about all axes"
                )
        interfaces[name] = planned
    # Elsewhere a few tell modes apart that look alike at the interfaces.
    taken = [k for one in interfaces.values() for k in (*one.sensors, *one.hits)]
    sensors = _far_from(surface.points, taken, FURTHER_SENSORS)
    hits = _far_from(surface.points, [*taken, *sensors], FURTHER_HITS)
    return MadePlan(surface, interfaces, sensors, hits)


def facet_middles(source: SolidSource) -> FacetMiddles:
    """The middle of each facet of the boundary, in which the mesh is as smooth as it is."""
    points, inwards = [], []
    for rims, _ in source.boundary():
        n = rims.shape[1]
        # Shape functions there: corners and middles of edges follow one another in quadratic rims.
        weights = {6: [-1.0 / 9.0, 4.0 / 9.0] * 3, 8: [-0.25, 0.5] * 4}.get(n, [1.0 / n] * n)
        points.append(np.einsum("k,nkj->nj", weights, rims))
        corners = rims[:, ::2] if n > 4 else rims
        crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0])
        inwards.append(-crossed / np.linalg.norm(crossed, axis=1)[:, None])
    return FacetMiddles(np.vstack(points), np.vstack(inwards))


def _around(surface: FacetMiddles, at: Array, reach: float) -> PlannedInterface | None:
    near = np.flatnonzero(np.linalg.norm(surface.points - at, axis=1) <= reach)
    if not len(near):
        return None
    levers = (surface.points[near] - at) / reach
    wrenches = rigid_rows(levers, surface.inwards[near])[:, None]
    motions = np.array([space_rows(lever) for lever in levers])
    sensors, told_by_sensors = _chosen(motions, SENSORS_OF_INTERFACE)
    # No hammer hits a sensor.
    hits, told_by_hits = _chosen(wrenches, HITS_OF_INTERFACE, sensors)
    if max(told_by_hits, told_by_sensors) > LARGEST_CONDITION_OF_PLAN:
        return None
    return PlannedInterface(at, near[sensors], near[hits])


def _chosen(rows: Array, count: int, taken: IntArray = NO_NODES) -> tuple[IntArray, float]:
    """The D-optimal blocks (count,) of rows (n, k, 6), each once, and their condition.

    taken: blocks that are none of them.
    """
    n = rows.shape[2]
    known, chosen = 1e-6 * np.eye(n), list[int]()
    for _ in range(min(count, len(rows) - len(taken))):
        # det(A + B^T B) = det A det(I + B A^-1 B^T)
        gain = np.linalg.det(
            np.eye(rows.shape[1]) + rows @ np.linalg.solve(known, rows.transpose(0, 2, 1))
        )
        # No place twice: a second hammer cannot stand on the first.
        gain[[*chosen, *taken]] = 0.0
        chosen.append(int(gain.argmax()))
        known = known + rows[chosen[-1]].T @ rows[chosen[-1]]
    sizes = np.linalg.svd(rows[chosen].reshape(-1, n), compute_uv=False)
    full = len(chosen) == count and len(sizes) == n and sizes[-1] > 0.0
    return np.array(chosen), float(sizes[0] / sizes[-1]) if full else np.inf


def _far_from(points: Array, taken: list[int], count: int) -> IntArray:
    """Points (count,), each as far from all that are taken as one can be."""
    taken, chosen = list(taken), []
    for _ in range(count):
        apart = np.linalg.norm(points[:, None] - points[taken], axis=2).min(axis=1)
        chosen.append(int(apart.argmax()))
        taken.append(chosen[-1])
    return np.array(chosen)
