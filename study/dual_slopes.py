"""Derivatives of outputs by runs with dual numbers, and what they are worth where forces switch.

A run with dual numbers gives the exact derivatives of all that it records. Outputs follow by the
chain rule, along each of them. Where forces have kinks, the derivative of a run with fixed steps is
not that of the motion: it depends on where in a step each switch lies. It is then taken at some
values nearby too, which change these places, and is as good as it varies smoothly there:

    d(s) at p_j (1 + s w_j),   s = -1e-2 .. 0.854e-2,   less its parabola over s

Beside that, the derivatives along w must agree with the difference of the outputs there. The larger
of both is the error. Source: docs/theory.md, Derivatives by dual numbers.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..files.arrays import Array
from ..results import Results
from ..solver import ModelError
from ..solver.compiler.targets import DERIVATIVE_COUNTS
from ..solver.derivatives.family import DifferentiatedRun, Differentiation
from ..solver.errors import DerivativeError
from .asked_numbers import AskedNumbers
from .errors import StudyError
from .parametrized import Parametrized

CHAIN_STEPS = np.array([1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
"""of the scale of a parameter, along its derivative"""
MAX_DEPARTURE = 1e-6
"""of an output, or of its derivative times the size of a parameter"""
DEPARTURE_MARGIN = 10.0
"""the error of a derivative over the departure of its output, where rounding grows: 1.4 to 2"""
ABSOLUTE_ROUNDING = 1e-12
"""in SI units, of outputs that are zero but for it"""
NEARBY_VALUES = 1e-2 * np.array([-1.0, -0.618, -0.236, 0.0, 0.382, 0.854])
"""values of s, unevenly: at even ones all switches may lie at the same places of their steps"""
SCATTER_MARGIN = 2.0
"""over the largest distance from the parabola, which takes half of what six values tell"""
GOLDEN_RATIO = 0.6180339887498949
"""whose multiples, less whole numbers, are all apart"""
BESIDE_PARABOLA = np.eye(len(NEARBY_VALUES)) - np.vander(NEARBY_VALUES, 3) @ np.linalg.pinv(
    np.vander(NEARBY_VALUES, 3)
)
"""what is left of values at `NEARBY_VALUES` less the parabola that fits best"""
BY_NUMBERS = np.linalg.pinv(np.vander(NEARBY_VALUES / 1e-2, 5))[-2] / 1e-2
"""weights of values at `NEARBY_VALUES` in the slope at 0 of the polynomial of fourth degree"""

DUAL_NUMBERS = "dual"
DERIVATIVE_METHODS = ("differences", DUAL_NUMBERS)
"""of fits and searches"""
DIFFERENCES_INSTEAD = (
    "something switches within the run: derivatives are taken by differences there"
)


class DualSlopes(NamedTuple):
    """Derivatives and errors (m, parameters); notes: what is to be known of them."""

    value: Array
    error: Array
    notes: tuple[str, ...]


def dual_slopes(
    family: Parametrized, scales: Mapping[str, float], asked: AskedNumbers, results: Results
) -> DualSlopes:
    """The derivatives of all numbers that are asked for; results: of the run without them.

    `StudyError` for what has none, which says what to do.
    """
    try:
        differentiation = Differentiation(family.make, scales, results, asked.numbers)
        found = differentiation.at(family.values)
        value, error = _chained(found, asked, scales)
        away = _departures(
            asked, asked.numbers(found.values), asked.numbers(results), value, scales
        )
        least = np.array([found.least_errors[name] for name in scales])
        shares = np.maximum(least, DEPARTURE_MARGIN * away[:, None])
        error = np.maximum(error, shares * np.abs(value))
    except DerivativeError as failure:
        raise StudyError(f'{failure}; take method = "differences"') from failure
    if found.switches:
        nearby = _Nearby(differentiation, family.values, scales, asked)
        error = np.maximum(error, nearby.errors(found, value))
    return DualSlopes(value, error, tuple(_notes(found)))


def exact_slopes(
    family: Parametrized,
    values: Mapping[str, float],
    scales: Mapping[str, float],
    results: Results,
    numbers: Callable[[Results, Mapping[str, float]], Array],
    groups: Sequence[int],
) -> Array | None:
    """The derivatives (m, parameters) of numbers of a run; none where forces have kinks.

    numbers: of a run and its parameters; results: of the run at values without derivatives;
    groups: how many numbers each are of one kind. `StudyError` for what has no derivative.
    """
    base = numbers(results, values)
    try:
        differentiation = Differentiation(
            family.make, scales, results, lambda run: numbers(run, values)
        )
        found = differentiation.at(values)
        if found.switches:
            return None
        columns = []
        for name, scale in scales.items():
            slopes = []
            for distance in (CHAIN_STEPS[2:4] * scale).tolist():
                high, low = (
                    numbers(found.moved(name, end), {**values, name: values[name] + end})
                    for end in (distance, -distance)
                )
                slopes.append((high - low) / (2.0 * distance))
            columns.append(slopes[1] + (slopes[1] - slopes[0]) / 99.0)
        value = np.stack(columns, axis=1)
        away = np.abs(numbers(found.values, values) - base)
    except DerivativeError as failure:
        raise StudyError(f'{failure}; take derivatives = "differences"') from failure
    sizes = np.abs(base) + np.abs(value * list(scales.values())).max(axis=1)
    first = np.cumsum([0, *groups[:-1]])
    allowed = MAX_DEPARTURE * np.maximum.reduceat(sizes, first) + ABSOLUTE_ROUNDING
    if not (np.maximum.reduceat(away, first) <= allowed).all():
        raise StudyError(
            "with derivatives the run differs from that without: rounding grows in this motion; "
            'take derivatives = "differences"'
        )
    return value


def runs_with_derivatives(n: int) -> int:
    """How many runs the derivatives by n parameters take."""
    return -(-n // max(DERIVATIVE_COUNTS))


def check_method(method: str) -> None:
    """`StudyError` for no method of fits and searches."""
    if method not in DERIVATIVE_METHODS:
        raise StudyError(
            f"derivatives: expected {' or '.join(DERIVATIVE_METHODS)}, found {method!r}"
        )


def _departures(
    asked: AskedNumbers,
    found: Array,
    plain: Array,
    value: Array,
    scales: Mapping[str, float],
) -> Array:
    """By which shares (m,) numbers came out otherwise than without derivatives.

    `DerivativeError` where that is more than rounding.
    """
    sizes = np.abs(plain) + np.abs(value * list(scales.values())).max(axis=1)
    # What is no number in either run is no miss.
    away = np.where(np.isnan(found) & np.isnan(plain), 0.0, np.abs(found - plain))
    of_outputs, of_series = asked.split(np.stack([away, sizes], axis=1))
    parts, shares = [*of_outputs[:, None], *of_series.values()], []
    for output, part in zip((*asked.outputs, *asked.series), parts, strict=True):
        miss, size = part[:, 0].max(), np.nan_to_num(part[:, 1]).max()
        # Not at most, as what is no number in one of them alone is not.
        if not miss <= MAX_DEPARTURE * size + ABSOLUTE_ROUNDING:
            raise DerivativeError(
                f"{output} differs by {miss:.2g} of {size:.2g} from the run without derivatives: "
                "rounding grows in this motion"
            )
        shares += len(part) * [miss / size if size > 0.0 else 0.0]
    return np.array(shares)


def _chained(
    found: DifferentiatedRun, asked: AskedNumbers, scales: Mapping[str, float]
) -> tuple[Array, Array]:
    """Derivatives and errors (m, parameters) of outputs by the chain rule.

    Central differences D(r) along the derivatives of all that is recorded, of which pairs give
    (100 D(r / 10) - D(r)) / 99: that which differs least from the next pair.
    """
    columns = []
    for name, scale in scales.items():
        slopes = []
        for distance in (CHAIN_STEPS * scale).tolist():
            ends = [asked.numbers(found.moved(name, end)) for end in (distance, -distance)]
            slopes.append((ends[0] - ends[1]) / (2.0 * distance))
        wide, narrow = np.array(slopes[:-1]), np.array(slopes[1:])
        better = narrow + (narrow - wide) / 99.0
        errors = np.abs(np.diff(better, axis=0))
        # What is no number anywhere has no best step.
        best = np.where(np.isnan(errors), np.inf, errors).argmin(axis=0)
        rows = np.arange(errors.shape[1])
        columns.append((better[best, rows], errors[best, rows]))
    value, error = (np.stack(parts, axis=1) for parts in zip(*columns, strict=True))
    return value, error


class _Nearby:
    """Runs with derivatives at some values beside those of all parameters."""

    def __init__(
        self,
        differentiation: Differentiation,
        values: Mapping[str, float],
        scales: Mapping[str, float],
        asked: AskedNumbers,
    ) -> None:
        self._asked, self._scales = asked, scales
        # All parameters by the same share would leave ratios, and the places of switches, alone.
        shares = [
            (-1.0) ** j * (1.0 - 0.4 * (GOLDEN_RATIO * j % 1.0)) * scale
            for j, scale in enumerate(scales.values())
        ]
        self._direction = np.array(shares)
        self._runs: dict[float, DifferentiatedRun] = {}
        for s in NEARBY_VALUES[NEARBY_VALUES != 0.0].tolist():
            ends = zip(values.items(), shares, strict=True)
            try:
                self._runs[s] = differentiation.at({name: v + s * w for (name, v), w in ends})
            except (DerivativeError, ModelError):
                return

    def errors(self, found: DifferentiatedRun, value: Array) -> Array:
        """Errors (m, parameters) of derivatives; infinite where there are no runs nearby."""
        runs = self._runs | {0.0: found}
        if len(runs) < len(NEARBY_VALUES):
            return np.full(value.shape, np.inf)
        ordered = [runs[s] for s in NEARBY_VALUES.tolist()]
        derivatives = np.array([_chained(run, self._asked, self._scales)[0] for run in ordered])
        numbers = np.array([self._asked.numbers(run.values) for run in ordered])
        scatter = np.einsum("st,tmp->smp", BESIDE_PARABOLA, derivatives)
        along = BY_NUMBERS @ numbers
        miss = np.abs(along - value @ self._direction)
        shares = np.abs(value * self._direction)
        total = shares.sum(axis=1, keepdims=True)
        even = np.full(value.shape, 1.0 / value.shape[1])
        shares = np.divide(shares, total, out=even, where=total > 0.0)
        missed = miss[:, None] * shares / np.abs(self._direction)
        found_errors = np.maximum(SCATTER_MARGIN * np.abs(scatter).max(axis=0), missed)
        return np.where(np.isnan(found_errors), np.inf, found_errors)


def _notes(found: DifferentiatedRun) -> Iterator[str]:
    for name, side in found.one_sided.items():
        word = "above" if side > 0 else "below"
        yield f"{name}: the model is valid {word} its value alone; the derivative is that of there"
