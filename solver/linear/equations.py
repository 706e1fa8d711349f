"""The linear equations of a pose at a complex frequency, small and well scaled.

With D = K + s C + s^2 M of the tangent, and H(s) of the superelements,

    [ D_r                          dr / dlambda  ] [ xi     ]   [ -r_in      ]
    [ -H D_pi, 1 - bend            -H dpi/dlambda] [ z      ] = [ H pi_in    ]
    [ D_phi + relaxation(s)        dphi/dlambda  ] [ lambda ]   [ -phi_in    ]

so Newton's matrix of a step in the frequency domain. Modes of bodies, of any number and frequency,
are summed exactly in H and leave no rounding in the slow motions.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import block_diag, lu_factor, lu_solve

from ..arrays import Array, Index
from ..errors import ModelError
from ..laws.law import LAWS
from ..laws.maxwell import MaxwellLaw
from .flexibility import FlexibleTransfer, Matrix, ModalBody, bends, flexible_bodies
from .pose import Pose
from .tangent import Sizes, Tangent, tangent_of

SINGULAR = 1e-13
"""reciprocal condition, rows and columns scaled, below which equations count as singular"""


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Branches of Maxwell laws: -kappa (g . (xi, z) - e), e' = (g . (xi, z) - e) / tau on a row.

    row (n,) its number, kappa (n,), tau (n,), gradient (n, n_r + n_a).
    """

    row: Index
    kappa: Array
    tau: Array
    gradient: Array

    def stiffness(self, s: complex) -> Matrix:
        """kappa s tau / (1 + s tau)"""
        values: Matrix = self.kappa * (s * self.tau) / (1.0 + s * self.tau)
        return values


@dataclass(frozen=True, eq=False)
class Forcing:
    """Derivatives of [r; pi; phi] by inputs (n_r + n_a + n_i, n_in)."""

    values: Array


@dataclass(frozen=True, eq=False)
class Response:
    """Amplitudes of the unknowns at a frequency, a column for each input.

    xi (n_r, n), z (n_a, n), lam (n_i, n), pi (n_a, n): loads on z.
    """

    xi: Any
    z: Any
    lam: Any
    pi: Any


@dataclass(frozen=True, eq=False)
class Equations:
    """Tangent and transfer functions of a pose."""

    pose: Pose
    tangent: Tangent
    bodies: Sequence[FlexibleTransfer]
    relaxation: Relaxation

    @property
    def sizes(self) -> Sizes:
        return self.tangent.sizes

    @property
    def modal_bodies(self) -> list[ModalBody]:
        """All flexible bodies; `ModelError` for one that is known by a kernel alone."""
        for body in self.bodies:
            if not isinstance(body, ModalBody):
                raise ModelError(
                    f"body {body.name!r}: superelement {body.element.name!r} has no modes, only a "
                    "kernel: frequency responses take it, modes and state space do not"
                )
        return [body for body in self.bodies if isinstance(body, ModalBody)]

    @cached_property
    def bends(self) -> Array:
        """(1 - bend)^-1 of all elastic dofs (n_u, n_u)."""
        bend = bends(self.pose)
        # bend leads from q to the other dofs alone: its square vanishes
        return np.eye(len(bend)) + bend

    def transfers(self, s: complex) -> list[Matrix]:
        """H of every body, of all its dofs by the active ones."""
        return [body.transfer(s) for body in self.bodies]

    def flexibility(self, transfers: Sequence[Matrix]) -> Matrix:
        """H (n_a, n_a) of the active dofs of all bodies."""
        blocks = [H[body.active] for H, body in zip(transfers, self.bodies, strict=True)]
        return np.asarray(block_diag(np.zeros((0, 0)), *blocks))

    def elastic_dofs(self, s: complex, pi: Any) -> Any:
        """Displacements of all elastic dofs (n_u, n) under loads pi on the active ones."""
        return self.bends @ block_diag(np.zeros((0, 0)), *self.transfers(s)) @ pi

    def dynamic(self, s: complex) -> Matrix:
        """D = K + s C + s^2 M, with the relaxation of laws (n_r + n_a + n_i, n_r + n_a)."""
        t, relaxation = self.tangent, self.relaxation
        D: Matrix = t.K + s * t.C + s * s * t.M
        added = relaxation.stiffness(s)[:, None] * relaxation.gradient
        np.add.at(D, self.sizes.rows.start + relaxation.row, added)
        return D

    def factorized(self, s: complex) -> "Factors":
        return Factors(self, s)


