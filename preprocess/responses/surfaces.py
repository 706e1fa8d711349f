"""The responses of bodies with surfaces: modes of a band, and the static rest of every node."""

from dataclasses import dataclass, replace

import numpy as np

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import RIGID_DOFS, Structure
from ..body.damping import Damping
from ..errors import MeshError
from ..memory import require
from ..solving.factor import Solve
from .band import Band
from .basis import Basis
from .condensation import condensed
from .damping import damped_modes
from .lanczos import modes_up_to
from .ritz import ritz_modes, space_shapes
from .search import CHANGE_FACTOR, CONDENSATION_ERROR_SHARE, OF_FIELDS, Watch, only
from .shapes import Shapes
from .static import refined, static_solver

COLUMNS_AT_ONCE = 150  # of the compliance, lest solutions of all of them take memory too
MAX_BLOCKS = 40  # of responses at interfaces beside the modes of the band
MAX_UNREFINED = 1e-10  # change of the compliance by a step of refinement, over its largest entry
MAX_ASYMMETRY = 1e-8  # of the compliance, relative to its diagonal: its error


@dataclass(frozen=True, eq=False)
class SurfaceResponses:
    """Modes with their shapes and error at the interfaces, and the compliance H of surfaces."""

    modes: Modes
    shapes: Shapes
    error: float
    H: Array


def surface_responses(
    structure: Structure,
    damping: Damping,
    band: Band,
    tolerance: float,
    watch: Watch,
    fields: bool = False,
) -> SurfaceResponses:
    """The modes of a body with surfaces, and the compliance H of these.

        V = [modes of the free body in the band, K^+ F, K^+ M K^+ F, ...],    H = P_S K^+ P_S^T

    with F the loads of interfaces, channels and rotation. What V leaves out of static responses
    to F is zero, so that F alone never meets the static rest H - phi omega^-2 phi^T of surfaces.
    Blocks are added until interfaces are right to the tolerance, as the method krylov has them. One
    factor of K, with six dofs held, serves all of it. Source: docs/theory.md, Surfaces.
    """
    assert structure.surfaces is not None
    require_room(structure)
    solve = static_solver(structure)
    normal = modes_up_to(structure, solve, 2.0 * np.pi * band.limit, watch)
    modes, shapes, error = _with_interfaces(
        structure, solve, damping, band, tolerance, normal, watch, fields
    )
    return SurfaceResponses(modes, shapes, error, surface_compliance(structure, solve, watch))


def require_room(structure: Structure) -> None:
    """`MemoryShortageError` where the compliance of the surfaces does not fit, or their file."""
    assert structure.surfaces is not None
    rows = structure.surfaces.rows.shape[0]
    H, panels = 8.0 * rows**2, 4.0 * 8.0 * structure.n_u * min(rows, COLUMNS_AT_ONCE)
    needs = {f"the compliance of {rows // 3} nodes of surfaces": 2.0 * H + panels, "its file": H}
    require(needs, "fewer or smaller surfaces, or a coarser mesh there, would do")


def surface_compliance(structure: Structure, solve: Solve, watch: Watch) -> Array:
    """P_S P K^+ P^T P_S^T (3 n, 3 n) [m/N], symmetric; solve: f -> P K^+ f.

    `MeshError` where rounding leaves an asymmetry of more than `MAX_ASYMMETRY`.
    """
    assert structure.surfaces is not None
    rows = structure.surfaces.rows
    n = rows.shape[0]
    H, changes = np.empty((n, n)), True
    for start in range(0, n, COLUMNS_AT_ONCE):
        columns = slice(start, min(start + COLUMNS_AT_ONCE, n))
        watch(f"static rest, {start} of {n} columns")
        loads = structure.relieve(rows[columns].T.toarray())
        u = solve(loads)
        H[:, columns] = rows @ u
        if changes:
            correction = rows @ solve(loads - structure.K @ u)
            H[:, columns] += correction
            # What refinement does not change in the first columns, it need not refine in others.
            changes = np.abs(correction).max() > MAX_UNREFINED * np.abs(H[:, columns]).max()
    scale = np.sqrt(H.diagonal())
    found = float((np.abs(H - H.T) / np.outer(scale, scale)).max())
    if not found <= MAX_ASYMMETRY:
        raise MeshError(
            "the static compliance of the surfaces is not determined: expected a symmetric matrix, "
            f"found differences of {found:.1e} of its diagonal: the body is far too slender for "
            "its mesh, or of materials of many orders of magnitude"
        )
    return 0.5 * (H + H.T)


def _with_interfaces(
    structure: Structure,
    solve: Solve,
    damping: Damping,
    band: Band,
    tolerance: float,
    normal: Array,
    watch: Watch,
    fields: bool,
) -> tuple[Modes, Shapes, float]:
    """The modes of the space with responses at interfaces, their shapes, and their error there."""
    loads = np.hstack([structure.loads, structure.inertia_loads])
    most = RIGID_DOFS + normal.shape[1] + MAX_BLOCKS * loads.shape[1]
    basis = Basis(structure, min(most, structure.n_u))
    basis.extend(structure.U)
    basis.extend(normal)
    found = _Found.of(structure, damping, band, basis)
    if not loads.shape[1]:
        return found.modes, found.shapes, 0.0
    W, error = refined(structure, solve, loads), 0.0
    for block in range(MAX_BLOCKS):
        if not (new := basis.extend(W)):
            break
        before, found = found, _Found.of(structure, damping, band, basis)
        error = CHANGE_FACTOR * found.change(before, band, fields)
        watch(f"{len(found.modes.omega)} modes, {block + 1} blocks, error {error:.1e}")
        if error <= (1.0 - CONDENSATION_ERROR_SHARE) * tolerance:
            break
        W = solve(structure.M @ basis.V[:, basis.columns - new :])
    share = CONDENSATION_ERROR_SHARE * tolerance * (OF_FIELDS if fields else 1.0)
    few = condensed(found.modes, damping, band, share, fields, found.with_rotation.phi)
    order = np.argsort(few.modes.omega)
    modes = only(few.modes, order)
    return modes, space_shapes(basis, found.Q @ few.Y[:, order]), error + few.error


@dataclass(frozen=True, eq=False)
class _Found:
    """Modes of a space, their coordinates Q (r, m) and shapes; with loads of rotation as well."""

    modes: Modes
    Q: Array
    shapes: Shapes
    with_rotation: Modes

    @classmethod
    def of(cls, structure: Structure, damping: Damping, band: Band, basis: Basis) -> "_Found":
        V = basis.V[:, RIGID_DOFS:]
        omega, Q = np.zeros(0), np.zeros((0, 0))
        if V.shape[1]:
            omega, Q = ritz_modes(structure, V, V.T @ (structure.K @ V))
        shapes = space_shapes(basis, Q)
        modes = damped_modes(damping, omega, shapes(structure.P_C), band.finest_step)
        turned = structure.inertia_loads.T @ V @ Q
        return cls(modes, Q, shapes, replace(modes, phi=np.vstack([modes.phi, turned])))

    def change(self, before: "_Found", band: Band, fields: bool) -> float:
        """The largest difference from the modes before: at interfaces, of fields, of rotation."""
        found = 0.0
        if len(self.modes.phi):
            found = band.error(before.modes, self.modes)
            if fields:
                turn = self.Q[: len(before.Q)].T @ before.Q
                found = max(found, band.field_error(before.modes, self.modes, turn))
        if len(self.with_rotation.phi) > len(self.modes.phi):
            found = max(found, band.slow_error(before.with_rotation, self.with_rotation))
        return found
