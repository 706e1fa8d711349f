"""What results hold: motions of bodies and frames, couplings, energies, a record for each quantity.

An attribute is described once, by its `Quantity` (quantity.py); the line below it, which editors
show, says the same, and a test compares them.
"""

from collections.abc import Sequence
from functools import partial
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from ..files.arrays import Array
from .batches import FURTHER_WORKS, EventRows, balance, dissipated, numerical, time_of
from .errors import ResultsError
from .quantity import Attribute, Quantity, Recorded, joined, quantity, vector
from .rotations import rotate

_energy = partial(quantity, "J", plot="")
"""the field of an energy, which `plot` has as "energy:NAME" """


class BodyMotion(Recorded, group="bodies", owner="body", plot="{}"):
    """Motion of a center of mass and of body axes, as `Results.body` gives it.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> m.simulate(1.0, step=0.1).results.body("ball").velocity[-1].round(6).tolist()
    [0.0, 0.0, -10.0]
    """

    x: Array = vector("m", "center of mass, in space", name="position")
    """(n, 3) center of mass, in space [m]"""
    R: Array = quantity(
        "1", "unit quaternion, body to space", "quaternion", name="rotation", plot=""
    )
    """(n, 4) unit quaternion, body to space, the scalar first"""
    v: Array = joined(
        vector("m s-1", "velocity of the center of mass, in space", name="velocity"),
        vector("rad s-1", "angular velocity, in body axes", name="angular_velocity", plot=""),
    )
    """(n, 6) velocity of the center of mass, in space [m/s]; angular velocity, in body axes
    [rad/s]"""
    v_dot: Array = joined(
        vector(
            "m s-2",
            "acceleration of the center of mass, in space",
            name="acceleration",
            in_peaks=True,
        ),
        vector(
            "rad s-2", "angular acceleration, in body axes", name="angular_acceleration", plot=""
        ),
    )
    """(n, 6) acceleration of the center of mass, in space [m/s²]; angular acceleration, in body
    axes [rad/s²]"""
    second_order_force: Array = quantity(
        ("N", "N"),
        "force on each second-order coordinate, which is scaled to a length, q / sqrt(mass)",
        of="second_order_coordinate",
    )
    """(n, k) force on each second-order coordinate, which is scaled to a length, q / sqrt(mass)
    [N]; k = 0 where a body has none"""
    modal_coordinate: Array = quantity(
        ("m", "m"),
        "coordinate of each mode of a body whose surfaces are in contact, scaled to a length, "
        "eta / sqrt(mass)",
        of="mode",
        plot="",
    )
    """(n, k) coordinate of each mode of a body whose surfaces are in contact, scaled to a length,
    eta / sqrt(mass) [m]; k = 0 where none was recorded"""
    surface_load: Array = vector(
        ("N", "N"),
        "force of contacts on each node of the surfaces of a body in contact, in body axes",
        of="surface_load",
        sparse=True,
        plot="",
    )
    """(n, k, 3) force of contacts on each node of the surfaces of a body in contact, in body axes
    [N]; k = 0 where none was recorded"""

    @property
    def position(self) -> Array:
        """(n, 3) center of mass, in space [m]"""
        return self.x

    @property
    def rotation(self) -> Array:
        """(n, 4) unit quaternion, body to space, the scalar first"""
        return self.R

    @property
    def velocity(self) -> Array:
        """(n, 3) velocity of the center of mass, in space [m/s]"""
        return self.v[:, :3]

    @property
    def angular_velocity(self) -> Array:
        """(n, 3) angular velocity, in space [rad/s], as `plot` draws it; in `v` in body axes"""
        return rotate(self.R, self.v[:, 3:])

    @property
    def acceleration(self) -> Array:
        """(n, 3) acceleration of the center of mass, in space [m/s²]"""
        return self.v_dot[:, :3]

    @property
    def angular_acceleration(self) -> Array:
        """(n, 3) angular acceleration, in space [rad/s²]; in `v_dot` in body axes"""
        return rotate(self.R, self.v_dot[:, 3:])


