"""How far two runs of one mechanism may end apart, from the tolerance of Newton's method and the
step.

A step is solved to `tolerance` of its own motion, and coordinates are rounded: an error of

    delta = tolerance (|v| + size |omega|) h + eps reach

of a position, and as velocities follow positions by 2 / h, of 2 delta / h in a velocity and
4 delta / h^2 in an acceleration. N steps carry velocities on: N^2 delta in positions.

Two runs end as far apart as the mechanism takes errors of velocities, 2 N delta / h of all steps:
far at a nearly singular pose, or where a contact barely closes. A run that starts with a nudge
tells how far.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from ..transformed import Units
from .mechanisms import run

UNTURNED, UNMOVED, SI = Rotation.identity(), np.zeros(3), Units()
EPS = np.finfo(float).eps
MECHANISMS = 10.0
"""by how much the levers and the ratios of masses of a few bodies multiply an error"""

NUDGE = 1e-6
"""[m/s] of every body, far above what the tolerance leaves"""


@dataclass(frozen=True)
class Bounds:
    """Of positions [m], velocities [m/s] and forces [N]; angles count by `size` [m]."""

    size: float
    position: float
    velocity: float
    force: float


def bounds(model, results, reach=0.0):
    """`reach` [m]: how far from the origin another run is that is compared with this one."""
    h, n = model.settings.step, len(results.time)
    motions = [results.body(name) for name in model.bodies]
    size = max(
        [
            0.2,
            *(np.linalg.norm(f.position) for b in model.bodies.values() for f in b.frames.values()),
        ]
    )
    reach = max(reach, size, *(np.abs(motion.x).max() for motion in motions))
    speed = max(np.abs(motion.v @ np.diag([1, 1, 1, size, size, size])).max() for motion in motions)
    mass = sum(body.mass for body in model.bodies.values())
    delta = MECHANISMS * (model.settings.tolerance * speed * h + EPS * reach)
    return Bounds(size, n**2 * delta, 2 * n * delta / h, 4 * n * mass * delta / h**2)


def bounds_apart(model, results, reach=0.0):
    """Of the differences of two runs."""
    limits = bounds(model, results, reach)
    position, velocity, force = apart(results, run(nudged(model, limits.size)), model)
    error = limits.velocity / NUDGE
    return Bounds(
        limits.size,
        max(limits.position, error * position),
        max(limits.velocity, error * velocity),
        max(limits.force, error * force),
    )


def nudged(model, size):
    """The model with other velocities at the start, by NUDGE in every axis of every body."""
    signs = np.random.default_rng(0)
    bodies = {}
    for name, body in model.bodies.items():
        linear, angular = NUDGE * signs.choice([-1.0, 1.0], (2, 3))
        start = body.start
        start = replace(
            start,
            velocity=start.velocity + linear,
            angular_velocity=start.angular_velocity + angular / size,
        )
        bodies[name] = replace(body, start=start)
    return replace(model, bodies=bodies)


def rotations(motion, attribute="R"):
    return Rotation.from_quat(getattr(motion, attribute), scalar_first=True)


def couplings(results):
    """Of joints and springs, by name: their order is the model's."""
    joints = [results.joint(name) for name in sorted(results.joints)]
    return joints + [results.spring(name) for name in sorted(results.springs)]


def apart(here, there, model, Q=UNTURNED, shift=UNMOVED, units=SI):
    """The largest differences of positions [m], velocities [m/s] and forces [N].

    `there` is turned by Q, then moved by shift (3,), and in other units.
    """
    size = bounds(model, here).size
    position, velocity, force = [0.0], [0.0], [0.0]
    for name in model.bodies:
        a, b = here.body(name), there.body(name)
        v = b.v / units.velocity
        position.append(np.abs(b.x / units.length - Q.apply(a.x) - shift).max())
        position.append(size * (rotations(b).inv() * Q * rotations(a)).magnitude().max())
        velocity.append(np.abs(v[:, :3] - Q.apply(a.v[:, :3])).max())
        velocity.append(size * np.abs(v[:, 3:] - a.v[:, 3:]).max())
    for name in here.interfaces:
        u = there.frame(name).u / units.displacement
        position.append(np.abs(u - here.frame(name).u).max())
    for a, b in zip(couplings(here), couplings(there), strict=True):
        force.append(np.abs(b.force / units.force - Q.apply(a.force)).max())
        force.append(np.abs(b.moment / units.energy - Q.apply(a.moment)).max() / size)
    return max(position), max(velocity), max(force)
