"""Runs with derivatives by the parameters of a function that makes the model."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ...files.blas import one_blas_thread
from ...results.results import Results
from ..compiler.targets import DERIVATIVE_COUNTS
from ..errors import about
from ..model.model import Model
from .rows import MovedSource, NotedSource
from .run import DualRun, count_for, recorded_rows, run_with_derivatives
from .scope import check_scope, has_kinks, surface_error
from .seeds import Start, seeds_of, start_of

Values = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class DifferentiatedRun:
    """A run and its derivatives by parameters.

    results: of the run without derivatives, whose notes these have; places: of each parameter, the
    run that has its derivative, and its number there; one_sided: by parameter, -1 or 1 where the
    model is valid on one side of its value alone; least_errors: by parameter, of each derivative;
    switches: whether forces had kinks.
    """

    results: Results
    places: Mapping[str, tuple[DualRun, int]]
    one_sided: Mapping[str, int]
    least_errors: Mapping[str, float]
    switches: bool

    def moved(self, parameter: str, distance: float) -> Results:
        """What results would be if all numbers followed their derivatives so far."""
        run, number = self.places[parameter]
        return self.results.read_from(lambda source: MovedSource(source, run, number, distance))

    @property
    def values(self) -> Results:
        """The results as they came out beside the derivatives."""
        run, _ = next(iter(self.places.values()))
        return self.results.read_from(lambda source: MovedSource(source, run, -1, 0.0))


class Differentiation:
    """Derivatives of what is read of the results of a family of models.

    make: the model of values of parameters; scales: the sizes of parameters; results: of the run
    without derivatives; read: reads what is asked for.
    """

    def __init__(
        self,
        make: Callable[[Values], Model],
        scales: Values,
        results: Results,
        read: Callable[[Results], object],
    ) -> None:
        self._make, self._scales, self._results = make, dict(scales), results
        self._noted = NotedSource(results.source)
        read(results.read_from(lambda source: self._noted))

    def at(self, values: Values) -> DifferentiatedRun:
        """The run at some values.

        `DerivativeError` for what is not covered, and for a parameter that changes more of the
        model than its numbers.
        """
        model, most = self._make(values), max(DERIVATIVE_COUNTS)
        with about(model.path), one_blas_thread():
            start = start_of(model, recorded_rows)
            check_scope(start.lowered, count_for(min(len(self._scales), most)))
            seeds = {}
            for name, scale in self._scales.items():

                def start_at(value: float, name: str = name) -> Start:
                    return self._start({**values, name: value})

                seeds[name] = seeds_of(start, start_at, name, values[name], scale)
            arrays = self._noted.arrays_of(start.lowered)
            places: dict[str, tuple[DualRun, int]] = {}
            names = list(seeds)
            for first in range(0, len(names), most):
                group = names[first : first + most]
                run = run_with_derivatives(start, [seeds[name] for name in group], arrays)
                places |= {name: (run, i) for i, name in enumerate(group)}
        one_sided = {name: one.one_sided for name, one in seeds.items() if one.one_sided}
        switches = has_kinks(start.lowered) or any(run.switches for run, _ in places.values())
        least = surface_error(start.lowered)
        errors = {name: max(one.error, least) for name, one in seeds.items()}
        return DifferentiatedRun(self._results, places, one_sided, errors, switches)

    def _start(self, values: Values) -> Start:
        return start_of(self._make(values), recorded_rows)