class FrameMotion(Recorded, group="frames", owner="frame", plot="{}"):
    """Motion of a frame, and the wrench on its body there. See `JointMotion` for an example.

    `velocity`, `acceleration` and `force` have six columns: those of a body have three.
    """

    position: Array = vector("m", "origin of the frame, in space")
    """(n, 3) origin of the frame, in space [m]"""
    rotation: Array = quantity("1", "unit quaternion, frame to space", "quaternion", plot="")
    """(n, 4) unit quaternion, frame to space, the scalar first"""
    velocity: Array = joined(
        vector("m s-1", "velocity of the origin of the frame, in space", in_vtk=True),
        vector("rad s-1", "angular velocity, in space", name="angular_velocity", plot=""),
    )
    """(n, 6) velocity of the origin of the frame, in space [m/s]; angular velocity, in space
    [rad/s]"""
    acceleration: Array = joined(
        vector("m s-2", "acceleration of the origin of the frame, in space"),
        vector("rad s-2", "angular acceleration, in space", name="angular_acceleration", plot=""),
    )
    """(n, 6) acceleration of the origin of the frame, in space [m/s²]; angular acceleration, in
    space [rad/s²]"""
    u: Array = joined(
        vector(
            "m",
            "elastic displacement of the interface, in body axes",
            name="elastic_displacement",
            role="INTERFACE",
            in_peaks=True,
        ),
        vector(
            "rad",
            "elastic rotation vector of the interface, in body axes",
            name="elastic_rotation",
            role="INTERFACE",
        ),
    )
    """(n, 6) elastic displacement of the interface, in body axes [m]; elastic rotation vector of
    the interface, in body axes [rad]; 0 on rigid bodies"""
    force: Array = joined(
        vector(
            "N",
            "force of joints, springs and loads on the body, in space",
            plot="frame_force",
            in_vtk=True,
        ),
        vector(
            "N m",
            "moment of joints, springs and loads about the origin of the frame, in space",
            name="moment",
            plot="frame_moment",
            in_vtk=True,
        ),
    )
    """(n, 6) force of joints, springs and loads on the body, in space [N]; moment of joints,
    springs and loads about the origin of the frame, in space [N m]"""

    @property
    def linear_velocity(self) -> Array:
        """(n, 3) velocity of the origin of the frame, in space [m/s]"""
        return self.velocity[:, :3]

    @property
    def angular_velocity(self) -> Array:
        """(n, 3) angular velocity, in space [rad/s]"""
        return self.velocity[:, 3:]

    @property
    def linear_acceleration(self) -> Array:
        """(n, 3) acceleration of the origin of the frame, in space [m/s²]"""
        return self.acceleration[:, :3]

    @property
    def angular_acceleration(self) -> Array:
        """(n, 3) angular acceleration, in space [rad/s²]"""
        return self.acceleration[:, 3:]

    @property
    def elastic_displacement(self) -> Array:
        """(n, 3) elastic displacement of the interface, in body axes [m]; 0 on rigid bodies"""
        return self.u[:, :3]

    @property
    def elastic_rotation(self) -> Array:
        """(n, 3) elastic rotation vector of the interface, in body axes [rad]"""
        return self.u[:, 3:]

    @property
    def applied_force(self) -> Array:
        """(n, 3) force of joints, springs and loads on the body, in space [N]"""
        return self.force[:, :3]

    @property
    def applied_moment(self) -> Array:
        """(n, 3) moment of the same loads about the origin of the frame, in space [N m]"""
        return self.force[:, 3:]


class Coupling(Recorded):
    """Loads and coordinates of a joint, a prescribed motion or a spring.

    See `JointMotion` for an example.
    """

    multipliers: Array
    force: Array
    moment: Array

    @property
    def coordinates(self) -> dict[str, Array]:
        """(n,) coordinates of a joint and their rates by name, attributes too, as `joint.angle`.

        angle [rad], angle_rate, distance [m], distance_rate, ...; friction [N m, N] on the
        coordinate and friction_state, 1 sticks, 2 slips; of a spring "coordinates" (n, rows).
        """
        others = {"multipliers", "force", "moment", "permanent"}
        return {name: array for name, array in vars(self).items() if name not in others}

    def __getattr__(self, name: str) -> Array:
        known = ", ".join(self.coordinates) or "none"
        raise AttributeError(f"no coordinate {name!r}; there are: {known}")


