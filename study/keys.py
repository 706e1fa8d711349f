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
        for key, value in _with_arrays(document):
            if isinstance(value, str) and fnmatchcase(key, pattern):
                yield key, value


def _with_arrays(part: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a document, also in arrays of tables, whose entries have numbers."""
    if isinstance(part, Mapping):
        items = [(str(key), value) for key, value in part.items()]
    elif isinstance(part, list) and any(isinstance(item, Mapping) for item in part):
        items = [(str(number), item) for number, item in enumerate(part)]
    else:
        yield prefix.removesuffix("."), part
        return
    for key, value in items:
        yield from _with_arrays(value, f"{prefix}{key}.")


def replaced(document: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """A copy of the document with another value at a key.

    `StudyError` lists the known keys if it has no such key.
    """
    changed = deepcopy(dict(document))
    table: Any = changed
    *path, last = key.split(".")
    for depth, name in enumerate(path):
        table = table[_entry(table, name, ".".join(path[:depth]))]
    table[_entry(table, last, ".".join(path))] = value
    return changed


def _entry(table: Any, name: str, path: str) -> Any:
    """The key or the number of an entry of a table, or of an array of tables, at a path."""
    entries: dict[str, Any] = {}
    if isinstance(table, dict):
        entries = {key: key for key in table}
    elif isinstance(table, list):
        entries = {str(number): number for number in range(len(table))}
        entries |= {entry["name"]: number for number, entry in enumerate(table) if _has_name(entry)}
    if name not in entries:
        raise StudyError(
            f"no {quoted(name)} in {path or 'the file'}; "
            f"there are: {', '.join(map(_shown, entries)) or 'no keys'}"
        )
    return entries[name]


def _shown(key: str) -> str:
    return dotted([key])


def _has_name(entry: Any) -> bool:
    return isinstance(entry, dict) and isinstance(entry.get("name"), str)
