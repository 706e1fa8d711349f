"""JSON schemas of the keys of entries, and of families."""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass
from math import inf
from typing import Any

from ...inputs import Table, member_of
from .entry import ANY_NUMBER, FieldSpec, note
from .forms import Family, Form

Schema = dict[str, Any]


@dataclass(frozen=True)
class ValueInWords:
    """An annotation of a key: the values that it takes, in words, and its default."""

    what: str | Callable[[], str]
    default: Any
    deprecated: bool = False

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> Schema:
        schema: Schema = dict(handler(core_schema))
        what = self.what if isinstance(self.what, str) else self.what()
        # An enumeration says itself what is expected.
        if what and "enum" not in schema:
            schema["expected"] = what
        # "" stands for a name that is numbered; JSON has no infinity.
        if isinstance(self.default, bool | int | float | str) and self.default not in ("", inf):
            schema["default"] = self.default
        if self.deprecated:
            schema["deprecated"] = True
        return schema


def value_in_words(field: "Field[Any]", hint: Any) -> ValueInWords:
    takes = note(hint, FieldSpec)
    what = "" if takes is None or takes is ANY_NUMBER else takes.what
    return ValueInWords(what, None if field.default is MISSING else field.default)


def members_of(family: str) -> Schema:
    """A member, a list of them, or a table of either by a name."""
    some = [member_of(family), {"type": "array", "items": member_of(family)}]
    named = {"type": "object", "additionalProperties": {"anyOf": some}}
    return {"anyOf": [*some, named]}


def definition(
    family: Family, tables: Mapping[tuple[Form, ...], type[Table]]
) -> Callable[[Mapping[type, Schema]], Schema]:
    """The definition of a family: a number, or a table of one of its forms."""

    def define(references: Mapping[type, Schema]) -> Schema:
        number = [] if family.number is None else [{"type": "number"}]
        return {"anyOf": [*number, *(references[table] for table in tables.values())]}

    return define
