"""A mesh while its file is being read."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ....superelement.validation import Array
from ..cells import FACET_TYPES, SOLID_TYPES
from ..mesh import NO_NODES, Group, IntArray

BEAM_PREFIXES = ("B", "CBAR", "CBEAM", "CROD", "CTUBE")
"""What the names of beams begin with, of Abaqus and of Nastran."""


@dataclass
class Deck:
    """What a deck computes with, and a mesh does not have.

    structural: the numbers of shells and beams by the names of their types, whose faces and lines
    are groups alone where the body is of other elements. no_shells: those of other flat elements,
    such as membranes. materials: in words.
    """

    structural: Counter[str] = field(default_factory=Counter)
    no_shells: Counter[str] = field(default_factory=Counter)
    materials: list[str] = field(default_factory=list)

    def not_in_the_body(self, kinds: Iterable[str], n_shells: int) -> Iterator[str]:
        """What the body of a mesh with cells of these types leaves out, in words.

        n_shells: the cells that are shells beside solids.
        """
        kinds = set(kinds)
        beams = {name: n for name, n in self.structural.items() if name.startswith(BEAM_PREFIXES)}
        left, beside = dict(self.structural), "solid elements, shells and beams"
        if kinds.isdisjoint(SOLID_TYPES):
            left, beside = {} if kinds.isdisjoint(FACET_TYPES) else beams, "shells, beams"
        elif n_shells:
            others = sum(self.structural.values()) - sum(beams.values()) - n_shells
            if others > 0:
                yield f"stiffness and mass of {others} shells, which are in no group of [shells]"
            left, beside = beams, "solid elements and shells, beams"
        if left:
            counts = ", ".join(f"{count} {name}" for name, count in left.items())
            yield f"stiffness and mass of {counts}: beside {beside} serve as groups alone"
        if self.materials:
            listed = ", ".join(dict.fromkeys(self.materials))
            yield f"materials {listed}: those of the body file are used"


class Draft:
    """Points (n, 3), cells and groups of a file, in its order.

    A name that is given to several things, as to nodes and to elements, is one group of them all.
    `lost` tells in words what the file holds and the draft does not; labels (n,) are the numbers
    that it gives to points, None if none. axes() (n, 3, 3): the axes of the displacements of points
    as rows, None where all have those of the file; scalars: the numbers of scalar points. by_label:
    whether matrices of the program have their rows in the order of the numbers. deck: what the
    program computes with.
    """

    def __init__(
        self, points: Array, lost: list[str] | None = None, labels: IntArray | None = None
    ) -> None:
        self.points = points
        self.labels = labels
        self.axes: Callable[[], Array | None] = lambda: None
        self.scalars = NO_NODES
        self.by_label = False
        self.deck = Deck()
        self.lost = [] if lost is None else lost
        self._blocks: dict[str, list[IntArray]] = {}
        self._counts: Counter[str] = Counter()
        self._cells: dict[str, dict[str, list[IntArray]]] = {}
        self._points: dict[str, list[IntArray]] = {}

    def add(self, kind: str, nodes: IntArray) -> IntArray:
        """Cells (n, k) of one type, as rows of `points`; their rows (n,) among all cells of that
        type.
        """
        first = self._counts[kind]
        self._counts[kind] += len(nodes)
        self._blocks.setdefault(kind, []).append(nodes)
        return np.arange(first, first + len(nodes))

    def mark(self, name: str, kind: str, rows: ArrayLike) -> None:
        """Put cells into a group."""
        self._cells.setdefault(name, {}).setdefault(kind, []).append(
            np.asarray(rows, dtype=np.int64)
        )

    def mark_points(self, name: str, rows: ArrayLike) -> None:
        """Put points into a group."""
        self._points.setdefault(name, []).append(np.asarray(rows, dtype=np.int64))

    @property
    def cells(self) -> dict[str, IntArray]:
        return {kind: np.concatenate(blocks) for kind, blocks in self._blocks.items()}

    @property
    def groups(self) -> dict[str, Group]:
        """Every group that holds something."""
        groups = {}
        for name in {**self._cells, **self._points}:
            cells = {
                kind: np.unique(np.concatenate(rows))
                for kind, rows in self._cells.get(name, {}).items()
            }
            # Files may name a member twice, as sets within sets do.
            points = np.unique(np.concatenate([NO_NODES, *self._points.get(name, [])]))
            groups[name] = Group({kind: rows for kind, rows in cells.items() if len(rows)}, points)
        return {name: group for name, group in groups.items() if group.kinds}


class Sequence:
    """The elements of a file in its order, across types, and the cell of each."""

    def __init__(self, draft: Draft) -> None:
        self._draft = draft
        self._kinds: list[str] = []
        self._blocks: list[tuple[IntArray, IntArray]] = [(NO_NODES, NO_NODES)]

    def add(self, kind: str, nodes: IntArray) -> None:
        """The next elements, all of one type."""
        if kind not in self._kinds:
            self._kinds.append(kind)
        self._blocks.append(
            (np.full(len(nodes), self._kinds.index(kind)), self._draft.add(kind, nodes))
        )

    def __len__(self) -> int:
        return sum(len(rows) for _, rows in self._blocks)

    def by_kind(self, elements: IntArray) -> Iterator[tuple[str, IntArray]]:
        """The cells of elements, numbered in the order of the file: rows of each type."""
        kinds, rows = (np.concatenate(parts) for parts in zip(*self._blocks, strict=True))
        for i, kind in enumerate(self._kinds):
            if len(found := rows[elements[kinds[elements] == i]]):
                yield kind, found

    def mark(self, group: str, elements: IntArray) -> None:
        """Put the cells of elements into a group."""
        for kind, rows in self.by_kind(elements):
            self._draft.mark(group, kind, rows)
