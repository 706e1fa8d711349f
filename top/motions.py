"""Prescribed motions of frames in space, as of shaker tables and bases."""

from collections.abc import Sequence

from duhamel.solver.couplings.motions import (
    PrescribedDisplacement,
    PrescribedOrientation,
    PrescribedRotation,
)
from duhamel.solver.schema.values import Framed
from duhamel.solver.signals.signal import AnySignal, DrivingSignal
from numpy.typing import ArrayLike


def displacement(
    frame: str | Framed,
    direction: ArrayLike | str,
    displacement: DrivingSignal | None = None,
    *,
    velocity: AnySignal | None = None,
    acceleration: AnySignal | None = None,
    name: str = "",
) -> PrescribedDisplacement:
    """A displacement of a frame along a direction; across it the frame moves freely.

    Parameters
    ----------
    frame
        The handle of a frame.
    direction : (3,), or "x", "y", "z"
        In space.
    displacement : signal [m]
        0 at t = 0; or instead
    velocity, acceleration : signal [m/s, m/s^2]
    name : str
    """
    return PrescribedDisplacement(
        name, frame, direction, displacement, velocity=velocity, acceleration=acceleration
    )


def rotation(
    frame: str | Framed,
    axis: ArrayLike | str,
    angle: DrivingSignal | None = None,
    *,
    angular_velocity: AnySignal | None = None,
    angular_acceleration: AnySignal | None = None,
    name: str = "",
) -> PrescribedRotation:
    """A rotation of a frame about an axis, which keeps its direction.

    Parameters
    ----------
    frame
        The handle of a frame.
    axis : (3,), or "x", "y", "z"
        In space.
    angle : signal [rad]
        0 at t = 0; or instead
    angular_velocity, angular_acceleration : signal [rad/s, rad/s^2]
    name : str
    """
    return PrescribedRotation(
        name,
        frame,
        axis,
        angle,
        angular_velocity=angular_velocity,
        angular_acceleration=angular_acceleration,
    )


def orientation(
    frame: str | Framed,
    angles: Sequence[DrivingSignal] | None = None,
    *,
    angular_velocities: Sequence[AnySignal] | None = None,
    angular_accelerations: Sequence[AnySignal] | None = None,
    name: str = "",
) -> PrescribedOrientation:
    """Rotations of a frame about all three axes of space, each of up to 1 rad.

    Parameters
    ----------
    frame
        The handle of a frame.
    angles : three signals [rad]
        About x, y and z, 0 at t = 0; or instead
    angular_velocities, angular_accelerations : three signals [rad/s, rad/s^2]
    name : str
    """
    return PrescribedOrientation(
        name,
        frame,
        angles,
        angular_velocities=angular_velocities,
        angular_accelerations=angular_accelerations,
    )


__all__ = ["displacement", "orientation", "rotation"]
