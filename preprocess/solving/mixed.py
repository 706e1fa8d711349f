"""A factor in single precision with conjugate gradients in double: half the memory and half the
time of a factor in double precision.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..threads import threads
from .gradients import given_up

MOST_STEPS = 12
"""Steps after which the factor is no preconditioner: two or three are taken by bodies of solids."""
SAFETY = 0.1
"""Share of the accuracy that is aimed at, for what is left is estimated."""
COLUMNS = 16
"""Solutions have multiples of so many columns, the last filled with zeros: rslab takes a fifth less
time for 16 than for 12.
"""
BYTES = 0.5
"""Of a factor in double precision."""
SECONDS = 0.55
"""Of a factor in double precision, with solutions of two steps."""


class MixedFactor:
    """x = solve(b) with S x = b for b (n_u, k), relative in energy to `accuracy`.

    factor: solves with S~, which is S as single precision has it. The error falls by some four
    digits a step, eps times the square root of the condition: the gain of energy of a step is the
    square of the error before it, and two of them give the rate, of which half the digits count:
    the first steps gain most. `NotConvergedError` where it does not fall.
    """

    def __init__(
        self,
        name: str,
        product: Callable[[Array], Array],
        factor: Callable[[Array], Array],
        accuracy: float,
    ) -> None:
        self._name, self._product, self._factor = name, product, factor
        self._enough = (SAFETY * accuracy) ** 2
        self._errors: list[float] = []

    @property
    def first_error(self) -> float:
        """The largest error that a first step has left, relative in energy."""
        return max(self._errors, default=np.inf)

    def once(self, b: Array) -> Array:
        """S~^-1 b, half the work of a solution: right to about `first_error`."""
        return self._factor(b)

    def __call__(self, b: Array) -> Array:
        R = b.reshape(len(b), -1).copy()
        X, energy = np.zeros_like(R), np.zeros(R.shape[1])
        Z = self._factor(R)
        P, remaining = Z, _dots(R, Z)
        gain_before = np.full(R.shape[1], np.inf)
        first = np.zeros(R.shape[1])
        for number in range(MOST_STEPS):
            SP = self._product(P)
            step = _over(remaining, _dots(P, SP))
            X += step * P
            gain = step * remaining
            energy += gain
            if number == 0:
                first = gain
            left = gain * np.sqrt(_over(gain, gain_before))
            if number > 0 and (left <= self._enough * energy).all():
                self._errors.append(float(np.sqrt(_over(energy - first, energy)).max()))
                return X.reshape(b.shape)
            R -= step * SP
            Z = self._factor(R)
            before, remaining, gain_before = remaining, _dots(R, Z), gain
            P = Z + _over(remaining, before) * P
        raise given_up(self._name, len(b), f"{MOST_STEPS} steps with a factor in single precision")


def single_factor(S: Any) -> Callable[[Array], Array] | None:
    """Solutions with a sparse symmetric matrix as single precision has it, by rslab; None where
    that is not positive definite.
    """
    import rslab

    scale = float(S.diagonal().max())
    single = (S.tocsc() / scale).astype(np.float32)
    single.sort_indices()
    try:
        factor = rslab.analyze(single, path="ldlt", threads=threads()).factor(single)
    except RuntimeError:
        return None
    if any(factor.inertia[1:]):
        return None

    def solve(R: Array) -> Array:
        # Columns of length one: their squares are far from the ends of single precision.
        sizes = np.linalg.norm(R, axis=0)
        unit = np.where(sizes > 0.0, sizes, 1.0)
        n, k = R.shape
        filled = np.zeros((n, -(-k // COLUMNS) * COLUMNS), dtype=np.float32)
        np.divide(R, unit, out=filled[:, :k], casting="same_kind")
        found: Array = factor.solve_many(filled)[:, :k].astype(np.float64)
        found *= unit / scale
        return found

    return solve


def _dots(A: Array, B: Array) -> Array:
    products: Array = np.einsum("ik,ik->k", A, B)
    return products


def _over(a: Array, b: Array) -> Array:
    """a / b (k,), zero where there is nothing left."""
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)
