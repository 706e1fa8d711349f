"""Coefficients of friction, the friction of a joint, and the spring that holds what sticks."""

import math
from dataclasses import dataclass
from typing import Annotated

from ..schema.entry import Entry, entry
from ..schema.forms import Family
from ..schema.tables import member
from ..schema.values import NotNegative, Positive

FRICTION_COEFFICIENTS = Family("coefficient of friction")


@FRICTION_COEFFICIENTS.bare_number
@entry(eq=True)
class Coulomb(Entry):
    """A coefficient of friction that is the same at rest and in motion.

    Parameters
    ----------
    sliding : float

    Examples
    --------
    >>> Coulomb(0.3).sliding
    0.3
    """

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
    """Friction that falls with the speed of slip v.

        mu = sliding + (static - sliding) exp(-(v / speed)^2)

    Parameters
    ----------
    static, sliding : float
    speed : float [m/s]

    Examples
    --------
    >>> Stribeck(static=0.4, sliding=0.3, speed=0.01).static
    0.4
    """

    static: NotNegative
    sliding: NotNegative
    speed: Positive

    def validate(self) -> None:
        if self.static < self.sliding:
            raise self.error(
                f"static: expected no less than sliding, {self.sliding:g}, got {self.static:g}"
            )


FrictionCoefficient = Coulomb | Stribeck


_COEFFICIENTS = "a number of at least 0, or static, sliding and speed"
AnyCoefficient = Annotated[
    FrictionCoefficient,
    FRICTION_COEFFICIENTS,
    member(FRICTION_COEFFICIENTS, _COEFFICIENTS, FrictionCoefficient),
]


@entry(eq=True)
class JointFriction(Entry):
    """Friction in a revolute or prismatic joint, by the forces of the joint itself, or constant.

    Parameters
    ----------
    coefficient : float, Coulomb or Stribeck
        Of the normal force; that of a revolute joint is the force across the axis plus that along
        it.
    radius : float, optional [m]
        Of a revolute joint: the distance from its axis at which friction acts.
    width : float, optional [m]
        Distance of two bearings, which carry moments across the axis as pairs of forces; by default
        moments cause no friction.
    preload : float [N]
        A normal force that is always there.
    viscous : float [N m s/rad, N s/m]
    stiffness, damping : float, optional [N m/rad, N/m; N m s/rad, N s/m]
        Of the spring that holds what sticks, by default as stiff as the step resolves.
    torque, force : float [N m, N]
        Coulomb friction that the forces of the joint do not change, instead of coefficient, radius,
        width and preload: the torque of a revolute joint, the force of a prismatic one.

    Examples
    --------
    >>> JointFriction(0.1, radius=0.01, preload=5.0).preload
    5.0
    """

    coefficient: AnyCoefficient = Coulomb(0.0)
    radius: Positive | None = None
    width: Positive | None = None
    preload: NotNegative = 0.0
    viscous: NotNegative = 0.0
    stiffness: Positive | None = None
    damping: NotNegative | None = None
    torque: NotNegative = 0.0
    force: NotNegative = 0.0

    def validate(self) -> None:
        if self.constant == 0.0:
            return
        key = "torque" if self.torque > 0.0 else "force"
        given = {
            "coefficient": self.coefficient.static,
            "radius": self.radius,
            "width": self.width,
            "preload": self.preload,
            "force": self.force if key == "torque" else 0.0,
        }
        if others := [name for name, value in given.items() if value]:
            raise self.error(f"{key}: constant friction takes no {others[0]}, got both")

    @property
    def constant(self) -> float:
        """Friction whatever the forces of the joint [N m, N]."""
        return self.torque or self.force

    @property
    def steady(self) -> tuple[FrictionCoefficient, float]:
        """The coefficient, and the normal force that is always there, times the radius if any."""
        if self.constant > 0.0:
            # Any pair with this product would do: the forces of the joint count for nothing.
            return Coulomb(1.0), self.constant
        return self.coefficient, self.preload * (self.radius or 1.0)


RESOLVED_TURN = 0.3
"""angular frequency of a bristle times the step, where nobody says how stiff it is"""
DAMPING_OF_BRISTLE = 0.2
"""damping of a bristle over sqrt(stiffness inertia), where nobody says: a ratio of 0.1"""


@dataclass(frozen=True)
class Bristle:
    """Friction of the last rows of a coupling, with the spring and damper of what sticks."""

    coefficient: FrictionCoefficient
    stiffness: float
    damping: float
    viscous: float = 0.0
    preload: float = 0.0


def resolved_spring(
    stiffness: float | None, damping: float | None, inertia: float, h: float
) -> tuple[float, float]:
    """Stiffness and damping of a bristle that moves an inertia, by default those of its step."""
    # omega h = RESOLVED_TURN: as stiff as the step resolves, so that sticking creeps least.
    stiffness = inertia * (RESOLVED_TURN / h) ** 2 if stiffness is None else stiffness
    damping = DAMPING_OF_BRISTLE * math.sqrt(stiffness * inertia) if damping is None else damping
    return stiffness, damping