class JointMotion(Coupling, group="joints", owner="joint", plot="{}"):
    """Loads and coordinates of a joint or a prescribed motion; `coordinates` lists the latter.

    Examples
    --------
    A pendulum at rest hangs from its pin:

    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> bob = m.add(du.RigidBody(2.0, [0.1, 0.1, 0.1], {"pin": [0.0, 0.0, 0.5]}), name="bob")
    >>> hinge = m.add(du.joints.Revolute(m.ground, bob["pin"], axis="y", name="hinge"))
    >>> results = m.simulate(0.1, step=0.01).results
    >>> joint, pin = results.joint("hinge"), results.frame("bob.pin")
    >>> round(float(joint.angle[-1]), 6), joint.force[-1].round(6).tolist()
    (0.0, [0.0, 0.0, 20.0])
    >>> pin.applied_force[-1].round(6).tolist(), pin.position[-1].round(6).tolist()
    ([0.0, 0.0, 20.0], [0.0, 0.0, 0.5])
    """

    force: Array = vector(
        "N",
        "force on the second body, in space",
        source="coupling_force",
        in_peaks=True,
        section="Forces",
    )
    """(n, 3) force on the second body, in space [N]"""
    moment: Array = vector(
        "N m", "moment on the second body, in space", source="coupling_moment", section="Forces"
    )
    """(n, 3) moment on the second body, in space [N m], about its frame"""
    multipliers: Array = quantity(
        ("N", "N m"),
        "Lagrange multiplier of each constraint",
        name="multiplier",
        of="joint_constraint",
        source="multiplier",
    )
    """(n, k) Lagrange multiplier of each constraint [N, N m], in the order of the joint's table"""
    _of_coordinates: dict[str, Array] = joined(
        quantity(
            ("m", "rad"),
            "value of each coordinate; angles continue beyond full turns",
            name="position",
            of="joint_coordinate",
            attribute="{}",
        ),
        quantity(
            ("m s-1", "rad s-1"),
            "rate of each coordinate",
            name="rate",
            of="joint_coordinate",
            attribute="{}_rate",
        ),
        quantity(
            ("N", "N m"),
            "force or moment of friction on the coordinate",
            name="friction",
            of="joint_with_friction",
            attribute="{}",
            source="friction_force",
        ),
        quantity(
            ("1", "1"),
            "0 before the first step, 1 sticks, 2 slips",
            name="friction_state",
            of="joint_with_friction",
            attribute="{}_state",
            source="friction_state",
            integer=True,
            states="1 sticks, 2 slips",
        ),
    )


class SpringMotion(Coupling, group="springs", owner="spring", plot="{}"):
    """Loads of a spring; `coordinates["coordinates"]` (n, rows) has its lengths and angles.

    See `JointMotion` for an example of the attributes that both have.
    """

    force: Array = vector("N", "force on the second body, in space", source="coupling_force")
    """(n, 3) force on the second body, in space [N]"""
    moment: Array = vector("N m", "moment on the second body, in space", source="coupling_moment")
    """(n, 3) moment on the second body, in space [N m], about its frame"""
    multipliers: Array = quantity(
        ("N", "N m"),
        "force or moment of each component",
        name="multiplier",
        of="spring_component",
        source="multiplier",
    )
    """(n, k) force or moment of each component [N, N m]"""
    _of_coordinates: dict[str, Array] = quantity(
        ("m", "rad"),
        "length or angle of each component",
        name="coordinate",
        of="spring_component",
        attribute="coordinates",
        source="coordinate",
    )
    permanent: Array = quantity(
        ("m", "rad"),
        "plastic deformation of each component, or mean slip of a bolted joint",
        of="spring_component",
        source="permanent",
        sparse=True,
        since=11,
    )
    """(n, k) plastic deformation of each component, or mean slip of a bolted joint [m, rad]; not in
    files before version 11"""


