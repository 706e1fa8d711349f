"""Quantities and what is made of them, by words: TRANSFORM(QUANTITY, WORD, KEY=NUMBER, ...).

    srs(acceleration:bracket.tip:z, q=10)        cfc(acceleration:head, 1000)
    srs(cfc(acceleration:bracket.tip:z, 1000), pseudo-velocity, from=10, to=2000)

A quantity is that of quantities.py. It has a colon before any bracket, and a transform has none, so
that names of bodies and joints with brackets mean what they did.
"""

import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..files.arrays import Array
from .errors import QuantityError, SeriesError, SeriesWarning
from .quantities import KINDS_BY_NAME, evaluate
from .results import Results
from .series.bands import octave_bands
from .series.filters import butterworth, cfc
from .series.fourier import SPECTRUM_SCALES, WINDOW_NAMES, Spectrum, cumulative_rms, fourier, psd
from .series.sampling import sampled
from .series.shock import (
    DEFAULT_MIN_FREQUENCY,
    EXTREME_KINDS,
    MIN_SAMPLES_PER_PERIOD,
    RESPONSE_KINDS,
    RESPONSE_SPANS,
    octave_frequencies,
    shock_spectrum,
)
from .steps import inside

Given = Mapping[str, float | str]
"""arguments by name"""
Applied = tuple[Array, Array]
"""time or frequency (m,), and values (m,) or (m, k)"""

TIME, FREQUENCY = "s", "Hz"
"""units of the abscissa"""
# [m/s^2], exact by definition (CGPM 1901).
STANDARD_GRAVITY = 9.80665
# The unit of an acceleration in g, and the power of g in it.
IN_G = {"m/s²": ("g", 1), "m/s² s": ("g s", 1), "(m/s²)²/Hz": ("g²/Hz", 2)}
ACCELERATION_UNITS = ("m/s²", "rad/s²")


@dataclass(frozen=True, eq=False)
class Series:
    """A quantity over time, or over frequency.

    abscissa (n,) in `base`, "s" or "Hz"; values (n,) or (n, axes). treatment: what was made of the
    quantity, in words; ordinate: what the values are, where the kind does not say it; paper: how a
    picture of it is ruled, "lines", "log", "bands" or "tripartite".
    """

    kind: str
    names: tuple[str, ...]
    axis: str
    axes: tuple[str, ...]
    """of its columns; none: it has no columns"""
    unit: str
    abscissa: Array
    values: Array
    base: str = TIME
    treatment: tuple[str, ...] = ()
    ordinate: str = ""
    paper: str = "lines"
    band: float = np.inf
    """the frequency up to which the superelement that it is read at is right [Hz]"""


@dataclass(frozen=True)
class Transform:
    """What is made of a series over time.

    apply: of time, values and arguments; unit: of the result, of the unit and the arguments, with
    `QuantityError` for one that it cannot take; told: in words; numbers: keys, in the order in
    which they may be given without key; required: how many of them must be given; words: what may
    be said, by meaning, the first one unless said otherwise.
    """

    apply: Callable[[Array, Array, Given], Applied]
    unit: Callable[[str, Given], str]
    told: Callable[[Given], str]
    base: str
    numbers: tuple[str, ...] = ()
    required: int = 0
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    ordinate: Callable[[Given], str] = lambda given: ""
    paper: Callable[[Given], str] = lambda given: "lines"


def _number(given: Given, key: str, default: float) -> float:
    return float(given.get(key, default))


def _whole(given: Given, key: str, default: int) -> int:
    value = _number(given, key, default)
    if not value.is_integer():
        raise SeriesError(f"{key}: expected a whole number, found {value:g}")
    return int(value)


def _same(unit: str, given: Given) -> str:
    return unit


def _quality(given: Given) -> float:
    """Q, or 1 / (2 zeta)."""
    if "zeta" not in given:
        return _number(given, "q", 10.0)
    zeta = float(given["zeta"])
    if "q" in given or not 0.0 <= zeta < 1.0:
        raise SeriesError(f"expected q, or a zeta from 0 to below 1, found zeta={zeta:g}")
    return 0.5 / zeta if zeta else np.inf


