"""The faces of shells, as points at which displacements and stresses are recovered."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from ...superelement.cells import padded
from ...superelement.validation import Array
from ..assembly.source import FacePoints
from ..body.material import STRESS_ORDER
from ..elements.directors import Directors
from ..elements.laminate import Laminate
from ..elements.shell import Shells, SurfaceFrames
from ..elements.shell_matrices import nodal_strains, shell_batches
from ..mesh.mesh import IntArray, Mesh
from ..mesh.nodes import node_dofs
from .assignment import Assignment

LOWER_FACE, UPPER_FACE = 0, 1  # numbers of faces


class MeshOfShells(Protocol):
    """What faces and readings need of a source."""

    @property
    def mesh(self) -> Mesh: ...

    @property
    def directors(self) -> Directors: ...

    @property
    def laminates(self) -> Assignment[Laminate]: ...

    @property
    def shells(self) -> Mapping[str, Shells]: ...


def face_points(source: MeshOfShells, stress: bool) -> FacePoints:
    """Points on both faces, fan by fan, the lower one first; their facets turn outwards.

    Where the surface ends, or folds, facets across the thickness close it.
    """
    fans, n = source.directors.fans, source.directors.n_fans
    node, arm = np.empty(n, dtype=np.int64), np.empty((n, 2, 3))
    heights = np.array([laminate.z for laminate in source.laminates.values])
    for kind, fan in fans.items():
        owners = source.mesh.of_kind(source.laminates.owners, kind)
        node[fan] = source.mesh.cells[kind]
        arm[fan] = heights[owners][:, None, :, None] * source.directors.d[kind][:, :, None]
    labels = source.mesh.labels
    nodes = np.repeat(node, 2)
    found = FacePoints(
        nodes,
        padded(_facets(source.directors)),
        labels=None if labels is None else labels[nodes],
        arms=arm.reshape(-1, 3),
    )
    return _with_stresses(source, found) if stress else found


def _facets(of: Directors) -> list[IntArray]:
    """The upper and lower facets of all elements, and those across the thickness."""
    cells = []
    for kind, fan in of.fans.items():
        lower, upper = 2 * fan + LOWER_FACE, 2 * fan + UPPER_FACE
        cells += [upper, lower[:, ::-1]]
        after = np.roll(np.arange(fan.shape[1]), -1)
        across = np.stack([lower, lower[:, after], upper[:, after], upper], axis=2)
        cells.append(across[of.open[kind]])
    return [part for part in cells if len(part)]


def _with_stresses(source: MeshOfShells, points: FacePoints) -> FacePoints:
    """With the stresses on both faces, the mean of the corners in each fan."""
    n, n_dofs = len(points.nodes), 6 * len(source.mesh.points)
    count = np.zeros(n)
    rows, columns, values = [], [], []
    for batch in shell_batches(source.mesh, source.laminates.owners):
        cells = source.mesh.cells[batch.kind][batch.rows]
        some = source.shells[batch.kind].some(batch.rows)
        laminate = source.laminates.values[batch.owner]
        strains, at = nodal_strains(some, laminate, some.shape.corners)
        fan = source.directors.fans[batch.kind][batch.rows]
        for face in (LOWER_FACE, UPPER_FACE):
            # Every corner counts alike: the mean does not depend on how elements are numbered.
            point = 2 * fan + face
            np.add.at(count, point, 1.0)
            stress = face_stresses(laminate, face, strains, at)  # (n, k, 6, 6 k)
            row = 6 * point[:, :, None] + np.arange(6)
            rows.append(np.broadcast_to(row[..., None], stress.shape).ravel())
            column = node_dofs(cells, 6)[:, None, None]
            columns.append(np.broadcast_to(column, stress.shape).ravel())
            values.append(stress.ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    total = sp.coo_array((np.concatenate(values), places), shape=(6 * n, n_dofs)).tocsr()
    mean = (sp.diags_array(np.repeat(1.0 / count, 6)) @ total).tocsc()
    dofs = np.arange(n_dofs).reshape(-1, 6)
    return FacePoints(
        points.nodes,
        points.cells,
        labels=points.labels,
        arms=points.arms,
        by_displacements=mean[:, dofs[:, :3].ravel()].tocsr(),
        by_rotations=mean[:, dofs[:, 3:].ravel()].tocsr(),
    )


def face_stresses(laminate: Laminate, face: int, strains: Array, at: SurfaceFrames) -> Array:
    """Stresses (n, q, 6, c) in mesh axes on a face, which has none across it.

    strains (n, q, 8, c): of the surface, curvatures and shear, along the axes `at`.
    """
    layer = laminate.layers[-face]
    z = laminate.z[face]
    local = layer.Q @ (strains[:, :, :3] + z * strains[:, :, 3:6])
    i, j = np.array(STRESS_ORDER).T
    e1, e2 = at.axes[:, :, 0], at.axes[:, :, 1]
    # sigma = s_11 e1 e1^T + s_22 e2 e2^T + s_12 (e1 e2^T + e2 e1^T)
    turn = np.stack(
        [
            e1[..., i] * e1[..., j],
            e2[..., i] * e2[..., j],
            e1[..., i] * e2[..., j] + e2[..., i] * e1[..., j],
        ],
        axis=3,
    )
    return np.asarray(turn @ local)
