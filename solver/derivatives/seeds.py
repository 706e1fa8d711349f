"""Seeds: derivatives of the arrays of a model, its start and its signals by a parameter.

A model is lowered and started at four values beside that of the parameter. Of a function f that is
smooth there,

    D(d) = (f(p + d) - f(p - d)) / (2 d),      df/dp = (4 D(d/2) - D(d)) / 3 + O(d^4)

which costs no run, for all arrays together. Where a model is valid on one side alone, as one whose
body is a plane lamina, the four values lie on that side. The fourth difference of all five values,

    f(p + d) - 4 f(p + d/2) + 6 f(p) - 4 f(p - d/2) + f(p - d) = O(d^4)

is next to nothing, also where df/dp = 0. If not, the parameter moves a kink or a jump, as a corner
of a signal past a step: then there is no seed. Source: docs/theory.md, Derivatives by dual numbers.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
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

    one_sided: -1 or 1 where models on one side of its value alone are valid.
    """

    arrays: Mapping[str, Mapping[str, Array]]
    one_sided: int


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
    step = SEED_STEP * scale
    for side, offsets, weights in (
        (0, CENTRAL_STEPS, CENTRAL_WEIGHTS),
        (1, ONE_SIDED, ONE_SIDED_WEIGHTS),
        (-1, ONE_SIDED, ONE_SIDED_WEIGHTS),
    ):
        signed = step * (side or 1)
        try:
            starts = [start_at(value + offset * signed) for offset in offsets]
        except ModelError as error:
            failure = error
            continue
        return Seeds(_derivatives([base, *starts], weights, signed, name), side)
    raise DerivativeError(f"{name}: the model is not valid beside {value:.9g}: {failure}")


def _derivatives(
    starts: Sequence[Start], weights: Sequence[Sequence[float]], step: float, parameter: str
) -> dict[str, dict[str, Array]]:
    found: dict[str, dict[str, Array]] = {}
    for part in starts[0].records:
        records = [start.records[part] for start in starts]
        _check_structure(part, records, parameter)
        if part == "system":
            _check_functions(starts, parameter)
        found[part] = {}
        samples = [dict(_numbers(record)) for record in records]
        for name in samples[0]:
            derivative, is_smooth = _derivative([one[name] for one in samples], weights, step)
            # Scratch has residuals of the start, which are rounding alone.
            if not is_smooth and part != "work":
                raise DerivativeError(
                    f"{parameter}: the model changes by a kink or a jump at or beside its value "
                    f"({part}/{name})"
                )
            if derivative.any():
                found[part][name] = derivative
    return found


def _derivative(
    arrays: Sequence[Array], weights: Sequence[Sequence[float]], step: float
) -> tuple[Array, bool]:
    """The derivative of an array, and whether it is smooth."""
    base = arrays[0]
    # What stays the same may be infinite, or no number.
    moves = np.zeros(base.shape, dtype=bool)
    for one in arrays[1:]:
        moves |= ~((one == base) | (np.isnan(one) & np.isnan(base)))
    derivative, is_smooth = np.zeros(base.shape), True
    if moves.any():
        samples = np.array([one[moves] for one in arrays])
        formulas = np.array(weights)
        best, change = formulas @ samples / step
        allowed = MAX_SEED_CHANGE * np.abs(best).max()
        rounding = SEED_ROUNDING * max(np.abs(samples).max(), 0.1) / abs(step)
        allowed += np.abs(formulas[1]).sum() * rounding
        # False too for what is no number.
        is_smooth = bool(np.abs(change).max() <= allowed)
        derivative[moves] = best
    return derivative, is_smooth


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
