"""Bodies: rigid ones, superelements, their frames, and where they start."""

from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from typing import Annotated, Literal

import numpy as np

from ...superelement import Rotation, Superelement
from ...superelement.rotation import N_INERTIA_CHANGES
from ..arrays import Array
from ..schema.entry import Entry, Flattened, entry
from ..schema.values import NO_ARRAY, ZERO_VECTOR, FrameName, Inertia, Name, Positive, Vector
from .body_shapes import AnyBodyShape

SecondOrder = Literal["auto", "full", "off"]
INERTIA_TOLERANCE = 1e-6
"""largest relative excess of a principal inertia over the sum of the other two: that of rounding"""


@entry()
class Frame(Entry):
    """A point and three axes fixed in a body.

    Parameters
    ----------
    position : (3,) [m]
    rotation : (3,) [rad]
        A rotation vector; both in body axes.

    Examples
    --------
    >>> Frame((0.5, 0.0, 0.0)).rotation.tolist()
    [0.0, 0.0, 0.0]
    """

    position: Vector = ZERO_VECTOR
    rotation: Vector = ZERO_VECTOR


@entry(eq=True)
class Place(Entry):
    """The start of a body by a frame, which coincides with a frame of another body, axes included.

    Parameters
    ----------
    frame : str
        A frame of the body itself; "" is its center of mass, with body axes.
    on : str
        "BODY.FRAME", or "BODY" for its center of mass.

    Examples
    --------
    >>> Start(place=Place("root", on="hub.rim")).place.on
    'hub.rim'
    """

    frame: Name
    on: FrameName


@entry()
class Start(Entry):
    """Position, orientation and velocities of a body at the start.

    Parameters
    ----------
    position : (3,) [m]
        Of the center of mass, in space.
    rotation : (3,) [rad]
        A rotation vector, in space.
    place : Place, optional
        Instead of both.
    velocity : (3,) [m/s]
        Of the center of mass, in space.
    angular_velocity : (3,) [rad/s]
        In body axes.

    Examples
    --------
    >>> Start(position=(0.0, 0.0, 1.0)).velocity.tolist()
    [0.0, 0.0, 0.0]
    """

    position: Vector = ZERO_VECTOR
    rotation: Vector = ZERO_VECTOR
    place: Place | None = None
    velocity: Vector = ZERO_VECTOR
    angular_velocity: Vector = ZERO_VECTOR

    def validate(self) -> None:
        if self.place is not None and (self.position.any() or self.rotation.any()):
            raise self.error("expected `place`, or `position` and `rotation`, got both")


@entry()
class RigidBody(Entry):
    """A rigid body with named frames.

    Parameters
    ----------
    mass : float [kg]
    inertia : (3,) or (3, 3) [kg m^2]
        About the center of mass in body axes; three numbers are principal ones. No principal
        inertia exceeds the sum of the other two, which no distribution of mass allows.
    frames : mapping of Frame or (3,)
        By name; a position [m] stands for a frame along the body axes.
    start : Start
    shape : Box, Cylinder, Sphere or Surface, optional
        How pictures show it, without effect on the motion; by default a box of its inertia.

    Examples
    --------
    >>> RigidBody(2.0, [0.1, 0.1, 0.1], {"pin": [0.0, 0.0, 0.5]}).frames["pin"].position.tolist()
    [0.0, 0.0, 0.5]
    """

    mass: Positive
    inertia: Inertia
    frames: Mapping[str, Frame] = field(default_factory=dict)
    start: Annotated[Start, Flattened()] = field(default_factory=Start)
    shape: AnyBodyShape | None = NO_ARRAY

    def validate(self) -> None:
        frames = {
            name: frame if isinstance(frame, Frame) else Frame(frame)
            for name, frame in self.frames.items()
        }
        # The class is frozen: here alone, while it is made, positions become frames.
        object.__setattr__(self, "frames", frames)
        # A real body has J_3 <= J_1 + J_2; a plate has equality, which rounding may exceed.
        principal = np.linalg.eigvalsh(self.inertia).tolist()
        if not principal[0] > 0.0:
            raise self.error(f"inertia: expected positive principal values, got {principal}")
        if principal[2] > (1.0 + INERTIA_TOLERANCE) * (principal[0] + principal[1]):
            raise self.error(
                "inertia: expected principal values of which none exceeds the sum of the other "
                f"two, got {principal}"
            )


