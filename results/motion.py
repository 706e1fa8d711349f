"""Motions of bodies, frames, joints and springs, energies and momenta over time."""

from dataclasses import dataclass

from ..superelement.validation import Array


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Motion of a center of mass and of body axes."""

    x: Array
    """(n, 3) position in space [m]"""
    R: Array
    """(n, 4) unit quaternion (w, x, y, z), body axes to space"""
    v: Array
    """(n, 6) velocity in space [m/s], angular velocity in body axes [rad/s]"""
    v_dot: Array
    """(n, 6) their derivatives"""


@dataclass(frozen=True, eq=False)
class FrameMotion:
    """Motion of a frame and the wrench on its body there."""

    position: Array
    """(n, 3) in space [m]"""
    rotation: Array
    """(n, 4) unit quaternion, frame axes to space"""
    velocity: Array
    """(n, 6) velocity [m/s] and angular velocity [rad/s], in space"""
    acceleration: Array
    """(n, 6) their derivatives"""
    u: Array
    """(n, 6) elastic displacement [m] and rotation [rad] in body axes, 0 on rigid bodies"""
    force: Array
    """(n, 6) force [N] and moment [N m] of joints and loads on the body, in space"""


@dataclass(frozen=True, eq=False)
class Coupling:
    """Loads and coordinates of a joint, a prescribed motion or a spring.

    Coordinates are attributes too, as `joint.angle`.
    """

    multipliers: Array
    """(n, rows) one per row of the joint, in the order of its table [N, N m]"""
    force: Array
    """(n, 3) on the second body, in space [N]"""
    moment: Array
    """(n, 3) on the second body about its frame, in space [N m]"""
    coordinates: dict[str, Array]
    """(n,) coordinates of a joint and their rates by name.

    angle [rad], angle_rate, distance [m], distance_rate, ...; of a spring "coordinates" (n, rows).
    Angles are continued over full turns.
    """

    def __getattr__(self, name: str) -> Array:
        coordinates: dict[str, Array] = self.__dict__.get("coordinates", {})
        if name not in coordinates:
            known = ", ".join(coordinates) or "none"
            raise AttributeError(f"no coordinate {name!r}; there are: {known}")
        return coordinates[name]


@dataclass(frozen=True, eq=False)
class Energy:
    """Energies over time (n,) [J].

    kinetic (of the rigid motion), elastic (vibration included), springs, potential (gravity), work
    (of loads and drives), dissipated (by dampers and modal damping), numerical (taken by time
    stepping from the modes); balance: the sum of all but work, less work and less its value at
    t = 0. elastic of a body whose kernel is convolved is the work of its interface loads, with what
    damping and time stepping have taken of it. Where it falls below zero, or numerical does, the
    convolution has created energy.
    """

    kinetic: Array
    elastic: Array
    springs: Array
    potential: Array
    work: Array
    dissipated: Array
    numerical: Array
    balance: Array


@dataclass(frozen=True, eq=False)
class Momentum:
    """Linear (n, 3) [kg m/s] and angular momentum about the origin (n, 3) [kg m^2/s], in space."""

    linear: Array
    angular: Array
