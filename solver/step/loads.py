"""Forces and torques on frames, in space or following the frame: f = direction s(t), or D of it."""

from ..compiler.marks import compiled
from ..compiler.memory import copy
from .frames import add_pair_tangent, pull_back
from .rotations import relative_rotation
from .system import Loads, State, System, Workspace
from .vectors import UNITS, Vector, add_to_row, cross, rotate, row, scale

ZERO = (0.0, 0.0, 0.0)


@compiled
def load_vector(loads: Loads, m: int, work: Workspace) -> Vector:
    """The force or torque of load m, in space."""
    direction = scale(work.loads.value[m], row(loads.direction, m))
    return rotate(work.frames.D, loads.frame[m], direction) if loads.follower[m] else direction


@compiled
def add_load_wrenches(loads: Loads, work: Workspace) -> None:
    """The loads act on their frames."""
    for m in range(len(loads.frame)):
        vector = load_vector(loads, m, work)
        add_to_row(work.frames.wrench, loads.frame[m], 3 * loads.torque[m], vector)


@compiled
def linearize_loads(system: System, state: State, work: Workspace) -> None:
    """K += the tangents of followers, df = dtheta x f; other loads have none but their frame's."""
    loads, frames, pattern = system.loads, system.frames, system.pattern
    half, tangent = work.frames.half_tangent, work.frames.pair_tangent
    for m in range(len(loads.frame)):
        f = loads.frame[m]
        if not loads.follower[m] or frames.body[f] < 0:
            continue
        vector = load_vector(loads, m, work)
        for i in range(3):
            turned = cross(UNITS[i], vector)
            wrench = (ZERO, turned) if loads.torque[m] else (turned, ZERO)
            pull_back(frames, f, wrench, state, work, half[i, :12])
        for z in range(12):
            moment = (half[0, z], half[1, z], half[2, z])
            pull_back(frames, f, (ZERO, moment), state, work, tangent[z, :12])
        add_pair_tangent(frames, (f, f), (0, 0), pattern.body_block[frames.body[f]], work)


@compiled
def add_load_work(loads: Loads, state: State, work: Workspace) -> None:
    """Trapezoidal means of loads times displacements or rotations of their frames in the step."""
    old, motion = state.loads, work.loads.motion
    for m in range(len(loads.frame)):
        f = loads.frame[m]
        vector = load_vector(loads, m, work)
        if loads.torque[m]:
            relative_rotation(old.axes[m], work.frames.D[f], motion)
        else:
            for i in range(3):
                motion[i] = work.frames.r[f, i] - old.position[m, i]
        copy(work.frames.r[f], old.position[m])
        copy(work.frames.D[f], old.axes[m])
        old.value[m] = work.loads.value[m]
        for i in range(3):
            state.energies.work[0] += 0.5 * (vector[i] + old.vector[m, i]) * motion[i]
            old.vector[m, i] = vector[i]
