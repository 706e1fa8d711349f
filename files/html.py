"""Small tables in HTML, by which notebooks show objects."""

from collections.abc import Iterable
from html import escape

Row = tuple[str, str]
"""what it is, and its value; a value of several lines keeps them"""
# Characters; a longer value would hide the rest of the table.
MAX_HTML_VALUE = 2000


def table(title: str, rows: Iterable[Row]) -> str:
    """A title and rows; whatever is in them is text."""
    lines = [f"<tr><th style='text-align:left'>{_text(title)}</th><td></td></tr>"]
    for name, value in rows:
        cells = (f"<td style='text-align:left'>{_text(text)}</td>" for text in (name, value))
        lines.append(f"<tr>{''.join(cells)}</tr>")
    return "\n".join(["<table>", *lines, "</table>"])


def listed(names: Iterable[str], most: int = 10) -> str:
    """Names in a line, the first of many."""
    known = list(names)
    more = len(known) - most
    shown = ", ".join(known[:most])
    return f"{shown} and {more} more" if more > 0 else shown or "none"


def _text(text: str) -> str:
    shown = text if len(text) <= MAX_HTML_VALUE else f"{text[:MAX_HTML_VALUE]}..."
    return escape(shown).replace("\n", "<br>")
