"""How far two runs of one mechanism may end apart, from the tolerance of Newton's method and the
step.

A step is solved to `tolerance` of its own motion, and coordinates are rounded: an error of

    delta = tolerance (|v| + size |omega|) h + eps reach

of a position, and as velocities follow positions by 2 / h, of 2 delta / h in a velocity and
4 delta / h^2 in an acceleration. N steps carry velocities on: N^2 delta in positions.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from ..transformed import Units

UNTURNED, UNMOVED, SI = Rotation.identity(), np.zeros(3), Units()
EPS = np.finfo(float).eps
MECHANISMS = 10.0
"""by how much the levers and the ratios of masses of a few bodies multiply an error"""


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
