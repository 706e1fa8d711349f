"""Abaqus and CalculiX input files (.inp): nodes, elements, sets and surfaces, with or without
parts.

Groups are node sets, element sets and surfaces, by their names as written; those of one name are
one group. A set of a part goes by its own name if the file has one instance, else by INSTANCE.NAME.
A face of a surface becomes a triangle or quad of its corners. Source: Abaqus Keywords Guide, and
for nodes and faces of elements Abaqus Elements Guide.
"""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ...errors import MeshError
from ..cells import CELL_DIMENSIONS
from ..mesh import NO_NODES, IntArray
from ..numbering import Numbering
from .abaqus_deck import Keyword, keywords
from .abaqus_parts import Instance, Sets, read_instances
from .draft import Deck, Draft, Sequence

# Corners of the faces S1, S2, ... of each solid.
_FACES = {
    "tetra": [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]],
    "wedge": [[0, 1, 2], [3, 5, 4], [0, 3, 4, 1], [1, 4, 5, 2], [2, 5, 3, 0]],
    "hexahedron": [
        [0, 1, 2, 3],
        [4, 7, 6, 5],
        [0, 4, 5, 1],
        [1, 5, 6, 2],
        [2, 6, 7, 3],
        [3, 7, 4, 0],
    ],
}


def read(path: Path) -> Draft:
    """A mesh of Abaqus; `MeshError` if the file is damaged, or generates its mesh by commands."""
    lost: list[str] = []
    deck = Deck()
    instances = read_instances(path, lost, deck)
    nodes, elements = _Family("node", lost), _Family("element", lost)
    for name, instance in instances.items():
        nodes.add(name, instance.part.numbers, instance.part.nsets)
        numbers = [NO_NODES, *(numbers for _, numbers, _ in instance.part.elements)]
        elements.add(name, np.concatenate(numbers), instance.part.elsets)

    labels = np.concatenate(
        [np.asarray(instance.part.numbers, dtype=np.int64) for instance in instances.values()]
    )
    draft = Draft(
        np.concatenate([instance.points for instance in instances.values()]), lost, labels
    )
    draft.axes, draft.deck = partial(_no_axes, path), deck
    sequence = Sequence(draft)
    for name, instance in instances.items():
        for kind, _, members in instance.part.elements:
            sequence.add(kind, nodes.rows(name, members, f"*ELEMENT, {kind}"))
    surfaces = _Surfaces(draft, sequence, nodes, elements)
    for key, instance in instances.items():
        name_of = partial(_group_name, instance=instance, instances=instances)
        for name in instance.part.nsets.written.values():
            draft.mark_points(name_of(name), nodes.members(key, name))
        for name in instance.part.elsets.written.values():
            sequence.mark(name_of(name), elements.members(key, name))
        for surface in instance.part.surfaces:
            surfaces.add(surface, key, name_of(surface["NAME"]))
    return draft


def _no_axes(path: Path) -> None:
    """`MeshError` for a deck that turns the dofs of nodes, which matrices would then be in."""
    for keyword in keywords(path):
        if keyword.name == "TRANSFORM":
            raise MeshError(
                f"{keyword.location}: expected dofs of nodes in the axes of the file, found "
                "*TRANSFORM: write the matrices without it"
            )


