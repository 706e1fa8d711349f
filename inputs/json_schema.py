"""JSON schemas of the tables of TOML files, by which editors complete and check them.

They say what keys there are, which are needed, and what a value looks like; what values must be to
one another is known to the validators alone. Descriptions are the words of the docstrings.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

# The draft that TOML extensions of editors support.
SCHEMA_DRAFT = "http://json-schema.org/draft-07/schema#"
# Descriptions are cut after the first sentence; abbreviations are not followed by a capital.
SENTENCE_END = re.compile(r"(?<=[.]) (?=[A-Z`])")
# Errors and examples are for readers of Python, not for editors of files.
DOCSTRING_SECTION = re.compile(r"\n\n\w+\n-{4,}\n")
PARAMETERS_SECTION = re.compile(r"\n\nParameters\n-+\n(.*?)(?=\n\n\w+\n-{4,}\n|$)", re.DOTALL)
# "velocity, rate : (3,) [m/s]", and the indented lines below it
PARAMETER_ENTRY = re.compile(r"^(\w+(?:, \w+)*)(?: : (.*))?\n?((?:^ .*\n?|^\n)*)", re.MULTILINE)
FIRST_WORD = re.compile("[A-Z][a-z]|A ")
SHAPE_OR_UNIT = re.compile(r"\([^()]*,[^()]*\)|\[[^]]*\]")
Schema = dict[str, Any]
NO_SCHEMA: Mapping[str, Any] = {}


@dataclass(frozen=True)
class Shown:
    """An annotation: the JSON schema of a value whose type does not tell it."""

    schema: Callable[[], Schema]

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> Schema:
        return self.schema()


@dataclass(frozen=True)
class Also:
    """An annotation: another form of a value, which a validator turns into that of its type."""

    type: Any

    def __get_pydantic_json_schema__(self, core_schema: Any, handler: Any) -> Schema:
        from pydantic import TypeAdapter

        return {"anyOf": [TypeAdapter(self.type).json_schema(), handler(core_schema)]}


def member_of(family: str) -> Schema:
    """What stands in a schema for a member of a family, a definition of the document."""
    return {"family": family}


def document_of(
    kind: type[Any],
    title: str,
    families: Mapping[str, Callable[[Mapping[type, Schema]], Schema]] = NO_SCHEMA,
    members: Iterable[type[Any]] = (),
) -> Schema:
    """The JSON schema of the files that a table describes.

    families: definitions by name, from references to the schemas of the tables `members`.
    """
    from pydantic.json_schema import models_json_schema

    kinds = (kind, *members)
    references, made = models_json_schema([(table, "validation") for table in kinds])
    found = {table: references[table, "validation"] for table in kinds}
    definitions = made["$defs"] | {name: define(found) for name, define in families.items()}
    name = found[kind]["$ref"].rpartition("/")[2]
    top = definitions.pop(name)
    shared = {key: _plain(value) for key, value in sorted(definitions.items())}
    return {"$schema": SCHEMA_DRAFT, **_plain(top), "title": title, "$defs": shared}


def describe(schema: Schema, documented: Iterable[type[Any]]) -> None:
    """Give the properties of a table descriptions, from the docstrings of classes."""
    properties = schema.get("properties", {})
    for kind in documented:
        text = inspect.getdoc(kind) or ""
        before = DOCSTRING_SECTION.split(text)[0]
        said = words_of(before, list(properties)) | parameters_of(text)
        for key, words in said.items():
            if key in properties:
                properties[key].setdefault("description", words)


def parameters_of(text: str) -> dict[str, str]:
    """What the section of parameters of a docstring says of each: name, shape, unit, a sentence."""
    found: dict[str, str] = {}
    section = PARAMETERS_SECTION.search(text)
    for names, kind, lines in PARAMETER_ENTRY.findall(section[1] if section else ""):
        head = " ".join([names, *SHAPE_OR_UNIT.findall(kind)])
        sentence = SENTENCE_END.split(" ".join(lines.split()))[0]
        if FIRST_WORD.match(sentence):  # not a symbol
            sentence = sentence[0].lower() + sentence[1:]
        if sentence or head != names:
            words = f"{head}: {sentence}" if sentence else head
            found |= dict.fromkeys(names.split(", "), words)
    return found


def words_of(text: str, names: list[str]) -> dict[str, str]:
    """What a docstring says of each of the names that begin a clause of it, as `mass [kg]`.

    A clause begins with a paragraph, a sentence, or after a semicolon, and ends where that of
    another name begins, or the paragraph does.
    """
    found: dict[str, str] = {}
    if not names:
        return found
    name = f"`?(?:{'|'.join(map(re.escape, names))})\\b`?"
    start = re.compile(rf"(?:^|(?<=[.;:] ))({name}(?:,? (?:and )?{name})*)(?=[ ,:;]|$)")
    for paragraph in text.split("\n\n"):
        line = " ".join(paragraph.split())
        starts = list(start.finditer(line))
        for here, there in zip(starts, [*starts[1:], None], strict=False):
            clause = line[here.start() : there.start() if there else len(line)]
            words = SENTENCE_END.split(clause.strip().rstrip(";"))[0]
            for key in re.findall(name, here[1]):
                found.setdefault(key.strip("`"), words)
    return found


def _plain(schema: Any) -> Any:
    """A schema in the words that editors know, without what TOML does not have."""
    if isinstance(schema, list):
        return [_plain(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    schema = dict(schema)
    if (family := schema.get("family")) is not None and isinstance(family, str):
        schema["$ref"] = f"#/$defs/{schema.pop('family')}"
    if (expected := schema.pop("expected", None)) is not None:
        words = schema.get("description", "")
        schema["description"] = f"{words}\n\nExpected: {expected}." if words else f"{expected}"
    schema = {key: _inner(key, value) for key, value in schema.items()}
    if isinstance(schema.get("title"), str):
        del schema["title"]
    for absent in ("default", "const"):
        if absent in schema and schema[absent] is None:
            del schema[absent]
    schema = _without_null(_same_items(schema))
    reference = {"$ref": schema.pop("$ref")} if "$ref" in schema else {}
    return _with_words(reference, schema) if reference else schema


def _inner(key: str, value: Any) -> Any:
    if key in ("default", "enum", "const", "required"):
        return value
    if key == "description" and isinstance(value, str):
        return DOCSTRING_SECTION.split(value)[0]
    if key in ("properties", "$defs"):
        return {name: _plain(schema) for name, schema in value.items()}
    return _plain(value)


def _same_items(schema: Schema) -> Schema:
    """Items that are all the same, or each its own, in the words of older drafts."""
    items = schema.pop("prefixItems", None)
    if items is not None:
        schema["items"] = items[0] if all(item == items[0] for item in items) else items
    if "const" in schema:
        schema["enum"] = [schema.pop("const")]
    return schema


def _without_null(schema: Schema) -> Schema:
    """A value that may be none is one whose key may be absent."""
    forms = [form for form in schema.get("anyOf", ()) if form != {"type": "null"}]
    if not forms:
        return schema
    others = {key: value for key, value in schema.items() if key != "anyOf"}
    if len(forms) > 1:
        return {"anyOf": forms, **others}
    return _with_words(forms[0], others)


def _with_words(form: Schema, others: Schema) -> Schema:
    """A form with words of its own; beside a reference they would not be read."""
    return {"allOf": [form], **others} if others and "$ref" in form else {**form, **others}
