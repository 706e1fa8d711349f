"""What tells, of the motion of each body as a whole, whether the step resolves it.

Of velocities, sums of the squares of their changes in a step and of the changes of these: of a
vibration of frequency omega their ratio is (2 sin(omega h / 2))^2, whatever steady motion goes with
it. Of angular momentum L about the center of mass, what the step has added beyond the moments M
that act at its ends,

    defect = sum of L_{n+1} - L_n - h/2 (M_n + M_{n+1}),     M = R (J omega' + omega x J omega)

of a body that turns freely all that its angular momentum has changed by.
"""

from ..compiler.marks import compiled
from .bodies import spin_moment, spin_momentum
from .records.bodies import Bodies
from .records.extremes import MomentumExtremes, MotionExtremes
from .system import State, System, Workspace
from .vectors import add, dot, rotate, row, scale, subtract

MIN_STEPS_IN_ROW = 2
"""steps in a row after which the change of a change is known"""


@compiled
def start_bodies(bodies: Bodies, state: State, work: Workspace) -> None:
    """From the state at the start of a run on."""
    motion, momentum = state.extremes.motion, state.extremes.momentum
    motion.row[0] = 0
    for b in range(len(bodies.mass)):
        for i in range(6):
            motion.velocity[b, i] = state.bodies.v[b, i]
    for k in range(len(bodies.free)):
        _keep_momentum(momentum, k, bodies.free[k], state, work)


@compiled
def follow_bodies(system: System, state: State, work: Workspace) -> None:
    """Take a step; where steps are of two sizes, velocities are followed over the long ones."""
    bodies, scheme, motion = system.bodies, system.scheme, state.extremes.motion
    # Short steps interrupt the series: differences across them would look like vibration.
    motion.row[0] = motion.row[0] + 1 if scheme.stride == scheme.ratio else 0
    counts = motion.row[0] >= MIN_STEPS_IN_ROW
    for b in range(len(bodies.mass)):
        for half in range(2):
            _follow_velocity(motion, b, half, counts, state)
    for k in range(len(bodies.free)):
        _follow_momentum(k, bodies.free[k], scheme.h, state, work)
    motion.steps[0] += int(counts)


@compiled
def _follow_velocity(motion: MotionExtremes, b: int, half: int, counts: bool, state: State) -> None:
    """Of body b the velocity, half 0, or the angular velocity, half 1."""
    square, changes, bends = 0.0, 0.0, 0.0
    for i in range(3 * half, 3 * half + 3):
        v = state.bodies.v[b, i]
        change = v - motion.velocity[b, i]
        bend = change - motion.change[b, i]
        motion.velocity[b, i], motion.change[b, i] = v, change
        if counts:
            motion.sum[b, i] += v
        square += v * v
        changes += change * change
        bends += bend * bend
    if counts:
        motion.square[b, half] += square
        motion.changes[b, half] += changes
        motion.bends[b, half] += bends
        motion.largest[b, half] = max(motion.largest[b, half], changes)


@compiled
def _follow_momentum(k: int, b: int, h: float, state: State, work: Workspace) -> None:
    """Of free body k, which is body b."""
    momentum = state.extremes.momentum
    L, M = row(momentum.momentum, k), row(momentum.moment, k)
    _keep_momentum(momentum, k, b, state, work)
    expected = add(L, scale(0.5 * h, add(M, row(momentum.moment, k))))
    # Summed as a vector: defects that cancel over a turn are no drift.
    left = subtract(row(momentum.momentum, k), expected)
    total = add(row(momentum.defect, k), left)
    for i in range(3):
        momentum.defect[k, i] = total[i]
    momentum.largest_defect[k] = max(momentum.largest_defect[k], dot(total, total))


@compiled
def _keep_momentum(
    momentum: MomentumExtremes, k: int, b: int, state: State, work: Workspace
) -> None:
    """L and M at the end of a step, and the largest L so far."""
    L = rotate(state.bodies.R, b, spin_momentum(b, state, work))
    M = rotate(state.bodies.R, b, spin_moment(b, state, work))
    for i in range(3):
        momentum.momentum[k, i], momentum.moment[k, i] = L[i], M[i]
    momentum.largest[k] = max(momentum.largest[k], dot(L, L))
