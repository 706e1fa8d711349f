"""Parts, instances and sets of an Abaqus input file."""

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from ....superelement.validation import Array
from ...errors import MeshError
from ..cells import NODES_PER_CELL
from ..mesh import NO_NODES, IntArray
from .abaqus_deck import Keyword, keywords
from .draft import Deck

# Types of cells by the names of elements: solids, whatever makes facets, trusses and beams.
_KINDS = (
    (r"C3D4", "tetra"),
    (r"C3D5", "pyramid"),
    (r"C3D6", "wedge"),
    (r"C3D8", "hexahedron"),
    (r"C3D10", "tetra10"),
    (r"C3D15", "wedge15"),
    (r"C3D20", "hexahedron20"),
    (r"C3D27", "hexahedron27"),
    (r"STRI3|(S|CP[SE]|CAX|M3D|SFM3D|R3D)3", "triangle"),
    (r"STRI65|(S|CP[SE]|CAX|M3D|SFM3D)6", "triangle6"),
    (r"(S|CP[SE]|CAX|M3D|SFM3D|R3D)4", "quad"),
    (r"(S|CP[SE]|CAX|M3D|SFM3D)8", "quad8"),
    (r"(S|M3D)9", "quad9"),
    (r"T[23]D2|B[23][13]", "line"),
    (r"T[23]D3|B[23]2", "line3"),
)
# Shells and beams, which carry load in the deck. Membranes and trusses are what Gmsh writes for
# groups of surfaces and lines.
_STRUCTURAL = re.compile(r"(STRI|S|B)\d\w*")
# Flat elements that are no shells: what they are in the deck.
_FLAT = {
    "CPS": "plane stress",
    "CPE": "plane strain",
    "CAX": "axially symmetric",
    "M3D": "membranes",
    "SFM3D": "surfaces without stiffness",
    "R3D": "rigid",
}
_NO_SHELLS = re.compile(rf"({'|'.join(_FLAT)})\d")
# The center of a C3D27 stands before the middles of its faces 1 to 6.
_ORDER = {"hexahedron27": [*range(20), 26, 24, 23, 25, 21, 22, 20]}
_GENERATED = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM")
_CONNECTIONS = (
    "TIE",
    "MPC",
    "EQUATION",
    "COUPLING",
    "KINEMATIC COUPLING",
    "SHELL TO SOLID COUPLING",
    "RIGID BODY",
    "EMBEDDED ELEMENT",
)


@dataclass(frozen=True)
class Entry:
    """An entry of a set: numbers, a range of numbers, or the name of another set.

    They are of an instance, where it is said.
    """

    item: str | IntArray | range
    instance: str = ""


@dataclass
class Sets:
    """Sets of nodes or of elements by name in upper case, as names are not case-sensitive."""

    entries: dict[str, list[Entry]] = field(default_factory=dict)
    written: dict[str, str] = field(default_factory=dict)
    """the names as the file has them; without those that are internal to the program that wrote it
    """

    def add(self, name: str, entries: list[Entry], internal: bool = False) -> None:
        self.entries.setdefault(name.upper(), []).extend(entries)
        if not internal:
            self.written.setdefault(name.upper(), name)

    def copy(self) -> "Sets":
        return Sets({name: [*entries] for name, entries in self.entries.items()}, {**self.written})


@dataclass
class Part:
    """The contents of *PART, or of the file outside all parts.

    elements: type of cell, numbers (n,) and numbers of the nodes (n, k), in meshio's order.
    """

    numbers: list[int] = field(default_factory=list)
    points: list[list[float]] = field(default_factory=list)
    elements: list[tuple[str, IntArray, IntArray]] = field(default_factory=list)
    nsets: Sets = field(default_factory=Sets)
    elsets: Sets = field(default_factory=Sets)
    surfaces: list[Keyword] = field(default_factory=list)

    def copy(self) -> "Part":
        """A copy that can be extended."""
        lists = [*self.numbers], [*self.points], [*self.elements]
        return Part(*lists, self.nsets.copy(), self.elsets.copy(), [*self.surfaces])


@dataclass(frozen=True)
class Instance:
    """A part, moved and turned: x = a + R (X + t - a)."""

    name: str
    part: Part
    translation: Array
    axis_point: Array
    rotation: Array

    @property
    def points(self) -> Array:
        points = np.array(self.part.points).reshape(-1, 3) + self.translation - self.axis_point
        return np.asarray(self.axis_point + points @ self.rotation.T)


