"""Forces and torques on frames, in space or following the frame: f = direction s(t), or D direction
s(t).
"""

from ..arrays import Array
from .frames import add_pair_tangent, pull_back
from .jit import compiled
from .system import Loads, State, System, Workspace
from .vectors import UNITS, Vector, add_to_row, cross, rotate, row, scale

NONE = (0.0, 0.0, 0.0)


@compiled
def load_vector(loads: Loads, m: int, value: float, work: Workspace) -> Vector:
    """The force or torque of load m, in space."""
    direction = scale(value, row(loads.direction, m))
    return rotate(work.D, loads.frame[m], direction) if loads.follower[m] else direction


@compiled
def evaluate_loads(loads: Loads, values: Array, work: Workspace) -> None:
    """Add the loads to the wrenches of their frames."""
    for m in range(len(loads.frame)):
        add_to_row(
            work.wrench, loads.frame[m], 3 * loads.torque[m], load_vector(loads, m, values[m], work)
        )


@compiled
def add_loads(system: System, values: Array, state: State, work: Workspace) -> None:
    """K += the tangents of followers, df = dtheta x f; other loads have none but that of their
    frame.
    """
    loads, frames, pattern = system.loads, system.frames, system.pattern
    half, tangent = work.half_tangent, work.pair_tangent
    for m in range(len(loads.frame)):
        f = loads.frame[m]
        if not loads.follower[m] or frames.body[f] < 0:
            continue
        vector = load_vector(loads, m, values[m], work)
        for i in range(3):
            turned = cross(UNITS[i], vector)
            force, moment = (NONE, turned) if loads.torque[m] else (turned, NONE)
            pull_back(frames, f, force, moment, state, work, half[i, :12])
        for z in range(12):
            pull_back(
                frames, f, NONE, (half[0, z], half[1, z], half[2, z]), state, work, tangent[z, :12]
            )
        b = frames.body[f]
        add_pair_tangent(
            frames, f, f, 0, 0, pattern.body_block[b, 0], pattern.body_block[b, 1], work
        )
