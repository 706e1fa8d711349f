"""The text of files that users wrote, and TOML, within bounds."""

import os
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..files import FileError, in_one_line, require_regular
from .errors import MAX_QUOTED_LENGTH, InputError, dotted, quoted
from .file_kinds import told_by_beginning

# 64 MiB: files that people write are far smaller, so a larger one is a mistake.
MOST_BYTES = 1 << 26
# Deeper tables are a mistake, or made to exhaust the stack of what reads them.
MAX_NESTING = 32
# TOML promises 64 bits; Python would read any number of digits.
TOML_INTEGERS = range(-(1 << 63), 1 << 63)
Keys = tuple[str, ...]
TOML_SLIPS = {
    r"^Cannot declare.*: '\[[^\[]": (
        "; a table is written once, and each of several joints or loads as [[joints]]"
    ),
    r"=\s*[-+]?\d+,\d": "; decimals take a point",
    r"=\s*(?i:yes|no|on|off|true|false)\b": "; expected true or false",
    r"=\s*[A-Za-z./]": "; texts take quotes",
}
"""what is usual in TOML, by what was said of a line and what is there instead"""


def read_text(path: str | os.PathLike[str], failure: type[Exception] = InputError) -> str:
    """The text of a regular file of at most `MOST_BYTES`, in UTF-8; a `failure` names the file."""
    path = Path(path)
    try:
        require_regular(path)
        if (size := path.stat().st_size) > MOST_BYTES:
            raise failure(f"{path}: expected at most {MOST_BYTES} bytes of text, found {size}")
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        what = told_by_beginning(error.object) or f"not UTF-8: {error}"
        raise failure(f"{path}: not a readable file: {what}") from error
    except OSError as error:
        raise failure(f"{path}: not a readable file: {error.strerror or error}") from error
    except FileError as error:
        raise failure(f"{path}: not a readable file: {error}") from error


def read_toml(
    path: str | os.PathLike[str], failure: type[Exception] = InputError
) -> dict[str, Any]:
    """The document of a TOML file; a `failure` names the file."""
    text = read_text(path, failure)
    try:
        return parse_toml(text)
    except InputError as error:
        raise failure(f"{path}: {error}") from error


def parse_toml(text: str) -> dict[str, Any]:
    """The document of a TOML file, of bounded depth; `InputError` without the name of the file."""
    try:
        document = tomllib.loads(text)
    except RecursionError as error:
        raise _too_deep() from error
    except ValueError as error:  # also an integer of thousands of digits, a date that there is not
        if what := told_by_beginning(text[:MAX_QUOTED_LENGTH].encode()):
            raise InputError(f"not a TOML file: {what}") from error
        said = in_one_line(error)[:MAX_QUOTED_LENGTH]
        raise InputError(f"not a TOML file: {said}{_slip(said, text)}") from error
    _check(document)
    return document


def _slip(said: str, text: str) -> str:
    """The line at which a text ceases to be TOML, and what is usual there."""
    if not (at := re.search(r"at line (\d+)", said)):
        return ""
    lines = text.splitlines()
    line = lines[min(int(at[1]), len(lines)) - 1].strip() if lines else ""
    where = f": {quoted(line)}"
    hints = (hint for slip, hint in TOML_SLIPS.items() if re.search(slip, f"{said}{where}"))
    return where + next(hints, "")


def _check(document: dict[str, Any]) -> None:
    """`InputError` for what is nested too deep, and for integers that TOML does not have."""
    level: list[tuple[Keys, Any]] = [((), document)]
    for _ in range(MAX_NESTING + 1):
        level = [inner for keys, value in level for inner in _items(keys, value)]
        for keys, value in level:
            if isinstance(value, int) and value not in TOML_INTEGERS:
                raise InputError(
                    f"{dotted(keys)}: expected an integer of 64 bits, found {quoted(value)}"
                )
    if level:
        raise _too_deep()


def _items(keys: Keys, value: Any) -> Iterator[tuple[Keys, Any]]:
    """The values of a table or an array, by their keys."""
    if isinstance(value, dict):
        yield from (((*keys, name), inner) for name, inner in value.items())
    elif isinstance(value, list):
        yield from (((*keys, str(number)), inner) for number, inner in enumerate(value))


def _too_deep() -> InputError:
    return InputError(f"expected at most {MAX_NESTING} tables and arrays within one another")
