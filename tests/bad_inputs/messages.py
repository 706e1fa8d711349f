"""What every error must be: one line that names the file and the key, and nothing left behind."""

from collections.abc import Iterable
from pathlib import Path

LONGEST = 2000
"""characters of a message"""


def complaint(error: Exception, path: Path, names: Iterable[str]) -> str:
    """What is wrong with the message of an error; "" if nothing is.

    names: words of which it must have one, such as the key and the name of its table.
    """
    text = str(error)
    if len(text.splitlines()) != 1 or not text.isprintable():
        return f"expected one line, found {text[:300]!r}"
    if len(text) > LONGEST:
        return f"expected at most {LONGEST} characters, found {len(text)}: {text[:100]}"
    if not text.startswith(f"{path}: "):
        return f"expected the file first, found {text[:300]!r}"
    if not any(name in text.removeprefix(str(path)) for name in names):
        return f"expected one of {list(names)}, found {text[:300]!r}"
    return "pydantic's own words" if "pydantic" in text else ""
