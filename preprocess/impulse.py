"""The choice of the method that computes impulse responses. The one place that knows the methods."""

from ..superelement import GeneralizedAlpha, Kernel, Modes, sample_kernel
from .body import Body
from .errors import MethodError
from .march import Track, march_kernel
from .modal import LIMIT, elastic_modes
from .structure import Structure


def impulse_responses(structure: Structure, body: Body, track: Track = iter) -> tuple[str, Kernel, Modes | None]:
    """The method that was used, the kernel, and the modes if the method has them."""
    impulse = body.impulse
    scheme = GeneralizedAlpha(impulse.rho_inf)
    method = impulse.method
    if method == "auto":
        method = "modal" if structure.n_u <= LIMIT else "march"
    match method:
        case "modal":
            modes = elastic_modes(structure, body.damping)
            return method, sample_kernel(modes, impulse.step, scheme, impulse.steps), modes
        case "march":
            kernel = march_kernel(structure, body.damping, impulse.step, scheme, impulse.steps, track)
            return method, kernel, None
        case _:
            raise MethodError(f"impulse.method {method} is not available yet: use auto, modal or march")
