"""XDMF (.xdmf, .xmf), versions 2 and 3; numbers in the file, in HDF5 or in binary files.

Groups are sets of nodes and cells, those of arrays of integers (see `arrays`), and the grids by
their names if there are several, as of dolfinx: its mesh tags are a grid on the points of the mesh,
with an array of the tags. Source: XDMF Model and Format, xdmf.org.
"""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ....superelement.validation import Array
from ...errors import MeshError
from ..cells import NODES_PER_CELL
from ..mesh import NO_NODES, IntArray
from .arrays import mark_values
from .draft import Draft, Sequence
from .xdmf_items import DataItems

# Types of cells and their numbers in mixed topologies; nodes are in meshio's order.
_KINDS = {
    "polyvertex": ("vertex", 1),
    "polyline": ("line", 2),
    "triangle": ("triangle", 4),
    "quadrilateral": ("quad", 5),
    "tetrahedron": ("tetra", 6),
    "pyramid": ("pyramid", 7),
    "wedge": ("wedge", 8),
    "hexahedron": ("hexahedron", 9),
    "edge_3": ("line3", 34),
    "quadrilateral_9": ("quad9", 35),
    "triangle_6": ("triangle6", 36),
    "quadrilateral_8": ("quad8", 37),
    "tetrahedron_10": ("tetra10", 38),
    "pyramid_13": ("pyramid13", 39),
    "wedge_15": ("wedge15", 40),
    "hexahedron_20": ("hexahedron20", 48),
    "hexahedron_27": ("hexahedron27", 50),
}
MAX_GRID_DEPTH = 20
_SHORT = {"quad": "quadrilateral", "tri": "triangle", "tet": "tetrahedron", "hex": "hexahedron"}
_BY_NUMBER = {number: kind for kind, number in _KINDS.values()}


def read(path: Path) -> Draft:
    """A mesh of XDMF; `MeshError` if the file or one beside it is damaged."""
    root = _root(path)
    lost: list[str] = []
    grids = _grids(root, lost)
    items = DataItems(path, root)
    geometries = [geometry for grid in grids if (geometry := grid.find("Geometry")) is not None]
    points = [_points(geometry, items) for geometry in geometries]
    if not points:
        raise MeshError("expected a Grid with a Geometry, found none")
    draft = Draft(np.concatenate(points), lost)

    rows_of = np.split(np.arange(len(draft.points)), np.cumsum([len(part) for part in points])[:-1])
    sequence, elements_of_first = Sequence(draft), NO_NODES
    for grid in grids:
        # A grid without points or cells of its own is on those of the first one, which it includes
        # by reference.
        geometry, topology = grid.find("Geometry"), grid.find("Topology")
        rows = rows_of[0 if geometry is None else geometries.index(geometry)]
        if topology is None:
            elements = elements_of_first
        else:
            elements = _add_cells(sequence, topology, items, rows)
            elements_of_first = elements_of_first if len(elements_of_first) else elements
        if len(grids) > 1:
            sequence.mark(grid.get("Name", "grid"), elements)
        _add_groups(draft, grid, items, rows, sequence, elements)
    return draft


def files_of(path: Path) -> list[Path]:
    """The file and those beside it that hold its numbers."""
    return [path, *DataItems(path, _root(path)).files()]


def _root(path: Path) -> ElementTree.Element:
    try:
        return ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, ValueError) as error:
        raise MeshError(f"the file is no XML, or breaks off: {error}") from error


def _grids(
    parent: ElementTree.Element, lost: list[str], depth: int = 1
) -> list[ElementTree.Element]:
    """The uniform grids below an element, of those in time only the first."""
    if depth > MAX_GRID_DEPTH:
        raise MeshError(f"expected at most {MAX_GRID_DEPTH} grids within one another, found more")
    grids = []
    for grid in [*parent.findall("Domain/Grid"), *parent.findall("Grid")]:
        if grid.get("GridType", "Uniform") == "Uniform":
            grids.append(grid)
            continue
        inner = _grids(grid, lost, depth + 1)
        if grid.get("CollectionType") == "Temporal" and len(inner) > 1:
            lost.append(f"{len(inner) - 1} later times of the grid {grid.get('Name')!r}")
            inner = inner[:1]
        grids.extend(inner)
    return grids


