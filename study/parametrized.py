"""Models as functions of numbers: the values of keys, of names of a study, or of a function."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from numbers import Real
from typing import Any

from ..inputs import dotted, quoted
from ..solver import Model
from ..solver.model.variation import Variation
from .errors import StudyError
from .expressions import LookUp
from .keys import put, value_at, with_varied_bodies


@dataclass(frozen=True)
class Parametrized:
    """A model as a function of its parameters; values: those at which it stands, by name."""

    values: Mapping[str, float]
    make: Callable[[Mapping[str, float]], Model]
    known: Callable[[Mapping[str, float]], LookUp] | None = None
    """what arithmetic may ask for beside the parameters, at their values"""

    def look_up(self, values: Mapping[str, float]) -> LookUp:
        """What names in arithmetic stand for: parameters, or keys of the model."""
        beside = None if self.known is None else self.known(values)

        def found(name: str) -> Any:
            if name in values:
                return values[name]
            if beside is None:
                raise StudyError(f"no {quoted(name)}; there are: {', '.join(values)}")
            return beside(name)

        return found


def of_model(model: Model, parameters: Mapping[str, str] | Sequence[str]) -> Parametrized:
    """A model whose parameters are keys of its file, by names of their own or as they are."""
    named = parameters if isinstance(parameters, Mapping) else {key: key for key in parameters}
    variation = Variation(model)
    given = with_varied_bodies(variation.tables, named.values(), design_of(model))
    values = {name: numeric_value_at(given, key) for name, key in named.items()}

    def tables_at(changed: Mapping[str, float]) -> dict[str, Any]:
        tables = deepcopy(given)
        for name, value in changed.items():
            put(tables, named[name], value)
        return tables

    return Parametrized(
        values,
        lambda changed: variation.model(tables_at(changed)),
        lambda changed: partial(value_at, tables_at(changed)),
    )


def design_of(model: Model) -> Callable[[str, str], float]:
    """The values of design parameters as superelements have them, by body and name."""

    def value(body: str, name: str) -> float:
        element = getattr(model.bodies[body], "superelement", None)
        known = {} if element is None else element.base.derivatives
        if name not in known:
            raise StudyError(
                f"parameters.{dotted([f'bodies.{body}.design.{name}'])}: the superelement has no "
                f"derivative by it; there are: {', '.join(known) or 'none'}"
            )
        return float(known[name].value)

    return value


def of_function(
    function: Callable[..., Model], values: Mapping[str, float] | Sequence[str]
) -> Parametrized:
    """A function of Python that makes the model, with its parameters as keywords."""
    if not isinstance(values, Mapping):
        raise StudyError(
            "parameters: of a function expected their values by name, found names alone"
        )
    numbers = {name: numeric(name, value) for name, value in values.items()}
    return Parametrized(numbers, lambda changed: function(**changed))


def numeric_value_at(tables: Mapping[str, Any], key: str) -> float:
    """The number at a dotted key; `StudyError` for what is no number."""
    try:
        value = value_at(tables, key)
    except StudyError as error:
        raise StudyError(f"parameters.{dotted([key])}: {error}") from error
    if isinstance(value, list):
        raise StudyError(
            f"parameters.{dotted([key])}: expected a number, found a list: name one of "
            f"{', '.join(_numbers_of(key, value))}"
        )
    return numeric(key, value)


def numeric(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise StudyError(f"parameters.{dotted([name])}: expected a number, found {quoted(value)}")
    return float(value)


def _numbers_of(key: str, value: Sequence[Any]) -> Iterator[str]:
    for i, entry in enumerate(value):
        yield from _numbers_of(f"{key}.{i}", entry) if isinstance(entry, list) else [f"{key}.{i}"]
