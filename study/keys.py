"""Dotted keys of a TOML document, such as "bodies.hub.mass", "joints.pivot.axis" or
"loads.0.signal".

A part of a key is a key of a table, the `name` of an entry of an array of tables, or the number of
an entry, from 0.
"""

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from fnmatch import fnmatchcase
from typing import Any

from .errors import StudyError


def leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """What a table and the tables inside hold that is no table itself, by dotted keys."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def matching(document: Mapping[str, Any], patterns: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The texts whose keys match one of the patterns, such as "bodies.*.superelement", in the order
    of these.
    """
    for pattern in patterns:
        for key, value in leaves(document):
            if isinstance(value, str) and fnmatchcase(key, pattern):
                yield key, value


def replaced(document: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """A copy of the document with another value at a key; `StudyError` lists the keys there are if
    it is none.
    """
    changed = deepcopy(dict(document))
    place: Any = changed
    *way, last = key.split(".")
    for depth, part in enumerate(way):
        place = place[_entry(place, part, ".".join(way[:depth]))]
    place[_entry(place, last, ".".join(way))] = value
    return changed


def _entry(place: Any, part: str, where: str) -> Any:
    """The key or the number under which `place` holds what `part` names."""
    entries: dict[str, Any] = {}
    if isinstance(place, dict):
        entries = {key: key for key in place}
    elif isinstance(place, list):
        entries = {str(number): number for number in range(len(place))}
        entries |= {entry["name"]: number for number, entry in enumerate(place) if _has_name(entry)}
    if part not in entries:
        raise StudyError(
            f"no {part!r} in {where or 'the file'}; there are: {', '.join(entries) or 'no keys'}"
        )
    return entries[part]


def _has_name(entry: Any) -> bool:
    return isinstance(entry, dict) and isinstance(entry.get("name"), str)
