"""Conjugate gradients in single precision for many right-hand sides, refined in double."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ...superelement.validation import Array
from .gradients import MAX_CG_STEPS, Goal, converge, given_up, ratio
from .loops import PANEL_WIDTH, Panel
from .multigrid import Multigrid
from .panels import Blocks, PanelSystem

SINGLE_PRECISION_ERROR = 1e-3
"""Relative error in energy that single precision reaches, whatever the matrix of a body."""
SHARE_OF_ACCURACY = 0.5  # what is aimed at, for what is left is estimated
MAX_REFINEMENTS = 8  # solutions, each of what the ones before have left


@dataclass(eq=False)
class RefinedGradients:
    """x = solve(b) with S x = b for S = K + s M, symmetric and positive definite; b (n_u, k).

    blocks: S in single precision; product: S X in double. accuracy: of x, relative, in the norm of
    the energy x^T S x; what b^T S^-1 b is taken for, errs by the square of it. Preconditioned by
    the blocks on the diagonal of S, unless there is multigrid. iterations: steps of each solution
    so far, those of all panels and refinements. `NotConvergedError` if it does not converge.
    """

    name: str
    blocks: Blocks
    product: Callable[[Array], Array]
    accuracy: float
    multigrid: Multigrid[Panel] | None = None
    max_steps: int = MAX_CG_STEPS
    iterations: list[int] = field(default_factory=list)

    def __call__(self, b: Array) -> Array:
        B = b.reshape(len(b), -1)
        X, taken = np.zeros_like(B), 0
        enough = before = np.zeros(B.shape[1])
        residual, missed = B, 0.0
        for turn in range(MAX_REFINEMENTS):
            new, energy, error, steps = self._in_single(residual, enough)
            X += new
            taken += steps
            residual = B - self.product(X)
            # Single precision takes directions for stiffer than they are: x (S~ - S) x.
            energy_missed = np.abs(np.einsum("ik,ik->k", new, residual))
            counted = np.where(energy > enough, energy_missed, 0.0)
            missed = max(missed, *ratio(counted, energy))
            if turn == 0:
                enough = (SHARE_OF_ACCURACY * self.accuracy) ** 2 * energy
            elif missed < 1.0:
                # Solutions to come are in geometric progression: by what this one found of what the
                # one before has left, and along what single precision has missed most, by that.
                rate = np.sqrt(ratio(energy, before))
                series = np.divide(rate, 1.0 - rate, out=np.full_like(rate, np.inf), where=rate < 1)
                coming = series**2 * energy
                left = [error, coming, missed / (1.0 - missed) * energy_missed]
                if (np.max(left, axis=0) <= enough).all():
                    self.iterations.append(taken)
                    return X.reshape(b.shape)
            before = energy
        raise given_up(self.name, len(b), f"{MAX_REFINEMENTS} solutions in single precision")

    def _in_single(self, B: Array, enough: Array) -> tuple[Array, Array, Array, int]:
        """The solution up to `SINGLE_PRECISION_ERROR`, or a square of the error of `enough` (k,);
        its energy, the square of its error in energy (k,), and the steps.
        """
        sizes = np.abs(B).max(axis=0)
        unit = np.where(sizes > 0.0, sizes, 1.0)
        squared = unit**2 / self.blocks.scale
        relative = max(SINGLE_PRECISION_ERROR, SHARE_OF_ACCURACY * self.accuracy)
        goal = Goal(self.name, self.blocks.n_u, relative, self.max_steps)
        allowed = np.pad(enough / squared, (0, -B.shape[1] % PANEL_WIDTH)).reshape(-1, PANEL_WIDTH)
        panels = zip(self.blocks.panels(B / unit), allowed, strict=True)
        system = PanelSystem(self.blocks, self.multigrid)
        found = [converge(system, R, goal, squares) for R, squares in panels]
        k = B.shape[1]
        X = self.blocks.vectors([panel.X for panel in found], k) * (unit / self.blocks.scale)
        energy, left = (
            np.concatenate([getattr(panel, name) for panel in found])[:k] * squared
            for name in ("energy", "left")
        )
        trusted = np.maximum(left, (SHARE_OF_ACCURACY * SINGLE_PRECISION_ERROR) ** 2 * energy)
        return X, energy, trusted, sum(len(panel.gains) for panel in found)
