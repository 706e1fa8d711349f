"""Springs, dampers and bushings between two frames: force laws on the coordinates of rows.

    point     the distance of the origins                                                 1 row
    torsion   the angle about an axis, from frame A to frame B, continued over full turns 1 row
    bushing   three displacements along, and three rotations about, axes carried by frame A; 6 rows

The rotations of a bushing are the sines e_3(A) . e_2(B), e_1(A) . e_3(B), e_2(A) . e_1(B), which
for small angles are the rotations about e_1, e_2, e_3. Generalized force on B along the coordinates
c, with the laws of each coordinate added:

    -stiffness (c - rest) - damping dc/dt - laws(c - rest, dc/dt)
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from ...inputs import dotted
from ..arrays import Array
from ..errors import plain
from ..laws.law import AnyLaws, ForceLaw, laws_of
from ..schema.entry import Entry, entry, one_of
from ..schema.values import (
    NO_ARRAY,
    Coefficients,
    Name,
    OptionalArray,
    OptionalDirection,
    Pair,
    is_symmetric,
)
from ..step.rows import Angle as AngleRow
from ..step.rows import Distance, Rotation, Translation
from .coupling import Coupling, length_of
from .joint import Angle, basis_about
from .rows import Row, Sides

BUSHING_AXES = ("x", "y", "z", "rx", "ry", "rz")
"""the coordinates of a bushing"""
NO_COEFFICIENT: Any = 0.0
"""the default of stiffness and damping"""


@dataclass(frozen=True)
class SpringType:
    """The coordinates on which a spring has its law, in this order."""

    distance: bool = False
    """that of the origins"""
    translations: tuple[int, ...] = ()
    """e_k(A) . (r_B - r_A)"""
    angles: tuple[Angle, ...] = ()
    rotations: tuple[tuple[int, int], ...] = ()
    """e_i(A) . e_j(B), sines"""
    axis: Literal["none", "needed", "optional"] = "optional"

    @property
    def n_rows(self) -> int:
        return self.distance + len(self.translations) + len(self.angles) + len(self.rotations)


SPRING_TYPES = {
    "point": SpringType(distance=True, axis="none"),
    "torsion": SpringType(angles=(Angle(0, 1, 0),), axis="needed"),
    "bushing": SpringType(translations=(0, 1, 2), rotations=((2, 1), (0, 2), (1, 0))),
}


@entry()
class Spring(Entry, Coupling):
    """A spring with a damper between two frames.

    Parameters
    ----------
    name : str
    type : {"point", "torsion", "bushing"}
        On the distance of the origins, on an angle, or on three displacements and three rotations.
    between : (2,) of str
        Frames A and B, see `Joint`.
    axis : (3,), optional
        Of torsion, or e_3 of a bushing, in space at the start.
    stiffness, damping : float, (6,) or symmetric (6, 6) [N/m, N m/rad; N s/m, N m s/rad]
        Six numbers or a matrix for a bushing. Damping has no negative eigenvalue: it dissipates.
    law : ForceLaw, several, or a mapping of them, optional
        Added to both; of a bushing by axes "x", "y", "z", "rx", "ry", "rz" (along and about e_1,
        e_2, e_3).
    rest : float or (6,), optional [m, rad]
        The coordinates without force, by default those of the start.
    second_axis : (3,), optional
        e_1 of a bushing, across `axis`. By default nearest to the x axis of frame A (to its y axis
        where x is within 26 degrees of e_3). Without both axes a bushing has those of frame A.

    Examples
    --------
    >>> Spring("coil", "point", ["ground", "box"], stiffness=2e4, damping=50.0, rest=0.3).n_rows
    1
    """

    label = "spring {name!r}"
    group: ClassVar[str] = "springs"
    dimension: ClassVar[str] = "spring"

    name: Name
    type: Annotated[str, one_of(SPRING_TYPES)]
    between: Pair
    axis: OptionalDirection = NO_ARRAY
    stiffness: Coefficients = NO_COEFFICIENT
    damping: Coefficients = NO_COEFFICIENT
    law: AnyLaws | None = None
    rest: OptionalArray = NO_ARRAY
    second_axis: OptionalDirection = NO_ARRAY

    @property
    def kind(self) -> SpringType:
        return SPRING_TYPES[self.type]

    @property
    def n_rows(self) -> int:
        return self.kind.n_rows

    def validate(self) -> None:
        if self.kind.axis == "needed" and self.axis is None:
            raise self.error(f"axis: a {self.type} spring needs one")
        if self.kind.axis == "none" and self.axis is not None:
            raise self.error(f"axis: a {self.type} spring takes none, got {plain(self.axis)}")
        self._check_second_axis()
        self._check_law()
        if self.rest is not None and self.rest.shape != (self.n_rows,):
            raise self.error(f"rest: expected {self.n_rows} numbers, got {plain(self.rest)}")
        # From here on both are matrices (n, n), whatever form a user gave.
        object.__setattr__(self, "stiffness", self._matrix("stiffness", self.stiffness))
        object.__setattr__(self, "damping", self._matrix("damping", self.damping))
        lowest = np.linalg.eigvalsh(self.damping)[0]
        # Semidefinite matrices have eigenvalues of rounding of either sign.
        if lowest < -1e-9 * np.abs(self.damping).max():
            limit = "no negative eigenvalue, which would create energy"
            limit = "zero or more" if self.n_rows == 1 else limit
            raise self.error(f"damping: expected {limit}, got {lowest:.6g}")

    @property
    def laws_of_rows(self) -> Sequence[tuple[ForceLaw, ...]]:
        """The force laws of each row."""
        if not isinstance(self.law, Mapping):
            return [laws_of(self.law)] * self.n_rows
        return [laws_of(self.law.get(axis)) for axis in BUSHING_AXES]

    def _check_law(self) -> None:
        if self.law is None:
            return
        axes = self.law if isinstance(self.law, Mapping) else None
        if self.n_rows == 1 and axes is not None:
            raise self.error(f"law: a {self.type} spring has one coordinate, got laws by axis")
        if self.n_rows > 1 and axes is None:
            raise self.error(f"law: a {self.type} takes laws by axis: {', '.join(BUSHING_AXES)}")
        for axis in axes or ():
            if axis not in BUSHING_AXES:
                raise self.error(
                    f"law: expected axes {', '.join(BUSHING_AXES)}, got {dotted([axis])}"
                )

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """One row for each coordinate of the spring, with its law."""
        (own,) = sides
        kind, basis = self.kind, self.basis(own.pose_a.R)
        in_a, in_b = own.carried(basis)
        A, B = own.frame_a, own.frame_b
        gap = own.gap(basis)
        rows = []
        if kind.distance:
            # The order of rows is that of the six coefficients: distances first, then angles.
            rows.append(Row(Distance.number, A, B, start=length_of(self, own)))
        rows += [
            Row(Translation.number, A, B, in_a[:, k], start=float(gap[k]))
            for k in kind.translations
        ]
        rows += [
            Row(AngleRow.number, A, B, in_a[:, t.i], in_a[:, t.k], in_b[:, t.j])
            for t in kind.angles
        ]
        rows += [Row(Rotation.number, A, B, in_a[:, i], b=in_b[:, j]) for i, j in kind.rotations]
        # Without a rest a spring is free of force where the model starts.
        rest = np.array([row.start for row in rows]) if self.rest is None else self.rest
        return [
            replace(
                row,
                rest=float(rest[i]),
                stiffness=self.stiffness[i],
                damping=self.damping[i],
                laws=self.laws_of_rows[i],
            )
            for i, row in enumerate(rows)
        ]

    def given_angles(self) -> Iterator[tuple[str, Any]]:
        if self.kind.angles and self.rest is not None:
            yield "rest", float(np.max(self.rest))

    def basis(self, D: Array) -> Array:
        """The axes of the spring at the start, in space, as columns (3, 3).

        D (3, 3): the axes of the first frame, which lead where the spring gives none.
        """
        if self.axis is None:
            return D
        if self.second_axis is None:
            return basis_about(self.axis, D)
        e3, e1 = self.axis, self.second_axis
        return np.column_stack([e1, np.cross(e3, e1), e3])

    def _check_second_axis(self) -> None:
        if self.second_axis is None:
            return
        takes = "one only with axis" if self.kind.axis == "optional" else "none"
        if self.axis is None or takes == "none":
            got = plain(self.second_axis)
            raise self.error(f"second_axis: a {self.type} spring takes {takes}, got {got}")
        if abs(self.axis @ self.second_axis) > 1e-9:
            raise self.error("second_axis: expected an axis perpendicular to axis at the start")

    def _matrix(self, name: str, values: Array) -> Array:
        """Coefficients (n, n): of the diagonal if there are n; no number but 0 stands for six."""
        n = self.n_rows
        diagonal = values.ravel() if values.size == 1 and n == 1 else values
        # Only zero stands for six coefficients: a stiffness [N/m] has no meaning for rotations.
        if values.size == 1 and not values.any():
            diagonal = np.zeros(n)
        matrix = np.diag(diagonal) if diagonal.shape == (n,) else values
        if matrix.shape != (n, n) or not is_symmetric(matrix):
            shapes = "a number" if n == 1 else f"{n} numbers or a symmetric {n}x{n} matrix"
            raise self.error(f"{name}: expected {shapes}, got {values.squeeze().tolist()}")
        return np.ascontiguousarray(matrix)
