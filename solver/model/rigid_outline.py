"""Outlines of rigid bodies: the shape in the model, or a box with the same inertia."""

import numpy as np

from ...superelement import Outline
from ...superelement.figures import box
from ..arrays import Array
from .bodies import RigidBody, RigidSuperelement

# A box of a flat body would be a sheet, which pictures hardly show: its thinnest edge has this
# share of the longest.
THINNEST_EDGE_RATIO = 1e-2
LARGEST_REACH, LARGEST_SIZE = 4.0, 0.3
"""a box is no longer than the larger of so many distances of its farthest frame from the center of
mass, and so many sizes of the model: of a mass that plays no part the inertia says no length
"""
SMALLEST_SIZE = 0.01
"""nor shorter than so many sizes of the model, to be seen"""


def outline_of_rigid(body: RigidBody | RigidSuperelement, size: float) -> Outline:
    """The outline of a rigid body, from its center of mass in body axes.

    That of its superelement or its shape, or else a box. size: of the model [m], 0 where it is a
    point.
    """
    if isinstance(body, RigidSuperelement):
        if body.superelement.outline is not None:
            return body.superelement.outline
    elif body.shape is not None:
        return body.shape.outline
    reach = max((float(np.linalg.norm(f.position)) for f in body.frames.values()), default=0.0)
    longest = max(LARGEST_REACH * reach, LARGEST_SIZE * size) or np.inf
    return box_of_inertia(body.mass, body.inertia, SMALLEST_SIZE * size, longest)


def box_of_inertia(
    mass: float, inertia: Array, shortest: float = 0.0, longest: float = np.inf
) -> Outline:
    """The box of uniform density with a mass and an inertia (3, 3).

        edge_1 = sqrt(6 (J_2 + J_3 - J_1) / m),   ...

    along the principal axes; what has no thickness gets some, to be seen. shortest, longest: what
    its longest edge may be [m], to which all of it is scaled.
    """
    # Principal axes come in any order and sign.
    J, axes = np.linalg.eigh(inertia)
    if np.linalg.det(axes) < 0.0:
        # A left-handed triad would turn the facets inside out.
        axes[:, 0] *= -1.0
    # J_2 + J_3 - J_1 = sum J - 2 J_1, of a plate zero, which rounding may make negative.
    edges = np.sqrt(6.0 * np.maximum(J.sum() - 2.0 * J, 0.0) / mass)
    edges *= np.clip(edges.max(), shortest, longest) / edges.max()
    return box(np.maximum(edges, THINNEST_EDGE_RATIO * edges.max()), axes=axes)
