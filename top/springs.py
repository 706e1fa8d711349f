"""Springs with dampers between two frames, of three types, and bearings of rotors."""

import os
from collections.abc import Mapping
from typing import Any

from duhamel.solver.couplings.bearings import Bearing
from duhamel.solver.couplings.springs import Spring
from duhamel.solver.laws.law import ForceLaw
from duhamel.solver.schema.values import Framed
from numpy.typing import ArrayLike

Laws = ForceLaw | tuple[ForceLaw, ...]
"""a force law of one coordinate, or several that are added"""


def point(
    frame_a: str | Framed,
    frame_b: str | Framed,
    *,
    stiffness: float = 0.0,
    damping: float = 0.0,
    length: float | None = None,
    law: Laws | None = None,
    name: str = "",
) -> Spring:
    """A spring along the line between the origins of two frames.

    Parameters
    ----------
    frame_a, frame_b
        Handles of frames.
    stiffness : float [N/m]
    damping : float [N s/m]
    length : float [m]
        Without force, by default that of the start.
    law
        A law of `du.laws` that adds to both, or several.
    name : str
    """
    rest = None if length is None else [length]
    return Spring(
        name, "point", (frame_a, frame_b), stiffness=stiffness, damping=damping, law=law, rest=rest
    )


def torsion(
    frame_a: str | Framed,
    frame_b: str | Framed,
    axis: ArrayLike | str,
    *,
    stiffness: float = 0.0,
    damping: float = 0.0,
    angle: float | None = None,
    law: Laws | None = None,
    name: str = "",
) -> Spring:
    """A spring against the rotation about an axis, continued over full turns.

    Parameters
    ----------
    frame_a, frame_b
        Handles of frames.
    axis : (3,), or "x", "y", "z"
        In space at the start.
    stiffness : float [N m/rad]
    damping : float [N m s/rad]
    angle : float [rad]
        Without moment, by default that of the start.
    law
        A law of `du.laws` that adds to both, or several.
    name : str
    """
    return Spring(
        name,
        "torsion",
        (frame_a, frame_b),
        axis,
        stiffness=stiffness,
        damping=damping,
        law=law,
        rest=None if angle is None else [angle],
    )


def bushing(
    frame_a: str | Framed,
    frame_b: str | Framed,
    *,
    stiffness: ArrayLike = 0.0,
    damping: ArrayLike = 0.0,
    axis: ArrayLike | str | None = None,
    second_axis: ArrayLike | str | None = None,
    rest: ArrayLike | None = None,
    law: dict[str, Any] | None = None,
    name: str = "",
) -> Spring:
    """A spring against all six relative motions of two frames, in axes e1, e2, e3 of the first.

    Parameters
    ----------
    frame_a, frame_b
        Handles of frames.
    stiffness : float, (6,) or (6, 6) [N/m, N m/rad]
        Along e1, e2, e3 and about them.
    damping : float, (6,) or (6, 6) [N s/m, N m s/rad]
    axis, second_axis : (3,), or "x", "y", "z"
        e3 and e1, in space at the start, by default those of the first frame.
    rest : (6,) [m, rad]
        The coordinates without force, by default those of the start.
    law : dict
        Laws of `du.laws` by axis, "x", "y", "z", "rx", "ry", "rz".
    name : str
    """
    return Spring(
        name,
        "bushing",
        (frame_a, frame_b),
        axis,
        stiffness=stiffness,
        damping=damping,
        law=law,
        rest=rest,
        second_axis=second_axis,
    )


def bearing(
    support: str | Framed,
    shaft: str | Framed,
    axis: ArrayLike | str,
    *,
    stiffness: ArrayLike = (),
    damping: ArrayLike = 0.0,
    speeds: ArrayLike | None = None,
    second_axis: ArrayLike | str | None = None,
    table: str | os.PathLike[str] | None = None,
    film: Mapping[str, float] | None = None,
    name: str = "",
) -> Bearing:
    """A bearing that acts across the axis of a shaft, in axes of its support.

    Parameters
    ----------
    support, shaft
        Handles of frames, the first most often of the ground.
    axis : (3,), or "x", "y", "z"
        Of the shaft, in space at the start. A positive spin turns e1 to e2.
    stiffness, damping : float, (2,), (2, 2), or with speeds (n, 4) [N/m; N s/m]
        Along e1, e2: entry (i, k) is the force against e_i by a motion along e_k. A matrix need not
        be symmetric. The rows of a table have the entries 11, 12, 21, 22.
    speeds : (n,) [rad/s]
        Spins of the rows, which are linear between them.
    second_axis : (3,), or "x", "y", "z"
        e1, by default nearest to the x axis of the support (to its y axis where x is within 26
        degrees of the axis).
    table : path
        A file with speeds, stiffness and damping in place of the three, see `solver.Bearing`.
    film : mapping of float
        load, clearance, viscosity, length and diameter, for a table over the Sommerfeld number.
    name : str
    """
    return Bearing(
        name,
        (support, shaft),
        axis,
        stiffness=stiffness,
        damping=damping,
        speeds=speeds,
        second_axis=second_axis,
        table=None if table is None else os.fspath(table),
        film=film or {},
    )


__all__ = ["bearing", "bushing", "point", "torsion"]
