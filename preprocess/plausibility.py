"""What is unlike any part that is built, most often by a wrong unit: told; refused if singular."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

import numpy as np
from scipy.sparse.linalg import ArpackError

from ..files import in_one_line
from ..superelement.validation import Array
from .assembly.source import MeshSource, Source
from .body.body import Body
from .body.material import Material, Section
from .body.measured_body import MeasuredBody
from .body.reading import AnyBody
from .errors import MethodError
from .mesh.mesh import Mesh

SOUND_SPEEDS = (20.0, 30_000.0)  # [m/s]: soft rubber, and twice that of beryllium
SOLID_DENSITIES = (9.0, 25_000.0)  # [kg/m^3]: foams, and osmium
MAX_YOUNGS_MODULUS = 1.3e12  # [Pa], above that of diamond
PART_SIZE = (1e-5, 100.0)  # [m]
MAX_BENDING_EXCESS = 1.05  # energy of bent elements over that of pure bending
MAX_DAMPING_RATIO = 0.5  # above which it may be in per cent
MAX_SECTION_DEPTH = 0.5  # radius of gyration of a section over the size of its mesh
POLAR_INERTIA_RATIOS = (0.01, 100.0)  # to that of a homogeneous section of the same EI and EA
MAX_TORSION_RATIO = 10.0
"""GJ over EI_y + EI_z; 1 / (2 (1 + nu)) at most where one isotropic material fills the section."""
SHELL_THICKNESSES = (1e-5, 0.3)  # over the size of the mesh
MAX_PIECE_RADIUS = 30.0  # of gyration of a rigid piece, over the size of the mesh
MIN_SHAPE = 0.05
"""Of a tetrahedron, 3 times the radius of its inscribed over that of its circumscribed sphere."""
MAX_VOLUME_DIFFERENCE = 2e-3
"""Of a mesh and its solid of CAD, relative; curved edges keep that of a cylinder to 5e-5."""
MIN_WAVE_SPACINGS = 0.01  # below which the waves of a step are nothing on this mesh


@contextmanager
def refused_where_singular() -> Iterator[None]:
    """`MethodError` for numbers that lie too far apart for the solvers of a body's matrices.

    What overflows on the way is found in the numbers that it makes.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            yield
    except (np.linalg.LinAlgError, ArpackError) as error:
        raise MethodError(
            f"numbers of the body lie too far apart for its matrices: {in_one_line(error)}"
        ) from error


def doubts_of_body(body: AnyBody) -> Iterator[str]:
    """Doubts about materials, sections, damping and the rotation of matrices, each by its key.

    Parameters
    ----------
    body : Body

    Yields
    ------
    str
        The key, its value and what is unlike any part, with the unit that may be wrong.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e3, nu=0.3, rho=7.85e-9)
    >>> cube = du.Part(([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]), steel)
    >>> cube.interface("tip", (1, 0, 0))
    >>> [doubt.split()[0] for doubt in doubts_of_body(cube.body(step=1e-4))]
    ['material.rho', 'material.E']
    """
    if isinstance(body, MeasuredBody):
        return  # which has neither materials nor sections
    if body.material is not None:
        yield from _of_material("material", body.material)
    for key, section in _sections(body):
        yield from _of_section(key, section)
    for group, material in body.materials.items():
        yield from _of_material(f"materials.{group}", material)
    yield from _of_damping(body)
    if body.rotation is not None and body.matrices is not None and body.material is None:
        yield (
            "rotation: [matrices] know no stiffening: slender bodies, as blades, soften as they "
            "turn where they would stiffen; good for stretch, and for the whirl of stiff rotors "
            "and shafts well below their first frequency"
        )


def doubts_of_source(body: Body, source: Source) -> Iterator[str]:
    """Doubts about the mesh of a body; none of matrices."""
    if body.matrices is None:
        on_mesh = cast(MeshSource, source)
        yield from doubts_of_mesh(on_mesh.mesh)
        yield from doubts_on_mesh(body, on_mesh)


