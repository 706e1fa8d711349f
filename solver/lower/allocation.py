"""Allocation of the state of a system, with bodies in their starting poses, and of scratch."""

import numpy as np

from ..step.rotations import quaternion_of
from ..step.system import Output, State, Workspace
from .lower import LoweredModel
from .surface_sizes import sizes_of_kept


def allocate(lowered: LoweredModel) -> tuple[State, Workspace]:
    """A state with bodies and frames in their starting poses, all else at zero, and scratch."""
    state, work = State.allocate(lowered.sizes), Workspace.allocate(lowered.sizes)
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
    return {**lowered.sizes, **kept, **given}
