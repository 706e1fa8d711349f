"""The interface of couplings: a new kind is one class that implements it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...results.space import ContactShape
from ..arrays import Array
from ..errors import ModelError
from ..step.rows import measures_length
from .friction import Bristle
from .rows import Row, Sides

GROUND = "ground"
"""the name of space among the bodies"""
Inertia = Callable[[Array | None], float]
"""the reduced mass of both sides [kg]; with an axis (3,) in space, that of inertias about it"""
# relative to coordinates: rounding of the starting poses, some 1e-16 of them, leaves a shorter
# distance no direction
COINCIDENT_DISTANCE = 1e-12


class Coupling:
    """A coupling of two frames, or of coordinates of joints, by rows.

    The rest of the solver uses this interface alone and never tests for a kind of coupling.
    """

    group: ClassVar[str]
    """the array of tables in model files that holds it, which pictures name too: "springs" """
    dimension: ClassVar[str]
    """the dimension of results files along which its kind is recorded: "spring" """
    opens: ClassVar[bool] = False
    """it acts by a `ContactLaw` on its first row, and has events"""
    keeps_turns: ClassVar[bool] = False
    """its angle knows its full turns, and the joint that it acts on learns them from it"""

    may_feed: ClassVar[bool] = False
    """its law may put energy into the bodies, by nature and not by an error of the step"""
    has_branches: ClassVar[bool] = False
    """its constraint holds on a second branch too, see solver/output/branches.py"""

    if TYPE_CHECKING:  # fields of some kinds, which a property of this class would hide

        @property
        def name(self) -> str: ...

        @property
        def type(self) -> str:
            """The type within its group, as pictures name it: "bushing"."""

        @property
        def between(self) -> tuple[str, str]:
            """The names of its two frames: "BODY.FRAME", "BODY" (its center), or "ground"."""

        @property
        def owner(self) -> str:
            """The name in messages: "spring 'mount'"."""

        def error(self, message: str) -> ModelError:
            """A ModelError that names the coupling."""

    def bound(self, joints: Mapping[str, Any]) -> "Coupling":
        """This coupling with the joints of a model that it refers to, by name."""
        return self

    @property
    def described(self) -> str:
        """The name in messages, with the type where that says more."""
        return f"{self.owner} ({self.type})"

    @property
    def in_words(self) -> str:
        """A line that describes the coupling, for `check`."""
        return self.described

    @property
    def framed_by(self) -> "Sequence[Coupling]":
        """The couplings between whose frames it acts: itself, or the joints of its coordinates."""
        return (self,)

    @property
    def joint_coordinates(self) -> Sequence[tuple[str, str]]:
        """The coordinates that it acts on, each by its joint and its name."""
        return ()

    @property
    def axis_in_space(self) -> Array | None:
        """The axis that pictures show (3,), in space at the start."""
        return None

    def drawn_shape(self, D: Array) -> ContactShape | None:
        """The shape of a contact, for pictures; D (3, 3): the axes of the first frame."""
        return None

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """The rows, in the order of coordinates or constraints.

        sides: the frames of each coupling in `framed_by`, at the start.
        """
        raise NotImplementedError

    def observed(self, sides: Sides) -> dict[str, Row]:
        """The coordinates that results record in addition to the rows, by name."""
        return {}

    def bristle(self, inertia: Inertia, sides: Sides, h: float) -> Bristle | None:
        """The friction of its last rows, in steps of h [s]; None where there is none."""
        return None

    def loaded_by_moments(self, rows: Sequence[Row]) -> Mapping[str, str]:
        """The frames of `side_names` that it loads by moments, with the cause for messages."""
        # Rows of lengths act by forces through the origins of their frames.
        if all(measures_length(row.kind) for row in rows):
            return {}
        return dict.fromkeys(side_names(self), self.described)

    def check_opening(self, sides: Sides, limit: float) -> None:
        """`ModelError` where its frames are further apart at the start than a limit [m]."""

    def check_depth(self, depth: float, size: float) -> None:
        """`ModelError` for a contact that starts too deep [m] in a model of a size [m]."""

    def given_angles(self) -> Iterator[tuple[str, Any]]:
        """Numbers [rad], and signals of angles, which may be in degrees by mistake, by key."""
        return iter(())


def side_names(coupling: Coupling) -> tuple[str, str]:
    """The frames of a coupling by name, with one of its own in place of the bare ground.

    The latter is fixed in space at the starting pose of the other side.
    """
    own = coupling.framed_by[0]
    first, second = (f"{GROUND}.({own.name})" if side == GROUND else side for side in own.between)
    return first, second


def length_of(coupling: Coupling, sides: Sides) -> float:
    """The distance of two frames at the start [m], which must not be zero."""
    # The row of a distance divides by it.
    length = float(np.linalg.norm(sides.gap(np.eye(3))))
    if length <= COINCIDENT_DISTANCE * float(np.abs([sides.pose_a.x, sides.pose_b.x]).max()):
        raise coupling.error(f"its ends {list(coupling.between)} coincide at the start")
    return length
