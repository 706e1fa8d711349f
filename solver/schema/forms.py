"""Families of entries that model files distinguish: by the key `type`, or by which key is there."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from .entry import Entry, former_keys, renamed, signature_of

AnyEntryType = TypeVar("AnyEntryType", bound=type[Entry])


class Kinds(dict[str, Any]):
    """The classes of entries that share one array of tables, by the value of its key `type`.

    Examples
    --------
    >>> from duhamel.solver import JOINTS, LOADS
    >>> JOINTS["revolute"].__name__, sorted(LOADS)
    ('Revolute', ['drag', 'force', 'pattern', 'torque'])
    """

    def in_files(self, tag: str) -> Callable[[AnyEntryType], AnyEntryType]:
        """Make an entry known to model files: a table with type = tag."""

        def register(kind: AnyEntryType) -> AnyEntryType:
            kind.tag = tag
            self[tag] = kind
            return kind

        return register


class ByType(type):
    """The class of a base of kinds, whose own call makes the kind that `of_type` chooses.

    So `Joint("pin", "revolute", ["ground", "arm"], [0, 0, 1])` of earlier versions still is a
    `Revolute`. A kind itself is made as any class.
    """

    @property
    def __signature__(cls) -> inspect.Signature:
        # Otherwise help() and notebooks would show that of the call below, which takes anything.
        if "of_type" in vars(cls):
            return inspect.signature(cls.of_type)  # type: ignore[attr-defined]
        return signature_of(cls)

    def __call__(cls, *args: Any, **given: Any) -> Any:
        # Here, before __init__, since dataclasses.replace makes its copies by this call as well.
        given = renamed(given, former_keys(cls))
        of_type = vars(cls).get("of_type")
        return super().__call__(*args, **given) if of_type is None else cls.of_type(*args, **given)  # type: ignore[attr-defined]


def kinds_of(base: Any) -> dict[str, Any]:
    """The classes that stand on another and have a type, by that."""
    found: dict[str, Any] = {}
    # Python keeps the list: a class of a user is known as soon as it is declared.
    for kind in base.__subclasses__():
        found |= ({kind.tag: kind} if "tag" in vars(kind) else {}) | kinds_of(kind)
    return found


@dataclass(frozen=True)
class Form:
    """An entry as model files give it: a table with a key, and flag = true if it has one."""

    kind: type[Entry]
    flag: str


@dataclass(frozen=True)
class Members:
    """An annotation: a member of a family, a list of them, or a table of either by a name."""

    family: "Family"


class Family:
    """Entries of one role, as an annotation of the fields that take them."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.forms: dict[str, list[Form]] = {}
        """the forms, by the key that distinguishes them"""
        self.number: Any = None
        """the entry of one field that a bare number stands for"""

    @property
    def title(self) -> str:
        """The name of the family in JSON schemas."""
        return self.name.replace(" ", "_")

    def in_files(self, key: str, flag: str = "") -> Callable[[AnyEntryType], AnyEntryType]:
        """Make an entry known to model files: a table with this key.

        And with flag = true if another entry of the family has the same key.
        """

        def register(kind: AnyEntryType) -> AnyEntryType:
            self.forms.setdefault(key, []).append(Form(kind, flag))
            return kind

        return register

    def bare_number(self, kind: AnyEntryType) -> AnyEntryType:
        """Let a number in a model file stand for an entry of one field."""
        self.number = kind
        return kind
