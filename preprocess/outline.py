"""The outline of a body: the boundary of solids and shells, or lines swept by sections."""

import warnings

import numpy as np

from ..superelement import Outline
from ..superelement.cells import IntArray, padded
from ..superelement.validation import Array
from .assembly.source import Source
from .body.material import Section
from .errors import MeshError, MeshWarning
from .sources.given import GivenSource
from .sources.lines import LineSource

MAX_ROUND_DIFFERENCE = 0.01  # of the bending stiffnesses of what is drawn round
ROUND_CORNERS = 12
THINNEST, THICKEST = 1e-3, 0.5
"""edges of a section in lengths of the body: what they are clamped to"""
MAX_SECTION_GAP = 1e-6  # of the size of a body: what sections of neighbors may differ by, to be one


def outline_of(source: Source, center: Array) -> Outline | None:
    """The outline of a body with its center of mass (3,) in mesh coordinates.

    None for matrices of another program without elements beside them.
    """
    if isinstance(source, GivenSource):
        if source.elements is None:
            return None
        try:
            corners, cells = source.elements.surface()
        except MeshError as error:
            # The matrices are whole without a picture: elements may be tied that do not fit.
            warnings.warn(f"{source.name}: no outline: {error}", MeshWarning, stacklevel=2)
            return None
        return Outline(corners - center, cells)
    if isinstance(source, LineSource):
        return swept(source, center)
    points = source.field_points(stress=False)
    return Outline(points.places(source.nodes) - center, points.cells)


def swept(source: LineSource, center: Array) -> Outline:
    """The lines of a body, each swept by a section with the same stiffnesses.

    A rectangle with the edges

        h_y = sqrt(12 EI_z / EA),   h_z = sqrt(12 EI_y / EA)

    or where both are the same, an ellipse with the semi-axes 2 sqrt(EI / EA) as twelve corners:
    right for homogeneous sections of these forms. Ends are closed where no neighbor goes on with
    the same section.
    """
    points, lines = source.mesh.points, source.mesh.cells["line"]
    _, axes = source.section_axes()
    size = float(np.linalg.norm(np.ptp(points[np.unique(lines)], axis=0)))
    rings = _Rings(MAX_SECTION_GAP * size)
    tubes = []
    for ends, (_, y, z), section in zip(lines, axes, source.section_of_each, strict=True):
        across = corners_of(section, size) @ np.array([y, z])
        tubes.append([rings.number(int(node), points[node] + across) for node in ends])
    sides = [_side(rings.points_of(first), rings.points_of(last)) for first, last in tubes]
    caps = _caps(rings, np.array(tubes))
    return Outline(rings.corners - center, padded([*sides, *caps]), rings.nodes)


def corners_of(section: Section, size: float) -> Array:
    """Corners (k, 2) of a section of the stiffnesses of another, along local y and z [m].

    They go round from y to z. size: of the body.
    """
    radii = np.sqrt(np.array([section.EI_z, section.EI_y]) / section.EA)
    low, high = THINNEST * size / np.sqrt(12.0), THICKEST * size / np.sqrt(12.0)
    radii = np.clip(radii, low, high)
    if abs(section.EI_y - section.EI_z) <= MAX_ROUND_DIFFERENCE * max(section.EI_y, section.EI_z):
        angles = 2.0 * np.pi / ROUND_CORNERS * np.arange(ROUND_CORNERS)
        return np.asarray(2.0 * radii * np.column_stack([np.cos(angles), np.sin(angles)]))
    signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    return np.asarray(np.sqrt(3.0) * radii * signs)


class _Rings:
    """The corners of sections at nodes, of which neighbors share those that are the same."""

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self._places: list[Array] = []
        self._nodes: list[int] = []
        self._at: dict[int, list[int]] = {}
        self._first = [0]

    def number(self, node: int, corners: Array) -> int:
        """The ring at a node with these corners, a new one if there is none."""
        for ring in self._at.setdefault(node, []):
            there = self._places[ring]
            if there.shape == corners.shape and np.abs(there - corners).max() < self._tolerance:
                return ring
        ring = len(self._places)
        self._places.append(corners)
        self._nodes.append(node)
        self._at[node].append(ring)
        self._first.append(self._first[-1] + len(corners))
        return ring

    def points_of(self, ring: int) -> IntArray:
        return np.arange(self._first[ring], self._first[ring + 1])

    @property
    def corners(self) -> Array:
        """All corners (p, 3)."""
        return np.concatenate(self._places)

    @property
    def nodes(self) -> IntArray:
        """The node (p,) of each corner."""
        return np.repeat(self._nodes, np.diff(self._first))


def _side(first: IntArray, last: IntArray) -> IntArray:
    """Quads (k, 4) between two rings, which turn outwards."""
    return np.column_stack([first, np.roll(first, -1), np.roll(last, -1), last])


def _caps(rings: _Rings, tubes: IntArray) -> list[IntArray]:
    """Facets at the ends of the tubes (n, 2), but where one ends and another begins alone."""
    begins, ends = (np.bincount(side, minlength=tubes.max() + 1) for side in tubes.T)
    # Where three beams meet, or two begin, each end is seen from outside.
    goes_on = (begins == 1) & (ends == 1)
    caps = []
    for first, last in tubes.tolist():
        if not goes_on[first]:
            caps.append(_fan(rings.points_of(first)[::-1]))
        if not goes_on[last]:
            caps.append(_fan(rings.points_of(last)))
    return caps


def _fan(around: IntArray) -> IntArray:
    """A ring filled with one quad, or with triangles from its first point."""
    if len(around) == 4:
        return around[None]
    first = np.full(len(around) - 2, around[0])
    return np.column_stack([first, around[1:-1], around[2:]])
