"""The fields of a model's classes, declared once for Python and for model files.

An `Entry` is what users write: a frozen dataclass whose annotations say what its fields take.
Making one converts and checks them; tables.py reads and writes model files by the same annotations.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from inspect import Signature, signature
from types import NoneType
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    TypeVar,
    dataclass_transform,
    get_args,
    get_origin,
    get_type_hints,
)

from ...inputs import Shown, dotted, quoted
from ...inputs.errors import did_you_mean
from ..errors import ModelError, plain


@dataclass(frozen=True)
class FieldSpec:
    """An annotation: the values that a field accepts, described by `what` in messages.

    store: converts a given value to the stored one; ValueError or TypeError for any other value.
    in_file: the type of the value in a model file, where no family tells it; to_file: converts the
    stored value to it; found: quotes a value in messages.
    """

    what: str | Callable[[], str]
    store: Callable[[Any], Any]
    in_file: Any = Any
    to_file: Callable[[Any], Any] | None = None
    found: Callable[[Any], str] = lambda value: quoted(plain(value))

    def refusal(self, value: Any) -> str:
        what = self.what if isinstance(self.what, str) else self.what()
        return f"expected {what}, got {self.found(value)}"


# Products of three numbers of a model stay finite: 1e300 is below the largest double.
LARGEST_NUMBER = 1e100


def real(value: Any) -> float:
    """A number of permissible size; ValueError or TypeError for any other value."""
    # float() reads "1e3" too, but in a model file a number in quotes is a mistake.
    if isinstance(value, str | bytes):
        raise TypeError
    stored = float(value)
    # Written so that nan, which compares as false, is refused too.
    if not abs(stored) <= LARGEST_NUMBER:
        raise ValueError
    return stored


ANY_NUMBER = FieldSpec(f"a number of magnitude up to {LARGEST_NUMBER:g}", real, float)
"""the specification of fields of type float"""


@dataclass(frozen=True)
class NameInFile:
    """An annotation: the key of a field in model files, where it is not the field's name."""

    name: str


@dataclass(frozen=True)
class FormerKey:
    """An annotation: a former name of a field, which model files and Python may still use."""

    name: str


@dataclass(frozen=True)
class DefaultInFile:
    """An annotation: the value of a field whose key a model file leaves out."""

    value: Any


@dataclass(frozen=True)
class Flattened:
    """An annotation: in model files the keys of this entry are keys of its owner."""


@dataclass(frozen=True)
class ItemOf:
    """An annotation: in model files the field is an item of an array, with others of its key."""

    key: str
    number: int
    in_file: Any
    """the type of the array"""


AnyEntry = TypeVar("AnyEntry", bound="Entry")


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(field,))
def entry(*, eq: bool = False, kw_only: bool = False) -> Callable[[type[AnyEntry]], type[AnyEntry]]:
    """Make a class of an `Entry` a frozen dataclass, which arrays in it forbid to compare.

    To a type checker it is no dataclass but one like it, whose fields may be descriptors. Its
    signature, as help() shows it, has types alone.
    """

    def make(kind: type[AnyEntry]) -> type[AnyEntry]:
        # Descriptors of values.py are there for type checkers alone; at run time these are
        # annotations.
        return dataclass(frozen=True, eq=eq, kw_only=kw_only)(kind)

    return make


def signature_of(kind: Any) -> Signature:
    """The signature of an entry as help() shows it, with types alone.

    The annotations of its fields are whole specifications.
    """
    made, types = signature(kind.__init__), get_type_hints(kind)
    _, *parameters = made.parameters.values()
    typed = [each.replace(annotation=types.get(each.name, each.annotation)) for each in parameters]
    return made.replace(parameters=typed)


class _LazySignature:
    """The signature of an entry, made when it is asked for.

    To make those of all takes as long as to read a model.
    """

    def __get__(self, instance: Any, kind: type) -> Signature:
        return signature_of(kind)


