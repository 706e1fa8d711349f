"""Rows that read points beside the axis of beams, which move with their sections."""

from typing import Any, NamedTuple

import numpy as np

from ...superelement.validation import Array
from ..body.material import Section
from ..errors import BodyError
from ..mesh.mesh import Mesh
from ..mesh.nodes import node_dofs
from ..sparse import in_columns
from .beam import beam_properties, lengths_and_axes, section_motion
from .inertia import LEVI_CIVITA

MAX_RADII_FROM_AXIS = 20.0
"""distance from the axis over the largest radius of gyration of the section, beyond which a point
is not of the beam
"""
MAX_SINE_TO_AXIS = 1e-6
"""sine of the angle between a gauge and the axis of its beam, up to which they are parallel"""


class SectionPoint(NamedTuple):
    """A line by its number, the place xi in [0, 1] along it, and the arm (3,) from its axis, in
    local axes [m].
    """

    line: int
    xi: float
    arm: Array


class Beams:
    """The lines of a mesh with their sections, and rows at their points."""

    def __init__(self, mesh: Mesh, sections: list[Section]) -> None:
        self._mesh = mesh
        self._L, self._axes = lengths_and_axes(mesh, sections)
        self._properties = beam_properties(sections, self._L)
        p = self._properties
        self._radius = np.sqrt(np.maximum(p.EI_y, p.EI_z) / p.EA)

    def locate(self, point: Array) -> SectionPoint:
        """The line nearest to a point (3,) [m]; `BodyError` for one that is far from all."""
        ends = self._mesh.points[self._mesh.cells["line"]]
        apart = point - ends[:, 0]
        along = np.einsum("ei,ei->e", apart, self._axes[:, 0]) / self._L
        xi = along.clip(0.0, 1.0)
        arms = apart - (xi * self._L)[:, None] * self._axes[:, 0]
        distance = np.linalg.norm(arms, axis=1)
        line = int(distance.argmin())
        if distance[line] > MAX_RADII_FROM_AXIS * self._radius[line] + 1e-6 * self._mesh.size:
            raise BodyError(
                f"expected a point on a beam or beside its axis, found {point.tolist()}, "
                f"{distance[line]:.3g} m from the nearest line"
            )
        return SectionPoint(line, float(xi[line]), self._axes[line] @ arms[line])

    def displacement_rows(self, place: SectionPoint) -> Any:
        """Rows (3, 6 n): the displacement u + w x arm of a point of a section, in mesh axes."""
        axes, motion = self._axes[place.line], self._motion(place, 0)
        moved = motion[:3] + np.einsum("ijk,jd,k->id", LEVI_CIVITA, motion[3:], place.arm)
        return self._spread(axes.T @ moved, place.line)

    def strain_rows(self, place: SectionPoint, direction: Array) -> Any:
        """One row: the strain u' + w_y' z - w_z' y along the axis, the direction of the gauge.

        `BodyError` for a gauge askew to the axis, where beams know no strain.
        """
        axis = self._axes[place.line, 0]
        if np.linalg.norm(np.cross(axis, direction)) > MAX_SINE_TO_AXIS:
            raise BodyError(
                f"direction: expected that of the beam, {axis.tolist()}, found {direction.tolist()}"
            )
        slope, (_, y, z) = self._motion(place, 1), place.arm
        row = slope[0] + z * slope[4] - y * slope[5]
        return self._spread(row[None], place.line)

    def _motion(self, place: SectionPoint, derivative: int) -> Array:
        """Motion of the section, or its derivative along the line (6, 12), in local axes."""
        motions: Array = section_motion(place.xi, self._L, self._properties, derivative)
        return np.asarray(motions[place.line])

    def _spread(self, local: Array, line: int) -> Any:
        """Rows (r, 6 n) from those (r, 12) by the local dofs of one line."""
        turn = np.kron(np.eye(4), self._axes[line])
        columns = node_dofs(self._mesh.cells["line"][line][None], 6)[0]
        return in_columns(local @ turn, columns, 6 * len(self._mesh.points))
