"""The state of a step as a row of the output."""

from ..arrays import Array
from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from .bodies import momentum, rigid_energies
from .couplings import spring_energy
from .frames import (
    move_frame_accelerations,
    move_frame_velocities,
    move_frames,
)
from .history import modal_energy
from .observers import observe
from .rotations import quaternion_exponential, quaternion_product
from .system import Run, State, System, Workspace


@entry
def record(run: Run, k: int) -> None:
    """Write the present state into row k of the output."""
    system, state, work, output = run.system, run.state, run.work, run.output
    frames, n_f = system.frames, len(system.frames.body)
    move_frames(frames, n_f, state, work)
    move_frame_velocities(frames, n_f, state, work)
    move_frame_accelerations(frames, n_f, state, work)
    copy(state.bodies.x, output.x[k])
    copy(state.bodies.quaternion, output.R[k])
    copy(state.bodies.v, output.v[k])
    copy(state.bodies.v_dot, output.v_dot[k])
    copy(work.frames.r, output.frame_position[k])
    copy(work.frames.V, output.frame_velocity[k])
    copy(work.frames.A, output.frame_acceleration[k])
    copy(work.frames.wrench, output.frame_force[k])
    for f in range(n_f):
        dof = frames.dof[f]
        n = 0 if dof < 0 else 3 + 3 * frames.rotations[f]
        for i in range(6):
            output.frame_u[k, f, i] = state.interfaces.u[dof + i] if i < n else 0.0
        _set_frame_rotation(system, f, n == 6, state, work, output.frame_rotation[k, f])
    copy(state.couplings.lam, output.multipliers[k])
    copy(work.couplings.coordinate, output.coordinates[k])
    copy(work.couplings.wrench, output.coupling_wrench[k])
    observe(system.observers, state, work, output.observed[k], output.observed_rates[k])
    _set_energies(system, state, work, output.energy[k])
    momentum(system.bodies, state, output.momentum[k])


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


@compiled
def _set_energies(system: System, state: State, work: Workspace, out: Array) -> None:
    """Those of `Output.energy`."""
    kinetic, potential = rigid_energies(system.bodies, state)
    out[0] = kinetic
    out[1] = state.energies.elastic[0]
    out[2] = spring_energy(system.couplings, work)
    out[3] = potential
    out[4] = state.energies.work[0]
    out[5] = state.energies.compliance[0]
    out[6] = modal_energy(system.elastic, state)
