"""Contacts of a ball with a shape.

A ball of radius r about the second frame, or a point (r = 0), meets a shape that the first frame
carries: a plane, or a sphere or cylinder of radius R about it, from outside or, hollow, from
inside. Force and damping are those of `ContactLaw` (solver/laws/contact.py), or of
`PlasticContactLaw` (plastic_contact.py).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ..arrays import Array
from ..laws.hertz import Patch, patch_of
from ..schema.entry import Entry, Flattened, entry, one_of
from ..schema.values import (
    NO_ARRAY,
    Name,
    NotNegative,
    Numbers,
    OptionalDirection,
    OptionalPoints,
    Pair,
    Positive,
    ZeroOrPositive,
)
from ..step.gaps import FirstSlip, Gap, SecondSlip, gap_parameters
from .carried_shape import SHAPE_TYPES, CarriedShape
from .coupling import Coupling, Inertia, side_names
from .friction import AnyCoefficient, Bristle, resolved_spring
from .impact import AnyContactLaw, Impact
from .rows import Row, Sides

NO_PATCH: Any = (0.0, 0.0)


DEEPEST_START = 0.1
"""penetration over the size of the model at which a run does not start"""


@entry(eq=True)
class Hertz(Entry):
    """The materials of two bodies in contact, for Hertz's law.

    Parameters
    ----------
    E : (2,) [Pa]
    nu : (2,)
    yield_pressure : float, optional [Pa]
        The largest contact pressure of the softer body: beyond it the contact deforms for good.
        1.6 times the yield strength where yielding begins below the surface, about 2.8 times where
        it has reached it.

    Examples
    --------
    >>> Hertz(E=[210e9, 70e9], nu=[0.3, 0.33]).nu
    (0.3, 0.33)
    """

    E: Numbers
    nu: Numbers
    yield_pressure: Positive | None = None

    def validate(self) -> None:
        if len(self.E) != 2 or not all(value > 0.0 for value in self.E):
            raise self.error(f"E: expected two positive numbers, got {list(self.E)}")
        if len(self.nu) != 2 or not all(0.0 <= value <= 0.5 for value in self.nu):
            raise self.error(f"nu: expected two numbers from 0 to 0.5, got {list(self.nu)}")

    @property
    def modulus(self) -> float:
        """E*, 1 / E* = sum of (1 - nu^2) / E."""
        return 1.0 / sum(_flexibility(E, nu) for E, nu in zip(self.E, self.nu, strict=True))

    def patch_compliance(self, radii: tuple[float, ...]) -> float:
        """16 (1 - nu^2) / (3 pi^2 E b): mean sinking of a patch of radius b under its own load."""
        return sum(
            16.0 / (3.0 * math.pi**2) * _flexibility(E, nu) / b
            for E, nu, b in zip(self.E, self.nu, radii, strict=True)
            if b > 0.0
        )


def _flexibility(E: float, nu: float) -> float:
    return (1.0 - nu**2) / E


@entry()
class Contact(CarriedShape, Entry, Coupling):
    """A ball about the second frame against a shape that the first carries.

    The force is that of one of `hertz`, `stiffness` and `law`.

    Parameters
    ----------
    name : str
    between : (2,) of str
        The frames of the shape and of the ball, see `Joint`.
    shape : {"plane", "sphere", "cylinder", "profile"}
    ball : float [m]
        The radius of the ball, 0 for a point.
    axis : (3,), optional
        The normal of a plane, towards the ball, or the axis of a cylinder; in space at the start.
    radius : float, optional [m]
        Of a sphere or cylinder about the first frame.
    hollow : bool
        The ball is inside.
    length : float, optional [m]
        Of a cylinder, half to each side of its frame; beyond it there is no contact.
    points : (n, 2), optional [m]
        Of a profile: a cubic spline across the axis, closed where the last point is the first,
        along e1, nearest to the x axis of the first frame, and e2 = axis x e1. Outside is to the
        right as one goes along.
    hertz : Hertz, optional
        The materials of both bodies.
    patch : (2,) [m]
        Radii of the patches of the first and second interface over which their motion is averaged.
        Hertz's law then leaves out the compliance of the patches, which the bodies have themselves.
    impact : Impact
        The force by the penetration. Model files have its keys beside those of the contact.
    friction : float, Coulomb or Stribeck, optional
    tangential_stiffness, tangential_damping : float, optional [N/m, N s/m]
        Of the contact before it slips.

    Examples
    --------
    >>> from duhamel.solver import Impact
    >>> hard, up = Impact(stiffness=1e6, restitution=0.8), [0.0, 0.0, 1.0]
    >>> Contact("floor", ["ground", "ball"], "plane", ball=0.02, axis=up, impact=hard).hollow
    False
    """

    label = "contact {name!r}"
    group: ClassVar[str] = "contacts"
    dimension: ClassVar[str] = "contact"
    opens: ClassVar[bool] = True

    name: Name
    between: Pair
    shape: Annotated[str, one_of(SHAPE_TYPES)]
    ball: ZeroOrPositive
    axis: OptionalDirection = NO_ARRAY
    radius: Positive | None = None
    hollow: bool = False
    length: Positive | None = None
    points: OptionalPoints = NO_ARRAY
    hertz: Hertz | None = None
    patch: Numbers = NO_PATCH
    impact: Annotated[Impact, Flattened()] = field(default_factory=Impact)
    friction: AnyCoefficient | None = None
    tangential_stiffness: Positive | None = None
    tangential_damping: NotNegative | None = None

    def validate(self) -> None:
        self.check_shape()
        if self.hollow and self.radius is not None and self.ball >= self.radius:
            raise self.error(
                f"ball: expected less than the hollow radius, {self.radius:g}, got {self.ball:g}"
            )
        self._check_force()
        if (self.friction is None) != (self.tangential_stiffness is None):
            given, missing = "friction", "tangential_stiffness"
            if self.friction is None:
                given, missing = missing, given
            raise self.error(f"{missing}: needed with {given}")
        if self.tangential_damping is not None and self.friction is None:
            raise self.error("tangential_damping: expected with friction, found no friction")

    def law(self) -> AnyContactLaw:
        """The law of the gap."""
        if self.hertz is None:
            return self.impact.beyond((0.0, math.inf))
        stiffness = self.hertz.modulus * self._patch.stiffness
        if self.hertz.yield_pressure is not None:
            yield_force = self._patch.force_at(self.hertz.yield_pressure, stiffness)
            return self.impact.plastic_hertzian(stiffness, yield_force)
        return self.impact.hertzian(stiffness, self.hertz.patch_compliance(self.patch))

    @property
    def type(self) -> str:
        return self.shape

    @property
    def described(self) -> str:
        return self.owner

    @property
    def in_words(self) -> str:
        ball = f"ball of {self.ball:g} m" if self.ball else "point"
        radius = "" if self.radius is None else f" of {self.radius:g} m"
        where = f"{'inside' if self.hollow else 'on'} a {self.type}{radius}"
        return f"{ball} at {self.between[1]}, {where} at {self.between[0]}"

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """The gap, and slip along two tangents where there is friction."""
        # A contact stands between one pair of frames; couplers between several.
        (own,) = sides
        A, B, (axis, across) = own.frame_a, own.frame_b, self.axes_of_shape(own.pose_a.R)
        gap = Row(Gap.number, A, B, axis, across, laws=(self.law(),), normal=(1.0, 0))
        slips = [
            Row(kind.number, A, B, axis, across, has_friction=True)
            for kind in (FirstSlip, SecondSlip)
        ]
        rows = [gap, *slips] if self.friction is not None else [gap]
        number, parameters, size = self.kind.number, self._parameters(), self._size
        return [replace(row, shape=number, parameters=parameters, size=size) for row in rows]

    def bristle(self, inertia: Inertia, sides: Sides, h: float) -> Bristle | None:
        if self.friction is None:
            return None
        spring = self.tangential_stiffness, self.tangential_damping
        return Bristle(self.friction, *resolved_spring(*spring, inertia(None), h))

    def loaded_by_moments(self, rows: Sequence[Row]) -> Mapping[str, str]:
        first, second = side_names(self)
        # The force acts at the touching point, away from the origin of the frame that carries the
        # shape. A ball has its force through its center unless it rubs.
        causes = {first: f"{self.owner}, whose shape it carries"}
        if self.friction is not None and self.ball > 0.0:
            causes[second] = f"{self.owner}, with friction on a ball"
        return causes

    def check_depth(self, depth: float, size: float) -> None:
        """`ModelError` for a ball that is deeper than its radius, or than a tenth of the model."""
        # Once its center is beyond the surface, the ball is pushed out on the other side; and a
        # force of a tenth of the model throws everything apart.
        limits = {"a tenth of the size of the model": DEEPEST_START * size}
        if self.ball > 0.0:
            limits["the radius of its ball"] = self.ball
        for name, limit in limits.items():
            if depth > limit:
                raise self.error(f"starts {depth:.6g} m deep: expected at most {name}, {limit:.6g}")

    def _parameters(self) -> list[float]:
        """The parameters of compiled code: ball, side, then those of the shape."""
        return gap_parameters(self.ball, self.hollow, self.shape_parameters())

    @property
    def _size(self) -> float:
        """A length [m] within which the ball meets or passes the shape; infinite for a plane.

        The radii of both together; for a profile the shortest distance of its points, and the ball.
        """
        if self.points is not None:
            spans = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
            # A profile has no radius; features of the curve are about as large as its shortest
            # chord.
            return self.ball + float(spans.min())
        return math.inf if self.radius is None else self.ball + self.radius

    @property
    def patch_over_radius(self) -> float:
        """The semi-axes of Hertz's patch over the smaller radius along each, the larger ratio.

        At a penetration of 1 m: it grows with the root of that.
        """
        # Hertz's ellipse is long where the curvature is small.
        along, around = self._curvatures
        patch = self._patch
        sizes = (patch.long, patch.short) if along <= around else (patch.short, patch.long)
        # Flat and hollow surfaces bound no patch by their own radius.
        shape = math.inf if self.radius is None or self.hollow else self.radius
        # Along its axis a cylinder is straight: there the ball alone has a radius.
        ball_alone = self.shape == "cylinder"
        return max(
            sizes[0] / (self.ball if ball_alone else min(self.ball, shape)),
            sizes[1] / min(self.ball, shape),
        )

    @property
    def _patch(self) -> Patch:
        return patch_of(*self._curvatures)

    @property
    def _curvatures(self) -> tuple[float, float]:
        """Sums of the curvatures of ball and shape [1/m], along and around the axis."""
        own = 1.0 / self.ball
        # In a hollow shape the curvatures have opposite signs.
        around = own if self.radius is None else own + (-1.0 if self.hollow else 1.0) / self.radius
        return (around if self.shape == "sphere" else own), around

    def _check_force(self) -> None:
        if self.hertz is not None and self.points is not None:
            raise self.error("hertz: a profile has no radius: expected stiffness or law")
        given = {"hertz": self.hertz, "stiffness": self.impact.stiffness, "law": self.impact.law}
        present = [name for name, value in given.items() if value is not None]
        if len(present) != 1:
            found = " and ".join(present) or "none"
            raise self.error(f"expected one of hertz, stiffness and law, found {found}")
        if self.hertz is not None and self.ball == 0.0:
            raise self.error("hertz: a point has no radius: expected ball > 0, or stiffness")
        if len(self.patch) != 2 or min(self.patch) < 0.0:
            raise self.error(f"patch: expected two radii of at least 0, got {list(self.patch)}")
        if any(self.patch) and self.hertz is None:
            raise self.error("patch: expected with hertz, found no hertz")
        if self.hertz is not None and self.hertz.yield_pressure is not None:
            self.impact.check_plastic("yield_pressure")
            # The compliance of a patch that yields is not that of the elastic body.
            if any(self.patch):
                raise self.error("patch: expected none with yield_pressure")
        elif self.hertz is not None and self.impact.spot == "new":
            raise self.error("spot: expected with yield_pressure, found none in hertz")
