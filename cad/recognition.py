"""Holes, shafts, planes and curved faces of the solid that gmsh holds."""

from dataclasses import dataclass

import gmsh
import numpy as np

from ..superelement.validation import Array
from .feature import Feature, FeatureKind, Point
from .session import solid_size
from .surfaces import FlatSurface, RoundSurface, Simple, fitted_surface, largest_gap, same

GRID_SIDES = (5, 17)
"""Parameters a side at which a face is looked at; the finer ones where it is much cut away."""
EDGE_POINTS = 33
FULL_GAP = 0.99 * np.pi
"""Angle that a hole may be open by: just less than half a turn, which the ends of slots have."""
MAX_GAP_OF_CYLINDERS = 1.4 * np.pi
"""Angle that a cylinder may be open by: fillets, of a quarter turn at most, leave 1.5 pi."""
PROBE_STEPS = (1e-3, 1e-4, 1e-5)
"""Steps off a face, over the root of its area, that tell inside from outside."""
EQUAL_CLEARANCE = 1e-2
"""Difference of distances from edges that is none, relative to the size of the part."""
LISTED_DIGITS = 7
KIND_ORDER: dict[FeatureKind, int] = {"hole": 0, "shaft": 1, "plane": 2, "curved": 3}


@dataclass(frozen=True, eq=False)
class _Face:
    """A face of the CAD file: its surface, a point on it, its edges, and points of these (n, 3)."""

    tag: int
    surface: Simple | None
    near: Array
    center: Array
    area: float
    edges: tuple[int, ...]
    rim: Array


def features_of(solid: int) -> list[Feature]:
    """The features of a solid, in the unit of the session: holes, shafts, planes, curved faces."""
    size = solid_size(solid)
    tags = [tag for _, tag in gmsh.model.getBoundary([(3, solid)], oriented=False)]
    faces = [_face(solid, tag, size) for tag in sorted(tags)]
    found = [_feature(group, size) for group in _joined(faces, size)]
    found.sort(key=lambda feature: (KIND_ORDER[feature.kind], feature.faces))
    return [_numbered(feature, number) for number, feature in enumerate(found, 1)]


def _face(solid: int, tag: int, size: float) -> _Face:
    area = float(gmsh.model.occ.getMass(2, tag))
    center = np.array(gmsh.model.occ.getCenterOfMass(2, tag))
    # Of each face alone: a combined boundary would leave out the seam of a closed cylinder.
    edges = gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False)
    edge_tags = tuple(sorted({edge for _, edge in edges}))
    rim = np.concatenate([np.zeros((0, 3)), *map(_edge_points, edge_tags)])
    (u_low, v_low), (u_high, v_high) = gmsh.model.getParametrizationBounds(2, tag)
    for n in GRID_SIDES:
        # At the middles of cells: bounds are edges, and poles of spheres have no normal.
        at = (np.arange(n) + 0.5) / n
        u, v = np.meshgrid(u_low + at * (u_high - u_low), v_low + at * (v_high - v_low))
        parameters = np.column_stack([u.ravel(), v.ravel()])
        points = np.reshape(gmsh.model.getValue(2, tag, parameters.ravel()), (-1, 3))
        on_face = _far_from_edges(tag, parameters, points, rim, center, size)
        if on_face is not None:
            break
    normals = np.reshape(gmsh.model.getNormal(tag, parameters.ravel()), (-1, 3))
    at_face = 0 if on_face is None else on_face
    outward = _outward(solid, points[at_face], normals[at_face], np.sqrt(area))
    surface = fitted_surface(points, outward * normals, size)
    return _Face(tag, surface, points[at_face], center, area, edge_tags, rim)


