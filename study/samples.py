"""Sampled designs: points in a space of parameters, each with a distribution of its own."""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Literal

import numpy as np
from pydantic import Field

from ..files.arrays import Array
from ..inputs import Table, dotted, quoted
from .errors import StudyError
from .keys import leaves

MOST_CASES = 100_000
# Half the spacing of numbers below 1: probabilities of 0 and 1 would give infinite values.
MIN_TAIL_PROBABILITY = 2.0**-53


class Design(Table):
    """The table [design]: how many points, and how they fill the ranges of the parameters."""

    type: Literal["latin-hypercube", "sobol", "random"] = "latin-hypercube"
    samples: int = Field(ge=1, le=MOST_CASES)
    seed: int = Field(default=0, ge=0)


Quantile = Callable[[float, float, Array], Array]
"""values (n,) that a distribution with two numbers has at probabilities (n,)"""


def _uniform(low: float, high: float, p: Array) -> Array:
    return low + (high - low) * p


def _log_uniform(low: float, high: float, p: Array) -> Array:
    """Uniform in the logarithm, within the ends also after rounding."""
    return np.clip(low * (high / low) ** p, low, high)


def _normal(mean: float, deviation: float, p: Array) -> Array:
    from scipy.special import ndtri

    values: Array = mean + deviation * ndtri(
        np.clip(p, MIN_TAIL_PROBABILITY, 1.0 - MIN_TAIL_PROBABILITY)
    )
    return values


DISTRIBUTIONS: dict[str, Quantile] = {
    "uniform": _uniform,
    "log_uniform": _log_uniform,
    "normal": _normal,
}
EXPECTED_PARAMETERS = {
    "uniform": "two numbers that rise",
    "log_uniform": "two positive numbers that rise",
    "normal": "a mean and a positive standard deviation",
}


def sampled(parameters: Mapping[str, Any], design: Design) -> Iterator[dict[str, Any]]:
    """The values of all parameters by dotted key, for each point of a design.

    A parameter has a distribution, {uniform = [low, high]}, {log_uniform = [low, high]} or {normal
    = [mean, deviation]}, or a list of values of equal probability. More points of a Sobol or
    random design leave those before as they are. `StudyError` names a key.
    """
    axes = [_axis(key, value) for key, value in leaves(parameters)]
    if not axes:
        raise StudyError("parameters: expected distributions by dotted key, found none")
    keys = [key for key, _ in axes]
    if repeated := {key for key in keys if keys.count(key) > 1}:
        raise StudyError(
            f"parameters.{dotted([min(repeated)])}: expected one distribution, found several"
        )
    points = _points(design, len(axes))
    columns = [values_of(p) for (_, values_of), p in zip(axes, points.T, strict=True)]
    for row in zip(*columns, strict=True):
        yield dict(zip(keys, row, strict=True))


def is_distribution(key: str, value: Any) -> bool:
    """Whether the last part of a dotted key is no key but a distribution: of two numbers."""
    return key.rpartition(".")[2] in DISTRIBUTIONS and (
        isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))
    )


def _axis(key: str, value: Any) -> tuple[str, Callable[[Array], list[Any]]]:
    """A parameter, and its values at probabilities (n,)."""
    if not isinstance(value, list) or not value:
        raise StudyError(
            f"parameters.{dotted([key])}: expected one of {', '.join(DISTRIBUTIONS)}, "
            f"or a list of values, found {quoted(value)}"
        )
    if not is_distribution(key, value):
        return key, lambda p: [value[i] for i in np.floor(len(value) * p).astype(int)]
    key, name, first, second = distribution_of(key, value)
    return key, lambda p: DISTRIBUTIONS[name](first, second, p).tolist()


def distribution_of(key: str, value: Any) -> tuple[str, str, float, float]:
    """The key of a parameter, the name of its distribution, and the two numbers of that."""
    key, _, name = key.rpartition(".")
    if not _is_valid(name, *value):
        raise StudyError(
            f"parameters.{dotted([key])}.{name}: expected {EXPECTED_PARAMETERS[name]}, found "
            f"{value}"
        )
    first, second = map(float, value)
    return key, name, first, second


def _is_valid(name: str, first: float, second: float) -> bool:
    if not (math.isfinite(first) and math.isfinite(second)):
        return False
    if name == "normal":
        return second > 0.0
    return first < second and (name == "uniform" or first > 0.0)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _points(design: Design, dimensions: int) -> Array:
    """Points (samples, dimensions) in the unit cube, from the seed alone."""
    generator = np.random.default_rng(design.seed)
    if design.type == "random":
        return generator.random((design.samples, dimensions))
    # Import here: takes a second.
    from scipy.stats import qmc

    engines: Mapping[str, Any] = {"sobol": qmc.Sobol, "latin-hypercube": qmc.LatinHypercube}
    with warnings.catch_warnings():
        # A number of points that is no power of two leaves Sobol's a little out of balance.
        warnings.simplefilter("ignore", UserWarning)
        points: Array = engines[design.type](dimensions, seed=generator).random(design.samples)
    return points