def _points(geometry: ElementTree.Element, items: DataItems) -> Array:
    kind = (geometry.get("GeometryType") or geometry.get("Type") or "XYZ").upper()
    if kind not in ("XYZ", "XY"):
        raise MeshError(f"expected a Geometry of type XYZ or XY, found {kind}")
    values = items.values(geometry).reshape(-1)
    if values.size % len(kind):
        raise MeshError(
            f"Geometry {kind}: expected coordinates of points, found {values.size} numbers"
        )
    points = np.zeros((values.size // len(kind), 3))
    points[:, : len(kind)] = values.reshape(-1, len(kind))
    return points


def _add_cells(
    sequence: Sequence, topology: ElementTree.Element, items: DataItems, rows: IntArray
) -> IntArray:
    """Add cells of one type or of mixed ones; their rows in the sequence."""
    first = len(sequence)
    name, _, order = (
        (topology.get("TopologyType") or topology.get("Type") or "").lower().partition("_")
    )
    name = _SHORT.get(name, name) + (f"_{order}" if order else "")
    values = items.integers(topology)
    if name == "mixed":
        blocks = _mixed(values.reshape(-1).tolist())
    elif name in _KINDS:
        kind, _ = _KINDS[name]
        k = NODES_PER_CELL[kind]
        if values.size % k:
            raise MeshError(
                f"Topology {name}: expected {k} nodes for each cell, found {values.size} numbers"
            )
        blocks = [(kind, values.reshape(-1, k))]
    else:
        raise MeshError(f"unsupported Topology of type {name!r}")
    for kind, nodes in blocks:
        if not ((nodes >= 0) & (nodes < len(rows))).all():
            raise MeshError(
                f"Topology: expected nodes 0 to {len(rows) - 1}, "
                f"found {nodes.min()} to {nodes.max()}"
            )
        sequence.add(kind, rows[nodes])
    return np.arange(first, len(sequence))


def _mixed(values: list[int]) -> list[tuple[str, IntArray]]:
    """Runs of cells of one type, from type and nodes of each cell; points and lines also have a
    count.
    """
    runs: list[tuple[str, list[list[int]]]] = []
    position = 0
    while position < len(values):
        number = values[position]
        if number not in _BY_NUMBER:
            raise MeshError(f"Topology: unsupported cells of XDMF's type {number}")
        kind = _BY_NUMBER[number]
        k = NODES_PER_CELL[kind]
        position += 1
        if kind in ("vertex", "line"):
            if values[position : position + 1] != [k]:
                raise MeshError(
                    f"Topology: expected {k} nodes of each {kind}, "
                    f"found {values[position : position + 1]}"
                )
            position += 1
        if position + k > len(values):
            raise MeshError("Topology: the last cell breaks off")
        if not runs or runs[-1][0] != kind:
            runs.append((kind, []))
        runs[-1][1].append(values[position : position + k])
        position += k
    return [(kind, np.array(cells, dtype=np.int64)) for kind, cells in runs]


def _add_groups(
    draft: Draft,
    grid: ElementTree.Element,
    items: DataItems,
    rows: IntArray,
    sequence: Sequence,
    elements: IntArray,
) -> None:
    """Groups from the arrays and sets of a grid on the points `rows` and the elements."""

    def mark_points(name: str, numbers: IntArray) -> None:
        draft.mark_points(name, rows[numbers])

    def mark_cells(name: str, numbers: IntArray) -> None:
        sequence.mark(name, elements[numbers])

    supports = {"node": (rows, mark_points), "cell": (elements, mark_cells)}
    for array in grid.findall("Attribute"):
        name, center = array.get("Name", "attribute"), array.get("Center", "Node").lower()
        if center in supports:
            support, mark = supports[center]
            values = items.values(array)
            if values.dtype.kind in "iu" and len(values) != len(support):
                raise MeshError(
                    f"Attribute {name}: expected {len(support)} values, found {len(values)}"
                )
            mark_values(draft, name, values, mark)
    for group in grid.findall("Set"):
        name, center = (
            group.get("Name", "set"),
            (group.get("SetType") or group.get("Type") or "").lower(),
        )
        if center not in supports:
            draft.lost.append(f"set {name!r} of type {center!r}")
            continue
        support, mark = supports[center]
        numbers = items.integers(group).reshape(-1)
        if not ((numbers >= 0) & (numbers < len(support))).all():
            raise MeshError(f"Set {name}: expected numbers 0 to {len(support) - 1}")
        mark(name, numbers)
