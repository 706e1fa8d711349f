"""Channels of a test: where its sensors are, and in which directions they measure."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...inputs import is_name, quoted
from ...superelement.validation import Array
from ..errors import MeasurementError, about

AXIS_VECTORS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
DIRECTION_COLUMNS = "dx", "dy", "dz"
DAMAGE_OF_TABLES = (OSError, UnicodeDecodeError, csv.Error)
"""what reading a table raises"""
MAX_UNIT_ERROR = 0.01
"""difference of the length of a direction from 1 that counts as rounding"""


def read_rows(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """The columns of a table with commas, by its first line, and its other lines.

    `MeasurementError` where it is none.
    """
    with (
        about(path, MeasurementError, "file", "not a readable table", DAMAGE_OF_TABLES),
        path.open(encoding="utf-8", newline="") as file,
    ):
        reader = csv.DictReader(file, skipinitialspace=True, restval="")
        return list(reader.fieldnames or ()), list(reader)


@dataclass(frozen=True, eq=False)
class ChannelTable:
    """Channels of a test.

    labels (n,) of their sensors, which may have several; names (n,), by which files of modes know
    them; points (n, 3) [m] and unit vectors (n, 3) in mesh axes.
    """

    labels: tuple[str, ...]
    names: tuple[str, ...]
    points: Array
    directions: Array

    @property
    def sensors(self) -> dict[str, Array]:
        """The place of each sensor by its label."""
        return dict(zip(self.labels, self.points, strict=True))


def read_channels(path: Path) -> ChannelTable:
    """The channels of a table with the columns label, x, y, z and either axis or dx, dy, dz.

    axis: x, y or z, perhaps with a sign. A channel is named after its sensor or, where that has
    several, LABEL:AXIS, or LABEL:1, LABEL:2 ... in their order if they have directions.

    `MeasurementError` names the file and the line.
    """
    rows = placed_rows(path, "channel")
    labels = [row["label"].strip() for row in rows]
    places: dict[str, Array] = {}
    points, directions = [], []
    for line, (label, row) in enumerate(zip(labels, rows, strict=True), start=2):
        where = f"{path}: line {line}"
        if not is_name(label):
            raise MeasurementError(f"{where}: label: expected a name, found {quoted(label)}")
        point = numbers_of(where, row, ("x", "y", "z"))
        # One label at two places is a slip in one of them: the sensor stands at one.
        if not np.array_equal(places.setdefault(label, point), point):
            raise MeasurementError(
                f"{where}: sensor {label} is at {point.tolist()}, but above at "
                f"{places[label].tolist()}"
            )
        points.append(point)
        directions.append(unit_direction(where, row))
    names = _names(labels, rows)
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise MeasurementError(f"{path}: expected every channel once, found {twice} twice")
    return ChannelTable(tuple(labels), tuple(names), np.array(points), np.array(directions))


def placed_rows(path: Path, kind: str) -> list[dict[str, str]]:
    """The lines of a table of places and directions, of channels or hits."""
    columns, rows = read_rows(path)
    needed, known = {"label", "x", "y", "z"}, set(columns)
    if not needed <= known or not ("axis" in known or set(DIRECTION_COLUMNS) <= known):
        raise MeasurementError(
            f"{path}: expected the columns label, x, y, z and either axis or dx, dy, dz, found "
            f"{', '.join(columns) or 'none'}"
        )
    if not rows:
        raise MeasurementError(f"{path}: expected a line for each {kind}, found none")
    return rows


def _names(labels: list[str], rows: list[dict[str, str]]) -> list[str]:
    names, seen = [], dict.fromkeys(labels, 0)
    for label, row in zip(labels, rows, strict=True):
        seen[label] += 1
        axis = (row.get("axis") or "").strip().lstrip("+-") or str(seen[label])
        names.append(label if labels.count(label) == 1 else f"{label}:{axis}")
    return names


def unit_direction(where: str, row: dict[str, str]) -> Array:
    axis = (row.get("axis") or "").strip()
    if axis:
        sign = -1.0 if axis.startswith("-") else 1.0
        if axis.lstrip("+-") not in AXIS_VECTORS:
            raise MeasurementError(f"{where}: axis: expected x, y or z, found {quoted(axis)}")
        return sign * np.array(AXIS_VECTORS[axis.lstrip("+-")])
    direction = numbers_of(where, row, DIRECTION_COLUMNS)
    length = float(np.linalg.norm(direction))
    if abs(length - 1.0) > MAX_UNIT_ERROR:
        raise MeasurementError(
            f"{where}: dx, dy, dz: expected a unit vector, found length {length:g}"
        )
    # The rounding of printed direction cosines would scale the channel.
    unit: Array = direction / length
    return unit


def numbers_of(where: str, row: dict[str, str], keys: tuple[str, ...]) -> Array:
    try:
        values = np.array([float(row[key] or "") for key in keys])
    except ValueError:
        found = ", ".join(quoted(row[key] or "") for key in keys)
        raise MeasurementError(
            f"{where}: {', '.join(keys)}: expected numbers, found {found}"
        ) from None
    if not np.isfinite(values).all():
        raise MeasurementError(f"{where}: {', '.join(keys)}: expected finite numbers")
    return values
