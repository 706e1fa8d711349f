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
from .system import MomentumExtremes, MotionExtremes, Scheme, State, Workspace
from .vectors import add, dot, rotate, row, scale, subtract

PAIR = 2
"""steps in a row before the change of a change is known"""


@compiled
def start_bodies(state: State, work: Workspace) -> None:
    """From the state at the start of a run on."""
    motion, momentum = state.extremes.motion, state.extremes.momentum
    motion.row[0] = 0
    for b in range(len(momentum.largest)):
        for i in range(6):
            motion.velocity[b, i] = state.bodies.v[b, i]
        _keep_momentum(momentum, b, state, work)


@compiled
def follow_bodies(scheme: Scheme, state: State, work: Workspace) -> None:
    """Take a step; where steps are of two sizes, velocities are followed over the long ones."""
    motion, momentum = state.extremes.motion, state.extremes.momentum
    followed = scheme.stride == scheme.ratio
    motion.row[0] = motion.row[0] + 1 if followed else 0
    for b in range(len(momentum.largest)):
        for half in range(2):
            _follow_velocity(motion, b, half, followed, state)
        _follow_momentum(momentum, b, scheme.h, state, work)
    motion.steps[0] += int(followed)


@compiled
def _follow_velocity(
    motion: MotionExtremes, b: int, half: int, followed: bool, state: State
) -> None:
    """Of body b the velocity, half 0, or the angular velocity, half 1."""
    in_row = motion.row[0]
    square, changes, bends = 0.0, 0.0, 0.0
    for i in range(3 * half, 3 * half + 3):
        v = state.bodies.v[b, i]
        change = v - motion.velocity[b, i]
        bend = change - motion.change[b, i]
        motion.velocity[b, i], motion.change[b, i] = v, change
        if followed:
            motion.sum[b, i] += v
        square += v * v
        changes += change * change
        bends += bend * bend
    if followed:
        motion.square[b, half] += square
        motion.changes[b, half] += changes
        motion.largest[b, half] = max(motion.largest[b, half], changes)
    if in_row >= PAIR:
        motion.bends[b, half] += bends


@compiled
def _follow_momentum(
    momentum: MomentumExtremes, b: int, h: float, state: State, work: Workspace
) -> None:
    L, M = row(momentum.momentum, b), row(momentum.moment, b)
    _keep_momentum(momentum, b, state, work)
    expected = add(L, scale(0.5 * h, add(M, row(momentum.moment, b))))
    left = subtract(row(momentum.momentum, b), expected)
    total = add(row(momentum.defect, b), left)
    for i in range(3):
        momentum.defect[b, i] = total[i]
    momentum.largest_defect[b] = max(momentum.largest_defect[b], dot(total, total))


@compiled
def _keep_momentum(momentum: MomentumExtremes, b: int, state: State, work: Workspace) -> None:
    """L and M at the end of a step, and the largest L so far."""
    L = rotate(state.bodies.R, b, spin_momentum(b, state, work))
    M = rotate(state.bodies.R, b, spin_moment(b, state, work))
    for i in range(3):
        momentum.momentum[b, i], momentum.moment[b, i] = L[i], M[i]
    momentum.largest[b] = max(momentum.largest[b], dot(L, L))
