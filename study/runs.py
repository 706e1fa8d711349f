"""Runs of one model at several values of its parameters, on all cores."""

import warnings
from collections.abc import Mapping, Sequence

from ..results import Results
from ..solver import Model, ValidityWarning, simulate_many
from .parametrized import Parametrized
from .simulation import Simulation


def runs_at(
    family: Parametrized, points: Sequence[Mapping[str, float]]
) -> list[Results | Exception]:
    """The results at each point, or why there are none; their warnings are not told."""
    failures = Simulation().failures
    models: list[Model | Exception] = []
    for point in points:
        try:
            models.append(family.make(point))
        except failures as error:
            models.append(error)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        runs = iter(
            simulate_many([one for one in models if isinstance(one, Model)], failures="keep")
        )
    found = [next(runs) if isinstance(one, Model) else one for one in models]
    for one in found:
        # Anything else is a defect of the program, and shows its traceback.
        if isinstance(one, Exception) and not isinstance(one, failures):
            raise one
    return found
