"""The shapes of contacts as numbers."""

import math
from typing import Any

import numpy as np

from ..arrays import Array
from ..couplings.contacts import Contact
from ..couplings.joints import basis_about
from ..step.shapes import Cylinder, Plane, Profile, Sphere

SHAPES = {
    "plane": Plane.number,
    "sphere": Sphere.number,
    "cylinder": Cylinder.number,
    "profile": Profile.number,
}


def shape_parameters(contact: Contact) -> list[float]:
    """Ball, side and what the shape asks for."""
    side = -1.0 if contact.hollow else 1.0
    length = math.inf if contact.length is None else contact.length
    radius = contact.radius or 0.0
    own = {"plane": [], "sphere": [radius], "cylinder": [radius, 0.5 * length]}
    parameters = _spline(contact.points) if contact.points is not None else own[contact.shape]
    return [contact.ball, side, *parameters]


def size_of(contact: Contact) -> float:
    """A length [m] within which the ball meets or passes the shape; infinite for a plane.

    The radii of both together; for a profile the shortest distance of its points, and the ball.
    """
    if contact.points is not None:
        spans = np.linalg.norm(np.diff(contact.points, axis=0), axis=1)
        return contact.ball + float(spans.min())
    return math.inf if contact.radius is None else contact.ball + contact.radius


def _spline(points: Array) -> list[float]:
    """The pieces of the curve through points, as `Profile` reads them."""
    spline = curve_through(points)
    lengths, closed = np.diff(spline.x), bool((points[0] == points[-1]).all())
    pieces = [[length, *spline.c[:, i, 0], *spline.c[:, i, 1]] for i, length in enumerate(lengths)]
    return [len(lengths), *np.ravel(pieces).tolist(), float(closed)]


def curve_through(points: Array) -> Any:
    """The `scipy.interpolate.CubicSpline` through points (n, 2) over the lengths of its chords."""
    from scipy.interpolate import CubicSpline  # slow to load, and few models have a profile

    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ends = "periodic" if (points[0] == points[-1]).all() else "natural"
    return CubicSpline(np.cumsum([0.0, *lengths]), points, bc_type=ends)


def contact_axes(contact: Contact, D: Array) -> tuple[Array, Array]:
    """The axis of the shape and one across it, in the axes D (3, 3) of the first frame."""
    if contact.axis is None:
        return np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    basis = D.T @ basis_about(contact.axis, D)
    return basis[:, 2], basis[:, 0]
