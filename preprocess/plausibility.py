"""What is unlike any part that is built, most often by a wrong unit: told; refused if singular."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from scipy.sparse.linalg import ArpackError

from ..files import in_one_line
from .body.body import Body
from .body.material import Material, Section
from .errors import MethodError
from .mesh.facets import Facets
from .mesh.mesh import Mesh

SOUND = (20.0, 30_000.0)
"""Speeds of sound in solids [m/s]: soft rubber, and twice that of beryllium."""
DENSITY = (5.0, 25_000.0)
"""Densities of solids [kg/m^3]: foams, and osmium."""
SIZE = (1e-5, 100.0)
"""Sizes of parts [m]."""
LINEAR = ("tetra", "hexahedron", "wedge")
"""Solids with nodes at their corners alone."""


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


def doubts_of_body(body: Body) -> Iterator[str]:
    """Doubts about materials, sections and the rotation of matrices, each by its key."""
    if body.material is not None:
        yield from _of_material("material", body.material)
    if body.section is not None:
        yield from _of_section("section", body.section)
    for group, material in body.materials.items():
        yield from _of_material(f"materials.{group}", material)
    for group, section in body.sections.items():
        yield from _of_section(f"sections.{group}", section)
    if body.rotation is not None and body.matrices is not None:
        yield (
            "rotation: [matrices] know no stiffening: slender bodies, as blades, soften as they "
            "turn where they would stiffen; good for stretch, and for the whirl of stiff rotors "
            "and shafts well below their first frequency"
        )


def doubts_of_mesh(mesh: Mesh, facets: Facets | None) -> Iterator[str]:
    """Doubts about the size of a mesh, and elements that are too stiff in bending."""
    if not SIZE[0] <= mesh.size <= SIZE[1]:
        yield (
            f"the mesh is {mesh.size:.4g} m large: are its coordinates in millimeters "
            "(scale = 1e-3)?"
        )
    if facets is None:
        return
    if "tetra" in mesh.body_types:
        yield "four-node tetrahedra are too stiff in bending, by a factor: mesh with ten nodes"
    elif _is_one_element_thick(mesh, facets):
        yield (
            "linear elements, one through the thickness, are too stiff in bending: "
            "mesh with two or more, or with nodes on the edges"
        )


def _is_one_element_thick(mesh: Mesh, facets: Facets) -> bool:
    """Whether all nodes of a mesh of linear elements lie on its boundary."""
    if not set(mesh.body_types) <= set(LINEAR):
        return False
    outer = [nodes.ravel() for nodes in facets.patch(np.flatnonzero(facets.boundary)).values()]
    return len(np.unique(np.concatenate(outer))) == len(mesh.points)


def _of_material(key: str, material: Material) -> Iterator[str]:
    if not DENSITY[0] <= material.rho <= DENSITY[1]:
        yield (
            f"{key}.rho = {material.rho:g} kg/m^3 is not that of a solid: "
            "is it in t/mm^3 or g/cm^3?"
        )
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


def _of_sound(what: str, speed: float) -> Iterator[str]:
    if not SOUND[0] <= speed <= SOUND[1]:
        yield (
            f"{what} makes a speed of sound of {speed:.3g} m/s, that of no solid: "
            "is it in MPa, or the mass in other units?"
        )
