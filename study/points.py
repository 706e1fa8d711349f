"""The points of a study: the values of its parameters in each case, from a grid or a table."""

import csv
import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

from ..inputs import InputError, dotted, quoted
from ..inputs.text import parse_toml, read_text
from .errors import StudyError
from .keys import leaves
from .samples import MOST_CASES, Design, is_distribution, sampled

# The column of a table that names its cases.
NAME_COLUMN = "case"


@dataclass(frozen=True)
class Point:
    """A row of a table, a point of a grid, or a sample: values by dotted key or name."""

    name: str
    parameters: Mapping[str, Any]


def grid(parameters: Mapping[str, Any]) -> Iterator[Point]:
    """Every value with every other; the last parameter changes fastest."""
    axes = dict(leaves(parameters))
    for key, values in axes.items():
        if not isinstance(values, list) or not values:
            raise StudyError(
                f"parameters.{dotted([key])}: expected a list of values, found {quoted(values)}"
            )
        if is_distribution(key, values) and not key.endswith(".normal"):
            raise StudyError(
                f"parameters.{dotted([key])}: a distribution wants samples: expected [design]"
            )
    if (cases := prod(map(len, axes.values()))) > MOST_CASES:
        raise StudyError(f"parameters: expected at most {MOST_CASES} cases, found {cases:.6g}")
    if not axes:
        raise StudyError("parameters: expected lists of values by dotted key, found none")
    for number, values in enumerate(product(*axes.values()), start=1):
        yield Point(_numbered(number), dict(zip(axes, values, strict=True)))


def samples(parameters: Mapping[str, Any], design: Design) -> Iterator[Point]:
    """The points of a sampled design, by number."""
    for number, values in enumerate(sampled(parameters, design), start=1):
        yield Point(_numbered(number), values)


def rows(path: Path) -> Iterator[Point]:
    """A case a row, a parameter a column; a column `case` names them."""
    header, *lines = _lines(path)
    if not lines or len(set(header)) < len(header):
        raise StudyError(
            f"{path}: expected a line of different keys and a line a case, "
            f"found {quoted(header)} and {len(lines)}"
        )
    if len(lines) > MOST_CASES:
        raise StudyError(f"{path}: expected at most {MOST_CASES} cases, found {len(lines)}")
    known: set[str] = set()
    for number, row in enumerate(lines, start=1):
        if len(row) != len(header):
            raise StudyError(
                f"{path}: case {number}: expected {len(header)} values, found {len(row)}"
            )
        cells = dict(zip(header, row, strict=True))
        name = cells.pop(NAME_COLUMN, _numbered(number))
        if name in known or not re.fullmatch(r"\w[\w.+-]{0,99}", name):
            raise StudyError(
                f"{path}: case {number}: expected a new name for files, found {quoted(name)}"
            )
        known.add(name)
        yield Point(name, {key: _cell(cell) for key, cell in cells.items()})


def _numbered(number: int) -> str:
    return f"case-{number:04d}"


def _lines(path: Path) -> list[list[str]]:
    """The rows of a table that are not empty, a first one in any case."""
    try:
        text = read_text(path, StudyError).removeprefix("\ufeff")
        lines = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True)
        return [line for line in lines if line] or [[]]
    except csv.Error as error:
        raise StudyError(f"{path}: not a readable table: {error}") from error


def _cell(text: str) -> Any:
    """A value as TOML writes it, or else text."""
    try:
        document = parse_toml(f"value = {text}")
    except InputError:
        return text
    return document["value"] if len(document) == 1 else text
