"""Tables of a TOML file as frozen models."""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from .errors import InputError, did_you_mean, dotted, quoted
from .file_kinds import TomlKind, mistaken_for
from .json_schema import describe
from .text import parse_toml, read_text

# Characters: a text is a name, a path, a formula or a line of words.
MAX_TEXT_LENGTH = 1000
# One line reports as many; further ones often follow from the first.
MOST_FAILURES = 5


def expected(form: str) -> WrapValidator:
    """One message for a value of several types: `form` is expected, and the value found."""

    def check(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        try:
            return handler(value)
        except ValidationError as error:
            raise ValueError(f"expected {form}, found {quoted(_plain(value))}") from error

    return WrapValidator(check)


Vector = Annotated[tuple[float, float, float], expected("three numbers")]


class _OneLine(type(BaseModel)):  # type: ignore[misc]
    """The class of tables, whose failures are one line where they are made in Python too."""

    def __call__(cls, *args: Any, **given: Any) -> Any:
        try:
            return super().__call__(*args, **given)
        except ValidationError as error:
            raise InputError(f"{cls.__name__}: {_messages(error.errors(), given)}") from error


if TYPE_CHECKING:
    _Model = BaseModel
else:

    class _Model(BaseModel, metaclass=_OneLine):
        pass


class Table(_Model):
    """A table of a file: frozen, of finite numbers, without unknown keys; text is no number."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        strict=True,
        str_max_length=MAX_TEXT_LENGTH,
        # A table within another is read by the validator of the whole: none of its own is made.
        defer_build=True,
    )

    documented: ClassVar[tuple[type[Any], ...]] = ()
    """the classes whose docstrings describe the keys, besides this one"""

    def given(self, *keys: str) -> dict[str, Any]:
        """Those of some keys that have a value, with it."""
        return {key: value for key in keys if (value := getattr(self, key)) is not None}

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        schema: dict[str, Any] = handler(core_schema)
        describe(handler.resolve_ref_schema(schema), (*cls.documented, cls))
        return schema

    absent: ClassVar[Mapping[str, str]] = {}
    """keys that one may expect from tables like this, and why it has none"""

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        known = {field.alias or name: name for name, field in cls.model_fields.items()}
        for key in data if isinstance(data, Mapping) else ():
            if key not in known and key not in cls.model_fields:
                if key in cls.absent:
                    raise ValueError(f"unknown key {quoted(key)}: {cls.absent[key]}")
                meant = did_you_mean(key, known, cutoff=0.5) or f"; known are {', '.join(known)}"
                raise ValueError(f"unknown key {quoted(key)}{meant}")
        return (
            {key: _frozen(value) for key, value in data.items()}
            if isinstance(data, Mapping)
            else data
        )


AnyTable = TypeVar("AnyTable", bound=Table)


def rule(method: Callable[[AnyTable], None]) -> Any:
    """A method that a table calls when it is made; ValueError for keys that break the rule."""

    def checked(table: AnyTable) -> AnyTable:
        method(table)
        return table

    return model_validator(mode="after")(checked)


def read_table(
    path: str | os.PathLike[str],
    kind: type[AnyTable] | Callable[[Mapping[str, Any]], type[AnyTable]],
    failure: type[Exception],
    wanted: TomlKind,
) -> tuple[AnyTable, str]:
    """The table in a TOML file, and its text.

    kind: the class of the table, or what makes it from the content; wanted: what the file should
    be. A `failure` names the file, the key, and the values found and expected.
    """
    text = read_text(path, failure)
    try:
        content = parse_toml(text)
        if mistake := mistaken_for(wanted, content):
            raise InputError(mistake)
        return read_part(content, kind if isinstance(kind, type) else kind(content)), text
    except InputError as error:
        raise failure(f"{path}: {error}") from error


def read_part(value: Any, kind: type[AnyTable]) -> AnyTable:
    """A table inside a file; `InputError` as of `read_table`, without the file."""
    try:
        return kind.model_validate(value)
    except ValidationError as error:
        raise InputError(_messages(error.errors(), value)) from error


def _frozen(value: Any) -> Any:
    """Arrays of TOML as tuples, which strict tables want."""
    return tuple(_frozen(entry) for entry in value) if isinstance(value, list) else value


def _plain(value: Any) -> Any:
    """Tuples as the arrays of TOML that they were."""
    return [_plain(entry) for entry in value] if isinstance(value, tuple) else value


def _messages(failures: Sequence[Mapping[str, Any]], value: Any) -> str:
    """The first failures of a value, and how many more there are."""
    first = [_message(failure, value) for failure in failures[:MOST_FAILURES]]
    more = len(failures) - len(first)
    return "; ".join([*first, f"and {more} more"] if more else first)


def _message(failure: Mapping[str, Any], value: Any) -> str:
    """One failure of pydantic as KEY: the expected value, found VALUE."""
    # A choice between types shows as a part of its own, in brackets, that is no key of the file.
    parts = [part for part in failure["loc"] if not str(part).startswith("(")]
    key = dotted(_named(parts, value))
    text = str(failure["msg"]).removeprefix("Value error, ")
    if failure["type"] == "missing":
        text = "missing"
    elif failure["type"] == "union_tag_not_found":
        key, text = f"{key}.type", "missing"
    elif failure["type"] == "union_tag_invalid":
        *others, last = failure["ctx"]["expected_tags"].split(", ")
        tag = failure["ctx"]["tag"]
        meant = did_you_mean(tag, [name.strip("'") for name in (*others, last)])
        text = f"expected {', '.join(others)} or {last}, found {quoted(tag)}{meant}"
        key = f"{key}.type"
    elif failure["type"] != "value_error":
        text = f"{text[0].lower()}{text[1:]}, found {quoted(_plain(failure['input']))}"
        if failure["type"] == "literal_error" and isinstance(failure["input"], str):
            text += did_you_mean(
                failure["input"], re.findall("'(.*?)'", failure["ctx"]["expected"])
            )
    return f"{key}: {text}" if key else text


def _named(parts: Sequence[Any], value: Any) -> Iterator[str]:
    """The parts of a key, with the names of entries of arrays that have one for their numbers."""
    for part in parts:
        if isinstance(value, Mapping) and part not in value and part == value.get("type"):
            continue  # pydantic names the member of a union, which is no key of the file
        value = _item(value, part)
        name = value.get("name") if isinstance(part, int) and isinstance(value, Mapping) else None
        yield name if isinstance(name, str) and name else str(part)


def _item(value: Any, part: Any) -> Any:
    """The value of a table or array at a key or number; None where it has none."""
    if isinstance(value, Mapping):
        return value.get(part)
    is_in = isinstance(value, list | tuple) and isinstance(part, int) and part < len(value)
    return value[part] if is_in else None
