"""Sections, materials and laminates of the elements of a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from ...superelement.validation import Array
from ..assembly.source import Share
from ..body.material import Material, Section
from ..elements.laminate import Laminate
from ..errors import BodyError
from ..mesh.mesh import IntArray, Mesh

Property = TypeVar("Property", Section, Material, Laminate)


@dataclass(frozen=True, eq=False)
class Assignment(Generic[Property]):
    """Sections or materials by group of the mesh, and their number (n_elements,) for every element.

    The group "" is the whole mesh.
    """

    properties: Mapping[str, Property]
    owners: IntArray

    @property
    def values(self) -> list[Property]:
        """The properties in the order of their numbers."""
        return list(self.properties.values())

    def shares(self, extents: Array, unit: str) -> tuple[Share, ...]:
        """The share of each property, from the length or volume (n_elements,) of every element."""
        shares = []
        for number, (group, value) in enumerate(self.properties.items()):
            members = extents[self.owners == number]
            total = float(members.sum())
            shares.append(Share(group, len(members), total, unit, value.density * total))
        return tuple(shares)


def assign(
    mesh: Mesh, whole: Property | None, by_group: Mapping[str, Property], key: str
) -> Assignment[Property]:
    """One property for all elements, or one for each group; `key` names their table.

    `BodyError` unless every element is in exactly one group.
    """
    if whole is not None:
        return Assignment({"": whole}, np.zeros(mesh.n_elements, dtype=np.int64))
    # Overlaps and gaps are both mistakes of groups, and are told together.
    members = np.zeros((len(by_group), mesh.n_elements), dtype=bool)
    for i, name in enumerate(by_group):
        members[i, mesh.members(name)] = True
    count = members.sum(axis=0)
    if (count != 1).any():
        kind, row = mesh.element(int(np.flatnonzero(count != 1)[0]))
        raise BodyError(
            f"{mesh.name}: every element must be in exactly one of the groups of [{key}] "
            f"({', '.join(by_group)}): {(count == 0).sum()} are in none and {(count > 1).sum()} "
            f"in several, first {kind} element {row}"
        )
    return Assignment(by_group, members.argmax(axis=0))