def _far_from_edges(
    tag: int, parameters: Array, points: Array, rim: Array, center: Array, size: float
) -> int | None:
    """The point on the face, not on what is cut away of its surface, farthest from its edges.

    Of such points the nearest to the center. On an edge it would be on two faces.
    """
    # Inside by parameters: what is cut away of a plane is as near to its center as the rest.
    on_face = [
        row
        for row, at in enumerate(parameters.tolist())
        if gmsh.model.isInside(2, tag, at, parametric=True)
    ]
    if not on_face:
        return None
    X = points[on_face]
    to_center = np.linalg.norm(X - center, axis=1)
    if not len(rim):
        return on_face[int(to_center.argmin())]
    clear = np.linalg.norm(X[:, None] - rim, axis=2).min(axis=1)
    clear = np.round(clear / (EQUAL_CLEARANCE * size))
    return on_face[int(np.lexsort((to_center, -clear))[0])]


def _outward(solid: int, point: Array, normal: Array, length: float) -> float:
    """1 where a normal leads out of the solid, -1 where it leads into it."""
    # CAD files may turn the surface below a face, so that its own normal tells nothing.
    for step in PROBE_STEPS:
        ahead, behind = (
            gmsh.model.isInside(3, solid, (point + side * step * length * normal).tolist())
            for side in (1.0, -1.0)
        )
        if bool(ahead) != bool(behind):
            return -1.0 if ahead else 1.0
    return 1.0


def _joined(faces: list[_Face], size: float) -> list[list[_Face]]:
    """Faces that share an edge and a surface, together: exporters split cylinders in halves."""
    groups = [[face] for face in faces]
    by_tag = {face.tag: group for face, group in zip(faces, groups, strict=True)}
    neighbors: dict[int, list[_Face]] = {}
    for face in faces:
        for edge in face.edges:
            for other in neighbors.setdefault(edge, []):
                one, two = by_tag[other.tag], by_tag[face.tag]
                if one is not two and same(face.surface, other.surface, size):
                    one.extend(two)
                    by_tag.update({member.tag: one for member in two})
            neighbors[edge].append(face)
    kept = {id(group): group for group in by_tag.values()}
    return list(kept.values())


def _feature(faces: list[_Face], size: float) -> Feature:
    surface, largest = faces[0].surface, max(faces, key=lambda face: face.area)
    area = sum(face.area for face in faces)
    center = np.asarray(sum(face.area * face.center for face in faces)) / area
    kind: FeatureKind = "curved"
    axis, radius, length = np.zeros(3), 0.0, 0.0
    if isinstance(surface, FlatSurface):
        kind, axis = "plane", surface.normal
    elif isinstance(surface, RoundSurface):
        rim = np.concatenate([face.rim for face in faces])
        # By its edges, which are exact, not by angles of parameters, which files turn as they like.
        gap = largest_gap(rim, surface)
        if gap < FULL_GAP:
            kind = "hole" if surface.radius < 0.0 else "shaft"
        if gap < MAX_GAP_OF_CYLINDERS:
            along = (rim - surface.point) @ surface.axis
            center = surface.point + 0.5 * float(along.min() + along.max()) * surface.axis
            axis, radius, length = surface.axis, abs(surface.radius), float(np.ptp(along))
    near = center if kind == "hole" else largest.near
    tags = tuple(sorted(face.tag for face in faces))
    center_point, near_point, direction = (
        _point(values, step) for values, step in ((center, size), (near, size), (axis, 1.0))
    )
    lengths = radius, length, area
    return Feature(0, kind, center_point, near_point, direction, *lengths, tags)


def _edge_points(edge: int) -> Array:
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, edge)
    points = gmsh.model.getValue(1, edge, np.linspace(low, high, EDGE_POINTS).tolist())
    return np.reshape(points, (-1, 3))


def _point(values: Array, size: float) -> Point:
    """Three numbers without their rounding, below 1e-7 of a size, and without the sign of zero."""
    # Users copy these numbers: 0.02, not 0.019999999999999997.
    decimals = LISTED_DIGITS - int(np.floor(np.log10(size)))
    x, y, z = (np.round(values, decimals) + 0.0).tolist()
    return x, y, z


def _numbered(feature: Feature, number: int) -> Feature:
    return Feature(**feature.__dict__ | {"number": number})
