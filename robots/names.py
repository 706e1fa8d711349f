"""Names of a robot as names of a model, which are of fewer characters and all different."""

from collections.abc import Iterable

from ..inputs import is_name
from ..inputs.names import MAX_NAME_LENGTH, NAME_SEPARATORS

# What a name without a character that may stand in one becomes.
UNNAMED_PART = "part"


class Names:
    """Names that are in use, from which new ones differ."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self.taken = set(taken)

    def new(self, wanted: str) -> str:
        """The name that is nearest to a wanted one, and from now on in use."""
        name = plain(wanted)
        # Numbered as the solver numbers what has no name: "revolute 2".
        number = 2
        while name in self.taken:
            ending = f" {number}"
            name = plain(wanted)[: MAX_NAME_LENGTH - len(ending)] + ending
            number += 1
        self.taken.add(name)
        return name


def plain(wanted: str) -> str:
    """A name with underscores for what no name of a model may have."""
    if is_name(wanted):
        return wanted
    kept = "".join(
        character if character.isprintable() and character not in NAME_SEPARATORS else "_"
        for character in wanted
    )
    return kept[:MAX_NAME_LENGTH] or UNNAMED_PART
