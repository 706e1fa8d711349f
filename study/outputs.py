"""Numbers of a motion, as study files ask for them: REDUCTION QUANTITY or REDUCTION |QUANTITY|.

    max |displacement:beam.tip:hub.rim:y|       final angle:hub:z       peak-to-peak energy:balance
    max event:stop:peak      min event:stop:steps      sum event:stop:impulse      count event:stop
    max srs(acceleration:bracket.tip:z, q=10) from 100 to 500 Hz
    value srs(acceleration:bracket.tip:z) at 100 Hz

Bars take the magnitude, of a vector its length. `from A to B` takes a part of the time [s] or of
the frequencies [Hz]. Quantities are those of `duhamel plot`, with what is made of them, and the
numbers of the events of a contact or stop, counted at every step; what only whole contacts have is
taken of those alone. There is no number where nothing touched, but for sum and count.
"""

import re
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..files.arrays import Array
from ..inputs.errors import did_you_mean
from ..results import QuantityError, Results, SeriesError, transforms
from ..results.motion import EVENT_QUANTITIES
from ..results.series import rms
from ..results.transforms import Series
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
    "rms": lambda time, samples: float(rms(time, samples)),
    "argmax": lambda time, samples: float(time[samples.argmax()]),
    "argmin": lambda time, samples: float(time[samples.argmin()]),
}
# Reductions that are one of the samples.
PEAK_REDUCTIONS = ("max", "min")
# Reductions that make sense over frequency too.
OF_SPECTRA = ("max", "min", "argmax", "argmin")
# Reductions that give a time or a frequency, not a value.
OF_TIMES = ("argmax", "argmin")
# The reduction that takes the value at a time or frequency.
VALUE_REDUCTION = "value"


OF_EVENTS: dict[str, Callable[[Array], float]] = {
    "max": lambda samples: float(samples.max()),
    "min": lambda samples: float(samples.min()),
    "final": lambda samples: float(samples[-1]),
    "mean": lambda samples: float(samples.mean()),
    "peak-to-peak": lambda samples: float(np.ptp(samples)),
    "sum": lambda samples: float(samples.sum()),
    "count": lambda samples: float(len(samples)),
}
# Reductions that are defined without any event.
OF_NOTHING = ("sum", "count")
EVENT_WORD = "event"
EVENT_COLUMNS = tuple(quantity.attribute for quantity in EVENT_QUANTITIES)
# Also of contacts that were closed at the start or at the end of the run.
ALWAYS_KNOWN = ("start", "peak", "impulse", "dissipated")


def values(results: Results, outputs: Mapping[str, str]) -> dict[str, float]:
    """The outputs by name, in SI units.

    `StudyError` names one that is invalid, or of a quantity that the results do not have;
    `SeriesError` one that cannot be made of these results.
    """
    return {
        name: _named(f"outputs.{name}", _value, results, output) for name, output in outputs.items()
    }


def units(results: Results, outputs: Mapping[str, str]) -> dict[str, str]:
    """The units of the outputs by name, "" of numbers, as "m/s²" and "Hz"; as `values` raises."""
    return {
        name: _named(f"outputs.{name}", _unit, results, output) for name, output in outputs.items()
    }


def check(results: Results, outputs: Mapping[str, str]) -> None:
    """Raise what `values` would raise."""
    for name, output in outputs.items():
        _named(f"outputs.{name}", _look, results, output)


def is_series(output: str) -> bool:
    """Whether an output is a quantity alone, over time or frequency, without a reduction."""
    first, _, rest = output.strip().partition(" ")
    return not rest or first not in (*REDUCTIONS, *OF_EVENTS, VALUE_REDUCTION)


def is_stepwise(output: str) -> bool:
    """Whether an output is one of the recorded times, or a count, which have no derivatives."""
    return _parsed(output).reduction in (*OF_TIMES, "count")


def reduction_of(output: str) -> str:
    """The reduction of an output; "" of one of events."""
    asked = _parsed(output)
    return "" if _is_event(asked.quantity) else asked.reduction


def samples_of(results: Results, output: str) -> Array:
    """What an output is the largest or least of (n,)."""
    asked = _parsed(output)
    found = transforms.series(results, asked.quantity)
    _check_columns(asked, found)
    return _within(asked, found.abscissa, _of_one_number(asked, found))[1]


