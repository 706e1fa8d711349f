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
    half a turn; what is left is curved, as fillets and half shells are.

    number: its own, from 1; center [m]: of a cylinder on its axis, half-way; near [m]: a point that
    picks it; axis: that of a cylinder, or the outward normal of a plane, a unit vector, zero of
    others; radius and length [m]: of cylinders around more than 0.3 of a turn, which fillets have
    not, else zero; area [m^2]; faces: their numbers in the CAD file.
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
        values: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value for key, value in table.items()
        }
        return cls(**values)

    def scaled(self, unit: float) -> "Feature":
        """The feature in meters, of one in a unit of length [m]."""
        lengths: dict[str, Any] = {
            key: _times(unit, getattr(self, key)) for key in ("center", "near")
        }
        radius, length = _times(unit, (self.radius, self.length))
        (area,) = _times(unit**2, (self.area,))
        lengths |= {"radius": radius, "length": length, "area": area}
        return Feature(**asdict(self) | lengths)

    def depth(self, point: Array) -> float:
        """Distance of a point (3,) from the cylinder that the feature is, filled; 0 within."""
        from_center = point - np.array(self.center)
        along = abs(float(from_center @ self.axis))
        across = float(np.linalg.norm(np.cross(from_center, self.axis)))
        beyond = max(along - 0.5 * self.length, 0.0), max(across - self.radius, 0.0)
        return float(np.hypot(*beyond))

    def middle(self, points: Array) -> Array:
        """The place (3,) on the axis of a cylinder half-way between the ends of points (n, 3)."""
        along = (points - np.array(self.center)) @ np.array(self.axis)
        half_way = 0.5 * float(along.min() + along.max())
        return np.asarray(self.center) + half_way * np.asarray(self.axis)

    @property
    def key(self) -> str:
        """The line of a body file that picks it."""
        near = list(self.near)
        if self.kind == "hole":
            return f"hole = {{near = {near}, radius = {self.radius:.6g}}}"
        return f"face = {{near = {near}}}"

    def __str__(self) -> str:
        """In words, for lists in messages."""
        if self.kind in ("hole", "shaft"):
            return (
                f"{self.kind} of radius {self.radius:.6g} at {list(self.center)} along "
                f"{list(self.axis)}"
            )
        if self.kind == "plane":
            return f"plane near {list(self.near)} with normal {list(self.axis)}"
        return f"curved face near {list(self.near)}"


def _times(factor: float, values: tuple[float, ...]) -> tuple[float, ...]:
    """Products without the rounding of their last digits, which nobody wants to copy."""
    return tuple(float(f"{factor * value:.10g}") for value in values)
