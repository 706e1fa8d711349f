"""The time loop: generalized-alpha on the rotation group (docs/theory.md, The time step), without
allocations.
"""

from ..arrays import Array
from .couplings import spring_energy
from .frames import frame_acceleration, move_frame_velocities, move_frames, spin_of, wrench
from .history import modal_energy, recall, remember, respond
from .jit import compiled
from .loads import load_vector
from .newton import accelerate, converge, renew
from .rotations import quaternion_exponential, quaternion_product, relative_rotation
from .rows import evaluate_row
from .system import Bodies, Inputs, Loads, Output, Rows, Scheme, State, System, Workspace
from .vectors import add, copy, cross, dot, rotate, row, scale, triple


@compiled
def advance(
    system: System,
    frame_quaternions: Array,
    inputs: Inputs,
    state: State,
    work: Workspace,
    output: Output,
) -> tuple[int, float]:
    """Take one step per row of the inputs; return how many were taken, fewer than asked where
    Newton failed, and the relative residual of the last.
    """
    scheme = system.scheme
    n, residual = len(inputs.load), 0.0
    for k in range(n + inputs.ahead):
        if not state.prepared[0]:
            prepare(system, state, work)
        if k == n:
            break
        state.prepared[0] = 0
        loads, drive, row = inputs.load[k], inputs.drive[k], inputs.row[k]
        iterations, residual, converged = converge(system, loads, drive, state, work)
        if not converged:
            return k, residual
        respond(system.elastic, scheme, work.history, state.p, state.u)
        remember(system.elastic, scheme, state, work.p_n, work.modal)
        _finish(scheme, state, work)
        account(system, loads, drive, state, work)
        state.step[0] += 1
        if row >= 0:
            output.iterations[row] = iterations
            output.residual[row] = residual
            record(system, frame_quaternions, row, state, work, output)
        else:
            _follow(system.observers, state, work)
    return n, residual


@compiled
def prepare(system: System, state: State, work: Workspace) -> None:
    """What a step can do before its inputs are known: remember its start, recall the past, predict.

    Where the number of corrections is given, factor their matrix too, at the end of the step
    before.
    """
    scheme = system.scheme
    if scheme.corrections > 0:
        work.renewed[0] = int(renew(system, state.load, state.drive, state, work))
    copy(state.quaternion, work.quaternion)
    copy(state.u, work.u_n)
    copy(state.p, work.p_n)
    copy(state.lam, work.lam_n)
    recall(system.elastic, scheme, state, work.history, work.modal)
    _predict(scheme, state, work)
    _predict_displacements(scheme, state, work)
    state.prepared[0] = 1


@compiled
def _predict(scheme: Scheme, state: State, work: Workspace) -> None:
    """Eqs (66)-(70), where a becomes a* for v_dot = 0; then what v_dot = v_dot_n adds. lambda
    begins as lambda_n.
    """
    h, beta, gamma = scheme.h, scheme.beta, scheme.gamma
    for b in range(len(state.x)):
        for i in range(6):
            a_n = state.a[b, i]
            a = (scheme.alpha_f * state.v_dot[b, i] - scheme.alpha_m * a_n) / (1.0 - scheme.alpha_m)
            change = h * state.v[b, i] + h * h * ((0.5 - beta) * a_n + beta * a)
            if i < 3:
                work.x_predicted[b, i] = state.x[b, i] + change
            else:
                work.psi_predicted[b, i - 3] = change
            work.v_predicted[b, i] = state.v[b, i] + h * ((1.0 - gamma) * a_n + gamma * a)
            state.a[b, i] = a
    accelerate(scheme, state, work)


