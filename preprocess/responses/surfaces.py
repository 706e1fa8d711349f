"""The responses of bodies with surfaces: modes of a band, and the static rest of every node."""

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
    """Modes with their shapes and error at the interfaces, and the compliance H of surfaces."""

    modes: Modes
    shapes: Shapes
    error: float
    H: Array


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
    return SurfaceResponses(modes, shapes, error, surface_compliance(structure, solve, watch))


def require_compliance_room(structure: Structure) -> None:
    """`MemoryShortageError` where the compliance of the surfaces does not fit, or their file."""
    assert structure.surfaces is not None
    rows = structure.surfaces.rows.shape[0]
    H, panels = 8.0 * rows**2, 4.0 * 8.0 * structure.n_u * min(rows, COLUMNS_AT_ONCE)
    needs = {f"the compliance of {rows // 3} nodes of surfaces": 2.0 * H + panels, "its file": H}
    require(needs, "fewer or smaller surfaces, or a coarser mesh there, would do")


def surface_compliance(structure: Structure, solve: Solve, watch: Watch) -> Array:
    """P_S P K^+ P^T P_S^T (3 n, 3 n) [m/N], symmetric; solve: f -> P K^+ f.

    `MeshError` where rounding leaves an asymmetry of more than `MAX_COMPLIANCE_ASYMMETRY`.
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
    if not found <= MAX_COMPLIANCE_ASYMMETRY:
        raise MeshError(
            "the static compliance of the surfaces is not determined: expected a symmetric matrix, "
            f"found differences of {found:.1e} of its diagonal: the body is far too slender for "
            "its mesh, or of materials of many orders of magnitude"
        )
    return 0.5 * (H + H.T)


def _ascending(modes: Modes, shapes: Shapes) -> tuple[Modes, Shapes]:
    """The same modes by their frequencies."""
    order = np.argsort(modes.omega)
    assert shapes.Q is not None
    return (
        replace(modes, omega=modes.omega[order], zeta=modes.zeta[order], phi=modes.phi[:, order]),
        replace(shapes, Q=shapes.Q[:, order]),
    )
