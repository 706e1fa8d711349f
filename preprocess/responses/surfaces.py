"""The responses of bodies with surfaces: modes of a band, and the static rest of every node."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..errors import MeshError
from ..memory import require
from ..solving.factor import Solve
from .krylov import KrylovSpace
from .lanczos import modes_up_to
from .search import Request, Watch, modes_in
from .shapes import Shapes
from .static import refined, slow_chain, static_solver

COLUMNS_AT_ONCE = 150  # of the compliance, lest solutions of all of them take memory too
MAX_UNREFINED = 1e-10  # change of the compliance by a step of refinement, over its largest entry
MAX_COMPLIANCE_ASYMMETRY = 1e-8  # of the compliance, relative to its diagonal: its error


@dataclass(frozen=True, eq=False)
class SurfaceResponses:
    """Modes with their shapes and error at the interfaces, and the compliance H of surfaces.

    fields: the static rest of `Patches.fields`, beyond the modes, to forces on surfaces.
    """

    modes: Modes
    shapes: Shapes
    error: float
    H: Array
    fields: Array


def surface_responses(request: Request) -> SurfaceResponses:
    """The modes of a body with surfaces, and the compliance H of these.

        V = [modes of the free body in the band, K^+ F, K^+ M K^+ F, ...],    H = P_S K^+ P_S^T

    with F the loads of interfaces, channels and rotation. What V leaves out of static responses
    to F is zero, so that F alone never meets the static rest H - phi omega^-2 phi^T of surfaces.
    Blocks are added until interfaces are right to the tolerance, as the method krylov has them. One
    factor of K, with six dofs held, serves all of it. Source: docs/theory.md, Surfaces.
    """
    structure, watch = request.structure, request.watch
    require_compliance_room(structure)
    solve = static_solver(structure)
    normal = modes_up_to(structure, solve, 2.0 * np.pi * request.band.limit, watch)
    space = KrylovSpace(
        structure, 0.0, solver=lambda *_: partial(refined, structure, solve), known=normal
    )
    chain = slow_chain(structure, solve)
    modes, shapes, error = modes_in(request, space, chain)
    modes, shapes = _ascending(modes, shapes)
    H, fields = static_responses(structure, solve, modes, shapes, watch)
    return SurfaceResponses(modes, shapes, error, H, fields)


def require_compliance_room(structure: Structure) -> None:
    """`MemoryShortageError` where the compliance of the surfaces does not fit, or their file."""
    assert structure.surfaces is not None
    patches = structure.surfaces
    rows = patches.rows.shape[0]
    H, panels = 8.0 * rows**2, 4.0 * 8.0 * structure.n_u * min(rows, COLUMNS_AT_ONCE)
    needs = {f"the compliance of {rows // 3} nodes of surfaces": 2.0 * H + panels, "its file": H}
    if values := patches.fields.shape[0]:
        # In single precision, rounded, and as the superelement has them.
        needs["the fields of forces on them"] = 16.0 * rows * values
    require(needs, "fewer or smaller surfaces, or a coarser mesh there, would do")


def static_responses(
    structure: Structure, solve: Solve, modes: Modes, shapes: Shapes, watch: Watch
) -> tuple[Array, Array]:
    """P_S P K^+ P^T P_S^T (3 n, 3 n) [m/N], symmetric, and the rest of fields P_F (k, 3 n).

        H_FS - phi_F diag(1 / omega^2) phi_S^T

    solve: f -> P K^+ f. The rest is in single precision, as files keep it. `MeshError` where
    rounding leaves an asymmetry of more than `MAX_COMPLIANCE_ASYMMETRY`.
    """
    patches = structure.surfaces
    assert patches is not None
    n = patches.rows.shape[0]
    H = np.empty((n, n))
    fields = np.empty((patches.fields.shape[0], n), dtype=np.float32)
    by_modes, phi = shapes(patches.fields) / modes.omega**2, shapes(patches.rows)
    for columns, u in _static_solutions(structure, solve, watch):
        H[:, columns] = patches.rows @ u
        fields[:, columns] = patches.fields @ u - by_modes @ phi[columns].T
    scale = np.sqrt(H.diagonal())
    found = float((np.abs(H - H.T) / np.outer(scale, scale)).max())
    if not found <= MAX_COMPLIANCE_ASYMMETRY:
        raise MeshError(
            "the static compliance of the surfaces is not determined: expected a symmetric matrix, "
            f"found differences of {found:.1e} of its diagonal: the body is far too slender for "
            "its mesh, or of materials of many orders of magnitude"
        )
    return 0.5 * (H + H.T), fields


def _static_solutions(
    structure: Structure, solve: Solve, watch: Watch
) -> Iterator[tuple[slice, Array]]:
    """Static displacements (n_u, k) by unit forces on nodes of surfaces, some at once."""
    assert structure.surfaces is not None
    rows, changes = structure.surfaces.rows, True
    n = rows.shape[0]
    for start in range(0, n, COLUMNS_AT_ONCE):
        columns = slice(start, min(start + COLUMNS_AT_ONCE, n))
        watch(f"static rest, {start} of {n} columns")
        loads = structure.relieve(rows[columns].T.toarray())
        u = solve(loads)
        if changes:
            correction = solve(loads - structure.K @ u)
            u = u + correction
            # What refinement does not change in the first columns, it need not refine in others.
            change, size = np.abs(rows @ correction).max(), np.abs(rows @ u).max()
            changes = change > MAX_UNREFINED * size
        yield columns, u


def _ascending(modes: Modes, shapes: Shapes) -> tuple[Modes, Shapes]:
    """The same modes by their frequencies."""
    order = np.argsort(modes.omega)
    assert shapes.Q is not None
    return (
        replace(modes, omega=modes.omega[order], zeta=modes.zeta[order], phi=modes.phi[:, order]),
        replace(shapes, Q=shapes.Q[:, order]),
    )
