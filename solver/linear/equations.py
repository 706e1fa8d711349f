"""The linear equations of a pose at a complex frequency, small and well scaled.

With D = K + s C + s^2 M of the tangent, and H(s) of the superelements,

    [ D_r                          dr / dlambda  ] [ xi     ]   [ -r_in      ]
    [ -H D_pi, 1 - bend            -H dpi/dlambda] [ z      ] = [ H pi_in    ]
    [ D_phi + relaxation(s)        dphi/dlambda  ] [ lambda ]   [ -phi_in    ]

so Newton's matrix of a step in the frequency domain. Modes of bodies, of any number and frequency,
are summed exactly in H and leave no rounding in the slow motions.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from ..arrays import Array, Index
from ..errors import ModelError
from ..laws.law import LAW_KINDS
from ..laws.maxwell import MaxwellLaw
from .blocks import diagonal_blocks
from .flexibility import (
    FlexibleTransfer,
    KernelBody,
    Matrix,
    ModalBody,
    StaticBody,
    bends,
    flexible_bodies,
)
from .pose import Pose
from .tangent import Sizes, Tangent, tangent_of

Bodies = Literal["dynamic", "static", "rigid"]
"""how flexible bodies deform"""
# reciprocal, with rows and columns scaled
SINGULAR_CONDITION = 1e-13


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
class Integrals:
    """Integrals of motors: -gain e on a row, e' = g . (xi, z).

    row (n,), gain (n,), gradient (n, n_r + n_a).
    """

    row: Index
    gain: Array
    gradient: Array


@dataclass(frozen=True, eq=False)
class Forcing:
    """Derivatives by inputs of r (n_r, n), of the loads pi (n_l, n) and of phi (n_i, n)."""

    r: Array
    pi: Array
    phi: Array


@dataclass(frozen=True, eq=False)
class Response:
    """Amplitudes of the unknowns at a frequency, a column for each input.

    xi (n_r, n), z (n_a, n), lam (n_i, n), pi (n_l, n): loads on all dofs that can be loaded.
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
    integrals: Integrals

    @property
    def sizes(self) -> Sizes:
        return self.tangent.sizes

    @property
    def modal_bodies(self) -> list[ModalBody]:
        """All flexible bodies; `ModelError` for one that is known by a kernel alone."""
        for body in self.bodies:
            if isinstance(body, KernelBody):
                raise ModelError(
                    f"body {body.name!r}: superelement {body.element.name!r} has a kernel but no "
                    "modes: only frequency responses can be computed"
                )
        return [body for body in self.bodies if isinstance(body, ModalBody)]

    @cached_property
    def bends(self) -> Array:
        """(1 - bend)^-1 of all elastic dofs (n_u, n_u)."""
        bend = bends(self.pose)
        # bend leads from q to the other dofs alone: its square vanishes
        # (1 - b)^-1 = 1 + b where b^2 = 0.
        return np.eye(len(bend)) + bend

    def with_bodies(self, bodies: Bodies) -> "Equations":
        """The same with bodies that deform as given: "dynamic", "static" or "rigid"."""
        if bodies == "dynamic":
            return self
        if bodies not in ("static", "rigid"):
            raise ModelError(f"bodies: expected dynamic, static or rigid, got {bodies!r}")
        factor = 1.0 if bodies == "static" else 0.0
        static = [
            StaticBody(body.name, factor * np.asarray(body.transfer(0.0)).real, body.loaded)
            for body in self.bodies
        ]
        return replace(self, bodies=static)

    @cached_property
    def relaxed(self) -> "Equations":
        """The same with bodies whose materials have no chains."""
        none = np.empty(0)
        bodies = [
            replace(body, tau=none, amplitude=np.empty((0, body.m)))
            if isinstance(body, ModalBody)
            else body
            for body in self.bodies
        ]
        return replace(self, bodies=bodies)

    @property
    def is_chained(self) -> bool:
        return any(isinstance(body, ModalBody) and len(body.tau) for body in self.bodies)

    def transfers(self, s: complex) -> list[Matrix]:
        """H of every body, of all its dofs by the active ones."""
        return [body.transfer(s) for body in self.bodies]

    @cached_property
    def acting(self) -> Index:
        """The active dofs among those that can be loaded (n_a,): others belong to patterns."""
        elastic = self.pose.system.elastic
        return np.searchsorted(elastic.loaded, elastic.active)

    def flexibility(self, transfers: Sequence[Matrix]) -> Matrix:
        """H (n_a, n_l) of the active dofs of all bodies by loads."""
        return np.asarray(diagonal_blocks(transfers))[self.pose.system.elastic.active]

    def spread(self, pi: Any) -> Any:
        """Loads (n_l, n) of those on active dofs (n_a, n)."""
        loads = np.zeros((len(self.pose.system.elastic.loaded), pi.shape[1]), dtype=pi.dtype)
        loads[self.acting] = pi
        return loads

    def elastic_dofs(self, s: complex, pi: Any) -> Any:
        """Displacements of all elastic dofs (n_u, n) under loads pi (n_l, n)."""
        return self.bends @ diagonal_blocks(self.transfers(s)) @ pi

    def dynamic(self, s: complex) -> Matrix:
        """D = K + s C + s^2 M, with the relaxation of laws (n_r + n_a + n_i, n_r + n_a).

        Rows of motors with an integral are multiplied by s.
        """
        t, relaxation = self.tangent, self.relaxation
        D: Matrix = t.K + s * t.C + s * s * t.M
        added = relaxation.stiffness(s)[:, None] * relaxation.gradient
        np.add.at(D, self.sizes.rows.start + relaxation.row, added)
        rows = self.sizes.rows.start + self.integrals.row
        # The integral 1 / s would be infinite at rest: the equation of the row times s is finite.
        D[rows] = s * D[rows] + self.integrals.gain[:, None] * self.integrals.gradient
        return D

    def row_factors(self, s: complex) -> Any:
        """What the equations of rows are multiplied by (n_r + n_a + n_i,)."""
        factors = np.ones(self.sizes.rows.stop, dtype=np.result_type(type(s), np.float64))
        factors[self.sizes.rows.start + self.integrals.row] = s
        return factors

    def factorized(self, s: complex) -> "Factors":
        return Factors(self, s)


