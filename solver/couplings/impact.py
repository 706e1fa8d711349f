"""The force of a contact or a stop by its penetration, and what an impact loses."""

import math
from itertools import pairwise
from typing import Annotated, Literal

from ..laws.contact import ContactLaw
from ..laws.plastic_contact import PlasticContactLaw
from ..schema.entry import Entry, entry
from ..schema.values import NotNegative, Numbers, Positive, number

AnyContactLaw = ContactLaw | PlasticContactLaw
UpToOne = Annotated[
    float, number("a number above 0, at most 1", float, lambda ratio: 1e-100 <= ratio <= 1.0)
]


@entry(eq=True)
class ForceTable(Entry):
    """The force of a contact over its penetration, straight beyond the last point.

    Parameters
    ----------
    penetration : (n,) [m, rad]
        Ascending from 0.
    force : (n,) [N, N m]

    Examples
    --------
    >>> ForceTable([0.0, 1e-3, 2e-3], [0.0, 100.0, 400.0]).force[-1]
    400.0
    """

    penetration: Numbers
    force: Numbers

    def validate(self) -> None:
        for name, values in (("penetration", self.penetration), ("force", self.force)):
            if len(values) < 2 or values[0] != 0.0:
                raise self.error(f"{name}: expected two or more numbers from 0, got {list(values)}")
            if any(b <= a for a, b in pairwise(values)):
                raise self.error(f"{name}: expected rising numbers, got {list(values)}")
        if len(self.penetration) != len(self.force):
            raise self.error(
                f"expected as many forces as penetrations, got {len(self.force)} and "
                f"{len(self.penetration)}"
            )


@entry(eq=True)
class Impact(Entry):
    """The force of a contact or stop by its penetration d, and what an impact loses.

    Parameters
    ----------
    stiffness : float, optional [N/m^exponent, N m/rad^exponent]
    exponent : float, optional
        The force is stiffness d^exponent.
    law : ForceTable, optional
        The force instead of both.
    restitution : float
        Exact for two free bodies at the speed of each impact.
    damping : float [s/m, s/rad]
        Instead of restitution: the force is multiplied by 1 + damping d'.
    slow : float [m/s, rad/s]
        Slower impacts are damped as one of this speed.
    yield_force : float, optional [N, N m]
        The force at which the contact begins to deform for good, so that restitution falls with
        speed (docs/theory.md, Contact). With `stiffness`, without restitution and damping.
    post_yield : float, optional
        The slope of the force beyond it, over that at yield: above 0, by default 1, which is
        Thornton's law. With an exponent of 1 it must be less.
    spot : {"same", "new"}
        Whether a later impact meets the dent of an earlier one.

    Examples
    --------
    >>> Impact(stiffness=1e6, restitution=0.5).slow
    0.01
    """

    stiffness: Positive | None = None
    exponent: Positive | None = None
    law: ForceTable | None = None
    restitution: Positive = 1.0
    damping: NotNegative = 0.0
    slow: Positive = 0.01
    yield_force: Positive | None = None
    post_yield: UpToOne | None = None
    spot: Literal["same", "new"] = "same"

    def validate(self) -> None:
        if not self.restitution <= 1.0:
            raise self.error(
                f"restitution: expected more than 0 and at most 1, got {self.restitution:g}"
            )
        # Restitution determines the damping at the speed of each impact.
        if self.damping > 0.0 and self.restitution < 1.0:
            raise self.error("expected restitution or damping, got both")
        if self.exponent is not None and self.stiffness is None:
            raise self.error("exponent: expected with stiffness, found no stiffness")
        # Below 1 the stiffness at first touch is infinite.
        if self.exponent is not None and self.exponent < 1.0:
            raise self.error(f"exponent: expected 1 or more, got {self.exponent:g}")
        if self.yield_force is not None:
            self._check_yield()
        elif self.post_yield is not None:
            raise self.error("post_yield: expected with yield_force, found no yield_force")
        # Contacts of Hertz, which yield at a pressure, are checked where that is known.
        elif self.spot == "new" and (self.stiffness is not None or self.law is not None):
            raise self.error("spot: expected with yield_force, found no yield_force")

    def check_plastic(self, key: str) -> None:
        """`ModelError` for losses beside those of a contact that yields by a key."""
        if self.restitution < 1.0 or self.damping > 0.0:
            name = "damping" if self.damping > 0.0 else "restitution"
            raise self.error(f"{name}: expected none with {key}, which determines the losses")

    def beyond(self, limits: tuple[float, float]) -> AnyContactLaw:
        """The law of a coordinate that is free between limits."""
        stiffness, exponent = self.stiffness or 0.0, self.exponent or 1.0
        if self.yield_force is not None:
            return self._plastic(limits, stiffness, exponent, self.yield_force)
        return self._law(limits, stiffness, exponent)

    def hertzian(self, stiffness: float, patch: float) -> ContactLaw:
        """The law of a gap whose stiffness [N/m^1.5] follows from materials and radii."""
        return self._law((0.0, math.inf), stiffness, 1.5, patch)

    def plastic_hertzian(self, stiffness: float, yield_force: float) -> PlasticContactLaw:
        """The same law with a yield force [N], which follows from materials and radii too."""
        return self._plastic((0.0, math.inf), stiffness, 1.5, yield_force)

    def _check_yield(self) -> None:
        if self.stiffness is None:
            raise self.error("yield_force: expected with stiffness, found no stiffness")
        self.check_plastic("yield_force")
        # Linear up to yield and as steep beyond it, the law would lose nothing.
        if (self.exponent or 1.0) == 1.0 and (self.post_yield or 1.0) == 1.0:
            raise self.error(
                "yield_force: expected with post_yield below 1, or an exponent above 1"
            )

    def _plastic(
        self, limits: tuple[float, float], stiffness: float, exponent: float, yield_force: float
    ) -> PlasticContactLaw:
        new_spot, slope = self.spot == "new", self.post_yield or 1.0
        return PlasticContactLaw(limits, stiffness, exponent, yield_force, slope, new_spot)

    def _law(
        self, limits: tuple[float, float], stiffness: float, exponent: float, patch: float = 0.0
    ) -> ContactLaw:
        return ContactLaw(
            limits,
            stiffness,
            exponent,
            self.restitution,
            self.slow,
            self.damping,
            patch,
            penetration=self.law.penetration if self.law else (),
            force=self.law.force if self.law else (),
        )
