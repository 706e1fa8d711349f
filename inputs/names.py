"""Names that users give to what they make."""

# Characters; a name must fit into messages, legends and names of files.
MAX_NAME_LENGTH = 100


# They separate names: frames from bodies, groups of files, the parts of a quantity.
NAME_SEPARATORS = frozenset("./:")
# What a name must be, in the words of errors.
NAME_FORM = f"1 to {MAX_NAME_LENGTH} printable characters without '.', '/' and ':'"


def is_name(name: str) -> bool:
    """True for a name that can stand in references to frames, in files and in quantities.

    It has 1 to `MAX_NAME_LENGTH` printable characters and none of `NAME_SEPARATORS`.
    """
    return (
        0 < len(name) <= MAX_NAME_LENGTH and name.isprintable() and not NAME_SEPARATORS & set(name)
    )
