"""From a body file's contents to a superelement."""

from importlib import metadata

from ..superelement import GeneralizedAlpha, Kernel, Modes, Provenance, Superelement, sample_kernel, sha256
from .body import Body
from .errors import MethodError
from .march import march_kernel
from .mesh import read_mesh
from .modal import LIMIT, elastic_modes
from .progress import Stages, shown_stages
from .static import compliance, mobility
from .structure import Structure, assemble_mesh

PACKAGES = ("duhamel", "numpy", "scipy", "scikit-fem", "meshio")


def build(body: Body, progress: bool = False) -> Superelement:
    """The superelement of a body: mesh, finite elements, interfaces, static and impulse responses.

    `progress` shows on the terminal what is being done and, while impulse responses are marched, how far it is.
    `PreprocessError` if the body, its mesh or its method do not allow it.
    """
    with shown_stages(progress) as stages:
        return _build(body, stages)


def _build(body: Body, stages: Stages) -> Superelement:
    with stages.stage("mesh"):
        mesh = read_mesh(body.mesh)
    with stages.stage("assembly"):
        structure = assemble_mesh(body, mesh)
    with stages.stage("static"):
        H, B = compliance(structure), mobility(structure)
    with stages.stage("impulse"):
        method, kernel, modes = impulse_responses(structure, body, stages)
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
            timings=stages.seconds,
        ),
    )


def impulse_responses(structure: Structure, body: Body, stages: Stages) -> tuple[str, Kernel, Modes | None]:
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
            kernel = march_kernel(structure, body.damping, impulse.step, scheme, impulse.steps, stages.track)
            return method, kernel, None
        case _:
            raise MethodError(f"impulse.method {method} is not available yet: use auto, modal or march")
