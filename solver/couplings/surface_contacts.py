"""Contacts of surfaces of flexible bodies with shapes that frames carry.

The gap of each node of the surface, and its force, obey Signorini's law exactly, without a penalty:

    0 <= P_i  _|_  y_i >= 0

See solver/step/surfaces.py.
"""

from typing import Annotated, ClassVar

from ..arrays import Array
from ..schema.entry import Entry, entry, one_of
from ..schema.values import (
    NO_ARRAY,
    Name,
    OptionalDirection,
    OptionalPoints,
    Pair,
    Positive,
)
from .carried_shape import SHAPE_TYPES, CarriedShape


@entry()
class SurfaceContact(CarriedShape, Entry):
    """A surface of a flexible body against a shape that a frame carries.

    surfaces: the surface, "BODY.SURFACE", and the frame of the shape, "BODY.FRAME", or "ground".
    shape, axis, radius, hollow, points: as of contacts of balls. layer [N/m^3]: stiffness per area
    of a layer between the surfaces, for flat against flat. margin [m]: nodes that are nearer are
    candidates of contact in a step, by default within twice their motion in it.
    """

    label = "contact {name!r}"
    group: ClassVar[str] = "contacts"

    name: Name
    surfaces: Pair
    shape: Annotated[str, one_of(SHAPE_TYPES)]
    axis: OptionalDirection = NO_ARRAY
    radius: Positive | None = None
    hollow: bool = False
    points: OptionalPoints = NO_ARRAY
    layer: Positive | None = None
    margin: Positive | None = None

    length: ClassVar[None] = None
    """cylinders are endless"""

    def validate(self) -> None:
        self.check_shape()

    @property
    def between(self) -> tuple[str, str]:
        """The frame of the shape first, as of contacts of balls."""
        return self.surfaces[1], self.surfaces[0]

    @property
    def body(self) -> str:
        """The body of the surface."""
        return self.surfaces[0].partition(".")[0]

    @property
    def surface(self) -> str:
        """The name of the surface on its body."""
        return self.surfaces[0].partition(".")[2]

    @property
    def carrier(self) -> str:
        """The frame that carries the shape; of the bare ground its origin."""
        return self.surfaces[1]

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis
