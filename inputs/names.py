"""Names that users give to what they make."""

MAX_NAME_LENGTH = 100
"""characters"""


NAME_SEPARATORS = frozenset("./:")
"""They separate names: frames from bodies, groups of files, the parts of a quantity."""
NAME_FORM = f"1 to {MAX_NAME_LENGTH} printable characters without '.', '/' and ':'"
"""of a name, in the words of errors"""


def is_name(name: str) -> bool:
    """True for a name that can stand in references to frames, in files and in quantities.

    It has 1 to `MAX_NAME_LENGTH` printable characters and none of `NAME_SEPARATORS`.
    """
    return (
        0 < len(name) <= MAX_NAME_LENGTH and name.isprintable() and not NAME_SEPARATORS & set(name)
    )