def _srs(time: Array, values: Array, given: Given) -> Applied:
    series = sampled(time, values)
    lowest = _number(given, "from", DEFAULT_MIN_FREQUENCY)
    highest = _number(given, "to", 1.0 / (MIN_SAMPLES_PER_PERIOD * series.coarsest))
    frequencies = octave_frequencies(lowest, highest, _whole(given, "per_octave", 12))
    found = shock_spectrum(
        time,
        values,
        frequencies,
        q=_quality(given),
        response=str(given["response"]),
        extreme=str(given["extreme"]),
        span=str(given["span"]),
    )
    return found.frequency, found.values


def _srs_unit(unit: str, given: Given) -> str:
    if unit not in ACCELERATION_UNITS:
        raise QuantityError(f"srs: expected an acceleration, [m/s²] or [rad/s²], found [{unit}]")
    angle = unit.partition("/")[0]
    units = {"pseudo-velocity": f"{angle}/s", "displacement": angle}
    return units.get(str(given["response"]), unit)


def _srs_told(given: Given) -> str:
    quality = _quality(given)
    damping = "no damping" if np.isinf(quality) else f"Q = {quality:.4g}"
    sides = [str(given[key]) for key in ("extreme", "span") if given[key] not in _PLAIN_SPECTRUM]
    return ", ".join(["shock response spectrum", damping, *sides])


_PLAIN_SPECTRUM = (EXTREME_KINDS[0], RESPONSE_SPANS[0])

_RESPONSE_LABELS = {
    "absolute": "absolute acceleration",
    "static": "equivalent static acceleration",
    "pseudo-velocity": "pseudo-velocity",
    "displacement": "relative displacement",
}


def _srs_paper(given: Given) -> str:
    return "tripartite" if given["response"] == "pseudo-velocity" else "log"


def _cfc(time: Array, values: Array, given: Given) -> Applied:
    found = cfc(time, values, float(given["class"]))
    return found.time, found.values


def _filter(kind: str, words: str, *corners: str) -> Transform:
    """A Butterworth filter whose corners have these keys."""

    def apply(time: Array, values: Array, given: Given) -> Applied:
        at = tuple(float(given[key]) for key in corners)
        found = butterworth(time, values, kind, at, _whole(given, "order", 4))
        return found.time, found.values

    def told(given: Given) -> str:
        return f"{words} {' to '.join(f'{given[key]:g}' for key in corners)} Hz"

    return Transform(apply, _same, told, TIME, (*corners, "order"), len(corners))


def _spectrum(function: Callable[..., Spectrum]) -> Callable[[Array, Array, Given], Applied]:
    """A spectrum above 0 Hz, which a logarithmic axis does not have."""

    def apply(time: Array, values: Array, given: Given) -> Applied:
        found = function(time, values, **given)
        return found.frequency[1:], found.values[1:]

    return apply


def _octaves(time: Array, values: Array, given: Given) -> Applied:
    found = octave_bands(time, values, _whole(given, "fraction", 3))
    return found.center, found.values


def _octaves_told(given: Given) -> str:
    fraction = _whole(given, "fraction", 3)
    return "octave bands" if fraction == 1 else f"1/{fraction} octave bands"


def _windowed(words: str, usual: str) -> Callable[[Given], str]:
    """The words, with the window unless it is the usual one."""
    return lambda given: words if given["window"] == usual else f"{words}, {given['window']}"


_WELCH_WINDOWS = ("hann", *(name for name in WINDOW_NAMES if name != "hann"))

TRANSFORMS = {
    "srs": Transform(
        _srs,
        _srs_unit,
        _srs_told,
        FREQUENCY,
        numbers=("q", "from", "to", "per_octave", "zeta"),
        words={"response": RESPONSE_KINDS, "extreme": EXTREME_KINDS, "span": RESPONSE_SPANS},
        ordinate=lambda given: _RESPONSE_LABELS[str(given["response"])],
        paper=_srs_paper,
    ),
    "fourier": Transform(
        _spectrum(fourier),
        lambda unit, given: f"{unit} s" if given["scale"] == "transient" else unit,
        _windowed("Fourier spectrum", "rectangular"),
        FREQUENCY,
        words={"scale": SPECTRUM_SCALES, "window": WINDOW_NAMES},
        ordinate=lambda given: {"amplitude": "peak amplitude", "rms": "RMS amplitude"}.get(
            str(given["scale"]), ""
        ),
        paper=lambda given: "log",
    ),
    "psd": Transform(
        _spectrum(psd),
        lambda unit, given: f"({unit})²/Hz",
        _windowed("power spectral density", "hann"),
        FREQUENCY,
        numbers=("resolution",),
        words={"window": _WELCH_WINDOWS},
        paper=lambda given: "log",
    ),
    "cumulative_rms": Transform(
        _spectrum(cumulative_rms),
        _same,
        lambda given: "cumulative RMS",
        FREQUENCY,
        numbers=("resolution",),
        words={"window": _WELCH_WINDOWS},
        ordinate=lambda given: "RMS below the frequency",
        paper=lambda given: "log",
    ),
    "octaves": Transform(
        _octaves,
        _same,
        _octaves_told,
        FREQUENCY,
        numbers=("fraction",),
        ordinate=lambda given: "RMS in the band",
        paper=lambda given: "bands",
    ),
    "cfc": Transform(
        _cfc, _same, lambda given: f"CFC {given['class']:g}", TIME, numbers=("class",), required=1
    ),
    "lowpass": _filter("lowpass", "below", "corner"),
    "highpass": _filter("highpass", "above", "corner"),
    "bandpass": _filter("bandpass", "", "low", "high"),
}
# The only transform that changes nothing but the unit.
IN_GRAVITIES = "g"

