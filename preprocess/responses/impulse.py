"""Impulse responses by the method that a body file names or its size suggests."""

from dataclasses import dataclass, replace

from ...superelement import GeneralizedAlpha, Kernel, Modes, sample_kernel
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.body import Body
from ..body.loss import damping_of
from ..memory import require
from ..progress import Stages
from ..solving.solver import SolverFactory, solver_of
from .band import Band
from .losses import with_losses
from .march import march_kernel
from .modal import FULL_MODAL_UNKNOWNS, elastic_shapes
from .search import Request, krylov_modes
from .shapes import Shapes
from .surfaces import surface_responses
from .truncated import REDUCTION_METHODS, TRUNCATION_ERROR, truncated_modes


@dataclass(frozen=True, eq=False)
class ImpulseResponses:
    """The method used, its kernel, and modes with their shapes if the method has them.

    shapes(rows) with sparse rows (k, n_u) is rows @ phi (k, m), the mode shapes of any dofs or of
    what is linear in them; only what is asked for is formed.
    """

    method: str
    kernel: Kernel
    modes: Modes | None = None
    shapes: Shapes | None = None
    tolerance: float = 0.0
    """the error asked of the method; 0 where it is exact"""
    surface_compliance: Array | None = None
    """H (3 n, 3 n) of the nodes of surfaces, None where there are none"""
    surface_fields: Array | None = None
    """static rest of `Patches.fields` to forces on these nodes"""


def require_memory(steps: int, n_c: int) -> None:
    """`MemoryShortageError` for more lags of n_c interface dofs than memory holds.

    g and g_initial, and once more the file, which is made in memory.
    """
    lags = 2.0 * 8.0 * (steps + 1.0) * n_c**2
    needs = {f"impulse.steps = {steps} on {n_c} interface dofs": lags, "their file": lags}
    require(needs, "fewer steps, or fewer interfaces, would do")


def impulse_responses(
    structure: Structure, body: Body, stages: Stages | None = None
) -> ImpulseResponses:
    """The impulse responses of a body, by the method that it names or the one for its size.

    `stages` shows how far it is. `MethodError` where the method does not allow what is asked.
    """
    stages = stages or Stages()
    impulse, damping = body.impulse, damping_of(body)
    # Again, now with channels: before them only the interfaces were known.
    require_memory(impulse.steps, structure.P_C.shape[0])
    h, scheme, steps = impulse.step, GeneralizedAlpha(impulse.rho_inf), impulse.steps
    if structure.surfaces is not None:
        return _with_surfaces(structure, body, stages)
    method = impulse.method
    if method == "auto":
        method = "modal" if structure.n_u <= FULL_MODAL_UNKNOWNS else "krylov"
    match method:
        case "modal":
            modes, shapes = elastic_shapes(structure, damping)
            modes = with_losses(body, structure, modes, shapes)
            return ImpulseResponses(method, sample_kernel(modes, h, scheme, steps), modes, shapes)
        case "krylov":
            return krylov_responses(body, *krylov_found(structure, body, stages))
        case "craig-bampton" | "rubin":
            return _truncated(structure, body, stages)
        case "march":
            return ImpulseResponses(
                method, march_kernel(structure, damping, h, scheme, steps, stages.track)
            )


def krylov_found(
    structure: Structure, body: Body, stages: Stages, solver: SolverFactory | None = None
) -> tuple[Modes, Shapes, float]:
    """The modes that the method krylov finds, their shapes, and their error.

    solver: another than the body asks for.
    """
    request = replace(_request(structure, body, stages), solver=solver or solver_of(body.solver))
    modes, shapes, error = krylov_modes(request)
    return with_losses(body, structure, modes, shapes), shapes, error


def krylov_responses(body: Body, modes: Modes, shapes: Shapes, error: float) -> ImpulseResponses:
    """The impulse responses of modes that the method krylov has found."""
    band = band_of(body)
    kernel = sample_kernel(modes, band.h, band.scheme, body.impulse.steps, error, band.limit)
    return ImpulseResponses("krylov", kernel, modes, shapes, body.impulse.tolerance)


def band_of(body: Body) -> Band:
    """The band in which the modes of the method krylov are to be right."""
    impulse = body.impulse
    scheme, limit = GeneralizedAlpha(impulse.rho_inf), impulse.band or 0.25 / impulse.step
    return Band(impulse.step, scheme, limit)


def _request(structure: Structure, body: Body, stages: Stages) -> Request:
    """The modes that a body file asks for."""
    return Request(
        structure,
        damping_of(body),
        band_of(body),
        body.impulse.tolerance,
        fields=body.recovery is not None,
        watch=stages.report,
    )


def _with_surfaces(structure: Structure, body: Body, stages: Stages) -> ImpulseResponses:
    """Those of a body with surfaces, right at the interfaces in the band."""
    request, impulse = _request(structure, body, stages), body.impulse
    wide = request.band
    # Of steps finer than those of the band only the band is right: modes end with it.
    band = replace(wide, h=max(wide.h, 0.25 / wide.limit))
    found = surface_responses(replace(request, band=band))
    modes = with_losses(body, structure, found.modes, found.shapes)
    kernel = sample_kernel(modes, wide.h, wide.scheme, impulse.steps, found.error, wide.limit)
    return ImpulseResponses(
        "lanczos", kernel, modes, found.shapes, impulse.tolerance, found.H, found.fields
    )


def _truncated(structure: Structure, body: Body, stages: Stages) -> ImpulseResponses:
    """Those of a number of modes, with the band in which they are right."""
    impulse, count = body.impulse, body.impulse.modes or 0
    request = replace(_request(structure, body, stages), tolerance=TRUNCATION_ERROR)
    reduction = REDUCTION_METHODS[impulse.method](structure, request.damping, count)
    found = truncated_modes(request, reduction)
    modes = with_losses(body, structure, found.modes, found.shapes)
    scheme = request.band.scheme
    kernel = sample_kernel(modes, impulse.step, scheme, impulse.steps, found.error, found.limit)
    method = f"{impulse.method} with {count} {'modes' if count > 1 else 'mode'}"
    return ImpulseResponses(method, kernel, modes, found.shapes, TRUNCATION_ERROR)
