"""Newton's method on the equations of a time step, with their exact tangent.

Unknowns: delta X = R^T delta x and delta Theta of every body (dr), the displacements u of the
active interface dofs, and lambda. K_ab: derivatives of the generalized forces, r rigid, a active;
B: of the rows' coordinates; A: of their residuals, A = B for a constraint, and lambda + stiffness c
+ ... = 0 for a spring, times h^2, whose Z is 1.

    [ h^2 (S_rr - K_rr)   -h^2 K_ra        -B_r^T            ] [ dr       ]     [ h^2 r_eq ]
    [ -w G_0 K_ar          I - w G_0 K_aa  -w G_0 B_a^T / h^2 ] [ du       ] = - [ -r_u     ]
    [ A_r                  A_a              Z                ] [ h^2 dlam ]     [ phi      ]

S_rr: inertia, with delta Theta = T(psi) delta psi. All blocks are of order one. In body axes
nothing of a mechanism that turns as a whole changes, so the factors of one matrix serve many steps:
they are made anew when a correction is larger than `scheme.reuse` times the one before. Source:
docs/theory.md, The time step; u exactly.
"""

import math

from ..arrays import Array
from .couplings import add_couplings, place_rows
from .elimination import factorise, substitute
from .equations import evaluate, model_size, relative_residual
from .frames import add_frame_tangents, map_frame_velocities
from .jit import compiled, compiled_apart
from .loads import add_loads
from .rotations import (
    normalise,
    quaternion_exponential,
    quaternion_matrix,
    quaternion_product,
    tangent_inverse,
)
from .system import Scheme, State, System, Workspace
from .vectors import UNITS, copy, cross, multiply, rotate, rotate_back, row

PRECISION = 1e-15
"""the last correction, relative to the size of the model, of a state as near to the solution as
rounding allows
"""
STALLED = 0.5
"""ratio of successive corrections from which on others bring nothing"""
LOST = 1.0
"""relative residual with which a given number of corrections has led nowhere"""


@compiled
def converge(
    system: System, loads: Array, drive: Array, state: State, work: Workspace
) -> tuple[int, float, bool]:
    """Newton's method from the predicted state: iterations, relative residual, and whether it
    converged.

    Errors of old factors do not square, so it goes on below the tolerance until the corrections
    come to rest. Where old factors, or the accelerations that the step began with, lead nowhere, it
    starts once more from zero accelerations and makes every matrix anew. After
    `scheme.corrections`, where given, it takes what it has.
    """
    scheme = system.scheme
    reuse = scheme.reuse
    size = model_size(system, state, work)
    change = previous = math.inf
    total = iterations = 0
    while True:
        evaluate(system, loads, drive, state, work)
        residual = relative_residual(system, size, iterations > 1, state, work)
        if iterations == scheme.corrections and iterations > 0:
            return total, residual, residual < LOST
        fast = change <= max(reuse * previous, PRECISION * size)
        settled = change <= PRECISION * size or change > STALLED * previous
        if (
            residual <= scheme.tolerance
            and iterations > 0
            and (settled or iterations == scheme.max_iterations)
        ):
            work.renewed[0] = int(fast)
            return total, residual, True
        solvable = iterations < scheme.max_iterations
        if solvable and not (work.renewed[0] and fast):
            solvable = renew(system, loads, drive, state, work)
            work.renewed[0] = int(solvable)
            work.renewed[1] += 1
        if solvable:
            previous, change = change, correct(system, size, state, work)
            iterations += 1
            total += 1
        elif reuse > 0.0:
            reuse, iterations = 0.0, 0
            change = previous = math.inf
            restart(scheme, state, work)
        else:
            return total, residual, False


