"""Bodies in space: outlines, what connects them, and the frames of the ground."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..files.arrays import Array
from ..superelement import Outline

SURFACE_CONTACTS = "surface_contacts"
"""the group of connections of a shape and the body whose surface meets it"""


@dataclass(frozen=True)
class Place:
    """A point of a body at rest.

    position: in the coordinates of the mesh, or from the center of mass in body axes where the mesh
    is not known [m]; node: its number in the mesh file, None where that gives none.
    """

    position: tuple[float, float, float]
    in_mesh: bool = True
    node: int | None = None

    def __str__(self) -> str:
        x, y, z = (f"{coordinate:.4g}" for coordinate in self.position)
        where = f"({x}, {y}, {z}) m " + ("of the mesh" if self.in_mesh else "in body axes")
        return where if self.node is None else f"{where}, node {self.node}"


@dataclass(frozen=True, eq=False)
class ContactShape:
    """What the ball or surface of a contact touches, about the first frame.

    A plane has its axis alone.

    radius: of a sphere or cylinder, else 0 [m]; length: of a cylinder, half to each side, or inf
    [m]; across (3,): a unit vector across the axis, in the axes in which that is; curve (n, 2): of
    a profile, along that vector and along axis x across, else (0, 2) [m].
    """

    radius: float
    length: float
    across: Array
    curve: Array


@dataclass(frozen=True, eq=False)
class Connection:
    """A coupling between two frames, as views draw it.

    Parameters
    ----------
    name : str
    group : str
        "joints", "springs", "contacts", "motions", "motors", "stops", "couplers" or
        "surface_contacts".
    type : str
        "revolute", ...
    between : (str, str)
        "BODY.FRAME", "BODY" for its center of mass, "ground.NAME", or "ground" where the other
        frame starts.
    axis : (3,), optional
        Of joints and others that have one: a unit vector in the axes of the first frame, or of
        space where that is on the ground.
    shape : ContactShape, optional
        Of a contact; files of earlier versions have none.

    Examples
    --------
    >>> Connection("hinge", "joints", "revolute", between=("ground", "arm.root")).type
    'revolute'
    """

    name: str
    group: str
    type: str
    between: tuple[str, str]
    axis: Array | None = None
    shape: ContactShape | None = None


@dataclass(frozen=True, eq=False)
class Space:
    """All that a picture of a run needs beside the motion of bodies and frames.

    outlines: of recorded bodies, by name; bodies with the same superelement share one; connections;
    ground_frames: positions (3,) of frames fixed in space [m]; interfaces: how many flexible bodies
    with an outline have, recorded or not.
    """

    outlines: Mapping[str, Outline] = field(default_factory=dict)
    connections: tuple[Connection, ...] = ()
    ground_frames: Mapping[str, Array] = field(default_factory=dict)
    interfaces: Mapping[str, int] = field(default_factory=dict)