class CouplerMotion(Recorded, group="couplers", owner="coupler"):
    """What a coupler does between joint coordinates, as `Results.coupler` gives it.

    See `MotorMotion` for an example of a quantity over time.
    """

    force: Array = quantity(
        ("N", "N m"),
        "force or moment on the first coordinate; on another one multiplied by ratio / first ratio",
        source="multiplier",
        words=("force", "moment"),
        section="Forces",
    )
    """(n,) force or moment on the first coordinate; on another one multiplied by ratio / first
    ratio [N, N m]"""


class Events(Recorded, group="events", rows="event"):
    """Each time that a contact or stop was closed (m,), in order, counted at every step.

    A contact that was still closed at the end of the run is the last: its end is there, and opening
    speed and restitution are NaN (`still_closed`). One that was closed from the start has a closing
    speed of 0. See `ContactMotion` for an example.
    """

    start: Array = quantity("s", "time when it closed")
    """(m,) time when it closed [s]"""
    end: Array = quantity("s", "time when it opened, or the run ended")
    """(m,) time when it opened, or the run ended [s]"""
    steps: Array = quantity("1", "steps at whose end it was closed", integer=True)
    """(m,) steps at whose end it was closed"""
    peak: Array = quantity(("N", "N m"), "largest normal force")
    """(m,) largest normal force [N, N m], of a stop of an angle the moment"""
    impulse: Array = quantity(("N s", "N m s"), "integral of the normal force over time")
    """(m,) integral of the normal force over time [N s, N m s]"""
    closing_speed: Array = quantity(
        ("m s-1", "rad s-1"), "speed of approach; 0: closed from the start"
    )
    """(m,) speed of approach; 0: closed from the start [m/s, rad/s]"""
    opening_speed: Array = quantity(("m s-1", "rad s-1"), "speed of departure; NaN: still closed")
    """(m,) speed of departure; NaN: still closed [m/s, rad/s]"""
    restitution: Array = quantity("1", "opening speed over closing speed")
    """(m,) opening speed over closing speed, 0 where that is 0"""
    dissipated: Array = quantity("J", "dissipated energy, friction included")
    """(m,) dissipated energy, friction included [J]"""

    @classmethod
    def by_owner(cls, rows: EventRows, names: Sequence[str]) -> "dict[str, Events]":
        """Those of each owner, of which the names are given in the order of their numbers."""
        columns = [quantity.attribute for quantity in cls.quantities]
        return {
            name: cls(dict(zip(columns, rows.values[rows.owner == k].T, strict=True)))
            for k, name in enumerate(names)
        }

    def __len__(self) -> int:
        return len(self.start)

    @property
    def still_closed(self) -> NDArray[np.bool_]:
        """(m,) True for the one that had not ended with the run."""
        # The time loop has no speed of departure for what has not departed.
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
        names = [quantity.attribute for quantity in self.quantities]
        columns = [[name, *(f"{x:.6g}" for x in getattr(self, name))] for name in names]
        widths = [max(map(len, column)) for column in columns]
        rows = zip(*columns, strict=True)
        return "\n".join("  ".join(map(str.rjust, row, widths)) for row in rows)


