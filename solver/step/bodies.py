"""Rigid motion of bodies: its generalized-alpha steps, inertia, energy and momentum.

    residual = J v_dot + v~ J v - f_r        f_r: loads, couplings, gravity
    h^2 S_rr = h^2 beta' m I                                             on X
               h^2 (beta' J + gamma' (omega~ J - (J omega)~)) T^-1(psi)  on Theta

J and J omega are those of the deformed body, and include its elastic motion, where it has terms of
second order (second_order.py); with delta X = R^T delta x and delta Theta = T(psi) delta psi.

Source: docs/theory.md, The time step.
"""

from ..arrays import Array
from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from ..compiler.parts import larger_parts
from .measure import SUM_ROUNDING, relative
from .newmark import (
    end_pseudo_acceleration,
    free_pseudo_acceleration,
    predicted_change,
    predicted_rate,
)
from .records.bodies import Bodies
from .records.matrix import Pattern
from .records.scheme import Scheme
from .rotations import (
    normalize,
    quaternion_exponential,
    quaternion_matrix,
    quaternion_product,
    tangent_inverse,
)
from .system import State, System, Workspace
from .vectors import (
    UNIT_AXES,
    Vector,
    add,
    cross,
    dot,
    magnitude,
    multiply,
    rotate,
    rotate_back,
    row,
    scale,
    triple,
)


@compiled
def spin_of(state: State, b: int) -> Vector:
    """omega of body b, in body axes."""
    v = state.bodies.v
    return v[b, 3], v[b, 4], v[b, 5]


@compiled
def predict_bodies(scheme: Scheme, state: State, work: Workspace) -> None:
    """Motion at the end of the step for v_dot = 0, where a is a*; then with v_dot = v_dot_n."""
    motion, predicted = state.bodies, work.bodies
    copy(motion.quaternion, predicted.quaternion_n)
    for b in range(len(motion.x)):
        for i in range(6):
            a_n = motion.a[b, i]
            a = free_pseudo_acceleration(scheme, motion.v_dot[b, i], a_n)
            change = predicted_change(scheme, motion.v[b, i], a_n, a)
            if i < 3:
                predicted.x_predicted[b, i] = motion.x[b, i] + change
            else:
                predicted.psi_predicted[b, i - 3] = change
            predicted.v_predicted[b, i] = predicted_rate(scheme, motion.v[b, i], a_n, a)
            motion.a[b, i] = a
    accelerate(scheme, state, work)


@compiled
def accelerate(scheme: Scheme, state: State, work: Workspace) -> None:
    """Positions and velocities that belong to v_dot, from those predicted for v_dot = 0."""
    motion, predicted = state.bodies, work.bodies
    # A change of v_dot by beta' dx moves x by dx and v by gamma' dx: their ratio is the change of
    # v.
    slope = scheme.gamma_prime / scheme.beta_prime
    for b in range(len(motion.x)):
        for i in range(6):
            motion.v[b, i] = predicted.v_predicted[b, i] + slope * motion.v_dot[b, i]
        for i in range(3):
            linear, angular = motion.v_dot[b, i], motion.v_dot[b, 3 + i]
            motion.x[b, i] = predicted.x_predicted[b, i] + linear / scheme.beta_prime
            predicted.psi[b, i] = predicted.psi_predicted[b, i] + angular / scheme.beta_prime
        set_rotation(b, state, work)


@compiled
def finish_bodies(scheme: Scheme, state: State) -> None:
    """Pseudo-accelerations at the end of the step."""
    motion = state.bodies
    for b in range(len(motion.a)):
        for i in range(6):
            motion.a[b, i] = end_pseudo_acceleration(scheme, motion.a[b, i], motion.v_dot[b, i])


@compiled
def move_body(b: int, first: int, scheme: Scheme, state: State, work: Workspace) -> None:
    """Apply the corrections of body b, from `first` on in the right-hand side, eqs (72)-(74)."""
    motion, T, rhs = state.bodies, work.bodies.T_inverse, work.matrix.rhs
    tangent_inverse(work.bodies.psi[b], T)
    dx = rotate(motion.R, b, triple(rhs, first))
    dpsi = multiply(T, triple(rhs, first + 3))
    for i in range(3):
        motion.x[b, i] += dx[i]
        motion.v[b, i] += scheme.gamma_prime * dx[i]
        motion.v_dot[b, i] += scheme.beta_prime * dx[i]
        work.bodies.psi[b, i] += dpsi[i]
        motion.v[b, 3 + i] += scheme.gamma_prime * dpsi[i]
        motion.v_dot[b, 3 + i] += scheme.beta_prime * dpsi[i]
    set_rotation(b, state, work)


@entry
def set_rotations(state: State, work: Workspace) -> None:
    """The rotations of all bodies from psi."""
    for b in range(len(state.bodies.x)):
        set_rotation(b, state, work)


