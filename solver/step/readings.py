"""Sensors of flexible bodies, read into a row of the output."""

from ..compiler.marks import compiled
from .bodies import spin_of
from .records.elastic import Sensors
from .system import Output, State
from .vectors import Vector, add, cross, rotate_back, row, scale, triple


@compiled
def record_readings(sensors: Sensors, state: State, output: Output, k: int) -> None:
    """Readings, their rates and second derivatives; of points the acceleration in space.

    All in body axes.
    """
    motion = state.interfaces
    for c in range(len(sensors.dof)):
        dof, axis = sensors.dof[c], sensors.axis[c]
        output.sensor_value[k, c] = motion.u[dof]
        output.sensor_rate[k, c] = motion.rate[dof]
        if axis < 0:
            output.sensor_acceleration[k, c] = motion.acceleration[dof]
        if axis == 0:
            acceleration = _acceleration(sensors, c, state)
            for i in range(3):
                output.sensor_acceleration[k, c + i] = acceleration[i]


@compiled
def _acceleration(sensors: Sensors, c: int, state: State) -> Vector:
    """R^T x'' + omega' x l + omega x (omega x l + 2 u') + u'', l = X + u, of a point."""
    b, dof, v_dot = sensors.body[c], sensors.dof[c], state.bodies.v_dot
    omega, alpha = spin_of(state, b), (v_dot[b, 3], v_dot[b, 4], v_dot[b, 5])
    lever = add(row(sensors.X, c), triple(state.interfaces.u, dof))
    rate = triple(state.interfaces.rate, dof)
    turning = cross(omega, add(cross(omega, lever), scale(2.0, rate)))
    own = add(triple(state.interfaces.acceleration, dof), add(cross(alpha, lever), turning))
    return add(rotate_back(state.bodies.R, b, row(v_dot, b)), own)