class Entry:
    """A frozen dataclass that converts and checks its fields when it is made."""

    __dataclass_fields__: ClassVar[dict[str, Any]]
    __signature__: ClassVar[Any] = _LazySignature()

    label: ClassVar[str] = ""
    """the name of an entry in messages, by its fields: "joint {name!r}" """
    tag: ClassVar[str] = ""
    """the value of the key `type`, of entries that model files tell apart by it"""
    absent: ClassVar[Mapping[str, str]] = {}
    """keys that one may expect in its table, and why there are none"""

    @property
    def owner(self) -> str:
        return self.named(vars(self))

    @classmethod
    def named(cls, values: Mapping[str, Any]) -> str:
        """The name in messages of an entry with these fields, of which some may be missing."""
        tag = {"type": cls.tag} if cls.tag else {}
        return filled(cls.label, {**tag, **values})

    def __post_init__(self) -> None:
        kind: Any = type(self)
        for name, takes, optional in _checked(kind):
            value = getattr(self, name)
            if value is None and optional:
                continue
            try:
                # The class is frozen: only here may fields be converted.
                object.__setattr__(self, name, takes.store(value))
            except (ValueError, TypeError) as error:
                raise self.error(f"{name}: {takes.refusal(value)}") from error
        self.validate()

    def validate(self) -> None:
        """ModelError for fields that contradict one another."""

    def error(self, message: str) -> ModelError:
        return ModelError(f"{self.owner}: {message}" if self.label else message)


def filled(label: str, values: Mapping[str, Any]) -> str:
    """The name of an entry by its fields; text that is not plain is quoted."""
    plain = {key: dotted([text]) if isinstance(text, str) else text for key, text in values.items()}
    # The entry has not been numbered yet: "joint without a name (revolute)" says which one is
    # meant.
    if values.get("name") == "" and "{name!r}" in label:
        kind = f" ({plain['type']})" if "type" in values else ""
        return f"{label.partition(' ')[0]} without a name{kind}"
    return label.format_map(plain)


@cache
def annotations(kind: type) -> Mapping[str, Any]:
    """The annotation of each field of an entry."""
    return {
        name: hint
        for name, hint in get_type_hints(kind, include_extras=True).items()
        if get_origin(hint) is not ClassVar
    }


@cache
def former_keys(kind: Any) -> Mapping[str, str]:
    """The names of fields of an entry by their former names."""
    hints = annotations(kind).items()
    return {former.name: name for name, hint in hints if (former := note(hint, FormerKey))}


def renamed(values: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, Any]:
    """Values by the present names of fields; ModelError where a field has two values."""
    found = {key: value for key, value in values.items() if key not in names}
    for former, name in names.items():
        if former in values:
            if found.get(name):
                raise ModelError(
                    f"{former} is the former name of {name}: expected one of them, found both"
                )
            found[name] = values[former]
    return found


def note(hint: Any, kind: type) -> Any:
    """The note of a kind in an annotation, or None.

    kind: `FieldSpec`, `NameInFile`, `Flattened`, ... Optional fields have that of their type.
    """
    if get_origin(hint) is Annotated:
        inner, *notes = get_args(hint)
        # Annotated types nest: the outer note overrides that of the kind of value.
        return next((item for item in notes if isinstance(item, kind)), None) or note(inner, kind)
    if hint is float and kind is FieldSpec:
        return ANY_NUMBER
    if get_origin(hint) is Literal and kind is FieldSpec:
        return one_of(dict.fromkeys(get_args(hint)))
    if NoneType in get_args(hint):
        return next((item for inner in get_args(hint) if (item := note(inner, kind))), None)
    return None


def is_optional(hint: Any) -> bool:
    inner = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    return NoneType in get_args(inner)


def one_of(names: Mapping[str, Any]) -> FieldSpec:
    """The specification of a field that takes one of some names, which may grow in number."""

    def what() -> str:
        # Evaluated when a message is written, for users may have added members since the class was
        # made.
        *others, last = map(repr, names)
        return f"{', '.join(others)} or {last}" if others else last

    def store(name: Any) -> Any:
        if name not in names:
            raise ValueError
        return name

    in_file = Annotated[str, Shown(lambda: {"type": "string", "enum": list(names)})]

    def found(name: Any) -> str:
        return f"{quoted(plain(name))}{did_you_mean(name, names) if isinstance(name, str) else ''}"

    return FieldSpec(what, store, in_file, found=found)


@cache
def _checked(kind: type) -> tuple[tuple[str, FieldSpec, bool], ...]:
    return tuple(
        (name, takes, is_optional(hint))
        for name, hint in annotations(kind).items()
        if (takes := note(hint, FieldSpec)) is not None
    )
