"""Holes and shafts of two solids in one line, where a joint may be."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..cad import Feature, Solid
from ..robots.document import tidy

ROUND_KINDS = ("hole", "shaft")
PARALLEL_AXES = 1e-6  # 1 - cosine of axes of one direction
SAME_LINE = 0.01
"""Distance of axes that are one line, relative to the larger radius."""
LARGE_COORDINATE = 1e4  # [m]: points are written to 1e-10 m
RADIUS_CLEARANCE = 0.1
"""Difference of radii that fit each other, relative to the larger one."""


@dataclass(frozen=True)
class JointPair:
    """Two features in one line, by the labels of their solids, and a point of both (3,) [m]."""

    labels: tuple[str, str]
    features: tuple[Feature, Feature]
    at: tuple[float, float, float]


def pairs_of(solids: Mapping[str, Solid]) -> Iterator[JointPair]:
    """Pairs of holes, or of a hole and a shaft, of different solids; each feature once."""
    taken: set[tuple[str, int]] = set()
    for (one, a), (two, b) in combinations(solids.items(), 2):
        for first in _round(a):
            for second in _round(b):
                keys = {(one, first.number), (two, second.number)}
                # Two pins in one line do not touch; a pin in a hole, or a bolt through two, may.
                if keys & taken or first.kind == second.kind == "shaft":
                    continue
                if (at := _common_point(first, second)) is not None:
                    taken |= keys
                    yield JointPair((one, two), (first, second), at)


def _round(solid: Solid) -> list[Feature]:
    return round_features(solid.features)


def round_features(features: Sequence[Feature]) -> list[Feature]:
    """Holes first, then shafts; last bosses, the outsides of holes."""

    def rank(feature: Feature) -> int:
        return 0 if feature.kind == "hole" else 2 if is_boss(feature, features) else 1

    return sorted((f for f in features if f.kind in ROUND_KINDS), key=rank)


def is_boss(feature: Feature, features: Sequence[Feature]) -> bool:
    """Whether a shaft is the material around a hole of the same solid."""
    holes = (other for other in features if other.kind == "hole" and other.radius < feature.radius)
    return feature.kind == "shaft" and any(_in_line(feature, hole) for hole in holes)


def _in_line(one: Feature, two: Feature) -> bool:
    """Whether two features have one axis, and meet or nearly meet along it."""
    axis, between = np.array(one.axis), np.subtract(two.center, one.center)
    larger, along = max(one.radius, two.radius), float(between @ axis)
    return bool(
        1.0 - abs(float(axis @ two.axis)) <= PARALLEL_AXES
        and np.linalg.norm(between - along * axis) <= SAME_LINE * larger
        and abs(along) <= 0.5 * (one.length + two.length) + larger
    )


def _common_point(one: Feature, two: Feature) -> tuple[float, float, float] | None:
    """The middle of what two features in one line have in common, or of the gap between them."""
    axis, between = np.array(one.axis), np.subtract(two.center, one.center)
    larger = max(one.radius, two.radius)
    along = float(between @ axis)
    if not _in_line(one, two) or abs(one.radius - two.radius) > RADIUS_CLEARANCE * larger:
        return None
    # Ends along the axis from the first center: of four, the inner two.
    ends = sorted([-0.5 * one.length, 0.5 * one.length, *_ends(along, two.length)])
    x, y, z = tidy(
        np.array(one.center) + 0.5 * (ends[1] + ends[2]) * axis, LARGE_COORDINATE
    ).tolist()
    return x, y, z


def _ends(center: float, length: float) -> tuple[float, float]:
    return center - 0.5 * length, center + 0.5 * length
