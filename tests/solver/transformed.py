"""Models that must give the same motion, seen from elsewhere: turned and moved, in another order,
in other units.
"""

from dataclasses import dataclass, replace

import numpy as np
from duhamel.solver import FlexibleBody, Frame, Harmonic, PrescribedRotation
from scipy.spatial.transform import Rotation

AXES = "axis", "second_axis"


def turned(model, Q, shift):
    """The whole model turned by Q about the origin of space, then moved by shift (3,)."""

    def pose(position, rotation):
        return Q.apply(position) + shift, (Q * Rotation.from_rotvec(rotation)).as_rotvec()

    def start(given):
        moved = replace(given, velocity=Q.apply(given.velocity))
        if given.place is None:
            position, rotation = pose(given.position, given.rotation)
            moved = replace(moved, position=position, rotation=rotation)
        return moved

    def direction(axis):
        return None if axis is None else Q.apply(axis)

    def turned_axis(motion):
        key = "axis" if isinstance(motion, PrescribedRotation) else "direction"
        return {key: direction(getattr(motion, key))}

    return replace(
        model,
        bodies={
            name: replace(body, start=start(body.start)) for name, body in model.bodies.items()
        },
        joints=[
            replace(j, **{key: direction(getattr(j, key)) for key in AXES if hasattr(j, key)})
            for j in model.joints
        ],
        springs=[
            replace(s, axis=direction(s.axis), second_axis=direction(s.second_axis))
            for s in model.springs
        ],
        contacts=[replace(c, axis=direction(c.axis)) for c in model.contacts],
        surface_contacts=[replace(c, axis=direction(c.axis)) for c in model.surface_contacts],
        motions=[replace(m, **turned_axis(m)) for m in model.motions],
        loads=[
            load if load.follower else replace(load, direction=direction(load.direction))
            for load in model.loads
        ],
        ground_frames={
            name: Frame(*pose(f.position, f.rotation)) for name, f in model.ground_frames.items()
        },
        gravity=Q.apply(model.gravity),
    )


def reordered(model, order):
    """Bodies, joints, springs, contacts and loads, in the order of `order`, a `random.Random`."""

    def shuffled(items):
        return order.sample(list(items), len(items))

    return replace(
        model,
        bodies=dict(shuffled(model.bodies.items())),
        joints=shuffled(model.joints),
        springs=shuffled(model.springs),
        contacts=shuffled(model.contacts),
        loads=shuffled(model.loads),
    )


@dataclass(frozen=True)
class Units:
    """How many of the new units make up one of the old: of length, mass and time."""

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    @property
    def force(self):
        return self.mass * self.length / self.time**2

    @property
    def velocity(self):
        return np.repeat([self.length / self.time, 1.0 / self.time], 3)

    @property
    def displacement(self):
        return np.repeat([self.length, 1.0], 3)

    @property
    def energy(self):
        return self.force * self.length


def rescaled(model, units):
    """The model in other units, with contacts that have a stiffness, and constant and harmonic
    loads.
    """
    a = units.length

    def frames(given):
        return {name: Frame(a * f.position, f.rotation) for name, f in given.items()}

    def start(given):
        linear, angular = units.velocity[[0, 3]]
        return replace(
            given,
            position=a * given.position,
            velocity=linear * given.velocity,
            angular_velocity=angular * given.angular_velocity,
        )

    def body(given):
        if isinstance(given, FlexibleBody):
            element = rescaled_element(given.superelement, units)
            return FlexibleBody(element, start(given.start))
        return replace(
            given,
            mass=units.mass * given.mass,
            inertia=units.mass * a**2 * given.inertia,
            frames=frames(given.frames),
            start=start(given.start),
        )

    def spring(given):
        size = units.displacement[: given.n_rows]
        per = units.energy / np.outer(size, size)
        return replace(
            given, stiffness=per * given.stiffness, damping=per * units.time * given.damping
        )

    def contact(given):
        impact, per = given.impact, units.force / a ** (given.impact.exponent or 1.0)
        tangential = {key: getattr(given, f"tangential_{key}") for key in ("stiffness", "damping")}
        scales = {"stiffness": units.force / a, "damping": units.force / a * units.time}
        return replace(
            given,
            ball=a * given.ball,
            radius=None if given.radius is None else a * given.radius,
            impact=replace(
                impact,
                stiffness=per * impact.stiffness,
                slow=units.velocity[0] * impact.slow,
            ),
            **{
                f"tangential_{key}": None if value is None else scales[key] * value
                for key, value in tangential.items()
            },
        )

    def load(given):
        unit = units.force if given.type == "force" else units.energy
        return replace(given, direction=unit * given.direction, signal=signal(given.signal))

    def signal(given):
        if isinstance(given, Harmonic):
            return replace(given, frequency=given.frequency / units.time)
        return given

    return replace(
        model,
        bodies={name: body(given) for name, given in model.bodies.items()},
        joints=[
            replace(given, lead=a * given.lead) if hasattr(given, "lead") else given
            for given in model.joints
        ],
        springs=[spring(given) for given in model.springs],
        contacts=[contact(given) for given in model.contacts],
        loads=[load(given) for given in model.loads],
        ground_frames=frames(model.ground_frames),
        gravity=a / units.time**2 * model.gravity,
        settings=replace(
            model.settings,
            step=units.time * model.settings.step,
            t_end=units.time * model.settings.t_end,
        ),
    )


def rescaled_element(element, units):
    """A superelement in other units: eta, the coordinates of its modes, are sqrt(mass) length."""
    size = np.concatenate([units.displacement[: i.n_dofs] for i in element.interfaces])
    per_load = np.outer(size, size) / units.energy
    modes = element.modes
    return replace(
        element,
        mass=units.mass * element.mass,
        J_rot=units.mass * units.length**2 * element.J_rot,
        center=units.length * element.center,
        interfaces=tuple(replace(i, X=units.length * i.X) for i in element.interfaces),
        kernel=replace(
            element.kernel,
            h=units.time * element.kernel.h,
            g=per_load * element.kernel.g,
            g_initial=per_load * element.kernel.g_initial,
        ),
        modes=replace(
            modes,
            omega=modes.omega / units.time,
            phi=size[:, None] / np.sqrt(units.mass * units.length**2) * modes.phi,
        ),
        compliance=per_load * element.compliance,
        accelerance=per_load / units.time**2 * element.accelerance,
    )