def read_instances(path: Path, lost: list[str], deck: Deck) -> dict[str, Instance]:
    """The instances by name in upper case; the nameless one has the contents outside parts.

    What the file has and a mesh does not is put into words and added to `lost`, and to the deck.
    """
    assembly = part = Part()
    parts: dict[str, Part] = {}
    instances = {"": Instance("", assembly, np.zeros(3), np.zeros(3), np.eye(3))}
    left_out: Counter[str] = Counter()
    for keyword in keywords(path):
        match keyword.name:
            case "PART":
                part = parts[keyword["NAME"].upper()] = Part()
            case "INSTANCE":
                if keyword["PART"].upper() not in parts:
                    raise MeshError(
                        f"{keyword.location}: no part {keyword['PART']!r} before this instance of "
                        "it"
                    )
                # Instances may add sets and nodes to a part, which the next instance must not see.
                part = parts[keyword["PART"].upper()].copy()
                instances[keyword["NAME"].upper()] = _instance(part, keyword)
            case "END PART" | "END INSTANCE":
                part = assembly
            case "NODE":
                _add_nodes(part, keyword)
            case "ELEMENT":
                kind = keyword["TYPE"].upper()
                if (added := _add_elements(part, keyword)) is None:
                    left_out[f"elements of type {kind}"] += len(keyword.data)
                elif _STRUCTURAL.fullmatch(kind):
                    deck.structural[kind] += added
                elif found := _NO_SHELLS.match(kind):
                    deck.no_shells[f"{kind} ({_FLAT[found[1]]})"] += added
            case "MATERIAL":
                deck.materials.append(keyword.get("NAME"))
            case "NSET":
                part.nsets.add(keyword["NSET"], _entries(keyword), "INTERNAL" in keyword.parameters)
            case "ELSET":
                part.elsets.add(
                    keyword["ELSET"], _entries(keyword), "INTERNAL" in keyword.parameters
                )
            case "SURFACE":
                part.surfaces.append(keyword)
            case name if name in _GENERATED:
                raise MeshError(
                    f"{keyword.location}: *{name} is not supported; "
                    "expected a mesh that is written out"
                )
            case name if name in _CONNECTIONS:
                left_out[f"*{name}"] += 1
    lost.extend(f"{name} ({count})" for name, count in left_out.items())
    return instances


def _instance(part: Part, keyword: Keyword) -> Instance:
    """An instance from a translation, and from two points of an axis with an angle [deg].

    Each stands in a data line.
    """
    translation, axis = np.zeros(3), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    for values, items in zip((translation, axis), keyword.data, strict=False):
        numbers = keyword.floats(items)
        if len(numbers) > len(values):
            raise MeshError(
                f"{keyword.location}: *INSTANCE: expected {len(values)} numbers, found "
                f"{len(numbers)}"
            )
        values[: len(numbers)] = numbers
    along = axis[3:6] - axis[:3]
    if not along.any():
        raise MeshError(f"{keyword.location}: *INSTANCE: the two points of its axis are the same")
    turn = Rotation.from_rotvec(np.deg2rad(axis[6]) * along / np.linalg.norm(along))
    return Instance(keyword["NAME"], part, translation, axis[:3], turn.as_matrix())


def _add_nodes(part: Part, keyword: Keyword) -> None:
    if keyword.get("SYSTEM").upper() not in ("", "R") or keyword.get("INPUT"):
        raise MeshError(
            f"{keyword.location}: *NODE: expected nodes in rectangular coordinates below it"
        )
    numbers = keyword.ints([line[0] for line in keyword.data])
    part.numbers += numbers
    part.points += [keyword.floats([*line[1:4], "", "", ""][:3]) for line in keyword.data]
    if keyword.get("NSET"):
        part.nsets.add(keyword["NSET"], [Entry(np.array(numbers, dtype=np.int64))])


def _add_elements(part: Part, keyword: Keyword) -> int | None:
    """Add the elements of a keyword, and give their number; None if their type makes no cells."""
    if keyword.get("INPUT"):
        raise MeshError(f"{keyword.location}: *ELEMENT: expected elements below it")
    numbers = NO_NODES
    kinds = [
        kind
        for name, kind in _KINDS
        if re.fullmatch(rf"({name})([A-Z]\w*)?", keyword["TYPE"].upper())
    ]
    for kind in kinds:
        k = NODES_PER_CELL[kind]
        # Elements with many nodes go on in the next line; only their count says where they end.
        items = keyword.ints([item for line in keyword.data for item in line if item])
        if len(items) % (1 + k):
            raise MeshError(
                f"{keyword.location}: *ELEMENT: expected a number and {k} nodes for each "
                f"{keyword['TYPE']}, found {len(items)} numbers in all"
            )
        table = np.array(items, dtype=np.int64).reshape(-1, 1 + k)
        numbers, nodes = table[:, 0], table[:, 1:]
        part.elements.append((kind, numbers, nodes[:, _ORDER[kind]] if kind in _ORDER else nodes))
    if keyword.get("ELSET"):
        part.elsets.add(keyword["ELSET"], [Entry(numbers)])
    return len(numbers) if kinds else None


def _entries(keyword: Keyword) -> list[Entry]:
    """The entries of *NSET and *ELSET: numbers and names, or first, last and step with GENERATE."""
    instance = keyword.get("INSTANCE").upper()
    if "GENERATE" in keyword.parameters:
        ranges = [(*keyword.ints(line), 1)[:3] for line in keyword.data]
        if any(len(limits) != 3 or limits[2] < 1 for limits in ranges):
            raise MeshError(
                f"{keyword.location}: GENERATE: expected first, last and a positive step in each "
                "line"
            )
        return [Entry(range(first, last + 1, step), instance) for first, last, step in ranges]
    items = [item for line in keyword.data for item in line if item]
    numbers = keyword.ints([item for item in items if item.isdigit()])
    names = [Entry(item.strip('"'), instance) for item in items if not item.isdigit()]
    return [Entry(np.array(numbers, dtype=np.int64), instance), *names]