@compiled
def set_rotation(b: int, state: State, work: Workspace) -> None:
    """R = R_n exp(skew(psi)), from the quaternion at the start of the step."""
    increment, product = work.bodies.increment, state.bodies.quaternion[b]
    quaternion_exponential(work.bodies.psi[b], increment)
    quaternion_product(work.bodies.quaternion_n[b], increment, product)
    # Products of unit quaternions leave the unit sphere by rounding, which would add up over a run.
    normalize(product)
    quaternion_matrix(product, state.bodies.R[b])


@compiled
def add_inertia_forces(bodies: Bodies, state: State, work: Workspace) -> None:
    """residual = J v_dot + v~ J v - f_r, with gravity in f_r."""
    v_dot, terms = state.bodies.v_dot, work.bodies
    for b in range(len(bodies.mass)):
        mass = bodies.mass[b]
        inertia, gyroscopic = _inertia_moments(b, state, work)
        for i in range(3):
            weight = mass * bodies.gravity[i]
            terms.residual[b, i] = mass * v_dot[b, i] - weight - terms.force[b, i]
            terms.residual[b, 3 + i] = inertia[i] + gyroscopic[i] - terms.force[b, 3 + i]


@compiled
def set_inertia_scales(bodies: Bodies, state: State, work: Workspace) -> None:
    """The force scales of all bodies, so far of inertia and gravity."""
    for b in range(len(bodies.mass)):
        inertia, gyroscopic = _inertia_moments(b, state, work)
        # Magnitudes, not their sum: in free fall both cancel, and the scale would vanish with them.
        force = magnitude(row(state.bodies.v_dot, b)) + magnitude(triple(bodies.gravity, 0))
        work.bodies.force_scale[b, 0] = bodies.mass[b] * force
        work.bodies.force_scale[b, 1] = magnitude(inertia) + magnitude(gyroscopic)


@compiled
def _inertia_moments(b: int, state: State, work: Workspace) -> tuple[Vector, Vector]:
    """J omega' + J' omega + Gamma' and omega x (J omega + Gamma) of body b, in body axes."""
    v_dot, omega = state.bodies.v_dot, spin_of(state, b)
    inertia = rotate(work.bodies.J, b, (v_dot[b, 3], v_dot[b, 4], v_dot[b, 5]))
    inertia = add(inertia, row(work.bodies.relative_moment, b))
    return inertia, cross(omega, spin_momentum(b, state, work))


@compiled
def spin_momentum(b: int, state: State, work: Workspace) -> Vector:
    """J omega + Gamma of body b, about its center of mass, in body axes."""
    rigid = rotate(work.bodies.J, b, spin_of(state, b))
    return add(rigid, row(work.bodies.relative_momentum, b))


@compiled
def spin_moment(b: int, state: State, work: Workspace) -> Vector:
    """The moment about the center of mass of body b that its motion needs, in body axes."""
    inertia, gyroscopic = _inertia_moments(b, state, work)
    return add(inertia, gyroscopic)


@compiled
def add_inertia(system: System, state: State, work: Workspace) -> None:
    """S += h^2 S_rr."""
    bodies, scheme, pattern = system.bodies, system.scheme, system.pattern
    h2 = scheme.h * scheme.h
    S, D, T = work.matrix.S, work.bodies.inertia, work.bodies.T_inverse
    for b in range(len(bodies.mass)):
        start, stride = pattern.body_block[b, 0], pattern.body_block[b, 1]
        J = work.bodies.J[b]
        omega, momentum_b = spin_of(state, b), spin_momentum(b, state, work)
        for j in range(3):
            S[start + j * (stride + 1)] += h2 * scheme.beta_prime * bodies.mass[b]
            spin = cross(omega, (J[0, j], J[1, j], J[2, j]))
            turned = cross(momentum_b, UNIT_AXES[j])
            for i in range(3):
                gyroscopic = scheme.gamma_prime * (spin[i] - turned[i])
                D[i, j] = scheme.beta_prime * J[i, j] + gyroscopic
        tangent_inverse(work.bodies.psi[b], T)
        for i in range(3):
            for j in range(3):
                total = D[i, 0] * T[0, j] + D[i, 1] * T[1, j] + D[i, 2] * T[2, j]
                S[start + (3 + i) * stride + 3 + j] += h2 * total


@compiled
def set_body_rhs(pattern: Pattern, h2: float, state: State, work: Workspace) -> None:
    """-h^2 times the residual of equilibrium, forces in body axes."""
    residual, rhs = work.bodies.residual, work.matrix.rhs
    for b in range(len(pattern.body)):
        first = pattern.first[pattern.body[b]]
        # In body axes the matrix does not change as a mechanism turns, so that its factors serve
        # many steps.
        force = rotate_back(state.bodies.R, b, row(residual, b))
        for i in range(3):
            rhs[first + i] = -h2 * force[i]
            rhs[first + 3 + i] = -h2 * residual[b, 3 + i]


