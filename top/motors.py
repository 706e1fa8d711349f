"""Motors and servos on joint coordinates."""

from typing import Any

from duhamel.solver.couplings.motors import Motor
from duhamel.solver.schema.values import Named
from duhamel.solver.signals.signal import AnySignal


def drive(
    joint: str | Named,
    coordinate: str,
    signal: AnySignal,
    *,
    limit: float | tuple[float, float] | None = None,
    speed: float | None = None,
    name: str = "",
) -> Motor:
    """A torque on an angle, or a force on a distance, that follows a signal.

    Parameters
    ----------
    joint
        The joint, or its name.
    coordinate : str
        "angle", "distance", ...
    signal
        The torque [N m] of an angle, the force [N] of a distance.
    limit : float or (2,) [N m, N]
        The most that it gives.
    speed : float [rad/s, m/s]
        That without load, towards which the limit falls to zero, as a line.
    name : str
    """
    return Motor(name, joint, coordinate, **_given(coordinate, signal, limit), speed=speed)


def servo(
    joint: str | Named,
    coordinate: str,
    reference: AnySignal,
    *,
    stiffness: float = 0.0,
    damping: float = 0.0,
    integral: float = 0.0,
    reference_rate: AnySignal | None = None,
    feedforward: AnySignal | None = None,
    limit: float | tuple[float, float] | None = None,
    speed: float | None = None,
    tracking_time: float | None = None,
    name: str = "",
) -> Motor:
    """A controller of a joint coordinate c.

        v = feedforward + stiffness (r - c) + damping (r' - c') + z,    z' = integral (r - c)

    Parameters
    ----------
    joint
        The joint, or its name.
    coordinate : str
        "angle", "distance", ...
    reference : signal [rad, m]
        r, which is followed.
    stiffness : float [N m/rad, N/m]
    damping : float [N m s/rad, N s/m]
    integral : float [N m/(rad s), N/(m s)]
        The gains.
    reference_rate : signal [rad/s, m/s]
        r', by default the derivative of r where it is smooth, or else 0.
    feedforward : signal [N m, N]
    limit : float or (2,) [N m, N]
        The most that it gives; the integral does not wind up beyond.
    speed : float [rad/s, m/s]
        That without load, towards which the limit falls to zero, as a line.
    tracking_time : float [s]
        In which the integral follows the limit.
    name : str
    """
    return Motor(
        name,
        joint,
        coordinate,
        **_given(coordinate, feedforward, limit),
        reference=reference,
        reference_rate=reference_rate,
        stiffness=stiffness,
        damping=damping,
        integral=integral,
        speed=speed,
        tracking_time=tracking_time,
    )


def _given(coordinate: str, signal: AnySignal | None, limit: Any) -> dict[str, Any]:
    """The torque of an angle or the force of a distance, within a limit."""
    return {"force" if "distance" in coordinate else "torque": signal, "limit": limit}


__all__ = ["drive", "servo"]
