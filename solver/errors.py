"""The exceptions of the solver, one per kind of failure."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..results.errors import RecoveryError, ResultsError

__all__ = ["ConvergenceError", "ModelError", "RecoveryError", "ResultsError", "about", "plain"]


class ModelError(ValueError):
    """A model that contradicts itself; the message names the body, joint or load."""


class ConvergenceError(RuntimeError):
    """Newton's method did not converge in a time step.

    step, time [s]; residual: of equilibrium and constraints, relative as the tolerance is; joint:
    the name of the joint with the largest opening, `opening` [m or rad]; model: the name of its
    file.
    """

    def __init__(
        self,
        step: int,
        time: float,
        residual: float,
        tolerance: float,
        joint: str,
        opening: float,
        model: str = "",
    ) -> None:
        self.step, self.time, self.residual = step, time, residual
        self.joint, self.opening = joint, opening
        where = f"{model}: " if model else ""
        worst = f"; the most open joint is {joint!r}, by {opening:.3e}" if joint else ""
        super().__init__(
            f"{where}no convergence in step {step} (t = {time:.9g} s): relative residual "
            f"{residual:.3e}, tolerance {tolerance:.1e}{worst}; try a smaller step"
        )


@contextmanager
def about(path: str | os.PathLike[str]) -> Iterator[None]:
    """Prefix the errors of a model with the file that it is from, if there is one."""
    try:
        yield
    except ModelError as error:
        if not os.fspath(path):
            raise
        raise ModelError(f"{path}: {error}") from error


def plain(value: Any) -> Any:
    """A value as messages quote it: arrays as lists."""
    return value.tolist() if isinstance(value, np.ndarray) else value
