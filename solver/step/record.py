"""The state of a step as a row of the output."""

from ..arrays import Array
from ..compiler.marks import compiled, differentiable, entry
from ..compiler.memory import copy
from .bodies import momentum
from .contacts import beyond_dent
from .couplings import spring_energy
from .force_laws import permanent_of_row
from .frames import (
    move_frame_accelerations,
    move_frame_velocities,
    move_frames,
)
from .gaps import contact_motion
from .history import modal_energy
from .readings import record_readings
from .rotations import quaternion_exponential, quaternion_product
from .rows import GAP
from .second_order import record_second_order
from .surface_results import record_surfaces
from .system import Run, State, System, Workspace


@differentiable
@entry
def record(run: Run, k: int) -> None:
    """Write the present state into row k of the output."""
    system, state, work, output = run.system, run.state, run.work, run.output
    frames, n_f = system.frames, len(system.frames.body)
    move_frames(frames, n_f, state, work)
    move_frame_velocities(frames, n_f, state, work)
    move_frame_accelerations(frames, n_f, state, work)
    copy(state.bodies.x, output.body_position[k])
    copy(state.bodies.quaternion, output.body_rotation[k])
    _split(state.bodies.v, output.body_velocity[k], output.body_angular_velocity[k])
    _split(state.bodies.v_dot, output.body_acceleration[k], output.body_angular_acceleration[k])
    record_second_order(system.elastic, state, output.body_second_order_force[k])
    record_readings(system.sensors, state, output, k)
    for g in range(len(system.elastic.pattern_dof)):
        output.pattern_load[k, g] = state.interfaces.p[system.elastic.pattern_dof[g]]
        output.pattern_displacement[k, g] = state.interfaces.u[system.elastic.pattern_dof[g]]
    copy(work.frames.r, output.frame_position[k])
    _split(work.frames.V, output.frame_velocity[k], output.frame_angular_velocity[k])
    _split(work.frames.A, output.frame_acceleration[k], output.frame_angular_acceleration[k])
    _split(work.frames.wrench, output.frame_force[k], output.frame_moment[k])
    for f in range(n_f):
        dof = frames.dof[f]
        n = 0 if dof < 0 else 3 + 3 * frames.rotations[f]
        for i in range(3):
            u = state.interfaces.u[dof + i] if n > 0 else 0.0
            w = state.interfaces.u[dof + 3 + i] if n == 6 else 0.0
            output.frame_elastic_displacement[k, f, i] = u
            output.frame_elastic_rotation[k, f, i] = w
        _set_frame_rotation(system, f, n == 6, state, work, output.frame_rotation[k, f])
    copy(state.couplings.lam, output.multiplier[k])
    copy(work.couplings.coordinate, output.coordinate[k])
    for i in range(len(work.couplings.coordinate)):
        output.permanent[k, i] = permanent_of_row(
            system.couplings.laws, i, work.couplings.coordinate[i], state
        )
    _split(work.couplings.wrench, output.coupling_force[k], output.coupling_moment[k])
    copy(state.observers.value, output.joint_position[k])
    copy(state.observers.rate, output.joint_rate[k])
    for w in range(len(system.couplings.switching)):
        _record_switching(run, system.couplings.switching[w], k)
    record_surfaces(system, state, work, output, k)
    _record_motors(run, k)
    _record_energies(run, k)
    momentum(system.bodies, state, work, output.linear_momentum[k], output.angular_momentum[k])


