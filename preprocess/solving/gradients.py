"""Conjugate gradients for many right-hand sides at once: single precision, refined in double."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from ..errors import MethodError
from .loops import WIDTH, Loops, Panel, with_loops
from .panels import Blocks

WINDOW = 3
"""Steps at least, a sixth of all beyond, whose gain of energy tells how fast the error falls."""
SLOWEST = 0.999
"""Ratio of the gains of two windows, at most: more says nothing of what is to come."""
SINGLE = 1e-3
"""Relative error in energy that single precision reaches, whatever the matrix of a body."""
MOST = 1000
"""Steps after which conjugate gradients give up: where a matrix takes more, as that of elements
1:250 flat, what is left is underestimated.
"""
SAFETY = 0.5
"""Share of the accuracy that is aimed at, for what is left is estimated."""
REFINEMENTS = 8
"""Solutions at most, each of what the ones before have left."""


class Preconditioner(Protocol):
    """Z = T R for a panel R, with T symmetric, positive definite, and near to S^-1; R . Z (16,)."""

    def __call__(self, R: Panel, Z: Panel, loops: Loops) -> Array: ...


@dataclass(eq=False)
class ConjugateGradients:
    """x = solve(b) with S x = b for S = K + s M, symmetric and positive definite; b (n_u, k).

    blocks: S in single precision; product: S X in double. accuracy: of x, relative, in the norm of
    the energy x^T S x; what b^T S^-1 b is taken for, errs by the square of it. precondition: by the
    blocks on the diagonal of S, unless another is given. iterations: steps of each solution so far,
    those of all panels and refinements. `MethodError` if it does not converge.

    The gain of energy of a step, alpha r^T z, is what it takes off the square of the error; the
    gains of two windows of steps give the rate, and so what is left. Source: M. R. Hestenes, E.
    Stiefel, J. Res. Nat. Bur. Standards 49 (1952) 409-436; Z. Strakos, P. Tichy, Electron. Trans.
    Numer. Anal. 13 (2002) 56-80.
    """

    name: str
    blocks: Blocks
    product: Callable[[Array], Array]
    accuracy: float
    precondition: Preconditioner | None = None
    iterations: list[int] = field(default_factory=list)

    def __call__(self, b: Array) -> Array:
        B = b.reshape(len(b), -1)
        X, taken = np.zeros_like(B), 0
        enough = before = np.zeros(B.shape[1])
        residual, missed = B, 0.0
        for turn in range(REFINEMENTS):
            found = self._in_single(residual, enough)
            X += found.X
            taken += found.steps
            residual = B - self.product(X)
            # Single precision takes directions for stiffer than they are: x (S~ - S) x.
            energy_missed = np.abs(np.einsum("ik,ik->k", found.X, residual))
            missed = max(missed, *_share(energy_missed, found.energy, found.energy > enough))
            if turn == 0:
                enough = (SAFETY * self.accuracy) ** 2 * found.energy
            elif missed < 1.0:
                # Solutions to come are in geometric progression: by what this one found of what the
                # one before has left, and along what single precision has missed most, by that.
                rate = np.sqrt(_share(found.energy, before, before > 0.0))
                series = np.divide(rate, 1.0 - rate, out=np.full_like(rate, np.inf), where=rate < 1)
                coming = series**2 * found.energy
                left = [found.left, coming, missed / (1.0 - missed) * energy_missed]
                if (np.max(left, axis=0) <= enough).all():
                    self.iterations.append(taken)
                    return X.reshape(b.shape)
            before = found.energy
        raise given_up(self.name, len(b), f"{REFINEMENTS} solutions in single precision")

    def _in_single(self, B: Array, enough: Array) -> "_Found":
        """The solution up to an error of `SINGLE`, or a square of it of `enough` (k,)."""
        sizes = np.abs(B).max(axis=0)
        unit = np.where(sizes > 0.0, sizes, 1.0)
        squared = unit**2 / self.blocks.scale
        goals = _in_panels(enough / squared)
        panels = zip(self.blocks.panels(B / unit), goals, strict=True)
        found = with_loops(lambda loops: [self._panel(R, goal, loops) for R, goal in panels])
        k = B.shape[1]
        X = self.blocks.vectors([panel.X for panel in found], k) * (unit / self.blocks.scale)
        energy, left = (
            np.concatenate([getattr(panel, name) for panel in found])[:k] * squared
            for name in ("energy", "left")
        )
        return _Found(X, energy, left, sum(panel.steps for panel in found))

    def _panel(self, R: Panel, enough: Array, loops: Loops) -> "_Found":
        """The solution for the vectors of one panel R, which is used up."""
        S, precondition = self.blocks, self.precondition or self.blocks.solve_diagonal
        X, Y, Z = np.zeros_like(R), np.empty_like(R), np.empty_like(R)
        relative = max(SINGLE, SAFETY * self.accuracy) ** 2
        remaining = first = precondition(R, Z, loops)
        P = Z.copy()
        gains: list[Array] = []
        while len(gains) < MOST:
            energies = S.multiply(P, Y, loops)
            if not_positive(energies, remaining, first).any():
                raise given_up(self.name, S.n_u, "the digits of single precision")
            step = _ratio(remaining, energies)
            loops.run("advance", S.n_nodes, step, P, Y, X, R)
            gains.append(step * remaining)
            energy, left = np.sum(gains, axis=0), energy_left(gains)
            if (left <= np.maximum(enough, relative * energy)).all():
                trusted = np.maximum(left, (SAFETY * SINGLE) ** 2 * energy)
                return _Found(X, energy, trusted, len(gains))
            before, remaining = remaining, precondition(R, Z, loops)
            loops.run("turn", S.n_nodes, _ratio(remaining, before), Z, P)
        raise given_up(self.name, S.n_u, f"{MOST} steps of conjugate gradients")


def not_positive(energies: Array, remaining: Array, first: Array) -> NDArray[np.bool_]:
    """Which directions a matrix gives no energy P^T S P (k,), though their solutions have not come
    to rounding yet: it is not positive definite.
    """
    return ~(energies > 0.0) & ~(np.abs(remaining) <= SINGLE**4 * np.abs(first))


class NotConvergedError(MethodError):
    """Conjugate gradients that do not reach their accuracy."""


def given_up(name: str, n_u: int, after: str) -> NotConvergedError:
    """The error where something is not enough to solve with the matrix `name`."""
    return NotConvergedError(
        f"{name} ({n_u} unknowns): {after} are not enough: the body is a mechanism, its elements "
        'far too flat, or the step too long; try impulse.solver = "factor"'
    )


@dataclass(frozen=True, eq=False)
class _Found:
    """Solutions, their energies and the squares of their errors in energy (k,), and the steps."""

    X: Any
    energy: Array
    left: Array
    steps: int


def _share(a: Array, b: Array, where: NDArray[np.bool_]) -> Array:
    """a / b (k,), zero elsewhere."""
    return np.divide(a, b, out=np.zeros_like(a), where=where)


def _ratio(a: Array, b: Array) -> Panel:
    """a / b (16,), zero where nothing is left."""
    return _share(a, b, b > 0.0).astype(np.float32)


def energy_left(gains: list[Array]) -> Array:
    """The square of the error in energy (k,) that is left, by the rate of the last gains."""
    window = max(WINDOW, len(gains) // 6)
    if len(gains) < 2 * window:
        return np.where(gains[-1] > 0.0, np.inf, 0.0)
    last = np.sum(gains[-window:], axis=0)
    one = np.sum(gains[-2 * window : -window], axis=0)
    rate = np.minimum(np.divide(last, one, out=np.zeros_like(one), where=one > 0.0), SLOWEST)
    left: Array = last * rate / (1.0 - rate)
    return left


def _in_panels(values: Array) -> Array:
    """Numbers (k,) of vectors by panel (n, 16), zeros behind the last."""
    found = np.zeros(-(-len(values) // WIDTH) * WIDTH)
    found[: len(values)] = values
    return found.reshape(-1, WIDTH)
