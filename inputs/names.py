"""Names that users give to what they make."""

LONGEST = 100
"""characters"""


SEPARATORS = frozenset("./:")
"""They separate names: frames from bodies, groups of files, the parts of a quantity."""
FORM = f"1 to {LONGEST} printable characters without '.', '/' and ':'"
"""of a name, in the words of errors"""


def is_name(name: str) -> bool:
    """True for a name that can stand in references to frames, in files and in quantities.

    It has 1 to `LONGEST` printable characters and none of `SEPARATORS`.
    """
    return 0 < len(name) <= LONGEST and name.isprintable() and not SEPARATORS & set(name)
