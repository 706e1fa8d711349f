"""The equations of a time step and how far a state is from satisfying them.

    r_eq = J v_dot + v~ J v - f_r = 0       equilibrium of every body; f_r: loads, joints, gravity
    phi(x, R, u, lambda, t) = 0             constraints and force laws
    r_u  = history + w G_0 p - u = 0        displacements of the active interface dofs; w: 1, or 1/2 in eq. (55)

Source: docs/theory.md, Impulse responses and The time step.
"""

import math

from ..arrays import Array
from .couplings import evaluate_couplings, table
from .frames import load_bodies, move_frame_velocities, move_frames
from .jit import compiled
from .loads import evaluate_loads
from .rows import measures_length
from .system import Bodies, Couplings, Elastic, Scheme, State, System, Workspace
from .vectors import cross, rotate

ROUNDING = 64 * 2.2e-16


@compiled
def evaluate(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> None:
    """Wrenches, generalized forces and residuals of the present state."""
    frames = system.frames
    _follow_displacements(system.elastic, system.scheme, state, work)
    move_frames(frames, frames.n_acting, state, work)
    move_frame_velocities(frames, frames.n_acting, state, work)
    work.wrench[:] = 0.0
    evaluate_loads(system.loads, loads, work)
    evaluate_couplings(system.couplings, state.lam, state.coordinate, drive, work)
    load_bodies(frames, state, work)
    _equilibrium(system.bodies, state, work)
    _compatibility(system.elastic, state, work)


@compiled
def model_size(system: System, state: State, work: Workspace) -> float:
    """The largest coordinate of a body or lever of a frame: what positions are rounded against."""
    size = 0.0
    for b in range(len(state.x)):
        for i in range(3):
            size = max(size, abs(state.x[b, i]))
    for f in range(system.frames.n_acting):
        for i in range(3):
            size = max(size, abs(work.lever[f, i]))
    return size


@compiled
def relative_residual(
    system: System, size: float, converged: bool, state: State, work: Workspace
) -> float:
    """The largest residual over what the tolerance is measured against; 0 at the rounding of its
    terms.

    Equilibrium against the sum of the magnitudes of its terms; constraints and interface
    displacements against the largest motion of the step (translations in m, rotations in rad). The
    rounding of positions, seen through beta', becomes one of forces; it counts only once Newton has
    `converged` as far as it can, lest it hide a true residual.
    """
    bodies, scheme = system.bodies, system.scheme
    tolerance = scheme.tolerance
    n_b = len(bodies.mass)
    length, angle, worst = 0.0, 0.0, 0.0
    for b in range(n_b):
        for i in range(3):
            length = max(
                length, abs(scheme.h * state.v[b, i]) + abs(scheme.h * scheme.h * state.v_dot[b, i])
            )
            angle = max(
                angle, abs(work.psi[b, i]) + abs(scheme.h * scheme.h * state.v_dot[b, 3 + i])
            )
    length += angle * size
    for b in range(n_b):
        rounding = ROUNDING * scheme.beta_prime if converged else 0.0
        force_floor = ROUNDING * work.force_scale[b, 0] + rounding * bodies.mass[b] * size
        moment_floor = ROUNDING * (work.force_scale[b, 1] + size * work.force_scale[b, 0])
        for i in range(3):
            moment_floor += rounding * bodies.J_rot[b, i, i]
        for i in range(3):
            worst = max(
                worst,
                _relative(work.residual[b, i], work.force_scale[b, 0], force_floor, tolerance),
            )
            worst = max(
                worst,
                _relative(work.residual[b, 3 + i], work.force_scale[b, 1], moment_floor, tolerance),
            )
    couplings = system.couplings
    for j in range(len(couplings.range) - 1):
        for i in range(couplings.range[j], couplings.range[j + 1]):
            if couplings.compliant[i]:
                floor = ROUNDING * work.law_scale[i]
                if converged:
                    floor += law_rounding(
                        couplings, i, couplings.range[j], scheme.gamma_prime, size, work
                    )
                worst = max(worst, _relative(work.phi[i], work.law_scale[i], floor, tolerance))
            elif measures_length(couplings.rows.kind[i]):
                worst = max(worst, _relative(work.phi[i], length, ROUNDING * size, tolerance))
            else:
                worst = max(worst, _relative(work.phi[i], angle, ROUNDING, tolerance))
    for i in range(len(work.u_residual)):
        worst = max(
            worst, _relative(work.u_residual[i], length + angle, ROUNDING * size, tolerance)
        )
    return worst


@compiled
def law_rounding(
    couplings: Couplings, i: int, first: int, gamma_prime: float, size: float, work: Workspace
) -> float:
    """What the rounding of positions does to the force law of row i of a spring whose rows begin at
    `first`.
    """
    _, slope, _ = table(couplings, i, work.coordinate[i])
    total = abs(slope) * (size if measures_length(couplings.rows.kind[i]) else 1.0)
    for j in range(first, min(first + 6, len(couplings.rows.kind))):
        steep = abs(couplings.stiffness[i, j - first]) + gamma_prime * abs(
            couplings.damping[i, j - first]
        )
        total += steep * (size if measures_length(couplings.rows.kind[j]) else 1.0)
    return ROUNDING * total


@compiled
def _relative(residual: float, scale: float, floor: float, tolerance: float) -> float:
    """|residual| / scale, 0 up to the floor that rounding sets, infinite for what is no number."""
    if not abs(residual) < math.inf:
        return math.inf
    return abs(residual) / max(scale, floor / tolerance) if abs(residual) > floor else 0.0


@compiled
def _follow_displacements(elastic: Elastic, scheme: Scheme, state: State, work: Workspace) -> None:
    """Interface rates follow displacements by Newmark's formulas, as those of the bodies do."""
    for i in range(len(elastic.active)):
        k = elastic.active[i]
        state.u_rate[k] = work.u_rate_predicted[k] + scheme.gamma_prime * (
            state.u[k] - work.u_predicted[k]
        )


@compiled
def _equilibrium(bodies: Bodies, state: State, work: Workspace) -> None:
    """residual = J v_dot + v~ J v - f_r, with gravity in f_r."""
    for b in range(len(bodies.mass)):
        mass = bodies.mass[b]
        omega = (state.v[b, 3], state.v[b, 4], state.v[b, 5])
        momentum = rotate(bodies.J_rot, b, omega)
        gyroscopic = cross(omega, momentum)
        inertia = rotate(bodies.J_rot, b, (state.v_dot[b, 3], state.v_dot[b, 4], state.v_dot[b, 5]))
        for i in range(3):
            weight = mass * bodies.gravity[i]
            work.residual[b, i] = mass * state.v_dot[b, i] - weight - work.force[b, i]
            work.residual[b, 3 + i] = inertia[i] + gyroscopic[i] - work.force[b, 3 + i]
            work.force_scale[b, 0] += abs(mass * state.v_dot[b, i]) + abs(weight)
            work.force_scale[b, 1] += abs(inertia[i]) + abs(gyroscopic[i])


@compiled
def _compatibility(elastic: Elastic, state: State, work: Workspace) -> None:
    """u_residual = history + w G_0 p - u at the active dofs."""
    for e in range(len(elastic.body)):
        begin, end = elastic.active_range[e], elastic.active_range[e + 1]
        entry = elastic.G_active_start[e]
        for i in range(begin, end):
            total = work.history[elastic.active[i]] - state.u[elastic.active[i]]
            for j in range(begin, end):
                total += elastic.G_active[entry] * state.p[elastic.active[j]]
                entry += 1
            work.u_residual[i] = total
