"""The bodies of a model in space, as results keep them: outlines and connections."""

from collections.abc import Iterable

import numpy as np

from ...results.space import SURFACE_CONTACTS, Connection, Space
from ...superelement import Outline
from ..arrays import Array
from ..couplings.coupling import GROUND, Coupling, side_names
from ..couplings.surface_contacts import SurfaceContact
from ..lower.lower import LoweredModel
from ..lower.numbering import carrier_name
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
        connections=(
            *(_connection(lowered, coupling) for coupling in model.couplings),
            *(
                _pressed(lowered, contact)
                for contact in model.surface_contacts
                if contact.shape is not None
            ),
        ),
        ground_frames=_ground_frames(model),
        interfaces={name: _n_interfaces(model, name) for name in outlines},
    )


def _ground_frames(model: Model) -> dict[str, Array]:
    """Positions of frames of the ground, and of its shapes about the origin."""
    places = {name: frame.position for name, frame in model.ground_frames.items()}
    for contact in model.surface_contacts:
        if contact.carrier == GROUND:
            places[carrier_name(contact).partition(".")[2]] = np.zeros(3)
    return places


def _pressed(lowered: LoweredModel, contact: SurfaceContact) -> Connection:
    """The shape that a surface meets, and the body of that surface."""
    frame = carrier_name(contact)
    D, ends = _axes(lowered, frame), (frame, contact.body)
    axis, shape = _axis_in_frame(contact.axis_in_space, frame, D), contact.drawn_shape(D)
    return Connection(contact.name, SURFACE_CONTACTS, str(contact.shape), ends, axis, shape)


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
    D = _axes(lowered, side_names(coupling)[0])
    axis = _axis_in_frame(coupling.axis_in_space, coupling.between[0], D)
    shape = coupling.drawn_shape(D)
    return Connection(coupling.name, coupling.group, coupling.type, coupling.between, axis, shape)


def _axes(lowered: LoweredModel, frame: str) -> Array:
    """The axes of a frame at the start (3, 3), in space."""
    return lowered.frame_poses[lowered.frame_names.index(frame)].R


def _axis_in_frame(axis: Array | None, frame: str, D: Array) -> Array | None:
    """An axis in space in the axes D of the frame that carries it, or in space for the ground."""
    # Axes of bodies turn with them; those of the ground stay in space.
    return axis if axis is None or frame.partition(".")[0] == GROUND else D.T @ axis
