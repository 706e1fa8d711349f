"""Contacts of a ball with a shape.

A ball of radius r about the second frame, or a point (r = 0), meets a shape that the first frame
carries: a plane, or a sphere or cylinder of radius R about it, from outside or, hollow, from
inside. Force and damping are those of `ContactLaw` (solver/laws/contact.py).
"""

import math
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from ..arrays import Array
from ..laws.contact import ContactLaw
from ..laws.hertz import Patch, patch_of
from ..schema.entry import Beside, Entry, entry, one_of
from ..schema.values import (
    ABSENT,
    Name,
    NotNegative,
    Numbers,
    OptionalDirection,
    OptionalPoints,
    Pair,
    Positive,
)
from .friction import AnyCoefficient
from .impact import Impact

NO_PATCH: Any = (0.0, 0.0)


@dataclass(frozen=True)
class ShapeType:
    """Which keys a shape takes."""

    round: bool = False
    """has a radius"""
    hollow: bool = False
    """may be"""
    points: bool = False
    """goes through some"""
    axis: bool = False
    """needs one"""
    length: bool = False
    """may have one"""


SHAPE_TYPES = {
    "plane": ShapeType(axis=True),
    "sphere": ShapeType(round=True, hollow=True),
    "cylinder": ShapeType(round=True, hollow=True, axis=True, length=True),
    "profile": ShapeType(axis=True, points=True, hollow=True),
}


@entry(eq=True)
class Hertz(Entry):
    """Materials of the first and the second body: E [Pa] and nu."""

    E: Numbers
    nu: Numbers

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
class Contact(Entry):
    """A ball about the second frame against a shape that the first carries.

    axis (3,), in space at the start: the normal of a plane, towards the ball, or the axis of a
    cylinder; radius [m] of a sphere or cylinder about the first frame; hollow: the ball is inside;
    length [m] of a cylinder, half to each side of the frame, beyond which there is no contact;
    points (n, 2) [m] of a profile: a cubic spline across the axis through them, closed where the
    last is the first, along e1, nearest to the x axis of the first frame, and e2 = axis x e1; its
    outside is to the right as one goes along;
    ball [m]: its radius, 0 for a point. The force is that of one of `hertz`, `stiffness` and `law`.
    patch [m]: radii of the patches of the first and second interface over which their motion is
    averaged, whose own compliance the law of Hertz then leaves out. friction: a coefficient, with
    tangential_stiffness [N/m] of the contact before it slips and tangential_damping [N s/m].
    """

    label = "contact {name!r}"

    name: Name
    between: Pair
    shape: Annotated[str, one_of(SHAPE_TYPES)]
    ball: NotNegative
    axis: OptionalDirection = ABSENT
    radius: Positive | None = None
    hollow: bool = False
    length: Positive | None = None
    points: OptionalPoints = ABSENT
    hertz: Hertz | None = None
    patch: Numbers = NO_PATCH
    impact: Annotated[Impact, Beside()] = field(default_factory=Impact)
    friction: AnyCoefficient | None = None
    tangential_stiffness: Positive | None = None
    tangential_damping: NotNegative | None = None

    @property
    def kind(self) -> ShapeType:
        return SHAPE_TYPES[self.shape]

    def validate(self) -> None:
        self._check_shape()
        self._check_force()
        if (self.friction is None) != (self.tangential_stiffness is None):
            given, missing = "friction", "tangential_stiffness"
            if self.friction is None:
                given, missing = missing, given
            raise self.error(f"{missing}: needed with {given}")
        if self.tangential_damping is not None and self.friction is None:
            raise self.error("tangential_damping: belongs to friction, got none")

    def law(self) -> ContactLaw:
        """The law of the gap."""
        if self.hertz is None:
            return self.impact.beyond((0.0, math.inf))
        stiffness = self.hertz.modulus * self._patch.stiffness
        return self.impact.hertzian(stiffness, self.hertz.patch_compliance(self.patch))

    @property
    def patch_over_radius(self) -> float:
        """The semi-axes of Hertz's patch over the smaller radius along each, the larger ratio.

        At a penetration of 1 m: it grows with the root of that.
        """
        along, around = self._curvatures
        patch = self._patch
        sizes = (patch.long, patch.short) if along <= around else (patch.short, patch.long)
        shape = math.inf if self.radius is None or self.hollow else self.radius
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
        around = own if self.radius is None else own + (-1.0 if self.hollow else 1.0) / self.radius
        return (around if self.shape == "sphere" else own), around

    def _check_shape(self) -> None:
        kind = self.kind
        if kind.axis != (self.axis is not None):
            raise self.error(f"axis: a {self.shape} {'needs one' if kind.axis else 'takes none'}")
        if kind.round != (self.radius is not None):
            takes = "needs one" if kind.round else "takes none"
            raise self.error(f"radius: a {self.shape} {takes}")
        if kind.points != (self.points is not None):
            takes = "needs some" if kind.points else "takes none"
            raise self.error(f"points: a {self.shape} {takes}")
        if self.points is not None:
            self._check_points(self.points)
        if self.length is not None and not kind.length:
            raise self.error(f"length: a {self.shape} takes none")
        if self.hollow and not kind.hollow:
            raise self.error(f"hollow: a {self.shape} cannot be")
        if self.hollow and self.radius is not None and self.ball >= self.radius:
            raise self.error(
                f"ball: expected less than the hollow radius, {self.radius:g}, got {self.ball:g}"
            )

    def _check_points(self, points: Array) -> None:
        if len(points) < 4:
            raise self.error(f"points: expected four or more, got {len(points)}")
        if not np.linalg.norm(np.diff(points, axis=0), axis=1).all():
            raise self.error("points: expected each apart from the next")
        if self.hertz is not None:
            raise self.error("hertz: a profile has no radius: expected stiffness or law")

    def _check_force(self) -> None:
        given = {
            "hertz": self.hertz,
            "stiffness": self.impact.stiffness,
            "law": self.impact.law,
        }
        present = [name for name, value in given.items() if value is not None]
        if len(present) != 1:
            found = " and ".join(present) or "none"
            raise self.error(f"expected one of hertz, stiffness and law, found {found}")
        if self.hertz is not None and self.ball == 0.0:
            raise self.error("hertz: a point has no radius: expected ball > 0, or stiffness")
        if len(self.patch) != 2 or min(self.patch) < 0.0:
            raise self.error(f"patch: expected two radii of at least 0, got {list(self.patch)}")
        if any(self.patch) and self.hertz is None:
            raise self.error("patch: belongs to hertz, got none")
