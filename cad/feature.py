"""Holes and faces of a CAD part, as they are found, listed and picked."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from ..superelement.validation import Array

FeatureKind = Literal["hole", "shaft", "plane", "curved"]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Feature:
    """A hole, a shaft or a face: the faces of a CAD file that are one plane or one cylinder.

    A hole is a cylinder seen from inside, a shaft one seen from outside, both around more than
    half a turn; what is left is curved, as fillets are.

    number: its own, from 1; center [m]: of a hole or shaft on its axis, half-way; near [m]: a point
    that picks it; axis: that of a cylinder, or the outward normal of a plane, a unit vector, zero
    of curved faces; radius and length [m]: of cylinders, else zero; area [m^2]; faces: their
    numbers in the CAD file.
    """

    number: int
    kind: FeatureKind
    center: Point
    near: Point
    axis: Point
    radius: float
    length: float
    area: float
    faces: tuple[int, ...]

    @classmethod
    def of(cls, table: dict[str, Any]) -> "Feature":
        """The feature that `asdict` has turned into a table, and JSON into lists."""
        return cls(**{k: tuple(v) if isinstance(v, list) else v for k, v in table.items()})

    def scaled(self, unit: float) -> "Feature":
        """The feature in meters, of one in a unit of length [m]."""
        table = asdict(self)
        for key in ("center", "near"):
            table[key] = tuple(unit * x for x in table[key])
        return Feature(
            **table | {"radius": unit * self.radius, "length": unit * self.length}
            | {"area": unit**2 * self.area}
        )

    def depth(self, point: Array) -> float:
        """Distance of a point (3,) from the cylinder that the feature is, filled; 0 within."""
        from_center = point - np.array(self.center)
        along = abs(float(from_center @ self.axis))
        across = float(np.linalg.norm(np.cross(from_center, self.axis)))
        beyond = max(along - 0.5 * self.length, 0.0), max(across - self.radius, 0.0)
        return float(np.hypot(*beyond))

    def __str__(self) -> str:
        """In words, for lists in messages."""
        if self.kind in ("hole", "shaft"):
            return (
                f"{self.kind} of radius {self.radius:.6g} at {_listed(self.center)} along "
                f"{_listed(self.axis)}"
            )
        if self.kind == "plane":
            return f"plane near {_listed(self.near)} with normal {_listed(self.axis)}"
        return f"curved face near {_listed(self.near)}"


def rounded(point: Point) -> list[float]:
    """Coordinates to a micrometer of a meter-sized part and better, without the sign of zero."""
    return [round(x, 7) + 0.0 for x in point]


def _listed(point: Point) -> str:
    return str(rounded(point))
