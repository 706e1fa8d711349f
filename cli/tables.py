"""How commands write tables, numbers of several components and sections of names and values."""

from collections.abc import Iterable, Sequence

from rich.table import Table
from rich.text import Text

from ..superelement.validation import Array

Row = tuple[str, str]
"""a name and a value"""


def table(
    title: str, headings: Sequence[str], rows: Iterable[Sequence[object]], kinds: str = ""
) -> Table:
    """A table under a title.

    kinds: a letter for each column, as in tables of reports: "n" for numbers, which stand to the
    right and are never folded, "t" for text.
    """
    made = Table(title=Text(title) if title else None)
    for heading, kind in zip(headings, kinds.ljust(len(headings), "t"), strict=True):
        if kind == "n":
            made.add_column(Text(heading), justify="right", no_wrap=True)
        else:
            made.add_column(Text(heading), overflow="fold")
    for row in rows:
        # Names of users may hold brackets, which rich would read as orders.
        made.add_row(*(Text(str(cell)) for cell in row))
    return made


def sectioned(title: str, sections: Iterable[Iterable[Row]]) -> Table:
    """Names and values side by side, with a line below each section."""
    made = Table(title=Text(title), show_header=False)
    made.add_column(no_wrap=True)
    made.add_column(overflow="fold")
    for section in sections:
        for name, value in section:
            made.add_row(Text(name), Text(value))
        made.add_section()
    return made


def components(values: Array) -> str:
    """Numbers in columns of one width, so that vectors stand below each other."""
    return " ".join(f"{value:11.5g}" for value in values)