class _OfSuperelement:
    """Mass, inertia and frames of a body with a `superelement`: its interfaces."""

    superelement: Superelement

    @property
    def mass(self) -> float:
        return self.superelement.mass

    @property
    def inertia(self) -> Array:
        return self.superelement.J_rot

    @cached_property
    def frames(self) -> Mapping[str, Frame]:
        return {each.name: Frame(each.X) for each in self.superelement.interfaces}


@entry()
class FlexibleBody(_OfSuperelement, Entry):
    """A body that moves as a whole and deforms as its superelement; its frames are its interfaces.

    Parameters
    ----------
    superelement : Superelement
    start : Start
    source : str
        The path of the file of the superelement, "" if there is none: of its base, if it was
        scaled.
    second_order : {"auto", "full", "off"}
        Whether its elastic motion has terms of second order, which fast rotation and large loads
        need: where the superelement has them, or always (an error where it has not), or never.

    Examples
    --------
    >>> import duhamel as du
    >>> import numpy as np
    >>> points = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 6)
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> beam = du.Beam(points, section=du.Section.rectangle(steel, width=0.01, height=0.01))
    >>> beam.interface("tip", points[-1])
    >>> sorted(FlexibleBody(beam.superelement(step=1e-4)).frames)
    ['tip']
    """

    superelement: Superelement
    start: Annotated[Start, Flattened()] = field(default_factory=Start)
    source: str = ""
    second_order: SecondOrder = "auto"

    def validate(self) -> None:
        _require_superelement(self, self.superelement)
        if self.second_order == "full" and self.superelement.rotation is None:
            raise self.error(
                f"second_order = 'full': superelement {self.superelement.name!r} has no terms of "
                "second order: its body file needs [rotation]"
            )

    @property
    def rotation(self) -> Rotation | None:
        """The terms of second order, None where it has none."""
        # "auto" and "full" are the same here: `validate` has refused "full" without such terms.
        return None if self.second_order == "off" else self.superelement.rotation

    @property
    def n_outer(self) -> int:
        """Elastic dofs of the interfaces, then of load patterns, then of sensors."""
        return self.superelement.n_c + self.superelement.n_channels

    @property
    def n_inner(self) -> int:
        """Elastic dofs of terms of second order: six of inertia, then the coordinates q."""
        second = self.rotation
        return 0 if second is None else N_INERTIA_CHANGES + second.r

    @property
    def n_dofs(self) -> int:
        """The number of elastic dofs, outer and inner ones."""
        return self.n_outer + self.n_inner


@entry()
class RigidSuperelement(_OfSuperelement, Entry):
    """A rigid body with the mass, inertia, interfaces and outline of a superelement.

    Its interfaces are frames, which carry moments too. In model files: `rigid = true` beside
    `superelement`. It is made as a `FlexibleBody`: see there for an example.

    Parameters
    ----------
    superelement : Superelement
    start : Start
    source : str
        The path of the file of the superelement, "" if there is none.
    """

    superelement: Superelement
    start: Annotated[Start, Flattened()] = field(default_factory=Start)
    source: str = ""

    def validate(self) -> None:
        _require_superelement(self, self.superelement)


def _require_superelement(body: Entry, given: object) -> None:
    if not isinstance(given, Superelement):
        raise body.error(f"superelement: expected one that superelement.read gave, got {given!r}")


Body = RigidBody | FlexibleBody | RigidSuperelement
