"""A solid of a CAD file, as it is listed."""

from dataclasses import dataclass

from .feature import Feature, Point


@dataclass(frozen=True)
class Solid:
    """volume [m^3] and center of volume [m], in the axes of the file, and what there is on it."""

    volume: float
    center: Point
    features: tuple[Feature, ...]
