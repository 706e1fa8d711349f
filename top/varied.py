"""A mechanism as a function of parameters, for derivatives, fits and searches."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from duhamel import solver
from duhamel.study import Parameter, StudyError
from duhamel.study.outputs import is_series, with_quantity
from duhamel.study.parameter import named_parameters, start_of
from duhamel.study.parametrized import Parametrized, numeric, of_model

if TYPE_CHECKING:
    from .mechanism import Mechanism

AnyParameter = str | Parameter


class VariedMechanism:
    """A mechanism whose parameters are keys of its model file, or functions that change a copy.

    parameters: as `duhamel.study` takes them with a function that makes the model, which is `make`.
    """

    def __init__(
        self,
        mechanism: "Mechanism",
        parameters: Mapping[str, AnyParameter],
        settings: solver.Settings,
    ) -> None:
        self._mechanism, self._settings = mechanism, settings
        named = named_parameters(parameters)
        self._keys = {name: one.at for name, one in named.items() if isinstance(one.at, str)}
        self._changes = {name: one.at for name, one in named.items() if callable(one.at)}
        self._first = self._changed({name: start_of(name, named[name]) for name in self._changes})
        # A function of Python may make what no file can hold.
        first = self._first.model(settings)
        self._family = (
            of_model(first, self._keys) if self._keys else Parametrized({}, lambda _: first)
        )
        starts = {name: one.start for name, one in named.items() if one.start is not None}
        starts = {**self._family.values, **starts}
        self.parameters = {
            name: Parameter("", one.bounds, starts[name], one.logarithmic)
            for name, one in named.items()
        }

    def make(self, **values: float) -> solver.Model:
        """The model at values of the parameters."""
        if not self._changes:
            return self._family.make(values)
        model = self._changed(values).model(self._settings)
        at_keys = {name: values[name] for name in self._keys}
        return of_model(model, self._keys).make(at_keys) if at_keys else model

    def at(self, values: Mapping[str, float]) -> solver.Model:
        """The same of values that a user gives, one of each parameter; `StudyError` otherwise."""
        for names, told in ((values, "no such parameter"), (self.parameters, "has no value")):
            if wrong := [one for one in names if one not in values or one not in self.parameters]:
                raise StudyError(
                    f"values.{wrong[0]}: {told}; there are: {', '.join(self.parameters)}"
                )
        return self.make(**{name: numeric(name, value) for name, value in values.items()})

    def _changed(self, values: Mapping[str, float]) -> "Mechanism":
        """A copy that the functions have changed; without any the mechanism itself."""
        if not self._changes:
            return self._mechanism
        changed = self._mechanism.copy()
        for name, change in self._changes.items():
            change(changed, values[name])
        return changed

    def output(self, text: str) -> str:
        """An output of a study, whose quantity may be named as `Run.plot` takes it."""
        return with_quantity(text, self._first.quantity)

    def goal(self, text: str) -> str:
        """The same of what may be an output, or else a name or arithmetic."""
        return text if is_series(text) else self.output(text)
