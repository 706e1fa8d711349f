"""Sources of a body: a mesh of lines, a mesh of solids, or matrices of another program."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
import scipy.sparse as sp

from ...cad import CadGeometry
from ...superelement.validation import Array
from ..body.loads import LoadPattern
from ..body.selection import Selection, SurfaceSelection
from ..body.sensors import SensorPoint
from ..elements.inertia import Moved
from ..mesh.facets import Facets, Patch
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import Nodes, spider
from .interfaces import Attachment

ALL_POINTS = slice(None)


@dataclass(frozen=True, eq=False)
class FieldPoints:
    """Points of a body at which displacements, and perhaps stresses, can be recovered.

    nodes (p,): the node of each point; cells (n, k): lines or facets as rows of points, -1 filling
    short ones. strains (6 p, 3 n) sparse: strains at the points from displacements of the n nodes
    of the source; C (materials, 6, 6) [Pa] and owners (p,): the elasticity of the material of each
    point. Without strains, displacements alone. labels (p,): the numbers of the nodes in the mesh
    file, None where it gives none.
    """

    nodes: IntArray
    cells: IntArray
    strains: Any | None = None
    C: Array | None = None
    owners: IntArray | None = None
    labels: IntArray | None = None

    def places(self, nodes: Nodes) -> Array:
        """Where the points (p, 3) are [m]."""
        return nodes.points[self.nodes]

    def displacement_rows(self, T: Any, part: slice = ALL_POINTS, turns: Any = None) -> Any:
        """Three dofs (3 k, n_u), sparse, of the nodes of points, which are T (3 n, n_u).

        turns (3 n, n_u): the rotations of nodes, of bodies whose nodes all have some.
        """
        return T[(3 * self.nodes[part, None] + np.arange(3)).ravel()]

    def stress_rows(self, T: Any, part: slice = ALL_POINTS, turns: Any = None) -> Any:
        """C strain (6 k, n_u), sparse, at points from displacements T (3 n, n_u) of the nodes.

        Order: `STRESSES`. No rows without strains.
        """
        if self.strains is None or self.C is None or self.owners is None:
            return T[:0]
        C = self.C[self.owners[part]]
        begin, end, _ = part.indices(len(self.nodes))
        blocks = sp.bsr_array((C, np.arange(len(C)), np.arange(len(C) + 1)))
        return (blocks @ (self.strains[6 * begin : 6 * end] @ T)).tocsr()


@dataclass(frozen=True, eq=False)
class FacePoints(FieldPoints):
    """Points on the faces of shells, on arms (p, 3) [m] from nodes that turn.

    Stresses at the points are by_displacements u + by_rotations w of the n nodes, each (6 p, 3 n),
    sparse; None of displacements alone.
    """

    arms: Array = field(default_factory=lambda: np.zeros((0, 3)))
    by_displacements: Any | None = None
    by_rotations: Any | None = None

    def places(self, nodes: Nodes) -> Array:
        return nodes.points[self.nodes] + self.arms

    def displacement_rows(self, T: Any, part: slice = ALL_POINTS, turns: Any = None) -> Any:
        """u + w x arm (3 k, n_u), sparse."""
        rows = (3 * self.nodes[part, None] + np.arange(3)).ravel()
        n = len(self.nodes[part])
        # -arm~, one block for each point.
        crossed = spider(self.arms[part])[:, :, 3:]
        arms = sp.bsr_array((crossed, np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n))
        return (T[rows] + arms @ turns[rows]).tocsr()

    def stress_rows(self, T: Any, part: slice = ALL_POINTS, turns: Any = None) -> Any:
        """Stresses (6 k, n_u), sparse; no rows without stresses."""
        if self.by_displacements is None or self.by_rotations is None:
            return T[:0]
        begin, end, _ = part.indices(len(self.nodes))
        rows = slice(6 * begin, 6 * end)
        return (self.by_displacements[rows] @ T + self.by_rotations[rows] @ turns).tocsr()


@dataclass(frozen=True)
class Share:
    """The elements of one material, section or laminate: number, extent, and mass [kg].

    extent: volume [m^3], area [m^2] of shells, or length [m] of lines, in its `unit`.

    group: that of the mesh; empty for the one of a whole body.
    """

    group: str
    elements: int
    extent: float
    unit: str
    mass: float


@dataclass(frozen=True)
class Resolution:
    """The shortest wave [m] at the end of the band, and the largest spacing of the nodes [m].

    Of solids the wave is one of shear, c = sqrt(G / rho); of beams one of bending, c^2 = omega
    sqrt(EI / mass). needed: the nodes in a wavelength that carry it within about five per cent of
    its speed; wave: its kind, in words.
    """

    wavelength: float
    spacing: float
    needed: int
    wave: str

    @property
    def nodes(self) -> float:
        """Nodes in a wavelength."""
        return self.wavelength / self.spacing


class Tensors(Protocol):
    """The second order of the elements of a body, in motions of the dofs of its source."""

    strain_energy: ClassVar[bool]
    """whether its derivatives, `third` and `quartic`, are known"""

    def inertia_loads(self) -> Array:
        """F (n_u, 6): the first order change of the inertia is F^T u."""
        ...

    def inertia(self, motions: Array) -> Array:
        """Q (6, r, r): the second derivative of the inertia by motions (n_u, r)."""
        ...

    def gyroscopic(self, motions: Array) -> Array:
        """h (3, r, r): the angular momentum h(q, q') of motions (n_u, r)."""
        ...

    def third(self, u: Array, motions: Array) -> Array:
        """D3(u; psi_k, psi_l) (k, r, r), the third derivative of the strain energy."""
        ...

    def quartic(self, motions: Array, moved: Moved | None) -> tuple[Array, Array]:
        """The energy of second order strains (pairs, pairs), and the loads of their stresses (n_u,
        pairs).
        """
        ...


class Source(Protocol):
    """A finite element model free in space, without interfaces and masses."""

    @property
    def name(self) -> str:
        """The file of the nodes, for messages."""
        ...

    @property
    def nodes(self) -> Nodes:
        """The nodes and their dofs."""
        ...

    @property
    def geometry(self) -> CadGeometry | None:
        """What the mesh was made of, of a CAD file."""
        ...

    def matrices(self) -> tuple[Any, Any]:
        """K [N/m ...] and M [kg ...] (n_u, n_u), sparse and symmetric to the last bit.

        `PreprocessError` unless they are those of one free elastic body.
        """
        ...

    def tensors(self, M: Any, center: Array) -> Tensors:
        """The second order of the elements with the mass M of `matrices`, about a center.

        `BodyError` where there are none.
        """
        ...

    def attachment(self, selection: Selection) -> Attachment:
        """The frame on the nodes or facets of a selection; `InterfaceError` if it picks none."""
        ...

    def touched(self, selection: SurfaceSelection) -> Patch:
        """The facets of the boundary in a selection, by type, outward; `InterfaceError` if none."""
        ...

    def forces(self, load: LoadPattern) -> Array:
        """Nodal forces and moments (n_u,) of a load pattern; `PreprocessError` if it picks none."""
        ...

    def readings(self, sensor: SensorPoint) -> tuple[Any, Array]:
        """Rows (k, n_u), sparse, that read a sensor, and its place (3,) [m]."""
        ...

    def check_fields(self, stress: bool) -> None:
        """`BodyError` if fields, or stresses, cannot be recovered."""
        ...

    def field_points(self, stress: bool) -> FieldPoints:
        """The points at which fields are recovered, with strains if `stress`."""
        ...


class MeshSource(Source, Protocol):
    """A source with elements, which can be surveyed and drawn."""

    @property
    def mesh(self) -> Mesh: ...

    @property
    def facets(self) -> Facets | None:
        """The facets of solids, the elements of shells, None of lines."""
        ...

    def shares(self) -> tuple[Share, ...]:
        """The elements of each material or section."""
        ...

    def resolution(self, frequency: float) -> Resolution:
        """The shortest wave at a frequency [Hz] beside the spacing of the nodes."""
        ...

    def bending_excess(self) -> float:
        """The energy of bent elements over that of pure bending; 1 of elements that hold it."""
        ...

    def stiff_in_volume(self) -> bool:
        """Whether a nearly incompressible material is in elements that are too stiff for it."""
        ...

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        """Polygons (m, k, 3) that turn outwards and their facets (m,), for each type of facet."""
        ...
