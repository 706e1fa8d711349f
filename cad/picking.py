"""The one feature of a part that a body file picks by a point."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..superelement.validation import Array
from .errors import CadError
from .feature import Feature, Point

RADIUS_TOLERANCE = 0.01
"""By which the radius of a hole may differ, relative: radii are often given to three digits."""
CLEARLY_NEARER = 0.1
"""Of the distance of the second nearest, that of a feature that is meant alone."""
ROUNDING_DISTANCE = 1e-7
"""Distances that are none, relative to the size of the part."""
MAX_LISTED_FEATURES = 6
FaceDistance = Callable[[int, Array], float]
"""of a face of the CAD file, by its number, from a point (3,) [m]"""


@dataclass(frozen=True)
class Pick:
    """What a key of a body file picks.

    key: for messages, as interfaces.bolt.hole; kind: a hole, or a face of any kind; near (3,) [m]:
    in the hole, or on the face; radius [m]: of the hole, if given; tolerance: distance allowed
    between the point and the feature, relative to the size of the part; group: the name of the
    facets in the mesh; size: of elements there [m], if it is another one.
    """

    key: str
    kind: Literal["hole", "face"]
    near: Point
    radius: float | None
    tolerance: float
    group: str
    size: float | None = None

    @classmethod
    def of(cls, table: dict[str, Any]) -> "Pick":
        """The pick that `asdict` has turned into a table, and JSON into lists."""
        return cls(**table | {"near": tuple(table["near"])})


def picked(pick: Pick, features: Sequence[Feature], distance: FaceDistance, size: float) -> Feature:
    """The feature of a pick on a part of a size [m]; `CadError` unless there is exactly one.

    The error lists what there is, nearest first.
    """
    candidates = [f for f in features if pick.kind == "face" or f.kind == "hole"]
    if not candidates:
        raise CadError(f"{pick.key}: the part has no hole: pick a face, or select by plane or box")
    gaps = [_gap(pick, feature, distance) for feature in candidates]
    order = np.argsort(gaps, kind="stable").tolist()
    sized = [i for i in order if _fits(pick, candidates[i])]
    within = [i for i in sized if gaps[i] <= pick.tolerance * size]
    # Narrow faces lie within the tolerance of their neighbors, which are no match for them.
    # Rounding makes none of two the nearer one, where a point is on the edge between them.
    nearest, *others = [*(gaps[i] for i in within), np.inf]
    if within and max(nearest, ROUNDING_DISTANCE * size) < CLEARLY_NEARER * others[0]:
        return candidates[int(within[0])]
    found = [candidates[i] for i in within]
    wanted = f"at {list(pick.near)}" + ("" if pick.radius is None else f", radius {pick.radius:g}")
    if found:
        more = " or a radius" if pick.kind == "hole" and pick.radius is None else ""
        raise CadError(
            f"{pick.key}: expected one {pick.kind} {wanted}, found {len(found)}: "
            f"{'; '.join(map(str, found[:MAX_LISTED_FEATURES]))}: give a point of one alone{more}"
        )
    listed = "; ".join(
        f"{candidates[i]}, {gaps[i]:.3g} m away" for i in order[:MAX_LISTED_FEATURES]
    )
    raise CadError(
        f"{pick.key}: no {pick.kind} {wanted}, within {pick.tolerance * size:.3g} m; "
        f"nearest of {len(candidates)} are [m]: {listed}"
    )


def _gap(pick: Pick, feature: Feature, distance: FaceDistance) -> float:
    # Anywhere in a hole counts: drawings give its center, which is on no face.
    point = np.array(pick.near)
    if pick.kind == "hole":
        return feature.depth(point)
    return min(distance(face, point) for face in feature.faces)


def _fits(pick: Pick, feature: Feature) -> bool:
    if pick.radius is None:
        return True
    return abs(feature.radius - pick.radius) <= RADIUS_TOLERANCE * pick.radius
