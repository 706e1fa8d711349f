"""Models of impacts: rods, Timoshenko's sphere, an arm on its stop, a hammer on the bracket."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from duhamel.results import Results
from duhamel.solver import (
    Constant,
    Contact,
    Fixed,
    FlexibleBody,
    Frame,
    Impact,
    Model,
    PrescribedDisplacement,
    Revolute,
    RigidBody,
    Settings,
    Start,
    simulate,
)
from duhamel.superelement import Superelement

from .exact import ArmOnStop, Array, History, Rod, RodImpact, SphereOnBeam
from .exact import Contact as Closed

RISE = 3.0
"""Time constant Z / K of the contact of rods, in steps, each the time of a wave for an element."""
LONGER = 1.3
"""Time that is looked at, over that of the contact of rods."""
RHO_INF = 0.9
TOUCH = "touch"
"""name of all contacts"""
MEASURED_SPEED = Callable[[Results], Array]


@dataclass(frozen=True, eq=False)
class Blow:
    """A model with one contact; the speed (n,) [m/s] of the striker from results."""

    model: Model
    speed: MEASURED_SPEED

    def strike(self) -> "Struck":
        results = simulate(self.model)
        force = results.contact(TOUCH).force[:, 0]
        return Struck(results.time, force, self.speed(results), results)


@dataclass(frozen=True, eq=False)
class Struck(History):
    """The history of a blow, with the results."""

    results: Results

    @property
    def blows(self) -> list[Closed]:
        events = self.results.events[TOUCH]
        columns = (events.start, events.end, events.peak, events.impulse)
        return [Closed(*values) for values in zip(*(c.tolist() for c in columns), strict=True)]


def velocity_of(body: str, axis: list[float]) -> MEASURED_SPEED:
    """Of the centre of mass of a body along an axis (3,)."""

    def speed(results: Results) -> Array:
        along: Array = results.body(body).v[:, :3] @ np.array(axis)
        return along

    return speed


def rod_step(rod: Rod, elements: int) -> float:
    """The time [s] that a wave takes for one of the elements."""
    return rod.length / elements / rod.wave_speed


def rod_contact(impedance: float, h: float) -> Impact:
    """As stiff as elements and steps resolve: K = Z / 3 h, with the impedance that it meets."""
    return Impact(stiffness=impedance / (RISE * h))


def rod_on_wall(
    rod: Rod, element: Superelement, exact: RodImpact, speed: float, h: float, rho_inf: float
) -> Blow:
    """A rod flies along x, its interface `touch` ahead, and meets a wall."""
    start = Start(position=_ahead(element), velocity=[speed, 0.0, 0.0])
    wall = Contact(
        TOUCH,
        ("ground.wall", "rod.touch"),
        "plane",
        ball=0.0,
        axis=[-1.0, 0.0, 0.0],
        impact=rod_contact(rod.impedance, h),
    )
    model = Model(
        {"rod": FlexibleBody(element, start)},
        contacts=[wall],
        ground_frames={"wall": Frame()},
        settings=Settings(t_end=LONGER * exact.duration, step=h, rho_inf=rho_inf),
    )
    return Blow(model, velocity_of("rod", [1.0, 0.0, 0.0]))


def rod_on_rod(
    rod: Rod,
    elements: tuple[Superelement, Superelement],
    exact: RodImpact,
    speed: float,
    h: float,
    rho_inf: float,
) -> Blow:
    """A rod flies along x and meets another one, which is turned about, `touch` to `touch`.

    Both have one impedance, and the contact meets half of it.
    """
    striker, struck = elements
    turned = Start(position=-_ahead(struck), rotation=[0.0, 0.0, np.pi])
    bodies = {
        "rod": FlexibleBody(striker, Start(position=_ahead(striker), velocity=[speed, 0.0, 0.0])),
        "struck": FlexibleBody(struck, turned),
    }
    ends = Contact(
        TOUCH,
        ("rod.touch", "struck.touch"),
        "plane",
        ball=0.0,
        axis=[1.0, 0.0, 0.0],
        impact=rod_contact(0.5 * rod.impedance, h),
    )
    settings = Settings(t_end=LONGER * exact.duration, step=h, rho_inf=rho_inf)
    model = Model(bodies, contacts=[ends], settings=settings)
    return Blow(model, velocity_of("rod", [1.0, 0.0, 0.0]))


def bar_on_sphere(
    element: Superelement,
    radii: tuple[float, float],
    speed: float,
    K: float,
    t_end: float,
    h: float,
) -> Blow:
    """A bar flies along x, a ball about its `tip`, and meets one of the ground; radii of both."""
    own, other = radii
    touch = Contact(
        TOUCH,
        ("ground.ball", "bar.tip"),
        "sphere",
        radius=other,
        ball=own,
        impact=Impact(stiffness=K),
    )
    bar = FlexibleBody(
        element, Start(position=-element.interface("tip").X, velocity=[speed, 0.0, 0.0])
    )
    model = Model(
        {"bar": bar},
        contacts=[touch],
        ground_frames={"ball": Frame([own + other, 0.0, 0.0])},
        settings=Settings(t_end=t_end, step=h, rho_inf=RHO_INF),
    )
    return Blow(model, velocity_of("bar", [1.0, 0.0, 0.0]))


def _ahead(element: Superelement) -> Array:
    """Where a rod lies whose `touch` is at the origin."""
    return -element.interface("touch").X


def sphere_on_beam(impact: SphereOnBeam, element: Superelement, t_end: float, h: float) -> Blow:
    """A point mass falls along -z on the middle of a beam that is simply supported."""
    ball = RigidBody(
        impact.m,
        [impact.m * impact.length**2] * 3,
        start=Start(position=element.interface("middle").X, velocity=[0.0, 0.0, -impact.speed]),
    )
    supports = tuple(
        PrescribedDisplacement(f"{end}_{k}", f"beam.{end}", np.eye(3)[k], Constant(0.0))
        for end, held in (("left", (0, 1, 2)), ("right", (1, 2)))
        for k in held
    )
    touch = Contact(
        TOUCH,
        ("beam.middle", "ball"),
        "plane",
        ball=0.0,
        axis=[0.0, 0.0, 1.0],
        impact=Impact(stiffness=impact.K, exponent=1.5),
    )
    model = Model(
        {"beam": FlexibleBody(element), "ball": ball},
        motions=supports,
        contacts=[touch],
        settings=Settings(t_end=t_end, step=h, rho_inf=RHO_INF),
    )
    return Blow(model, velocity_of("ball", [0.0, 0.0, -1.0]))


def arm_on_stop(impact: ArmOnStop, element: Superelement, t_end: float, h: float) -> Blow:
    """An arm turns about y, its root hinged at the origin; its tip meets a stop below it.

    The speed is that of the tip of a rigid arm with the same moment of momentum.
    """
    length, spin = impact.length, impact.speed / impact.length
    centre = -element.interface("root").X
    arm = FlexibleBody(
        element,
        Start(
            position=centre,
            velocity=[0.0, 0.0, -spin * centre[0]],
            angular_velocity=[0.0, spin, 0.0],
        ),
    )
    stop = Contact(
        TOUCH,
        ("ground.stop", "arm.tip"),
        "plane",
        ball=0.0,
        axis=[0.0, 0.0, 1.0],
        impact=Impact(stiffness=impact.K, exponent=1.5),
    )
    model = Model(
        {"arm": arm},
        [Revolute("ground", "arm.root", [0.0, 1.0, 0.0], name="hinge")],
        contacts=[stop],
        ground_frames={"stop": Frame([length, 0.0, 0.0])},
        settings=Settings(t_end=t_end, step=h, rho_inf=RHO_INF),
    )

    def speed(results: Results) -> Array:
        tip: Array = results.momentum.angular[:, 1] / (impact.m * length)
        return tip

    return Blow(model, speed)


@dataclass(frozen=True)
class Hammer:
    """mass [kg]; the force of its tip; speed [m/s]."""

    mass: float
    tip: Impact
    speed: float


def hammer_on_lug(hammer: Hammer, bracket: Superelement, t_end: float, h: float) -> Blow:
    """A hammer flies along x to a lug of the bracket, which four bolts hold."""
    lug = bracket.interface("lug_1").X
    head = RigidBody(
        hammer.mass,
        [1e-3 * hammer.mass] * 3,
        start=Start(position=lug, velocity=[hammer.speed, 0.0, 0.0]),
    )
    bolts = [Fixed("ground", f"bracket.bolt_{n}", name=f"bolt_{n}") for n in range(1, 5)]
    touch = Contact(
        TOUCH,
        ("hammer", "bracket.lug_1"),
        "plane",
        ball=0.0,
        axis=[1.0, 0.0, 0.0],
        impact=hammer.tip,
    )
    model = Model(
        {"hammer": head, "bracket": FlexibleBody(bracket)},
        bolts,
        contacts=[touch],
        settings=Settings(t_end=t_end, step=h, rho_inf=RHO_INF),
    )
    return Blow(model, velocity_of("hammer", [1.0, 0.0, 0.0]))
