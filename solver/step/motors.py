"""Motors on joint coordinates: servos with limits, whose integral is stepped with the motion.

With the error e = r - c of the coordinate c,

    v = f + stiffness e + damping e' + z,    tau = v within [lower, upper]
    z' = integral e + (tau - v) tracking

z is stepped by the trapezoidal rule, of which the end of the step is solved here in closed form, so
that tau is a function of c and dc/dt alone, and its exact slopes are part of Newton's matrix.

Whether a motor is at a limit is judged by its multiplier, which v moves by half of the range at
most. A solution has lambda = tau, and there this and v tell the same; but Newton's method, which
may go to and fro for ever between two limits by v, comes from a limit to the servo first. (An
active set by multipliers: Hintermueller, Ito, Kunisch, SIAM J. Optim. 13, 2002.)
"""

import math

from ..compiler.marks import compiled
from ..compiler.memory import copy
from .records.laws import Motors
from .system import State, Workspace


@compiled
def motor_law(
    motors: Motors, m: int, state: State, work: Workspace
) -> tuple[float, float, float, float]:
    """The force against its coordinate, the slopes by coordinate and rate, and no energy."""
    out, i = work.motors, motors.row[m]
    c, rate = work.couplings.coordinate[i], work.couplings.rate[i]
    error, error_rate = out.value[3 * m + 1] - c, out.value[3 * m + 2] - rate
    step = _step(work)
    asked = out.value[3 * m] + motors.stiffness[m] * error + motors.damping[m] * error_rate
    z = state.motors.integral[m]
    z += 0.5 * step * (state.motors.slope[m] + motors.integral[m] * error)
    v = asked + z
    lower, upper = bounds_of(motors, m, rate)
    torque = min(max(v, lower), upper)
    # Solved implicitly: an explicit anti-windup is unstable for short tracking times.
    lag = 0.5 * step * motors.tracking[m]
    excess = (v - torque) / (1.0 + lag)
    out.error[m], out.torque[m] = error, torque
    out.integral[m] = z - lag * excess
    out.slope[m] = motors.integral[m] * error - motors.tracking[m] * excess
    out.scale[m] = abs(asked) + abs(z)
    out.status[m] = _status(v, state.couplings.lam[i], lower, upper)
    # -v, even slightly beyond a limit: the status decides, so that force and slope agree.
    if out.status[m] == 0:
        slope = motors.stiffness[m] + 0.5 * step * motors.integral[m]
        return -v, slope, motors.damping[m], 0.0
    limit = lower if out.status[m] < 0 else upper
    return -limit, 0.0, -_bound_slope(motors, m, rate, out.status[m]), 0.0


@compiled
def _step(work: Workspace) -> float:
    """The time since the integral was that of the state: none at the start."""
    h = work.couplings.elapsed[0]
    return h if h < math.inf else 0.0


@compiled
def _status(v: float, lam: float, lower: float, upper: float) -> int:
    """-1, 1: at the lower or upper limit; 0: between them."""
    half = 0.5 * (upper - lower)
    w = lam + min(max(v - lam, -half), half)
    if w > upper:
        return 1
    return -1 if w < lower else 0


@compiled
def bounds_of(motors: Motors, m: int, rate: float) -> tuple[float, float]:
    """The limits of motor m at a rate of its coordinate, less towards the speed without load."""
    lower, upper = motors.lower[m], motors.upper[m]
    if motors.speed[m] < math.inf:
        part = rate / motors.speed[m]
        # Only what drives the motion falls with speed; braking keeps the full limit.
        upper *= min(max(1.0 - part, 0.0), 1.0)
        lower *= min(max(1.0 + part, 0.0), 1.0)
    return lower, upper


@compiled
def _bound_slope(motors: Motors, m: int, rate: float, status: int) -> float:
    """The derivative of the limit that motor m is at by the rate."""
    speed = motors.speed[m]
    if status > 0:
        return -motors.upper[m] / speed if 0.0 < rate < speed else 0.0
    return motors.lower[m] / speed if -speed < rate < 0.0 else 0.0


@compiled
def settle_motors(state: State, work: Workspace) -> None:
    """Let the integrals be those of the last evaluation, at the end of a step."""
    copy(work.motors.integral, state.motors.integral)
    copy(work.motors.slope, state.motors.slope)


@compiled
def have_motors_switched(work: Workspace) -> bool:
    """Whether a motor has come to a limit or left it since the matrix was made."""
    out = work.motors
    switched = False
    for m in range(len(out.status)):
        switched = switched or out.status[m] != out.matrix_status[m]
    return switched


@compiled
def note_motors(work: Workspace) -> None:
    """The matrix is that of the present status."""
    out = work.motors
    for m in range(len(out.status)):
        out.matrix_status[m] = out.status[m]
