"""HTML from values: every text is escaped, whatever it holds."""

from collections.abc import Iterable, Sequence
from html import escape


class Markup(str):
    """Text that is HTML already."""


def element(tag: str, *children: object, **attributes: object) -> Markup:
    """An element; children that are no `Markup` are escaped as text.

    A trailing underscore of an attribute is dropped, as in `class_`; others become hyphens.
    """
    names = (name.rstrip("_").replace("_", "-") for name in attributes)
    written = (
        f' {name}="{escape(str(value))}"'
        for name, value in zip(names, attributes.values(), strict=True)
    )
    return Markup(f"<{tag}{''.join(written)}>{joined(children)}</{tag}>")


def joined(children: Iterable[object]) -> Markup:
    """Children one after the other."""
    return Markup("".join(map(markup, children)))


def markup(child: object) -> Markup:
    """HTML as it is, and everything else as text.

    Characters that UTF-8 has no code for, as of names of files, are escaped.
    """
    if isinstance(child, Markup):
        return child
    return Markup(escape(str(child).encode("utf-8", "backslashreplace").decode("utf-8")))


def section(identity: str, heading: str, *children: object) -> Markup:
    """A part of the page, with its heading."""
    return element("section", element("h2", heading), *children, id=identity)


def note(text: object) -> Markup:
    """A small remark."""
    return element("p", text, class_="note")


def table(headings: Sequence[str], rows: Iterable[Sequence[object]], numbers: str = "") -> Markup:
    """A table; numbers: a letter for each column, "n" where numbers stand, to the right."""
    kinds = numbers.ljust(len(headings), "t")
    head = element("tr", *(_cell("th", h, kind) for h, kind in zip(headings, kinds, strict=True)))
    body = (
        element("tr", *(_cell("td", value, kind) for value, kind in zip(row, kinds, strict=True)))
        for row in rows
    )
    whole = element("table", element("thead", head), element("tbody", *body))
    return element("div", whole, class_="wide")


def _cell(tag: str, value: object, kind: str) -> Markup:
    return element(tag, value, class_="n") if kind == "n" else element(tag, value)


def facts(rows: Iterable[tuple[str, object]]) -> Markup:
    """Names and values, side by side."""
    pairs = (
        element("div", element("dt", name), element("dd", value)) for name, value in rows if value
    )
    return element("dl", *pairs)


def folded(summary: str, *children: object) -> Markup:
    """What opens at a click."""
    return element("details", element("summary", summary), *children)
