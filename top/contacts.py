"""Contacts of a ball, about the second frame, with a shape that the first frame carries.

And contacts of surfaces of flexible bodies, by `surface`.
"""

import os
from typing import Any, Literal, TypedDict, Unpack

from duhamel.solver.couplings.contacts import Contact, Hertz
from duhamel.solver.couplings.friction import Coulomb, Stribeck
from duhamel.solver.couplings.impact import ForceTable, Impact
from duhamel.solver.couplings.surface_contacts import SurfaceContact
from duhamel.solver.schema.values import Framed
from numpy.typing import ArrayLike

IMPACT_KEYWORDS = (
    *("stiffness", "exponent", "restitution", "damping", "slow"),
    *("yield_force", "post_yield", "spot"),
)
"""keywords of the penetration's law"""


class Law(TypedDict, total=False):
    """The keywords of a contact's force: one of `hertz`, `stiffness` and `table`, and more."""

    hertz: Hertz
    """the materials of both bodies, for Hertz's law"""
    stiffness: float
    """[N/m^exponent], of the force stiffness d^exponent at a penetration d"""
    exponent: float
    table: ForceTable
    """forces over penetrations"""
    restitution: float
    """speed after an impact over that before it, by default 1"""
    damping: float
    """[s/m], instead of a restitution: the force is multiplied by 1 + damping d'"""
    slow: float
    """[m/s], slower impacts are damped as this one"""
    yield_force: float
    """[N], with a stiffness: beyond it the contact deforms for good (see `Impact`)"""
    post_yield: float
    """the slope of the force beyond it, over that at yield"""
    spot: Literal["same", "new"]
    """whether a later impact meets the dent of an earlier one"""
    friction: float | Coulomb | Stribeck
    """the coefficient of friction, with a tangential_stiffness"""
    tangential_stiffness: float
    """[N/m], of the contact before it slips"""
    tangential_damping: float
    """[N s/m]"""
    patch: tuple[float, float]
    """[m], radii over which the motion of both interfaces is averaged"""


def plane(
    carrier: str | Framed,
    ball_frame: str | Framed,
    normal: ArrayLike | str,
    *,
    ball: float = 0.0,
    name: str = "",
    **law: Unpack[Law],
) -> Contact:
    """A ball on a plane.

    Parameters
    ----------
    carrier, ball_frame
        Handles of the frame that carries the plane and of that at the center of the ball.
    normal : (3,), or "x", "y", "z"
        Of the plane, towards the ball, in space at the start.
    ball : float [m]
        The radius of the ball, 0 for a point.
    name : str
    **law
        The force, by the keywords of `Law`.
    """
    return _contact(name, "plane", carrier, ball_frame, {"axis": normal, "ball": ball}, law)


def sphere(
    carrier: str | Framed,
    ball_frame: str | Framed,
    radius: float,
    *,
    ball: float = 0.0,
    hollow: bool = False,
    name: str = "",
    **law: Unpack[Law],
) -> Contact:
    """A ball on, or with `hollow` inside, a sphere about the carrier; see `plane`."""
    shape = {"radius": radius, "ball": ball, "hollow": hollow}
    return _contact(name, "sphere", carrier, ball_frame, shape, law)


def cylinder(
    carrier: str | Framed,
    ball_frame: str | Framed,
    axis: ArrayLike | str,
    radius: float,
    *,
    length: float | None = None,
    ball: float = 0.0,
    hollow: bool = False,
    name: str = "",
    **law: Unpack[Law],
) -> Contact:
    """A ball on, or with `hollow` in the bore of, a cylinder about the carrier; see `plane`.

    length [m]: half to each side of the frame, beyond which there is no contact.
    """
    shape = {"axis": axis, "radius": radius, "length": length, "ball": ball, "hollow": hollow}
    return _contact(name, "cylinder", carrier, ball_frame, shape, law)


def profile(
    carrier: str | Framed,
    ball_frame: str | Framed,
    axis: ArrayLike | str,
    points: ArrayLike,
    *,
    ball: float = 0.0,
    hollow: bool = False,
    name: str = "",
    **law: Unpack[Law],
) -> Contact:
    """A ball on a cam: a cubic spline through points (n, 2) [m] across an axis; see `plane`.

    The outside is to the right as one goes along the points, which are closed where the last is the
    first.
    """
    shape = {"axis": axis, "points": points, "ball": ball, "hollow": hollow}
    return _contact(name, "profile", carrier, ball_frame, shape, law)


def surface(
    first: str | Framed,
    second: str | Framed,
    *,
    shape: Literal["plane", "sphere", "cylinder", "profile"] | None = None,
    axis: ArrayLike | str | None = None,
    radius: float | None = None,
    hollow: bool = False,
    length: float | None = None,
    points: ArrayLike | None = None,
    facets: str | os.PathLike[str] | None = None,
    geometry: Literal["smooth", "flat"] = "smooth",
    friction: float | Coulomb | Stribeck | None = None,
    layer: float | None = None,
    margin: float | None = None,
    name: str = "",
) -> SurfaceContact:
    """A surface of a flexible body on a shape, on rigid facets, or on another such surface.

    Parameters
    ----------
    first
        `ball["cap"]` or "ball.cap": the surface whose nodes are pressed, the finer one.
    second
        What it meets: another surface, or the frame that carries a shape or facets.
    shape : {"plane", "sphere", "cylinder", "profile"}, optional
    axis : (3,), or "x", "y", "z"
        Of the shape, in space at the start; of a plane its normal, towards the surface.
    radius, length : float [m]
    hollow : bool
        Whether the surface is inside of the shape.
    points : (n, 2) [m]
        Of a profile, see `profile`.
    facets : path, optional
        Of a file of triangles [m] in the axes of the second frame, as "wall.stl".
    geometry : {"smooth", "flat"}
        How facets that are met are read.
    friction : float, Coulomb or Stribeck, optional
        The coefficient of friction; what sticks does not move.
    layer : float [N/m^3]
        The stiffness per area of a layer between both, for flat against flat.
    margin : float [m]
        The gap below which nodes are candidates, by default what they may move in two steps.
    name : str
    """
    given: dict[str, Any] = {
        "shape": shape,
        "axis": axis,
        "radius": radius,
        "length": length,
        "points": points,
    }
    given |= {"facets": facets, "layer": layer, "margin": margin}
    given["friction"] = Coulomb(friction) if isinstance(friction, int | float) else friction
    keys = {key: value for key, value in given.items() if value is not None}
    return SurfaceContact(name, (first, second), hollow=hollow, geometry=geometry, **keys)


def _contact(
    name: str,
    shape: str,
    carrier: str | Framed,
    ball_frame: str | Framed,
    measures: dict[str, Any],
    law: Law,
) -> Contact:
    """A contact; the keywords of its law are sorted into the records that solver classes take."""
    keys: dict[str, Any] = dict(law)
    table = keys.pop("table", None)
    of_impact = {key: keys.pop(key) for key in IMPACT_KEYWORDS if key in keys}
    if isinstance(keys.get("friction"), int | float):
        keys["friction"] = Coulomb(keys["friction"])
    impact = Impact(law=table, **of_impact)
    return Contact(name, (carrier, ball_frame), shape, impact=impact, **measures, **keys)


__all__ = [
    "Coulomb",
    "ForceTable",
    "Hertz",
    "Law",
    "Stribeck",
    "SurfaceContact",
    "cylinder",
    "plane",
    "profile",
    "sphere",
    "surface",
]
