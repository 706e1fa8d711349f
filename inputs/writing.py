"""TOML files as users would write them."""

import re
from collections.abc import Mapping
from typing import Any

import tomli_w

SHORT_ARRAY = re.compile(r"\[\n((?:[^\[\]\n]*,\n)+) *\]")
"""an array of numbers or words as tomli_w writes it, an item a line"""
LONGEST_ARRAY = 80
"""characters of an array that stands on one line"""


def toml_of(document: Mapping[str, Any]) -> str:
    """The text of a TOML file; short arrays stand on one line."""
    return SHORT_ARRAY.sub(_on_one_line, tomli_w.dumps(document))


def _on_one_line(array: re.Match[str]) -> str:
    items = ", ".join(line.strip().removesuffix(",") for line in array[1].splitlines())
    return f"[{items}]" if len(items) < LONGEST_ARRAY else array[0]