class Factors:
    """The equations at a frequency, ready to be solved; `ModelError` where they are singular."""

    def __init__(self, equations: Equations, s: complex) -> None:
        sizes, t = equations.sizes, equations.tangent
        self.equations, self.s = equations, s
        self.D = equations.dynamic(s)
        self.H = equations.flexibility(equations.transfers(s))
        self.multiplied = equations.row_factors(s)
        by_rows = self.multiplied[:, None] * t.by_rows
        matrix = np.hstack([self.D, by_rows]).astype(np.result_type(self.D.dtype, self.H.dtype))
        # Rows of active dofs are compliances: H times the loads that the motion asks for.
        matrix[sizes.active] = -self.H[:, equations.acting] @ matrix[sizes.active]
        matrix[sizes.active, sizes.active] += np.eye(sizes.n_a) - t.bend
        # Rows have units of force, displacement and none: scaled, pivots tell the condition.
        self.rows = _scales(matrix, 1)
        self.columns = _scales(self.rows[:, None] * matrix, 0)
        scaled = self.rows[:, None] * matrix * self.columns
        from scipy.linalg import LinAlgWarning, lu_factor

        with warnings.catch_warnings(action="ignore", category=LinAlgWarning):
            self.lu = lu_factor(scaled, check_finite=False)
        # A cheap measure, good enough with scaled rows and columns.
        pivots = np.abs(np.diag(self.lu[0]))
        self.conditioned = bool(
            pivots.min(initial=1.0) > SINGULAR_CONDITION * pivots.max(initial=1.0)
        )

    def solve(self, b: Any, pi: Any) -> Response:
        """Amplitudes under b (n_r + n_a + n_i, n) on the right; pi (n_l, n): loads that are given.

        The rows of active dofs of b come on top of H pi.
        """
        sizes = self.equations.sizes
        right = (self.multiplied[:, None] * b).astype(
            np.result_type(b.dtype, pi.dtype, self.H.dtype, self.multiplied.dtype)
        )
        right[sizes.active] += self.H @ pi
        x = self.backward(right)
        loads = self.own_loads(x) + pi
        return Response(x[sizes.rigid], x[sizes.active], x[sizes.rows], loads)

    def backward(self, right: Any) -> Any:
        """The solution of the equations as they are, for (n_r + n_a + n_i, ...) on the right."""
        from scipy.linalg import lu_solve

        scaled = (self.rows * right.T).T
        return (self.columns * lu_solve(self.lu, scaled, check_finite=False).T).T

    def own_loads(self, x: Any) -> Any:
        """The loads (n_l, n) that motions and multipliers put on elastic dofs."""
        sizes, by_rows = self.equations.sizes, self.equations.tangent.by_rows
        own = self.D[sizes.active] @ x[sizes.moving] + by_rows[sizes.active] @ x[sizes.rows]
        return self.equations.spread(own)

    def forced(self, forcing: Forcing) -> Response:
        """Amplitudes by unit inputs."""
        sizes = self.equations.sizes
        b = np.zeros((sizes.rows.stop, forcing.r.shape[1]))
        b[sizes.rigid], b[sizes.rows] = -forcing.r, -forcing.phi
        return self.solve(b, forcing.pi)


def _scales(matrix: Matrix, axis: int) -> Array:
    """The reciprocals of the largest entries of rows (1) or columns (0)."""
    largest = np.abs(matrix).max(axis=axis, initial=0.0)
    scales: Array = 1.0 / np.where(largest > 0.0, largest, 1.0)
    return scales


def equations_of(pose: Pose) -> Equations:
    tangent = tangent_of(pose)
    motors = pose.system.couplings.laws.motors
    # Other motors are springs and dampers, which the tangent has already.
    own = motors.integral > 0.0
    row = motors.row[own]
    integrals = Integrals(row, motors.integral[own], tangent.gradients[row])
    return Equations(pose, tangent, flexible_bodies(pose), _relaxation(pose, tangent), integrals)


def _relaxation(pose: Pose, tangent: Tangent) -> Relaxation:
    laws = pose.system.couplings.laws
    rows: list[int] = []
    kappa: list[float] = []
    tau: list[float] = []
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        if LAW_KINDS[laws.number[m]] is not MaxwellLaw:
            continue
        parameters = laws.parameters[laws.first[m] : laws.first[m + 1]].tolist()
        n = len(parameters) // 2
        rows += n * [i]
        tau += parameters[:n]
        kappa += parameters[n:]
    row = np.array(rows, dtype=np.int64)
    return Relaxation(row, np.array(kappa), np.array(tau), tangent.gradients[row])
