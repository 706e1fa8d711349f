"""From a body file's contents to a superelement."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import metadata

import numpy as np

from ..files import in_one_line
from ..files.blas import one_blas_thread
from ..files.memory import available
from ..superelement import Provenance, Rotation, Superelement, Surfaces
from ..superelement.checks import band_rest, eigenvalue_spread, rest_spread
from .assembly.losses import lossy_parts
from .assembly.second_order import SecondOrder, second_order
from .assembly.source import Source
from .assembly.structure import Structure, assemble_on
from .body.body import Body
from .body.measured_body import MeasuredBody
from .body.reading import AnyBody
from .derivatives import design_derivatives
from .errors import MemoryShortageError, MethodError
from .measured.part import build_measured
from .measured.update import read_test, updated, with_rigid, with_test
from .outline import outline_of
from .plausibility import doubts_of_frequencies, doubts_of_source, refused_where_singular
from .progress import Stages, Warn, shown_stages, silent
from .recovery import check_recovery, recover
from .responses.channels import channels_of, of_interfaces
from .responses.impulse import ImpulseResponses, impulse_responses, require_memory
from .responses.static import accelerance, compliance
from .rotation.reduced import reduced_rotation
from .sources.reading import read_source, with_body
from .threads import blas_threads

MIN_INTERFACE_DOFS = 3
STATED_PACKAGES = ("duhamel", "numpy", "scipy", "scikit-fem", "meshio", "rslab")


def assemble(body: Body) -> Structure:
    """The finite element model of a body, from its mesh or matrix files.

    Parameters
    ----------
    body : Body

    Returns
    -------
    Structure
        With the interfaces and masses of the body, in mesh axes and SI units.

    Raises
    ------
    PreprocessError
        Names what the body or its files do not allow.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> structure = assemble(beam.body(step=1e-4))
    >>> structure.n_u, structure.n_c, round(structure.rigid.mass, 3)
    (18, 6, 1.57)
    """
    return assemble_on(body, read_source(body))


def build(
    body: AnyBody, progress: bool = False, on_warning: Warn = silent, told: Warn | None = None
) -> Superelement:
    """The superelement of a body: mesh, finite elements, interfaces, static and impulse responses.

    Of a `MeasuredBody` from its test.

    Parameters
    ----------
    body : Body or MeasuredBody
    progress : bool
        Whether to show on the terminal what is being done and how far it is.
    on_warning : callable
        Called with each doubt about the mesh, the step and the band, as text.
    told : callable, optional
        The former name of on_warning.

    Returns
    -------
    Superelement

    Raises
    ------
    PreprocessError
        Names what the body, its mesh or its method do not allow.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> build(beam.body(step=1e-4))
    <Superelement 'beam': 1.57 kg, at tip, 12 modes>
    """
    require_memory(body.impulse.steps, MIN_INTERFACE_DOFS * len(body.interfaces))
    with (
        memory_shortage_told(),
        refused_where_singular(),
        shown_stages(progress, told or on_warning) as stages,
    ):
        if isinstance(body, MeasuredBody):
            return build_measured(body, stages)
        return _build(body, stages)


@contextmanager
def memory_shortage_told() -> Iterator[None]:
    """`MemoryShortageError` with advice where the machine refuses memory."""
    try:
        yield
    except MemoryShortageError:
        raise
    except MemoryError as error:
        raise MemoryShortageError(
            f"out of memory: {in_one_line(error)}; fewer impulse.steps, fewer interfaces, or a "
            "coarser mesh would do",
            np.inf,
            available(),
        ) from error


def _build(body: Body, stages: Stages) -> Superelement:
    with stages.stage("mesh"):
        source = checked_source(body, stages.warn)
        # The file keeps the body as it was given, without the sensors and the density of the test.
        as_given, test = body, read_test(body)
        if test is not None:
            body = with_test(body, test, source)
            source = with_body(source, body)
    with stages.stage("assembly"), one_blas_thread():  # it has threads of its own
        structure = assemble_on(body, source)
        second = None
        if body.rotation is not None:
            second = second_order(structure, source, body)
            structure = replace(structure, inertia=second.inertia_loads)
        structure = replace(structure, lossy=lossy_parts(body, source))
    with blas_threads(structure.n_u):
        with stages.stage("impulse"):
            responses = impulse_responses(structure.with_channels(), body, stages)
            for doubt in doubts_of_responses(body, responses):
                stages.warn(doubt)
        found = None
        if test is not None:
            responses, found = updated(test, structure, responses, stages.warn)
        derivatives = {}
        if body.derivatives:
            with stages.stage("derivatives"):
                derivatives = design_derivatives(body, structure, responses, stages.warn)
        element = superelement_of(as_given, source, structure, second, responses, stages)
        element = replace(element, derivatives=derivatives)
        return element if test is None or found is None else with_rigid(element, test, found)


def checked_source(body: Body, warn: Warn) -> Source:
    """The source of a body, which has the fields that are to be recovered, with its warnings."""
    source = read_source(body)
    check_recovery(body, source)
    for doubt in doubts_of_source(body, source):
        warn(doubt)
    return source


def superelement_of(
    body: Body,
    source: Source,
    structure: Structure,
    second: SecondOrder | None,
    responses: ImpulseResponses,
    stages: Stages,
) -> Superelement:
    """The superelement of a structure and its impulse responses.

    second: the terms of second order, if asked for.
    """
    with stages.stage("static"):
        # Modes say it without another factorization; and steps start as their modes do, not as the
        # whole mesh would.
        if responses.modes is None:
            wide = structure.with_channels()
            H, B = compliance(wide), accelerance(wide)
        else:
            H, B = responses.modes.compliance, responses.modes.accelerance
    channels = None
    if structure.channels is not None:
        channels = channels_of(structure.channels, structure.n_c, responses, H, B)
        responses, H, B = of_interfaces(structure.n_c, responses, H, B)
    recovery = None
    if body.recovery is not None and responses.shapes is not None:
        with stages.stage("recovery"):
            recovery = recover(body, source, structure, responses.shapes, responses.surface_fields)
    surfaces = _surfaces(structure, responses)
    rotation = None
    if second is not None:
        with stages.stage("rotation"):
            rotation = _rotation(structure, second, responses, body)
    return Superelement(
        name=body.name,
        mass=structure.rigid.mass,
        J_rot=structure.rigid.J_rot,
        center=structure.rigid.center,
        interfaces=structure.interfaces,
        kernel=responses.kernel,
        modes=responses.modes,
        compliance=H,
        accelerance=B,
        recovery=recovery,
        rotation=rotation,
        channels=channels,
        provenance=Provenance(
            body=body.text,
            mesh=_mesh_in_words(body, source),
            mesh_sha256=body.digests,
            method=responses.method,
            tolerance=responses.tolerance,
            versions=_versions(structure.solvers, source),
            timings=stages.seconds,
        ),
        outline=outline_of(source, structure.rigid.center),
        surfaces=surfaces,
    )


def doubts_of_responses(body: Body, responses: ImpulseResponses) -> Iterator[str]:
    """Doubts about a step or band that holds none of the modes, and about an error beyond the
    tolerance.
    """
    modes, found, asked = responses.modes, responses.kernel.error, body.impulse.tolerance
    if modes is not None and len(modes.omega):
        yield from doubts_of_frequencies(body, float(modes.frequencies.min()))
    if responses.method in ("krylov", "lanczos") and found > asked:
        yield (
            f"impulse.tolerance: the stated error is {found:.1e} where {asked:g} was asked for: "
            "the rounding of a stiffness whose elements are far stiffer than the body, as short "
            "ones of a slender body; longer elements would do better"
        )


def _rotation(
    structure: Structure, second: SecondOrder, responses: ImpulseResponses, body: Body
) -> Rotation | None:
    """The second order in the modes of the responses; None where there are none, or none asked."""
    modes, shapes, asked = responses.modes, responses.shapes, body.rotation
    if modes is None or shapes is None or asked is None:
        return None
    return reduced_rotation(structure, second, modes, shapes, asked)


def _surfaces(structure: Structure, responses: ImpulseResponses) -> Surfaces | None:
    """The surfaces with their modes and compliance; `MethodError` where modes leave none of it."""
    patches, H = structure.surfaces, responses.surface_compliance
    if patches is None or H is None or responses.modes is None or responses.shapes is None:
        return None
    surfaces = Surfaces(patches.surfaces, responses.shapes(patches.rows), H)
    band = responses.kernel.band or np.inf
    rest = rest_spread(eigenvalue_spread(band_rest(surfaces, responses.modes, band)))
    if not rest.holds:
        raise MethodError(
            f"impulse.band = {band:g} Hz is too wide for this mesh: beside its modes the "
            f"eigenvalues of the compliance of surfaces spread over {rest.found:.3g}, expected "
            f"{rest.limit:g} at most: lower impulse.band, or refine the mesh"
        )
    return surfaces


def _mesh_in_words(body: Body, source: Source) -> str:
    """The files of mesh or matrices; of CAD the elements that were made of it."""
    names = ", ".join(path.name for path in body.files)
    return names if source.geometry is None else f"{names}: {source.geometry.quality}"


def _versions(solvers: list[str], source: Source) -> dict[str, str]:
    versions = {name: metadata.version(name) for name in STATED_PACKAGES}
    # Of a CAD file: another version of gmsh makes another mesh.
    if source.geometry is not None:
        versions["gmsh"] = source.geometry.gmsh
    if solvers:
        versions["factorization"] = ", ".join(dict.fromkeys(solvers))
    return versions
