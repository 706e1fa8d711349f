"""The reading of a body file and its mesh, before any impulse response is computed."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..superelement import Surface
from ..superelement.validation import Array
from .assembly.interfaces import Attachment
from .assembly.source import MeshSource, Resolution, Share
from .assembly.structure import Structure, assemble_on
from .body.body import Body
from .body.loss import damping_of
from .estimate import Frequencies, first_frequencies
from .measured.update import read_test, with_test
from .mesh.facets import Facets
from .mesh.mesh import IntArray, Mesh
from .plausibility import (
    doubts_of_body,
    doubts_of_frequencies,
    doubts_of_mesh,
    doubts_on_mesh,
    refused_where_singular,
)
from .progress import shown_stages
from .responses.accuracy import solution_accuracy
from .responses.impulse import band_of
from .responses.modal import FULL_MODAL_UNKNOWNS
from .responses.shifts import shifts
from .solving.cost import Cost, krylov_cost, surface_cost
from .solving.solver import costs
from .sources.lines import LineSource
from .sources.reading import mesh_as_read, read_mesh_source, source_of

N_SURVEYED_FREQUENCIES = 10


@dataclass(frozen=True)
class BuildCost:
    """What a build costs with a factor, and without; solver: which it is to be."""

    factor: Cost
    iterative: Cost
    solver: Literal["factor", "iterative"]

    @property
    def other(self) -> Literal["factor", "iterative"]:
        """What is not the solver."""
        return "iterative" if self.solver == "factor" else "factor"


@dataclass(frozen=True)
class SurfaceCost:
    """What a build with surfaces takes: `columns` of compliance, about that many modes, and all.

    fields: values at all points of the recovery.
    """

    columns: int
    fields: int
    modes: float
    build: Cost

    @property
    def compliance_bytes(self) -> float:
        """The memory of the compliance of all nodes of surfaces."""
        return 8.0 * self.columns**2

    @property
    def field_bytes(self) -> float:
        """The memory of fields by forces on these nodes."""
        return 8.0 * self.fields * self.columns


@dataclass(frozen=True, eq=False)
class Survey:
    """A body on its mesh: matrices, shares of its materials or sections, and what to expect of it.

    doubts: what is unlike any part, a line each. band [Hz]: up to where impulse responses are asked
    to be right. cost: of bodies that take a while, None for others; surfaces: what these take, None
    without any.
    """

    body: Body
    source: MeshSource
    structure: Structure
    shares: tuple[Share, ...]
    frequencies: Frequencies
    resolution: Resolution
    doubts: tuple[str, ...]
    band: float
    cost: BuildCost | None
    surfaces: SurfaceCost | None
    measured: Array | None
    """frequencies of a modal test [Hz]"""

    @property
    def mesh(self) -> Mesh:
        return self.source.mesh

    @property
    def facets(self) -> Facets | None:
        """The facets of solids, the elements of shells, None of lines."""
        return self.source.facets

    @property
    def interfaces(self) -> Mapping[str, Attachment]:
        """The frames of the interfaces on the mesh, by name."""
        return self.structure.frames

    @property
    def masses(self) -> Mapping[str, Attachment]:
        """The frames of the masses on the mesh, by name."""
        return self.structure.masses

    def section_axes(self) -> tuple[Array, Array]:
        """Middles (n, 3) of lines and their local axes as rows (n, 3, 3); none of solids."""
        if isinstance(self.source, LineSource):
            return self.source.section_axes()
        return np.zeros((0, 3)), np.zeros((0, 3, 3))

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        """Polygons (m, k, 3) and the interface (m,) of each, -1 for none, by type of facet.

        Surfaces are counted on behind the interfaces. Polygons turn outwards.
        """
        frames = [frame.facets for frame in self.interfaces.values()]
        owned = [*frames, *map(self._numbers, self.touched)]
        for polygons, facets in self.source.boundary():
            owner = np.full(len(facets), -1, dtype=np.int64)
            for number, chosen in enumerate(owned):
                owner[np.isin(facets, chosen)] = number
            yield polygons, owner

    @property
    def touched(self) -> tuple[Surface, ...]:
        """The surfaces that other bodies may touch."""
        return () if self.structure.surfaces is None else self.structure.surfaces.surfaces

    def _numbers(self, patch: Surface) -> IntArray:
        assert self.facets is not None
        return self.facets.matching(patch.facet_type, patch.nodes[patch.facets])


def survey(body: Body, progress: bool = False) -> Survey:
    """Read, select and assemble, without factorizing what is large; errors are those of `build`.

    `progress` shows the stages on the terminal.
    """
    with refused_where_singular(), shown_stages(progress) as stages:
        with stages.stage("mesh"):
            source, test = read_mesh_source(body), read_test(body)
            if test is not None:
                body = with_test(body, test, source)
                source = source_of(mesh_as_read(source), body)
        with stages.stage("assembly"):
            structure = assemble_on(body, source)
        with stages.stage("frequencies"):
            frequencies = first_frequencies(structure, N_SURVEYED_FREQUENCIES)
    band = body.impulse.band or 0.25 / body.impulse.step
    return Survey(
        body=body,
        source=source,
        structure=structure,
        shares=source.shares(),
        frequencies=frequencies,
        resolution=source.resolution(band),
        doubts=(
            *doubts_of_body(body),
            *doubts_of_mesh(source.mesh),
            *doubts_on_mesh(body, source),
            *doubts_of_frequencies(body, float(min(frequencies.values, default=0.0))),
        ),
        band=band,
        cost=_cost(body, structure),
        surfaces=_surface_cost(structure, source, band),
        measured=None if test is None else test.modes.frequency,
    )


def _surface_cost(structure: Structure, source: MeshSource, band: float) -> SurfaceCost | None:
    """Of the modes up to `band` [Hz], about 9 V / w^3 + 2.4 S / w^2, with the shear wave w there.

    Weyl's law for two shear waves and one of compression, and as of three fields with free ends.
    Source: H. Weyl, Rend. Circ. Mat. Palermo 39 (1915) 1-49.
    """
    if structure.surfaces is None:
        return None
    wave, columns = source.resolution(band).wavelength, structure.surfaces.rows.shape[0]
    volume = sum(share.extent for share in source.shares())
    area = sum(
        0.5 * float(np.linalg.norm(np.cross(p, np.roll(p, -1, axis=1)).sum(axis=1), axis=1).sum())
        for p, _ in source.boundary()
    )
    modes = 9.0 * volume / wave**3 + 0.75 * np.pi * area / wave**2
    fields = structure.surfaces.fields.shape[0]
    build = surface_cost(structure.n_u, structure.K.nnz, columns, fields, modes)
    return SurfaceCost(columns, fields, modes, build)


def _cost(body: Body, structure: Structure) -> BuildCost | None:
    """Time and memory of the method for large bodies; None for small ones and other methods."""
    impulse = body.impulse
    by_krylov = impulse.method not in ("modal", "march") and structure.surfaces is None
    if not by_krylov or structure.n_u <= FULL_MODAL_UNKNOWNS:
        return None
    wide = structure.with_channels()
    shift, lower = shifts(wide, damping_of(body), band_of(body))
    accuracy = solution_accuracy(impulse.tolerance, fields=body.recovery is not None)
    # Nearly all blocks are made with the low shift, where there is one.
    solutions = costs(wide, lower or shift, accuracy)
    factor, iterative = (
        krylov_cost(wide.n_u, wide.K.nnz, wide.P_C.shape[0], impulse.steps, each)
        for each in (solutions.factor, solutions.iterative)
    )
    chosen = solutions.cheaper if body.solver == "auto" else body.solver
    return BuildCost(factor, iterative, chosen)
