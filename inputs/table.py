"""Tables of a TOML file as frozen models."""

import difflib
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)


def expected(form: str) -> WrapValidator:
    """One message for a value of several types: `form` is expected, and the value found."""

    def check(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        try:
            return handler(value)
        except ValidationError as error:
            raise ValueError(f"expected {form}, found {_plain(value)!r}") from error

    return WrapValidator(check)


Vector = Annotated[tuple[float, float, float], expected("three numbers")]


class InputError(ValueError):
    """A file that is unreadable or has invalid entries; one line for each."""


class Table(BaseModel):
    """A table of a file: frozen, of finite numbers, without unknown keys; text is no number."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        known = {field.alias or name: name for name, field in cls.model_fields.items()}
        for key in data if isinstance(data, Mapping) else ():
            if key not in known and key not in cls.model_fields:
                nearest = difflib.get_close_matches(key, known, n=1, cutoff=0.5)
                hint = (
                    f"did you mean {nearest[0]!r}?" if nearest else f"known are {', '.join(known)}"
                )
                raise ValueError(f"unknown key {key!r}; {hint}")
        return (
            {key: _frozen(value) for key, value in data.items()}
            if isinstance(data, Mapping)
            else data
        )


AnyTable = TypeVar("AnyTable", bound=Table)


def read_table(path: str | os.PathLike[str], kind: type[AnyTable]) -> tuple[AnyTable, str]:
    """The table in a TOML file, and its text.

    `InputError` names the file, the key, and the values found and expected.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
        return kind.model_validate(tomllib.loads(text)), text
    except ValidationError as error:
        raise InputError(
            "\n".join(f"{path}: {_message(failure)}" for failure in error.errors())
        ) from error
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: not a TOML file: {error}") from error
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a readable file: {error}") from error


def read_part(value: Any, kind: type[AnyTable]) -> AnyTable:
    """A table inside a file; `InputError` as of `read_table`, without the file."""
    try:
        return kind.model_validate(value)
    except ValidationError as error:
        raise InputError("; ".join(_message(failure) for failure in error.errors())) from error


def _frozen(value: Any) -> Any:
    """Arrays of TOML as tuples, which strict tables want."""
    return tuple(_frozen(entry) for entry in value) if isinstance(value, list) else value


def _plain(value: Any) -> Any:
    """Tuples as the arrays of TOML that they were."""
    return [_plain(entry) for entry in value] if isinstance(value, tuple) else value


def _message(failure: Mapping[str, Any]) -> str:
    """One failure of pydantic as KEY: the expected value, found VALUE."""
    # A choice between types shows as a part of its own, in brackets, that is no key of the file.
    key = ".".join(str(part) for part in failure["loc"] if not str(part).startswith("("))
    text = str(failure["msg"]).removeprefix("Value error, ")
    if failure["type"] == "missing":
        text = "missing"
    elif failure["type"] != "value_error":
        text = f"{text[0].lower()}{text[1:]}, found {_plain(failure['input'])!r}"
    return f"{key}: {text}" if key else text