class ContactMotion(Recorded, group="contacts", owner="contact", plot="{}"):
    """What happens between the ball and the shape of a contact.

    Examples
    --------
    A ball that falls 0.05 m, onto a floor without losses:

    >>> from duhamel import solver
    >>> floor = solver.Contact(
    ...     "floor", ["ground.floor", "ball"], "plane", ball=0.05, axis=[0.0, 0.0, 1.0],
    ...     impact=solver.Impact(stiffness=1e5),
    ... )
    >>> start = solver.Start(position=(0.0, 0.0, 0.1))
    >>> results = solver.simulate(solver.Model(
    ...     {"ball": solver.RigidBody(1.0, [0.1, 0.1, 0.1], start=start)}, contacts=[floor],
    ...     ground_frames={"floor": solver.Frame()}, gravity=(0.0, 0.0, -10.0),
    ...     settings=solver.Settings(t_end=0.15, step=1e-4),
    ... ))
    >>> contact = results.contact("floor")
    >>> contact.events.impacts, contact.events.closing_speed.round(2).tolist()
    (1, [1.0])
    >>> bool(contact.gap.min() < 0.0)
    True
    """

    events: Events
    """each time that it was closed, counted at every step"""
    gap: Array = quantity("m", "gap, negative while closed", source="gap", section="Contacts")
    """(n,) gap, negative while closed [m]"""
    dent: Array = quantity(
        "m", "depth of the dent that impacts have left", source="dent", sparse=True, since=11
    )
    """(n,) depth of the dent that impacts have left [m]; not in files before
    version 11"""
    force: Array = quantity(
        "N", "force on the second body, along normal and tangents", "contact_axis", plot=""
    )
    """(n, 3) force on the second body, along normal and tangents [N], t2 = normal x t1"""
    normal: Array = vector(
        "1", "normal of the shape, towards the second body, in space", plot="contact_normal"
    )
    """(n, 3) normal of the shape, towards the second body, in space"""
    point: Array = vector(
        "m", "point of the ball nearest to the shape, in space", plot="contact_point"
    )
    """(n, 3) point of the ball nearest to the shape, in space [m]"""
    slip: Array = quantity(
        "m s-1", "slip velocity of the second body, 0 while open", "tangent_axis"
    )
    """(n, 2) slip velocity of the second body, 0 while open [m/s], along t1 and t2"""
    state: Array = quantity(
        "1",
        "0 open, 1 closed or sticks, 2 slips",
        integer=True,
        states="0 open, 1 closed, 2 slips",
        plot="contact_state",
    )
    """(n,) 0 open, 1 closed or sticks, 2 slips"""
    impulse: Array = quantity(
        "N s",
        "integral of the normal force since t = 0",
        source="normal_impulse",
        since=8,
        in_peaks=True,
    )
    """(n,) integral of the normal force since t = 0 [N s], counted at every step; not in files
    before version 8"""


class SurfaceContactMotion(Recorded, group="surface_contacts", owner="surface_contact", plot="{}"):
    """What happens between two surfaces, or a surface and a shape.

    `pressure`, `gaps`, `traction`, `slip_speed` and `displacement` are recorded where the model
    asks for `nodes`. See `ContactMotion` for an example: `results.contact(name)` has both.
    """

    events: Events
    """each time that it was closed, counted at every step"""
    force: Array = vector("N", "force on the body of the first surface, in space", in_peaks=True)
    """(n, 3) force on the body of the first surface, in space [N]"""
    moment: Array = vector("N m", "moment of it about the center of mass of that body, in space")
    """(n, 3) moment of it about the center of mass of that body, in space [N m]"""
    normal_force: Array = quantity("N", "sum of the normal forces of all rows", plot="")
    """(n,) sum of the normal forces of all rows [N]"""
    center_of_pressure: Array = vector(
        "m", "center of pressure, in space; no number where it is open"
    )
    """(n, 3) center of pressure, in space; no number where it is open [m]"""
    area: Array = quantity("m2", "area in contact", section="Contacts")
    """(n,) area in contact [m²]"""
    closed_rows: Array = quantity("1", "number of rows that are closed", integer=True)
    """(n,) number of rows that are closed"""
    largest_pressure: Array = quantity(
        "Pa", "largest pressure of a row", in_peaks=True, section="Contacts"
    )
    """(n,) largest pressure of a row [Pa]"""
    gap: Array = quantity("m", "least gap; no number where it is far")
    """(n,) least gap; no number where it is far [m]"""
    impulse: Array = quantity("N s", "integral of the magnitude of the force since t = 0")
    """(n,) integral of the magnitude of the force since t = 0 [N s], counted at every step"""
    pressure: Array = quantity(
        ("Pa", "Pa"),
        "pressure of each row",
        name="pressure",
        of="surface_row",
        source="surface_row_pressure",
    )
    """(n, k) pressure of each row [Pa]"""
    gaps: Array = quantity(
        ("m", "m"),
        "gap of each row; no number where it is far",
        name="gaps",
        of="surface_row",
        source="surface_row_gap",
    )
    """(n, k) gap of each row; no number where it is far [m]"""
    traction: Array = quantity(
        ("Pa", "Pa"),
        "friction of each row over its area, on the body of the first surface, in space",
        "axis",
        name="traction",
        of="surface_row",
        source="surface_row_traction",
    )
    """(n, k, 3) friction of each row over its area, on the body of the first surface, in space
    [Pa]"""
    slip_speed: Array = quantity(
        ("m s-1", "m s-1"),
        "speed at which each closed row with friction slips",
        name="slip_speed",
        of="surface_row",
        source="surface_row_slip_speed",
    )
    """(n, k) speed at which each closed row with friction slips [m/s]"""
    displacement: Array = quantity(
        ("m", "m"),
        "elastic displacement of each node of the first surface, in body axes; no number where it "
        "is far",
        "axis",
        name="node_displacement",
        of="surface_node",
        source="surface_node_displacement",
    )
    """(n, k, 3) elastic displacement of each node of the first surface, in body axes; no number
    where it is far [m]"""

    @property
    def state(self) -> Array:
        """(n,) 0 open, 1 closed"""
        closed: Array = np.minimum(self.closed_rows, 1)
        return closed

    def lacks(self, attribute: Attribute) -> NoReturn:
        if any(one.of for one in attribute.quantities):
            name = attribute.quantities[0].attribute
            raise ResultsError(
                f"{self._origin[0]}: {name} of rows and nodes was not recorded: write "
                "nodes = true into [output]"
            )
        super().lacks(attribute)


