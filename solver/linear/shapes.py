"""Shapes of modes as lines in space: surfaces of recovery, curves between interfaces, or rods."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.bodies import FlexibleBody
from .modes import FirstOrder
from .motion import motion_of

# points of a curve between two interfaces
CURVE_STATIONS = 17


@dataclass(frozen=True, eq=False)
class Shape:
    """The points of a body, and their motion.

    points (p, 3) in space [m]; motion (p, 3) complex, of arbitrary size; edges (n, 2): points that
    a line joins.
    """

    body: str
    points: Array
    motion: Any
    edges: NDArray[np.int64]


def shapes_of(form: FirstOrder, y: Any) -> list[Shape]:
    """The bodies of a mechanism in one motion y (n_y,), as a column of `LinearModes.y`."""
    pose = form.equations.pose
    moved = motion_of(form, y[:, None])
    at = {name: k for k, name in enumerate(moved.names)}
    found, column = [], 6 * len(pose.state.bodies.x)
    modal = {body.name: body for body in form.bodies}
    for b, (name, body) in enumerate(pose.lowered.model.bodies.items()):
        ends = [at[f"{name}.{frame}"] for frame in body.frames if f"{name}.{frame}" in at]
        if not isinstance(body, FlexibleBody):
            found.append(_star(name, at[name], ends, moved.points, moved.translations[..., 0]))
            continue
        eta = y[column : column + modal[name].m]
        column += modal[name].m
        recovery = body.superelement.recovery
        if recovery is not None:
            rigid = y[6 * b : 6 * b + 6]
            u = np.tensordot(recovery.phi, eta, axes=1)
            u = u + rigid[:3] + np.cross(np.broadcast_to(rigid[3:], u.shape), recovery.points)
            x, R = pose.state.bodies.x[b], pose.state.bodies.R[b]
            edges = _edges(recovery.cells)
            found.append(Shape(name, x + recovery.points @ R.T, u @ R.T, edges))
        else:
            order = _along(moved.points[ends])
            ends = [ends[k] for k in order]
            found.append(
                _curve(
                    name,
                    moved.points[ends],
                    moved.translations[ends, :, 0],
                    moved.rotations[ends, :, 0],
                )
            )
    return found


def _star(name: str, center: int, ends: list[int], points: Array, moved: Any) -> Shape:
    """Lines from the center of a rigid body to its frames."""
    chosen = [center, *ends]
    edges = np.array([[0, k + 1] for k in range(len(ends))], dtype=np.int64).reshape(-1, 2)
    return Shape(name, points[chosen], moved[chosen], edges)


def _along(points: Array) -> list[int]:
    """The order of points along the line that fits them."""
    arms = points - points.mean(axis=0)
    _, _, directions = np.linalg.svd(arms)
    order: list[int] = np.argsort(arms @ directions[0], kind="stable").tolist()
    return order


def _curve(name: str, points: Array, moved: Any, turned: Any) -> Shape:
    """Cubic curves through interfaces, with their rotations as slopes."""
    stations, motions = [points[:1]], [moved[:1]]
    for k in range(len(points) - 1):
        part, motion = _segment(points[k : k + 2], moved[k : k + 2], turned[k : k + 2])
        stations.append(part)
        motions.append(motion)
    whole = np.vstack(stations)
    n = len(whole)
    edges = np.column_stack([np.arange(n - 1), np.arange(1, n)])
    return Shape(name, whole, np.vstack(motions), edges)


def _segment(points: Array, moved: Any, turned: Any) -> tuple[Array, Any]:
    """The points after the first of a segment, and their motion."""
    s = np.linspace(0.0, 1.0, CURVE_STATIONS)[1:, None]
    chord = points[1] - points[0]
    stretch = chord * ((moved[1] - moved[0]) @ chord) / max(chord @ chord, 1e-300)
    slopes = [np.cross(turn, chord) + stretch for turn in turned]
    a, b = 3.0 * s**2 - 2.0 * s**3, s**3 - s**2
    motion = (1.0 - a) * moved[0] + a * moved[1]
    motion = motion + (s - 2.0 * s**2 + s**3) * slopes[0] + b * slopes[1]
    return points[0] + s * chord, motion


def _edges(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Pairs of neighbors around facets, corners alone; lines by their two ends."""
    pairs = np.array(list(_pairs(cells)), dtype=np.int64).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _pairs(cells: NDArray[np.int64]) -> Iterator[tuple[int, int]]:
    corners = {2: 2, 3: 3, 4: 4, 6: 3, 8: 4, 9: 4}
    for row in cells.tolist():
        points = [point for point in row if point >= 0]
        n = corners[len(points)]
        yield from ((points[k], points[(k + 1) % n]) for k in range(n if n > 2 else 1))
