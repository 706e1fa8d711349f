"""The types of cells that meshes have, by meshio's names: one record for each solid and facet.

A new solid needs one record in `SOLID_TYPES`, and one in `FACET_TYPES` if its faces are of a new
type; all else follows: what meshes may hold, faces and neighbors, stiffness and mass, strains.
Formats that do not know the name yet need it in their own table, of names alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from meshio._common import num_nodes_per_cell

NODES_PER_CELL: dict[str, int] = num_nodes_per_cell
"""The number of nodes of every type of cell: the one table that all readers of formats share."""
LINE_CELLS = ("line",)  # that make a body of beams


@dataclass(frozen=True)
class FacetType:
    """A face of solids: its number of corners and the shape functions of scikit-fem, by their name.

    Nodes are in meshio's order, which is that of scikit-fem: corners, then the middles of the sides
    between them, then the middle.
    """

    corners: int
    shapes: str


@dataclass(frozen=True, eq=False)
class SolidType:
    """An isoparametric solid, its nodes in meshio's order.

    facets: by type, the nodes of every face, which turns outwards; shapes: the element of
    scikit-fem by its name; order (k,): the shape function of each node; integration: the degree of
    polynomials that stiffness and mass integrate exactly, and sampling: that of the points of one
    order less at which strains are sampled for recovery. terms: how many of 1, xi, eta, zeta the
    dilatation of an element has where that is projected; modes: the incompatible modes that go
    with it, by their name in elements.assumed. Both are used where the material is nearly
    incompressible, and always for a type that `locks`: whose nodes alone are too stiff in bending.
    """

    facets: dict[str, list[list[int]]]
    shapes: str
    order: Sequence[int]
    integration: int
    sampling: int
    terms: int = 0
    modes: str | None = None
    locks: bool = False


FACET_TYPES = {
    "triangle": FacetType(3, "ElementTriP1"),
    "triangle6": FacetType(3, "ElementTriP2"),
    "quad": FacetType(4, "ElementQuad1"),
    "quad8": FacetType(4, "ElementQuadS2"),
    "quad9": FacetType(4, "ElementQuad2"),
}
FACET_FAMILIES = ({"triangle", "quad"}, {"triangle6", "quad8"}, {"triangle6", "quad9"})
"""Facets that may bound one body: those with the same nodes on their sides."""

_HEXAHEDRON = [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]
_MIDDLES = [
    [16, 15, 19, 11],
    [9, 18, 13, 17],
    [8, 17, 12, 16],
    [19, 14, 18, 10],
    [11, 10, 9, 8],
    [12, 13, 14, 15],
]
_HEXAHEDRON20 = [corners + middles for corners, middles in zip(_HEXAHEDRON, _MIDDLES, strict=True)]
_HEXAHEDRON27 = [[*facet, 20 + i] for i, facet in enumerate(_HEXAHEDRON20)]

# scikit-fem numbers the nodes of a hexahedron from (1, 1, 1); this is a turn, not a reflection, of
# meshio's numbering.
_CORNERS = [1, 5, 7, 4, 0, 3, 6, 2]
_EDGES = [12, 18, 17, 11, 10, 16, 14, 9, 8, 15, 19, 13]
_FACES = [20, 25, 22, 23, 24, 21, 26]

# All weights of integration are positive. Stiffness and mass are exact on straight-sided simplices
# and wedges and on parallelepipeds.
SOLID_TYPES = {
    "tetra": SolidType(
        facets={"triangle": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]},
        shapes="ElementTetP1",
        order=range(4),
        integration=2,
        sampling=1,
    ),
    "tetra10": SolidType(
        facets={
            "triangle6": [
                [0, 2, 1, 6, 5, 4],
                [0, 1, 3, 4, 8, 7],
                [1, 2, 3, 5, 9, 8],
                [2, 0, 3, 6, 7, 9],
            ]
        },
        shapes="ElementTetP2",
        order=range(10),
        integration=5,
        sampling=2,
        terms=4,
        modes="tetrahedron",
    ),
    "hexahedron": SolidType(
        {"quad": _HEXAHEDRON}, "ElementHex1", _CORNERS, 5, 3, 4, "hexahedron", locks=True
    ),
    "hexahedron20": SolidType(
        {"quad8": _HEXAHEDRON20}, "ElementHexS2", [*_CORNERS, *_EDGES], 5, 3, 4
    ),
    "hexahedron27": SolidType(
        {"quad9": _HEXAHEDRON27}, "ElementHex2", [*_CORNERS, *_EDGES, *_FACES], 5, 3, 4
    ),
    "wedge": SolidType(
        facets={
            "triangle": [[0, 2, 1], [3, 4, 5]],
            "quad": [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
        },
        shapes="ElementWedge1",
        order=range(6),
        integration=4,
        sampling=2,
        terms=4,
        modes="wedge",
        locks=True,
    ),
}

SHELL_CELLS = ("triangle", "quad")
"""Facets that are shells where the mesh has no solids; those of second order are divided."""

CELL_DIMENSIONS = {"vertex": 0, "line": 1, "line3": 1, **dict.fromkeys(FACET_TYPES, 2)}
"""Cells that may bound or mark a body without being one, and their dimension."""
