"""Bodies of shells: a mesh of triangles and quadrangles with thicknesses."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NoReturn

import numpy as np

from ...superelement.validation import Array
from ..assembly.interfaces import Attachment, nodal_frame, section_frame
from ..assembly.selected import check_elements, mesh_facets, mesh_nodes, names_points, nearest_node
from ..assembly.source import FieldPoints, Resolution, Share
from ..body.body import Body
from ..body.loads import LoadPattern
from ..body.selection import Selection, SurfaceSelection
from ..body.sensors import SensorPoint
from ..body.shell import Shell
from ..elements.directors import Directors, directors
from ..elements.laminate import Laminate, Layer
from ..elements.shell import Shells
from ..elements.shell_matrices import shell_matrices
from ..elements.shell_second import ShellTensors
from ..elements.shell_shape import SHELL_SHAPES
from ..elements.solid_force import pressure_forces
from ..errors import BodyError, MeshError
from ..mesh.connectivity import check_connected
from ..mesh.facets import Facets
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import Nodes
from .assignment import Assignment, assign
from .gauge import stretch_rows, unit_vector
from .shell_faces import face_points
from .shell_readings import (
    face_stress_rows,
    gauge_rows,
    shell_displacement_rows,
    traction_loads,
    volume_loads,
)

SHELL_NODES_PER_WAVE = 7
"""Nodes in a wavelength of bending: waves run too fast by (k h)^2 / 16, 5 per cent."""
MIN_SINE_OF_CORNER = 1e-3
"""Sine of the angle of a corner below which an element counts as degenerate."""
MAX_RELATIVE_OFFSET = 1e-9  # of the mass from the nodes, over the thickness
MIN_SINE_TO_NORMAL = 1e-3
"""Sine of the angle between an orientation and a normal below which it has no projection."""


@dataclass(frozen=True, eq=False)
class ShellSource:
    """A mesh of triangles and quadrangles; every node has six dofs."""

    mesh: Mesh
    body: Body
    geometry: None = None

    @property
    def name(self) -> str:
        return self.mesh.name

    @cached_property
    def nodes(self) -> Nodes:
        return Nodes(self.mesh.points, np.ones(len(self.mesh.points), dtype=bool))

    @cached_property
    def facets(self) -> Facets:
        """The elements themselves."""
        return Facets(self.mesh.elements, np.ones(self.mesh.n_elements, dtype=bool), {})

    @cached_property
    def laminates(self) -> Assignment[Laminate]:
        """The laminate of every element; `BodyError` if the body file has none."""
        body = self.body
        if body.shell is None and not body.shells:
            raise BodyError(
                f"{self.name} is a mesh of shells: expected [shell] or [shells.GROUP] with a "
                "thickness, found none; mesh the volume of a part of solids"
            )
        # Every group has a laminate of its own, also where materials are the same: fans end there.
        whole = None if body.shell is None else self._laminate(body.shell)
        by_group = {name: self._laminate(shell) for name, shell in body.shells.items()}
        return assign(self.mesh, whole, by_group, "shells")

    def _laminate(self, shell: Shell) -> Laminate:
        z, layers = shell.offset - 0.5 * shell.total, []
        for ply in shell.layers:
            material = self.body.material
            if ply.material is not None:
                material = self.body.materials[ply.material]
            assert material is not None
            layers.append(Layer(material, (z, z + ply.thickness), np.radians(ply.angle)))
            z += ply.thickness
        return Laminate(layers, shell.orientation)

    @cached_property
    def directors(self) -> Directors:
        return directors(self.mesh.points, self.mesh.elements, self.laminates.owners)

    @cached_property
    def shells(self) -> Mapping[str, Shells]:
        """The elements of each type, which are known to be sound."""
        # Cheap checks of the mesh, before any matrix is made of it.
        self._check_corners()
        self._check_doubles()
        self._check_sides()
        found = {}
        for kind, cells in self.mesh.elements.items():
            X, axis = self.mesh.points[cells], self._axes(kind)
            found[kind] = Shells(SHELL_SHAPES[kind], X, self.directors.d[kind], axis)
        return found

    def matrices(self) -> tuple[Any, Any]:
        check_connected(self.mesh)
        return self.sums()

    def sums(self) -> tuple[Any, Any]:
        """K and M (n_u, n_u) of shells that need not hang together."""
        laminates = self.laminates
        return shell_matrices(self.mesh, self.shells, laminates.values, laminates.owners)

    def _axes(self, kind: str) -> Array:
        """Vectors (n, 3) of which the projection on an element is its axis 1."""
        cells, normals = self.mesh.cells[kind], self._normals(kind)
        axis = self.mesh.points[cells[:, 1]] - self.mesh.points[cells[:, 0]]
        owners = self.mesh.of_kind(self.laminates.owners, kind)
        for number, laminate in enumerate(self.laminates.values):
            if laminate.axis is not None:
                axis[owners == number] = laminate.axis
        # The first side of an element does where all directions are alike.
        axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
        sine = np.linalg.norm(np.cross(axis, normals), axis=1)
        if (along := np.flatnonzero(sine < MIN_SINE_TO_NORMAL)).size:
            row = int(along[0])
            raise BodyError(
                f"{self.name}: {self._named(kind, row)}: orientation: expected a vector that is "
                f"not along the normal, {normals[row].tolist()}, found {axis[row].tolist()}"
            )
        return np.asarray(axis)

    def _normals(self, kind: str) -> Array:
        """Unit normals (n, 3) in the middle of elements."""
        X = self.mesh.points[self.mesh.cells[kind]]
        across = np.cross(X[:, 1] - X[:, 0], X[:, 2] - X[:, 0])
        # Diagonals: the mean normal of a warped quadrangle, whatever its first corner.
        if kind == "quad":
            across = np.cross(X[:, 2] - X[:, 0], X[:, 3] - X[:, 1])
        length = np.linalg.norm(across, axis=1, keepdims=True)
        return np.asarray(across / np.maximum(length, np.finfo(float).tiny))

    def _named(self, kind: str, row: int) -> str:
        """An element for messages: where it is, for divided ones have no number of the file."""
        middle = self.mesh.points[self.mesh.cells[kind][row]].mean(axis=0)
        return f"{kind} element {row} at {middle.tolist()}"

    def _check_corners(self) -> None:
        """`MeshError` for elements that are degenerate, or not convex."""
        for kind, cells in self.mesh.elements.items():
            X = self.mesh.points[cells]
            after, before = np.roll(X, -1, axis=1) - X, np.roll(X, 1, axis=1) - X
            sizes = np.linalg.norm(after, axis=2) * np.linalg.norm(before, axis=2)
            heights = np.einsum("nki,ni->nk", np.cross(after, before), self._normals(kind))
            worst = (heights / np.maximum(sizes, np.finfo(float).tiny)).min(axis=1)
            if (bad := np.flatnonzero(worst < MIN_SINE_OF_CORNER)).size:
                raise MeshError(
                    f"{self.name}: {self._named(kind, int(bad[0]))} is degenerate or not convex: "
                    f"the sine of a corner is {worst[bad[0]]:.2g}; {bad.size} of {len(cells)} are"
                )

    def _check_doubles(self) -> None:
        """`MeshError` for elements on the same nodes, which would count twice."""
        for kind, cells in self.mesh.elements.items():
            _, first, count = np.unique(
                np.sort(cells, axis=1), axis=0, return_index=True, return_counts=True
            )
            if (twice := np.flatnonzero(count > 1)).size:
                raise MeshError(
                    f"{self.name}: {self._named(kind, int(first[twice[0]]))} is there "
                    f"{count[twice[0]]} times, expected once; {twice.size} of {len(cells)} are: "
                    "give layers as plies"
                )

    def _check_sides(self) -> None:
        """`MeshError` for neighbors whose normals are on opposite sides, where sides matter."""
        turned = self.directors.turned
        sided = self.body.loads or any(laminate.sided for laminate in self.laminates.values)
        if len(turned) and sided:
            first, second = (self._named(*self.mesh.element(int(i))) for i in turned[0])
            raise MeshError(
                f"{self.name}: expected normals on one side of a surface, found them on opposite "
                f"sides of neighbors, {first} and {second}; {len(turned)} such pairs: "
                "loads, offsets, unsymmetric plies and plies at an angle need one side"
            )

    def tensors(self, M: Any, center: Array) -> ShellTensors:
        """`BodyError` for frames and offsets whose second order is not known."""
        self._check_second_order()
        laminates = self.laminates
        return ShellTensors(self.mesh, self.shells, laminates.values, laminates.owners, center)

    def _check_second_order(self) -> None:
        for group, laminate in self.laminates.properties.items():
            mass, moment, _ = laminate.inertia
            if abs(moment) > MAX_RELATIVE_OFFSET * mass * (laminate.z[1] - laminate.z[0]):
                key = f"shells.{group}" if group else "shell"
                raise BodyError(
                    f"{key}: with [rotation] expected a mass whose middle is at the nodes (no "
                    f"offset), found it {moment / mass:.3g} m beside them"
                )
        for table in ("interfaces", "masses"):
            for name, selection in getattr(self.body, table).items():
                if getattr(selection, "interface", None) is not None or selection.rigid:
                    continue
                nodes = self.attachment(selection).nodes
                # From one node to another place leads an arm, which turns with it.
                if len(nodes) > 1 or selection.at is not None:
                    found = f"an average of {len(nodes)} nodes" if len(nodes) > 1 else "one with at"
                    raise BodyError(
                        f"{table}.{name}: with [rotation] expected one node, or an interface of "
                        f'kind = "rigid", found {found}'
                    )

    def attachment(self, selection: Selection) -> Attachment:
        """The dofs of a node, or a frame with six that several nodes carry."""
        mesh = self.mesh
        check_elements(selection, mesh)
        if selection.node is not None:
            return nodal_frame(nearest_node(selection, mesh.points, mesh.size), self.nodes)
        members = mesh_nodes(selection, mesh)
        return section_frame(selection, members, self.nodes, self.radius)

    @cached_property
    def radius(self) -> float:
        """The radius of gyration of a section, of the mean thickness [m]."""
        # One for all: it only weighs rotations beside displacements, and rigid motions stay exact.
        thickness = [laminate.z[1] - laminate.z[0] for laminate in self.laminates.values]
        return float(np.mean(thickness) / np.sqrt(12.0))

    def touched(self, selection: SurfaceSelection) -> NoReturn:
        """`BodyError`: surfaces are those of solids."""
        raise BodyError(f"[surfaces]: expected a mesh of solids, found {self.name}, one of shells")

    def forces(self, load: LoadPattern) -> Array:
        """Nodal forces and moments (6 n,); a pressure acts against the normals of elements."""
        if load.force_per_length is not None:
            raise BodyError("force_per_length: expected a mesh of lines, found one of shells")
        self._check_sides()
        if load.force_per_volume is not None:
            return volume_loads(self, load.group, np.array(load.force_per_volume)).ravel()
        check_elements(load, self.mesh)
        if names_points(load, self.mesh):
            raise BodyError(f"group {load.group!r}: expected shells, found points")
        chosen = np.unique(mesh_facets(load, self.mesh, self.facets))
        if load.traction is not None:
            return traction_loads(self, chosen, np.array(load.traction)).ravel()
        assert load.pressure is not None
        total = np.zeros((len(self.mesh.points), 6))
        patch = self.facets.patch(chosen)
        total[:, :3] = pressure_forces(self.mesh.points, patch, load.pressure)
        return total.ravel()

    def readings(self, sensor: SensorPoint) -> tuple[Any, Array]:
        """Of points within the thickness; stresses on a face."""
        point = np.array(sensor.point)
        if sensor.length is not None:
            rows = stretch_rows(lambda x: shell_displacement_rows(self, x), sensor, self.mesh.size)
            return rows, point
        if sensor.stress:
            return face_stress_rows(self, point), point
        if sensor.direction is not None:
            return gauge_rows(self, point, unit_vector(sensor.direction)), point
        return shell_displacement_rows(self, point), point

    def check_fields(self, stress: bool) -> None:
        """Shells give displacements, and stresses on both faces."""

    def field_points(self, stress: bool) -> FieldPoints:
        """Points on both faces, at every node one for each smooth surface that meets there."""
        return face_points(self, stress)

    def shares(self) -> tuple[Share, ...]:
        areas = [
            (shells.frames(shells.shape.xi).areas @ shells.shape.weights)
            for shells in self.shells.values()
        ]
        return self.laminates.shares(np.concatenate(areas), "m^2")

    def resolution(self, frequency: float) -> Resolution:
        shortest = min(laminate.shortest_wave(frequency) for laminate in self.laminates.values)
        spacing = 0.0
        for cells in self.mesh.elements.values():
            corners = self.mesh.points[cells]
            edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
            spacing = max(spacing, float(edges.max()))
        return Resolution(shortest, spacing, SHELL_NODES_PER_WAVE, "bending")

    def bending_excess(self) -> float:
        """Bending without transverse shear is held by the assumed strains."""
        return 1.0

    def stiff_in_volume(self) -> bool:
        return False

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        for kind, cells in self.mesh.elements.items():
            yield self.mesh.points[cells], self.mesh.first[kind] + np.arange(len(cells))