class StopMotion(Recorded, group="stops", owner="stop", plot="{}"):
    """What happens at a stop of a joint coordinate.

    See `ContactMotion` for an example of its events.
    """

    events: Events
    """each time that it was closed, counted at every step"""
    gap: Array = quantity(
        ("m", "rad"), "distance to the nearer limit, negative beyond it", source="gap"
    )
    """(n,) distance to the nearer limit, negative beyond it [m, rad]"""
    dent: Array = quantity(
        ("m", "rad"), "depth of the dent at the nearer limit", source="dent", sparse=True, since=11
    )
    """(n,) depth of the dent at the nearer limit [m, rad]; not in files before
    version 11"""
    force: Array = quantity(
        ("N", "N m"), "force or moment on the coordinate", source="normal_force", plot=""
    )
    """(n,) force or moment on the coordinate [N, N m]"""
    state: Array = quantity(
        "1", "0 open, 1 closed", source="contact_state", integer=True, plot="contact_state"
    )
    """(n,) 0 open, 1 closed"""
    impulse: Array = quantity(
        ("N s", "N m s"),
        "integral of the force or moment since t = 0",
        source="normal_impulse",
        since=8,
        words=("impulse", "angular impulse"),
    )
    """(n,) integral of the force or moment since t = 0 [N s, N m s], counted at every step; not in
    files before version 8"""


class PatternMotion(Recorded, group="patterns", owner="pattern"):
    """A load pattern of a body over time, as `Results.pattern` gives it.

    See `MotorMotion` for an example of a quantity over time.
    """

    load: Array = quantity("1", "amplitude of each load pattern", words="amplitude of the load")
    """(n,) amplitude of each load pattern"""
    displacement: Array = quantity(
        "J",
        "work of the pattern with amplitude 1 on the elastic displacement",
        words="elastic displacement under the load",
    )
    """(n,) work of the pattern with amplitude 1 on the elastic displacement [J], int t . u dA"""


class SensorMotion(Recorded, group="sensors", owner="sensor"):
    """What a sensor reads: of a point (n, 3), of a strain gauge (n, 1), stresses (n, 6).

    In body axes; stresses in the order xx, yy, zz, yz, xz, xy. See `MotorMotion` for an example of
    a quantity over time.
    """

    value: Array = quantity(
        ("m", "1", "Pa"),
        "elastic displacement, strain or stress, in body axes",
        of="sensor_channel",
    )
    """(n, k) elastic displacement, strain or stress, in body axes [m, 1, Pa]"""
    rate: Array = quantity(("m s-1", "s-1", "Pa s-1"), "rate of the value", of="sensor_channel")
    """(n, k) rate of the value [m/s, 1/s, Pa/s]"""
    acceleration: Array = quantity(
        ("m s-2", "s-2", "Pa s-2"),
        "acceleration of a point in space, in body axes; second derivative of strain or stress",
        of="sensor_channel",
    )
    """(n, k) acceleration of a point in space, in body axes; second derivative of strain or stress
    [m/s², 1/s², Pa/s²]. An accelerometer reads that of a point, without gravity."""


