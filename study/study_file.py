"""The study file: a model or a body, many values of its parameters, and outputs."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from ..files.memory import shortage
from ..files.outputs import clash, resolved
from ..inputs import Table, document_of, read_table, read_toml, rule
from ..inputs.file_kinds import STUDY_FILE
from .case import Case, Kind
from .derived import Derivation, definitions, own_names
from .errors import StudyError
from .goals import OptimizeTable
from .keys import leaves, matching, put, with_texts, with_varied_bodies
from .measured_series import SeriesTable
from .points import Point, grid, rows, samples
from .samples import Design

AnyPath = Annotated[Path, Field(strict=False)]

# Bytes in memory of a case for each byte of its file: Python objects hold the parsed tables.
MEMORY_PER_FILE_BYTE = 20


class FitTable(Table):
    """What a fit compares runs with, and how.

    shift: whether the time of all series may be shifted; derivatives: of the residuals, by two
    runs for each parameter or by one run with dual numbers.
    """

    series: tuple[SeriesTable, ...] = ()
    shift: bool = False
    derivatives: Literal["differences", "dual"] = "differences"


class SensitivityTable(Table):
    """How `duhamel sensitivity` takes derivatives."""

    method: Literal["differences", "dual"] = "differences"


class StudyTables(Table):
    """The tables of a study file."""

    model: AnyPath | None = None
    body: AnyPath | None = None
    parameters: dict[str, Any] | None = None
    design: Design | None = None
    table: AnyPath | None = None
    derived: dict[str, Any] = Field(default_factory=dict)
    outputs: dict[str, str] = Field(default_factory=dict)
    fit: FitTable | None = None
    optimize: OptimizeTable | None = None
    sensitivity: SensitivityTable = SensitivityTable()

    @rule
    def _one_of_each(self) -> None:
        for pair in (("model", "body"), ("parameters", "table")):
            if len(found := self.given(*pair)) != 1:
                raise ValueError(
                    f"expected one of {' and '.join(pair)}, found {' and '.join(found) or 'none'}"
                )
        if self.design is not None and self.parameters is None:
            raise ValueError("design: expected with parameters, found with table")


@dataclass(frozen=True)
class Study:
    """A base file, the cases that vary it, and their outputs.

    `read_study` reads it from a file. See `sweep` for an example.

    Parameters
    ----------
    path : Path
        The study file.
    kind : Kind
        What is made of each case: a run of a model, or a superelement of a body.
    base : Path
        The model or body file that the cases vary.
    folder : Path
        Of the files of the cases and the summary.
    cases : tuple of Case
    outputs : mapping of str
        By name, see docs/studies.md.
    table : Path, optional
        The table of the parameters, if they are not in the study file.
    """

    path: Path
    kind: Kind
    base: Path
    folder: Path
    cases: tuple[Case, ...]
    outputs: Mapping[str, str]
    table: Path | None = None

    @property
    def summary(self) -> Path:
        return self.folder / "summary.csv"

    @property
    def units(self) -> Path:
        return units_beside(self.summary)

    @property
    def inputs(self) -> dict[str | os.PathLike[str], str]:
        """What the cases are made from, by path: the files of the study, and those they name."""
        named: dict[str | os.PathLike[str], str] = {
            case.folder / path: "a file that cases name"
            for case in self.cases
            for _, path in matching(case.document, self.kind.paths)
        }
        if self.table is not None:
            named[self.table] = "the table of the study"
        return named | {self.path: "the study file", self.base: "the base file"}


def units_beside(summary: Path) -> Path:
    """The file with the units of the outputs in a summary."""
    return summary.with_name(f"{summary.stem}-units{summary.suffix}")


def study_schema() -> dict[str, Any]:
    """The JSON schema of study files, by which editors complete and check them.

    Examples
    --------
    >>> sorted(study_schema()["properties"])[:5]
    ['body', 'derived', 'design', 'fit', 'model']
    """
    return document_of(StudyTables, "A study file of Duhamel")


def read_study(path: str | os.PathLike[str], folder: str | os.PathLike[str] | None = None) -> Study:
    """Read a study file, its table and its base file; nothing is written.

    Parameters
    ----------
    path : path
    folder : path, optional
        Of the cases, by default named as the study file and beside it.

    Returns
    -------
    Study

    Raises
    ------
    StudyError
        Names the file, the key and the value found there. See `sweep` for an example.
    """
    path = Path(path).absolute()
    file = read_study_file(path)
    try:
        return _study(file, path, resolved(Path(folder or path.with_suffix(""))))
    except (StudyError, OSError) as error:
        raise StudyError(f"{path}: {error}") from error


def read_study_file(path: Path) -> StudyTables:
    """The tables of a study file; `StudyError` names the file and the key."""
    return read_table(path, StudyTables, StudyError, STUDY_FILE)[0]


def check_outputs(study: Study) -> None:
    """`StudyError` for a file of a case that would replace an input of the study."""
    targets = [target for case in study.cases for target in (case.source, case.target)]
    if found := clash([*targets, study.summary, study.units], study.inputs):
        raise StudyError(f"{study.path}: {found}, which the study would replace")


def _study(file: StudyTables, path: Path, folder: Path) -> Study:
    kind, base = _kind_and_base(file, path.parent)
    given = read_toml(base, StudyError)
    table = None if file.table is None else path.parent / file.table
    points = list(_points(file, table))
    if lacking := shortage(MEMORY_PER_FILE_BYTE * len(points) * base.stat().st_size):
        raise StudyError(f"a study of {len(points)} cases of {base} {lacking}")
    given = with_varied_bodies(given, [*points[0].parameters, *dict(leaves(file.derived))])
    derived = definitions(given, file.derived, points[0].parameters)
    place = "parameters." if table is None else f"{table}: column "
    own = own_names(given, points[0].parameters, derived, place)
    plan = Plan(kind, given, own, derived, path.parent, base.parent).moved(folder)
    cases = []
    for point in points:
        with _named(table, point.name):
            cases.append(
                Case(point.name, point.parameters, plan.document_at(point.parameters), folder)
            )
    return Study(path, kind, base, folder, tuple(cases), file.outputs, table)


def _points(file: StudyTables, table: Path | None) -> Iterator[Point]:
    if table is not None:
        return rows(table)
    if file.design is not None:
        return samples(file.parameters or {}, file.design)
    return grid(file.parameters or {})


@dataclass(frozen=True)
class Plan:
    """How a point becomes a document.

    own: names that are no keys; derived: definitions by key; home: the folder of the study file,
    whose paths are relative to it; folder: that of the cases.
    """

    kind: Kind
    document: Mapping[str, Any]
    own: frozenset[str]
    derived: Mapping[str, Any]
    home: Path
    folder: Path

    def document_at(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The base document with values of parameters, and what is derived from them."""
        return self.derivation_at(values).document

    def derivation_at(self, values: Mapping[str, Any]) -> Derivation:
        """The same, with the values of names of the study's own."""
        derivation = Derivation(deepcopy(dict(self.document)), self.own, self._put)
        for key, value in values.items():
            derivation.give(key, value)
        derivation.derive(self.derived)
        return derivation

    def moved(self, folder: Path) -> "Plan":
        """The same plan for files in another folder, to which their paths are relative."""
        document = with_texts(
            dict(self.document),
            "",
            self.kind.paths,
            lambda text: _relative(self.folder / text, folder),
        )
        return replace(self, document=document, folder=folder)

    def _put(self, document: dict[str, Any], key: str, value: Any) -> None:
        """Give a key a value, whose paths are relative to the study file."""
        put(document, key, with_texts(value, key, self.kind.paths, self._moved))

    def _moved(self, path: str) -> str:
        return _relative(self.home / path, self.folder)


@contextmanager
def _named(table: Path | None, case: str) -> Iterator[None]:
    """Name the table, if there is one, and the case in errors of its keys."""
    try:
        yield
    except StudyError as error:
        raise error if table is None else StudyError(f"{table}: {case}: {error}") from error


def _kind_and_base(file: StudyTables, folder: Path) -> tuple[Kind, Path]:
    # Imports here: each kind takes a second to load its packages.
    if file.model is not None:
        from .simulation import Simulation

        return Simulation(), folder / file.model
    from .preprocessing import Preprocessing

    return Preprocessing(), folder / (file.body or "")


def _relative(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(resolved(path), folder)).as_posix()
