"""One number of a motion, as a study file asks for it: REDUCTION QUANTITY or REDUCTION |QUANTITY|.

    max |displacement:beam.tip:hub.rim:y|        final angle:hub:z        peak-to-peak energy:balance

Bars take the magnitude, of a vector its length. Quantities are those of `duhamel plot`.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..superelement.validation import Array
from ..view import QuantityError, Recording, curves
from ..view.quantities import AXES, KINDS
from .errors import StudyError


def _mean(time: Array, values: Array) -> float:
    """Over time, by trapezoids."""
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))


REDUCTIONS: dict[str, Callable[[Array, Array], float]] = {
    "max": lambda time, values: float(values.max()),
    "min": lambda time, values: float(values.min()),
    "final": lambda time, values: float(values[-1]),
    "mean": _mean,
    "peak-to-peak": lambda time, values: float(np.ptp(values)),
}


def values(recording: Recording, outputs: Mapping[str, str]) -> dict[str, float]:
    """The outputs by name, in SI units; `StudyError` names one that is none, or of what the
    recording does not have.
    """
    return {name: _told(name, _value, recording, output) for name, output in outputs.items()}


def check(recording: Recording, outputs: Mapping[str, str]) -> None:
    """Raise what `values` would raise."""
    for name, output in outputs.items():
        _told(name, _components, recording, output)


def _told(
    name: str, function: Callable[[Recording, str], Any], recording: Recording, output: str
) -> Any:
    try:
        return function(recording, output)
    except (StudyError, QuantityError) as error:
        raise StudyError(f"outputs.{name}: {error}") from error


def _value(recording: Recording, output: str) -> float:
    reduction, _, magnitude = _parts(output)
    components = _components(recording, output)
    values = np.linalg.norm(components, axis=0) if magnitude else components[0]
    return REDUCTIONS[reduction](recording.time, values)


def _components(recording: Recording, output: str) -> list[Array]:
    return [curve.values for curve in curves(recording, _parts(output)[1])]


def _parts(output: str) -> tuple[str, str, bool]:
    """Reduction, quantity, and whether its magnitude is meant."""
    match = re.fullmatch(r"\s*(\S+)\s+(\|?)([^\s|]+)(\|?)\s*", output)
    if match is None or match[1] not in REDUCTIONS or match[2] != match[4]:
        raise StudyError(
            f"expected REDUCTION QUANTITY or REDUCTION |QUANTITY| with one of {', '.join(REDUCTIONS)}, found {output!r}"
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
            f"{output!r} is of a vector: expected an axis, {quantity}:x, or its length, |{quantity}|"
        )
    return reduction, quantity, magnitude
