"""ANSYS archives (.cdb), written by CDWRITE in blocks: nodes, solid elements and components.

Groups are components of nodes and of elements. Elements of other types than solids are left out.
Source: ANSYS Mechanical APDL Command Reference and Programmer's Reference, NBLOCK, EBLOCK, CMBLOCK.
"""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....superelement.validation import Array
from ...errors import MeshError
from ..mesh import NO_NODES, IntArray
from ..numbering import Numbering
from .draft import Draft, Sequence
from .text import Line, lines

_SOLIDS = {
    45: {8: "hexahedron"},
    185: {8: "hexahedron"},
    95: {20: "hexahedron20"},
    186: {20: "hexahedron20"},
    92: {10: "tetra10"},
    187: {4: "tetra", 10: "tetra10"},
    285: {4: "tetra"},
}
"""Types of cells by the number of the element type, and the number of its nodes."""
_FORMAT = re.compile(r"\((\d*)i(\d+)(?:,(\d*)e(\d+)\.\S*)?\)", re.IGNORECASE)
NODE_COUNT, ELEMENT_NUMBER, FIRST_NODE = 8, 10, 11  # fields of a line of EBLOCK, from 0


@dataclass(frozen=True)
class ArchiveBlock:
    """A command, its arguments, and the fields of the lines of its block."""

    words: list[str]
    location: str
    integers: list[list[int]]
    reals: list[list[float]]


def read(path: Path) -> Draft:
    """A mesh of ANSYS; `MeshError` if the file is damaged, or not written in blocks."""
    blocks: dict[str, list[ArchiveBlock]] = {"NBLOCK": [], "EBLOCK": [], "CMBLOCK": []}
    types, materials = dict[int, int](), list[str]()
    deck = iter(list(lines(path, lambda _: None)))
    for line in deck:
        words = [word.strip() for word in line.text.split(",")]
        command = words[0].upper()
        if command in blocks:
            blocks[command].append(_block(words, line, deck))
        elif command == "ET":
            types[_integer(words[1:2], line)] = _integer(words[2:3], line)
        elif command == "MPDATA" and len(words) > 4:
            materials.append(f"{words[-3]} of material {words[4].split()[0]}")
    if len(blocks["NBLOCK"]) != 1:
        raise MeshError(
            f"expected one block NBLOCK, as CDWRITE writes it, found {len(blocks['NBLOCK'])}"
        )
    nodes = blocks["NBLOCK"][0]
    labels = np.array([row[0] for row in nodes.integers], dtype=np.int64)
    # Zeros at the end of a line are left out.
    values = np.array([(row + 6 * [0.0])[:6] for row in nodes.reals]).reshape(-1, 6)
    draft = Draft(values[:, :3].copy(), [], labels)
    draft.axes = lambda: _no_axes(labels, values[:, 3:])
    numbers, sequence = _add_elements(draft, blocks["EBLOCK"], types, Numbering(labels, "node"))
    draft.deck.materials = materials
    for block in blocks["CMBLOCK"]:
        _add_component(draft, block, Numbering(labels, "node"), numbers, sequence)
    return draft


def _block(words: list[str], head: Line, deck: Iterator[Line]) -> ArchiveBlock:
    """The rows below a command, of the widths that the line after it says."""
    form = next(deck, Line(head.location, ""))
    match = _FORMAT.fullmatch(form.text.strip())
    if match is None:
        raise MeshError(
            f"{form.location}: expected a format as (3i9,6e21.13e3), found {form.text!r}"
        )
    count, width = int(match[1] or 1), int(match[2])
    real_width = int(match[4] or 0)
    integers: list[list[int]] = []
    reals: list[list[float]] = []
    left = _integer(words[3:4], head) if words[0].upper() == "CMBLOCK" else -1
    while left:
        line = next(deck, None)
        if line is None:
            raise MeshError(f"{head.location}: {words[0]}: the block breaks off")
        text = line.text.rstrip()
        # Blocks of nodes and elements end by -1, alone or as the last word of a command.
        if left < 0 and (text.strip() == "-1" or text.upper().startswith("N,")):
            break
        try:
            row = [int(text[i : i + width]) for i in range(0, min(len(text), count * width), width)]
            places = range(count * width, len(text), real_width) if real_width else ()
            values = [float(text[i : i + real_width]) for i in places]
        except ValueError as error:
            raise MeshError(f"{line.location}: {words[0]}: expected numbers: {error}") from error
        integers.append(row)
        reals.append(values)
        left = max(left - len(row), 0) if left > 0 else left
    return ArchiveBlock(words, head.location, integers, reals)


