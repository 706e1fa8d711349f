"""HTML from templates, in which every text is escaped, whatever it holds."""

from collections.abc import Iterable, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from .libraries import package

REPORT_FOLDER = files(__package__)


class Markup(str):
    """Text that is HTML already, which templates take as it is."""

    def __html__(self) -> str:
        return self


def rendered(template: str, **values: object) -> Markup:
    """A template of this folder with its values."""
    return Markup(_environment().get_template(template).render(values))


def part(name: str, *values: object) -> Markup:
    """A macro of parts.html with its values."""
    return Markup(getattr(_environment().get_template("parts.html").module, name)(*values).strip())


def joined(parts: Iterable[Markup]) -> Markup:
    """HTML one after the other."""
    return Markup("".join(parts))


def note(text: object) -> Markup:
    """A small remark."""
    return part("note", text)


def table(headings: Sequence[str], rows: Iterable[Sequence[object]], numbers: str = "") -> Markup:
    """A table; numbers: a letter for each column, "n" where numbers stand, to the right."""
    return part("table", headings, rows, numbers.ljust(len(headings), "t"))


def facts(rows: Iterable[tuple[str, object]]) -> Markup:
    """Names and values, side by side."""
    return part("facts", rows)


def folded(summary: str, content: Markup) -> Markup:
    """What opens at a click."""
    return part("folded", summary, content)


def read(name: str) -> str:
    """The text of a file of this folder."""
    return REPORT_FOLDER.joinpath(name).read_text(encoding="utf-8")


@cache
def _environment() -> Any:
    # Jinja comes with the extra `report`: all of `duhamel.view` but reports works without it.
    jinja2 = package("jinja2")
    return jinja2.Environment(
        loader=jinja2.FunctionLoader(read),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        # A misspelled name would leave a gap in the page that nobody sees.
        undefined=jinja2.StrictUndefined,
    )
