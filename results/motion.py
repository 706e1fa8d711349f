"""Motions of bodies, frames, joints and springs, energies and momenta over time."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from ..superelement.validation import Array
from .schema import EventRows


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
    second_order_force: Array
    """(n, r) loads on the coordinates of second order [N]; r = 0 where a body has none"""


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

    angle [rad], angle_rate, distance [m], distance_rate, ...; friction [N m, N] on the coordinate
    and friction_state, 1 sticks, 2 slips; of a spring "coordinates" (n, rows). Angles are continued
    over full turns.
    """

    def __getattr__(self, name: str) -> Array:
        coordinates: dict[str, Array] = self.__dict__.get("coordinates", {})
        if name not in coordinates:
            known = ", ".join(coordinates) or "none"
            raise AttributeError(f"no coordinate {name!r}; there are: {known}")
        return coordinates[name]


@dataclass(frozen=True, eq=False)
class Events:
    """Each time that a contact or stop was closed (m,), in order, counted at every step.

    A contact that was still closed at the end of the run is the last, with its end there and no
    numbers for opening speed and restitution: `still_closed`. One that was closed from the start
    has a closing speed of 0.
    """

    start: Array
    """time when it closed [s]"""
    end: Array
    """time when it opened [s]"""
    steps: Array
    """steps at whose end it was closed"""
    peak: Array
    """largest normal force [N], of a stop of an angle moment [N m]"""
    impulse: Array
    """integral of the same over time [N s, N m s]"""
    closing_speed: Array
    """[m/s, rad/s]"""
    opening_speed: Array
    restitution: Array
    """opening speed over closing speed, 0 where that is 0"""
    dissipated: Array
    """energy that it took, friction included [J]"""

    @classmethod
    def by_owner(cls, rows: EventRows, names: Sequence[str]) -> "dict[str, Events]":
        """Those of each owner, of which the names are given in the order of their numbers."""
        return {name: cls(*rows.values[rows.owner == k].T) for k, name in enumerate(names)}

    def __len__(self) -> int:
        return len(self.start)

    @property
    def still_closed(self) -> NDArray[np.bool_]:
        """(m,) True for the one that had not ended with the run."""
        return np.isnan(self.opening_speed)

    @property
    def impacts(self) -> int:
        """How often it closed; not where it was closed from the start."""
        return int((self.closing_speed > 0.0).sum())

    @property
    def whole(self) -> NDArray[np.bool_]:
        """(m,) True for those that closed and opened within the run."""
        return (self.closing_speed > 0.0) & ~self.still_closed

    @property
    def shortest(self) -> int | None:
        """Steps of the shortest from closing to opening, if there is one."""
        steps = self.steps[self.whole]
        return int(steps.min()) if len(steps) else None

    def __str__(self) -> str:
        names = [own.name for own in fields(self)]
        columns = [[name, *(f"{x:.6g}" for x in getattr(self, name))] for name in names]
        widths = [max(map(len, column)) for column in columns]
        rows = zip(*columns, strict=True)
        return "\n".join("  ".join(map(str.rjust, row, widths)) for row in rows)


@dataclass(frozen=True, eq=False)
class PatternMotion:
    """A load pattern of a body over time."""

    load: Array
    """(n,) its amplitude"""
    displacement: Array
    """(n,) the elastic displacement that the amplitude does work on, int t . u dA [J]"""


@dataclass(frozen=True, eq=False)
class SensorMotion:
    """What a sensor reads: of a point (n, 3), of a strain gauge (n, 1), stresses (n, 6).

    In body axes; stresses in the order xx, yy, zz, yz, xz, xy.
    """

    value: Array
    """elastic displacement [m], strain [1] or stress [Pa]"""
    rate: Array
    """its derivative by time"""
    acceleration: Array
    """of a point that in space, as an accelerometer reads it without gravity [m/s^2]; of a gauge
    the second derivative"""


@dataclass(frozen=True, eq=False)
class ContactMotion:
    """What happens between the ball and the shape of a contact."""

    gap: Array
    """(n,) [m], negative where it is closed"""
    force: Array
    """(n, 3) on the second body, along the normal and the tangents t1, t2 = normal x t1 [N]"""
    normal: Array
    """(n, 3) of the shape, towards the second body, in space"""
    point: Array
    """(n, 3) point of the ball nearest to the shape, in space [m]"""
    slip: Array
    """(n, 2) rates of slip of the second body along t1 and t2 [m/s], 0 where it is open"""
    state: Array
    """(n,) 0 open, 1 closed or sticks, 2 slips"""
    events: Events
    impulse: Array = field(default_factory=lambda: np.empty(0))
    """(n,) integral of the normal force since t = 0 [N s], counted at every step; (0,) of files
    before version 8"""


@dataclass(frozen=True, eq=False)
class StopMotion:
    """What happens at a stop of a joint coordinate."""

    gap: Array
    """(n,) distance to the nearer limit [m, rad], negative beyond it"""
    force: Array
    """(n,) on the coordinate [N, N m]"""
    state: Array
    """(n,) 0 open, 1 closed"""
    events: Events
    impulse: Array = field(default_factory=lambda: np.empty(0))
    """(n,) integral of the force since t = 0 [N s, N m s], as that of a contact"""


@dataclass(frozen=True, eq=False)
class CouplerMotion:
    """What a coupler does between joint coordinates."""

    force: Array
    """(n,) on the first coordinate, a moment on an angle [N, N m]; on each other one times its
    ratio over the first"""


@dataclass(frozen=True, eq=False)
class MotorMotion:
    """What a motor does."""

    torque: Array
    """(n,) on the coordinate [N m]; of a distance the force [N]"""
    reference: Array
    """(n,) [rad, m]"""
    error: Array
    """(n,) reference less coordinate [rad, m]; both 0 where no position is followed"""
    power: Array
    """(n,) that it gives [W]"""
    work: Array
    """(n,) since t = 0 [J]"""
    state: Array
    """(n,) -1 at the lower limit, 1 at the upper one, 0 between them"""


@dataclass(frozen=True, eq=False)
class Energy:
    """Energies over time (n,) [J].

    kinetic (of the rigid motion), elastic (vibration included), springs (contacts too), potential
    (gravity), work (of loads, drives and motors), dissipated (by dampers, contacts, friction and
    modal damping), numerical (taken by time stepping from the modes); balance: the sum of all but
    work, less work and less its value at t = 0. elastic of a body whose kernel is convolved is the
    work of its interface loads, with what damping and time stepping have taken of it. Where it
    falls below zero, or numerical does, the convolution has created energy.
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
