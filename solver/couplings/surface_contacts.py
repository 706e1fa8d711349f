"""Contacts of surfaces of flexible bodies: with shapes, rigid facets, or other flexible surfaces.

The gap of each node of the surface, and its force, obey Signorini's law exactly, without a penalty:

    0 <= P_i  _|_  y_i >= 0

See solver/step/surfaces.py.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np

from ...superelement import Surface
from ..arrays import Array
from ..errors import ModelError
from ..schema.entry import Entry, entry, one_of
from ..schema.paths import FilePath
from ..schema.values import NO_ARRAY, Name, OptionalDirection, OptionalPoints, Pair, Positive
from .carried_shape import SHAPE_TYPES, CarriedShape
from .coupling import GROUND
from .friction import AnyCoefficient
from .rigid_facets import read_facets

TARGET_GEOMETRIES = "smooth", "flat"
"""how facets of targets are read: with arcs between their corners, or as they are"""
KEYS_OF_SHAPE = "axis", "radius", "hollow", "length", "points"
"""keys that belong to a shape"""


class ShapeInFrame(NamedTuple):
    """A shape in the axes of its frame, as compiled code reads it; none has the number -1."""

    number: int
    axis: Array
    across: Array
    parameters: list[float]


WITHOUT_LAW = dict.fromkeys(
    ("restitution", "stiffness", "exponent", "damping", "slow", "hertz", "law"),
    "surfaces of bodies meet exactly, without a law of force; an impact loses what goes into "
    "waves and their damping",
) | dict.fromkeys(
    ("tangential_stiffness", "tangential_damping"),
    "what sticks does not move, and no spring holds it",
)


@entry()
class SurfaceContact(CarriedShape, Entry):
    """A surface of a flexible body against a shape, rigid facets, or another flexible surface.

    Parameters
    ----------
    name : str
    surfaces : (2,) of str
        The surface that has the rows, "BODY.SURFACE", the finer one or the softer body; and what it
        meets, "BODY.SURFACE", or the frame that carries a shape or facets, "BODY.FRAME" or
        "ground".
    shape : {"plane", "sphere", "cylinder", "profile"}, optional
    axis : (3,), optional
        The normal of a plane, towards the surface, or the axis of a cylinder; in space at the
        start.
    radius : float, optional [m]
        Of a sphere or cylinder about the frame.
    hollow : bool
        The surface is inside of the shape, or of closed facets.
    length : float, optional [m]
        Of a cylinder, half to each side of its frame; beyond it there is no contact.
    points : (n, 2), optional [m]
        Of a profile, as of a `Contact`.
    facets : path, optional
        A file of triangles in the axes of the frame [m], as "wall.stl". They act on the side of
        their normals.
    geometry : {"smooth", "flat"}
        How the facets of the second surface are read: as arcs between their corners, or flat.
    friction : float, Coulomb or Stribeck, optional
        The coefficient; what sticks does not move, without a spring.
    layer : float, optional [N/m^3]
        Stiffness per area of a layer between the surfaces, for flat against flat.
    margin : float, optional [m]
        Nodes that are nearer are candidates of contact in a step, by default within twice their
        motion in it.

    Examples
    --------
    >>> up = [0.0, 0.0, 1.0]
    >>> SurfaceContact("floor", ["ball.cap", "ground"], "plane", axis=up).meets_surface
    False
    """

    label = "contact {name!r}"
    group: ClassVar[str] = "contacts"
    presses_surfaces: ClassVar[bool] = True
    absent: ClassVar[Mapping[str, str]] = WITHOUT_LAW

    name: Name
    surfaces: Pair
    shape: Annotated[str, one_of(SHAPE_TYPES)] | None = None
    axis: OptionalDirection = NO_ARRAY
    radius: Positive | None = None
    hollow: bool = False
    length: Positive | None = None
    points: OptionalPoints = NO_ARRAY
    facets: FilePath | None = None
    geometry: Annotated[str, one_of(TARGET_GEOMETRIES)] = "smooth"
    friction: AnyCoefficient | None = None
    layer: Positive | None = None
    margin: Positive | None = None

    def validate(self) -> None:
        for place in self.surfaces[:1]:
            if not all(place.partition(".")):
                raise self.error(f"surfaces: expected BODY.SURFACE first, found {place!r}")
        given = [key for key in ("shape", "facets") if getattr(self, key) is not None]
        if len(given) > 1:
            raise self.error("expected one of shape and facets, found both")
        if self.shape is not None:
            self.check_shape()
        elif given_keys := [key for key in KEYS_OF_SHAPE if self._has(key)]:
            raise self.error(f"{given_keys[0]}: expected with shape, found no shape")
        if self.meets_surface:
            if not self.target[1]:
                raise self.error(
                    f"expected shape or facets on {self.surfaces[1]!r}, or BODY.SURFACE, found none"
                )
            if self.target[0] == GROUND:
                raise self.error(
                    f"surfaces: expected shape or facets on {self.surfaces[1]!r}: the ground has "
                    "no flexible surfaces"
                )
        if self.target[0] == self.body:
            raise self.error(f"surfaces: expected two bodies, found {list(self.surfaces)}")
        if self.facets is not None:
            _ = self.rigid_surface  # errors of the file come before a run

    def _has(self, key: str) -> bool:
        value = getattr(self, key)
        # closed facets may be hollow too
        is_of_facets = key == "hollow" and self.facets is not None
        return value is not None and value is not False and not is_of_facets

    @cached_property
    def rigid_surface(self) -> Surface:
        """The facets of the file, in the axes of the frame that carries them."""
        assert self.facets is not None
        try:
            return read_facets(self.facets, self.hollow)
        except ModelError as error:
            raise self.error(f"facets: {error}") from error

    @property
    def in_words(self) -> str:
        """What touches what, as `duhamel check` says it."""
        if self.shape is not None:
            met = f"a {'hollow ' if self.hollow else ''}{self.shape} on {self.carrier!r}"
        elif self.facets is not None:
            n = len(self.rigid_surface.facets)
            met = f"{n} {self.geometry} facets of {Path(self.facets).name} on {self.carrier!r}"
        else:
            met = f"the {self.geometry} surface {self.target[1]!r} of {self.target[0]!r}"
        layer = "" if self.layer is None else f", with a layer of {self.layer:g} N/m^3"
        return f"surface {self.surface!r} of {self.body!r} on {met}{layer}"

    @property
    def between(self) -> tuple[str, str]:
        """The target first, as of contacts of balls."""
        return self.surfaces[1], self.surfaces[0]

    @property
    def body(self) -> str:
        """The body of the surface that has the rows."""
        return self.surfaces[0].partition(".")[0]

    @property
    def surface(self) -> str:
        """The name of that surface on its body."""
        return self.surfaces[0].partition(".")[2]

    @property
    def meets_surface(self) -> bool:
        """Whether the target is a surface of a flexible body."""
        return self.shape is None and self.facets is None

    @property
    def target(self) -> tuple[str, str]:
        """The body and the surface, or frame, that it meets."""
        body, _, name = self.surfaces[1].partition(".")
        return body, name

    @property
    def flexible_bodies(self) -> tuple[str, ...]:
        """The bodies whose surfaces it presses."""
        return (self.body, self.target[0]) if self.meets_surface else (self.body,)

    @property
    def carrier(self) -> str:
        """The frame that carries a shape or facets; of the bare ground its origin."""
        return self.surfaces[1]

    @property
    def size(self) -> float:
        """The depth [m] at which a point is pushed out of its shape on the other side."""
        if self.hollow:
            return math.inf
        if self.points is not None:
            return 0.5 * float(np.ptp(self.points, axis=0).min())
        return math.inf if self.radius is None else self.radius

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis

    def shape_in(self, poses: Mapping[str, Any], frame: str) -> ShapeInFrame:
        """The shape in the axes of its frame, by the poses of frames at the start."""
        if self.shape is None:
            return ShapeInFrame(-1, np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), [])
        axis, across = self.axes_of_shape(poses[frame].R)
        return ShapeInFrame(self.kind.number, axis, across, self.shape_parameters())
