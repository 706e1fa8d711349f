"""Numbers of a motion, as study files ask for them: REDUCTION QUANTITY or REDUCTION |QUANTITY|.

    max |displacement:beam.tip:hub.rim:y|       final angle:hub:z       peak-to-peak energy:balance

Bars take the magnitude, of a vector its length. Quantities are those of `duhamel plot`.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..results import QuantityError, Results
from ..results.quantities import AXES, KINDS, evaluate
from ..superelement.validation import Array
from .errors import StudyError


def _mean(time: Array, samples: Array) -> float:
    """The mean over time, by trapezoids; of a single sample, that one."""
    if len(time) == 1:
        return float(samples[0])
    return float(np.trapezoid(samples, time) / (time[-1] - time[0]))


REDUCTIONS: dict[str, Callable[[Array, Array], float]] = {
    "max": lambda time, samples: float(samples.max()),
    "min": lambda time, samples: float(samples.min()),
    "final": lambda time, samples: float(samples[-1]),
    "mean": _mean,
    "peak-to-peak": lambda time, samples: float(np.ptp(samples)),
}


def values(results: Results, outputs: Mapping[str, str]) -> dict[str, float]:
    """The outputs by name, in SI units.

    `StudyError` names one that is invalid, or of a quantity that the results do not have.
    """
    return {name: _named(name, _value, results, output) for name, output in outputs.items()}


def check(results: Results, outputs: Mapping[str, str]) -> None:
    """Raise what `values` would raise."""
    for name, output in outputs.items():
        _named(name, _components, results, output)


def _named(
    name: str, function: Callable[[Results, str], Any], results: Results, output: str
) -> Any:
    try:
        return function(results, output)
    except (StudyError, QuantityError) as error:
        raise StudyError(f"outputs.{name}: {error}") from error


def _value(results: Results, output: str) -> float:
    reduction, _, magnitude = _parsed(output)
    components = _components(results, output)
    if magnitude and components.ndim > 1:
        return REDUCTIONS[reduction](results.time, np.linalg.norm(components, axis=1))
    if magnitude:
        components = np.abs(components)
    return REDUCTIONS[reduction](results.time, components)


def _components(results: Results, output: str) -> Array:
    """The values (n,) or (n, 3) of the quantity."""
    return evaluate(results, _parsed(output)[1]).values


def _parsed(output: str) -> tuple[str, str, bool]:
    """Reduction, quantity, and True if its magnitude is meant."""
    match = re.fullmatch(r"\s*(\S+)\s+(\|?)([^\s|]+)(\|?)\s*", output)
    if match is None or match[1] not in REDUCTIONS or match[2] != match[4]:
        raise StudyError(
            f"expected REDUCTION QUANTITY or REDUCTION |QUANTITY| with one of "
            f"{', '.join(REDUCTIONS)}, found {output!r}"
        )
    reduction, magnitude, quantity = match[1], bool(match[2]), match[3]
    kind, *names = quantity.split(":")
    if (
        not magnitude
        and kind in KINDS
        and KINDS[kind].axes
        and names[-1:] not in [[axis] for axis in AXES]
    ):
        raise StudyError(
            f"{output!r} is of a vector: "
            f"expected an axis, {quantity}:x, or its length, |{quantity}|"
        )
    return reduction, quantity, magnitude
