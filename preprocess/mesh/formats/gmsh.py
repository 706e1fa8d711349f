"""Gmsh's files (.msh), versions 2.2 and 4.1, text and binary.

Groups are the physical groups, by name, or as "physical surface 7" where they have none. An entity
may be in several. Source: Gmsh reference manual, "MSH file format" and its legacy versions.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...errors import MeshError
from ..cells import CELL_DIMENSIONS, NODES_PER_CELL
from ..mesh import NO_NODES, IntArray
from ..numbering import Numbering
from .draft import Draft
from .numbers import BinaryNumbers, Numbers, TextNumbers

# Types of cells, in the order of the numbers that Gmsh gives to them, from 1 on.
_TYPES = (
    *("line", "triangle", "quad", "tetra", "hexahedron", "wedge", "pyramid", "line3", "triangle6"),
    *("quad9", "tetra10", "hexahedron27", "wedge18", "pyramid14", "vertex", "quad8"),
    *("hexahedron20", "wedge15", "pyramid13"),
)
# Where Gmsh has the nodes of a cell, in meshio's order; cells that are not here have them in the
# same order.
_EDGES = [8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]
_ORDER = {
    "tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hexahedron20": [*range(8), *_EDGES],
    "hexahedron27": [*range(8), *_EDGES, 22, 23, 21, 24, 20, 25, 26],
}
LONGEST_COUNT = 64  # bytes of a line with a count
_SECTION = re.compile(rb"\s*\$(\w+)[ \t]*\r?\n")
_PHYSICAL = ("physical point", "physical curve", "physical surface", "physical volume")


def read(path: Path) -> Draft:
    """A mesh of Gmsh; `MeshError` if the file is damaged or of another version."""
    sections = _sections(path.read_bytes())
    form = _Format(bytes(sections.pop("MeshFormat", b"")))
    for name in ("Nodes", "Elements"):
        if name not in sections:
            raise MeshError(f"the file has no section ${name}")
    names = _physical_names(bytes(sections.get("PhysicalNames", b"0")))
    return (
        _read2(sections, form, names) if form.version[0] == "2" else _read4(sections, form, names)
    )


def _sections(data: bytes) -> dict[str, memoryview]:
    """The contents between $NAME and $EndNAME, by name, in place."""
    sections = {}
    position, whole = 0, memoryview(data)
    while match := _SECTION.match(data, position):
        name = match[1]
        # Found, not counted: binary sections may hold any bytes, but not this word by chance.
        end = data.find(b"$End" + name, match.end())
        if end < 0:
            raise MeshError(f"the file breaks off: ${name.decode()} has no $End{name.decode()}")
        sections[name.decode()] = whole[match.end() : end]
        position = end + len(b"$End" + name)
    if rest := data[position:].strip():
        raise MeshError(f"expected a section of Gmsh, found {rest[:20]!r}")
    return sections


class _Format:
    """The section $MeshFormat: version, text or binary, and how numbers are stored."""

    def __init__(self, section: bytes) -> None:
        line, _, one = section.partition(b"\n")
        given = re.fullmatch(r"\s*([\d.]+)\s+([01])\s+([48])\s*", line.decode("ascii", "replace"))
        if given is None:
            raise MeshError(
                f"$MeshFormat: expected version, type and size of numbers, found {line[:20]!r}"
            )
        self.version, self.binary, self._size = given[1], given[2] == "1", int(given[3])
        if self.version not in ("2", "2.1", "2.2", "4.1"):
            raise MeshError(
                f"the file has version {self.version} of Gmsh's format; expected 2.2 or 4.1"
            )
        # A binary file begins with the integer 1.
        self._order = "<" if one.startswith(b"\1") else ">"

    def numbers(self, section: memoryview) -> Numbers:
        if self.binary:
            return BinaryNumbers(section, self._order, self._size)
        return TextNumbers(bytes(section))

    def counted(self, section: memoryview) -> tuple[int, Numbers]:
        """The count that version 2 writes as text before the numbers of a section."""
        count, _, _ = bytes(section[:LONGEST_COUNT]).partition(b"\n")
        if not count.strip().isdigit():
            raise MeshError(f"expected a count, found {count[:20]!r}")
        return int(count), self.numbers(section[len(count) + 1 :])


def _physical_names(section: bytes) -> dict[tuple[int, int], str]:
    """Names by dimension and tag."""
    count, *lines = section.decode("utf-8", "replace").strip().splitlines() or [""]
    names = {}
    for line in lines:
        match = re.fullmatch(r'\s*([0-3])\s+(-?\d+)\s+"(.*)"\s*', line)
        if match is None:
            raise MeshError(f"$PhysicalNames: expected dimension, tag and name, found {line!r}")
        names[int(match[1]), abs(int(match[2]))] = match[3]
    if count.strip() != str(len(names)):
        raise MeshError(
            f"$PhysicalNames: expected {count.strip() or 'a count of'} names, found {len(names)}"
        )
    return names


def _name(names: dict[tuple[int, int], str], dimension: int, tag: int) -> str:
    return names.get((dimension, tag), f"{_PHYSICAL[dimension]} {tag}")


def _kind(number: int) -> tuple[str, int]:
    """The type of a cell and its number of nodes."""
    if not 1 <= number <= len(_TYPES):
        raise MeshError(f"$Elements: unsupported elements of Gmsh's type {number}")
    kind = _TYPES[number - 1]
    return kind, NODES_PER_CELL[kind]


def _cells(kind: str, nodes: IntArray, numbering: Numbering) -> IntArray:
    rows = numbering.rows(nodes, "$Elements")
    return rows[:, _ORDER[kind]] if kind in _ORDER else rows


def _finish(numbers: Numbers, section: str) -> None:
    """A newline may follow binary numbers, and nothing else."""
    if numbers.left > isinstance(numbers, BinaryNumbers):
        raise MeshError(f"${section}: {numbers.left} numbers or bytes more than it announces")


def _read2(
    sections: dict[str, memoryview], form: _Format, names: dict[tuple[int, int], str]
) -> Draft:
    """Version 2: elements have tags of their own, and stand once for each physical group."""
    count, numbers = form.counted(sections["Nodes"])
    given, points = numbers.table(count, ("i", 1), ("d", 3))
    _finish(numbers, "Nodes")
    draft, numbering = Draft(points, labels=given.ravel()), Numbering(given.ravel(), "node")

    count, numbers = form.counted(sections["Elements"])
    tables = (
        _binary_tables(numbers, count)
        if isinstance(numbers, BinaryNumbers)
        else _text_tables(numbers, count)
    )
    blocks: dict[int, list[IntArray]] = {}
    for number, table in tables:
        _, k = _kind(number)
        tags = table[:, 1] if table.shape[1] > 1 + k else np.zeros(len(table), dtype=np.int64)
        blocks.setdefault(number, []).append(np.column_stack([np.abs(tags), table[:, -k:]]))
    _finish(numbers, "Elements")
    for number, parts in blocks.items():
        kind, rows = _kind(number)[0], np.concatenate(parts)
        _, first, same = np.unique(rows[:, 1:], axis=0, return_index=True, return_inverse=True)
        # Elements in several groups are written several times; the body has each once.
        row = np.argsort(np.argsort(first))[same.ravel()]
        draft.add(kind, _cells(kind, rows[np.sort(first), 1:], numbering))
        for tag in np.unique(rows[:, 0]):
            if tag:
                draft.mark(
                    _name(names, CELL_DIMENSIONS.get(kind, 3), int(tag)),
                    kind,
                    row[rows[:, 0] == tag],
                )
    return draft


def _binary_tables(numbers: BinaryNumbers, count: int) -> Iterator[tuple[int, IntArray]]:
    """Types and tables of number, tags and nodes; each table has a header.

    The header: type, length and number of tags.
    """
    while count > 0:
        ((number, length, tags),) = numbers.table(1, ("i", 3))[0].tolist()
        if length < 1:
            raise MeshError(f"$Elements: expected elements in each block, found {length}")
        yield number, numbers.table(length, ("i", 1 + tags + _kind(number)[1]))[0]
        count -= length


def _text_tables(numbers: TextNumbers, count: int) -> Iterator[tuple[int, IntArray]]:
    """Elements from rows of number, type, number of tags, tags and nodes; runs of equal rows at
    once.
    """
    while count > 0:
        _, number, tags = numbers.ahead(3)
        width = 3 + max(tags, 0) + _kind(number)[1]
        length = numbers.alike(width, slice(1, 3), count)
        table = numbers.table(max(length, 1), ("i", width))[0]
        yield number, np.delete(table, [1, 2], axis=1)
        count -= length


def _read4(
    sections: dict[str, memoryview], form: _Format, names: dict[tuple[int, int], str]
) -> Draft:
    """Version 4.1: elements belong to entities, which know their physical groups."""
    if "PartitionedEntities" in sections:
        raise MeshError("the mesh is partitioned; expected one that is saved whole")
    groups = _entities(form.numbers(sections["Entities"])) if "Entities" in sections else {}
    numbers = form.numbers(sections["Nodes"])
    blocks, count, _, _ = numbers.table(1, ("u", 4))[0][0].tolist()
    given, points = [NO_NODES], [np.zeros((0, 3))]
    for _ in range(blocks):
        (((dimension, _, parametric),), ((length,),)) = numbers.table(1, ("i", 3), ("u", 1))
        if dimension not in range(4):
            raise MeshError(f"$Nodes: expected an entity of dimension 0 to 3, found {dimension}")
        given.append(numbers.table(length, ("u", 1))[0].ravel())
        # Parametric nodes carry their parameters on the entity, one for each of its dimensions.
        points.append(numbers.table(length, ("d", 3 + bool(parametric) * dimension))[0][:, :3])
    _finish(numbers, "Nodes")
    labels = np.concatenate(given)
    draft, numbering = Draft(np.concatenate(points), labels=labels), Numbering(labels, "node")
    if count != len(draft.points):
        raise MeshError(f"$Nodes: expected {count} nodes, found {len(draft.points)}")

    numbers = form.numbers(sections["Elements"])
    blocks, count, _, _ = numbers.table(1, ("u", 4))[0][0].tolist()
    found = 0
    for _ in range(blocks):
        (((dimension, entity, number),), ((length,),)) = numbers.table(1, ("i", 3), ("u", 1))
        kind, k = _kind(int(number))
        rows = draft.add(
            kind, _cells(kind, numbers.table(length, ("u", 1 + k))[0][:, 1:], numbering)
        )
        found += length
        for tag in groups.get((dimension, entity), []):
            draft.mark(_name(names, dimension, tag), kind, rows)
    _finish(numbers, "Elements")
    if found != count:
        raise MeshError(f"$Elements: expected {count} elements, found {found}")
    return draft


def _entities(numbers: Numbers) -> dict[tuple[int, int], list[int]]:
    """The physical tags of each entity, by its dimension and tag."""
    groups = {}
    for dimension, count in enumerate(numbers.table(1, ("u", 4))[0][0].tolist()):
        for _ in range(count):
            # A point has its place, what is larger a bounding box, and the entities that bound it.
            ((tag,),), _, ((physical,),) = numbers.table(
                1, ("i", 1), ("d", 6 if dimension else 3), ("u", 1)
            )
            groups[dimension, int(tag)] = np.abs(
                numbers.table(1, ("i", int(physical)))[0][0]
            ).tolist()
            if dimension:
                ((bounds,),) = numbers.table(1, ("u", 1))[0]
                numbers.table(1, ("i", int(bounds)))
    _finish(numbers, "Entities")
    return groups
