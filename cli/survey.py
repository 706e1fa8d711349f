"""The report of a dry run on a body, and the picture of the selections on its mesh."""

from collections.abc import Iterator

import numpy as np
from rich.table import Table
from rich.text import Text

from ..preprocess.assembly.interfaces import Attachment
from ..preprocess.survey import Survey
from ..superelement.validation import Array
from ..view import Patch, Place, Scene

EXACT = "from the mesh itself"
ESTIMATED = (
    "upper bounds, by fields that are quadratic splines in space: a few per cent high for compact "
    "bodies, up to a quarter where thin walls meet"
)

Row = tuple[str, str]


def report(survey: Survey) -> Table:
    """Mesh, mass properties, places, frequencies and cost, a section each."""
    table = Table(title=Text(survey.body.name), show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for section in (
        _mesh(survey),
        _rigid(survey),
        _places(survey),
        _frequencies(survey),
        _cost(survey),
    ):
        for label, value in section:
            table.add_row(Text(label), Text(value))
        table.add_section()
    return table


def scene(survey: Survey) -> Scene:
    """The boundary of solids or the lines of beams, with the facets of interfaces, the frames and
    the masses.
    """
    mesh, facets = survey.mesh, survey.facets
    places = [Place(name, place.X, place.rotates) for name, place in survey.interfaces.items()]
    masses = [
        Place(f"{name} {survey.body.masses[name].mass:.3g} kg", place.X, turns=False)
        for name, place in survey.masses.items()
    ]
    if facets is None:
        return Scene(lines=mesh.points[mesh.cells["line"]], places=places, masses=masses)
    patches = [Patch(polygons, owners) for polygons, owners in survey.boundary()]
    return Scene(patches, places=places, masses=masses)


def _mesh(survey: Survey) -> Iterator[Row]:
    mesh, structure = survey.mesh, survey.structure
    elements = ", ".join(f"{len(cells)} {kind}" for kind, cells in mesh.elements.items())
    yield "mesh", f"{mesh.name}: {len(mesh.points)} nodes, {elements}"
    yield "from [m]", _line(mesh.points.min(axis=0))
    yield "to [m]", _line(mesh.points.max(axis=0))
    yield "unknowns", f"{structure.n_u}, of which {structure.P_C.shape[0]} interface dofs are kept"


def _rigid(survey: Survey) -> Iterator[Row]:
    rigid = survey.structure.rigid
    yield "mass [kg]", f"{rigid.mass:.6g}"
    yield "center of mass [m]", _position(rigid.center, survey)
    yield "principal inertia [kg m^2]", _line(np.linalg.eigvalsh(rigid.J_rot).astype(np.float64))
    unit = "m" if survey.facets is None else "m^3"
    for share in survey.shares:
        label = f"  {share.group}" if share.group else "  all elements"
        yield label, f"{share.mass:.6g} kg, {share.extent:.6g} {unit}, {share.elements} elements"


def _places(survey: Survey) -> Iterator[Row]:
    yield "interfaces", f"{len(survey.interfaces)}, positions [m] in the axes of the mesh"
    for name, place in survey.interfaces.items():
        yield f"  {name}", f"{_position(place.X, survey)}\n{_carried(place)}"
    if survey.masses:
        yield "masses", f"{len(survey.masses)}"
    for name, place in survey.masses.items():
        mass = survey.body.masses[name]
        where = "" if mass.interface is None else f", on interface {mass.interface}"
        yield f"  {name}", f"{_position(place.X, survey)}\n{mass.mass:.6g} kg{where}"


def _carried(place: Attachment) -> str:
    """What carries a frame."""
    if len(place.nodes) == 1:
        return f"one node, {place.rows.shape[0]} dofs"
    facets = (
        f"{len(place.facets)} facets of {place.area:.4g} m^2 with " if len(place.facets) else ""
    )
    return f"{'rigid' if place.rigid else 'average'}, {facets}{len(place.nodes)} nodes"


def _frequencies(survey: Survey) -> Iterator[Row]:
    found, band, wave = survey.frequencies, survey.band, survey.resolution
    yield f"first {len(found.values)} [Hz]", ", ".join(f"{value:.5g}" for value in found.values)
    yield "  found", EXACT if found.exact else ESTIMATED
    inside = int((found.values <= band).sum())
    held = "all" if inside == len(found.values) else str(inside)
    yield "band [Hz]", f"up to {band:.5g}, which holds {held} of these"
    kind = "bending" if survey.facets is None else "shear"
    hint = (
        ""
        if wave.nodes >= wave.needed
        else f": the mesh is too coarse for it, {wave.needed} would do"
    )
    yield (
        f"  shortest {kind} wave [m]",
        f"{wave.wavelength:.4g}, {wave.nodes:.3g} nodes where they are sparse{hint}",
    )


def _cost(survey: Survey) -> Iterator[Row]:
    if survey.cost is not None:
        seconds, gigabytes = survey.cost.seconds, survey.cost.bytes / 1e9
        yield (
            "to expect",
            f"about {seconds:.2g} s and {gigabytes:.2g} GB for {survey.body.impulse.steps} steps",
        )


def _position(X: Array, survey: Survey) -> str:
    """Coordinates, without the rounding of those that are zero."""
    return _line(np.where(np.abs(X) < 1e-12 * survey.mesh.size, 0.0, X))


def _line(values: Array) -> str:
    return " ".join(f"{value:11.5g}" for value in values)
