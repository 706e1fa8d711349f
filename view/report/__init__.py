"""A report of a run: one page of HTML that holds all it needs, for a browser without a network."""

from .write import write_report

__all__ = ["write_report"]
