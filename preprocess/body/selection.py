"""Selections on a mesh: nodes, groups, shapes in space, and holes and faces of CAD files."""

from typing import Annotated, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, NonNegativeFloat, PositiveFloat

from ...inputs import Table, Vector, rule
from ...superelement.validation import Array

Chosen = NDArray[np.bool_]


class Shape(Protocol):
    """A region of space."""

    def holds(self, points: Array, size: float) -> Chosen:
        """True (n,) for the points (n, 3) inside, within its tolerance times `size` [m]."""
        ...


class Plane(Table):
    """The points of a plane."""

    point: Vector
    normal: Vector
    tolerance: PositiveFloat = 1e-6

    @rule
    def _has_direction(self) -> None:
        if not any(self.normal):
            raise ValueError("normal: expected a vector that is not zero")

    def holds(self, points: Array, size: float) -> Chosen:
        """|(X - point) . n| <= tolerance size"""
        # The normal need not be a unit vector; the tolerance is then still a length.
        height = (points - self.point) @ (np.array(self.normal) / np.linalg.norm(self.normal))
        return np.asarray(np.abs(height) <= self.tolerance * size)


class Box(Table):
    """The points between two opposite corners; a box may be flat."""

    corners: tuple[Vector, Vector]
    tolerance: PositiveFloat = 1e-6

    def holds(self, points: Array, size: float) -> Chosen:
        """lower <= X <= upper, component by component"""
        # Nodes of a plane face differ by rounding: an exact comparison would lose some of them.
        margin = self.tolerance * size
        lower, upper = np.sort(self.corners, axis=0)
        return np.asarray(((points >= lower - margin) & (points <= upper + margin)).all(axis=1))


class Sphere(Table):
    """The points up to `radius` from a center."""

    center: Vector
    radius: PositiveFloat
    tolerance: PositiveFloat = 1e-6

    def holds(self, points: Array, size: float) -> Chosen:
        """|X - center| <= radius"""
        inside: Chosen = (
            np.linalg.norm(points - self.center, axis=1) <= self.radius + self.tolerance * size
        )
        return inside


class Cylinder(Table):
    """The points between the two ends of an axis, and between `inner` and `radius` from it.

    With inner = radius these are the points of the surface, as of a bore or a journal.
    """

    axis: tuple[Vector, Vector]
    radius: PositiveFloat
    inner: NonNegativeFloat = 0.0
    tolerance: PositiveFloat = 1e-6

    @rule
    def _is_a_cylinder(self) -> None:
        if self.axis[0] == self.axis[1]:
            raise ValueError(f"axis: expected two points, found {list(self.axis[0])} twice")
        if self.inner > self.radius:
            raise ValueError(
                f"inner: expected at most the radius, {self.radius}, found {self.inner}"
            )

    def holds(self, points: Array, size: float) -> Chosen:
        """0 <= z <= length and inner <= r <= radius, with z along the axis and r across"""
        margin = self.tolerance * size
        start, end = np.array(self.axis)
        length = np.linalg.norm(end - start)
        along = (end - start) / length
        z = (points - start) @ along
        r = np.linalg.norm(points - start - z[:, None] * along, axis=1)
        inside: Chosen = (
            (z >= -margin)
            & (z <= length + margin)
            & (r >= self.inner - margin)
            & (r <= self.radius + margin)
        )
        return inside


class Hole(Table):
    """A hole of a CAD file, by a point in it: its center, as the dry run lists it, or any other.

    radius: that of the hole, which must agree within 1 %; needed where holes meet, as a
    counterbore. tolerance: how far the point may be outside, relative to the size of the part.
    """

    near: Vector
    radius: PositiveFloat | None = None
    tolerance: PositiveFloat = 1e-3

    def __str__(self) -> str:
        of_radius = "" if self.radius is None else f" of radius {self.radius:g}"
        return f"hole near {list(self.near)}{of_radius}"


class Face(Table):
    """A face of a CAD file, plane or curved, by a point on it.

    Faces that meet and lie in one plane, or on one cylinder, are one. tolerance: how far the point
    may be from the face, relative to the size of the part.
    """

    near: Vector
    tolerance: PositiveFloat = 1e-3

    def __str__(self) -> str:
        return f"face near {list(self.near)}"


SHAPE_KEYS = ("plane", "box", "sphere", "cylinder")
FEATURE_KEYS = ("hole", "face")