@compiled
def _predict_displacements(scheme: Scheme, state: State, work: Workspace) -> None:
    """The same for interface displacements and rates."""
    h, beta, gamma = scheme.h, scheme.beta, scheme.gamma
    for k in range(len(state.u)):
        a_n = state.u_a[k]
        a = (scheme.alpha_f * state.u_acceleration[k] - scheme.alpha_m * a_n) / (
            1.0 - scheme.alpha_m
        )
        work.u_predicted[k] = (
            state.u[k] + h * state.u_rate[k] + h * h * ((0.5 - beta) * a_n + beta * a)
        )
        work.u_rate_predicted[k] = state.u_rate[k] + h * ((1.0 - gamma) * a_n + gamma * a)
        state.u_a[k] = a
        state.u[k] = work.u_predicted[k] + state.u_acceleration[k] / scheme.beta_prime


@compiled
def _finish(scheme: Scheme, state: State, work: Workspace) -> None:
    """a_{n+1} = a* + (1 - alpha_f) / (1 - alpha_m) v_dot_{n+1}, for bodies and interfaces."""
    ratio = (1.0 - scheme.alpha_f) / (1.0 - scheme.alpha_m)
    for b in range(len(state.a)):
        for i in range(6):
            state.a[b, i] += ratio * state.v_dot[b, i]
    for k in range(len(state.u)):
        change = state.u[k] - work.u_predicted[k]
        state.u_rate[k] = work.u_rate_predicted[k] + scheme.gamma_prime * change
        state.u_acceleration[k] = scheme.beta_prime * change
        state.u_a[k] += ratio * state.u_acceleration[k]


@compiled
def account(system: System, loads: Array, drive: Array, state: State, work: Workspace) -> None:
    """Add the work of the step: trapezoidal means of loads times displacements.

    Elastic energy: that of the interface loads p . du. Drives: -lambda dphi/ds ds. Springs and
    dampers: lambda dc.
    """
    elastic = system.elastic
    for i in range(len(elastic.active)):
        k = elastic.active[i]
        state.elastic_energy[0] += 0.5 * (state.p[k] + work.p_n[k]) * (state.u[k] - work.u_n[k])
    _account_loads(system.loads, loads, state, work)
    for i in range(len(state.lam)):
        if system.couplings.compliant[i]:
            turn = work.coordinate[i] - state.coordinate[i]
            state.compliance_work[0] += 0.5 * (state.lam[i] + work.lam_n[i]) * turn
        state.coordinate[i] = work.coordinate[i]
        d = system.couplings.drive[i]
        if d >= 0:
            force = -state.lam[i] * work.drive_slope[i]
            state.work[0] += 0.5 * (force + state.drive_force[d]) * (drive[d] - state.drive[d])
            state.drive_force[d] = force
            state.drive[d] = drive[d]


@compiled
def _account_loads(loads: Loads, values: Array, state: State, work: Workspace) -> None:
    turn = work.scratch_3
    for m in range(len(loads.frame)):
        f = loads.frame[m]
        vector = load_vector(loads, m, values[m], work)
        if loads.torque[m]:
            relative_rotation(work.load_axes[m], work.D[f], turn)
        else:
            for i in range(3):
                turn[i] = work.r[f, i] - work.load_position[m, i]
        copy(work.r[f], work.load_position[m])
        copy(work.D[f], work.load_axes[m])
        state.load[m] = values[m]
        for i in range(3):
            state.work[0] += 0.5 * (vector[i] + state.load_vector[m, i]) * turn[i]
            state.load_vector[m, i] = vector[i]


@compiled
def record(
    system: System, frame_quaternions: Array, k: int, state: State, work: Workspace, output: Output
) -> None:
    """Write the present state into row k of the output."""
    frames = system.frames
    move_frames(frames, len(frames.body), state, work)
    move_frame_velocities(frames, len(frames.body), state, work)
    copy(state.x, output.x[k])
    copy(state.quaternion, output.R[k])
    copy(state.v, output.v[k])
    copy(state.v_dot, output.v_dot[k])
    copy(work.r, output.frame_position[k])
    for f in range(len(frames.body)):
        dof = frames.dof[f]
        n = 0 if dof < 0 else 3 + 3 * frames.rotations[f]
        for i in range(6):
            output.frame_u[k, f, i] = state.u[dof + i] if i < n else 0.0
        force, moment = wrench(work, f)
        for i in range(3):
            output.frame_force[k, f, i] = force[i]
            output.frame_force[k, f, 3 + i] = moment[i]
        if frames.body[f] >= 0:
            linear, angular = frame_acceleration(frames, f, state, work)
            for i in range(3):
                output.frame_acceleration[k, f, i] = linear[i]
                output.frame_acceleration[k, f, 3 + i] = angular[i]
        _frame_rotation(
            system, frame_quaternions, f, n == 6, state, work, output.frame_rotation[k, f]
        )
    copy(work.V, output.frame_velocity[k])
    copy(state.lam, output.multipliers[k])
    copy(work.coordinate, output.coordinates[k])
    copy(work.coupling_wrench, output.coupling_wrench[k])
    _observe(system.observers, state, work, output.observed[k], output.observed_rates[k])
    _energies(system, state, work, output.energy[k])
    _momentum(system.bodies, state, output.momentum[k])


