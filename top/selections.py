"""Selections of nodes and facets of a mesh, which are combined by `&`.

du.plane(x=0.0) & du.box([0.0, 0.0, 0.0], [0.0, 0.1, 0.1])
"""

from collections.abc import Sequence

from duhamel.inputs import InputError
from duhamel.preprocess.body.selection import Box, Cylinder, Face, Hole, Plane, Selection, Sphere
from numpy.typing import ArrayLike

from .vectors import vector

AXIS_NAMES = ("x", "y", "z")


def plane(
    point: ArrayLike | None = None,
    normal: ArrayLike | None = None,
    *,
    x: float | None = None,
    y: float | None = None,
    z: float | None = None,
    tolerance: float = 1e-6,
) -> Selection:
    """Facets, or nodes of beams, on a plane.

    Parameters
    ----------
    point, normal : (3,) [m]
        A point of the plane and its normal, in mesh coordinates.
    x, y, z : float [m]
        Instead of these one coordinate: `plane(x=0.0)`.
    tolerance : float
        Largest distance from the plane, relative to the size of the mesh.

    Examples
    --------
    >>> import duhamel as du
    >>> print(du.plane(x=0.5))
    plane (point=(0.5, 0.0, 0.0) normal=(1.0, 0.0, 0.0) tolerance=1e-06)
    """
    given = {
        axis: value for axis, value in zip(AXIS_NAMES, (x, y, z), strict=True) if value is not None
    }
    if len(given) == 1 and point is None and normal is None:
        ((axis, value),) = given.items()
        unit = tuple(float(axis == other) for other in AXIS_NAMES)
        point, normal = tuple(value * component for component in unit), unit
    if (given and len(given) != 1) or point is None or normal is None:
        raise InputError("plane: expected one of x, y and z, or point and normal")
    shape = Plane(point=vector(point), normal=vector(normal), tolerance=tolerance)
    return Selection(plane=shape)


def box(corner: ArrayLike, opposite: ArrayLike, *, tolerance: float = 1e-6) -> Selection:
    """Facets, or nodes of beams, within a box.

    Parameters
    ----------
    corner, opposite : (3,) [m]
        Two opposite corners, in mesh coordinates; a box may be flat.
    tolerance : float
        Margin, relative to the size of the mesh.
    """
    return Selection(box=Box(corners=(vector(corner), vector(opposite)), tolerance=tolerance))


def sphere(center: ArrayLike, radius: float, *, tolerance: float = 1e-6) -> Selection:
    """Facets, or nodes of beams, within a sphere.

    Parameters
    ----------
    center : (3,) [m]
        In mesh coordinates.
    radius : float [m]
    tolerance : float
        Margin, relative to the size of the mesh.
    """
    shape = Sphere(center=vector(center), radius=radius, tolerance=tolerance)
    return Selection(sphere=shape)


def cylinder(
    start: ArrayLike, end: ArrayLike, radius: float, *, inner: float = 0.0, tolerance: float = 1e-6
) -> Selection:
    """Facets, or nodes of beams, within a cylinder; with inner = radius those on its surface.

    Parameters
    ----------
    start, end : (3,) [m]
        The ends of its axis, in mesh coordinates.
    radius, inner : float [m]
        Outer and inner radius.
    tolerance : float
        Margin, relative to the size of the mesh.
    """
    axis = (vector(start), vector(end))
    shape = Cylinder(axis=axis, radius=radius, inner=inner, tolerance=tolerance)
    return Selection(cylinder=shape)


def node(point: ArrayLike, *, tolerance: float = 1e-3) -> Selection:
    """The node nearest to a point.

    Parameters
    ----------
    point : (3,) [m]
        In mesh coordinates.
    tolerance : float
        Largest distance of the node, relative to the size of the mesh.
    """
    return Selection(node=vector(point), tolerance=tolerance)


def group(name: str) -> Selection:
    """The facets, nodes or elements of a named group of the mesh."""
    return Selection(group=name)


def hole(near: ArrayLike, radius: float | None = None, *, tolerance: float = 1e-3) -> Selection:
    """The wall of a hole of a CAD file.

    Parameters
    ----------
    near : (3,) [m]
        A point in the hole, as its center.
    radius : float, optional [m]
        Its radius, which must agree within 1 %; needed where holes meet, as a counterbore.
    tolerance : float
        How far the point may be outside, relative to the size of the part.

    Examples
    --------
    >>> import duhamel as du
    >>> print(du.hole([0.02, 0.03, 0.004], radius=0.005))
    hole near [0.02, 0.03, 0.004] of radius 0.005
    """
    return Selection(hole=Hole(near=vector(near), radius=radius, tolerance=tolerance))


def face(near: ArrayLike, *, tolerance: float = 1e-3) -> Selection:
    """A face of a CAD file, plane or curved; faces of one plane or cylinder that meet are one.

    Parameters
    ----------
    near : (3,) [m]
        A point on the face.
    tolerance : float
        How far the point may be from it, relative to the size of the part.

    Examples
    --------
    >>> import duhamel as du
    >>> print(du.face([0.05, 0.03, 0.0]))
    face near [0.05, 0.03, 0.0]
    """
    return Selection(face=Face(near=vector(near), tolerance=tolerance))


def selection_of(given: Selection | str | Sequence[float] | ArrayLike) -> Selection:
    """A selection; a word is the name of a group, and a point the node nearest to it."""
    if isinstance(given, Selection):
        return given
    return group(given) if isinstance(given, str) else node(given)
