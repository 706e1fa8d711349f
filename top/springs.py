"""Springs with dampers between two frames, of three types."""

from typing import Any

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


__all__ = ["bushing", "point", "torsion"]
