"""Springs, dampers and bushings between two frames: force laws on the coordinates of rows.

    point     the distance of the origins                                                 1 row
    torsion   the angle about an axis, from frame A to frame B, continued over full turns 1 row
    bushing   three displacements along, and three rotations about, axes carried by frame A; 6 rows

The rotations of a bushing are the sines e_3(A) . e_2(B), e_1(A) . e_3(B), e_2(A) . e_1(B), which
for small angles are the rotations about e_1, e_2, e_3. Generalized force on B along the coordinates
c, linear and tabulated parts added:

    -stiffness (c - rest) - damping dc/dt - law(c - rest)
"""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError, plain
from .joints import basis_about
from .vectors import unit_vector

SPRING_ROWS = {"point": 1, "torsion": 1, "bushing": 6}


@dataclass(frozen=True)
class Law:
    """Force [N] or moment [N m] over deformation [m, rad]: linear between the points, and beyond
    the last ones.
    """

    deformation: tuple[float, ...]
    force: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.deformation) != len(self.force) or len(self.force) < 2:
            raise ModelError(
                f"law: expected two or more points, got {self.deformation} and {self.force}"
            )
        if any(b <= a for a, b in pairwise(self.deformation)):
            raise ModelError(
                f"law: deformation: expected increasing values, got {list(self.deformation)}"
            )


@dataclass(frozen=True, eq=False)
class Spring:
    """A spring with a damper between frames A and B, given as in a joint.

    stiffness, damping: a number, or for a bushing six numbers or a symmetric (6, 6) matrix [N/m, N
    m/rad; N s/m ...]; damping, which takes energy away, has no negative eigenvalue; law: a
    tabulated part (point and torsion); rest: the coordinates without force (length, angle, or six
    of them), by default those of the start; axis: of torsion, or e_3 of a bushing, in space at the
    start.
    """

    name: str
    type: str
    between: tuple[str, str]
    axis: Array | None = None
    stiffness: Array = field(default_factory=lambda: np.zeros(1))
    damping: Array = field(default_factory=lambda: np.zeros(1))
    law: Law | None = None
    rest: Array | None = None

    def __post_init__(self) -> None:
        if self.type not in SPRING_ROWS:
            known = ", ".join(SPRING_ROWS)
            raise ModelError(
                f"spring {self.name!r}: type: expected one of {known}, got {self.type!r}"
            )
        object.__setattr__(self, "between", tuple(self.between))
        if len(self.between) != 2:
            raise ModelError(
                f"spring {self.name!r}: between: expected two frames, got {self.between}"
            )
        if self.type == "torsion" and self.axis is None:
            raise ModelError(f"spring {self.name!r}: axis: a torsion spring needs one")
        if self.type == "point" and self.axis is not None:
            raise ModelError(
                f"spring {self.name!r}: axis: a point spring takes none, got {plain(self.axis)}"
            )
        if self.law is not None and self.type == "bushing":
            raise ModelError(f"spring {self.name!r}: law: a bushing takes none")
        for key in ("stiffness", "damping"):
            object.__setattr__(self, key, self._matrix(key, getattr(self, key)))
        lowest = np.linalg.eigvalsh(self.damping)[0]
        if lowest < -1e-9 * np.abs(self.damping).max():
            wanted = (
                "zero or more"
                if self.n_rows == 1
                else "no negative eigenvalue, which would create energy"
            )
            raise ModelError(f"spring {self.name!r}: damping: expected {wanted}, got {lowest:.6g}")
        if self.rest is not None:
            rest = np.atleast_1d(np.asarray(self.rest, dtype=np.float64))
            if rest.shape != (self.n_rows,):
                raise ModelError(
                    f"spring {self.name!r}: rest: expected {self.n_rows} numbers, got {plain(self.rest)}"
                )
            object.__setattr__(self, "rest", rest)
        self.basis()

    @property
    def n_rows(self) -> int:
        return SPRING_ROWS[self.type]

    def basis(self) -> Array:
        """The axes of the spring at the start, in space, as columns (3, 3)."""
        if self.axis is None:
            return np.eye(3)
        return basis_about(unit_vector(f"spring {self.name!r}: axis", self.axis))

    def _matrix(self, key: str, value: Any) -> Array:
        n = self.n_rows
        array = np.asarray(value, dtype=np.float64)
        if array.size == 1:
            array = array.reshape(1) * np.ones(n) if n == 1 or not array.any() else array
        matrix = np.diag(array) if array.shape == (n,) else array
        if (
            matrix.shape != (n, n)
            or not np.isfinite(matrix).all()
            or not np.allclose(matrix, matrix.T, rtol=1e-9)
        ):
            wanted = "a number" if n == 1 else "six numbers or a symmetric 6x6 matrix"
            raise ModelError(f"spring {self.name!r}: {key}: expected {wanted}, got {plain(value)}")
        return np.ascontiguousarray(matrix)
