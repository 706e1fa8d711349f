"""A report of a run: one page of HTML that holds all it needs, for a browser without a network."""

from ..field_kinds import FIELD_WORDS
from .sections import SECTIONS, ReportSection
from .write import write_report

REPORT_FIELDS = tuple(FIELD_WORDS)
"""the fields that can color the animation"""

__all__ = ["REPORT_FIELDS", "SECTIONS", "ReportSection", "write_report"]