@compiled
def largest_correction(pattern: Pattern, size: float, work: Workspace) -> float:
    """The largest correction of a body, rotations times the size of the model [m]."""
    largest = 0.0
    for b in range(len(pattern.body)):
        first = pattern.first[pattern.body[b]]
        for i in range(3):
            largest = larger_parts(largest, work.matrix.rhs[first + i])
            # An angle is weighed by the displacement that it causes at the edge of the model.
            largest = larger_parts(largest, size * work.matrix.rhs[first + 3 + i])
    return largest


@compiled
def largest_coordinate(bodies: Bodies, state: State) -> float:
    """The scale of the rounding of positions: the largest coordinate, or the size of the model."""
    largest = bodies.size
    for b in range(len(state.bodies.x)):
        for i in range(3):
            largest = max(largest, abs(state.bodies.x[b, i]))
    return largest


@compiled
def largest_motion(bodies: Bodies, h: float, state: State) -> float:
    """The largest coordinate or rotation times the size of the model, in each part of a number.

    Its derivatives are the scales of the rounding of those of positions. Rates and accelerations
    count by what they move in a step: at the start positions may depend on no parameter.
    """
    motion, largest = state.bodies, 0.0
    for b in range(len(motion.x)):
        for i in range(3):
            largest = larger_parts(largest, motion.x[b, i])
        for i in range(4):
            largest = larger_parts(largest, 2.0 * bodies.size * motion.quaternion[b, i])
        for i in range(6):
            length = h if i < 3 else h * bodies.size
            largest = larger_parts(largest, length * motion.v[b, i])
            largest = larger_parts(largest, h * length * motion.v_dot[b, i])
    return largest


@compiled
def step_motion(scheme: Scheme, state: State, work: Workspace) -> tuple[float, float]:
    """The largest translation and rotation of a body in the step."""
    motion, h = state.bodies, scheme.h
    length, angle = 0.0, 0.0
    for b in range(len(motion.x)):
        for i in range(3):
            # With the acceleration: where a body reverses, its velocity is zero but not its motion.
            length = max(length, abs(h * motion.v[b, i]) + abs(h * h * motion.v_dot[b, i]))
            rotation = abs(work.bodies.psi[b, i]) + abs(h * h * motion.v_dot[b, 3 + i])
            angle = max(angle, rotation)
    return length, angle


@compiled
def relative_body_residual(
    system: System, reach: float, at_rest: bool, state: State, work: Workspace
) -> float:
    """The largest residual of equilibrium over the sum of the magnitudes of its terms.

    0 at their rounding. That of positions up to `reach`, seen through beta', counts only once
    Newton's method is `at_rest`, lest it hide a true residual.
    """
    bodies, terms, tolerance = system.bodies, work.bodies, system.newton.tolerance
    # beta' is of the order 1 / h^2, which makes of rounded positions large rounded forces.
    by_position = SUM_ROUNDING * system.scheme.beta_prime if at_rest else 0.0
    worst = 0.0
    for b in range(len(bodies.mass)):
        forces, moments = terms.force_scale[b, 0], terms.force_scale[b, 1]
        force_floor = SUM_ROUNDING * forces + by_position * bodies.mass[b] * reach
        moment_floor = SUM_ROUNDING * (moments + reach * forces)
        for i in range(3):
            moment_floor += by_position * bodies.J_rot[b, i, i]
        for i in range(3):
            force = relative(terms.residual[b, i], forces, force_floor, tolerance)
            moment = relative(terms.residual[b, 3 + i], moments, moment_floor, tolerance)
            worst = max(worst, force, moment)
    return worst


@compiled
def rigid_energies(bodies: Bodies, state: State, work: Workspace) -> tuple[float, float]:
    """Kinetic energy of the rigid motion, with what of the elastic motion is linear in omega.

    And potential energy in gravity: 1/2 m v^2 + 1/2 omega . J omega + omega . Gamma, -m x . g.
    """
    kinetic, potential = 0.0, 0.0
    for b in range(len(bodies.mass)):
        velocity, omega = row(state.bodies.v, b), spin_of(state, b)
        kinetic += 0.5 * bodies.mass[b] * dot(velocity, velocity)
        kinetic += 0.5 * dot(omega, rotate(work.bodies.J, b, omega))
        kinetic += dot(omega, row(work.bodies.relative_momentum, b))
        potential -= bodies.mass[b] * dot(row(state.bodies.x, b), triple(bodies.gravity, 0))
    return kinetic, potential


@compiled
def momentum(bodies: Bodies, state: State, work: Workspace, linear: Array, angular: Array) -> None:
    """In space: sums of m v, and about the origin of x x m v + R (J omega + Gamma)."""
    linear[:] = 0.0
    angular[:] = 0.0
    for b in range(len(bodies.mass)):
        mv = scale(bodies.mass[b], row(state.bodies.v, b))
        spin = rotate(state.bodies.R, b, spin_momentum(b, state, work))
        # About a fixed point: the center of mass of the model may accelerate.
        about_origin = add(cross(row(state.bodies.x, b), mv), spin)
        for i in range(3):
            linear[i] += mv[i]
            angular[i] += about_origin[i]
