"""Shapes that a frame carries, and that balls and surfaces touch: planes, spheres and others."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...results.space import ContactShape
from ..arrays import Array
from ..errors import ModelError
from ..step.shapes import Cylinder, Plane, Profile, Sphere
from .coupling import GROUND
from .joint import basis_about

PROFILE_POINTS = 8
"""points of a profile that are drawn, for each of its pieces"""


@dataclass(frozen=True)
class ShapeType:
    """The keys of a shape of contacts, and its number in compiled code."""

    number: int
    round: bool = False
    """whether it has a radius"""
    hollow: bool = False
    """whether it may be hollow"""
    points: bool = False
    """whether it goes through points"""
    axis: bool = False
    """whether it needs an axis"""
    length: bool = False
    """whether it may have a length"""


SHAPE_TYPES = {
    "plane": ShapeType(Plane.number, axis=True),
    "sphere": ShapeType(Sphere.number, round=True, hollow=True),
    "cylinder": ShapeType(Cylinder.number, round=True, hollow=True, axis=True, length=True),
    "profile": ShapeType(Profile.number, axis=True, points=True, hollow=True),
}


class CarriedShape:
    """What contacts with the keys of a shape have in common."""

    presses_surfaces: ClassVar[bool] = False
    """whether surfaces of bodies meet, by their nodes, and not a ball"""

    if TYPE_CHECKING:  # fields of the contacts

        @property
        def shape(self) -> str | None: ...
        @property
        def axis(self) -> Array | None: ...
        @property
        def radius(self) -> float | None: ...
        @property
        def hollow(self) -> bool: ...
        @property
        def length(self) -> float | None: ...
        @property
        def points(self) -> Array | None: ...
        @property
        def between(self) -> tuple[str, str]: ...
        def error(self, message: str) -> ModelError: ...

    @property
    def kind(self) -> ShapeType:
        assert self.shape is not None
        return SHAPE_TYPES[self.shape]

    def axes_of_shape(self, D: Array) -> tuple[Array, Array]:
        """The axis of the shape and one across it, in the axes D (3, 3) of the first frame."""
        # A sphere is the same from all sides; any axes do for its tangents.
        if self.axis is None:
            return np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
        # The axis is given in space at the start; the shape turns with its frame from there on.
        basis = D.T @ basis_about(self.axis, D)
        return basis[:, 2], basis[:, 0]

    def shape_parameters(self) -> list[float]:
        """The parameters of the shape in compiled code."""
        if self.points is not None:
            return _pieces(self.points)
        if self.radius is None:
            return []
        length = math.inf if self.length is None else self.length
        return [self.radius, 0.5 * length] if self.kind.length else [self.radius]

    def drawn_shape(self, D: Array) -> ContactShape:
        """In the axes that its axis has: those of the first frame, or of space for the ground."""
        _, across = self.axes_of_shape(D)
        curve = np.zeros((0, 2))
        if self.points is not None:
            # Spline pieces have unequal lengths: each gets as many points, so that short ones look
            # round.
            spline = curve_through(self.points)
            n = len(spline.x) - 1
            pieces = np.linspace(0, n, PROFILE_POINTS * n + 1)
            curve = spline(np.interp(pieces, np.arange(n + 1), spline.x))
        length = np.inf if self.length is None else self.length
        # Frames of the ground may be turned (D), but pictures place their shapes in the axes of
        # space.
        across = D @ across if self.between[0].partition(".")[0] == GROUND else across
        return ContactShape(self.radius or 0.0, length, across, curve)

    def check_shape(self) -> None:
        kind = self.kind
        if kind.axis != (self.axis is not None):
            raise self.error(f"axis: a {self.shape} {'needs one' if kind.axis else 'takes none'}")
        if kind.round != (self.radius is not None):
            takes = "needs one" if kind.round else "takes none"
            raise self.error(f"radius: a {self.shape} {takes}")
        if kind.points != (self.points is not None):
            takes = "needs some" if kind.points else "takes none"
            raise self.error(f"points: a {self.shape} {takes}")
        if self.points is not None:
            self._check_points(self.points)
        if self.length is not None and not kind.length:
            raise self.error(f"length: a {self.shape} takes none")
        if self.hollow and not kind.hollow:
            raise self.error(f"hollow: a {self.shape} cannot be")

    def _check_points(self, points: Array) -> None:
        if len(points) < 4:
            raise self.error(f"points: expected four or more, got {len(points)}")
        if not np.linalg.norm(np.diff(points, axis=0), axis=1).all():
            raise self.error("points: expected different neighbors, found equal ones")


def _pieces(points: Array) -> list[float]:
    """The pieces of the curve through points, as `Profile` reads them."""
    spline = curve_through(points)
    # Compiled code finds a piece by its length, then the coefficients of both coordinates.
    lengths, closed = np.diff(spline.x), bool((points[0] == points[-1]).all())
    pieces = [[length, *spline.c[:, i, 0], *spline.c[:, i, 1]] for i, length in enumerate(lengths)]
    return [len(lengths), *np.ravel(pieces).tolist(), float(closed)]


def curve_through(points: Array) -> Any:
    """The `scipy.interpolate.CubicSpline` through points (n, 2) over the lengths of its chords."""
    from scipy.interpolate import CubicSpline  # slow to load, and few models have a profile

    # Chord lengths as parameter: equal parameters for unequal chords would make loops.
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ends = "periodic" if (points[0] == points[-1]).all() else "natural"
    return CubicSpline(np.cumsum([0.0, *lengths]), points, bc_type=ends)