@compiled_apart
def renew(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> bool:
    """The factors of the iteration matrix at the present state, which `evaluate` has seen last.
    False if singular.
    """
    linearise(system, loads, drive, state, work)
    assemble(system, state, work)
    return factorise(system.pattern, work.S, work.pivots)


@compiled
def correct(system: System, size: float, state: State, work: Workspace) -> float:
    """Solve for the corrections with the factors at hand and apply them; how far the largest moves
    a body.
    """
    set_right_hand_side(system, state, work)
    substitute(system.pattern, work.S, work.pivots, work.rhs)
    apply_correction(system, state, work)
    largest = 0.0
    for b in range(len(system.bodies.mass)):
        first = system.pattern.first[system.pattern.body[b]]
        for i in range(3):
            largest = max(largest, abs(work.rhs[first + i]), size * abs(work.rhs[first + 3 + i]))
    return largest


@compiled
def linearise(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> None:
    """B and A at the present state, and K, alone in the blocks of the matrix."""
    if system.couplings.n_compliant:
        map_frame_velocities(system.frames, system.scheme.gamma_prime, work.psi, state, work)
    work.S[:] = 0.0
    add_frame_tangents(system.frames, system.pattern, state, work)
    add_couplings(system, drive, state, work)
    add_loads(system, loads, state, work)


@compiled
def assemble(system: System, state: State, work: Workspace) -> None:
    """The iteration matrix from K, B and A."""
    place_rows(system, work)
    _weigh_forces(system, work)
    _add_inertia(system, state, work)


@compiled
def _weigh_forces(system: System, work: Workspace) -> None:
    """[K, B^T / h^2] times -h^2 in the rows of rigid coordinates, -w G_0 in those of active dofs."""
    elastic, pattern, S, forces = system.elastic, system.pattern, work.S, work.forces
    h2 = system.scheme.h * system.scheme.h
    for m in range(len(pattern.force_block)):
        b, start = pattern.force_block[m, 0], pattern.force_block[m, 1]
        stride, width = pattern.force_block[m, 2], pattern.force_block[m, 3]
        for i in range(6):
            for j in range(width):
                S[start + i * stride + j] *= -h2
        e = elastic.of_body[b]
        if e < 0:
            continue
        n = elastic.active_range[e + 1] - elastic.active_range[e]
        for i in range(n):
            own = start + (6 + i) * stride
            for j in range(width):
                forces[i * width + j] = S[own + j]
                S[own + j] = 0.0
        for i in range(n):
            own = start + (6 + i) * stride
            for k in range(n):
                G = elastic.G_active[elastic.G_active_start[e] + i * n + k]
                if G != 0.0:
                    for j in range(width):
                        S[own + j] -= G * forces[k * width + j]


@compiled
def _add_inertia(system: System, state: State, work: Workspace) -> None:
    """h^2 S_rr, with beta' m I on X and (beta' J + gamma' (skew(w) J - skew(J w))) T^-1(psi) on
    Theta; I on u.
    """
    bodies, scheme, pattern = system.bodies, system.scheme, system.pattern
    h2 = scheme.h * scheme.h
    S, D, T = work.S, work.frame_tangent, work.scratch_33
    for b in range(len(bodies.mass)):
        start, stride = pattern.body_block[b, 0], pattern.body_block[b, 1]
        J = bodies.J_rot[b]
        omega = (state.v[b, 3], state.v[b, 4], state.v[b, 5])
        momentum = rotate(bodies.J_rot, b, omega)
        for j in range(3):
            S[start + j * (stride + 1)] += h2 * scheme.beta_prime * bodies.mass[b]
            spin = cross(omega, (J[0, j], J[1, j], J[2, j]))
            turned = cross(momentum, UNITS[j])
            for i in range(3):
                D[i, j] = scheme.beta_prime * J[i, j] + scheme.gamma_prime * (spin[i] - turned[i])
        tangent_inverse(work.psi[b], T)
        for i in range(3):
            for j in range(3):
                total = D[i, 0] * T[0, j] + D[i, 1] * T[1, j] + D[i, 2] * T[2, j]
                S[start + (3 + i) * stride + 3 + j] += h2 * total
        for i in range(6, pattern.size[pattern.body[b]]):
            S[start + i * (stride + 1)] += 1.0


@compiled
def set_right_hand_side(system: System, state: State, work: Workspace) -> None:
    """`work.rhs` from the residuals that `evaluate` found."""
    pattern, couplings, rhs = system.pattern, system.couplings, work.rhs
    h2 = system.scheme.h * system.scheme.h
    for b in range(len(system.bodies.mass)):
        first = pattern.first[pattern.body[b]]
        force = rotate_back(state.R, b, row(work.residual, b))
        for i in range(3):
            rhs[first + i] = -h2 * force[i]
            rhs[first + 3 + i] = -h2 * work.residual[b, 3 + i]
        e = system.elastic.of_body[b]
        if e >= 0:
            for i in range(system.elastic.active_range[e], system.elastic.active_range[e + 1]):
                rhs[first + 6 + i - system.elastic.active_range[e]] = work.u_residual[i]
    for j in range(len(pattern.coupling)):
        for i in range(couplings.range[j], couplings.range[j + 1]):
            z = pattern.first[pattern.coupling[j]] + i - couplings.range[j]
            rhs[z] = -h2 * work.phi[i] if couplings.compliant[i] else -work.phi[i]


@compiled
def apply_correction(system: System, state: State, work: Workspace) -> None:
    """Add the corrections in `work.rhs` to u, lambda and the motion of the bodies."""
    pattern, couplings, elastic = system.pattern, system.couplings, system.elastic
    h2 = system.scheme.h * system.scheme.h
    for b in range(len(system.bodies.mass)):
        first = pattern.first[pattern.body[b]]
        e = elastic.of_body[b]
        if e >= 0:
            for i in range(elastic.active_range[e], elastic.active_range[e + 1]):
                state.u[elastic.active[i]] += work.rhs[first + 6 + i - elastic.active_range[e]]
        _move_body(b, first, system.scheme, state, work)
    for j in range(len(pattern.coupling)):
        for i in range(couplings.range[j], couplings.range[j + 1]):
            state.lam[i] += (
                work.rhs[pattern.first[pattern.coupling[j]] + i - couplings.range[j]] / h2
            )


@compiled
def _move_body(b: int, first: int, scheme: Scheme, state: State, work: Workspace) -> None:
    """Apply the corrections of body b to position, rotation, velocity and acceleration, eqs
    (72)-(74).
    """
    T, rhs = work.scratch_33, work.rhs
    tangent_inverse(work.psi[b], T)
    dx = rotate(state.R, b, (rhs[first], rhs[first + 1], rhs[first + 2]))
    dpsi = multiply(T, (rhs[first + 3], rhs[first + 4], rhs[first + 5]))
    for i in range(3):
        state.x[b, i] += dx[i]
        state.v[b, i] += scheme.gamma_prime * dx[i]
        state.v_dot[b, i] += scheme.beta_prime * dx[i]
        work.psi[b, i] += dpsi[i]
        state.v[b, 3 + i] += scheme.gamma_prime * dpsi[i]
        state.v_dot[b, 3 + i] += scheme.beta_prime * dpsi[i]
    set_rotation(b, state, work)


@compiled
def accelerate(scheme: Scheme, state: State, work: Workspace) -> None:
    """Positions and velocities that belong to the accelerations at hand, from those predicted for
    none.
    """
    slope = scheme.gamma_prime / scheme.beta_prime
    for b in range(len(state.x)):
        for i in range(6):
            state.v[b, i] = work.v_predicted[b, i] + slope * state.v_dot[b, i]
        for i in range(3):
            state.x[b, i] = work.x_predicted[b, i] + state.v_dot[b, i] / scheme.beta_prime
            work.psi[b, i] = work.psi_predicted[b, i] + state.v_dot[b, 3 + i] / scheme.beta_prime
        set_rotation(b, state, work)


@compiled
def restart(scheme: Scheme, state: State, work: Workspace) -> None:
    """Back to the safest guess: no accelerations, displacements and multipliers of the start of the
    step.
    """
    for b in range(len(state.x)):
        for i in range(6):
            state.v_dot[b, i] = 0.0
    accelerate(scheme, state, work)
    copy(work.u_n, state.u)
    copy(work.lam_n, state.lam)


@compiled
def set_rotation(b: int, state: State, work: Workspace) -> None:
    """R = R_n exp(skew(psi)), from the quaternion at the start of the step."""
    increment, product = work.scratch_4, state.quaternion[b]
    quaternion_exponential(work.psi[b], increment)
    quaternion_product(work.quaternion[b], increment, product)
    normalise(product)
    quaternion_matrix(product, state.R[b])
