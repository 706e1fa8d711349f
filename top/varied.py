"""A mechanism as a function of parameters, for derivatives, fits and searches."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from duhamel import solver
from duhamel.study import Parameter, StudyError
from duhamel.study.outputs import is_series, with_quantity
from duhamel.study.parametrized import of_model

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
        named = {
            name: one if isinstance(one, Parameter) else Parameter(one)
            for name, one in parameters.items()
        }
        self._keys = {name: one.at for name, one in named.items() if isinstance(one.at, str)}
        self._changes = {name: one.at for name, one in named.items() if callable(one.at)}
        self._family = of_model(mechanism.model(settings), self._keys)
        self.parameters = {
            name: Parameter("", one.bounds, self._start(name, one), one.logarithmic)
            for name, one in named.items()
        }

    def make(self, **values: float) -> solver.Model:
        """The model at values of the parameters."""
        family = self._family
        if self._changes:
            changed = self._mechanism.copy()
            for name, change in self._changes.items():
                change(changed, values[name])
            family = of_model(changed.model(self._settings), self._keys)
        return family.make({name: values[name] for name in self._keys})

    def output(self, text: str) -> str:
        """An output of a study, whose quantity may be named as `Run.plot` takes it."""
        return with_quantity(text, self._mechanism.quantity)

    def goal(self, text: str) -> str:
        """The same of what may be an output, or else a name or arithmetic."""
        return text if is_series(text) else self.output(text)

    def _start(self, name: str, parameter: Parameter) -> float:
        if parameter.start is not None:
            return parameter.start
        if name not in self._keys:
            raise StudyError(f"parameters.{name}: of a function expected a start, found none")
        return self._family.values[name]
