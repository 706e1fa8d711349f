"""XML from files of others: no document types, no entities, bounded size and depth."""

from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from ..inputs.text import read_text
from .errors import RobotError

# A robot has some five elements within one another; more would only exhaust the stack.
MAX_DEPTH = 100


def read_xml(path: Path) -> Element:
    """The root element of a file; `RobotError` names the file and the line."""
    return _Reader(path).read(read_text(path, RobotError))


def elements(root: Element) -> Iterator[Element]:
    """An element and all within it; comments are none."""
    return (each for each in root.iter() if isinstance(each.tag, str))


class _Reader:
    """A parser that gives up at what robots do not need and what exhausts memory."""

    def __init__(self, path: Path) -> None:
        self.path = path
        # ElementTree's own parser hides the hooks that are needed here.
        self.builder = TreeBuilder()
        self.depth = 0
        # Given here, the encoding counts and not what the file says: the text is read by now.
        self.parser = expat.ParserCreate("utf-8")
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.StartDoctypeDeclHandler = self._refuse_document_type

    def read(self, text: str) -> Element:
        try:
            self.parser.Parse(text.encode("utf-8"), True)
        except expat.ExpatError as error:
            raise RobotError(f"{self.path}: expected XML: {error}") from error
        return self.builder.close()

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self._error(f"expected at most {MAX_DEPTH} elements within one another")
        self.builder.start(tag, attributes)

    def _end(self, tag: str) -> None:
        self.depth -= 1
        self.builder.end(tag)

    def _refuse_document_type(self, *_: object) -> None:
        # Entities of a document type may expand to gigabytes, or name other files.
        raise self._error("expected no document type (<!DOCTYPE ...>), which robots do not need")

    def _error(self, message: str) -> RobotError:
        return RobotError(f"{self.path}: line {self.parser.CurrentLineNumber}: {message}")
