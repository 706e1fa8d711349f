"""A study file as one model that varies, for derivatives, fits and optimizations."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..inputs import read_toml
from ..solver import Model, read_model
from ..solver.model.variation import Variation
from .derived import definitions, own_names
from .errors import StudyError
from .keys import leaves
from .parametrized import Parametrized, numeric, numeric_value_at
from .samples import is_distribution
from .simulation import Simulation
from .study_file import Plan, StudyTables, read_study_file


@dataclass(frozen=True, eq=False)
class StudyOfOneModel:
    """What a study file varies, without its cases.

    parametrized: the model by its parameters; deviations: those of parameters with a normal
    distribution; plan: how values become the tables of a model file.
    """

    path: Path
    base: Path
    parametrized: Parametrized
    outputs: Mapping[str, str]
    deviations: Mapping[str, float]
    plan: Plan
    file: StudyTables


def read_study_of_one_model(path: str | os.PathLike[str]) -> StudyOfOneModel:
    """Read a study file of a model, and the model with its superelements.

    The value of a parameter is the number that the study file gives it, the mean of its normal
    distribution, or else what the model file has. `StudyError` names the file and the key.
    """
    path = Path(path).absolute()
    file = read_study_file(path)
    try:
        return _study_of_one_model(file, path)
    except (StudyError, OSError) as error:
        raise StudyError(f"{path}: {error}") from error


def _study_of_one_model(file: StudyTables, path: Path) -> StudyOfOneModel:
    if file.model is None or file.parameters is None:
        raise StudyError("expected model and parameters, found body or table")
    base = path.parent / file.model
    given = read_toml(base, StudyError)
    values, deviations = dict[str, float](), dict[str, float]()
    for key, value in leaves(file.parameters):
        name, kind = key, ""
        if is_distribution(key, value):
            name, _, kind = key.rpartition(".")
        if kind == "normal":
            values[name], deviations[name] = map(float, value)
        elif isinstance(value, list):
            # Values and ranges of a sweep have no middle that one would expect here.
            values[name] = numeric_value_at(given, name)
        else:
            values[name] = numeric(name, value)
    if not values:
        raise StudyError("parameters: expected numbers by dotted key, found none")
    derived = definitions(given, file.derived, values)
    own = own_names(given, values, derived, "parameters.")
    plan = Plan(Simulation(), given, own, derived, path.parent, base.parent)
    # The tables as they stand in the file: its keys are those that users know.
    variation = Variation(read_model(base), given)

    def make(changed: Mapping[str, float]) -> Model:
        return variation.model(plan.document_at(changed))

    parametrized = Parametrized(values, make)
    return StudyOfOneModel(path, base, parametrized, file.outputs, deviations, plan, file)