def _integer(words: list[str], line: Line) -> int:
    try:
        return int("".join(words).partition("!")[0])
    except ValueError as error:
        raise MeshError(
            f"{line.location}: expected an integer, found {line.text[:60]!r}"
        ) from error


def _no_axes(labels: IntArray, angles: Array) -> None:
    """`MeshError` for nodes whose dofs are in axes of their own, which matrices would be in."""
    if (turned := angles.any(axis=1)).any():
        raise MeshError(
            f"expected nodes with dofs in the axes of the file, found {turned.sum()} that are "
            f"turned by NROTAT, first node {labels[turned][0]}"
        )


def _add_elements(
    draft: Draft, blocks: list[ArchiveBlock], types: dict[int, int], nodes: Numbering
) -> tuple[Numbering, Sequence]:
    """Solid elements; their numbers, and the cell of each."""
    numbers: list[int] = []
    sequence = Sequence(draft)
    by_kind: dict[str, list[list[int]]] = {}
    left_out: Counter[str] = Counter()
    for block in blocks:
        if [word.upper() for word in block.words[1:3]] != ["19", "SOLID"]:
            raise MeshError(f"{block.location}: expected EBLOCK,19,SOLID, found {block.words}")
        for row in _whole_rows(block):
            kind = _kind(row, types, block)
            if kind is None:
                left_out[f"elements of type {types.get(row[1], row[1])}"] += 1
                continue
            by_kind.setdefault(kind, []).append(row[ELEMENT_NUMBER:])
    for kind, rows in by_kind.items():
        table = np.array(rows, dtype=np.int64)
        cells = nodes.rows(table[:, 1:], f"{kind} elements")
        _check_whole(kind, table)
        numbers += table[:, 0].tolist()
        sequence.add(kind, cells)
    draft.lost.extend(f"{count} {what}" for what, count in left_out.items())
    return Numbering(numbers, "element"), sequence


def _whole_rows(block: ArchiveBlock) -> Iterator[list[int]]:
    """The fields of each element, of which those with more than 8 nodes go on in the next line."""
    rows = iter(block.integers)
    for row in rows:
        if len(row) <= FIRST_NODE:
            raise MeshError(f"{block.location}: EBLOCK: expected nodes of an element, found {row}")
        while len(row) < FIRST_NODE + row[NODE_COUNT]:
            more = next(rows, [])
            row = row + more
            if not more:
                raise MeshError(f"{block.location}: EBLOCK: the block breaks off")
        yield row


def _check_whole(kind: str, table: IntArray) -> None:
    """`MeshError` for hexahedra that are prisms, pyramids or tetrahedra, as ANSYS allows."""
    in_order = np.sort(table[:, 1:], axis=1)
    collapsed = (in_order[:, 1:] == in_order[:, :-1]).any(axis=1)
    if collapsed.any():
        raise MeshError(
            f"expected elements of different nodes, found {collapsed.sum()} of type {kind} that "
            f"are collapsed, first element {table[collapsed][0, 0]}: mesh the part in SOLID285 or "
            "SOLID187, or in whole hexahedra"
        )


def _kind(row: list[int], types: dict[int, int], block: ArchiveBlock) -> str | None:
    """The type of cell of an element; None of one that is no solid."""
    solids = _SOLIDS.get(types.get(row[1], 0))
    if solids is None:
        return None
    if row[NODE_COUNT] not in solids:
        raise MeshError(
            f"{block.location}: element {row[ELEMENT_NUMBER]} of type {types[row[1]]}: expected "
            f"{' or '.join(map(str, solids))} nodes, found {row[NODE_COUNT]}"
        )
    return solids[row[NODE_COUNT]]


def _add_component(
    draft: Draft, block: ArchiveBlock, nodes: Numbering, elements: Numbering, sequence: Sequence
) -> None:
    """Put the members of a component into a group; -m ends a range that the number before begins.

    `MeshError` names a node that is not there.
    """
    members: list[IntArray] = []
    previous = 0
    for number in (number for row in block.integers for number in row):
        first = previous + 1 if number < 0 else number
        members.append(np.arange(first, abs(number) + 1))
        previous = abs(number)
    name, kind = block.words[1], block.words[2].upper()
    numbers = np.concatenate(members) if members else NO_NODES
    if kind.startswith("NODE"):
        draft.mark_points(name, nodes.rows(numbers, f"component {name}"))
    else:
        # Elements that are left out, as those of surfaces, are no members.
        inside = numbers[elements.known(numbers)]
        sequence.mark(name, elements.rows(inside, f"component {name}"))
