"""The element that holds a point of a mesh of solids, and where it is in that."""

from typing import NamedTuple

import numpy as np
from skfem.refdom import Refdom, RefHex, RefTet

from ...superelement.validation import Array
from ..errors import BodyError
from ..mesh.mesh import Mesh
from .element import SolidElement, solid_element

MAX_OVERSHOOT = 1e-2
"""how far beyond an element a point may lie, relative to it: on a curved surface, or by rounding"""
MAX_LOCATION_STEPS = 30
LOCATION_TOLERANCE = 1e-12


class Location(NamedTuple):
    """A type of element, its row, the point xi (3,) in reference coordinates."""

    kind: str
    row: int
    xi: Array


def locate(mesh: Mesh, point: Array) -> Location:
    """The element that holds a point (3,) [m]; `BodyError` where none does."""
    best, beyond = None, np.inf
    for kind, cells in mesh.elements.items():
        corners = mesh.points[cells]
        low, high = corners.min(axis=1), corners.max(axis=1)
        # Curved faces bulge beyond the box of their nodes.
        margin = 0.1 * np.linalg.norm(high - low, axis=1)[:, None]
        near = ((point >= low - margin) & (point <= high + margin)).all(axis=1)
        solid = solid_element(kind)
        for row in np.flatnonzero(near).tolist():
            xi = _inverse(solid, corners[row], point)
            if (missed := _beyond(solid.shapes.refdom, xi)) < beyond - LOCATION_TOLERANCE:
                best, beyond = Location(kind, row, xi), missed
    if best is None or beyond > MAX_OVERSHOOT:
        nearest = mesh.points[np.linalg.norm(mesh.points - point, axis=1).argmin()]
        raise BodyError(
            f"expected a point within the body, found {point.tolist()}, which is in no element; "
            f"the nearest node is at {nearest.tolist()}"
        )
    return best


def _inverse(solid: SolidElement, corners: Array, point: Array) -> Array:
    """xi (3,) with x(xi) = point in an element with nodes (k, 3), by Newton's method."""
    # About the element, for rounding of places a kilometer away is larger than the tolerance.
    middle = corners.mean(axis=0)
    corners, point = corners - middle, point - middle
    xi = solid.nodes.mean(axis=1)
    for _ in range(MAX_LOCATION_STEPS):
        at = xi[:, None]
        missed = point - solid.N(at)[:, 0] @ corners
        J = corners.T @ solid.dN(at)[:, :, 0]
        try:
            change = np.linalg.solve(J, missed)
        except np.linalg.LinAlgError:
            break
        # Far outside, the map of a curved element folds, and Newton's method would run away.
        xi = np.clip(xi + change, -2.0, 3.0)
        if np.abs(change).max() < LOCATION_TOLERANCE:
            return np.asarray(xi)
    return np.full(3, np.inf)


def _beyond(domain: type[Refdom], xi: Array) -> float:
    """How far a point is outside the reference domain, 0 within."""
    x, y, z = xi
    if domain is RefHex:
        bounds = [-x, -y, -z, x - 1.0, y - 1.0, z - 1.0]
    elif domain is RefTet:
        bounds = [-x, -y, -z, x + y + z - 1.0]
    else:
        bounds = [-x, -y, -z, x + y - 1.0, z - 1.0]
    worst = max(0.0, *bounds)
    return float(worst) if np.isfinite(worst) else np.inf
