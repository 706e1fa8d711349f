"""A study file as one model that varies, for derivatives and fits."""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..files import renamed_when_whole
from ..inputs import read_toml, toml_of
from ..solver import FlexibleBody, Model, RigidSuperelement, read_model
from ..solver.model.variation import Variation
from .derived import definitions, own_names
from .errors import StudyError
from .expressions import LookUp
from .keys import leaves, with_varied_bodies
from .parametrized import Parametrized, design_of, numeric, numeric_value_at
from .samples import distribution_of, is_distribution
from .simulation import Simulation
from .study_file import Plan, StudyTables, read_study_file


@dataclass(frozen=True)
class StudyParameter:
    """A parameter with one value.

    deviation: of a normal distribution, else 0; bounds: of a range, in whose logarithm it is
    searched if it is logarithmic.
    """

    value: float
    deviation: float = 0.0
    bounds: tuple[float, float] | None = None
    logarithmic: bool = False


@dataclass(frozen=True, eq=False)
class StudyOfOneModel:
    """What a study file varies, without its cases; plan: how values become a model file.

    inputs: its file, that of the model, and those of superelements.
    """

    path: Path
    base: Path
    inputs: tuple[Path, ...]
    parameters: Mapping[str, StudyParameter]
    parametrized: Parametrized
    plan: Plan
    file: StudyTables

    def write(self, path: Path, values: Mapping[str, float]) -> None:
        """Write the model file with values of the parameters, whole or not at all."""
        tables = self.plan.moved(path.parent).document_at(values)
        with renamed_when_whole(path, failure=StudyError) as temporary:
            temporary.write_text(toml_of(tables), encoding="utf-8")


def read_study_of_one_model(path: str | os.PathLike[str]) -> StudyOfOneModel:
    """Read a study file of a model, and the model with its superelements.

    The value of a parameter is the number that the study file gives it, the mean of its normal
    distribution, what the model file has, or else the middle of its range. `StudyError` names the
    file and the key.
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
    given, model = read_toml(base, StudyError), read_model(base)
    varied = dict(leaves({**file.parameters, **file.derived}))
    given = with_varied_bodies(given, varied, design_of(model))
    found = [_parameter(given, key, value) for key, value in leaves(file.parameters)]
    if not found:
        raise StudyError("parameters: expected numbers by dotted key, found none")
    parameters = dict(found)
    values = {name: parameter.value for name, parameter in found}
    derived = definitions(given, file.derived, values)
    own = own_names(given, values, derived, "parameters.")
    plan = Plan(Simulation(), given, own, derived, path.parent, base.parent)
    # The tables as they stand in the file: its keys are those that users know.
    variation = Variation(model, given)

    def make(changed: Mapping[str, float]) -> Model:
        return variation.model(plan.document_at(changed))

    def known(changed: Mapping[str, float]) -> LookUp:
        return plan.derivation_at(changed).look_up

    family = Parametrized(values, make, known)
    kinds = FlexibleBody | RigidSuperelement
    sources = [Path(body.source) for body in model.bodies.values() if isinstance(body, kinds)]
    return StudyOfOneModel(path, base, (path, base, *sources), parameters, family, plan, file)


def _parameter(given: Mapping[str, Any], key: str, value: Any) -> tuple[str, StudyParameter]:
    if not is_distribution(key, value):
        if not isinstance(value, list):
            return key, StudyParameter(numeric(key, value))
        # The values of a sweep have no middle that one would expect here.
        return key, StudyParameter(numeric_value_at(given, key))
    name, kind, low, high = distribution_of(key, value)
    if kind == "normal":
        return name, StudyParameter(low, deviation=high)
    logarithmic = kind == "log_uniform"
    try:
        start = numeric_value_at(given, name)
    except StudyError:
        if "." in name or name in given:
            raise
        # A name of the study's own has no value in the model file.
        start = math.sqrt(low * high) if logarithmic else 0.5 * (low + high)
    return name, StudyParameter(start, bounds=(low, high), logarithmic=logarithmic)