def with_quantity(output: str, change: Callable[[str], str]) -> str:
    """An output whose quantity is changed; what is no output is a quantity alone."""
    match = OUTPUT_PATTERN.fullmatch(output)
    if is_series(output) or match is None:
        return change(output.strip())
    start, end = match.span("quantity")
    return f"{output[:start]}{change(output[start:end])}{output[end:]}"


def sampled_over(results: Results, name: str, quantity: str, base: str = "") -> tuple[Array, Array]:
    """The abscissa (n,) and the values (n,) of a quantity of one number; raises as `values`.

    name: its key, for messages; base: "s" where it must be over time.
    """

    def taken(results: Results, quantity: str) -> tuple[Array, Array]:
        found = transforms.series(results, quantity)
        if found.axes:
            raise StudyError(
                f"{quantity!r} is of a vector: expected an axis, {quantity}:{found.axes[0]}"
            )
        if base not in ("", found.base):
            raise StudyError(f"{quantity!r} is over {found.base}: expected one over {base}")
        return found.abscissa, found.values

    found: tuple[Array, Array] = _named(name, taken, results, quantity)
    return found


def unit_of(results: Results, quantity: str) -> str:
    """The unit of a quantity, "" of a number."""
    return _plain(transforms.series(results, quantity).unit)


def _named(
    name: str, function: Callable[[Results, str], Any], results: Results, output: str
) -> Any:
    try:
        return function(results, output)
    except (StudyError, QuantityError) as error:
        raise StudyError(f"{name}: {error}") from error
    except SeriesError as error:
        raise SeriesError(f"{name}: {error}") from error


def _value(results: Results, output: str) -> float:
    asked = _parsed(output)
    if _is_event(asked.quantity):
        components = _events(results, asked.quantity)
        samples = np.abs(components) if asked.magnitude else components
        known = len(samples) or asked.reduction in OF_NOTHING
        return OF_EVENTS[asked.reduction](samples) if known else float("nan")
    found = transforms.series(results, asked.quantity)
    _check_columns(asked, found)
    samples = _of_one_number(asked, found)
    if asked.reduction == VALUE_REDUCTION:
        return _at(asked, found.abscissa, samples)
    return REDUCTIONS[asked.reduction](*_within(asked, found.abscissa, samples))


def _of_one_number(asked: "_Output", found: Series) -> Array:
    """The samples (n,), of bars their magnitude."""
    if not asked.magnitude:
        return found.values
    return np.linalg.norm(found.values, axis=1) if found.values.ndim > 1 else np.abs(found.values)


def _unit(results: Results, output: str) -> str:
    asked = _parsed(output)
    if _is_event(asked.quantity):
        _, owner, column, *_ = [*asked.quantity.split(":"), ""]
        if asked.reduction == "count":
            return ""
        return _plain(results.unit("events", owner, column or "start"))
    found = transforms.series(results, asked.quantity)
    return _plain(found.base if asked.reduction in OF_TIMES else found.unit)


def _plain(unit: str) -> str:
    return "" if unit == "1" else unit


def _look(results: Results, output: str) -> None:
    """Find a quantity, but for its values."""
    asked = _parsed(output)
    if _is_event(asked.quantity):
        _events(results, asked.quantity)
    else:
        _check_columns(asked, transforms.check(results, asked.quantity))


def _check_columns(asked: "_Output", found: Series) -> None:
    """That an output is of one number over time or frequency, and of a kind that can be reduced."""
    is_spectrum = found.base == transforms.FREQUENCY
    if is_spectrum and asked.reduction not in (*OF_SPECTRA, VALUE_REDUCTION):
        raise StudyError(
            f"{asked.text!r} is of a spectrum: expected one of "
            f"{', '.join((*OF_SPECTRA, VALUE_REDUCTION))}"
        )
    if asked.unit not in ("", found.base):
        raise StudyError(f"{asked.text!r}: expected {found.base}, found {asked.unit}")
    if not found.axes or (asked.magnitude and not is_spectrum):
        return
    length = "" if is_spectrum else f", or its length, |{asked.quantity}|"
    within = transforms.parse(asked.quantity)[0]
    raise StudyError(
        f"{asked.text!r} is of a vector: expected an axis, {within}:{found.axes[0]}{length}"
    )


