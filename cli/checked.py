"""What `duhamel check` found, as a table."""

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from ..superelement import Check

COLUMNS = ("dataset", "expected", "found", "limit", "holds")


def checks_table(title: str, checks: Sequence[Check]) -> Table:
    """A row for each check, in their order."""
    table = Table(title=Text(title))
    for column in COLUMNS:
        table.add_column(column, overflow="fold")
    for check in checks:
        numbers = (f"{check.found:.2g}", f"{check.limit:.2g}", "yes" if check.holds else "NO")
        table.add_row(Text(check.where), Text(check.expected), *numbers)
    return table


def failures(checks: Sequence[Check]) -> list[str]:
    """Those that do not hold, a line each."""
    return [str(check) for check in checks if not check.holds]