Step = tuple[str, Given]
"""the name of a transform, and its arguments"""


Window = tuple[float, float]
"""from and to [s], both within it; infinities for the ends of a run"""


def series(results: Results, text: str, window: Window | None = None) -> Series:
    """A quantity, or what is made of it, by words.

    window: the part of the run that is taken, before anything is made of it.
    `QuantityError` names a quantity or a word that there is not; `SeriesError` a series of which
    it cannot be made. Warns (`SeriesWarning`) where the run recorded one step in several.
    """
    quantity, steps = parse(text)
    found = _quantity(results, quantity)
    transformed = [name for name, _ in steps if name != IN_GRAVITIES]
    if transformed and (every := int(results.solver.get("every", 1))) > 1:
        rate = (len(results.time) - 1) / float(np.ptp(results.time) or 1.0)
        warnings.warn(
            f"{text}: the run recorded one step in {every}: what vibrates above {0.5 * rate:.4g} "
            f"Hz, half of that rate, appears at lower frequencies",
            SeriesWarning,
            stacklevel=2,
        )
    try:
        if window is not None:
            found = _within(found, window)
        for name, given in steps:
            found = in_g(found) if name == IN_GRAVITIES else _applied(found, name, given)
    except SeriesError as error:
        raise SeriesError(f"{text}: {error}") from error
    except QuantityError as error:
        raise QuantityError(f"{text}: {error}") from error
    return found


def check(results: Results, text: str) -> Series:
    """Raise what `series` would raise before it computes; its columns and units, without values."""
    quantity, steps = parse(text)
    found = _quantity(results, quantity)
    try:
        for name, given in steps:
            # The unit "g" is no transform of the table: it has no arguments, and computes nothing.
            found = in_g(found) if name == IN_GRAVITIES else _expected(found, name, given)
    except (SeriesError, QuantityError) as error:
        raise QuantityError(f"{text}: {error}") from error
    return found


def in_g(found: Series) -> Series:
    """A series of accelerations in g = 9.80665 m/s^2."""
    if found.unit not in IN_G:
        raise QuantityError(f"g: expected an acceleration, [m/s²], found [{found.unit}]")
    unit, power = IN_G[found.unit]
    return replace(found, unit=unit, values=found.values / STANDARD_GRAVITY**power)


def parse(text: str) -> tuple[str, list[Step]]:
    """The quantity within, and the transforms from the inside out."""
    # Greedy, so that the last bracket closes the outermost transform.
    match = re.fullmatch(r"\s*(\w+)\s*\((.*)\)\s*", text, re.DOTALL)
    if match is None:
        opened = re.match(r"\s*(\w+)\s*\(", text)
        if opened and opened[1] in TRANSFORMS:
            raise QuantityError(f"{text}: found no closing bracket; expected {form(opened[1])}")
        return text.strip(), []
    name, (inner, *arguments) = match[1], split(match[2])
    known = (*TRANSFORMS, IN_GRAVITIES)
    if name not in known:
        raise QuantityError(f"{text}: no transform {name!r}; there are: {', '.join(known)}")
    quantity, steps = parse(inner)
    given: Given = {}
    if name == IN_GRAVITIES and arguments:
        raise QuantityError(f"{text}: expected g(QUANTITY)")
    if name != IN_GRAVITIES:
        try:
            given = _given(TRANSFORMS[name], arguments)
        except QuantityError as error:
            raise QuantityError(f"{text}: {error}; expected {form(name)}") from error
    return quantity, [*steps, (name, given)]