@compiled
def _frame_rotation(
    system: System,
    frame_quaternions: Array,
    f: int,
    small: bool,
    state: State,
    work: Workspace,
    out: Array,
) -> None:
    """The quaternion of D = R exp(skew(w)) D_0."""
    b, dof = system.frames.body[f], system.frames.dof[f]
    if b < 0:
        copy(frame_quaternions[f], out)
    elif small:
        quaternion_exponential(state.u[dof + 3 : dof + 6], work.scratch_4)
        quaternion_product(state.quaternion[b], work.scratch_4, work.scratch_4b)
        quaternion_product(work.scratch_4b, frame_quaternions[f], out)
    else:
        quaternion_product(state.quaternion[b], frame_quaternions[f], out)


@compiled
def _observe(observers: Rows, state: State, work: Workspace, values: Array, rates: Array) -> None:
    """Joint coordinates and their rates; angles go on over full turns."""
    gradient = work.scratch_12
    for i in range(len(observers.kind)):
        A, B = observers.frame_a[i], observers.frame_b[i]
        values[i] = evaluate_row(observers, i, 0.0, state.observed[i], work, gradient)
        state.observed[i] = values[i]
        rates[i] = 0.0
        for k in range(6):
            rates[i] += gradient[k] * work.V[A, k] + gradient[6 + k] * work.V[B, k]


@compiled
def _follow(observers: Rows, state: State, work: Workspace) -> None:
    """Joint coordinates of a step that is not recorded, which tell the turns of the next."""
    for i in range(len(observers.kind)):
        state.observed[i] = evaluate_row(
            observers, i, 0.0, state.observed[i], work, work.scratch_12
        )


@compiled
def _energies(system: System, state: State, work: Workspace, out: Array) -> None:
    """Kinetic energy of the rigid motion, elastic energy (vibration included), springs, gravity,
    work; see Output.
    """
    bodies = system.bodies
    kinetic, potential = 0.0, 0.0
    for b in range(len(bodies.mass)):
        velocity, omega = row(state.v, b), spin_of(state, b)
        kinetic += 0.5 * bodies.mass[b] * dot(velocity, velocity)
        kinetic += 0.5 * dot(omega, rotate(bodies.J_rot, b, omega))
        potential -= bodies.mass[b] * dot(row(state.x, b), triple(bodies.gravity, 0))
    out[0] = kinetic
    out[1] = state.elastic_energy[0]
    out[2] = spring_energy(system.couplings, work)
    out[3] = potential
    out[4] = state.work[0]
    out[5] = state.compliance_work[0]
    out[6] = modal_energy(system.elastic, state)


@compiled
def _momentum(bodies: Bodies, state: State, out: Array) -> None:
    """Linear momentum, and angular momentum about the origin, in space: sums of m v and of x x m v
    + R J omega.
    """
    out[:] = 0.0
    for b in range(len(bodies.mass)):
        linear = scale(bodies.mass[b], row(state.v, b))
        own = rotate(state.R, b, rotate(bodies.J_rot, b, spin_of(state, b)))
        angular = add(cross(row(state.x, b), linear), own)
        for i in range(3):
            out[i] += linear[i]
            out[3 + i] += angular[i]
