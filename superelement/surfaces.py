"""Surfaces: facets of a superelement that other bodies may touch, and how their nodes respond."""

from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array
from .cells import IntArray
from .validation import (
    SuperelementError,
    check_name,
    check_positive,
    check_symmetric,
    checked,
    checked_integers,
)

# Nodes and corners of each type of facet, by meshio's names: corners first, then middle nodes.
FACET_NODES = {"triangle": 3, "quad": 4, "triangle6": 6, "quad8": 8, "quad9": 9}
FACET_CORNERS = {"triangle": 3, "quad": 4, "triangle6": 3, "quad8": 4, "quad9": 4}
# Unit vectors may differ from 1 by the rounding of single precision, in files of other programs.
MAX_NORMAL_ERROR = 1e-6


@dataclass(frozen=True, eq=False)
class Surface:
    """A part of the boundary of a body that other bodies may touch.

    Parameters
    ----------
    name : str
        One line without '/' and '.'.
    nodes : (n,) of int
        The numbers of its nodes in the mesh.
    X : (n, 3) [m]
        Positions of the nodes from the center of mass, in body axes.
    facets : (n_f, k) of int
        Rows of numbers below n; their order is that of meshio, and turns outward.
    facet_type : str
        "triangle", "quad", "triangle6", "quad8" or "quad9", as meshio names it.
    normals : (n, 3)
        Unit normals at the nodes, outward: means of those of the facets of the surface around.
    area : float [m^2]

    Raises
    ------
    SuperelementError
        For arrays that do not fit each other; the message names the surface and the array.

    Examples
    --------
    >>> import numpy as np
    >>> X = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    >>> up = np.tile([0.0, 0.0, 1.0], (4, 1))
    >>> Surface("top", np.arange(4), X, np.array([[0, 1, 2, 3]]), "quad", up, area=1.0)
    <Surface 'top': 4 nodes, 1 quad, 1 m^2>
    """

    name: str
    nodes: IntArray
    X: Array
    facets: IntArray
    facet_type: str
    normals: Array
    area: float

    def __post_init__(self) -> None:
        check_name("surface", self.name)
        what = f"surface {self.name!r}"
        if self.facet_type not in FACET_NODES:
            raise SuperelementError(
                f"{what}: facet_type: expected one of {', '.join(FACET_NODES)}, "
                f"found {self.facet_type!r}"
            )
        X = checked(f"{what}: X", self.X, ("n", 3))
        n, k = len(X), FACET_NODES[self.facet_type]
        nodes = checked_integers(f"{what}: nodes", self.nodes, (n,))
        if len(np.unique(nodes)) != n:
            raise SuperelementError(f"{what}: nodes: expected each node once, found one twice")
        facets = checked_integers(f"{what}: facets", self.facets, (None, k))
        # A node without a facet has neither area nor normal.
        used = np.unique(facets)
        if not np.array_equal(used, np.arange(n)):
            raise SuperelementError(
                f"{what}: facets: expected all of the numbers 0 to {n - 1} and no others, found "
                f"{len(used)} from {used.min(initial=0)} to {used.max(initial=0)}"
            )
        normals = checked(f"{what}: normals", self.normals, (n, 3))
        error = np.abs(np.linalg.norm(normals, axis=1) - 1.0).max(initial=0.0)
        if error > MAX_NORMAL_ERROR:
            raise SuperelementError(
                f"{what}: normals: expected unit vectors, found one whose length differs by "
                f"{error:.3g}"
            )
        check_positive(f"{what}: area", self.area)
        for key, array in (("nodes", nodes), ("X", X), ("facets", facets), ("normals", normals)):
            object.__setattr__(self, key, array)

    def __repr__(self) -> str:
        count = f"{len(self.facets)} {self.facet_type}"
        return f"<Surface {self.name!r}: {self.n} nodes, {count}, {self.area:.4g} m^2>"

    @property
    def n(self) -> int:
        """The number of nodes."""
        return len(self.X)

    @property
    def corners(self) -> IntArray:
        """The corners of the facets (n_f, 3 or 4)."""
        return self.facets[:, : FACET_CORNERS[self.facet_type]]

    @property
    def corner_nodes(self) -> IntArray:
        """The nodes that are corners, each once, ascending: all of them of linear facets."""
        return np.unique(self.corners)