class _Family:
    """The nodes, or the elements, of all instances in one numbering, by number or by set."""

    def __init__(self, what: str, lost: list[str]) -> None:
        self._what = what
        self._lost = lost
        self._count = 0
        self._instances: dict[str, tuple[Numbering, int, Sets]] = {}

    def add(self, instance: str, numbers: ArrayLike, sets: Sets) -> None:
        numbering = Numbering(numbers, self._what)
        self._instances[instance] = numbering, self._count, sets
        self._count += len(numbering)

    def rows(self, instance: str, numbers: IntArray, user: str) -> IntArray:
        """The rows of numbers of an instance; `MeshError` if one is missing."""
        numbering, first, _ = self._instances[instance]
        return first + numbering.rows(numbers, user)

    def members(self, instance: str, item: str, inside: tuple[str, ...] = ()) -> IntArray:
        """The rows of a set, or of a single number; both may be of another instance, as
        INSTANCE.ITEM.
        """
        holder, _, rest = item.upper().partition(".")
        # Names with a point in them are common: only that of an instance is a prefix.
        if rest and holder in self._instances:
            return self.members(holder, rest, inside)
        numbering, first, sets = self._instances[instance]
        if item.isdigit():
            return first + numbering.rows([int(item)], f"a set or surface of {self._what}s")
        if item.upper() not in sets.entries:
            raise MeshError(f"no {self._what} set {item!r} in the file")
        path = (*inside, f"{instance}.{item.upper()}")
        if path[-1] in inside:
            raise MeshError(f"the {self._what} set {item!r} contains itself")
        rows = [NO_NODES]
        for entry in sets.entries[item.upper()]:
            holder = entry.instance or instance
            if holder not in self._instances:
                raise MeshError(f"{self._what} set {item!r}: no instance {holder!r}")
            numbering, first, _ = self._instances[holder]
            match entry.item:
                case str(name):
                    rows.append(self.members(holder, name, path))
                case range() as numbers:
                    rows.append(first + numbering.within(numbers))
                case numbers:
                    known = numbering.known(numbers)
                    if not known.all():
                        self._lost.append(
                            f"numbers of set {item} that are no {self._what}s ({(~known).sum()})"
                        )
                    rows.append(first + numbering.rows(numbers[known], item))
        return np.concatenate(rows)


def _group_name(name: str, instance: Instance, instances: Mapping[str, Instance]) -> str:
    """The name of a set outside of instances; of a single instance the same, if no set outside has
    it.
    """
    outside = instances[""].part
    taken = {
        *outside.nsets.entries,
        *outside.elsets.entries,
        *(s["NAME"].upper() for s in outside.surfaces),
    }
    # Two entries: the nameless one of the file itself, and the only instance.
    plain = instance.part is outside or (len(instances) == 2 and name.upper() not in taken)
    return name if plain else f"{instance.name}.{name}"


class _Surfaces:
    """Surfaces become groups of facets or of nodes."""

    def __init__(self, draft: Draft, sequence: Sequence, nodes: _Family, elements: _Family) -> None:
        self._draft, self._sequence = draft, sequence
        self._nodes, self._elements = nodes, elements
        self._cells = draft.cells

    def add(self, surface: Keyword, instance: str, group: str) -> None:
        """TYPE=ELEMENT: faces S1 to S6 of solids, and elements that are facets themselves;
        TYPE=NODE: nodes.
        """
        kind = surface.get("TYPE").upper() or "ELEMENT"
        whole = kind in ("ELEMENT", "NODE") and "COMBINE" not in surface.parameters
        for item, *rest in surface.data if whole else ():
            label = rest[0].upper() if rest else ""
            if kind == "NODE":
                self._draft.mark_points(group, self._nodes.members(instance, item))
                continue
            for cells, rows in self._sequence.by_kind(self._elements.members(instance, item)):
                whole &= self._mark_facets(group, cells, rows, label)
        if not whole:
            self._draft.lost.append(f"surface {group} ({surface.location}), or parts of it")

    def _mark_facets(self, group: str, kind: str, rows: IntArray, label: str) -> bool:
        """Put faces of cells into the group; false if the cells have no such face."""
        if CELL_DIMENSIONS.get(kind) == 2 and label in ("", "SPOS", "SNEG"):
            self._draft.mark(group, kind, rows)
            return True
        faces = {
            f"S{i}": face for i, face in enumerate(_FACES.get(kind.rstrip("0123456789"), []), 1)
        }
        if label not in faces:
            return False
        corners = self._cells[kind][rows][:, faces[label]]
        facet = "triangle" if corners.shape[1] == 3 else "quad"
        self._draft.mark(group, facet, self._draft.add(facet, corners))
        return True
