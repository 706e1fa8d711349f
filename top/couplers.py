"""Couplers of joint coordinates: gears, racks, screws, and any linear equation."""

from collections.abc import Sequence

from duhamel.solver.couplings.couplers import Coupler
from duhamel.solver.schema.values import Named
from duhamel.solver.signals.signal import DrivingSignal

Coordinate = str | Named
"""a joint that has one coordinate, or "JOINT.COORDINATE" """


def gear(
    first: Coordinate,
    second: Coordinate,
    *,
    teeth: tuple[float, float] | None = None,
    radii: tuple[float, float] | None = None,
    internal: bool = False,
    offset: DrivingSignal | None = None,
    name: str = "",
) -> Coupler:
    """Two wheels that roll on one another: `teeth[0] q_1 + teeth[1] q_2 = offset`.

    Parameters
    ----------
    first, second
        The joints about whose axes they turn, or "JOINT.COORDINATE".
    teeth, radii : (2,)
        Their numbers of teeth, or their radii; of bevel gears the mean ones.
    internal : bool
        The second is a ring gear: `teeth[0] q_1 - teeth[1] q_2 = offset`.
    offset : signal
        By default that of the bodies as they are placed.
    name : str
    """
    return Coupler(
        name, "gear", (first, second), teeth=teeth, radii=radii, internal=internal, offset=offset
    )


def rack(pinion: Coordinate, rack: Coordinate, radius: float, *, name: str = "") -> Coupler:
    """A pinion of a radius [m] on a rack: `radius q_1 = q_2`, an angle and a distance."""
    return Coupler(name, "rack", (pinion, rack), radius=radius)


def screw(angle: Coordinate, distance: Coordinate, lead: float, *, name: str = "") -> Coupler:
    """A nut on a screw: `lead / (2 pi) q_1 = q_2`; lead [m]: the way of the nut in a full turn."""
    return Coupler(name, "screw", (angle, distance), lead=lead)


def linear(
    coordinates: Sequence[Coordinate],
    ratios: Sequence[float],
    *,
    offset: DrivingSignal | None = None,
    name: str = "",
) -> Coupler:
    """Any linear equation of coordinates: `sum_k ratios[k] q_k = offset`."""
    return Coupler(name, "linear", coordinates, ratios=tuple(ratios), offset=offset)


__all__ = ["gear", "linear", "rack", "screw"]
