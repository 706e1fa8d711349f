"""Conjugate gradients for many right-hand sides at once: single precision, refined in double."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ...superelement.validation import Array
from ..errors import MethodError
from ..threads import threads
from .loops import WIDTH, Loops, Panel
from .panels import Blocks

WINDOW = 8
"""Steps at least, an eighth of all beyond, whose gain of energy tells how fast the error falls."""
SLOWEST = 0.999
"""Ratio of the gains of two windows, at most: more says nothing of what is to come."""
SINGLE = 1e-3
"""Relative error in energy that single precision reaches, whatever the matrix of a body."""
MOST = 5000
"""Steps after which conjugate gradients give up."""
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
    blocks on the diagonal of S, unless another is given. iterations: those of each solution so far.
    `MethodError` if it does not converge.

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
        X, left, taken, accuracy = np.zeros_like(B), B, 0, self.accuracy
        for _ in range(REFINEMENTS):
            found, steps = self._in_single(left, max(accuracy, SINGLE))
            X += found
            taken += steps
            if accuracy >= SINGLE:
                break
            accuracy /= SINGLE
            left = B - self.product(X)
        self.iterations.append(taken)
        return X.reshape(b.shape)

    def _in_single(self, B: Array, accuracy: float) -> tuple[Array, int]:
        """x in single precision, and the number of steps that it took."""
        sizes = np.abs(B).max(axis=0)
        unit = np.where(sizes > 0.0, sizes, 1.0)
        with ThreadPoolExecutor(threads()) as pool:
            loops = Loops(pool)
            solved = [self._panel(R, accuracy, loops) for R in self.blocks.panels(B / unit)]
        panels, steps = zip(*solved, strict=True)
        X = self.blocks.vectors(list(panels), B.shape[1]) * (unit / self.blocks.scale)
        return X, sum(steps)

    def _panel(self, R: Panel, accuracy: float, loops: Loops) -> tuple[Panel, int]:
        """The solution for the vectors of one panel R, which is used up, and the number of steps."""
        S, precondition = self.blocks, self.precondition or self.blocks.solve_diagonal
        X, Y, Z = np.zeros_like(R), np.empty_like(R), np.empty_like(R)
        left = precondition(R, Z, loops)
        P = Z.copy()
        gains: list[Array] = []
        while len(gains) < MOST:
            step = _ratio(left, S.multiply(P, Y, loops))
            loops.run("advance", S.n_nodes, step, P, Y, X, R)
            gains.append(step * left)
            if _converged(gains, accuracy):
                return X, len(gains)
            before, left = left, precondition(R, Z, loops)
            loops.run("turn", S.n_nodes, _ratio(left, before), Z, P)
        raise MethodError(
            f"{self.name} ({S.n_u} unknowns): {MOST} steps of conjugate gradients are not enough: "
            "the body is a mechanism, its elements far too flat, or the step too long; try "
            'impulse.solver = "factor"'
        )


def _ratio(a: Array, b: Array) -> Panel:
    """a / b (16,), zero where nothing is left."""
    found: Array = np.divide(a, b, out=np.zeros(WIDTH), where=b > 0.0)
    return found.astype(np.float32)


def _converged(gains: list[Array], accuracy: float) -> bool:
    """Whether what is left of the energy of every vector is below the square of the accuracy."""
    window = max(WINDOW, len(gains) // 8)
    if len(gains) < 2 * window:
        return not gains[-1].any()
    last = np.sum(gains[-window:], axis=0)
    one = np.sum(gains[-2 * window : -window], axis=0)
    rate = np.minimum(np.divide(last, one, out=np.zeros(WIDTH), where=one > 0.0), SLOWEST)
    left = last * rate / (1.0 - rate)
    return bool((left <= accuracy**2 * np.sum(gains, axis=0)).all())
