"""Exudyn's models for the benchmarks beside it."""

import sys

sys.exudynFast = (
    True  # its build without range checks, which it looks for when it is first imported
)
