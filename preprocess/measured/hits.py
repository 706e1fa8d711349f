"""Hits of a test: where a hammer struck, and in which direction it pushed the part."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...superelement.validation import Array
from ..errors import MeasurementError
from .channels import numbers_of, placed_rows, unit_direction


@dataclass(frozen=True, eq=False)
class HitTable:
    """Hits of a test: labels (n,), points (n, 3) [m] and unit vectors (n, 3) of force."""

    labels: tuple[str, ...]
    points: Array
    directions: Array


def read_hits(path: Path) -> HitTable:
    """The hits of a table with the columns label, x, y, z and either axis or dx, dy, dz.

    Directions are those of the force on the part, into it. `MeasurementError` names the file and
    the line.
    """
    labels, points, directions = [], [], []
    for line, row in enumerate(placed_rows(path, "hit"), start=2):
        where = f"{path}: line {line}"
        label = row["label"].strip()
        if not label or label in labels:
            raise MeasurementError(f"{where}: label: expected another name, found {label!r}")
        labels.append(label)
        points.append(numbers_of(where, row, ("x", "y", "z")))
        directions.append(unit_direction(where, row))
    return HitTable(tuple(labels), np.array(points), np.array(directions))