def doubts_of_mesh(mesh: Mesh) -> Iterator[str]:
    """Doubts about the size of a mesh, and the elements that were made of a CAD file."""
    if not PART_SIZE[0] <= mesh.size <= PART_SIZE[1]:
        unit = "millimeters (scale = 1e-3)" if mesh.size > PART_SIZE[1] else "meters (no scale)"
        yield (
            f"the mesh is {mesh.size:.4g} m large, parts are {PART_SIZE[0]:g} to {PART_SIZE[1]:g} "
            f"m: are its coordinates in {unit}?"
        )
    if mesh.geometry is not None and mesh.geometry.quality.worst_shape < MIN_SHAPE:
        yield (
            f"the flattest tetrahedron has a shape of {mesh.geometry.quality.worst_shape:.2g}, "
            f"expected {MIN_SHAPE:g} or more: a smaller size, or one on small faces "
            "([sizes.NAME])"
        )


def doubts_on_mesh(body: Body, source: MeshSource) -> Iterator[str]:
    """Doubts about what needs mesh and body file: elements that lock, sections, rigid pieces, the
    step and the band.
    """
    size = source.mesh.size
    yield from _of_volume(source)
    yield from _of_locking(source)
    for key, section in _sections(body):
        yield from _of_depth(key, section, size)
    for key, shell in body.shells_by_key.items():
        yield from _of_thickness(key, shell.total, size)
    for name, piece in body.masses.items():
        yield from _of_piece(f"masses.{name}", piece.mass, np.array(piece.inertia), size)
    step = body.impulse.step
    fastest = source.resolution(0.5 / step)
    if fastest.nodes < MIN_WAVE_SPACINGS:
        yield (
            f"impulse.step = {step:g} s: the shortest wave that it follows is {fastest.nodes:.3g} "
            f"of the spacing of the nodes, expected {MIN_WAVE_SPACINGS:g} or more: "
            "nothing on this mesh is so fast"
        )
    if body.impulse.band is not None:
        wave = source.resolution(body.impulse.band)
        if wave.nodes < wave.needed:
            yield (
                f"impulse.band = {body.impulse.band:g} Hz: {wave.nodes:.2g} nodes in the shortest "
                f"wave, expected {wave.needed} or more: a finer mesh or a lower band"
            )


def doubts_of_frequencies(body: Body, first: float) -> Iterator[str]:
    """Doubts about a step or band that holds no elastic mode.   first: elastic frequency [Hz]"""
    step, band = body.impulse.step, body.impulse.band
    if first > 0.5 / step:
        yield (
            f"impulse.step = {step:g} s: its Nyquist frequency, {0.5 / step:.4g} Hz, is below the "
            f"first elastic frequency, {first:.4g} Hz when free: expected {0.05 / first:.2g} s or "
            "less"
        )
    elif band is not None and band < first:
        yield (
            f"impulse.band = {band:g} Hz is below the first elastic frequency, {first:.4g} Hz: "
            "nothing in it vibrates"
        )


def _sections(body: Body) -> Iterator[tuple[str, Section]]:
    """All sections by key."""
    if body.section is not None:
        yield "section", body.section
    for group, section in body.sections.items():
        yield f"sections.{group}", section


def _of_volume(source: MeshSource) -> Iterator[str]:
    if source.geometry is None:
        return
    found, expected = sum(share.extent for share in source.shares()), source.geometry.volume
    difference = found / expected - 1.0
    if abs(difference) > MAX_VOLUME_DIFFERENCE:
        yield (
            f"the mesh has a volume of {found:.4g} m^3, {100.0 * difference:+.2g} % beside the "
            f"{expected:.4g} m^3 of the CAD solid: elements are too large for its curved faces, or "
            "faces and edges of the file do not fit each other: try a smaller size, and repair "
            "the part in the CAD program if the difference stays"
        )


def _of_locking(source: MeshSource) -> Iterator[str]:
    excess = source.bending_excess()
    if excess > MAX_BENDING_EXCESS:
        yield (
            f"these elements are too stiff in bending: deflections are about {1.0 / excess:.2g} "
            "of what they should be; use elements with nodes on their edges (order = 2 makes them "
            "of tetrahedra and wedges), or hexahedra with right angles"
        )
    if source.stiff_in_volume():
        yield (
            "four-node tetrahedra and wedges are too stiff for a nearly incompressible material, "
            "by a factor: use hexahedra, or tetrahedra with ten nodes (order = 2)"
        )