class Factors:
    """The equations at a frequency, ready to be solved; `ModelError` where they are singular."""

    def __init__(self, equations: Equations, s: complex) -> None:
        sizes, t = equations.sizes, equations.tangent
        self.equations, self.s = equations, s
        self.D = equations.dynamic(s)
        self.H = equations.flexibility(equations.transfers(s))
        matrix = np.hstack([self.D, t.by_rows.astype(self.D.dtype)]).astype(
            np.result_type(self.D.dtype, self.H.dtype)
        )
        matrix[sizes.active] = -self.H @ matrix[sizes.active]
        matrix[sizes.active, sizes.active] += np.eye(sizes.n_a) - t.bend
        self.rows = _scales(matrix, 1)
        self.columns = _scales(self.rows[:, None] * matrix, 0)
        scaled = self.rows[:, None] * matrix * self.columns
        with np.errstate(all="ignore"):
            self.lu = lu_factor(scaled, check_finite=False)
        pivots = np.abs(np.diag(self.lu[0]))
        self.conditioned = bool(pivots.min(initial=1.0) > SINGULAR * pivots.max(initial=1.0))

    def solve(self, b: Any, pi: Any) -> Response:
        """Amplitudes under b (n_r + n_a + n_i, n) on the right; pi (n_a, n): loads that are given.

        The rows of active dofs of b come on top of H pi.
        """
        sizes = self.equations.sizes
        right = b.astype(np.result_type(b.dtype, pi.dtype, self.H.dtype))
        right[sizes.active] += self.H @ pi
        x = self.columns[:, None] * lu_solve(
            self.lu, self.rows[:, None] * right, check_finite=False
        )
        by_rows = self.equations.tangent.by_rows[sizes.active]
        loads = self.D[sizes.active] @ x[sizes.moving] + by_rows @ x[sizes.rows] + pi
        return Response(x[sizes.rigid], x[sizes.active], x[sizes.rows], loads)

    def forced(self, forcing: Array) -> Response:
        """Amplitudes by unit inputs, whose derivatives of [r; pi; phi] are given."""
        sizes = self.equations.sizes
        b = -forcing
        b[sizes.active] = 0.0
        return self.solve(b, forcing[sizes.active])


def _scales(matrix: Matrix, axis: int) -> Array:
    """The reciprocals of the largest entries of rows (1) or columns (0)."""
    largest = np.abs(matrix).max(axis=axis, initial=0.0)
    scales: Array = 1.0 / np.where(largest > 0.0, largest, 1.0)
    return scales


def equations_of(pose: Pose) -> Equations:
    tangent = tangent_of(pose)
    return Equations(pose, tangent, flexible_bodies(pose), _relaxation(pose, tangent))


def _relaxation(pose: Pose, tangent: Tangent) -> Relaxation:
    laws = pose.system.couplings.laws
    rows: list[int] = []
    kappa: list[float] = []
    tau: list[float] = []
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        if LAWS[laws.number[m]] is not MaxwellLaw:
            continue
        parameters = laws.parameters[laws.first[m] : laws.first[m + 1]].tolist()
        n = len(parameters) // 2
        rows += n * [i]
        tau += parameters[:n]
        kappa += parameters[n:]
    row = np.array(rows, dtype=np.int64)
    return Relaxation(row, np.array(kappa), np.array(tau), tangent.gradients[row])
