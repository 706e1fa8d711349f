"""Dotted keys of a TOML document: "bodies.hub.mass", "joints.pivot.axis", "loads.0.signal".

A name in a dotted key is a key of a table, the `name` of an entry of an array of tables, or the
number of an entry, from 0.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from fnmatch import fnmatchcase
from typing import Any

from ..inputs import dotted, quoted
from .errors import StudyError

WORDS_FOR_PATHS = ("frf",)
"""texts at keys of paths that are none: mass `from` the responses, in place of a file"""
NEUTRAL_FACTOR = 1.0
"""of `bodies.NAME.scale.KEY`, which a model file need not have to be varied"""


def leaves(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a table and of the tables inside, without the tables, by dotted keys."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def matching(document: Mapping[str, Any], patterns: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The texts whose keys match one of the patterns, such as "bodies.*.superelement".

    In the order of the patterns; entries of arrays by their numbers.
    """
    for pattern in patterns:
        for key, text in _texts(document, ""):
            if fnmatchcase(key, pattern) and text not in WORDS_FOR_PATHS:
                yield key, text


def with_texts(value: Any, key: str, patterns: Sequence[str], change: Callable[[str], str]) -> Any:
    """A copy of the value at a key, in which texts whose keys match a pattern are changed."""
    if isinstance(value, str):
        named = any(fnmatchcase(key, pattern) for pattern in patterns)
        return change(value) if named and value not in WORDS_FOR_PATHS else value
    if isinstance(value, Mapping):
        return {
            name: with_texts(entry, below(key, name), patterns, change)
            for name, entry in value.items()
        }
    if isinstance(value, list):
        return [
            with_texts(entry, below(key, number), patterns, change)
            for number, entry in enumerate(value)
        ]
    return value


def below(key: str, name: str | int) -> str:
    """The dotted key of an entry of the value at a key, "" for the document."""
    return f"{key}.{name}" if key else str(name)


def _texts(value: Any, key: str) -> Iterator[tuple[str, str]]:
    """The texts in a value by dotted key."""
    if isinstance(value, str):
        yield key, value
    elif isinstance(value, Mapping):
        for name, entry in value.items():
            yield from _texts(entry, below(key, name))
    elif isinstance(value, list):
        for number, entry in enumerate(value):
            yield from _texts(entry, below(key, number))


def with_varied_bodies(
    document: Mapping[str, Any],
    keys: Iterable[str],
    design: Callable[[str, str], float] = lambda body, name: NEUTRAL_FACTOR,
) -> dict[str, Any]:
    """A copy of a document with the parameters of superelements that are among the keys.

    Also as the beginnings of keys, that end in a distribution. design: the value of a design
    parameter of a body as it is, by their names.
    """
    found = deepcopy(dict(document))
    for key in keys:
        first, body, table, name, *_ = *key.split("."), "", "", ""
        bodies = found.get(first, {}) if first == "bodies" else {}
        if body not in bodies:
            continue
        if table == "scale":
            bodies[body].setdefault(table, {}).setdefault(name, NEUTRAL_FACTOR)
        elif table == "design" and name not in bodies[body].get(table, {}):
            bodies[body].setdefault(table, {})[name] = design(body, name)
    return found


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
