"""The study file: a model or a body, many values of its parameters, and outputs."""

import csv
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import product
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, model_validator

from ..inputs import InputError, Table, parse_toml, read_table, read_toml
from .case import Case, Kind
from .errors import StudyError
from .keys import leaves, matching, replaced

AnyPath = Annotated[Path, Field(strict=False)]

NAME = "case"
"""the column of a table that names its cases"""


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
    path = Path(path).resolve()
    try:
        file, _ = read_table(path, _StudyFile)
        return _study(
            file, path, path.with_suffix("") if folder is None else Path(folder).resolve()
        )
    except InputError as error:
        raise StudyError(str(error)) from error
    except StudyError as error:
        raise StudyError(f"{path}: {error}") from error


def _study(file: _StudyFile, path: Path, folder: Path) -> Study:
    kind, base = _kind_and_base(file, path.parent)
    document = _relocated(_document(base), kind.paths, base.parent, folder)
    points = _grid(file.parameters or {}) if file.table is None else _rows(path.parent / file.table)
    cases = []
    for point in points:
        changed = document
        for key, value in point.parameters.items():
            is_path = isinstance(value, str) and any(
                fnmatchcase(key, pattern) for pattern in kind.paths
            )
            changed = replaced(
                changed, key, _relative(path.parent / value, folder) if is_path else value
            )
        cases.append(Case(point.name, point.parameters, changed, folder))
    return Study(path, kind, base, folder, tuple(cases), file.outputs)


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
    return Path(os.path.relpath(path.resolve(), folder)).as_posix()


def _grid(parameters: Mapping[str, Any]) -> Iterator[_Values]:
    """Every value with every other; the last parameter changes fastest."""
    axes = dict(leaves(parameters))
    for key, values in axes.items():
        if not isinstance(values, list) or not values:
            raise StudyError(f"parameters.{key}: expected a list of values, found {values!r}")
    if not axes:
        raise StudyError("parameters: expected lists of values by dotted key, found none")
    for number, values in enumerate(product(*axes.values()), start=1):
        yield _Values(f"case-{number:04d}", dict(zip(axes, values, strict=True)))


def _rows(path: Path) -> Iterator[_Values]:
    """A case a row, a parameter a column; a column `case` names them."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            header, *rows = [row for row in csv.reader(file, skipinitialspace=True) if row] or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise StudyError(f"{path}: not a readable table: {error}") from error
    if not rows or len(set(header)) < len(header):
        raise StudyError(
            f"{path}: expected a line of different keys and a line a case, "
            f"found {header} and {len(rows)}"
        )
    known: set[str] = set()
    for number, row in enumerate(rows, start=1):
        if len(row) != len(header):
            raise StudyError(
                f"{path}: case {number}: expected {len(header)} values, found {len(row)}"
            )
        cells = dict(zip(header, row, strict=True))
        name = cells.pop(NAME, f"case-{number:04d}")
        if name in known or not re.fullmatch(r"\w[\w.+-]*", name):
            raise StudyError(
                f"{path}: case {number}: expected a new name for files, found {name!r}"
            )
        known.add(name)
        yield _Values(name, {key: _cell(cell) for key, cell in cells.items()})


def _cell(text: str) -> Any:
    """A value as TOML writes it, or else text."""
    try:
        document = parse_toml(f"value = {text}")
    except InputError:
        return text
    return document["value"] if len(document) == 1 else text
