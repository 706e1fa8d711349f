"""Names that users give to what they make."""

LONGEST = 100
"""characters"""


def is_name(name: str) -> bool:
    """True for a name that can stand in paths of results, in references to frames and in messages.

    Of 1 to `LONGEST` printable characters, without dots and slashes.
    """
    return 0 < len(name) <= LONGEST and name.isprintable() and not {".", "/"} & set(name)
