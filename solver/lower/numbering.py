"""Numbers of the frames of a model, those that carry couplings or loads first, and their dofs."""

from dataclasses import dataclass

import numpy as np

from ..arrays import starts
from ..couplings.coupling import GROUND, Coupling, side_names
from ..couplings.rows import Pose, Sides
from ..couplings.surface_contacts import SurfaceContact
from ..model.bodies import FlexibleBody
from ..model.model import Model
from ..step.records.frames import Frames
from ..step.rotations import quaternion_of
from .placement import frame_pose


@dataclass(frozen=True, eq=False)
class NumberedFrames:
    """All frames by name in the order of their numbers: poses at the start, numbers, arrays."""

    poses: dict[str, Pose]
    numbers: dict[str, int]
    arrays: Frames

    def number(self, name: str) -> int:
        return self.numbers[name]

    def sides(self, coupling: Coupling) -> Sides:
        first, second = side_names(coupling)
        fixed = self.arrays.body[self.number(first)] < 0
        return Sides(
            self.number(first),
            self.number(second),
            self.poses[first],
            self.poses[second],
            bool(fixed),
        )


def number_frames(model: Model, poses: dict[str, Pose]) -> NumberedFrames:
    """Number the frames of a model whose bodies start in the given poses."""
    named: dict[str, Pose] = {}
    for coupling in model.couplings:
        first, second = coupling.between
        for name, side, other in zip(
            side_names(coupling), (first, second), (second, first), strict=True
        ):
            # The bare ground has a frame of its own for each coupling, where the other side starts.
            named[name] = frame_pose(model, poses, other if side == GROUND else side)
    for contact in model.surface_contacts:
        if contact.meets_surface:
            continue
        named[carrier_name(contact)] = _carrier_pose(model, poses, contact)
    for load in model.frame_loads:
        named[load.on] = frame_pose(model, poses, load.on)
    # Frames with couplings and loads come first: the loop over forces ends there.
    n_acting = len(named)
    for body in model.bodies:
        for frame in model.frames_of(body):
            named.setdefault(f"{body}.{frame}", frame_pose(model, poses, f"{body}.{frame}"))
    numbers = {name: f for f, name in enumerate(named)}
    return NumberedFrames(named, numbers, _arrays(model, list(named), n_acting))


def carrier_name(contact: SurfaceContact) -> str:
    """The frame of the shape; the bare ground has one at the origin of space for each contact."""
    carrier = contact.carrier
    return f"{GROUND}.({contact.name})" if carrier == GROUND else carrier


def _carrier_pose(model: Model, poses: dict[str, Pose], contact: SurfaceContact) -> Pose:
    if contact.carrier == GROUND:
        return Pose(np.zeros(3), np.eye(3))
    return frame_pose(model, poses, contact.carrier)


def _arrays(model: Model, frame_names: list[str], n_acting: int) -> Frames:
    body_numbers = {name: b for b, name in enumerate(model.bodies)}
    first_dof = _first_dofs(model)
    n = len(frame_names)
    frames = Frames(
        n_acting=n_acting,
        body=np.full(n, -1, dtype=np.int64),
        X=np.zeros((n, 3)),
        D_0=np.tile(np.eye(3), (n, 1, 1)),
        quaternion_0=np.zeros((n, 4)),
        dof=np.full(n, -1, dtype=np.int64),
        active=np.full(n, -1, dtype=np.int64),
        column=np.full(n, -1, dtype=np.int64),
        rotations=np.zeros(n, dtype=np.int64),
    )
    n_active = 0
    # Columns 0 to 5 of a body's block are its rigid coordinates.
    n_columns = np.full(len(body_numbers), 6)
    # Active dofs are numbered body by body, so that the bodies' ranges are contiguous.
    by_dof = sorted(range(n), key=lambda f: first_dof.get(frame_names[f], -1))
    for f in by_dof:
        owner, _, name = frame_names[f].partition(".")
        if owner == GROUND:
            continue
        frames.body[f] = body_numbers[owner]
        body = model.bodies[owner]
        if name:
            frames.X[f] = body.frames[name].position
            frames.D_0[f] = Pose(np.zeros(3), np.eye(3)).carry(body.frames[name]).R
        if isinstance(body, FlexibleBody):
            interface = body.superelement.interface(name)
            frames.dof[f] = first_dof[frame_names[f]]
            frames.rotations[f] = interface.rotations
            if f < frames.n_acting:
                frames.active[f] = n_active
                n_active += interface.n_dofs
                frames.column[f] = n_columns[frames.body[f]]
                n_columns[frames.body[f]] += interface.n_dofs
    _skip_inner_dofs(model, frames)
    frames.quaternion_0[:] = np.reshape([quaternion_of(D) for D in frames.D_0], (n, 4))
    return frames


def _skip_inner_dofs(model: Model, frames: Frames) -> None:
    """Dofs of inertia and of q, which are always active, stand behind the interfaces."""
    inner = {name: body.n_inner for name, body in model.flexible_bodies.items()}
    numbers = [inner.get(name, 0) for name in model.bodies]
    before = starts(numbers)
    loaded = frames.active >= 0
    frames.active[loaded] += before[frames.body[loaded]]


def _first_dofs(model: Model) -> dict[str, int]:
    first: dict[str, int] = {}
    n = 0
    for name, body in model.flexible_bodies.items():
        for interface in body.superelement.interfaces:
            first[f"{name}.{interface.name}"] = n
            n += interface.n_dofs
        n += body.n_dofs - body.superelement.n_c
    return first
