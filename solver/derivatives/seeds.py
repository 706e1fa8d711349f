"""Seeds: derivatives of the arrays of a model, its start and its signals by a parameter.

A model is lowered and started at four values beside that of the parameter. Of a function f that is
smooth there,

    D(d) = (f(p + d) - f(p - d)) / (2 d),      df/dp = (4 D(d/2) - D(d)) / 3 + O(d^4)

which costs no run, for all arrays together. Where a model is valid on one side alone, as one whose
body is a plane lamina, the four values lie on that side. The fourth difference of all five values,

    f(p + d) - 4 f(p + d/2) + 6 f(p) - 4 f(p - d/2) + f(p - d) = O(d^4)

is next to nothing, also where df/dp = 0. If not, d is halved, which makes a sixteenth of that of a
smooth f. That of a kink halves, that of a jump stays, and that of either beside p vanishes at once:
where the parameter moves such, as a corner of a signal past a step, there is no seed. Source:
docs/theory.md, Derivatives by dual numbers.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, Index
from ..compiler.struct import Struct
from ..errors import DerivativeError, ModelError
from ..lower.lower import LoweredModel
from ..model.model import Model
from ..simulation import signals
from ..start.initial import InitialState, initialize, lower_to_start
from ..step.system import Inputs
from .records import array_names, has_derivatives
from .scope import user_laws

SEED_STEP = 2e-4
"""of the scale of a parameter"""
CENTRAL_STEPS = (1.0, -1.0, 0.5, -0.5)
# The weights of the value itself and the others, for steps of one: of the derivative, and of the
# fourth difference.
CENTRAL_WEIGHTS = (0.0, -1.0 / 6.0, 1.0 / 6.0, 4.0 / 3.0, -4.0 / 3.0), (6.0, 1.0, 1.0, -4.0, -4.0)
ONE_SIDED = (1.0, 0.75, 0.5, 0.25)
ONE_SIDED_WEIGHTS = (-25.0 / 3.0, -1.0, 16.0 / 3.0, -12.0, 16.0), (1.0, 1.0, -4.0, 6.0, -4.0)
MAX_SEED_CHANGE = 1e-5
"""of the largest derivative of an array, by the fourth difference over the step"""
SEED_ROUNDING = 1e-12
"""of the largest number of an array, or of 0.1 in SI units: of each number that the check weighs"""
MAX_HALVINGS = 7
"""of the step, for arrays whose fourth difference is too large"""
LEAST_FALL, MOST_FALL = 4.0, 64.0
"""of the fourth difference of a smooth function where the step is halved: 16"""
LEAST_ERROR = 1e-11
"""of a derivative: differences over 1e-4 of a parameter have its rounding"""
FREE_NUMBERS = frozenset({"bodies/size"})
"""numbers that are no part of the motion, and may depend on parameters"""


class Start(NamedTuple):
    """All that a run reads at its start."""

    initial: InitialState
    inputs: Inputs

    @property
    def lowered(self) -> LoweredModel:
        return self.initial.lowered

    @property
    def records(self) -> dict[str, Struct]:
        flight = self.lowered.flight
        return {
            "system": self.lowered.system,
            "state": self.initial.state,
            "work": self.initial.work,
            "inputs": self.inputs,
            **({} if flight is None else {"flight": flight}),
        }


@dataclass(frozen=True, eq=False)
class Seeds:
    """The derivatives of arrays by one parameter, by record and name.

    one_sided: -1 or 1 where models on one side of its value alone are valid; error: their largest,
    of the derivative.
    """

    arrays: Mapping[str, Mapping[str, Array]]
    one_sided: int
    error: float = LEAST_ERROR


def start_of(model: Model, rows: Callable[[LoweredModel], Index]) -> Start:
    """A model at its start, with its signals at all steps; rows: where these are recorded."""
    lowered, source = lower_to_start(model)
    initial = initialize(model, lowered, source)
    return Start(initial, signals(initial.lowered, 1, rows(initial.lowered)))


def seeds_of(
    base: Start, start_at: Callable[[float], Start], name: str, value: float, scale: float
) -> Seeds:
    """The seeds of a parameter; start_at: the start at one of its values.

    `DerivativeError` where the parameter changes what cannot be differentiated.
    """
    start_beside = cache(start_at)
    for side, offsets, weights in (
        (0, CENTRAL_STEPS, CENTRAL_WEIGHTS),
        (1, ONE_SIDED, ONE_SIDED_WEIGHTS),
        (-1, ONE_SIDED, ONE_SIDED_WEIGHTS),
    ):
        step = SEED_STEP * scale * (side or 1)
        beside = _Beside(name, base, start_beside, value, offsets)
        try:
            beside.starts(step)
        except ModelError as error:
            failure = error
            continue
        arrays, error_of_all = _derivatives(beside, weights, step)
        return Seeds(arrays, side, error_of_all)
    raise DerivativeError(f"{name}: the model is not valid beside {value:.9g}: {failure}")


class _Beside:
    """A model at a value of a parameter and at others beside it, `offsets` times a step away.

    Each is made when it is first asked for: halved steps have half of their values from before.
    """

    def __init__(
        self,
        parameter: str,
        base: Start,
        start_at: Callable[[float], Start],
        value: float,
        offsets: Sequence[float],
    ) -> None:
        self.parameter, self.base = parameter, base
        self._start_at, self._value, self._offsets = start_at, value, offsets
        self._numbers: dict[tuple[str, float], list[dict[str, Array]]] = {}

    def starts(self, step: float) -> list[Start]:
        return [self.base, *(self._start_at(self._value + one * step) for one in self._offsets)]

    def numbers(self, part: str, step: float) -> list[dict[str, Array]]:
        """The arrays of a record by name, of each model; they have one structure."""
        if (part, step) not in self._numbers:
            records = [start.records[part] for start in self.starts(step)]
            _check_structure(part, records, self.parameter)
            self._numbers[part, step] = [dict(_numbers(record)) for record in records]
        return self._numbers[part, step]

    def arrays(self, part: str, name: str, step: float) -> list[Array]:
        return [numbers[name] for numbers in self.numbers(part, step)]


def _derivatives(
    beside: _Beside, weights: Sequence[Sequence[float]], step: float
) -> tuple[dict[str, dict[str, Array]], float]:
    """The derivatives of all arrays, and the largest of their errors."""
    found: dict[str, dict[str, Array]] = {}
    largest = LEAST_ERROR
    for part in beside.base.records:
        found[part] = {}
        # Scratch has residuals of the start, which are rounding alone.
        is_scratch = part == "work"
        names = tuple(beside.numbers(part, step)[0])
        if part == "system":
            _check_functions(beside.starts(step), beside.parameter)
        for name in names:
            derivative, error, fault = _derivative(
                partial(beside.arrays, part, name),
                weights,
                [step / 2.0**halving for halving in range(1 if is_scratch else MAX_HALVINGS + 1)],
            )
            if not is_scratch:
                if fault:
                    raise DerivativeError(f"{beside.parameter}: the model {fault} ({part}/{name})")
                largest = max(largest, error)
            if derivative.any():
                found[part][name] = derivative
    return found, largest


def _derivative(
    arrays_over: Callable[[float], Sequence[Array]],
    weights: Sequence[Sequence[float]],
    steps: Sequence[float],
) -> tuple[Array, float, str]:
    """The derivative of an array, its error over it, and what it has in place of one, if anything.

    arrays_over: the arrays at all values, by the step; steps: each half of that before.
    """
    arrays = arrays_over(steps[0])
    base = arrays[0]
    # What stays the same may be infinite, or no number.
    moves = np.zeros(base.shape, dtype=bool)
    for one in arrays[1:]:
        moves |= ~((one == base) | (np.isnan(one) & np.isnan(base)))
    derivative, before, falls = np.zeros(base.shape), np.inf, True
    if not moves.any():
        return derivative, 0.0, ""
    formulas = np.array(weights)
    for halving, step in enumerate(steps):
        samples = np.array([one[moves] for one in arrays_over(step)])
        sums = formulas @ samples
        derivative[moves] = sums[0] / step
        change, size = (float(np.abs(one).max()) for one in (sums[1], sums[0]))
        rounding = SEED_ROUNDING * max(np.abs(samples).max(), 0.1) * np.abs(formulas[1]).sum()
        # No number falls.
        falls = change <= before / LEAST_FALL
        if halving and not before - rounding <= MOST_FALL * change:
            falls = False
            break
        if falls and change <= MAX_SEED_CHANGE * size + rounding:
            share = (change - rounding) / size if change > rounding else 0.0
            # Of a sine: the fourth difference is x^3 / 16 of it, what D(d) leaves x^4 / 480.
            return derivative, max(LEAST_ERROR * 2.0**halving, 0.1 * share ** (4.0 / 3.0)), ""
        before = change
    if falls and len(steps) > 1:
        return derivative, 0.0, f"changes too fast with it for differences over {abs(step):.2g}"
    return derivative, 0.0, "changes by a kink or a jump at or beside its value"


def _numbers(record: Struct) -> Iterator[tuple[str, Array]]:
    """The arrays of a record whose numbers have derivatives, by name."""
    cls: Any = type(record)
    fields, pointers = cls.array_fields(), record.pointers()
    for name, (_, field), (_, array) in zip(array_names(cls), fields, pointers, strict=True):
        if has_derivatives(field):
            yield name, array


def _check_structure(part: str, records: Sequence[Struct], parameter: str) -> None:
    """`DerivativeError` where models differ in more than numbers."""
    leaves = [dict(record.leaves()) for record in records]
    for name, first in leaves[0].items():
        for other in leaves[1:]:
            if not _is_same(part, name, first, other[name]):
                raise DerivativeError(
                    f"{parameter}: it changes the structure or the steps of the model "
                    f"({part}/{name})"
                )


def _check_functions(starts: Sequence[Start], parameter: str) -> None:
    """`DerivativeError` where a law calls another function at other values."""
    for laws in zip(*(user_laws(start.lowered) for start in starts), strict=True):
        if any(law.addresses != laws[0].addresses for law in laws):
            raise DerivativeError(
                f"{parameter}: {laws[0].owner} has a law whose function changes with it; expected "
                "it among the numbers of this law"
            )


def _is_same(part: str, name: str, first: Any, other: Any) -> bool:
    if not isinstance(first, np.ndarray):
        return first == other or name in FREE_NUMBERS
    if first.shape != other.shape:
        return False
    # Whole numbers of scratch are made anew in every step.
    return first.dtype == np.float64 or part == "work" or np.array_equal(first, other)