@dataclass(frozen=True, eq=False)
class Surfaces:
    """The responses of all nodes of all surfaces of a body.

    The rows are surface by surface, node by node, and x, y, z in body axes.

        u = phi eta + F p,      eta_i'' + 2 zeta_i omega_i eta_i' + omega_i^2 eta_i = phi_i . p
        F = H - phi diag(1 / omega^2) phi^T

    Source: R. H. MacNeal, Computers & Structures 1 (1971) 581-601.

    Parameters
    ----------
    patches : tuple of Surface
    phi : (3 n, m) [1/sqrt(kg)]
        The modes of the superelement at the nodes.
    H : (3 n, 3 n) [m/N]
        Inertia-relieved static compliance P_C P K^+ P^T P_C^T.

    Raises
    ------
    SuperelementError
        For equal names, and matrices of wrong shape or without symmetry.

    Examples
    --------
    >>> import numpy as np
    >>> X = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    >>> up = np.tile([0.0, 0.0, 1.0], (3, 1))
    >>> top = Surface("top", np.arange(3), X, np.array([[0, 1, 2]]), "triangle", up, area=0.5)
    >>> surfaces = Surfaces((top,), phi=np.ones((9, 1)), H=2.0 * np.eye(9) + 1.0)
    >>> surfaces.rows("top"), surfaces.F(omega=np.array([1.0]))[0, :2].tolist()
    (slice(0, 9, None), [2.0, 0.0])
    """

    patches: tuple[Surface, ...]
    phi: Array
    H: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "patches", tuple(self.patches))
        names = [patch.name for patch in self.patches]
        if not names or len(set(names)) != len(names):
            raise SuperelementError(f"surfaces: expected different names, found {names}")
        rows = 3 * self.n
        H = checked("surfaces: H", self.H, (rows, rows))
        check_symmetric("surfaces: H", H)
        object.__setattr__(self, "phi", checked("surfaces: phi", self.phi, (rows, "m")))
        object.__setattr__(self, "H", H)

    @property
    def n(self) -> int:
        """The number of nodes of all surfaces."""
        return sum(patch.n for patch in self.patches)

    def surface(self, name: str) -> Surface:
        """The surface of a name; `SuperelementError` lists the names where there is none."""
        return self.patches[self._index(name)]

    def rows(self, name: str) -> slice:
        """The rows of a surface in phi, H and F."""
        index = self._index(name)
        first = 3 * sum(patch.n for patch in self.patches[:index])
        return slice(first, first + 3 * self.patches[index].n)

    def F(self, omega: Array, highest: float = np.inf) -> Array:
        """H - phi diag(1 / omega^2) phi^T (3 n, 3 n) [m/N] with the modes omega (m,) up to highest.

        The flexibility that is left once these modes are dynamic. Positive semidefinite.
        """
        chosen = omega <= highest
        phi = self.phi[:, chosen] / omega[chosen]
        rest: Array = self.H - phi @ phi.T
        return rest

    @property
    def distinct(self) -> IntArray:
        """The rows of each node of the mesh once: surfaces that meet share nodes."""
        nodes = np.concatenate([patch.nodes for patch in self.patches])
        _, first = np.unique(nodes, return_index=True)
        return np.asarray((3 * np.sort(first)[:, None] + np.arange(3)).ravel())

    def _index(self, name: str) -> int:
        names = [patch.name for patch in self.patches]
        if name not in names:
            raise SuperelementError(f"no surface {name!r}; there are: {', '.join(names)}")
        return names.index(name)