class MotorMotion(Recorded, group="motors", owner="motor"):
    """What a motor does.

    Examples
    --------
    A constant torque on a disk of 0.2 kg m^2:

    >>> import duhamel as du
    >>> m = du.Mechanism()
    >>> disk = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.2]), name="disk")
    >>> shaft = m.add(du.joints.Revolute(m.ground, disk, axis="z", name="shaft"))
    >>> drive = m.add(du.motors.drive(shaft, "angle", du.signals.Constant(4.0), name="motor"))
    >>> motor = m.simulate(1.0, step=0.1).results.motor("motor")
    >>> round(float(motor.power[-1]), 6), round(float(motor.work[-1]), 6)
    (80.0, 40.0)
    """

    torque: Array = quantity(
        ("N", "N m"),
        "force or torque on the coordinate",
        words=("force", "torque"),
        section="Motors",
    )
    """(n,) force or torque on the coordinate [N, N m]"""
    reference: Array = quantity(("m", "rad"), "reference; 0 without position control")
    """(n,) reference; 0 without position control [m, rad]"""
    error: Array = quantity(("m", "rad"), "reference minus coordinate; 0 without position control")
    """(n,) reference minus coordinate; 0 without position control [m, rad]"""
    power: Array = quantity("W", "power of the motor", section="Motors")
    """(n,) power of the motor [W]"""
    work: Array = quantity("J", "work since t = 0")
    """(n,) work since t = 0 [J]"""
    state: Array = quantity(
        "1",
        "-1 at the lower limit, 1 at the upper one, 0 between them",
        integer=True,
        states="-1, 1 at a limit",
    )
    """(n,) -1 at the lower limit, 1 at the upper one, 0 between them"""


INPUT_UNITS = ("1", "N", "N m", "m", "rad", "m s-1", "rad s-1")
"""the units in which loads and motors take signals; "1": several, or none that is known"""


class FmuMotion(Recorded, group="fmus", owner="fmu"):
    """What an FMU gives: `outputs["tau"]` (n,), by the names of the inputs of the model.

    Each has the unit of the loads or motors that follow it. docs/how-to/controller-fmu.md has an
    example.

    Examples
    --------
    >>> FmuMotion.quantities[0].source
    'fmu_value'
    """

    _of_inputs: dict[str, Array] = quantity(
        INPUT_UNITS,
        "value of each input that the FMU gives",
        name="value",
        of="fmu_input",
        attribute="{}",
    )

    @property
    def outputs(self) -> dict[str, Array]:
        """(n,) the inputs that it gives, by name."""
        return dict(vars(self))


# In the order in which reports have them.
BALANCED_ENERGIES = (
    *("kinetic", "elastic", "springs", "potential"),
    *("work", "dissipated", "numerical"),
)


