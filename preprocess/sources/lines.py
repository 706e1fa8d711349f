"""Bodies of beams: a mesh of lines with sections."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..assembly.interfaces import Attachment, nodal_frame
from ..assembly.selected import check_elements, mesh_nodes, nearest_node
from ..assembly.source import FieldPoints, Resolution, Share
from ..body.body import Body
from ..body.loads import LoadPattern
from ..body.material import Section
from ..body.selection import Selection, SurfaceSelection
from ..body.sensors import SensorPoint
from ..elements.beam import beam_matrices, lengths, lengths_and_axes
from ..elements.beam_force import line_forces
from ..elements.beam_second import BeamTensors, beam_tensors
from ..elements.section_point import Beams
from ..errors import BodyError, InterfaceError
from ..mesh.connectivity import check_connected
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import Nodes, node_dofs
from .assignment import Assignment, assign
from .gauge import stretch_rows, unit_vector

MAX_LISTED_NODES = 4
NODES_PER_WAVE = 4  # nodes in a wavelength: waves run too fast by sqrt(10) / pi - 1, 1 per cent


@dataclass(frozen=True, eq=False)
class LineSource:
    """A mesh of lines with sections; every node has six dofs."""

    mesh: Mesh
    body: Body
    facets: None = None
    geometry: None = None

    @property
    def name(self) -> str:
        return self.mesh.name

    @cached_property
    def nodes(self) -> Nodes:
        return Nodes(self.mesh.points, np.ones(len(self.mesh.points), dtype=bool))

    @cached_property
    def sections(self) -> Assignment[Section]:
        """The section of every line; `BodyError` if the body file has none."""
        if self.body.section is None and not self.body.sections:
            raise BodyError(
                f"{self.name} is a mesh of lines: expected [section] or [sections.GROUP], "
                "found a material"
            )
        return assign(self.mesh, self.body.section, self.body.sections, "sections")

    def matrices(self) -> tuple[Any, Any]:
        check_connected(self.mesh)
        stiffness, mass = beam_matrices(self.mesh, self.section_of_each)
        dofs = node_dofs(self.mesh.cells["line"], 6)
        n_dofs = self.nodes.n_dofs
        return _scatter(stiffness, dofs, n_dofs), _scatter(mass, dofs, n_dofs)

    def tensors(self, M: Any, center: Array) -> BeamTensors:
        return beam_tensors(self.mesh, self.section_of_each, center)

    @property
    def section_of_each(self) -> list[Section]:
        """The section of every line."""
        return [self.sections.values[owner] for owner in self.sections.owners]

    def section_axes(self) -> tuple[Array, Array]:
        """Middles (n, 3) of the lines, and their local axes x, y, z as rows (n, 3, 3)."""
        middles: Array = self.mesh.points[self.mesh.cells["line"]].mean(axis=1)
        return middles, lengths_and_axes(self.mesh, self.section_of_each)[1]

    def attachment(self, selection: Selection) -> Attachment:
        """The dofs of the node nearest to a point, or of the one that a group or shapes select."""
        mesh = self.mesh
        check_elements(selection, mesh)
        if selection.node is not None:
            return nodal_frame(nearest_node(selection, mesh.points, mesh.size), self.nodes)
        if selection.model_fields_set & {"kind", "at"}:
            raise InterfaceError("kind and at belong to facets, of which a mesh of lines has none")
        # A frame on several nodes would need their weights, which lines do not tell.
        members = mesh_nodes(selection, mesh)
        if len(members) != 1:
            listed = [
                f"{node} at {mesh.points[node].tolist()}" for node in members[:MAX_LISTED_NODES]
            ]
            more = ", ..." if len(members) > MAX_LISTED_NODES else ""
            raise InterfaceError(
                f"expected one node of the lines, found {len(members)} in {selection}: "
                f"points {', '.join(listed)}{more}"
            )
        return nodal_frame(int(members[0]), self.nodes)

    def touched(self, selection: SurfaceSelection) -> NoReturn:
        """`BodyError`: lines have no facets."""
        raise BodyError(f"[surfaces]: expected a mesh of solids, found {self.name}, one of lines")

    def forces(self, load: LoadPattern) -> Array:
        if load.force_per_length is None:
            raise BodyError(
                f"{load.kind}: expected force_per_length on lines, which have neither facets nor "
                "volumes"
            )
        rows = np.arange(self.mesh.n_elements)
        if load.group is not None and not len(rows := self.mesh.members(load.group)):
            raise BodyError(f"group {load.group!r}: expected lines, found none")
        density = np.array(load.force_per_length)
        return line_forces(self.mesh, self.section_of_each, rows, density).ravel()

    def readings(self, sensor: SensorPoint) -> tuple[Any, Array]:
        """Of points beside the axis too, which move with their sections."""
        if sensor.stress:
            raise BodyError("stress: expected a mesh of solids, found lines: take direction")
        beams, point = Beams(self.mesh, self.section_of_each), np.array(sensor.point)
        if sensor.direction is None:
            return beams.displacement_rows(beams.locate(point)), point
        d = unit_vector(sensor.direction)
        if sensor.length is None:
            return beams.strain_rows(beams.locate(point), d), point
        size = self.mesh.size
        return stretch_rows(lambda x: beams.displacement_rows(beams.locate(x)), sensor, size), point

    def check_fields(self, stress: bool) -> None:
        if stress:
            raise BodyError(
                f"recovery.stress: expected a mesh of solids, found {self.name}, one of lines"
            )

    def field_points(self, stress: bool) -> FieldPoints:
        """All nodes, joined by the lines."""
        self.check_fields(stress)
        nodes = np.arange(len(self.mesh.points))
        return FieldPoints(nodes, self.mesh.cells["line"], labels=self.mesh.labels)

    def shares(self) -> tuple[Share, ...]:
        return self.sections.shares(lengths(self.mesh), "m")

    def resolution(self, frequency: float) -> Resolution:
        shortest = min(section.shortest_wave(frequency) for section in self.sections.values)
        return Resolution(shortest, float(lengths(self.mesh).max()), NODES_PER_WAVE, "bending")

    def bending_excess(self) -> float:
        """Lines hold pure bending exactly."""
        return 1.0

    def stiff_in_volume(self) -> bool:
        return False

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        """Lines have no facets."""
        return iter(())


def _scatter(blocks: Array, dofs: IntArray, n_dofs: int) -> Any:
    """The sum of element matrices (n, k, k) in rows and columns `dofs` (n, k)."""
    rows = np.broadcast_to(dofs[:, :, None], blocks.shape)
    columns = np.broadcast_to(dofs[:, None, :], blocks.shape)
    shape = (n_dofs, n_dofs)
    matrix = sp.coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsc()
    # Sums in another order round differently on both sides of the diagonal.
    return (0.5 * (matrix + matrix.T)).tocsc()
