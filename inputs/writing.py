"""TOML files as users would write them."""

import re
from collections.abc import Mapping
from typing import Any

import tomli_w

# tomli_w writes arrays of numbers or words with an item a line.
SHORT_ARRAY = re.compile(r"\[\n((?:[^\[\]\n]*,\n)+) *\]")
# Characters of an array that stays on one line.
LONGEST_ARRAY = 80


def toml_of(document: Mapping[str, Any]) -> str:
    """The text of a TOML file; short arrays stand on one line."""
    return SHORT_ARRAY.sub(_on_one_line, tomli_w.dumps(document))


def _on_one_line(array: re.Match[str]) -> str:
    items = ", ".join(line.strip().removesuffix(",") for line in array[1].splitlines())
    return f"[{items}]" if len(items) < LONGEST_ARRAY else array[0]
