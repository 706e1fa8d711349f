"""Numbers of a motion, as study files ask for them: REDUCTION QUANTITY or REDUCTION |QUANTITY|.

    max |displacement:beam.tip:hub.rim:y|       final angle:hub:z       peak-to-peak energy:balance
    max event:stop:peak      min event:stop:steps      sum event:stop:impulse      count event:stop

Bars take the magnitude, of a vector its length. Quantities are those of `duhamel plot`, and the
numbers of the events of a contact or stop, counted at every step; what only whole contacts have is
taken of those alone. There is no number where nothing touched, but for sum and count.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..results import QuantityError, Results
from ..results.quantities import KINDS, evaluate
from ..results.schema import EVENTS
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


OF_EVENTS: dict[str, Callable[[Array], float]] = {
    "max": lambda samples: float(samples.max()),
    "min": lambda samples: float(samples.min()),
    "final": lambda samples: float(samples[-1]),
    "mean": lambda samples: float(samples.mean()),
    "peak-to-peak": lambda samples: float(np.ptp(samples)),
    "sum": lambda samples: float(samples.sum()),
    "count": lambda samples: float(len(samples)),
}
OF_NOTHING = ("sum", "count")
"""which also hold for no events"""
EVENT = "event"
COLUMNS = tuple(quantity.attribute for quantity in EVENTS)
ALWAYS_KNOWN = ("start", "peak", "impulse", "dissipated")
"""also of contacts that were closed at the start or at the end of the run"""


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
    reduction, quantity, magnitude = _parsed(output)
    components = _components(results, output)
    if _is_event(quantity):
        samples = np.abs(components) if magnitude else components
        known = len(samples) or reduction in OF_NOTHING
        return OF_EVENTS[reduction](samples) if known else float("nan")
    if magnitude and components.ndim > 1:
        return REDUCTIONS[reduction](results.time, np.linalg.norm(components, axis=1))
    if magnitude:
        components = np.abs(components)
    return REDUCTIONS[reduction](results.time, components)


def _components(results: Results, output: str) -> Array:
    """The values (n,) or (n, 3) of the quantity, or those of events (m,)."""
    quantity = _parsed(output)[1]
    return _events(results, quantity) if _is_event(quantity) else evaluate(results, quantity).values


def _is_event(quantity: str) -> bool:
    return quantity.partition(":")[0] == EVENT


def _events(results: Results, quantity: str) -> Array:
    """A number of each event, event:NAME:COLUMN; those that closed, event:NAME."""
    _, name, column, *more = [*quantity.split(":"), "", ""]
    owners = results.events
    if name not in owners:
        known = ", ".join(sorted(owners)) or "none"
        raise StudyError(f"{quantity}: no contact or stop {name!r}; there are: {known}")
    if any(more) or column not in ("", *COLUMNS):
        raise StudyError(
            f"{quantity}: expected {EVENT}:NAME or one of {EVENT}:NAME:COLUMN with "
            f"{', '.join(COLUMNS)}"
        )
    events = owners[name]
    samples: Array = getattr(events, column or "start")
    closed = events.closing_speed > 0.0
    if column in ALWAYS_KNOWN:
        return samples
    return samples[closed] if column in ("", "closing_speed") else samples[events.whole]


def _parsed(output: str) -> tuple[str, str, bool]:
    """Reduction, quantity, and True if its magnitude is meant."""
    match = re.fullmatch(r"\s*(\S+)\s+(\|?)([^\s|]+)(\|?)\s*", output)
    of_events = match is not None and _is_event(match[3])
    reductions = OF_EVENTS if of_events else REDUCTIONS
    if match is None or match[1] not in reductions or match[2] != match[4]:
        raise StudyError(
            f"expected REDUCTION QUANTITY or REDUCTION |QUANTITY| with one of "
            f"{', '.join(reductions)}, found {output!r}"
        )
    reduction, magnitude, quantity = match[1], bool(match[2]), match[3]
    kind, *names = quantity.split(":")
    if (
        not magnitude
        and kind in KINDS
        and KINDS[kind].axes
        and names[-1:] not in [[axis] for axis in KINDS[kind].axes]
    ):
        raise StudyError(
            f"{output!r} is of a vector: "
            f"expected an axis, {quantity}:{KINDS[kind].axes[0]}, or its length, |{quantity}|"
        )
    return reduction, quantity, magnitude