def _within(asked: "_Output", abscissa: Array, samples: Array) -> tuple[Array, Array]:
    """The part between two times or frequencies."""
    low, high = asked.limits
    inside = (abscissa >= low) & (abscissa <= high)
    if not inside.any():
        raise SeriesError(
            f"{asked.text!r}: nothing there, between {abscissa[0]:.6g} and {abscissa[-1]:.6g}"
        )
    return abscissa[inside], samples[inside]


def _at(asked: "_Output", abscissa: Array, samples: Array) -> float:
    """The value between samples: on a line over time, and over the logarithm of frequency."""
    at = asked.limits[0]
    if not abscissa[0] <= at <= abscissa[-1]:
        raise SeriesError(
            f"{asked.text!r}: expected between {abscissa[0]:.6g} and {abscissa[-1]:.6g}"
        )
    if abscissa[0] > 0.0:
        return float(np.interp(np.log(at), np.log(abscissa), samples))
    return float(np.interp(at, abscissa, samples))


def _is_event(quantity: str) -> bool:
    return quantity.partition(":")[0] == EVENT_WORD


def _events(results: Results, quantity: str) -> Array:
    """A number of each event, event:NAME:COLUMN; those that closed, event:NAME."""
    _, name, column, *more = [*quantity.split(":"), "", ""]
    owners = results.events
    if name not in owners:
        known = ", ".join(sorted(owners)) or "none"
        raise StudyError(f"{quantity}: no contact or stop {name!r}; there are: {known}")
    if any(more) or column not in ("", *EVENT_COLUMNS):
        raise StudyError(
            f"{quantity}: expected {EVENT_WORD}:NAME or one of {EVENT_WORD}:NAME:COLUMN with "
            f"{', '.join(EVENT_COLUMNS)}"
        )
    events = owners[name]
    samples: Array = getattr(events, column or "start")
    closed = events.closing_speed > 0.0
    if column in ALWAYS_KNOWN:
        return samples
    return samples[closed] if column in ("", "closing_speed") else samples[events.whole]


class _Output(NamedTuple):
    """An output in parts; magnitude: it has bars; unit: of the limits, if it was given."""

    text: str
    reduction: str
    quantity: str
    magnitude: bool
    limits: tuple[float, float] = (-np.inf, np.inf)
    unit: str = ""


NUMBER_PATTERN = r"([-+.\deE]+)"
OUTPUT_PATTERN = re.compile(
    r"\s*(?P<reduction>\S+)\s+(?P<bar>\|?)(?P<quantity>[^\s|](?:[^|]*?[^\s|])?)(?P<end>\|?)"
    rf"((\s+at\s+(?P<at>{NUMBER_PATTERN})|\s+from\s+(?P<low>{NUMBER_PATTERN})\s+to\s+(?P<high>{NUMBER_PATTERN}))"
    r"(\s*(?P<unit>s|Hz))?)?\s*"
)
"""A quantity may have blanks, as names have; the part of the time is last."""


def _parsed(output: str) -> _Output:
    match = OUTPUT_PATTERN.fullmatch(output)
    of_events = match is not None and _is_event(match["quantity"])
    reductions = OF_EVENTS if of_events else (*REDUCTIONS, VALUE_REDUCTION)
    if match is None or match["reduction"] not in reductions or match["bar"] != match["end"]:
        raise StudyError(
            f"expected REDUCTION QUANTITY or REDUCTION |QUANTITY| with one of "
            f"{', '.join(reductions)}, found {output!r}"
            f"{did_you_mean(output.partition(' ')[0], reductions)}"
        )
    reduction, at, low = match["reduction"], match["at"], match["low"]
    limits = (-np.inf, np.inf)
    try:
        if at or low:
            limits = float(at or low), float(at or match["high"])
    except ValueError:
        raise StudyError(f"expected numbers after at, from and to, found {output!r}") from None
    fits = not (of_events and (at or low)) and bool(at) == (reduction == VALUE_REDUCTION)
    if not fits or limits[0] > limits[1] or (match["unit"] and not (at or low)):
        raise StudyError(
            f"expected {VALUE_REDUCTION} QUANTITY at X, or another reduction, of no events, from A "
            "to B, "
            f"found {output!r}"
        )
    return _Output(
        output, reduction, match["quantity"], bool(match["bar"]), limits, match["unit"] or ""
    )
