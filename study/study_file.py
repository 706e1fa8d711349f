"""The study file: a model or a body, many values of its parameters, and outputs."""

import csv
import io
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import product
from math import prod
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, model_validator

from ..files.memory import shortage
from ..files.outputs import clash, resolved
from ..inputs import InputError, Table, parse_toml, quoted, read_table, read_text, read_toml
from .case import Case, Kind
from .errors import StudyError
from .keys import leaves, matching, replaced

AnyPath = Annotated[Path, Field(strict=False)]

NAME = "case"
"""the column of a table that names its cases"""
MOST_CASES = 100_000
"""of a study"""
COPIES = 20
"""bytes in memory of a case for each byte of its file"""


class _StudyFile(Table):
    model: AnyPath | None = None
    body: AnyPath | None = None
    parameters: dict[str, Any] | None = None
    table: AnyPath | None = None
    outputs: dict[str, str] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_of_each(self) -> "_StudyFile":
        for pair in (("model", "body"), ("parameters", "table")):
            present = [key for key in pair if getattr(self, key) is not None]
            if len(present) != 1:
                raise ValueError(
                    f"expected one of {' and '.join(pair)}, found {' and '.join(present) or 'none'}"
                )
        return self


@dataclass(frozen=True)
class Study:
    """A base file, the cases that vary it, and their outputs by name (outputs.py)."""

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


@dataclass(frozen=True)
class _Values:
    """A row of a table, or a point of a grid."""

    name: str
    parameters: Mapping[str, Any]


def read_study(path: str | os.PathLike[str], folder: str | os.PathLike[str] | None = None) -> Study:
    """Read a study file, its table and its base file.

    folder: of the cases, by default named as the study file and beside it. Nothing is written.
    `StudyError` names the file, the key and the value found there.
    """
    path = Path(path).absolute()
    try:
        file, _ = read_table(path, _StudyFile)
        return _study(file, path, resolved(Path(folder or path.with_suffix(""))))
    except InputError as error:
        raise StudyError(str(error)) from error
    except (StudyError, OSError) as error:
        raise StudyError(f"{path}: {error}") from error


def check_outputs(study: Study) -> None:
    """`StudyError` for a file of a case that would replace an input of the study."""
    targets = [target for case in study.cases for target in (case.source, case.target)]
    if found := clash([*targets, study.summary], study.inputs):
        raise StudyError(f"{study.path}: {found}, which the study would replace")


def _study(file: _StudyFile, path: Path, folder: Path) -> Study:
    kind, base = _kind_and_base(file, path.parent)
    document = _relocated(_document(base), kind.paths, base.parent, folder)
    table = None if file.table is None else path.parent / file.table
    points = list(_grid(file.parameters or {}) if table is None else _rows(table))
    if lacking := shortage(COPIES * len(points) * base.stat().st_size):
        raise StudyError(f"a study of {len(points)} cases of {base} {lacking}")
    cases = []
    for point in points:
        changed = document
        for key, value in point.parameters.items():
            is_path = isinstance(value, str) and any(
                fnmatchcase(key, pattern) for pattern in kind.paths
            )
            value = _relative(path.parent / value, folder) if is_path else value
            with _named(table, point.name):
                changed = replaced(changed, key, value)
        cases.append(Case(point.name, point.parameters, changed, folder))
    return Study(path, kind, base, folder, tuple(cases), file.outputs, table)


@contextmanager
def _named(table: Path | None, case: str) -> Iterator[None]:
    """Name the table, if there is one, and the case in errors of its keys."""
    try:
        yield
    except StudyError as error:
        raise error if table is None else StudyError(f"{table}: {case}: {error}") from error


def _kind_and_base(file: _StudyFile, folder: Path) -> tuple[Kind, Path]:
    # Imports here: each kind takes a second to load its packages.
    if file.model is not None:
        from .simulation import Simulation

        return Simulation(), folder / file.model
    from .preprocessing import Preprocessing

    return Preprocessing(), folder / (file.body or "")


def _document(base: Path) -> dict[str, Any]:
    try:
        return read_toml(base)
    except InputError as error:
        raise StudyError(str(error)) from error


def _relocated(
    document: dict[str, Any], paths: tuple[str, ...], old: Path, new: Path
) -> dict[str, Any]:
    """The document with its paths relative to another folder."""
    for key, value in matching(document, paths):
        document = replaced(document, key, _relative(old / value, new))
    return document


def _relative(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(resolved(path), folder)).as_posix()


def _grid(parameters: Mapping[str, Any]) -> Iterator[_Values]:
    """Every value with every other; the last parameter changes fastest."""
    axes = dict(leaves(parameters))
    for key, values in axes.items():
        if not isinstance(values, list) or not values:
            raise StudyError(f"parameters.{key}: expected a list of values, found {quoted(values)}")
    if (cases := prod(map(len, axes.values()))) > MOST_CASES:
        raise StudyError(f"parameters: expected at most {MOST_CASES} cases, found {cases:.6g}")
    if not axes:
        raise StudyError("parameters: expected lists of values by dotted key, found none")
    for number, values in enumerate(product(*axes.values()), start=1):
        yield _Values(f"case-{number:04d}", dict(zip(axes, values, strict=True)))


def _rows(path: Path) -> Iterator[_Values]:
    """A case a row, a parameter a column; a column `case` names them."""
    header, *rows = _lines(path)
    if not rows or len(set(header)) < len(header):
        raise StudyError(
            f"{path}: expected a line of different keys and a line a case, "
            f"found {quoted(header)} and {len(rows)}"
        )
    if len(rows) > MOST_CASES:
        raise StudyError(f"{path}: expected at most {MOST_CASES} cases, found {len(rows)}")
    known: set[str] = set()
    for number, row in enumerate(rows, start=1):
        if len(row) != len(header):
            raise StudyError(
                f"{path}: case {number}: expected {len(header)} values, found {len(row)}"
            )
        cells = dict(zip(header, row, strict=True))
        name = cells.pop(NAME, f"case-{number:04d}")
        if name in known or not re.fullmatch(r"\w[\w.+-]{0,99}", name):
            raise StudyError(
                f"{path}: case {number}: expected a new name for files, found {quoted(name)}"
            )
        known.add(name)
        yield _Values(name, {key: _cell(cell) for key, cell in cells.items()})


def _lines(path: Path) -> list[list[str]]:
    """The rows of a table that are not empty, a first one in any case."""
    try:
        text = read_text(path).removeprefix("\ufeff")
        rows = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True)
        return [row for row in rows if row] or [[]]
    except csv.Error as error:
        raise StudyError(f"{path}: not a readable table: {error}") from error
    except InputError as error:
        raise StudyError(str(error)) from error


def _cell(text: str) -> Any:
    """A value as TOML writes it, or else text."""
    try:
        document = parse_toml(f"value = {text}")
    except InputError:
        return text
    return document["value"] if len(document) == 1 else text