def split(text: str) -> list[str]:
    """The parts of a text between its commas, those within brackets apart."""
    depth, parts = 0, [""]
    for character in text:
        depth += (character == "(") - (character == ")")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    # With brackets that do not match, messages come out best from all parts.
    return parts if depth == 0 else text.split(",")


def form(name: str) -> str:
    """How a transform is written, as "cfc(QUANTITY, class)"."""
    transform = TRANSFORMS[name]
    required = list(transform.numbers[: transform.required])
    optional = [f"{key}=" for key in transform.numbers[transform.required :]]
    words = ["|".join(choices) for choices in transform.words.values()]
    return f"{name}({', '.join(['QUANTITY', *required, *optional, *words])})"


def _quantity(results: Results, quantity: str) -> Series:
    if quantity in TRANSFORMS:
        raise QuantityError(f"{quantity}: expected {form(quantity)}")
    found = evaluate(results, quantity)
    # One axis was chosen: the series has one column, and no names of columns.
    axes = () if found.axis else KINDS_BY_NAME[found.kind].axes
    owners = {name.partition(".")[0] for name in found.names} & results.bands.keys()
    return Series(
        found.kind,
        found.names,
        found.axis,
        axes,
        found.unit,
        results.time,
        found.values,
        ordinate=found.states,
        band=min((results.bands[owner] for owner in owners), default=np.inf),
    )


def _within(found: Series, window: Window) -> Series:
    time, (start, end) = found.abscissa, window
    rows = inside(time, start, end)
    if not rows.any():
        given = {"from": start, "to": end}
        ends = [f"{word} {at:.9g}" for word, at in given.items() if np.isfinite(at)]
        raise SeriesError(
            f"nothing was recorded {' '.join(ends)} s, expected times from {time[0]:.9g} to "
            f"{time[-1]:.9g} s"
        )
    return replace(found, abscissa=time[rows], values=found.values[rows])


def _applied(found: Series, name: str, given: Given) -> Series:
    expected, values = _expected(found, name, given), found.values
    # Transforms compute in SI units: the square of an acceleration in g is no density in SI.
    if powers := dict(IN_G.values()).get(found.unit):
        values = values * STANDARD_GRAVITY**powers
    abscissa, made = TRANSFORMS[name].apply(found.abscissa, values, given)
    made_of = replace(expected, abscissa=abscissa, values=made)
    return in_g(made_of) if powers and made_of.unit in IN_G else made_of


def _expected(found: Series, name: str, given: Given) -> Series:
    """What a transform makes of a series, but for the numbers."""
    transform = TRANSFORMS[name]
    if found.base != TIME:
        raise QuantityError(f"{name}: expected a quantity over time, found a spectrum")
    in_si = {unit: si for si, (unit, _) in IN_G.items()}.get(found.unit, found.unit)
    return replace(
        found,
        unit=transform.unit(in_si, given),
        base=transform.base,
        treatment=(*found.treatment, transform.told(given)),
        ordinate=transform.ordinate(given),
        paper=transform.paper(given),
    )


def _given(transform: Transform, arguments: list[str]) -> Given:
    """Arguments by name, of numbers in order, KEY=NUMBER, and words."""
    given: dict[str, float | str] = {}
    meanings = {word: key for key, words in transform.words.items() for word in words}
    in_order = list(transform.numbers)
    for argument in map(str.strip, arguments):
        key, is_named, value = argument.rpartition("=")
        key = key.strip()
        if not is_named and value in meanings:
            key = meanings[value]
        elif not is_named and in_order:
            key = in_order.pop(0)
        if key in given or key not in (*transform.numbers, *transform.words):
            raise QuantityError(f"found {argument!r}")
        given[key] = _value(key, value.strip(), transform)
    missing = [key for key in transform.numbers[: transform.required] if key not in given]
    if missing:
        raise QuantityError(f"found no {missing[0]}")
    return {key: words[0] for key, words in transform.words.items()} | given


def _value(key: str, text: str, transform: Transform) -> float | str:
    if key in transform.words:
        if text not in transform.words[key]:
            raise QuantityError(f"found {key}={text!r}")
        return text
    try:
        number = float(text)
    except ValueError:
        raise QuantityError(f"expected a number for {key}, found {text!r}") from None
    if np.isnan(number):
        raise QuantityError(f"expected a number for {key}, found {text!r}")
    return number
