"""Entries as tables of a model file, by the specifications of their fields."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, Field, fields, replace
from functools import cache
from types import UnionType
from typing import Annotated, Any, ClassVar, Literal, TypeVar, Union, get_args, get_origin

import numpy as np
from pydantic import Discriminator, Tag, create_model
from pydantic import Field as PydanticField

from ...inputs import Shown, Table, dotted, member_of, quoted, read_part
from ...inputs.errors import did_you_mean
from ..errors import ModelError
from .entry import (
    DefaultInFile,
    Entry,
    FieldSpec,
    Flattened,
    FormerKey,
    ItemOf,
    NameInFile,
    annotations,
    former_keys,
    note,
    renamed,
)
from .forms import Family, Form, Kinds, Members
from .json_schema import members_of, value_in_words

AnyEntry = TypeVar("AnyEntry", bound=Entry)


class EntryTable(Table):
    """The table of an entry; its fields bear the names of the keys."""

    entry: ClassVar[type[Entry]]


@cache
def table_of(kind: type[Entry]) -> type[EntryTable]:
    """The table in which a model file gives an entry."""
    keys = keys_of(kind)
    if kind.tag:
        # pydantic tells the tables of an array apart by this literal.
        keys = {"type": (Literal[kind.tag], ...), **keys}
    table = create_model(kind.__name__, __base__=EntryTable, **keys)
    table.entry, table.documented, table.absent = kind, (kind,), kind.absent
    return table


def table_of_kinds(kinds: Kinds, tags: Iterable[str]) -> Any:
    """The table in which a model file gives an entry of one of several kinds, by their tags."""
    tables = tuple(table_of(kinds[tag]) for tag in tags)
    if len(tables) == 1:
        return tables[0]
    return Annotated[Union[tables], PydanticField(discriminator="type")]  # noqa: UP007 - of a tuple of types


def tables_by_key(otherwise: type[Entry], **by_key: type[Entry]) -> Any:
    """The table of an entry that is of the kind whose key it has, or else of another one."""

    # In parentheses, by which messages know that they are no keys.
    def kind_of(table: Any) -> str:
        keys = table if isinstance(table, Mapping) else ()
        return f"({next((key for key in by_key if key in keys), '')})"

    members: dict[str, Any] = {"": otherwise, **by_key}
    tables = tuple(Annotated[table_of(kind), Tag(f"({key})")] for key, kind in members.items())
    return Annotated[Union[tables], Discriminator(kind_of)]  # noqa: UP007 - of a tuple of types


def keys_of(kind: type[Entry]) -> dict[str, Any]:
    """The keys of an entry, each with its type, and a default if it may be left out.

    The default is never read: for a key that a file leaves out the entry has its own.
    """
    keys: dict[str, Any] = {}
    for field, hint in declared(kind):
        if note(hint, Flattened):
            # Keys of a flattened entry stand in the table of its owner.
            keys |= keys_of(_bare(hint))
        elif item := note(hint, ItemOf):
            keys[item.key] = (item.in_file, ...)
        else:
            required = _is_required(field) and note(hint, DefaultInFile) is None
            kind_in_file: Any = Annotated[type_in_file(hint), value_in_words(field, hint)]
            keys[key_of(field, hint)] = (kind_in_file, ... if required else None)
            if former := note(hint, FormerKey):
                words = replace(value_in_words(field, hint), deprecated=True)
                keys[former.name] = (Annotated[type_in_file(hint), words], None)
    return keys


def key_of(field: "Field[Any]", hint: Any) -> str:
    key = note(hint, NameInFile)
    return field.name if key is None else str(key.name)


def entry_of(kind: type[AnyEntry], table: Mapping[str, Any]) -> AnyEntry:
    """An entry from the values of a file, by key; ModelError names the entry."""
    values: dict[str, Any] = {}
    declaring: Any = kind
    former = {name: key for key, name in former_keys(declaring).items() if key in table}
    with _owned(kind, table):
        table = renamed(table, former_keys(declaring))
    for field, hint in declared(kind):
        if note(hint, Flattened):
            with _owned(kind, values):
                values[field.name] = entry_of(_bare(hint), table)
        elif item := note(hint, ItemOf):
            # Two fields, frame_a and frame_b, share one key, `between`.
            values[field.name] = table[item.key][item.number]
        elif (key := key_of(field, hint)) in table:
            with _owned(kind, values, f"{field.name}: "):
                values[field.name] = _read(hint, table[key])
        elif (left_out := note(hint, DefaultInFile)) is not None:
            values[field.name] = left_out.value
    try:
        return kind(**values)
    except ModelError as error:
        raise ModelError(_by_keys_of_file(str(error), former)) from error


def _by_keys_of_file(message: str, former: Mapping[str, str]) -> str:
    """A message with the key that the file has, where that is a former name."""
    for name, key in former.items():
        message = message.replace(f"{name}:", f"{key}, now {name}:")
    return message


def _read(hint: Any, value: Any) -> Any:
    """The value of a field with this annotation, from that of a validated table."""
    if (family := note(hint, Family)) is not None:
        return read_member(family, value)
    if (members := note(hint, Members)) is not None:
        return _read_members(members.family, value)
    return value_of(value)


def _read_members(family: Family, value: Any) -> Any:
    """A member, a list of them, or a table of either, which alone has tables in it."""
    if isinstance(value, list | tuple):
        return tuple(read_member(family, item) for item in value)
    # A table of members by name has tables as values; the table of one member has numbers and
    # lists.
    if not isinstance(value, Mapping) or not any(map(_holds_tables, value.values())):
        return read_member(family, value)
    named = {}
    for name, members in value.items():
        try:
            named[name] = _read_members(family, members)
        except ValueError as error:
            raise ValueError(f"{dotted([name])}: {error}") from error
    return named


def _holds_tables(value: Any) -> bool:
    items = value if isinstance(value, list | tuple) else [value]
    return any(isinstance(item, Mapping) for item in items)


@contextmanager
def _owned(kind: type[Entry], values: Mapping[str, Any], key: str = "") -> Iterator[None]:
    """Name an entry in errors of its key; some of its values are known, its name among them."""
    try:
        yield
    except ValueError as error:
        owner = f"{kind.named(values)}: " if kind.label else ""
        raise ModelError(f"{owner}{key}{error}") from error


def value_of(value: Any) -> Any:
    """A value of a validated table, with entries for the tables in it."""
    if isinstance(value, EntryTable):
        return entry_of(value.entry, present_keys(value))
    if isinstance(value, Mapping):
        return {key: value_of(item) for key, item in value.items()}
    return tuple(map(value_of, value)) if isinstance(value, tuple) else value


def present_keys(table: Table) -> dict[str, Any]:
    """The keys that a file has, with their values."""
    present = table.model_fields_set
    return {key: getattr(table, key) for key in type(table).model_fields if key in present}


def table_in_file(entry: Entry) -> dict[str, Any]:
    """The table of an entry in a file, without keys that have their defaults."""
    table: dict[str, Any] = {"type": entry.tag} if entry.tag else {}
    for field, hint in declared(type(entry)):
        value = in_file(entry, field.name, getattr(entry, field.name), hint)
        if note(hint, Flattened):
            table |= value
        elif item := note(hint, ItemOf):
            table.setdefault(item.key, []).append(value)
        # Both are compared as files give them: arrays have no truth value.
        elif value != _default_in_file(entry, field, hint):
            table[key_of(field, hint)] = value
    # The name comes first, for people who read the file.
    return {key: table[key] for key in ("name", *table) if key in table}


def in_file(owner: Entry, name: str, value: Any, hint: Any) -> Any:
    """The value of a field as a file gives it."""
    if value is None:
        return None
    if (members := note(hint, Members)) is not None and isinstance(value, Mapping):
        return {key: in_file(owner, f"{name}: {key}", item, hint) for key, item in value.items()}
    if members is not None and isinstance(value, tuple):
        return [in_file(owner, name, item, hint) for item in value]
    if (family := members.family if members is not None else note(hint, Family)) is not None:
        table = member_in_file(family, value)
        if table is None:
            raise owner.error(f"{name}: a {type(value).__name__} cannot be written to a file")
        return table
    takes = note(hint, FieldSpec)
    if takes is not None and takes.to_file is not None:
        return takes.to_file(value)
    if isinstance(value, Entry):
        return table_in_file(value)
    if isinstance(value, Mapping):
        return {key: in_file(owner, name, item, None) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    return list(value) if isinstance(value, tuple) else value


def read_member(family: Family, value: Any) -> Any:
    """An entry of a family, from a table with one key by which it is known, or from a number."""
    # In Python a bool is an int.
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if is_number and family.number is not None:
        return family.number(float(value))
    keys = list(value) if isinstance(value, Mapping) else []
    if known := [tuple(forms) for key, forms in family.forms.items() if key in keys]:
        # A key may belong to two forms (`times` and `over`): the one that takes all keys is meant.
        fit = [forms for forms in known if set(keys) <= set(_table_of_forms(forms).model_fields)]
        return _entry_of_forms((fit or known)[0], value)
    # None of its keys is known, so that the most likely mistake is a misspelled one.
    meant = next(filter(None, (did_you_mean(key, family.forms) for key in keys)), "")
    form = "a table" if family.number is None else "a number or a table"
    raise ValueError(
        f"expected {form} with one of the keys {', '.join(family.forms)}, "
        f"found {quoted(value)}{meant}"
    )


def member(family: Family, what: str, kinds: Any) -> FieldSpec:
    """The specification of a field that takes a member of a family, or its form in a file."""
    return FieldSpec(
        what, lambda value: value if isinstance(value, kinds) else read_member(family, value)
    )


def _entry_of_forms(forms: tuple[Form, ...], value: Any) -> Any:
    table = present_keys(read_part(value, _table_of_forms(forms)))
    flags = [form.flag for form in forms if table.pop(form.flag, False)]
    if len(flags) > 1:
        raise ValueError(f"expected {' or '.join(flags)}, found both")
    # Forms of the same key are told apart by flags; without one the plain form is meant.
    flag = flags[0] if flags else ""
    return entry_of(next(form.kind for form in forms if form.flag == flag), table)


def tables_of(family: Family) -> dict[tuple[Form, ...], type[Table]]:
    """The tables in which model files give the members of a family, by the forms of each."""
    groups = [tuple(forms) for forms in family.forms.values()]
    return {forms: _table_of_forms(forms) for forms in groups}


@cache
def _table_of_forms(forms: tuple[Form, ...]) -> type[Table]:
    keys: dict[str, Any] = {}
    for form in forms:
        keys |= keys_of(form.kind)
        if form.flag:
            keys[form.flag] = (bool, False)
    table = create_model("Or".join(form.kind.__name__ for form in forms), __base__=Table, **keys)
    table.documented = tuple(form.kind for form in forms)
    return table


def member_in_file(family: Family, member: Any) -> Any:
    """An entry of a family as a file gives it; None if files have none of its kind."""
    if family.number is not None and isinstance(member, family.number):
        (number,) = vars(member).values()
        return float(number)
    for form in (form for forms in family.forms.values() for form in forms):
        # Not isinstance: a user's subclass would be written as its base, and read back as another
        # signal.
        if type(member) is form.kind:
            return table_in_file(member) | ({form.flag: True} if form.flag else {})
    return None


def type_in_file(hint: Any) -> Any:
    """The type of a value in a file, for a field with this annotation."""
    origin, arguments = get_origin(hint), get_args(hint)
    if (family := note(hint, Family)) is not None:
        return Annotated[Any, Shown(lambda: member_of(family.title))]
    if (members := note(hint, Members)) is not None:
        return Annotated[Any, Shown(lambda: members_of(members.family.title))]
    if origin is Annotated:
        takes = next((item for item in arguments[1:] if isinstance(item, FieldSpec)), None)
        return takes.in_file if takes is not None else type_in_file(arguments[0])
    if origin in (Union, UnionType):
        return Union[tuple(map(type_in_file, arguments))]  # noqa: UP007 - of a tuple of types
    if origin is Mapping:
        return dict[str, type_in_file(arguments[1])]  # type: ignore[misc]
    if isinstance(hint, type) and issubclass(hint, Entry):
        kind: Any = hint
        return table_of(kind)
    return hint


def declared(kind: Any) -> list[tuple["Field[Any]", Any]]:
    """The fields that an entry is made of, each with its annotation."""
    hints = annotations(kind)
    return [(field, hints[field.name]) for field in fields(kind) if field.init]


def _is_required(field: "Field[Any]") -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _default_in_file(owner: Entry, field: "Field[Any]", hint: Any) -> Any:
    if field.default_factory is not MISSING:
        return in_file(owner, field.name, field.default_factory(), hint)
    if field.default is MISSING:
        left_out = note(hint, DefaultInFile)
        return MISSING if left_out is None else left_out.value
    takes = note(hint, FieldSpec)
    stored = field.default
    if takes is not None and stored is not None:
        # Defaults of dataclasses are not converted, values are: only converted ones compare.
        stored = takes.store(stored)
    return in_file(owner, field.name, stored, hint)


def _bare(hint: Any) -> Any:
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint
