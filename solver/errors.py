"""What can go wrong, one exception per kind of failure."""

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

    step, time [s]; residual: of equilibrium and constraints, relative to what the tolerance is
    measured against; joint: the name of the joint that is most open, `opening` [m or rad] how far;
    model: the name of its file.
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
        self.step, self.time, self.residual, self.joint, self.opening = (
            step,
            time,
            residual,
            joint,
            opening,
        )
        where = f"{model}: " if model else ""
        worst = f"; the most open joint is {joint!r}, by {opening:.3e}" if joint else ""
        super().__init__(
            f"{where}no convergence in step {step} (t = {time:.9g} s): relative residual {residual:.3e}, "
            f"tolerance {tolerance:.1e}{worst}; try a smaller step"
        )


@contextmanager
def about(path: str | os.PathLike[str]) -> Iterator[None]:
    """Errors of a model name the file that it is from, if there is one."""
    try:
        yield
    except ModelError as error:
        if not os.fspath(path):
            raise
        raise ModelError(f"{path}: {error}") from error


def plain(value: Any) -> Any:
    """A value as messages quote it: arrays as lists."""
    return value.tolist() if isinstance(value, np.ndarray) else value
