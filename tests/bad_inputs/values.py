"""Values that a key of a TOML file should not have, and the keys that tables may have."""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from datetime import date
from math import inf, nan
from typing import Any, get_args, get_origin

from pydantic import BaseModel

DEEP: list[Any] = []
for _ in range(20):
    DEEP = [DEEP]

VALUES: dict[str, Any] = {
    "true": True,
    "zero": 0,
    "minus one": -1,
    "a fraction": 0.5,
    "minus a fraction": -2.5,
    "nan": nan,
    "inf": inf,
    "minus inf": -inf,
    "the largest number": 1.7e308,
    "the smallest number": 5e-324,
    "a large integer": 2**62,
    "an integer beyond 64 bits": 10**30,
    "1e30": 1e30,
    "no text": "",
    "text": "nonsense",
    "long text": "x" * 100_000,
    "text with a line break": "a\nb",
    "text with NUL": "a\0b",
    "text with a slash": "a/../b",
    "two dots": "..",
    "a date": date(2020, 2, 29),
    "no array": [],
    "numbers": [1.0, 2.0, 3.0],
    "zeros": [0, 0, 0],
    "huge numbers": [1e308, -1e308, 1e308],
    "nan in an array": [nan, 0.0, 1.0],
    "texts": ["a", "b", "c"],
    "arrays": [[1, 2], [3]],
    "nested deep": DEEP,
    "no table": {},
    "a table": {"nonsense": 1},
    "an array of tables": [{"nonsense": 1}],
}
"""by what they are"""

UNKNOWN = "nonsense"
"""no key of any table"""

Place = tuple[str | int, ...]
"""keys and numbers that lead to a value in a document"""


def declared(kind: type[BaseModel], document: Any, at: Place = ()) -> Iterator[Place]:
    """The places of all keys that the tables of a document may have, whether it has them or not."""
    for name, field in kind.model_fields.items():
        key = field.alias or name
        yield (*at, key)
        for table in table_kinds(field.annotation):
            for place, value in _tables_in(field.annotation, document.get(key), (*at, key)):
                if _is_of_kind(value, table):
                    yield from declared(table, value, place)
    yield (*at, UNKNOWN)


def _is_of_kind(value: Mapping[str, Any], table: type[BaseModel]) -> bool:
    """Whether a value is of the kind that this table is for, by its key `type` or what it needs."""
    fields = table.model_fields
    needed = {field.alias or name for name, field in fields.items() if field.is_required()}
    kinds = get_args(fields["type"].annotation) if "type" in fields else ()
    return needed <= value.keys() and (not kinds or value.get("type") in kinds)


def table_kinds(annotation: Any) -> Iterator[type[BaseModel]]:
    """The tables that a field of this type holds."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from table_kinds(inner)


def changed(document: Any, place: Place, value: Any) -> Any:
    """A copy of a document with another value at a place; without one if the value is `None`."""
    copy = deepcopy(document)
    table = copy
    for key in place[:-1]:
        table = table[key]
    if value is None:
        del table[place[-1]]
    else:
        table[place[-1]] = value
    return copy


def value_at(document: Any, place: Place) -> Any:
    """The value at a place; `None` if there is none."""
    for key in place:
        if isinstance(document, Mapping) and key not in document:
            return None
        document = document[key]
    return document


def dotted(place: Place) -> str:
    return ".".join(map(str, place))


def _tables_in(annotation: Any, value: Any, at: Place) -> Iterator[tuple[Place, Any]]:
    if isinstance(value, list):
        yield from (((*at, i), item) for i, item in enumerate(value))
    elif isinstance(value, Mapping) and get_origin(annotation) is dict:
        yield from (((*at, name), item) for name, item in value.items())
    elif isinstance(value, Mapping):
        yield at, value
