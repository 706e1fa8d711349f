"""From a body file's contents to a superelement."""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib import metadata

from ..superelement import GeneralizedAlpha, Kernel, Modes, Provenance, Superelement, sample_kernel, sha256
from .body import Body
from .errors import MethodError
from .march import march_kernel
from .mesh import read_mesh
from .modal import LIMIT, elastic_modes
from .static import compliance, mobility
from .structure import Structure, assemble_mesh

PACKAGES = ("duhamel", "numpy", "scipy", "scikit-fem", "meshio")


def build(body: Body, progress: bool = False) -> Superelement:
    """The superelement of a body: mesh, finite elements, interfaces, static and impulse responses.

    `progress` shows a bar on the terminal while impulse responses are marched. `PreprocessError` if the body, its mesh
    or its method do not allow it.
    """
    clock = Clock()
    with clock.stage("mesh"):
        mesh = read_mesh(body.mesh)
    with clock.stage("assembly"):
        structure = assemble_mesh(body, mesh)
    with clock.stage("static"):
        H, B = compliance(structure), mobility(structure)
    with clock.stage("impulse"):
        method, kernel, modes = impulse_responses(structure, body, _bar if progress else iter)
    return Superelement(
        name=body.name,
        mass=structure.rigid.mass,
        J_rot=structure.rigid.J_rot,
        center=structure.rigid.center,
        interfaces=structure.interfaces,
        kernel=kernel,
        modes=modes,
        compliance=H,
        mobility=B,
        provenance=Provenance(
            body=body.text,
            mesh=mesh.name,
            mesh_sha256=sha256(body.mesh),
            method=method,
            tolerance=0.0,
            versions={name: metadata.version(name) for name in PACKAGES},
            timings=clock.seconds,
        ),
    )


def impulse_responses(
    structure: Structure, body: Body, track: Callable[[Iterable[int]], Iterable[int]]
) -> tuple[str, Kernel, Modes | None]:
    """The method that was used, the kernel, and the modes if the method has them. The one place that knows methods."""
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
            return method, march_kernel(structure, body.damping, impulse.step, scheme, impulse.steps, track), None
        case _:
            raise MethodError(f"impulse.method {method} is not available yet: use auto, modal or march")


class Clock:
    """Seconds by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - start


def _bar(steps: Iterable[int]) -> Iterable[int]:
    from rich.progress import track

    return track(steps, description="Marching", transient=True)
