"""The solid elements of the mesh beside given matrices: surface, stresses and stiffening."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..assembly.source import FieldPoints
from ..body.body import Body
from ..elements.solid_second import SolidTensors
from ..errors import BodyError
from ..given.matrices import GivenModel
from ..mesh.facets import facets_of
from ..mesh.mesh import IntArray, Mesh
from .solid_surface import surface_points
from .solids import SolidSource

STIFFNESS_RATIOS = (0.5, 2.0)
"""Of the sums of the diagonals of given stiffness and of that of the elements: formulations differ
by less than a factor, units by more.
"""


@dataclass(frozen=True, eq=False)
class GivenElements:
    """Elements of a mesh on the nodes of a model; what needs a material takes that of `body`."""

    mesh: Mesh
    model: GivenModel
    body: Body

    @cached_property
    def rows(self) -> IntArray | None:
        """The node (n,) of the model of each of the mesh; None where some have no dofs."""
        labels, table = self.mesh.labels, self.model.table
        if labels is None or len(table.unknown(labels)):
            return None
        return table.rows(labels)

    def check_fields(self, stress: bool) -> None:
        """`BodyError` where nodes of the mesh have no dofs, or stresses no material."""
        name = self.model.table.name
        if self.rows is None:
            raise BodyError(
                f"[recovery]: expected dofs at all nodes of the elements of {name}, found a "
                "reduced model, which moves only some of them"
            )
        if stress:
            self._require_material("recovery.stress")

    def surface(self) -> tuple[Array, IntArray]:
        """Points (p, 3) of the surface, and its facets (n, k) as rows of them, -1 filling."""
        points = surface_points(self.mesh, facets_of(self.mesh), self._owners)
        return self.mesh.points[points.nodes], points.cells

    def field_points(self, stress: bool) -> FieldPoints:
        """The nodes of the surface, as rows of the model."""
        self.check_fields(stress)
        rows = np.zeros(0, dtype=np.int64) if self.rows is None else self.rows
        if not stress:
            points = surface_points(self.mesh, facets_of(self.mesh), self._owners)
            labels = None if self.mesh.labels is None else self.mesh.labels[points.nodes]
            return FieldPoints(rows[points.nodes], points.cells, labels=labels)
        found = self._solids.field_points(stress=True)
        # Strains are of displacements of the mesh, which are some of those of the model.
        columns = (3 * rows[:, None] + np.arange(3)).ravel()
        shape = (len(columns), 3 * len(self.model.nodes.points))
        pick = sp.csr_array((np.ones(len(columns)), (np.arange(len(columns)), columns)), shape)
        strains: Any = found.strains @ pick
        return FieldPoints(
            rows[found.nodes], found.cells, strains, found.C, found.owners, found.labels
        )

    def tensors(self, M: Any, center: Array) -> SolidTensors:
        """The second order of the elements. `BodyError` if not all dofs are those of elements."""
        self._require_material("[rotation]")
        nodes = self.model.nodes
        same = self.rows is not None and len(self.rows) == len(nodes.points)
        if not same or nodes.rotations.any() or nodes.generalized:
            raise BodyError(
                f"[rotation]: expected dofs at the nodes of solid elements of "
                f"{self.model.table.name} alone, found others, whose stiffening is not known: "
                "leave [material] out for the inertia alone"
            )
        return self._solids.tensors(M, center)

    @cached_property
    def _solids(self) -> SolidSource:
        return SolidSource(self.mesh, self.body)

    @property
    def _owners(self) -> IntArray:
        """One material for all elements (n_elements,)."""
        return np.zeros(self.mesh.n_elements, dtype=np.int64)

    def _require_material(self, key: str) -> None:
        """`BodyError` without a material, or with one unlike that of the matrices."""
        name = self.model.name
        if self.body.material is None:
            raise BodyError(
                f"{key}: expected [material], for the matrices {name} do not tell it, found none"
            )
        if self.rows is None:
            return
        # Elements of other codes differ by some ten per cent, a wrong unit of E by thousands.
        own = self._solids.sums()[0].diagonal().sum()
        of_nodes = self.model.nodes.displacements[self.rows].ravel()
        ratio = float(self.model.K.diagonal()[of_nodes].sum() / own)
        if not STIFFNESS_RATIOS[0] <= ratio <= STIFFNESS_RATIOS[1]:
            raise BodyError(
                f"material: expected that of the matrices {name}, found one with which the "
                f"elements are {1.0 / ratio:.3g} times as stiff: look at E and its unit"
            )
