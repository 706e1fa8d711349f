"""Rows that read points in shells, and loads that are spread through their thickness."""

from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..elements.laminate import Laminate
from ..elements.shell import Shells
from ..elements.shell_matrices import nodal_strains
from ..elements.shell_shape import TRIANGLE_CORNERS
from ..errors import BodyError
from ..mesh.mesh import IntArray
from ..mesh.nodes import node_dofs, spider
from ..sparse import in_columns
from .shell_faces import LOWER_FACE, UPPER_FACE, MeshOfShells, face_stresses

MAX_STEPS = 30
OUTSIDE_TOLERANCE = 1e-6
"""How far a point may be outside, over the size of the mesh, or in reference coordinates."""
FACE_TOLERANCE = 1e-2
"""Distance from a face, over the thickness, up to which a point is on it."""
MAX_SINE_TO_SURFACE = 1e-2  # of a strain gauge


class ShellPoint(NamedTuple):
    """An element by its type and row, reference coordinates (2, 1), and the height z [m]."""

    kind: str
    row: int
    xi: Array
    z: float


def locate_in_shells(source: MeshOfShells, point: Array) -> ShellPoint:
    """The place in the thickness of an element; `BodyError` for a point that is in none."""
    best: ShellPoint | None = None
    nearest = np.inf
    for kind, shells in source.shells.items():
        heights = _heights(source, kind)
        # All points of an element are in the box of its corners, or as far from it as its faces.
        reach = np.abs(heights).max(axis=1) + 2.0 * OUTSIDE_TOLERANCE * source.mesh.size
        outside = np.maximum(shells.X.min(axis=1) - point, point - shells.X.max(axis=1))
        rows = np.flatnonzero(outside.max(axis=1) <= reach)
        distance = np.linalg.norm(shells.X[rows].mean(axis=1) - point, axis=1)
        for row in rows[np.argsort(distance)].tolist():
            # The element whose middle is nearest need not be the one that has the point.
            xi, z = _projected(shells.some(np.array([row])), point)
            low, high = heights[row]
            beyond = max(low - z, z - high, 0.0) / source.mesh.size
            beyond += _beyond(shells, xi)
            if beyond < nearest:
                best, nearest = ShellPoint(kind, row, xi, z), beyond
            if not beyond:
                break
    if best is None or nearest > OUTSIDE_TOLERANCE:
        raise BodyError(f"expected a point within the thickness of a shell, found {point.tolist()}")
    return best


def _heights(source: MeshOfShells, kind: str) -> Array:
    """Of the lower and the upper face over the nodes (n, 2) [m], of the elements of a type."""
    heights = np.array([laminate.z for laminate in source.laminates.values])
    return np.asarray(heights[source.mesh.of_kind(source.laminates.owners, kind)])


def _laminate(source: MeshOfShells, kind: str, row: int) -> Laminate:
    owner = int(source.mesh.of_kind(source.laminates.owners, kind)[row])
    return source.laminates.values[owner]


def _projected(shell: Shells, point: Array) -> tuple[Array, float]:
    """Reference coordinates (2, 1) and height z, by Newton's method, of x(xi) + z d(xi)."""
    X, d, shape = shell.X[0], shell.d[0], shell.shape
    xi, z = shape.middle.copy(), 0.0
    for _ in range(MAX_STEPS):
        N, dN = shape.N(xi)[:, 0], shape.dN(xi)[:, :, 0]
        at, director = N @ X, N @ d
        J = np.column_stack([((X + z * d).T @ dN), director])
        change = np.linalg.solve(J, point - at - z * director)
        # Far outside a warped element folds, and Newton's method would run away.
        xi = np.clip(xi + change[:2, None], -3.0, 3.0)
        z += float(change[2])
        if np.abs(change[:2]).max() < 1e-12:
            break
    return xi, z


def _beyond(shells: Shells, xi: Array) -> float:
    """How far reference coordinates are outside of the element, 0 within."""
    r, s = xi[:, 0]
    if shells.shape.corners is TRIANGLE_CORNERS:
        return float(max(-r, -s, r + s - 1.0, 0.0))
    return float(max(abs(r) - 1.0, abs(s) - 1.0, 0.0))


def shell_displacement_rows(source: MeshOfShells, point: Array) -> Any:
    """Rows (3, 6 n), sparse: the displacement u + z w x d of a point."""
    place = locate_in_shells(source, point)
    shell = source.shells[place.kind].some(np.array([place.row]))
    N, spun = shell.motion(place.xi)
    k = len(N[0])
    rows = np.zeros((3, k, 6))
    rows[:, :, :3] = np.einsum("k,ij->ikj", N[0], np.eye(3))
    rows[:, :, 3:] = place.z * spun[0, 0]
    return _spread(source, place, rows.reshape(3, -1))


