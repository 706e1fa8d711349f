"""Forces and torques on frames, in space or following the frame: f = direction s(t), or D direction s(t)."""

from .compiled import Array, compiled
from .frames import add_pair_tangent
from .system import Frames, Loads, Workspace
from .vectors import Vector, add_to_row, cross, rotate, row, scale


@compiled
def load_vector(loads: Loads, m: int, value: float, work: Workspace) -> Vector:
    """The force or torque of load m, in space."""
    direction = scale(value, row(loads.direction, m))
    return rotate(work.D, loads.frame[m], direction) if loads.follower[m] else direction


@compiled
def evaluate_loads(loads: Loads, values: Array, work: Workspace) -> None:
    """Add the loads to the wrenches of their frames."""
    for m in range(len(loads.frame)):
        add_to_row(work.wrench, loads.frame[m], 3 * loads.torque[m], load_vector(loads, m, values[m], work))


@compiled
def load_tangent(loads: Loads, m: int, value: float, work: Workspace) -> None:
    """`work.frame_tangent`[:6, :6]: the derivative of the wrench of a follower by (r, theta): df = dtheta x f."""
    K = work.frame_tangent
    K[:] = 0.0
    f = load_vector(loads, m, value, work)
    first = 3 * loads.torque[m]
    for i in range(3):
        e = (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0)
        turned = cross(e, f)
        for k in range(3):
            K[first + k, 3 + i] = turned[k]


@compiled
def add_loads(loads: Loads, frames: Frames, n_q: int, values: Array, work: Workspace) -> None:
    """K += the tangents of followers; other loads have none but that of their frame."""
    for m in range(len(loads.frame)):
        if loads.follower[m]:
            f = loads.frame[m]
            load_tangent(loads, m, values[m], work)
            add_pair_tangent(frames, n_q, f, f, 0, 0, work)
