"""The keywords of an Abaqus input file and the data lines below them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ...errors import MeshError
from .text import INTEGER_PATTERN, lines

_INCLUDE = re.compile(r'\*INCLUDE\s*,\s*INPUT\s*=\s*"?([^"]+?)"?\s*,?\s*', re.IGNORECASE)


@dataclass(frozen=True)
class Keyword:
    """`*NAME, PARAMETER=value, FLAG` and the items of the data lines below it. Names are in upper
    case.
    """

    name: str
    parameters: dict[str, str]
    location: str
    data: list[list[str]] = field(default_factory=list)

    def __getitem__(self, parameter: str) -> str:
        """The value of a parameter that must be there."""
        if not self.parameters.get(parameter):
            raise MeshError(f"{self.location}: *{self.name}: expected a value of {parameter}")
        return self.parameters[parameter]

    def get(self, parameter: str) -> str:
        """The value of a parameter, nothing if it is not there."""
        return self.parameters.get(parameter, "")

    def ints(self, items: list[str]) -> list[int]:
        for item in items:
            if not INTEGER_PATTERN.fullmatch(item):
                raise MeshError(
                    f"{self.location}: *{self.name}: expected an integer, found {item!r}"
                )
        return [int(item) for item in items]

    def floats(self, items: list[str]) -> list[float]:
        """Numbers, 0 where nothing is written; Fortran's exponents are understood."""
        try:
            return [float(item.upper().replace("D", "E") or 0.0) for item in items]
        except ValueError as error:
            raise MeshError(
                f"{self.location}: *{self.name}: expected numbers, found {items}"
            ) from error


def keywords(path: Path) -> Iterator[Keyword]:
    """The keywords of a file and of those it includes, in their order."""
    keyword: Keyword | None = None
    head = ""
    for location, text in lines(path, abaqus_include):
        if not text.strip() or text.startswith("**"):
            continue
        if head or text.startswith("*"):
            # A line of a keyword that ends in a comma goes on in the next one.
            head += text.strip()
            if not head.endswith(","):
                if keyword is not None:
                    yield keyword
                keyword, head = _keyword(head, location), ""
        elif keyword is None:
            raise MeshError(
                f"{location}: expected a keyword of Abaqus (*HEADING, *NODE, ...), found "
                f"{text[:40]!r}"
            )
        else:
            keyword.data.append(
                [item.strip() for item in text.strip().removesuffix(",").split(",")]
            )
    if keyword is None:
        raise MeshError("expected keywords of Abaqus, found none")
    yield keyword


def _keyword(text: str, location: str) -> Keyword:
    name, *parameters = [" ".join(item.split()) for item in text[1:].split(",")]
    # Flags have no value, and are there by their name alone.
    pairs = [parameter.partition("=") for parameter in parameters if parameter]
    values = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
    return Keyword(name.upper(), values, location)


def abaqus_include(text: str) -> str | None:
    """The file of `*INCLUDE, INPUT=file`."""
    match = _INCLUDE.fullmatch(text)
    return match and match[1]
