"""Nastran bulk data (.bdf, .nas, .dat, .fem): grid points, elements, properties and sets of points.

Groups are the elements of a property, as "property 3" and by the name that a comment of HyperMesh,
ANSA or Femap gives it, and the points of SET1 as "set 5", of SPC and SPC1 as "spc 2". Source: MSC
Nastran Quick Reference Guide.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from ....superelement.validation import Array
from ...errors import MeshError
from ..cells import NODES_PER_CELL
from ..mesh import NO_NODES
from ..numbering import Numbering
from .draft import Draft
from .nastran_deck import Card, read_cards
from .nastran_frames import frame_of

# Types of cells by the names of elements; of solids of both orders, which have one name, by the
# number of nodes.
_SOLIDS = {
    "CTETRA": {4: "tetra", 10: "tetra10"},
    "CPYRAM": {5: "pyramid", 13: "pyramid13"},
    "CPYRA": {5: "pyramid", 13: "pyramid13"},
    "CPENTA": {6: "wedge", 15: "wedge15"},
    "CHEXA": {8: "hexahedron", 20: "hexahedron20"},
}
_PARTS = {
    "CTRIA3": "triangle",
    "CTRIAR": "triangle",
    "CTRIA6": "triangle6",
    "CQUAD4": "quad",
    "CQUADR": "quad",
    "CSHEAR": "quad",
    "CQUAD8": "quad8",
    "CBAR": "line",
    "CBEAM": "line",
    "CROD": "line",
    "CTUBE": "line",
}
# Nastran has the middles of the upright edges before those of the top.
_ORDER = {
    "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15],
    "wedge15": [*range(9), 12, 13, 14, 9, 10, 11],
}
# Properties of shells and beams; without one, as Gmsh writes them, these are groups alone.
_PROPERTY = re.compile(r"P(SHELL|COMP|SHEAR|BAR|BEAM|ROD|TUBE)\w*")
_MATERIAL = re.compile(r"MAT\d+")
# Other elements, rigid ones and constraints between points.
_LEFT_OUT = re.compile(r"(?!CORD)C\w+|R(BAR|BE|JOINT|ROD|SPLINE|SSCON|TRPLT)\w*|MPC\w*")


def read(path: Path) -> Draft:
    """A mesh of Nastran; `MeshError` if the file is damaged."""
    grids: list[Card] = []
    elements: list[Card] = []
    sets: list[Card] = []
    systems: dict[int, Card] = {}
    left_out: Counter[str] = Counter()
    materials: list[str] = []
    properties: set[int] = set()
    default_system, default_axes, names = 0, 0, dict[int, str]()
    scalars: list[range] = []
    for card in read_cards(path, names):
        match card.name:
            case "GRID":
                grids.append(card)
            case "GRDSET":
                default_system, default_axes = card.integer(3, 0), card.integer(7, 0)
            case "SPOINT":
                scalars += card.ranges(2)
            case "CORD2R" | "CORD2C" | "CORD2S":
                systems[card.integer(2)] = card
            case "SET1" | "SPC" | "SPC1":
                sets.append(card)
            case name if name in _SOLIDS or name in _PARTS:
                elements.append(card)
            case name if _PROPERTY.fullmatch(name):
                properties.add(card.integer(2))
            case name if _MATERIAL.fullmatch(name):
                materials.append(f"{name} {card.text(2)}")
            case name if _LEFT_OUT.fullmatch(name):
                left_out[name] += 1

    labels = np.array([card.integer(2) for card in grids], dtype=np.int64)
    numbering = Numbering(labels, "grid point")
    points = np.array([[card.number(field) for field in (4, 5, 6)] for card in grids]).reshape(
        -1, 3
    )
    system = np.array([card.integer(3, default_system) for card in grids], dtype=np.int64)
    for number in np.unique(system):
        points[system == number] = frame_of(int(number), systems).to_basic(points[system == number])
    draft = Draft(points, [f"{name} ({count})" for name, count in left_out.items()], labels)
    draft.scalars = np.unique(np.concatenate([NO_NODES, *map(np.array, scalars)]))
    # Only matrices are in these axes: a mesh is read whatever they are.
    draft.axes = partial(_axes, grids, default_axes, points, systems)
    draft.by_label = True
    _add_elements(draft, elements, numbering, names)
    draft.deck.materials = materials
    for card in elements:
        if card.name == "CSHEAR":
            draft.deck.no_shells["CSHEAR (panels that carry shear alone)"] += 1
        if card.name in _PARTS and _property(card) in properties:
            draft.deck.structural[card.name] += 1
    for card in sets:
        _add_points(draft, card, numbering)
    return draft


def _axes(
    grids: Sequence[Card], default: int, points: Array, systems: Mapping[int, Card]
) -> Array | None:
    """The axes (n, 3, 3) of the displacements of points, None where all are basic."""
    system = np.array([card.integer(7, default) for card in grids], dtype=np.int64)
    if not system.any():
        return None
    axes = np.empty((len(points), 3, 3))
    for number in np.unique(system):
        frame = frame_of(int(number), systems)
        axes[system == number] = frame.axes_at(points[system == number])
    return axes


def _add_elements(
    draft: Draft, cards: list[Card], numbering: Numbering, names: dict[int, str]
) -> None:
    by_kind: dict[str, list[tuple[int, list[int]]]] = {}
    for card in cards:
        kind, given = _nodes(card)
        by_kind.setdefault(kind, []).append((_property(card), given))
    for kind, members in by_kind.items():
        nodes = numbering.rows([given for _, given in members], f"{kind} elements")
        rows = draft.add(kind, nodes[:, _ORDER[kind]] if kind in _ORDER else nodes)
        properties = np.array([number for number, _ in members])
        for number in np.unique(properties).tolist():
            # Body files may use either: numbers survive where preprocessors drop comments.
            for name in dict.fromkeys(
                (f"property {number}", names.get(number, f"property {number}"))
            ):
                draft.mark(name, kind, rows[properties == number])


def _property(card: Card) -> int:
    """The number of the property of an element: its own unless given."""
    return card.integer(3, card.integer(2))


def _nodes(card: Card) -> tuple[str, list[int]]:
    """The type of cell of an element, and its nodes."""
    if card.name in _PARTS:
        kind = _PARTS[card.name]
        count = NODES_PER_CELL[kind]
    else:
        # Trailing fields may be blank; the last one that is filled tells the order.
        filled = [field for field, text in enumerate(card.fields[2:], 1) if text]
        count, kinds = filled[-1] if filled else 0, _SOLIDS[card.name]
        if count not in kinds:
            raise MeshError(
                f"{card.location}: {card.name}: "
                f"expected {' or '.join(map(str, kinds))} grid points, found {count}"
            )
        kind = kinds[count]
    return kind, [card.integer(field) for field in range(4, 4 + count)]


def _add_points(draft: Draft, card: Card, numbering: Numbering) -> None:
    """Put the grid points of a set into a group; ranges may name missing ones, SET1 elements."""
    match card.name:
        case "SPC":
            numbers = [card.integer(field) for field in (3, 6) if card.text(field)]
            ranges = [range(number, number + 1) for number in numbers]
        case "SPC1":
            ranges = card.ranges(4)
        case _:
            ranges = card.ranges(3)
    rows = np.concatenate([NO_NODES, *map(numbering.within, ranges)])
    if not len(rows):
        draft.lost.append(
            f"{card.name} {card.integer(2)} ({card.location}), which names no grid points"
        )
    draft.mark_points(f"{card.name[:3].lower()} {card.integer(2)}", rows)