@compiled
def _record_switching(run: Run, j: int, k: int) -> None:
    """The contact or the friction of coupling j."""
    couplings, lam, output = run.system.couplings, run.state.couplings.lam, run.output
    i, status = couplings.range[j], run.work.couplings.status[j]
    c, r = couplings.contact_of[j], couplings.friction_of[j]
    if r >= 0:
        row = couplings.friction.first[r]
        # On the second body as the user named it, whichever frame carries the row.
        output.friction_force[k, r] = lam[row] if couplings.second[row] == 6 else -lam[row]
        output.friction_state[k, r] = status
    if c < 0:
        return
    coordinate = run.work.couplings.coordinate[i]
    # The gap closes where the ball touches the ground of its dent.
    beyond, _ = beyond_dent(couplings, i, coordinate, run.state)
    # Not -beyond, which would write a negative zero.
    output.gap[k, c] = 0.0 - beyond
    output.dent[k, c] = permanent_of_row(couplings.laws, i, coordinate, run.state)
    output.normal_force[k, c] = lam[i]
    output.normal_impulse[k, c] = run.state.contacts.total_impulse[c]
    output.contact_state[k, c] = status
    for x in range(3):
        output.contact_force[k, c, x] = lam[i + x] if i + x < couplings.range[j + 1] else 0.0
    if couplings.rows.kind[i] == GAP:
        slip, n, point = contact_motion(couplings, j, run.work)
        for x in range(3):
            output.contact_normal[k, c, x] = n[x]
            output.contact_point[k, c, x] = point[x]
        for x in range(2):
            output.contact_slip[k, c, x] = slip[x] if status else 0.0


@compiled
def _record_motors(run: Run, k: int) -> None:
    state, work, output = run.state, run.work, run.output
    motors = run.system.couplings.laws.motors
    for m in range(len(motors.row)):
        i = motors.row[m]
        output.motor_torque[k, m] = state.couplings.lam[i]
        reference, error = 0.0, 0.0
        # Without a position gain the reference is unused, and an error would mean nothing.
        if motors.stiffness[m] > 0.0 or motors.integral[m] > 0.0:
            reference = work.motors.value[3 * m + 1]
            error = reference - work.couplings.coordinate[i]
        output.motor_reference[k, m] = reference
        output.motor_error[k, m] = error
        output.motor_power[k, m] = state.couplings.lam[i] * work.couplings.rate[i]
        output.motor_work[k, m] = state.motors.work[m]
        output.motor_state[k, m] = work.motors.status[m]


@compiled
def _record_energies(run: Run, k: int) -> None:
    system, energies, output = run.system, run.state.energies, run.output
    modal = modal_energy(system.elastic, run.state)
    output.kinetic_energy[k] = energies.kinetic[0]
    output.potential_energy[k] = energies.potential[0]
    output.elastic_energy[k] = modal + energies.convolved[0] + energies.residual[0]
    # What contacts do in closing and opening is, as that, an error of time stepping.
    output.modal_loss[k] = energies.modal[0] - modal - energies.switching[0]
    output.modal_damping[k] = energies.damping[0]
    output.external_work[k] = energies.work[0]
    springs, work = 0.0, 0.0
    for j in range(len(energies.compliance)):
        springs += spring_energy(system.couplings, j, run.state, run.work)
        work += energies.compliance[j]
    output.spring_energy[k] = springs
    # Friction of surfaces takes energy as that of contacts of balls does, which `work` has.
    output.compliance_work[k] = work - energies.friction[0]


@compiled
def _split(pairs: Array, linear: Array, angular: Array) -> None:
    """The two halves of rows (n, 6)."""
    for m in range(len(pairs)):
        for i in range(3):
            linear[m, i] = pairs[m, i]
            angular[m, i] = pairs[m, 3 + i]


@compiled
def _set_frame_rotation(
    system: System, f: int, small: bool, state: State, work: Workspace, out: Array
) -> None:
    """The quaternion of D = R exp(w~) D_0."""
    frames, scratch = system.frames, work.frames
    b, dof = frames.body[f], frames.dof[f]
    if b < 0:
        copy(frames.quaternion_0[f], out)
    elif small:
        quaternion_exponential(state.interfaces.u[dof + 3 : dof + 6], scratch.small_quaternion)
        turned = scratch.body_quaternion
        quaternion_product(state.bodies.quaternion[b], scratch.small_quaternion, turned)
        quaternion_product(turned, frames.quaternion_0[f], out)
    else:
        quaternion_product(state.bodies.quaternion[b], frames.quaternion_0[f], out)
