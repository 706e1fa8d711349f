"""Bodies of solids: a mesh of solid elements with materials."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from ...cad import CadGeometry
from ...superelement.validation import Array
from ..assembly.interfaces import Attachment, facet_frame, nodal_frame, point_frame
from ..assembly.selected import check_elements, mesh_facets, mesh_nodes, names_points, nearest_node
from ..assembly.source import FieldPoints, Resolution, Share
from ..assembly.surface import Surface, surface
from ..body.body import Body
from ..body.loads import LoadPattern
from ..body.material import STRESS_ORDER, Material
from ..body.selection import Selection, SurfaceSelection
from ..body.sensors import SensorPoint
from ..elements.bending import bending_excess
from ..elements.location import locate
from ..elements.sampling import displacement_rows, point_strain_rows
from ..elements.solid import check_jacobians, solid_matrices, volumes
from ..elements.solid_force import pressure_forces, traction_forces, volume_forces
from ..elements.solid_second import SolidTensors
from ..elements.strain import strain_rows
from ..errors import BodyError, InterfaceError
from ..mesh.cells import FACET_TYPES
from ..mesh.connectivity import check_connected, check_no_mechanism
from ..mesh.facets import Facets, Patch, facets_of
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import Nodes
from .assignment import Assignment, assign
from .gauge import stretch_rows, unit_vector
from .solid_surface import surface_points

SOLID_NODES_PER_WAVE = (6, 4)
"""Nodes in a wavelength, of linear and of quadratic elements: waves run too fast by (k h)^2 / 24,
5 per cent, and by sqrt(10) / pi - 1, 1 per cent.
"""
STIFF_IN_VOLUME = ("tetra", "wedge")
"""Solids that are too stiff where the material is nearly incompressible."""


@dataclass(frozen=True, eq=False)
class SolidSource:
    """A mesh of solids with materials; every node has three dofs."""

    mesh: Mesh
    body: Body

    @property
    def name(self) -> str:
        return self.mesh.name

    @property
    def geometry(self) -> CadGeometry | None:
        return self.mesh.geometry

    @cached_property
    def nodes(self) -> Nodes:
        return Nodes(self.mesh.points, np.zeros(len(self.mesh.points), dtype=bool))

    @cached_property
    def facets(self) -> Facets:
        return facets_of(self.mesh)

    @cached_property
    def materials(self) -> Assignment[Material]:
        """The material of every element; `BodyError` if the body file has none."""
        if self.body.material is None and not self.body.materials:
            raise BodyError(
                f"{self.name} is a mesh of solids: expected [material] or [materials.GROUP], "
                "found a section"
            )
        return assign(self.mesh, self.body.material, self.body.materials, "materials")

    def matrices(self) -> tuple[Any, Any]:
        self.check()
        return self.sums()

    def check(self) -> None:
        """`PreprocessError` unless the elements have materials and are one free elastic body."""
        check_connected(self.mesh)
        # Before anything expensive: a group without material is a mistake in the body file.
        _ = self.materials
        check_jacobians(self.mesh)
        check_no_mechanism(self.mesh, self.facets)

    def sums(self) -> tuple[Any, Any]:
        """K and M (n_u, n_u) of elements that are known to be sound."""
        return solid_matrices(self.mesh, self.materials.values, self.materials.owners)

    def part(self, elements: IntArray) -> tuple["SolidSource", IntArray]:
        """Some of the elements (n,) with their materials, and their points among all."""
        mesh, points = self.mesh.part(elements, self.body.materials)
        return replace(self, mesh=mesh), points

    def tensors(self, M: Any, center: Array) -> SolidTensors:
        return SolidTensors(
            self.name,
            # The mass of solids is the same in all directions: a third of it says all.
            M[::3, ::3].tocsr(),
            self.mesh.points - center,
            self.mesh,
            self.materials.values,
            self.materials.owners,
        )

    def attachment(self, selection: Selection) -> Attachment:
        """A node with three dofs, or a frame with six that facets or points carry.

        A group that names a single point has the three dofs of that.
        """
        mesh, nodes = self.mesh, self.nodes
        check_elements(selection, mesh)
        if selection.node is not None:
            return nodal_frame(nearest_node(selection, mesh.points, mesh.size), nodes)
        if names_points(selection, mesh):
            return point_frame(selection, mesh_nodes(selection, mesh), nodes)
        numbers = mesh_facets(selection, mesh, self.facets)
        faces = surface(mesh.points, self.facets.patch(numbers))
        return facet_frame(selection, numbers, faces, nodes, self._on_axis(selection, faces))

    def _on_axis(self, selection: Selection, faces: Surface) -> Array | None:
        """The place on the axis of a cylinder of CAD: a keyway moves the centroid of facets."""
        if self.geometry is None or selection.feature is None:
            return None
        feature = self.geometry.groups[str(selection.feature)]
        if not feature.radius:
            return None
        # Of a hole as a whole the edges of the CAD file are exact, those of the mesh have chords.
        ends = self.mesh.points[faces.nodes] if selection.shapes else np.array([feature.center])
        return feature.middle(ends)

    def touched(self, selection: SurfaceSelection) -> Patch:
        mesh = self.mesh
        check_elements(selection, mesh)
        if names_points(selection, mesh):
            raise InterfaceError(f"group {selection.group!r}: expected facets, found points")
        numbers = np.unique(mesh_facets(selection, mesh, self.facets))
        if inner := int((~self.facets.boundary[numbers]).sum()):
            raise InterfaceError(
                f"expected facets of the boundary, found {inner} of {len(numbers)} in the body"
            )
        return self.facets.patch(numbers)

    def forces(self, load: LoadPattern) -> Array:
        mesh = self.mesh
        if load.force_per_length is not None:
            raise BodyError("force_per_length: expected a mesh of lines, found one of solids")
        if load.force_per_volume is not None:
            density = np.array(load.force_per_volume)
            return volume_forces(mesh, self._elements(load.group), density).ravel()
        numbers = self._loaded_facets(load)
        if load.pressure is not None:
            patch = self.facets.patch(numbers)
            return pressure_forces(mesh.points, patch, load.pressure).ravel()
        traction = np.array(load.traction)
        return traction_forces(mesh.points, self.facets.patch(numbers), traction).ravel()

    def _elements(self, group: str | None) -> dict[str, IntArray]:
        """The rows of the elements of a group, or of all, by type."""
        rows = {kind: np.arange(len(cells)) for kind, cells in self.mesh.elements.items()}
        if group is None:
            return rows
        cells = self.mesh.group(group).cells
        chosen = {kind: cells[kind] for kind in rows if kind in cells}
        if not chosen:
            raise BodyError(f"group {group!r}: expected solid elements, found none")
        return chosen

    def _loaded_facets(self, load: LoadPattern) -> IntArray:
        check_elements(load, self.mesh)
        if names_points(load, self.mesh):
            raise BodyError(f"group {load.group!r}: expected facets, found points")
        numbers = mesh_facets(load, self.mesh, self.facets)
        # Within a body a pressure would push both sides, and cancel.
        if load.pressure is not None and not self.facets.boundary[numbers].all():
            raise BodyError("pressure: expected facets of the boundary, found some within the body")
        return np.unique(numbers)

    def readings(self, sensor: SensorPoint) -> tuple[Any, Array]:
        mesh, point = self.mesh, np.array(sensor.point)
        if sensor.length is not None:
            row = stretch_rows(
                lambda x: displacement_rows(mesh, locate(mesh, x)), sensor, mesh.size
            )
            return row, point
        place = locate(mesh, point)
        if sensor.kind == "motion":
            return displacement_rows(mesh, place), point
        owner = mesh.of_kind(self.materials.owners, place.kind)[place.row]
        material = self.materials.values[owner]
        strains = point_strain_rows(mesh, place, material)
        if sensor.kind == "stress":
            return sp.csr_array(material.elasticity) @ strains, point
        d = unit_vector(sensor.direction)
        i, j = np.array(STRESS_ORDER).T
        return sp.csr_array((d[i] * d[j])[None]) @ strains, point

    def check_fields(self, stress: bool) -> None:
        """Solids give displacements and stresses."""

    def field_points(self, stress: bool) -> FieldPoints:
        """The nodes of the surface, one for each material that bounds there."""
        owners = self.materials.owners
        points = surface_points(self.mesh, self.facets, owners)
        labels = None if self.mesh.labels is None else self.mesh.labels[points.nodes]
        if not stress:
            return FieldPoints(points.nodes, points.cells, labels=labels)
        C = np.array([material.elasticity for material in self.materials.values])
        strains = strain_rows(self.mesh, points.of_elements, self.materials.values, owners)
        return FieldPoints(points.nodes, points.cells, strains, C, points.owners, labels)

    def shares(self) -> tuple[Share, ...]:
        return self.materials.shares(volumes(self.mesh), "m^3")

    def resolution(self, frequency: float) -> Resolution:
        shortest = min(material.shortest_wave(frequency) for material in self.materials.values)
        spacing, quadratic = 0.0, False
        for kind, nodes in self.facets.nodes.items():
            corners = self.mesh.points[nodes[:, : FACET_TYPES[kind].corners]]
            edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
            quadratic = nodes.shape[1] > FACET_TYPES[kind].corners
            spacing = max(spacing, float(edge) / (2 if quadratic else 1))
        return Resolution(shortest, spacing, SOLID_NODES_PER_WAVE[quadratic], "shear")

    def bending_excess(self) -> float:
        return bending_excess(self.mesh, self.materials.values, self.materials.owners)

    def stiff_in_volume(self) -> bool:
        materials, owners = self.materials.values, self.materials.owners
        stiff = [i for i, material in enumerate(materials) if material.nearly_incompressible]
        return any(
            bool(np.isin(self.mesh.of_kind(owners, kind), stiff).any())
            for kind in STIFF_IN_VOLUME
            if kind in self.mesh.elements
        )

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        for kind, first in self.facets.first.items():
            nodes = self.facets.nodes[kind]
            rows = np.flatnonzero(self.facets.boundary[first:][: len(nodes)])
            rim = _rim(FACET_TYPES[kind].corners, nodes.shape[1])
            yield self.mesh.points[nodes[rows][:, rim]], first + rows


def _rim(corners: int, n_nodes: int) -> list[int]:
    """The nodes around a facet: its corners, with the middles between them if there are any."""
    if n_nodes == corners:
        return list(range(corners))
    return [node for corner in range(corners) for node in (corner, corners + corner)]
