"""Conjugate gradients for many right-hand sides at once, in single precision, refined in double."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..errors import MethodError
from ..threads import threads
from .panels import PIECES, WIDTH, Blocks, Panel, in_blocks, kernels

WINDOW = 8
"""Steps whose gain of energy tells how fast the error falls."""
SLOWEST = 0.999
"""Ratio of the gains of two windows, at most: more says nothing of what is to come."""
SINGLE = 1e-5
"""Relative error in energy that single precision reaches with room to spare."""
MOST = 5000
"""Steps after which conjugate gradients give up."""
REFINEMENTS = 8
"""Solutions at most, each of what the ones before have left."""


@dataclass(eq=False)
class ConjugateGradients:
    """x = solve(b) with S x = b for S = K + s M, symmetric and positive definite; b (n_u, k).

    accuracy: of x, relative, in the norm of the energy x^T S x. What b^T S^-1 b is taken for, errs
    by the square of it. iterations: those of each solution so far.

    The gain of energy of a step, alpha r^T D^-1 r, is what it takes off the square of the error;
    the gains of two windows of steps give the rate, and so what is left. Source: M. R. Hestenes,
    E. Stiefel, J. Res. Nat. Bur. Standards 49 (1952) 409-436; Z. Strakos, P. Tichy, Electron.
    Trans. Numer. Anal. 13 (2002) 56-80.
    """

    K: Any
    M: Any
    shift: float
    accuracy: float
    iterations: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.blocks = in_blocks(self.K, self.M, self.shift)

    def __call__(self, b: Array) -> Array:
        B = b.reshape(len(b), -1)
        X, left, taken = np.zeros_like(B), B, 0
        accuracy = self.accuracy
        for _ in range(REFINEMENTS):
            found, steps = self._single(left, max(accuracy, SINGLE))
            X += found
            taken += steps
            if accuracy >= SINGLE:
                break
            accuracy /= SINGLE
            left = B - (self.K @ X + self.shift * (self.M @ X))
        self.iterations.append(taken)
        return X.reshape(b.shape)

    def _single(self, B: Array, accuracy: float) -> tuple[Array, int]:
        """x in single precision, and the number of steps that it took."""
        sizes = np.abs(B).max(axis=0)
        unit = np.where(sizes > 0.0, sizes, 1.0)
        with ThreadPoolExecutor(threads()) as pool:
            solved = [
                _Panel(self.blocks, panel, pool).solve(accuracy)
                for panel in self.blocks.panels(B / unit)
            ]
        panels, steps = zip(*solved, strict=True)
        X = self.blocks.vectors(list(panels), B.shape[1]) * (unit / self.blocks.scale)
        return X, sum(steps)


class _Panel:
    """Conjugate gradients for the vectors of one panel."""

    def __init__(self, blocks: Blocks, B: Panel, pool: ThreadPoolExecutor) -> None:
        self._blocks, self._pool = blocks, pool
        edges = np.linspace(0, blocks.n_nodes, PIECES * threads() + 1).astype(int).tolist()
        self._pieces = list(zip(edges[:-1], edges[1:], strict=True))
        self._R, self._X, self._P, self._Y = B, np.zeros_like(B), np.zeros_like(B), np.zeros_like(B)

    def solve(self, accuracy: float) -> tuple[Panel, int]:
        S, do = self._blocks, kernels()
        X, R, P, Y = self._X, self._R, self._P, self._Y
        none = np.zeros(WIDTH, dtype=np.float32)
        left = self._sums(do.step, none, P, Y, X, R, S.inverses)
        self._all(do.turn, none, R, S.inverses, P)
        gains: list[Array] = []
        while len(gains) < MOST:
            curvature = self._sums(do.multiply, S.first, S.columns, S.blocks, P, Y)
            alpha = _ratio(left, curvature)
            before = left
            left = self._sums(do.step, alpha, P, Y, X, R, S.inverses)
            gains.append(alpha * before)
            if _converged(gains, accuracy):
                return X, len(gains)
            self._all(do.turn, _ratio(left, before), R, S.inverses, P)
        raise MethodError("no convergence")

    def _all(self, kernel: Callable[..., None], *arguments: Any) -> None:
        list(self._pool.map(lambda piece: kernel(*arguments, *piece), self._pieces))

    def _sums(self, kernel: Callable[..., None], *arguments: Any) -> Array:
        """What a kernel adds up over all nodes (16,)."""
        sums = np.zeros((len(self._pieces), WIDTH))
        self._all_with(kernel, sums, arguments)
        total: Array = sums.sum(axis=0)
        return total

    def _all_with(self, kernel: Callable[..., None], sums: Array, arguments: Any) -> None:
        jobs = zip(sums, self._pieces, strict=True)
        list(self._pool.map(lambda job: kernel(*arguments, job[0], *job[1]), jobs))


def _ratio(a: Array, b: Array) -> Array:
    """a / b (16,), zero where nothing is left."""
    found: Array = np.divide(a, b, out=np.zeros(WIDTH), where=b > 0.0)
    return found.astype(np.float32)


def _converged(gains: list[Array], accuracy: float) -> bool:
    """Whether what is left of the energy of every vector is below the square of the accuracy."""
    if len(gains) < 2 * WINDOW or len(gains) % 2:
        return False
    last, one = (np.sum(gains[-n * WINDOW :][:WINDOW], axis=0) for n in (1, 2))
    rate = np.minimum(np.divide(last, one, out=np.zeros(WIDTH), where=one > 0.0), SLOWEST)
    left = last * rate / (1.0 - rate)
    return bool((left <= accuracy**2 * np.sum(gains, axis=0)).all())
