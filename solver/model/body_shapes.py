"""Shapes of rigid bodies in pictures; the motion does not depend on them."""

import io
from contextlib import redirect_stderr, redirect_stdout
from functools import cached_property
from typing import Annotated, Any, Protocol

import numpy as np
from pydantic import AfterValidator

from ...files import FileError, in_one_line, require_regular
from ...inputs import expected
from ...superelement import Outline, SuperelementError, figures
from ...superelement.cells import padded
from ..errors import ModelError
from ..schema.entry import Entry, FieldSpec, NameInFile, entry
from ..schema.forms import Family
from ..schema.paths import FilePath
from ..schema.tables import member
from ..schema.values import ZERO_VECTOR, Direction, Positive, Vector, vector

BODY_SHAPES = Family("shape")
FACET_CELLS = ("triangle", "quad", "triangle6", "quad8", "quad9")
"""cells of a surface, as meshio calls them"""
E_Z: Any = (0.0, 0.0, 1.0)


def _edges(value: Any) -> Any:
    edges = vector(value)
    if not (edges > 0.0).all():
        raise ValueError
    return edges


_EdgesInFile = Annotated[
    tuple[float, float, float], AfterValidator(_edges), expected("three positive numbers")
]
Edges = Annotated[np.ndarray, FieldSpec("three positive numbers", _edges, _EdgesInFile)]


class BodyShape(Protocol):
    """The shape by which pictures show a rigid body."""

    @property
    def outline(self) -> Outline:
        """In body axes, from its center of mass."""


@BODY_SHAPES.in_files("box")
@entry()
class Box(Entry):
    """A box along the body axes.

    Parameters
    ----------
    edges, center : (3,) [m]

    Examples
    --------
    >>> Box([0.2, 0.1, 0.1]).edges.tolist()
    [0.2, 0.1, 0.1]
    """

    edges: Annotated[Edges, NameInFile("box")]
    center: Vector = ZERO_VECTOR

    @property
    def outline(self) -> Outline:
        return figures.box(self.edges, self.center)


@entry()
class CylinderSize(Entry):
    """The measures of a cylinder [m], and its axis in body axes."""

    radius: Positive
    length: Positive
    axis: Direction = E_Z


@BODY_SHAPES.in_files("cylinder")
@entry()
class Cylinder(Entry):
    """A cylinder.

    Parameters
    ----------
    cylinder : CylinderSize
        Radius, length [m] and axis, in body axes.
    center : (3,) [m]
        Its middle.

    Examples
    --------
    >>> Cylinder(CylinderSize(radius=0.1, length=0.5)).cylinder.length
    0.5
    """

    cylinder: CylinderSize
    center: Vector = ZERO_VECTOR

    @property
    def outline(self) -> Outline:
        one = self.cylinder
        return figures.cylinder(one.radius, one.length, one.axis, self.center)


@BODY_SHAPES.in_files("sphere")
@entry()
class Sphere(Entry):
    """A sphere.

    Parameters
    ----------
    radius : float [m]
    center : (3,) [m]

    Examples
    --------
    >>> Sphere(0.1).radius
    0.1
    """

    radius: Annotated[Positive, NameInFile("sphere")]
    center: Vector = ZERO_VECTOR

    @property
    def outline(self) -> Outline:
        return figures.sphere(self.radius, self.center)


@BODY_SHAPES.in_files("stl")
@entry()
class Surface(Entry):
    """The facets of a file that meshio reads, STL or another.

    Parameters
    ----------
    file : path
    scale : float [m]
        The unit of its coordinates.
    center : (3,) [m]
        Where its origin is, in body axes.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import meshio
    >>> import numpy as np
    >>> corners = np.array([[0.0, 0.0, 0.0], [200.0, 0.0, 0.0], [0.0, 100.0, 0.0]])
    >>> with TemporaryDirectory() as folder:
    ...     meshio.Mesh(corners, {"triangle": [[0, 1, 2]]}).write(f"{folder}/fin.vtu")
    ...     float(Surface(f"{folder}/fin.vtu", scale=1e-3).outline.points.max().round(6))
    0.2
    """

    file: Annotated[FilePath, NameInFile("stl")]
    scale: Positive = 1.0
    center: Vector = ZERO_VECTOR

    def validate(self) -> None:
        self.outline  # noqa: B018 - read once, so that an unreadable file is reported at once

    @cached_property
    def outline(self) -> Outline:
        points, cells = _facets(self.file)
        try:
            return Outline(self.scale * points + self.center, cells)
        except SuperelementError as error:
            raise ModelError(f"stl: {self.file}: {error}") from error


def _facets(path: str) -> tuple[Any, Any]:
    """Points (p, 3) and facets of a file; `ModelError` where there are none."""
    try:
        require_regular(path)
        mesh = _read(path)
    except FileNotFoundError as error:
        raise ModelError(f"stl: {path}: no such file") from error
    except (FileError, OSError) as error:
        raise ModelError(f"stl: {path}: cannot be read: {in_one_line(error)}") from error
    # Files of meshes have lines and volumes beside the surface, which no picture needs.
    blocks = [np.asarray(block.data) for block in mesh.cells if block.type in FACET_CELLS]
    if not sum(map(len, blocks)):
        raise ModelError(f"stl: {path}: expected facets of a surface, found none")
    points = np.zeros((len(mesh.points), 3))
    # A file of a flat surface may have two coordinates for each point.
    points[:, : np.shape(mesh.points)[1]] = mesh.points
    return points, padded(blocks)


def _read(path: str) -> Any:
    """A mesh as meshio reads it, which fails in many ways and may end the process that asks."""
    import meshio  # it takes a while, and few models have such a body

    quiet = io.StringIO()
    try:
        # meshio prints to the terminal, and calls sys.exit for a format that it does not know.
        with redirect_stdout(quiet), redirect_stderr(quiet), np.errstate(all="ignore"):
            return meshio.read(path)
    except (Exception, SystemExit) as error:
        said = str(error).strip() or quiet.getvalue().strip() or type(error).__name__
        why = " ".join(said.split())
        raise ModelError(f"stl: {path}: not a readable surface: {why}") from error


_SHAPES = "a shape: Box, Cylinder, Sphere or Surface"
AnyBodyShape = Annotated[
    BodyShape, BODY_SHAPES, member(BODY_SHAPES, _SHAPES, Box | Cylinder | Sphere | Surface)
]
