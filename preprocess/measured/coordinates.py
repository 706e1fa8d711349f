"""The coordinates of a measured part: virtual points of interfaces, and further sensors and hits.

A channel along e at X moves as e . (u + theta x (X - X_v)) of the virtual point at X_v; a hit along
d there loads it with the force d and the moment (X - X_v) x d. Both have the row
[e, (X - X_v) x e].
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...superelement.validation import Array
from ..body.measured_body import VirtualPoint
from ..errors import MeasurementError
from .channels import ChannelTable
from .hits import HitTable

LARGEST_CONDITION = 1e4
"""of the rows of a virtual point, lengths scaled by their spread"""
TOLD_AXES = "x", "y", "z"


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


def coordinates_of(
    points: Mapping[str, VirtualPoint], channels: ChannelTable, hits: HitTable, center: Array
) -> TestCoordinates:
    """The coordinates of virtual points, then of other sensors, then of other hits.

    `MeasurementError` names the interface whose channels or hits do not tell its motion or load.
    """
    at_sensor = _interface_of(points, "channels", channels.labels)
    at_hit = _interface_of(points, "hits", hits.labels)
    rigid: list[Array] = []
    interfaces, sensors, places = {}, {}, {}
    size = sum(6 if point.rotations else 3 for point in points.values())
    size += len(channels.labels) + len(hits.labels)
    outputs, inputs = np.zeros((len(channels.labels), size)), np.zeros((len(hits.labels), size))
    for name, point in points.items():
        n = 6 if point.rotations else 3
        own = slice(len(rigid), len(rigid) + n)
        X = np.array(point.at)
        for key, rows, table, owner in (
            ("channels", outputs, channels, at_sensor),
            ("hits", inputs, hits, at_hit),
        ):
            mine = [k for k, label in enumerate(table.labels) if owner[label] == name]
            for k in mine:
                rows[k, own] = _row(table.points[k] - X, table.directions[k])[:n]
            _require_rank(name, key, rows[mine][:, own])
        for e in np.eye(3):
            rigid.append(_row(X - center, e))
        for e in np.eye(3)[: n - 3]:
            rigid.append(np.concatenate([np.zeros(3), e]))
        interfaces[name], places[name] = own, X - center
    for label in dict.fromkeys(label for label in channels.labels if not at_sensor[label]):
        mine = [k for k, other in enumerate(channels.labels) if other == label]
        first, directions = len(rigid), channels.directions[mine]
        X = channels.points[mine[0]] - center
        # Only three directions make a motion that a run can be compared with.
        triaxial = np.linalg.matrix_rank(directions) == 3
        axes = np.eye(3) if triaxial else directions
        outputs[mine, first : first + len(axes)] = directions if triaxial else np.eye(len(mine))
        rigid += [_row(X, e) for e in axes]
        if triaxial:
            sensors[label], places[label] = slice(first, first + 3), X
    for k, label in enumerate(hits.labels):
        if not at_hit[label]:
            inputs[k, len(rigid)] = 1.0
            rigid.append(_row(hits.points[k] - center, hits.directions[k]))
    q = len(rigid)
    motions = {label: np.zeros((3, q)) for label in sensors}
    for label, own in sensors.items():
        motions[label][:, own] = np.eye(3)
    for k, label in enumerate(channels.labels):
        # A sensor at an interface moves with it in all directions, whichever it measures.
        if name := at_sensor[label]:
            lever, own = channels.points[k] - np.array(points[name].at), interfaces[name]
            motions[label] = np.zeros((3, q))
            motions[label][:, own] = [_row(lever, e)[: own.stop - own.start] for e in np.eye(3)]
    return TestCoordinates(
        outputs[:, :q], inputs[:, :q], np.array(rigid), interfaces, sensors, places, motions
    )


def _row(lever: Array, e: Array) -> Array:
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
