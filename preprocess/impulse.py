"""The choice of the method that computes impulse responses. The one place that knows the methods."""

from dataclasses import dataclass

from ..superelement import GeneralizedAlpha, Kernel, Modes, sample_kernel
from .body import Body
from .errors import MethodError
from .march import Track, march_kernel
from .modal import LIMIT, Shapes, elastic_shapes
from .structure import Structure


@dataclass(frozen=True, eq=False)
class ImpulseResponses:
    """The method that was used and what it found: a kernel, and modes with their shapes if the method has them.

    shapes(rows) with sparse rows (k, n_u) is rows @ phi (k, m), the mode shapes of any dofs or of what is linear in
    them; only what is asked for is formed.
    """

    method: str
    kernel: Kernel
    modes: Modes | None = None
    shapes: Shapes | None = None


def impulse_responses(structure: Structure, body: Body, track: Track = iter) -> ImpulseResponses:
    """The impulse responses that a body asks for, by the method it names or, with "auto", the one that fits its size.

    `MethodError` where the method does not allow what is asked.
    """
    impulse = body.impulse
    scheme = GeneralizedAlpha(impulse.rho_inf)
    method = impulse.method
    if method == "auto":
        method = "modal" if structure.n_u <= LIMIT else "march"
    match method:
        case "modal":
            modes, shapes = elastic_shapes(structure, body.damping)
            return ImpulseResponses(method, sample_kernel(modes, impulse.step, scheme, impulse.steps), modes, shapes)
        case "march":
            kernel = march_kernel(structure, body.damping, impulse.step, scheme, impulse.steps, track)
            return ImpulseResponses(method, kernel)
        case _:
            raise MethodError(f"impulse.method {method} is not available yet: use auto, modal or march")
