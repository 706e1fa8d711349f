"""The sections of a report below its plots, an open set: a heading each, and what makes the rest.

SECTIONS.insert(2, ReportSection("Wear", lambda results: table(("joint", "depth"), ...)))
"""

from collections.abc import Callable
from dataclasses import dataclass

from ...results import Results
from .markup import Markup, joined
from .tables import (
    balance_table,
    bodies_table,
    events_table,
    model_text,
    momentum_table,
    peaks_table,
    provenance,
    solver_table,
    validity_table,
)


@dataclass(frozen=True)
class ReportSection:
    """A section of a report; `content` gives None for results that it has nothing to say of."""

    heading: str
    content: Callable[[Results], Markup | None]


def _balances(results: Results) -> Markup:
    return joined([balance_table(results), momentum_table(results)])


SECTIONS = [
    ReportSection("Validity", validity_table),
    ReportSection("Peaks", peaks_table),
    ReportSection("Contact events", events_table),
    ReportSection("Balances", _balances),
    ReportSection("Bodies", bodies_table),
    ReportSection("Run", solver_table),
    ReportSection("Provenance", provenance),
    ReportSection("Model", model_text),
]
"""in their order on the page"""
