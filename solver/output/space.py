"""The bodies of a model in space, as results keep them: outlines and connections."""

from collections.abc import Iterable

import numpy as np

from ...results.space import Connection, Space
from ...superelement import Outline
from ..arrays import Array
from ..couplings.coupling import GROUND, Coupling, side_names
from ..lower.lower import LoweredModel
from ..model.bodies import FlexibleBody
from ..model.model import Model
from ..model.rigid_outline import outline_of_rigid


def space_of(lowered: LoweredModel, bodies: Iterable[str]) -> Space:
    """The outlines of some bodies, and all connections and ground frames."""
    model = lowered.model
    size = _size(lowered)
    outlines = {name: _outline(model, name, size) for name in bodies}
    return Space(
        outlines={name: outline for name, outline in outlines.items() if outline is not None},
        connections=tuple(_connection(lowered, coupling) for coupling in model.couplings),
        ground_frames={name: frame.position for name, frame in model.ground_frames.items()},
        interfaces={name: _n_interfaces(model, name) for name in outlines},
    )


def _n_interfaces(model: Model, name: str) -> int:
    body = model.bodies[name]
    return len(body.superelement.interfaces) if isinstance(body, FlexibleBody) else 0


def _outline(model: Model, name: str, size: float) -> Outline | None:
    """The outline of a body; None for a superelement without one."""
    body = model.bodies[name]
    if isinstance(body, FlexibleBody):
        return body.superelement.outline
    return outline_of_rigid(body, size)


def _size(lowered: LoweredModel) -> float:
    """The distance across all bodies and frames at the start [m]."""
    points = [pose.x for pose in (*lowered.poses, *lowered.frame_poses)]
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _connection(lowered: LoweredModel, coupling: Coupling) -> Connection:
    """A coupling as pictures show it; its axis in the axes of its first frame, or in space."""
    D, axis = _first_axes(lowered, coupling), coupling.axis_in_space
    if axis is not None and coupling.between[0] != GROUND:
        # Axes of bodies turn with them; those of the ground stay in space.
        axis = D.T @ axis
    return Connection(
        coupling.name,
        coupling.group,
        coupling.type,
        coupling.between,
        axis,
        coupling.drawn_shape(D),
    )


def _first_axes(lowered: LoweredModel, coupling: Coupling) -> Array:
    """The axes of the first frame of a coupling at the start (3, 3), in space."""
    return lowered.frame_poses[lowered.frame_names.index(side_names(coupling)[0])].R
