"""Quantities by owner, attribute and axis: "rod.tip.elastic_displacement.y"."""

from collections.abc import Callable, Collection

from duhamel.results import QuantityError
from duhamel.results.quantities import KINDS_BY_NAME

COORDINATE_KIND = "coordinate"
"""the kind of quantity that the coordinates of joints are"""
Coordinates = Callable[[str], Collection[str]]
"""the names of the coordinates of an owner, none where it is no joint"""


def quantity_of(text: str, owners: Collection[str], coordinates: Coordinates) -> str:
    """A quantity as `duhamel plot` names it, from "OWNER.ATTRIBUTE[.AXIS]".

    Also "energy.kinetic" and the like; what has a colon, as "angular_velocity:hub:z", stays as it
    is. `QuantityError` for an owner that there is not.
    """
    if ":" in text:
        return text
    words = text.split(".")
    if words[0] in KINDS_BY_NAME:
        return ":".join(words)
    for n in range(len(words) - 1, 0, -1):
        owner = ".".join(words[:n])
        if owner in owners:
            attribute, *axis = words[n:]
            kind = [COORDINATE_KIND, owner, attribute] if attribute in coordinates(owner) else None
            return ":".join([*(kind or [attribute, owner]), *axis])
    raise QuantityError(f"{text}: nothing is named so; there are: {', '.join(owners) or 'none'}")
