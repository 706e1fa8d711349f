"""Velocities that bodies are given and do not start with."""

from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from ..lower.lower import LoweredModel
from ..model.bodies import Body
from ..step.system import State

NOTICEABLE_CHANGE = 0.01
"""of a velocity at the start, relative to that given, by the square root of the kinetic energy"""


def lost_velocities(lowered: LoweredModel, state: State) -> Iterator[str]:
    """Bodies that start with another velocity than is given, in words.

    Rates of joints that are asked for count as given: then bodies that are said to rest do not.
    """
    for b, (name, body) in enumerate(lowered.model.bodies.items()):
        start = body.start
        given = np.concatenate([start.velocity, start.angular_velocity])
        change = state.bodies.v[b] - given
        energies = [_twice_energy(body, velocity) for velocity in (given, change)]
        if energies[1] > NOTICEABLE_CHANGE**2 * energies[0] > 0.0:
            v, omega = state.bodies.v[b, :3], state.bodies.v[b, 3:]
            yield (
                f"body {name!r}: starts with velocity = {_listed(v)}, angular_velocity = "
                f"{_listed(omega)}, not with {_listed(given[:3])} and {_listed(given[3:])} as "
                "given: its joints do not allow that while elastic bodies start without "
                "vibration; give all bodies velocities that fit, or a rate in the start of a joint"
            )


def _twice_energy(body: Body, velocity: Array) -> float:
    v, omega = velocity[:3], velocity[3:]
    return float(body.mass * v @ v + omega @ body.inertia @ omega)


def _listed(numbers: Array) -> str:
    return f"[{', '.join(f'{number:.4g}' for number in numbers)}]"