class Energy(Recorded, group="energy"):
    """Energies over time (n,) [J].

    `elastic` of a body whose kernel is convolved is the work of its interface loads, minus what
    damping and time stepping have dissipated. Where it falls below zero, or `numerical` does, the
    convolution has created energy. `plot` has each as "energy:NAME".

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> round(float(results.energy.kinetic[-1]), 6), bool(abs(results.energy.balance[-1]) < 1e-9)
    (50.0, True)
    >>> results.momentum.linear[-1].round(6).tolist(), int(results.iterations.max())
    ([0.0, 0.0, -10.0], 1)
    """

    kinetic: Array = _energy("kinetic energy of the rigid motions", name="kinetic_energy")
    """(n,) kinetic energy of the rigid motions [J]"""
    elastic: Array = _energy(
        "elastic energy of flexible bodies, vibration included", name="elastic_energy"
    )
    """(n,) elastic energy of flexible bodies, vibration included [J]"""
    springs: Array = _energy(
        "energy stored in springs, contacts and friction",
        name="spring_energy",
        words="energy of springs",
    )
    """(n,) energy stored in springs, contacts and friction [J]"""
    potential: Array = _energy("potential energy of gravity", name="potential_energy")
    """(n,) potential energy of gravity [J]"""
    work: Array = _energy(
        "work of loads, drives and motors since t = 0",
        name="external_work",
        words="work from outside",
    )
    """(n,) work of loads, drives and motors since t = 0 [J]"""
    dissipated: Array = _energy(
        "energy dissipated by dampers and modal damping since t = 0",
        name="dissipated_energy",
        derive=dissipated,
    )
    """(n,) energy dissipated by dampers and modal damping since t = 0 [J], by contacts and friction
    too"""
    numerical: Array = _energy(
        "energy dissipated by time stepping (numerical damping) since t = 0",
        name="numerical_dissipation",
        derive=numerical,
    )
    """(n,) energy dissipated by time stepping (numerical damping) since t = 0 [J]"""
    balance: Array = _energy(
        "change of all energies since t = 0 plus both dissipations minus external work",
        name="energy_balance",
        derive=balance,
    )
    """(n,) change of all energies since t = 0 plus both dissipations minus external work [J]"""

    def imbalance(self) -> tuple[float, float]:
        """The largest balance [J], and over the largest energy that moved (0 where none did)."""
        largest = float(np.abs(self.balance).max())
        moved = [np.abs(getattr(self, name)).max() for name in BALANCED_ENERGIES]
        # The level of potential energy is arbitrary: its change is what moved.
        moved[BALANCED_ENERGIES.index("potential")] = np.ptp(self.potential)
        scale = float(max(moved))
        return largest, largest / scale if scale > 0.0 else 0.0


class Momentum(Recorded, group="momentum"):
    """Momenta of all bodies over time. See `Energy` for an example."""

    linear: Array = vector(
        "kg m s-1", "momentum of all bodies, in space", name="linear_momentum", words="momentum"
    )
    """(n, 3) momentum of all bodies, in space [kg m/s]"""
    angular: Array = vector(
        "kg m2 s-1", "angular momentum about the origin, in space", name="angular_momentum"
    )
    """(n, 3) angular momentum about the origin, in space [kg m²/s]"""


class Solution(Recorded, group="solver"):
    """How the equations of the steps were solved. See `Energy` for an example."""

    iterations: Array = quantity(
        "1",
        "iterations of Newton's method",
        name="newton_iterations",
        integer=True,
        words="Newton iterations",
    )
    """(n,) iterations of Newton's method"""
    residual: Array = quantity(
        "1",
        "relative residual at the end of the step",
        name="newton_residual",
        words="Newton residual",
    )
    """(n,) relative residual at the end of the step"""


TIME_QUANTITY = Quantity("s", "time of each recorded step", derive=time_of, plot="").within("time")
# The dimension of the owners of a group, in the order in which results list them.
OWNERS_OF_GROUP = {kind.group: kind.owner for kind in Recorded.kinds if kind.owner}
KINDS_OF_STEPS = [kind for kind in Recorded.kinds if kind is not Events]
QUANTITIES = (TIME_QUANTITY, *(quantity for kind in KINDS_OF_STEPS for quantity in kind.quantities))
# The numbers of an event in the order in which the time loop writes them.
EVENT_QUANTITIES = Events.quantities
EVENT_NUMBER = Quantity("1", "number of the event", integer=True).within("", rows="event")
EVENT_OWNER = Quantity("1", "number of its owner in event_owner, from 0", integer=True).within(
    "of", rows="event"
)
# The time loop numbers all couplings together, results have an axis for each kind.
SHARED_DIMENSIONS = {
    "stop": "contact",
    "joint": "coupling",
    "spring": "coupling",
    "joint_constraint": "row",
    "spring_component": "row",
    "coupler": "row",
}


def output_fields() -> dict[str, tuple[tuple[str, ...], bool]]:
    """The arrays that the time loop fills: dimensions, and True for integers, by name.

    Examples
    --------
    >>> output_fields()["body_position"]
    (('time', 'body', 'axis'), False)
    """
    fields = {
        quantity.source: (
            tuple(SHARED_DIMENSIONS.get(dimension, dimension) for dimension in quantity.dimensions),
            quantity.integer,
        )
        for quantity in QUANTITIES
        if quantity.source
    }
    return fields | dict.fromkeys(FURTHER_WORKS, (("time",), False))
