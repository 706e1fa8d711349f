"""The exceptions of the solver, one per kind of failure."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..results.errors import RecoveryError, ResultsError

__all__ = [
    "ConvergenceError",
    "MissedContactError",
    "ModelError",
    "OutOfRangeError",
    "RecoveryError",
    "ResultsError",
    "StateError",
    "ValidityWarning",
    "about",
    "plain",
]


class ModelError(ValueError):
    """A model that contradicts itself; the message names the body, joint or load."""


class DerivativeError(ValueError):
    """A run or a parameter without derivatives by dual numbers; the message says why."""


class StateError(ValueError):
    """A state that a run cannot continue from: damaged, or of another model, version or machine.

    The message names what differs.
    """


class ConvergenceError(RuntimeError):
    """Newton's method did not converge in a time step.

    Parameters
    ----------
    step : int
    time : float [s]
    residual, tolerance : float
        Of equilibrium and constraints, both relative.
    worst : (str, float)
        The joint that is farthest open, "" if none is, and by how much [m or rad].
    model : str
        The model file.
    cause : str
        The likely one, where one is known.
    """

    def __init__(
        self,
        step: int,
        time: float,
        residual: float,
        tolerance: float,
        worst: tuple[str, float],
        model: str = "",
        cause: str = "",
    ) -> None:
        self.step, self.time, self.residual = step, time, residual
        self.joint, self.opening = worst
        where = f"{model}: " if model else ""
        opening = f"; the most open joint is {self.joint!r}, by {self.opening:.3e}"
        opening = opening if self.joint else ""
        super().__init__(
            f"{where}no convergence in step {step} (t = {time:.9g} s): relative residual "
            f"{residual:.3e}, tolerance {tolerance:.1e}{opening}; "
            + (f"likely cause: {cause}" if cause else "try a smaller step in [simulation]")
        )


class OutOfRangeError(RuntimeError):
    """A flexible body has left the range of linear elasticity so far that the run has no meaning.

    Parameters
    ----------
    step : int
    time : float [s]
    interface : str
        "BODY.FRAME".
    reason : str
    model : str
        The model file.
    """

    def __init__(self, step: int, time: float, interface: str, reason: str, model: str) -> None:
        self.step, self.time, self.interface = step, time, interface
        where = f"{model}: " if model else ""
        super().__init__(f"{where}stopped in step {step} (t = {time:.9g} s): {reason}")


class MissedContactError(RuntimeError):
    """A contact that steps are too long for.

    A ball, or a surface, passed through its target within one step; or surfaces that touched for
    fewer than 8 steps have created energy.

    Parameters
    ----------
    step : int
    time : float [s]
    contact, reason : str
    model : str
        The model file.
    """

    def __init__(self, step: int, time: float, contact: str, reason: str, model: str) -> None:
        self.step, self.time, self.contact = step, time, contact
        where = f"{model}: " if model else ""
        super().__init__(
            f"{where}contact {contact!r}: stopped in step {step} (t = {time:.9g} s): {reason}"
        )


class ValidityWarning(UserWarning):
    """A run has passed a limit of the method (`Results.validity`)."""


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


class ForeignError(Exception):
    """A function of a user that cannot be compiled, or returns something else than it should."""
