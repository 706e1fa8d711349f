"""Bearings: forces on a shaft in axes of its support, by stiffness and damping over the spin.

With the displacement c = (c_1, c_2) of the shaft along e_1, e_2 across the axis, carried by the
support, and the spin Omega, the rate of the angle about the axis from the support to the shaft, the
force on the shaft along e_1, e_2 is

    -K(Omega) (c - c_start) - C(Omega) dc/dt

whatever the angle is. K and C are linear between the speeds of a table. K need not be symmetric:
the cross coupling of fluid films and seals drives the shaft round, and so does work. Sources:
J. W. Lund, Spring and damping coefficients for the tilting-pad journal bearing, ASLE Trans. 7
(1964); M. I. Friswell, J. E. T. Penny, S. D. Garvey, A. W. Lees, Dynamics of Rotating Machines
(2010), ch. 5 and 7.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import Any, ClassVar

import numpy as np

from ...inputs import dotted
from ..arrays import Array
from ..errors import ModelError, plain
from ..schema.entry import Entry, entry
from ..schema.paths import FilePath
from ..schema.values import (
    NO_ARRAY,
    BearingCoefficients,
    Direction,
    Name,
    NumbersByName,
    OptionalArray,
    OptionalDirection,
    Pair,
)
from ..step.rows import Angle as AngleRow
from ..step.rows import Translation
from ..step.spin_tables import MARGIN_OF_TABLE
from .bearing_tables import FILM_KEYS, read_bearing_table
from .coupling import Coupling
from .joint import basis_about
from .rows import OverSpin, Row, Sides

IN_TABLE: Any = ()
"""the stiffness of a bearing that has a table"""
NO_DAMPING: Any = 0.0
"""the default of damping"""
CONSTANT_FORMS = "a number, 2 numbers or a 2x2 matrix"
# Two numbers a row would be mistaken for one 2x2 matrix where there are two speeds.
FORMS_OVER_SPEEDS = "a row of 4 numbers (11, 12, 21, 22)"


@entry()
class Bearing(Entry, Coupling):
    """A bearing between a support and a shaft, which acts across its axis alone.

    Parameters
    ----------
    name : str
    between : (2,) of str
        Frames of the support, most often of the ground, and of the shaft, see `Joint`.
    axis : (3,)
        Of the shaft, in space at the start. A positive spin turns e_1 to e_2.
    stiffness, damping : float, (2,), (2, 2), or with speeds (n, 4) [N/m; N s/m]
        Along e_1, e_2; entry (i, k) is the force against e_i by a displacement or rate along e_k.
        Rows over speeds have the entries 11, 12, 21, 22. Left out where a table gives them.
    second_axis : (3,), optional
        e_1, across `axis`. By default nearest to the x axis of the support (to its y axis where x
        is within 26 degrees of the axis).
    speeds : (n,), optional [rad/s]
        Increasing spins of the rows of stiffness and damping, which are linear between them. The
        spin may leave them by a hundredth of their range, where the coefficients of the end hold; a
        run that goes further stops, and a linear analysis beyond is refused.
    table : path, optional
        A file with speeds, stiffness and damping: CSV with the columns speed, kxx, kxy, kyx, kyy,
        cxx, cxy, cyx, cyy and their units, or the TOML or JSON that ROSS saves. x is e_1, y is e_2.
        It is read once, when the bearing is made.
    film : mapping of float, optional
        load [N], clearance (radial) [m], viscosity [Pa s], length and diameter [m] of a bearing
        whose table is dimensionless, over the Sommerfeld number.

    Examples
    --------
    >>> film = Bearing("film", ["ground", "shaft.left"], [1.0, 0.0, 0.0],
    ...                stiffness=[[1e7, 4e6], [-4e6, 2e7]], damping=[1e4, 1e4])
    >>> film.n_rows
    2
    """

    label = "bearing {name!r}"
    group: ClassVar[str] = "bearings"
    dimension: ClassVar[str] = "spring"
    may_feed: ClassVar[bool] = True

    name: Name
    between: Pair
    axis: Direction
    stiffness: BearingCoefficients = IN_TABLE
    damping: BearingCoefficients = NO_DAMPING
    second_axis: OptionalDirection = NO_ARRAY
    speeds: OptionalArray = NO_ARRAY
    table: FilePath | None = None
    film: NumbersByName = field(default_factory=dict)

    @property
    def type(self) -> str:
        return "bearing"

    @property
    def n_rows(self) -> int:
        return 2 if self.speeds is None else 3

    def validate(self) -> None:
        if self.second_axis is not None and abs(self.axis @ self.second_axis) > 1e-9:
            raise self.error("second_axis: expected an axis perpendicular to axis at the start")
        if self.between[1].partition(".")[0] == "ground":
            raise self.error(
                f"between: expected the support and then the shaft, got {dotted(self.between)}"
            )
        if self.table is not None:
            self._read(self.table)
        elif self.film:
            raise self.error("film: expected a dimensionless table with it")
        elif not self.stiffness.size:
            raise self.error("expected stiffness, or a table")
        if self.speeds is not None:
            self._check_speeds(self.speeds)
        # From here on both are matrices (n, 2, 2), whatever form a user gave.
        for key in ("stiffness", "damping"):
            object.__setattr__(self, key, self._matrices(key, getattr(self, key)))

    def _read(self, path: str) -> None:
        """Take the coefficients of a file, which then stand in the bearing itself."""
        if self.stiffness.size or self.damping.any() or self.speeds is not None:
            raise self.error("expected a table, or stiffness, damping and speeds, not both")
        if self.film:
            self._check_film()
        try:
            found = read_bearing_table(path, self.film)
        except ModelError as error:
            raise self.error(f"table: {error}") from error
        taken = {**found._asdict(), "table": None, "film": {}}
        for key, value in taken.items():
            object.__setattr__(self, key, value)

    def _check_film(self) -> None:
        if set(self.film) != set(FILM_KEYS):
            raise self.error(f"film: expected {', '.join(FILM_KEYS)}, got {', '.join(self.film)}")
        for key, value in self.film.items():
            if not value > 0.0:
                raise self.error(f"film: {key}: expected a number above 0, got {value:g}")

    def _check_speeds(self, speeds: Array) -> None:
        if speeds.ndim != 1 or len(speeds) < 2 or (np.diff(speeds) <= 0.0).any():
            raise self.error(
                f"speeds: expected two or more increasing speeds in rad/s, got {plain(speeds)}"
            )

    def _matrices(self, key: str, values: Array) -> Array:
        """Matrices (n, 2, 2), one for each speed, or (1, 2, 2)."""
        if self.speeds is None:
            matrices = _constant(values)
        else:
            matrices = _over_speeds(values, len(self.speeds))
        if matrices is None:
            forms = CONSTANT_FORMS
            if self.speeds is not None:
                forms = f"for each of {len(self.speeds)} speeds {FORMS_OVER_SPEEDS}"
            raise self.error(f"{key}: expected {forms}, got {np.squeeze(values).tolist()}")
        return np.ascontiguousarray(matrices)

    @property
    def axis_in_space(self) -> Array | None:
        return self.axis

    def coefficients(self, spin: float) -> tuple[Array, Array]:
        """K and C (2, 2) at a spin [rad/s]; ModelError beyond the margins of the table."""
        if self.speeds is None:
            return self.stiffness[0], self.damping[0]
        first, last = float(self.speeds[0]), float(self.speeds[-1])
        margin = MARGIN_OF_TABLE * (last - first)
        if not first - margin <= spin <= last + margin:
            raise self.error(
                f"speeds: {spin:.6g} rad/s is beyond its table, from {first:.6g} to {last:.6g}"
            )
        K, C = (
            np.array(
                [[np.interp(spin, self.speeds, m[:, i, k]) for k in range(2)] for i in range(2)]
            )
            for m in (self.stiffness, self.damping)
        )
        return K, C

    def rows(self, sides: Sequence[Sides]) -> list[Row]:
        """Two translations with their laws, and with a table the angle whose rate is the spin."""
        (own,) = sides
        basis = self.basis(own.pose_a.R)
        in_a, in_b = own.carried(basis)
        gap = own.gap(basis)
        A, B = own.frame_a, own.frame_b
        rows = [
            Row(
                Translation.number,
                A,
                B,
                in_a[:, i],
                start=float(gap[i]),
                rest=float(gap[i]),
                stiffness=self.stiffness[0, i],
                damping=self.damping[0, i],
                over_spin=self._over_spin(i),
            )
            for i in range(2)
        ]
        if self.speeds is not None:
            # A law without any force: the row is there for its rate, and its multiplier vanishes.
            angle = Row(AngleRow.number, A, B, in_a[:, 0], in_a[:, 1], in_b[:, 0])
            rows.append(replace(angle, stiffness=np.zeros(2), damping=np.zeros(2)))
        return rows

    def _over_spin(self, i: int) -> OverSpin | None:
        if self.speeds is None:
            return None
        # Added to the coefficients of the first speed, which all else sees that asks for a spring.
        return OverSpin(
            self.speeds,
            self.stiffness[:, i] - self.stiffness[0, i],
            self.damping[:, i] - self.damping[0, i],
        )

    def loaded_by_moments(self, rows: Sequence[Row]) -> Mapping[str, str]:
        # The angle has no moment: an interface without rotations can carry a bearing.
        return {}

    def basis(self, D: Array) -> Array:
        """e_1, e_2 and the axis at the start, in space, as columns (3, 3).

        D (3, 3): the axes of the support, which lead where no second axis is given.
        """
        if self.second_axis is None:
            return basis_about(self.axis, D)
        return np.column_stack([self.second_axis, np.cross(self.axis, self.second_axis), self.axis])


def _constant(values: Array) -> Array | None:
    """One matrix (1, 2, 2) of a number, a diagonal or four entries; None of anything else."""
    if values.size == 1:
        return float(values.ravel()[0]) * np.eye(2)[None]
    if values.shape == (2,):
        return np.diag(values)[None]
    return values.reshape(1, 2, 2) if values.shape in ((2, 2), (1, 2, 2)) else None


def _over_speeds(values: Array, n: int) -> Array | None:
    """Matrices (n, 2, 2) of rows of four numbers; None of anything else."""
    if values.size == 1 and not values.any():
        return np.zeros((n, 2, 2))
    return values.reshape(n, 2, 2) if values.shape in ((n, 4), (n, 2, 2)) else None
