"""Names of a study's own, and keys of its cases that follow from others by arithmetic."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..inputs import dotted, quoted
from .errors import StudyError
from .expressions import RESERVED_WORDS, evaluate, names_in
from .keys import entries, leaves, value_at


def own_names(
    document: Mapping[str, Any],
    parameters: Mapping[str, Any],
    derived: Mapping[str, Any],
    place: str,
) -> frozenset[str]:
    """The names without a dot that are no key of the base file, but stand for a value.

    derived: definitions by dotted key; place: that of the parameters, for messages. `StudyError`
    for a name that no definition uses: it is a key that is spelled wrong.
    """
    names = [key for key in (*parameters, *derived) if "." not in key and key not in document]
    used = {name for definition in derived.values() for name in _names(definition)}
    for name in names:
        where = f"{place if name in parameters else 'derived.'}{dotted([name])}"
        if not name.isidentifier() or name in RESERVED_WORDS:
            raise StudyError(f"{where}: expected a name that is one word and no function")
        if name not in used:
            raise StudyError(
                f"{where}: no key of the base file, and no name that [derived] uses; "
                f"keys are {', '.join(dotted([key]) for key in document)}"
            )
    return frozenset(names)


def definitions(
    document: Mapping[str, Any], derived: Mapping[str, Any], parameters: Mapping[str, Any]
) -> dict[str, Any]:
    """The definitions of the table [derived] by dotted key, in their order."""
    found = dict(leaves(derived))
    given = [_entries(document, key) for key in parameters]
    for key, definition in found.items():
        if _entries(document, key) in given:
            raise StudyError(f"derived.{dotted([key])}: is a parameter too")
        for text in _texts(definition):
            if not isinstance(text, str | int | float) or isinstance(text, bool):
                raise StudyError(
                    f"derived.{dotted([key])}: expected arithmetic, found {quoted(text)}"
                )
    return found


def _entries(document: Mapping[str, Any], key: str) -> tuple[str | int, ...]:
    """A key as `entries` has it, or as it is where the document has none."""
    try:
        return entries(document, key)
    except StudyError:
        return (key,)


@dataclass
class Derivation:
    """A document in which values are put: those of parameters, then those that follow from them.

    names: the values of names of the study's own; pending: definitions that are still to be
    computed, by key; begun: those that wait for others, the last one innermost.
    """

    document: dict[str, Any]
    own: frozenset[str]
    put: Callable[[dict[str, Any], str, Any], None]
    names: dict[str, Any] = field(default_factory=dict)
    pending: dict[str, Any] = field(default_factory=dict)
    begun: list[str] = field(default_factory=list)

    def give(self, key: str, value: Any) -> None:
        """Give a name or a key of the document its value."""
        if key in self.own:
            self.names[key] = value
        else:
            self.put(self.document, key, value)

    def derive(self, definitions: Mapping[str, Any]) -> None:
        """Compute all definitions, each after those that it needs; `StudyError` names the key.

        One that asks for its own key gets the value in the base file.
        """
        self.pending = dict(definitions)
        while self.pending:
            self._compute(next(iter(self.pending)))

    def _compute(self, key: str) -> None:
        definition = self.pending.pop(key)
        self.begun.append(key)
        try:
            self.give(key, self._value(definition))
        except StudyError as error:
            raise StudyError(f"derived.{dotted([key])}: {error}") from error
        self.begun.pop()

    def _value(self, part: Any) -> Any:
        if isinstance(part, list):
            return [self._value(entry) for entry in part]
        return evaluate(part, self.look_up) if isinstance(part, str) else part

    def look_up(self, asked: str) -> Any:
        """The value of a name or a key, after what it is made of."""
        # A definition that needs one that has begun, and is not done, is a cycle.
        for key in self.begun[:-1]:
            if self._meet(asked, key):
                raise StudyError(f"{asked} depends on itself, through {', '.join(self.begun)}")
        # Also keys that lie within what is asked for, as entries of a vector.
        for key in list(self.pending):
            if key in self.pending and self._meet(asked, key):
                self._compute(key)
        first = asked.partition(".")[0]
        if first in self.own:
            return self._at(self.names, asked)
        value = self._at(self.document, asked)
        if isinstance(value, str):  # a path would be relative to another file
            raise StudyError(f"{asked}: expected numbers, found the text {quoted(value)}")
        return value

    def _at(self, table: Mapping[str, Any], asked: str) -> Any:
        if asked.partition(".")[0] not in table:
            known = ", ".join(dotted([name]) for name in (*sorted(self.own), *self.document))
            raise StudyError(f"no {quoted(asked)}; there are: {known}")
        return value_at(table, asked)

    def _meet(self, asked: str, key: str) -> bool:
        """Whether one of two keys is, or lies within, the other."""
        pairs = zip(self._entries(asked), self._entries(key), strict=False)
        return all(one == other for one, other in pairs)

    def _entries(self, key: str) -> tuple[str | int, ...]:
        if key.partition(".")[0] in self.own:
            return tuple(key.split("."))[:1]
        return _entries(self.document, key)


def _names(definition: Any) -> Iterator[str]:
    for text in _texts(definition):
        if isinstance(text, str):
            yield from names_in(text)


def _texts(definition: Any) -> Iterator[Any]:
    """The expressions and numbers of a definition."""
    if isinstance(definition, list):
        for part in definition:
            yield from _texts(part)
    else:
        yield definition
