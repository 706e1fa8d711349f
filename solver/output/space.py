"""The bodies of a model in space, as results keep them: outlines and connections."""

from collections.abc import Iterable

import numpy as np

from ...results.space import Connection, ContactShape, Space
from ...superelement import Outline
from ..arrays import Array
from ..couplings.contacts import Contact
from ..couplings.couplers import JointCoupler
from ..couplings.joints import Joint
from ..couplings.motions import PrescribedDisplacement, PrescribedRotation
from ..couplings.motors import JointMotor
from ..couplings.springs import Spring
from ..couplings.stops import JointStop
from ..lower.contacts import contact_axes, curve_through
from ..lower.lower import LoweredModel
from ..lower.numbering import between, side_names
from ..model.bodies import FlexibleBody
from ..model.model import Coupling, Model
from ..model.rigid_outline import outline_of_rigid

PER_PIECE = 8
"""points of a profile that are drawn, for each of its pieces"""


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
    """None of a flexible body whose superelement has none."""
    body = model.bodies[name]
    if isinstance(body, FlexibleBody):
        return body.superelement.outline
    return outline_of_rigid(body, size)


def _size(lowered: LoweredModel) -> float:
    """The distance across all bodies and frames at the start [m]."""
    points = [pose.x for pose in (*lowered.poses, *lowered.frame_poses)]
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _connection(lowered: LoweredModel, coupling: Coupling) -> Connection:
    first, second = between(coupling)
    return Connection(
        coupling.name,
        group_of(coupling),
        _type(coupling),
        (first, second),
        _axis(lowered, coupling),
        _shape(lowered, coupling) if isinstance(coupling, Contact) else None,
    )


def _shape(lowered: LoweredModel, contact: Contact) -> ContactShape:
    """The shape of a contact in the axes that its axis has."""
    names = dict(zip(lowered.frame_names, lowered.frame_poses, strict=True))
    D = names[side_names(contact)[0]].R
    across = contact_axes(contact, D)[1]
    first, _ = between(contact)
    curve = np.zeros((0, 2))
    if contact.points is not None:
        spline = curve_through(contact.points)
        n = len(spline.x) - 1
        curve = spline(np.interp(np.linspace(0, n, PER_PIECE * n + 1), np.arange(n + 1), spline.x))
    length = np.inf if contact.length is None else contact.length
    across = D @ across if first == "ground" else across
    return ContactShape(contact.radius or 0.0, length, across, curve)


def group_of(coupling: Coupling) -> str:
    """The group of results that a coupling is of; motions have one of their own here."""
    kinds = {
        Joint: "joints",
        Spring: "springs",
        Contact: "contacts",
        JointStop: "stops",
        JointMotor: "motors",
        JointCoupler: "couplers",
    }
    return next((name for kind, name in kinds.items() if isinstance(coupling, kind)), "motions")


def _type(coupling: Coupling) -> str:
    """The type of a joint or spring, the shape of a contact, what a motion gives."""
    if isinstance(coupling, Contact):
        return coupling.shape
    if isinstance(coupling, JointStop | JointMotor):
        return coupling.coordinate
    if isinstance(coupling, JointCoupler):
        return coupling.coupler.type
    if isinstance(coupling, Joint | Spring):
        return coupling.type
    return coupling.keys.coordinate


def _axis(lowered: LoweredModel, coupling: Coupling) -> Array | None:
    """The axis that a coupling has, in the axes of its first frame; in space if that is ground."""
    axis = _axis_in_space(coupling)
    first, _ = between(coupling)
    if axis is None or first == "ground":
        return axis
    names = dict(zip(lowered.frame_names, lowered.frame_poses, strict=True))
    turned: Array = names[side_names(coupling)[0]].R.T @ axis
    return turned


def _axis_in_space(coupling: Coupling) -> Array | None:
    if isinstance(coupling, JointStop | JointMotor):
        return coupling.joint.axis
    if isinstance(coupling, JointCoupler):
        return coupling.joints[0].axis
    if isinstance(coupling, PrescribedDisplacement):
        return coupling.direction
    if isinstance(coupling, PrescribedRotation | Joint | Spring | Contact):
        return coupling.axis
    return None
