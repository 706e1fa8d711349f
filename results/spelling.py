"""Quantities as Python spells them, by owner, attribute and axis: "rod.tip.force.y"."""

from collections.abc import Callable, Collection

from .errors import QuantityError

COORDINATE_KIND = "coordinate"
"""the kind of quantity that the coordinates of joints are"""
Coordinates = Callable[[str], Collection[str]]
"""the names of the coordinates of an owner, none where it is no joint"""


def owner_in(text: str, owners: Collection[str]) -> tuple[str, list[str]] | None:
    """The longest owner that a text begins with, and the words after it."""
    words = text.split(".")
    for n in range(len(words) - 1, 0, -1):
        if (owner := ".".join(words[:n])) in owners:
            return owner, words[n:]
    return None


def quantity_of(
    text: str, kinds: Collection[str], owners: Collection[str], coordinates: Coordinates
) -> str:
    """OWNER.ATTRIBUTE[.AXIS] as `duhamel plot` spells it, ATTRIBUTE:OWNER[:AXIS].

    Also "energy.kinetic" and the like; what has a colon, as "angular_velocity:hub:z", stays as it
    is. `QuantityError` for an owner that there is not.
    """
    if ":" in text:
        return text
    if (words := text.split("."))[0] in kinds:
        return ":".join(words)
    if (found := owner_in(text, owners)) is None:
        told = ", ".join(owners) or "none"
        raise QuantityError(f"{text}: nothing is named so; there are: {told}")
    owner, (attribute, *axis) = found
    kind = [COORDINATE_KIND, owner, attribute] if attribute in coordinates(owner) else None
    return ":".join([*(kind or [attribute, owner]), *axis])
