"""Bodies of solids and shells in one mesh."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NoReturn

import numpy as np
import scipy.sparse as sp

from ...superelement.cells import padded
from ...superelement.validation import Array
from ..assembly.interfaces import Attachment, check_spread, nodal_frame, point_frame, section_frame
from ..assembly.selected import check_elements, mesh_nodes, nearest_node
from ..assembly.source import FacePoints, FieldPoints, Resolution, Share
from ..assembly.surface import mean_motion_of_sections
from ..body.body import Body
from ..body.loads import LoadPattern
from ..body.selection import Selection, SurfaceSelection
from ..body.sensors import SensorPoint
from ..elements.junction import junction_rows
from ..elements.solid import check_jacobians
from ..errors import BodyError, InterfaceError
from ..mesh.cells import CELL_DIMENSIONS
from ..mesh.connectivity import check_connected, check_no_mixed_mechanism
from ..mesh.facets import Facets
from ..mesh.mesh import IntArray, Mesh
from ..mesh.mixed import MixedMesh, mixed
from ..mesh.nodes import Nodes
from .shells import ShellSource
from .solids import SolidSource


@dataclass(frozen=True, eq=False)
class MixedSource:
    """A mesh of solids and shells; nodes of shells have six dofs, all others three.

    A shell on a face of a solid shares its nodes. The end of another shell follows the solid there
    by `junction_rows`, and has no dofs of its own.
    """

    given: Mesh
    body: Body
    geometry: None = None

    @cached_property
    def parts(self) -> MixedMesh:
        return mixed(self.given)

    @property
    def name(self) -> str:
        return self.given.name

    @property
    def mesh(self) -> Mesh:
        return self.parts.whole

    @cached_property
    def nodes(self) -> Nodes:
        turning = np.zeros(len(self.mesh.points), dtype=np.bool_)
        turning[self.parts.of_shells[~self.parts.joined]] = True
        return Nodes(self.mesh.points, turning)

    @cached_property
    def solids(self) -> SolidSource:
        """The solids; `BodyError` if none of the materials is theirs."""
        body = self.body
        own = {
            name: material
            for name, material in body.materials.items()
            if name in self.mesh.groups and len(self.parts.solids.members(name))
        }
        for name in body.materials:
            if name not in own and name not in body.ply_materials:
                raise BodyError(
                    f"materials.{name}: expected a group of solids, or a shell of it, found none"
                )
        if body.material is None and not own:
            raise BodyError(
                f"{self.name}: expected [material] or [materials.GROUP] for the solids, found "
                "materials of shells alone"
            )
        changes = {"materials": own, "shells": {}}
        return SolidSource(self.parts.solids, body.model_copy(update=changes))

    @cached_property
    def shells(self) -> ShellSource:
        """The shells, whose mesh has the joined points too."""
        return ShellSource(self.parts.shells, self.body)

    @property
    def facets(self) -> Facets:
        """The facets of the solids."""
        return self.parts.facets

    @cached_property
    def of_solids(self) -> Any:
        """The dofs (3 n_s) of the solids from all (n_u), sparse."""
        columns = self.nodes.displacements[self.parts.of_solids].ravel()
        return _picked(columns, self.nodes.n_dofs)

    @cached_property
    def of_shells(self) -> Any:
        """The dofs (6 n_h) of the shells from all (n_u), sparse: joined ones follow the solids."""
        parts, n = self.parts, self.nodes.n_dofs
        own, joined = np.flatnonzero(~parts.joined), np.flatnonzero(parts.joined)
        first = self.nodes.first[parts.of_shells[own]]
        picked = _picked((first[:, None] + np.arange(6)).ravel(), n)
        heights = np.array([laminate.z for laminate in self.shells.laminates.values])
        of_kind = {
            kind: heights[parts.shells.of_kind(self.shells.laminates.owners, kind)]
            for kind in parts.shells.elements
        }
        followed = junction_rows(parts, self.shells.directors, of_kind) @ self.of_solids
        order = np.argsort(np.concatenate([own, joined]))
        rows = (6 * order[:, None] + np.arange(6)).ravel()
        return sp.vstack([picked, followed], format="csr")[rows]

    def matrices(self) -> tuple[Any, Any]:
        parts = self.parts
        check_connected(self.mesh)
        # Before anything expensive, and before directors of shells that are none.
        _ = self.solids.materials, self.shells.shells
        check_jacobians(parts.solids)
        check_no_mixed_mechanism(parts)
        S, R = self.of_solids, self.of_shells

        def summed(solid: Any, shell: Any) -> Any:
            total = S.T @ solid @ S + R.T @ shell @ R
            # Sums in another order round differently on both sides of the diagonal.
            return (0.5 * (total + total.T)).tocsc()

        of_solids, of_shells = self.solids.sums(), self.shells.sums()
        return summed(of_solids[0], of_shells[0]), summed(of_solids[1], of_shells[1])

    def tensors(self, M: Any, center: Array) -> NoReturn:
        """`BodyError`: the second order of a junction is not known."""
        raise BodyError(
            f"[rotation]: expected a mesh of solids or of shells, found {self.name}, which has both"
        )

    def attachment(self, selection: Selection) -> Attachment:
        """A node, a frame on facets of solids, or one on nodes of shells."""
        check_elements(selection, self.mesh)
        if selection.node is not None:
            return nodal_frame(
                nearest_node(selection, self.mesh.points, self.mesh.size), self.nodes
            )
        if self._on_solids(selection):
            return self._lifted(self.solids.attachment(selection))
        members = mesh_nodes(selection, self.mesh)
        if not np.isin(members, self.parts.of_shells).all():
            return point_frame(selection, members, self.nodes)
        if self.nodes.rotations[members].all():
            return section_frame(selection, members, self.nodes, self.shells.radius)
        # The ends of shells on solids turn as these do, and have no dofs of their own.
        if selection.rigid and not self.nodes.rotations[members].any():
            # Displacements of nodes on a line do not hold a frame against turns about it.
            check_spread(self.mesh.points[members])
        X = self.mesh.points[members].mean(axis=0)
        X = X if selection.at is None else np.array(selection.at)
        ends = np.flatnonzero(np.isin(self.parts.of_shells, members))
        rows = mean_motion_of_sections(ends, X, self.shells.nodes, self.shells.radius)
        return Attachment(X, (rows @ self.of_shells).tocsr(), members, rigid=selection.rigid)

    def _lifted(self, frame: Attachment) -> Attachment:
        """A frame on the solids as one on the whole."""
        return Attachment(
            frame.X,
            (frame.rows @ self.of_solids).tocsr(),
            self.parts.of_solids[frame.nodes],
            frame.facets,
            frame.area,
            frame.rigid,
        )

    def _on_solids(self, selection: Selection | LoadPattern) -> bool:
        """Whether a selection is of facets of solids; `InterfaceError` where of shells as well."""
        solids, shells = self._groups(selection) if selection.group else self._places(selection)
        if solids and shells:
            raise InterfaceError(
                f"expected facets of solids or shells, found {solids} facets of solids and "
                f"{shells} shells or nodes of shells in {selection}: take groups of one of them"
            )
        return bool(solids)

    def _groups(self, selection: Selection | LoadPattern) -> tuple[int, int]:
        """How many facets of solids, and shells, a group has."""
        assert selection.group is not None
        shells, solids = 0, 0
        for kind, rows in self.given.group(selection.group).cells.items():
            if CELL_DIMENSIONS.get(kind) == 2:
                of_shells = int(np.isin(rows, self.given.shells.get(kind, ())).sum())
                shells, solids = shells + of_shells, solids + len(rows) - of_shells
        return solids, shells

    def _places(self, selection: Selection | LoadPattern) -> tuple[int, int]:
        """How many facets of the boundary, and nodes of shells alone, lie in shapes."""
        chosen = selection.holds(self.mesh.points, self.mesh.size)
        facets = self.facets.within(chosen[self.parts.of_solids]) & self.facets.boundary
        shells = chosen & ~self.parts.on_solids
        return int(facets.sum()), int(shells.sum())

    def touched(self, selection: SurfaceSelection) -> NoReturn:
        """`BodyError`: surfaces are those of solids."""
        raise BodyError(f"[surfaces]: expected a mesh of solids, found shells in {self.name}")

    def forces(self, load: LoadPattern) -> Array:
        """Nodal forces and moments (n_u,) on solids or shells; forces per volume on both."""
        if load.force_per_length is not None:
            raise BodyError("force_per_length: expected a mesh of lines, found solids and shells")
        if load.force_per_volume is not None:
            return self._volume_forces(load)
        if self._on_solids(load):
            return np.asarray(self.of_solids.T @ self.solids.forces(load))
        return np.asarray(self.of_shells.T @ self.shells.forces(load))

    def _volume_forces(self, load: LoadPattern) -> Array:
        total, found = np.zeros(self.nodes.n_dofs), False
        for source, rows in ((self.solids, self.of_solids), (self.shells, self.of_shells)):
            if load.group is None or len(source.mesh.members(load.group)):
                total, found = total + rows.T @ source.forces(load), True
        if not found:
            raise BodyError(f"group {load.group!r}: expected solids or shells, found none")
        return total

    def readings(self, sensor: SensorPoint) -> tuple[Any, Array]:
        """Of a point in a solid, or else in the thickness of a shell."""
        try:
            rows, place = self.solids.readings(sensor)
            return (rows @ self.of_solids).tocsr(), place
        except BodyError as in_solids:
            try:
                rows, place = self.shells.readings(sensor)
            except BodyError as in_shells:
                raise BodyError(f"of solids: {in_solids}; of shells: {in_shells}") from in_shells
            return (rows @ self.of_shells).tocsr(), place

    def check_fields(self, stress: bool) -> None:
        """Both give displacements and stresses."""

    def field_points(self, stress: bool) -> FieldPoints:
        """The points of the surface of the solids, and then those on the faces of the shells."""
        return _together(self, self.solids.field_points(stress), self.shells.field_points(stress))

    def shares(self) -> tuple[Share, ...]:
        # One material is that of the solids alone: shells have groups.
        solids = [replace(share, group=share.group or "solids") for share in self.solids.shares()]
        return (*solids, *self.shells.shares())

    def resolution(self, frequency: float) -> Resolution:
        """That of the part whose waves have the fewest of the nodes that they need."""
        both = (self.solids.resolution(frequency), self.shells.resolution(frequency))
        return min(both, key=lambda found: found.nodes / found.needed)

    def bending_excess(self) -> float:
        return self.solids.bending_excess()

    def stiff_in_volume(self) -> bool:
        return self.solids.stiff_in_volume()

    def boundary(self) -> Iterator[tuple[Array, IntArray]]:
        yield from self.solids.boundary()
        for polygons, numbers in self.shells.boundary():
            yield polygons, self.facets.count + numbers


def _picked(columns: IntArray, n: int) -> Any:
    """Rows (k, n), sparse, that pick columns (k,)."""
    k = len(columns)
    return sp.csr_array((np.ones(k), columns, np.arange(k + 1)), shape=(k, n))


@dataclass(frozen=True, eq=False)
class _MixedPoints(FacePoints):
    """Points of solids and shells: they move by moved T + turned turns, each (3 p, 3 n), sparse."""

    moved: Any | None = None
    turned: Any | None = None

    def displacement_rows(self, T: Any, part: slice = slice(None), turns: Any = None) -> Any:
        assert self.moved is not None
        assert self.turned is not None
        begin, end, _ = part.indices(len(self.nodes))
        rows = slice(3 * begin, 3 * end)
        return (self.moved[rows] @ T + self.turned[rows] @ turns).tocsr()


def _together(source: MixedSource, solids: FieldPoints, shells: FieldPoints) -> _MixedPoints:
    """The points of the solids, and then those of the shells, by the nodes of both."""
    assert isinstance(shells, FacePoints)
    parts = source.parts
    displacements, rotations = _of_nodes(source.nodes)

    def split(of_solids: Any, of_shells: Any) -> tuple[Any, Any]:
        """By the displacements and the rotations (3 n) of all nodes."""
        rows = sp.vstack([of_solids @ source.of_solids, of_shells @ source.of_shells], format="csc")
        return (rows @ displacements.T).tocsr(), (rows @ rotations.T).tocsr()

    own = source.shells.nodes
    u, w = _of_nodes(own)
    still = sp.identity(3 * len(parts.of_solids), format="csr")
    moved, turned = split(solids.displacement_rows(still), shells.displacement_rows(u, turns=w))
    by_displacements = by_rotations = None
    if shells.by_displacements is not None:
        by_displacements, by_rotations = split(
            solids.stress_rows(still), shells.stress_rows(u, turns=w)
        )
    count = len(solids.nodes)
    cells = [solids.cells, np.where(shells.cells >= 0, shells.cells + count, -1)]
    nodes = np.concatenate([parts.of_solids[solids.nodes], parts.of_shells[shells.nodes]])
    labels = source.mesh.labels
    return _MixedPoints(
        nodes,
        padded(cells),
        labels=None if labels is None else labels[nodes],
        arms=np.vstack([np.zeros((count, 3)), shells.arms]),
        by_displacements=by_displacements,
        by_rotations=by_rotations,
        moved=moved,
        turned=turned,
    )


def _of_nodes(nodes: Nodes) -> tuple[Any, Any]:
    """Displacements and rotations (3 n, n_dofs), sparse, of all nodes; zeros for no rotation."""
    turning = np.flatnonzero(nodes.rotations)
    columns = (nodes.displacements[turning] + 3).ravel()
    rows = (3 * turning[:, None] + np.arange(3)).ravel()
    shape = (3 * len(nodes.points), nodes.n_dofs)
    rotations = sp.coo_array((np.ones(len(rows)), (rows, columns)), shape=shape).tocsr()
    return _picked(nodes.displacements.ravel(), nodes.n_dofs), rotations
