"""Dotted keys of a TOML document: "bodies.hub.mass", "joints.pivot.axis", "loads.0.signal".

A name in a dotted key is a key of a table, the `name` of an entry of an array of tables, or the
number of an entry, from 0.
"""

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from fnmatch import fnmatchcase
from typing import Any

from ..inputs import dotted, quoted
from .errors import StudyError


def leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a table and of the tables inside, without the tables, by dotted keys."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def matching(document: Mapping[str, Any], patterns: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The texts whose keys match one of the patterns, such as "bodies.*.superelement".

    In the order of the patterns.
    """
    for pattern in patterns:
        for key, value in leaves(document):
            if isinstance(value, str) and fnmatchcase(key, pattern):
                yield key, value


def replaced(document: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """A copy of the document with another value at a key; `StudyError` as of `put`."""
    changed = deepcopy(dict(document))
    put(changed, key, value)
    return changed


def put(document: dict[str, Any], key: str, value: Any) -> None:
    """Give a key of the document a copy of another value.

    `StudyError` lists the known keys if it has no such key.
    """
    path, _, last = key.rpartition(".")
    table = value_at(document, path) if path else document
    table[_entry(table, last, path)] = deepcopy(value)


def value_at(document: Mapping[str, Any], key: str) -> Any:
    """The value at a key; `StudyError` lists the known keys if there is no such key."""
    table: Any = document
    for entry in entries(document, key):
        table = table[entry]
    return table


def entries(document: Mapping[str, Any], key: str) -> tuple[str | int, ...]:
    """The keys and numbers, one inside the other, that a dotted key stands for.

    The same for an entry by its name and by its number. `StudyError` as of `value_at`.
    """
    table: Any = document
    found: list[str | int] = []
    path = key.split(".")
    for depth, name in enumerate(path):
        found.append(_entry(table, name, ".".join(path[:depth])))
        table = table[found[-1]]
    return tuple(found)


def _entry(table: Any, name: str, path: str) -> Any:
    """The key or the number of an entry of a table, or of an array of tables, at a path."""
    known: dict[str, Any] = {}
    if isinstance(table, dict):
        known = {key: key for key in table}
    elif isinstance(table, list):
        known = {str(number): number for number in range(len(table))}
        known |= {entry["name"]: number for number, entry in enumerate(table) if _has_name(entry)}
    if name not in known:
        raise StudyError(
            f"no {quoted(name)} in {path or 'the file'}; "
            f"there are: {', '.join(map(_shown, known)) or 'no keys'}"
        )
    return known[name]


def _shown(key: str) -> str:
    return dotted([key])


def _has_name(entry: Any) -> bool:
    return isinstance(entry, dict) and isinstance(entry.get("name"), str)
