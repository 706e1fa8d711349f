"""The coordinates of a measured part: virtual points of interfaces, and further sensors and hits.

A channel along e at X moves as e . (u + theta x (X - X_v)) of the virtual point at X_v; a hit along
d there loads it with the force d and the moment (X - X_v) x d. Both have the row
[e, (X - X_v) x e].
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...superelement.validation import Array
from ..body.measured_body import VirtualPoint
from ..errors import MeasurementError
from .channels import ChannelTable
from .hits import HitTable

LARGEST_CONDITION = 1e4
"""of the rows of a virtual point, lengths scaled by their spread"""
TOLD_AXES = "x", "y", "z"
SPACE_AXES = np.eye(3)


@dataclass(frozen=True, eq=False)
class TestCoordinates:
    """q and what channels and hits are of them.

    outputs (n_o, q), inputs (n_i, q); rigid (q, 6): rigid motions about the center of mass;
    interfaces and sensors: the coordinates of each, sensors that have three and are at none of
    the interfaces; places (3,) of these from the center. motions (3, q): along x, y, z, of the
    sensors of which they are known.
    """

    outputs: Array
    inputs: Array
    rigid: Array
    interfaces: dict[str, slice]
    sensors: dict[str, slice]
    places: dict[str, Array]
    motions: dict[str, Array]


@dataclass(frozen=True, eq=False)
class CoordinateBlock:
    """Some coordinates: their rigid motions (n, 6), and what channels and hits are of them."""

    rigid: Array
    outputs: Mapping[int, Array]
    inputs: Mapping[int, Array]


def coordinates_of(
    points: Mapping[str, VirtualPoint], channels: ChannelTable, hits: HitTable, center: Array
) -> TestCoordinates:
    """The coordinates of virtual points, then of other sensors, then of other hits.

    `MeasurementError` names the interface whose channels or hits do not tell its motion or load.
    """
    at_sensor = _interface_of(points, "channels", channels.labels)
    at_hit = _interface_of(points, "hits", hits.labels)
    others = [label for label in dict.fromkeys(channels.labels) if not at_sensor[label]]
    blocks = [
        *(_of_point(name, point, channels, hits, center) for name, point in points.items()),
        *(_of_sensor(label, channels, center) for label in others),
        *(_of_hit(k, hits, center) for k, label in enumerate(hits.labels) if not at_hit[label]),
    ]
    first = np.cumsum([0, *(len(block.rigid) for block in blocks)]).tolist()
    outputs = np.zeros((len(channels.labels), first[-1]))
    inputs = np.zeros((len(hits.labels), first[-1]))
    owns = [slice(start, end) for start, end in pairwise(first)]
    for block, own in zip(blocks, owns, strict=True):
        for rows, entries in ((outputs, block.outputs), (inputs, block.inputs)):
            for k, values in entries.items():
                rows[k, own] = values
    interfaces = dict(zip(points, owns, strict=False))
    of_others = zip(others, owns[len(points) :], strict=False)
    sensors = {label: own for label, own in of_others if _is_triaxial(channels, label)}
    places = {name: np.array(point.at) - center for name, point in points.items()}
    places |= {label: channels.sensors[label] - center for label in sensors}
    motions = {}
    for label, own in sensors.items():
        motions[label] = np.zeros((3, first[-1]))
        motions[label][:, own] = SPACE_AXES
    for label, X in channels.sensors.items():
        # A sensor at an interface moves with it in all directions, whichever it measures.
        if name := at_sensor[label]:
            own, lever = interfaces[name], X - np.array(points[name].at)
            motions[label] = np.zeros((3, first[-1]))
            motions[label][:, own] = space_rows(lever)[:, : own.stop - own.start]
    rigid = np.vstack([block.rigid for block in blocks])
    return TestCoordinates(outputs, inputs, rigid, interfaces, sensors, places, motions)


def _of_point(
    name: str, point: VirtualPoint, channels: ChannelTable, hits: HitTable, center: Array
) -> CoordinateBlock:
    """The dofs of a virtual point: displacements, and rotations if it has some."""
    n, X = 6 if point.rotations else 3, np.array(point.at)
    rows: dict[str, dict[int, Array]] = {}
    for key, table, labels in (
        ("channels", channels, point.channels),
        ("hits", hits, point.hits),
    ):
        rows[key] = {
            k: rigid_row(table.points[k] - X, table.directions[k])[:n]
            for k, label in enumerate(table.labels)
            if label in labels
        }
        _require_rank(name, key, np.array(list(rows[key].values())))
    turns = np.hstack([np.zeros((3, 3)), SPACE_AXES])
    rigid = np.vstack([space_rows(X - center), turns])
    return CoordinateBlock(rigid[:n], rows["channels"], rows["hits"])


def _of_sensor(label: str, channels: ChannelTable, center: Array) -> CoordinateBlock:
    """The motion of a sensor along x, y, z, or only along its own directions."""
    mine = _channels_of(channels, label)
    directions, triaxial = channels.directions[mine], _is_triaxial(channels, label)
    axes = SPACE_AXES if triaxial else directions
    rows = directions if triaxial else np.eye(len(mine))
    lever = channels.points[mine[0]] - center
    rigid = rigid_rows(np.tile(lever, (len(axes), 1)), axes)
    return CoordinateBlock(rigid, dict(zip(mine, rows, strict=True)), {})


def _channels_of(channels: ChannelTable, label: str) -> list[int]:
    return [k for k, other in enumerate(channels.labels) if other == label]


def _is_triaxial(channels: ChannelTable, label: str) -> bool:
    """Whether a sensor tells a whole motion, which a run can be compared with."""
    return bool(np.linalg.matrix_rank(channels.directions[_channels_of(channels, label)]) == 3)


def _of_hit(k: int, hits: HitTable, center: Array) -> CoordinateBlock:
    rigid = rigid_row(hits.points[k] - center, hits.directions[k])[None]
    return CoordinateBlock(rigid, {}, {k: np.ones(1)})


def rigid_rows(levers: Array, directions: Array) -> Array:
    """`rigid_row` (n, 6) of levers (n, 3) and directions (n, 3)."""
    return np.hstack([directions, np.cross(levers, directions)])


def space_rows(lever: Array) -> Array:
    """(3, 6): the motion u + theta x X along x, y, z, of a point at the end of a lever."""
    return rigid_rows(np.tile(lever, (3, 1)), SPACE_AXES)


def rigid_row(lever: Array, e: Array) -> Array:
    """[e, lever x e] (6,): the motion along e, of a point at the end of a lever."""
    return np.concatenate([e, np.cross(lever, e)])


def _interface_of(
    points: Mapping[str, VirtualPoint], key: str, labels: tuple[str, ...]
) -> dict[str, str]:
    """The interface of each label, "" of none."""
    found = dict.fromkeys(labels, "")
    for name, point in points.items():
        for label in getattr(point, key):
            if label not in found:
                raise MeasurementError(
                    f"interfaces.{name}.{key}: no {label!r} in the table; there are: "
                    f"{', '.join(dict.fromkeys(labels))}"
                )
            found[label] = name
    return found


def _require_rank(name: str, key: str, rows: Array) -> None:
    n = rows.shape[1]
    # Moments are forces times lengths: by these they become comparable.
    scaled = rows.copy()
    if n == 6 and (spread := float(np.abs(rows[:, 3:]).max(initial=0.0))) > 0.0:
        scaled[:, 3:] /= spread
    _, sizes, directions = np.linalg.svd(scaled)
    if len(sizes) == n and sizes[-1] * LARGEST_CONDITION > sizes[0]:
        return
    # What they tell least: the right singular vector that has no or the least value.
    weakest = int(np.abs(directions[-1]).argmax())
    kind = "turn it about" if weakest >= 3 else "push it along"
    verb = (
        kind
        if key == "hits"
        else kind.replace("turn it", "tell its turn").replace("push it", "tell its motion")
    )
    axis = TOLD_AXES[weakest % 3]
    advice = ", or rotations = false" if n == 6 else ""
    raise MeasurementError(
        f"interfaces.{name}: its {key} do not {verb} {axis}: add one beside the others{advice}"
    )