def gauge_rows(source: MeshOfShells, point: Array, direction: Array) -> Any:
    """One row: the strain at a point along a direction (3,) of the surface."""
    place = locate_in_shells(source, point)
    shell = source.shells[place.kind].some(np.array([place.row]))
    strains, at = nodal_strains(shell, _laminate(source, place.kind, place.row), place.xi)
    e1, e2, e3 = at.axes[0, 0]
    if abs(direction @ e3) > MAX_SINE_TO_SURFACE:
        raise BodyError(
            f"direction: expected one along the shell, whose normal is {e3.tolist()}, found "
            f"{direction.tolist()}"
        )
    c, s = direction @ e1, direction @ e2
    row = np.array([c * c, s * s, c * s]) @ (strains[0, 0, :3] + place.z * strains[0, 0, 3:6])
    # A gauge a little off the surface lies on it: its direction there has a length of one.
    return _spread(source, place, row[None] / (c * c + s * s))


def face_stress_rows(source: MeshOfShells, point: Array) -> Any:
    """Rows (6, 6 n), sparse: the stresses at a point of a face, in mesh axes.

    `BodyError` for a point within, where shells know the shear stress across them as a mean alone.
    """
    place = locate_in_shells(source, point)
    laminate = _laminate(source, place.kind, place.row)
    low, high = laminate.z
    face = UPPER_FACE if place.z > 0.5 * (low + high) else LOWER_FACE
    if abs(place.z - laminate.z[face]) > FACE_TOLERANCE * (high - low):
        raise BodyError(
            f"stress: expected a point on a face of the shell, {low:g} or {high:g} m from its "
            f"nodes along the normal, found {place.z:.3g} m"
        )
    shell = source.shells[place.kind].some(np.array([place.row]))
    strains, at = nodal_strains(shell, laminate, place.xi)
    return _spread(source, place, face_stresses(laminate, face, strains, at)[0, 0])


def _spread(source: MeshOfShells, place: ShellPoint, rows: Array) -> Any:
    """Rows (r, 6 n) from those by the dofs of one element."""
    columns = node_dofs(source.mesh.cells[place.kind][place.row][None], 6)[0]
    return sp.csr_array(in_columns(rows, columns, 6 * len(source.mesh.points)))


def volume_loads(source: MeshOfShells, group: str | None, density: Array) -> Array:
    """Forces and moments (n_points, 6) of a force per volume (3,) in shells of a group, or in all.

    f_i = int N_i t dA density,   moments d_i x int N_i s dA density,   t, s = int (1, z) dz
    """
    if group is None:
        return _middle_loads(source, np.arange(source.mesh.n_elements), density, through=True)
    if not len(members := source.mesh.members(group)):
        raise BodyError(f"group {group!r}: expected shells, found none")
    return _middle_loads(source, members, density, through=True)


def traction_loads(source: MeshOfShells, elements: IntArray, traction: Array) -> Array:
    """Forces and moments (n_points, 6) of a traction (3,) in the middle of the thickness.

    f_i = int N_i dA traction,   moments z d_i x f_i,   z: the height of the middle
    """
    return _middle_loads(source, elements, traction, through=False)


def _middle_loads(source: MeshOfShells, elements: IntArray, load: Array, through: bool) -> Array:
    """Of a load per area, or `through` the thickness per volume, on some elements."""
    total = np.zeros((len(source.mesh.points), 6))
    chosen = np.zeros(source.mesh.n_elements, dtype=np.int64)
    chosen[elements] = 1
    for kind, shells in source.shells.items():
        rows = np.flatnonzero(source.mesh.of_kind(chosen, kind))
        some = shells.some(rows)
        low, high = _heights(source, kind)[rows].T
        xi = some.shape.xi
        areas = (some.frames(xi).areas * some.shape.weights) @ some.shape.N(xi).T
        extent = (high - low)[:, None] * areas if through else areas
        forces = extent[..., None] * load
        arms = 0.5 * (low + high)[:, None, None] * some.d
        turning = spider(arms.reshape(-1, 3)).transpose(0, 2, 1)[:, 3:]
        moments = np.einsum("nij,nj->ni", turning, forces.reshape(-1, 3))
        loads = np.concatenate([forces.reshape(-1, 3), moments], axis=1)
        np.add.at(total, source.mesh.cells[kind][rows].ravel(), loads)
    return total