class Selection(Table):
    """Nodes or facets of a mesh: the node nearest to a point, or a group, or shapes in space.

    Of a CAD file, a hole or a face in place of a group. Of a group, hole or face together with
    shapes, the intersection.

    Of a solid, shapes select the facets of the boundary that lie in them as a whole, and a group
    those that it names; a group of points selects its points. Of a beam, both select nodes. Given
    several, all must hold: the facets of a plane that lie in a box. Of matrices, all select nodes:
    one gives its dofs, several carry a frame of six; nodes names them by their labels. at: the
    position of the frame; half-way on the axis of a hole, shaft or half shell of CAD, else the
    centroid of the facets, or the mean of the points, unless given. tolerance: the distance allowed
    between `node` and the nearest node, as a fraction of the size of the mesh.
    """

    node: Vector | None = None
    nodes: Annotated[tuple[int, ...], Field(min_length=1)] | None = None
    group: str | None = None
    hole: Hole | None = None
    face: Face | None = None
    plane: Plane | None = None
    box: Box | None = None
    sphere: Sphere | None = None
    cylinder: Cylinder | None = None
    at: Vector | None = None
    tolerance: PositiveFloat = 1e-3

    @rule
    def _node_stands_alone(self) -> None:
        # The nearest node is one node, whatever else is selected: nothing could be intersected.
        others = self.selectors - {"node"} | self.model_fields_set & {"kind", "at"}
        if self.node is not None and others:
            raise ValueError(f"node stands alone, found it with {' and '.join(sorted(others))}")
        others = self.selectors - {"nodes"}
        if self.nodes is not None and others:
            raise ValueError(f"nodes stands alone, found it with {' and '.join(sorted(others))}")

    @rule
    def _one_set_of_facets(self) -> None:
        # Two faces have no facet in common: their intersection would always be empty.
        if len(found := self.given("group", *FEATURE_KEYS)) > 1:
            raise ValueError(f"expected one of group, hole and face, found {' and '.join(found)}")

    def __and__(self, other: "Selection") -> "Selection":
        """What both select; ValueError where both give the same key, as two planes do."""
        keys = self.model_fields_set & other.model_fields_set
        if twice := sorted(keys - {"tolerance"}):
            raise ValueError(
                f"expected selections by different keys, found {' and '.join(twice)} twice"
            )
        given = self.model_dump(exclude_unset=True) | other.model_dump(exclude_unset=True)
        return Selection.model_validate(given)

    @property
    def selectors(self) -> set[str]:
        """The keys that select something."""
        return set(self.given("node", "nodes", "group", *FEATURE_KEYS, *SHAPE_KEYS))

    @property
    def feature(self) -> Hole | Face | None:
        """The hole or face of a CAD file, which is a group of the mesh by its words."""
        return self.hole or self.face

    @property
    def facet_group(self) -> str | None:
        """The group of the mesh that it selects from, None for its whole boundary."""
        return self.group if self.feature is None else str(self.feature)

    @property
    def shapes(self) -> dict[str, Shape]:
        """The shapes in space, by their keys."""
        return self.given(*SHAPE_KEYS)

    @property
    def rigid(self) -> bool:
        """Whether what is selected follows its frame as one piece; else the frame follows it."""
        return False

    def holds(self, points: Array, size: float) -> Chosen:
        """True (n,) for the points (n, 3) inside all of the shapes; all points without shapes."""
        inside = np.ones(len(points), dtype=np.bool_)
        for shape in self.shapes.values():
            inside &= shape.holds(points, size)
        return inside

    def __str__(self) -> str:
        """The group, hole or face and the shapes, for messages."""
        group = [] if self.group is None else [f"group {self.group!r}"]
        group += [] if self.feature is None else [str(self.feature)]
        return " and ".join([*group, *(f"{key} ({shape})" for key, shape in self.shapes.items())])


class InterfaceSelection(Selection):
    """The selection that carries the frame of an interface.

    A node of a solid gives three dofs; a node of a beam, and any set of facets or points, gives a
    frame of six. kind: "average", the frame follows the facets as their mean motion does, without
    stiffening them; "rigid", the facets follow the frame.
    """

    kind: Literal["average", "rigid"] = "average"

    @rule
    def _selects(self) -> None:
        if not self.selectors:
            raise ValueError(
                "expected node, or one or more of group, hole, face, plane, box, sphere and "
                "cylinder, found none"
            )

    @property
    def rigid(self) -> bool:
        return self.kind == "rigid"


class SurfaceSelection(Selection):
    """The facets of solids that other bodies may touch: all their nodes, with three dofs each.

    Facets of the boundary in a group, or that lie in shapes as a whole, all of one type.
    """

    @rule
    def _of_facets(self) -> None:
        single = self.given("node", "nodes", "at")
        if single or not self.selectors:
            raise ValueError(
                "expected facets, by one or more of group, hole, face, plane, box, sphere and "
                f"cylinder, found {' and '.join(sorted(single)) or 'none'}"
            )
