"""Allocation of the state of a system, with bodies in their starting poses, and of scratch."""

import numpy as np

from ..history.dyadic import Window
from ..step.rotations import quaternion_of
from ..step.system import Output, State, System, Workspace
from .lower import LoweredModel
from .surface_sizes import sizes_of_kept, sizes_of_surfaces

# contacts that can end before the time loop hands them over, and one more of each
EVENT_CAPACITY = 256


def sizes_of(system: System, n_steps: int) -> dict[str, int]:
    """The dimensions of `State`, `Workspace` and `Output` by name (step/system.py)."""
    pattern, elastic = system.pattern, system.elastic
    # Rows of a body's block below its six rigid ones are those of its active dofs.
    owner = pattern.body[pattern.force_block[:, 0]]
    n_touching = len(system.couplings.contact) + len(system.surfaces.contacts.patch)
    force_rows = pattern.force_block[:, 3] * (pattern.size[owner] - 6)
    return {
        "n_b": len(system.bodies.mass),
        "n_f": len(system.frames.body),
        "n_j": len(system.couplings.range) - 1,
        "n_i": len(system.couplings.rows.kind),
        "n_terms": len(system.couplings.terms.row),
        "n_o": len(system.observers.kind),
        "n_h": int(system.couplings.laws.memory[-1]),
        "n_k": len(system.couplings.contact),
        "n_r": len(system.couplings.friction.first),
        "n_motors": len(system.couplings.laws.motors.row),
        "n_motor_signals": 3 * len(system.couplings.laws.motors.row),
        "n_touching": n_touching,
        "n_v": EVENT_CAPACITY + n_touching if n_touching else 0,
        "n_l": len(system.loads.frame),
        "n_t": len(system.patterns.body),
        "n_y": len(system.loads.frame) + len(system.patterns.body),
        "n_z": len(system.sensors.dof),
        "n_g": len(elastic.pattern_dof),
        "n_d": len(system.couplings.driven),
        "n_e": len(elastic.body),
        "n_axial": len(elastic.axial.body),
        "n_free": len(system.bodies.free),
        "n_u": int(elastic.dof[-1]),
        "n_a": len(elastic.active),
        "n_m": len(elastic.modes.stiffness),
        "n_x": len(elastic.modes.chains.amplitude),
        "n_s": int(elastic.second.r.sum()),
        "n_3q": 3 * int(elastic.second.r.max(initial=0)),
        "n_slopes": int(elastic.second.row[-1]),
        "n_p": Window(elastic).capacity(n_steps) if elastic.kernels.lags.any() else 0,
        "n_numbers": pattern.n_numbers,
        "n_unknowns": int(pattern.first[-1]),
        "n_force_rows": int(force_rows.max()),
        **sizes_of_surfaces(system.surfaces),
    }


def allocate(lowered: LoweredModel) -> tuple[State, Workspace]:
    """A state with bodies and frames in their starting poses, all else at zero, and scratch."""
    sizes = sizes_of(lowered.system, lowered.n_steps)
    state, work = State.allocate(sizes), Workspace.allocate(sizes)
    motion, frames = state.bodies, work.frames
    starts = [body.start for body in lowered.model.bodies.values()]
    motion.x[:] = [pose.x for pose in lowered.poses]
    motion.R[:] = [pose.R for pose in lowered.poses]
    motion.quaternion[:] = [quaternion_of(pose.R) for pose in lowered.poses]
    motion.v[:] = [[*start.velocity, *start.angular_velocity] for start in starts]
    work.bodies.quaternion_n[:] = motion.quaternion
    for f, pose in enumerate(lowered.frame_poses):
        frames.r[f], frames.D[f] = pose.x, pose.R
    # Without this, frames that only observe would have no axes before the first step.
    frames.T[:] = np.eye(3)
    work.bodies.J[:] = lowered.system.bodies.J_rot
    # Loads of the convolution count from step 1; that at t = 0 is kept apart.
    state.past.since[:] = 1
    work.couplings.near[:] = lowered.starts
    work.terms.near[:] = lowered.term_starts
    state.couplings.memory[:] = lowered.memories
    # Laws that relax have had for ever to do so before the start.
    work.couplings.elapsed[:] = np.inf
    state.observers.value[:] = lowered.observer_starts
    work.surfaces.looks[:] = -1
    state.surfaces.gap[:] = np.nan
    work.surfaces.listed[:] = -1
    return state, work


def make_output(lowered: LoweredModel, n: int) -> Output:
    """Arrays for n rows of output."""
    return Output.allocate(_sizes_of_output(lowered) | {"n": n})


def row_width(lowered: LoweredModel) -> int:
    """The numbers in a row of output."""
    return Output.n_elements(_sizes_of_output(lowered) | {"n": 1})


def _sizes_of_output(lowered: LoweredModel) -> dict[str, int]:
    kept = sizes_of_kept(lowered.system.surfaces, lowered.model.settings.output)
    given = {"n_fmu_inputs": sum(len(fmu.outputs) for fmu in lowered.model.fmus)}
    return {**sizes_of(lowered.system, lowered.n_steps), **kept, **given}
