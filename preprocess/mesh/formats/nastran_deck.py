"""The cards of Nastran bulk data: short, long and free fields, continuations, includes."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ...errors import MeshError
from .text import INTEGER_PATTERN, lines

_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-])")
_BEGIN = re.compile(r"\s*BEGIN\b", re.IGNORECASE)
_END = re.compile(r"\s*ENDDATA\b", re.IGNORECASE)
_INCLUDE = re.compile(r"INCLUDE\s+['\"]?([^'\"$]+?)['\"]?\s*(\$.*)?", re.IGNORECASE)
# How preprocessors write the names of properties into comments: HyperMesh, ANSA and Femap.
_NAMES = (
    re.compile(r'\$HMNAME PROP\s+(\d+)\s*"([^"]+)"'),
    re.compile(r"\$ANSA_NAME(?:_COMMENT)?;(\d+);P\w+;([^;]+)"),
    re.compile(r"\$ Femap Property (\d+) : (.+?)\s*$", re.IGNORECASE),
)


@dataclass(frozen=True)
class Card:
    """A card: its name, its fields without continuations, and its line in the file."""

    name: str
    fields: list[str]
    location: str

    def text(self, field: int) -> str:
        """A field by its number; field 1 is the name, and continuations do not count."""
        return self.fields[field - 2] if field - 2 < len(self.fields) else ""

    def integer(self, field: int, default: int | None = None) -> int:
        text = self.text(field)
        if not text and default is not None:
            return default
        if not INTEGER_PATTERN.fullmatch(text):
            raise MeshError(
                f"{self.location}: {self.name}: expected an integer in field {field}, found "
                f"{text!r}"
            )
        return int(text)

    def number(self, field: int) -> float:
        """A real number, as 1.5, 1.5e-3, 1.5-3 or 1.5D-3; 0 where nothing is written."""
        text = self.text(field).upper().replace("D", "E")
        try:
            return float(_BARE_EXPONENT.sub(r"E\1", text) or 0.0)
        except ValueError as error:
            raise MeshError(
                f"{self.location}: {self.name}: expected a number in field {field}, "
                f"found {self.text(field)!r}"
            ) from error

    def ranges(self, first: int) -> list[range]:
        """The integers from a field on, with those between as `1 THRU 5`."""
        found: list[range] = []
        thru = False
        for field in range(first, len(self.fields) + 2):
            if self.text(field).upper() == "THRU":
                if not found or thru:
                    raise MeshError(f"{self.location}: {self.name}: THRU without a first number")
                thru = True
            elif self.text(field):
                number = self.integer(field)
                found.append(range(found.pop().start if thru else number, number + 1))
                thru = False
        return found


def read_cards(path: Path, names: dict[int, str]) -> Iterator[Card]:
    """The cards of the bulk data. The names of properties that comments tell are put into `names`.

    A file without BEGIN BULK is bulk data throughout; one with it must have an ENDDATA, else
    `MeshError`.
    """
    deck = list(lines(path, nastran_include))
    starts = [i for i, line in enumerate(deck) if _BEGIN.match(line.text)]
    ends = [i for i, line in enumerate(deck) if _END.match(line.text)]
    if starts and not ends:
        raise MeshError("the file breaks off: BEGIN BULK without ENDDATA")
    card: Card | None = None
    for location, text in deck[starts[0] + 1 if starts else 0 : ends[0] if ends else len(deck)]:
        for pattern in _NAMES if text.startswith("$") else ():
            if match := pattern.match(text):
                names.setdefault(int(match[1]), match[2].strip())
        name, fields = _fields(text)
        if not name and not any(fields):
            continue
        # Markers of continuations need not match: cards follow each other in the files of today.
        if not name or name[0] in "+*":
            if card is None:
                raise MeshError(
                    f"{location}: expected a card of Nastran, found a continuation: {text[:40]!r}"
                )
            card.fields.extend(fields)
            continue
        if card is not None:
            yield card
        card = Card(name.upper().rstrip("*").rstrip(), fields, location)
    if card is None:
        raise MeshError("expected cards of Nastran, found none")
    yield card


def _fields(text: str) -> tuple[str, list[str]]:
    """The first field, and the 8 others of a line, or 4 where a star asks for long fields."""
    text = text.partition("$")[0].expandtabs()
    first, *items = (
        [item.strip() for item in text.split(",")] if "," in text else [text[:8].strip()]
    )
    count, width = (4, 16) if "*" in first else (8, 8)
    items = items or [text[i : i + width].strip() for i in range(8, 8 + count * width, width)]
    return first, (items + [""] * count)[:count]


def nastran_include(text: str) -> str | None:
    """The file of `INCLUDE 'file'`."""
    match = _INCLUDE.fullmatch(text)
    return match and match[1]
