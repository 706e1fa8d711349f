"""What a body file makes of its mesh, before any impulse response is computed."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..superelement.validation import Array
from .assembly.interfaces import Attachment, attachments
from .assembly.masses import placed_masses
from .assembly.structure import Structure, assemble_mesh, read_source
from .body.body import Body
from .body.material import Material, Section
from .elements.element import ELEMENTS, cofactors
from .errors import BodyError
from .estimate import Frequencies, first_frequencies
from .mesh.cells import FACETS, LINES
from .mesh.facets import Facets, facets_of
from .mesh.mesh import IntArray, Mesh
from .mesh.nodes import Nodes
from .progress import shown_stages
from .responses.cost import Cost, krylov_cost
from .responses.impulse import SMALL

SHOWN = 10
"""Frequencies that a survey looks for."""
BATCH = 2**14
"""Elements whose volumes are integrated at once."""
LINEAR, QUADRATIC = 6, 4
"""Nodes in a wavelength: waves run too fast by (k h)^2 / 24, 5 per cent, and by sqrt(10) / pi - 1,
1 per cent.
"""


@dataclass(frozen=True)
class Share:
    """What is made of one material or section: elements, their volume [m^3] or length [m], their
    mass [kg].

    group: that of the mesh; empty for what all of the body is made of.
    """

    group: str
    elements: int
    extent: float
    mass: float


@dataclass(frozen=True)
class Resolution:
    """The shortest wave [m] that the material carries at the end of the band, and the longest way
    between nodes [m].

    Of solids the wave is one of shear, c = sqrt(G / rho); of beams one of bending, c^2 = omega
    sqrt(EI / mass). needed: the nodes in a wavelength that carry it within about five per cent of
    its speed.
    """

    wavelength: float
    spacing: float
    needed: int

    @property
    def nodes(self) -> float:
        """Nodes in a wavelength."""
        return self.wavelength / self.spacing


@dataclass(frozen=True, eq=False)
class Survey:
    """A body on its mesh: matrices, places by the names of interfaces and of masses, and what to
    expect of it.

    facets: those of solids, None of beams; band [Hz]: up to where impulse responses are asked to be
    right. cost: what to expect, of bodies that take a while. A mass on an interface has the place
    of the interface.
    """

    body: Body
    mesh: Mesh
    structure: Structure
    facets: Facets | None
    interfaces: Mapping[str, Attachment]
    masses: Mapping[str, Attachment]
    shares: tuple[Share, ...]
    frequencies: Frequencies
    resolution: Resolution
    band: float
    cost: Cost | None

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        """By type of facet: polygons (m, k, 3) that turn outwards, and the interface (m,) of each,
        -1 for none.
        """
        if self.facets is None:
            return
        owner = np.full(self.facets.count, -1, dtype=np.int64)
        for number, place in enumerate(self.interfaces.values()):
            owner[place.facets] = number
        first = 0
        for kind, nodes in self.facets.nodes.items():
            rows = np.flatnonzero(self.facets.boundary[first:][: len(nodes)])
            yield (
                self.mesh.points[nodes[rows][:, _around(kind, nodes.shape[1])]],
                owner[first + rows],
            )
            first += len(nodes)


def _around(kind: str, n_nodes: int) -> list[int]:
    """The nodes on the rim of a facet, one after the other: corners, with the middles between them
    if there are any.
    """
    corners = FACETS[kind].corners
    middles = [] if n_nodes == corners else [range(corners, 2 * corners)]
    return [node for group in zip(range(corners), *middles, strict=True) for node in group]


def survey(body: Body, progress: bool = False) -> Survey:
    """Read, select and assemble, without factorizing what is large; errors are those of `build`.

    `progress` shows on the terminal what is being done.
    """
    with shown_stages(progress) as stages:
        with stages.stage("mesh"):
            mesh = read_source(body)
            if not isinstance(mesh, Mesh):
                raise BodyError("a dry run draws what was selected on a mesh, found [matrices]")
        with stages.stage("assembly"):
            structure = assemble_mesh(body, mesh)
        with stages.stage("selection"):
            beams = mesh.body_types == LINES
            facets = None if beams else facets_of(mesh)
            nodes = Nodes(mesh.points, np.full(len(mesh.points), beams))
            interfaces = attachments("interfaces", body.interfaces, mesh, nodes, facets)
            placed = attachments("masses", placed_masses(body), mesh, nodes, facets)
        with stages.stage("frequencies"):
            frequencies = first_frequencies(structure, SHOWN)
    masses = {
        name: placed[name] if m.interface is None else interfaces[m.interface]
        for name, m in body.masses.items()
    }
    band = body.impulse.band or 0.25 / body.impulse.step
    return Survey(
        body=body,
        mesh=mesh,
        structure=structure,
        facets=facets,
        interfaces=interfaces,
        masses=masses,
        shares=_shares(body, mesh),
        frequencies=frequencies,
        resolution=_resolution(body, mesh, facets, band),
        band=band,
        cost=_cost(body, structure),
    )


def _cost(body: Body, structure: Structure) -> Cost | None:
    """What the method for large bodies will take; nothing worth telling for small ones and for
    other methods.
    """
    if body.impulse.method not in ("auto", "krylov") or structure.n_u <= SMALL:
        return None
    return krylov_cost(structure.n_u, structure.K.nnz, structure.P_C.shape[0], body.impulse.steps)


def _makes(body: Body) -> Mapping[str, Material | Section]:
    """Materials or sections by the groups of the mesh that are made of them."""
    one = body.material or body.section
    return body.materials or body.sections if one is None else {"": one}


def _shares(body: Body, mesh: Mesh) -> tuple[Share, ...]:
    extents = np.concatenate([_extents(mesh, kind) for kind in mesh.body_types])
    shares = []
    for group, make in _makes(body).items():
        own = extents[mesh.members(group)] if group else extents
        density = make.mass_per_length if isinstance(make, Section) else make.rho
        shares.append(Share(group, len(own), float(own.sum()), float(density * own.sum())))
    return tuple(shares)


def _extents(mesh: Mesh, kind: str) -> Array:
    """The length (n,) [m] or the volume (n,) [m^3] of every element of a type."""
    points, cells = mesh.points, mesh.cells[kind]
    if kind in LINES:
        return np.asarray(np.linalg.norm(points[cells[:, 1]] - points[cells[:, 0]], axis=1))
    element = ELEMENTS[kind]
    dN = element.dN(element.xi)
    batches = (cells[start : start + BATCH] for start in range(0, len(cells), BATCH))
    return np.concatenate([cofactors(dN, points[batch])[1] @ element.weights for batch in batches])


def _resolution(body: Body, mesh: Mesh, facets: Facets | None, band: float) -> Resolution:
    wavelength = min(_wavelength(make, band) for make in _makes(body).values())
    if facets is None:
        return Resolution(wavelength, float(_extents(mesh, "line").max()), QUADRATIC)
    spacing, quadratic = 0.0, False
    for kind, nodes in facets.nodes.items():
        corners = mesh.points[nodes[:, : FACETS[kind].corners]]
        edge = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
        quadratic = nodes.shape[1] > FACETS[kind].corners
        spacing = max(spacing, edge / 2 if quadratic else edge)
    return Resolution(wavelength, spacing, QUADRATIC if quadratic else LINEAR)


def _wavelength(make: Material | Section, frequency: float) -> float:
    """The shortest wave [m] of a material or a section at a frequency [Hz]."""
    if isinstance(make, Section):
        omega = 2.0 * np.pi * frequency
        return float(
            2.0 * np.pi * (min(make.EI_y, make.EI_z) / (make.mass_per_length * omega**2)) ** 0.25
        )
    shear = make.elasticity.diagonal()[3:].min()
    return float(np.sqrt(shear / make.rho) / frequency)