def _of_material(key: str, material: Material) -> Iterator[str]:
    if not SOLID_DENSITIES[0] <= material.rho <= SOLID_DENSITIES[1]:
        yield (
            f"{key}.rho = {material.rho:g} kg/m^3 is not that of a solid, "
            f"{SOLID_DENSITIES[0]:g} to {SOLID_DENSITIES[1]:g}: is it in t/mm^3 or g/cm^3?"
        )
    stiffest = float(np.max(material.E))
    if stiffest > MAX_YOUNGS_MODULUS:
        yield f"{key}.E = {stiffest:g} Pa is above that of diamond, 1.2e12: is it in other units?"
    # The softest direction: stiff fibers alone are no sign of a wrong unit.
    E = float(np.min(material.E))
    yield from _of_sound(f"{key}.E = {E:g} Pa", float(np.sqrt(E / material.rho)))


def _of_section(key: str, section: Section) -> Iterator[str]:
    speed = float(np.sqrt(section.EA / section.mass_per_length))
    yield from _of_sound(f"{key}.EA = {section.EA:g} N", speed)
    if section.EI_y != section.EI_z and section.orientation is None:
        yield (
            f"{key}: EI_y and EI_z differ, and without {key}.orientation local y is horizontal: "
            "does the dry run show it where it should be?"
        )
    polar = section.mass_per_length * (section.EI_y + section.EI_z) / section.EA
    ratio = section.polar_inertia_per_length / polar
    if not POLAR_INERTIA_RATIOS[0] <= ratio <= POLAR_INERTIA_RATIOS[1]:
        yield (
            f"{key}.polar_inertia_per_length = {section.polar_inertia_per_length:g} kg m is "
            f"{ratio:.2g} times that of a homogeneous section of this EI and EA, {polar:.3g}"
        )
    torsion = section.GJ / (section.EI_y + section.EI_z)
    if torsion > MAX_TORSION_RATIO:
        yield (
            f"{key}.GJ = {section.GJ:g} N m^2 is {torsion:.2g} times EI_y + EI_z, usual is half "
            "or less"
        )
    for name in ("GA_y", "GA_z"):
        GA = getattr(section, name)
        if GA is not None and GA > section.EA:
            yield f"{key}.{name} = {GA:g} N is more than EA = {section.EA:g} N, usual is a third"


def _of_depth(key: str, section: Section, size: float) -> Iterator[str]:
    for name in ("EI_y", "EI_z"):
        radius = float(np.sqrt(getattr(section, name) / section.EA))
        if radius > MAX_SECTION_DEPTH * size:
            yield (
                f"{key}.{name}: sqrt({name} / EA), the radius of gyration, is {radius:.3g} m "
                f"in a mesh of {size:.3g} m: is {name} in N mm^2?"
            )


def _of_thickness(key: str, thickness: float, size: float) -> Iterator[str]:
    if not SHELL_THICKNESSES[0] <= thickness / size <= SHELL_THICKNESSES[1]:
        unit = "mm" if thickness > size else "other units"
        yield (
            f"{key}: a thickness of {thickness:.3g} m in a mesh of {size:.3g} m is none of a "
            f"shell: is it in {unit}?"
        )


def _of_piece(key: str, mass: float, inertia: Array, size: float) -> Iterator[str]:
    if mass == 0.0:
        return
    radius = float(np.sqrt(0.5 * np.trace(inertia) / mass))
    if radius > MAX_PIECE_RADIUS * size:
        yield (
            f"{key}.inertia: its radius of gyration, sqrt(tr J / 2 m), is {radius:.3g} m on a mesh "
            f"of {size:.3g} m: is it in kg mm^2?"
        )


def _of_damping(body: Body) -> Iterator[str]:
    ratios = None if body.damping is None else body.damping.modal
    if ratios is not None and (largest := max(ratios.ratios)) > MAX_DAMPING_RATIO:
        yield (
            f"damping.modal = {largest:g} is a ratio to critical damping, of parts 0.001 to 0.1: "
            "is it in per cent?"
        )


def _of_sound(what: str, speed: float) -> Iterator[str]:
    if not SOUND_SPEEDS[0] <= speed <= SOUND_SPEEDS[1]:
        yield (
            f"{what} makes a speed of sound of {speed:.3g} m/s, that of no solid, "
            f"{SOUND_SPEEDS[0]:g} to {SOUND_SPEEDS[1]:g}: is it in MPa, or the mass in other units?"
        )
