"""The lowest modes of a body some of whose motions are held."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space, orth
from scipy.sparse.linalg import LinearOperator, eigsh

from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..errors import MethodError
from ..solving.factor import Solve, factorize
from .modal import FULL_MODAL_UNKNOWNS, MODAL_LIMIT

MAX_LANCZOS_SHARE = 0.2  # of the unknowns, from which on Lanczos' method saves nothing
N_CHECKED_MODES = 4
"""Modes looked for beside those found: of equal frequencies Lanczos' method may miss one."""
EQUAL_SQUARES = 1e-9  # difference of squared frequencies, relative to them, that is rounding


@dataclass(frozen=True, eq=False)
class HeldModes:
    """Modes with squared frequencies (m,) [1/s^2], ascending, and shapes (n_u, m)."""

    squares: Array
    shapes: Array


def held_modes(structure: Structure, held: Array, count: int, shift: float) -> HeldModes:
    """The first `count` modes of a body that cannot move along the rows of `held` (k, n_u).

        K phi + held^T lambda = omega^2 M phi,    held phi = 0

    shift [1/s^2]: about the first elastic omega^2. What is held must leave no rigid motion.
    `MethodError` for more modes than there are, or than there is time for.
    """
    # Displacements and rotations compare once each row has length one.
    rows = orth((held / np.linalg.norm(held, axis=1)[:, None]).T).T
    most = structure.n_u - len(rows)
    if not 1 <= count <= most:
        raise MethodError(f"impulse.modes: expected 1 to {most}, all of this mesh, found {count}")
    if structure.n_u <= FULL_MODAL_UNKNOWNS or count > MAX_LANCZOS_SHARE * structure.n_u:
        if structure.n_u > MODAL_LIMIT:
            raise MethodError(
                f"impulse.modes: expected up to {int(MAX_LANCZOS_SHARE * structure.n_u)} of a mesh "
                f"of {structure.n_u} unknowns, found {count}: use method krylov"
            )
        return _of_all(structure, rows, count, shift)
    return _by_lanczos(structure, rows, count, shift)


def _of_all(structure: Structure, rows: Array, count: int, shift: float) -> HeldModes:
    """Those of the largest 1 / (omega^2 + shift), which the solver has to its rounding."""
    Z = null_space(rows)
    n = Z.shape[1]
    M, K = Z.T @ (structure.M @ Z), Z.T @ (structure.K @ Z)
    inverses, y = eigh(M, K + shift * M, subset_by_index=[n - count, n - 1])
    return HeldModes(1.0 / inverses[::-1] - shift, Z @ y[:, ::-1])


def _by_lanczos(structure: Structure, rows: Array, count: int, shift: float) -> HeldModes:
    """By Lanczos' method, until what is left has no mode below those found."""
    solve = _held_solve(structure, rows, shift)
    found = _lanczos(structure, solve, count, shift)
    while True:
        rest = _beside(structure, solve, found.shapes)
        more = _lanczos(structure, rest, N_CHECKED_MODES, shift)
        last = found.squares[count - 1]
        found = _merged(found, more)
        if more.squares[0] >= (1.0 - EQUAL_SQUARES) * last:
            return HeldModes(found.squares[:count], found.shapes[:, :count])


def _held_solve(structure: Structure, rows: Array, shift: float) -> Solve:
    """b -> x: (K + shift M) x + rows^T lambda = b, rows x = 0."""
    S = structure.K + shift * structure.M
    solve = factorize(S, "the shifted stiffness", solvers=structure.solvers)
    Y = solve(rows.T)
    back = np.linalg.inv(rows @ Y)

    def held_solve(b: Array) -> Array:
        x = solve(b)
        return np.asarray(x - Y @ (back @ (rows @ x)))

    return held_solve


def _beside(structure: Structure, solve: Solve, shapes: Array) -> Solve:
    """The solution without its parts along the shapes (n_u, m) of modes."""
    weights = (structure.M @ shapes).T

    def solve_beside(b: Array) -> Array:
        x = solve(b)
        return np.asarray(x - shapes @ (weights @ x))

    return solve_beside


def _lanczos(structure: Structure, solve: Solve, count: int, shift: float) -> HeldModes:
    inverse = LinearOperator(structure.K.shape, matvec=solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(structure.n_u)
    squares, shapes = eigsh(structure.K, count, structure.M, sigma=-shift, OPinv=inverse, v0=start)
    order = np.argsort(squares)
    return HeldModes(squares[order], shapes[:, order])


def _merged(first: HeldModes, second: HeldModes) -> HeldModes:
    squares = np.concatenate([first.squares, second.squares])
    order = np.argsort(squares)
    return HeldModes(squares[order], np.hstack([first.shapes, second.shapes])[:, order])
