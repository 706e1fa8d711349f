"""Coefficients of friction, and the friction of a joint."""

from typing import Annotated, Any

from ..errors import ModelError
from ..schema.entry import Entry, Takes, entry
from ..schema.forms import Family
from ..schema.tables import read_member
from ..schema.values import NotNegative, Positive

FRICTION_COEFFICIENTS = Family("coefficient of friction")


@FRICTION_COEFFICIENTS.bare_number
@entry(eq=True)
class Coulomb(Entry):
    """The same coefficient at rest and in motion."""

    sliding: NotNegative

    @property
    def static(self) -> float:
        return self.sliding

    @property
    def speed(self) -> float:
        return 1.0


@FRICTION_COEFFICIENTS.in_files("static")
@entry(eq=True)
class Stribeck(Entry):
    """mu = sliding + (static - sliding) exp(-(v / speed)^2) at a speed of slip v [m/s]."""

    static: NotNegative
    sliding: NotNegative
    speed: Positive

    def validate(self) -> None:
        if self.static < self.sliding:
            raise self.error(
                f"static: expected no less than sliding, {self.sliding:g}, got {self.static:g}"
            )


FrictionCoefficient = Coulomb | Stribeck


def _coefficient(value: Any) -> FrictionCoefficient:
    if isinstance(value, FrictionCoefficient):
        return value
    try:
        coefficient: FrictionCoefficient = read_member(FRICTION_COEFFICIENTS, value)
    except ModelError as error:
        raise ValueError from error
    return coefficient


AnyCoefficient = Annotated[
    FrictionCoefficient,
    FRICTION_COEFFICIENTS,
    Takes("a number of at least 0, or static, sliding and speed", _coefficient, Any),
]


@entry(eq=True)
class JointFriction(Entry):
    """Friction in a revolute or prismatic joint, by its own forces.

    coefficient: mu of the normal force, which of a revolute joint is that across the axis plus that
    along it, at `radius` [m] from the axis; width [m]: distance of two bearings, which carry
    moments across the axis as pairs of forces, by default none; preload [N]: a normal force that is
    always there; viscous [N m s/rad, N s/m]. What sticks is held by a spring, `stiffness` [N m/rad,
    N/m] with `damping`, by default as stiff as the step resolves.
    """

    coefficient: AnyCoefficient = Coulomb(0.0)
    radius: Positive | None = None
    width: Positive | None = None
    preload: NotNegative = 0.0
    viscous: NotNegative = 0.0
    stiffness: Positive | None = None
    damping: NotNegative | None = None
