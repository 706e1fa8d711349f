"""Parameters of models in memory, as fits and searches take them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..inputs import dotted, quoted
from ..solver import Model
from .errors import StudyError
from .one_model import StudyParameter
from .parametrized import Parametrized, numeric, of_function, of_model


@dataclass(frozen=True)
class Parameter:
    """What a fit or a search may change of a model.

    Parameters
    ----------
    at : str or callable
        A key of the model as in its file, "springs.mount.stiffness.0"; for a `Mechanism` also a
        function that gets a copy of it and the value, and changes it. Of a function that makes the
        model there is none: the name of the parameter is its keyword.
    bounds : (low, high), optional
        Which it does not leave.
    start : float, optional
        Where it begins, by default the value of the model.
    logarithmic : bool
        Search in its logarithm, as of what may change by factors.

    Examples
    --------
    >>> from duhamel.study import Parameter
    >>> Parameter("springs.mount.stiffness.0", bounds=(300.0, 3000.0), logarithmic=True).bounds
    (300.0, 3000.0)
    """

    at: str | Callable[[Any, float], None] = ""
    bounds: tuple[float, float] | None = None
    start: float | None = None
    logarithmic: bool = False

    def of_study(self, name: str, value: float) -> StudyParameter:
        """As study files have it, which begins at a value unless it has a start; `StudyError`."""
        start = value if self.start is None else numeric(name, self.start)
        if self.bounds is not None:
            low, high = (numeric(name, end) for end in self.bounds)
            if not low < high or (self.logarithmic and not low > 0.0):
                raise StudyError(
                    f"parameters.{dotted([name])}: expected bounds that rise"
                    f"{' above 0' if self.logarithmic else ''}, found {self.bounds}"
                )
            return StudyParameter(start, 0.0, (low, high), self.logarithmic)
        if self.logarithmic and not start > 0.0:
            raise StudyError(
                f"parameters.{dotted([name])}: expected a start above 0, found {start:g}"
            )
        return StudyParameter(start, logarithmic=self.logarithmic)


def named_parameters(parameters: Mapping[str, str | Parameter]) -> dict[str, Parameter]:
    """Parameters by name, of which a text is the key of one without bounds."""
    return {
        name: one if isinstance(one, Parameter) else Parameter(one)
        for name, one in parameters.items()
    }


def family_of(
    model: Model | Callable[..., Model], parameters: Mapping[str, str | Parameter]
) -> tuple[Parametrized, dict[str, StudyParameter]]:
    """The models of all values, and where the parameters begin."""
    named = named_parameters(parameters)
    if not named:
        raise StudyError("parameters: expected at least one, found none")
    if isinstance(model, Model):
        family = of_model(model, {name: _key(name, one) for name, one in named.items()})
    else:
        family = of_function(model, {name: start_of(name, one) for name, one in named.items()})
    starts = {name: one.of_study(name, family.values[name]) for name, one in named.items()}
    values = {name: one.value for name, one in starts.items()}
    return replace(family, values=values), starts


def _key(name: str, parameter: Parameter) -> str:
    if not isinstance(parameter.at, str) or not parameter.at:
        raise StudyError(
            f"parameters.{dotted([name])}: expected a key of the model, found "
            f"{quoted(parameter.at)}"
        )
    return parameter.at


def start_of(name: str, parameter: Parameter) -> float:
    """Where a parameter of a function begins; `StudyError` where that is not given."""
    if parameter.start is None:
        raise StudyError(f"parameters.{dotted([name])}: of a function expected a start, found none")
    return parameter.start
