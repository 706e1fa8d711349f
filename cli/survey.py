"""The report of a dry run on a body, and the picture of the selections on its mesh."""

from collections.abc import Iterator

import numpy as np
from rich.table import Table

from ..cad import Feature
from ..preprocess.assembly.interfaces import Attachment
from ..preprocess.survey import Survey
from ..superelement.validation import Array
from ..view import Cross, Marker, Patch, Scene
from .tables import Row, components, sectioned

EXACT_FREQUENCIES = "from the mesh itself"
ESTIMATED_FREQUENCIES = (
    "upper bounds, by fields that are quadratic splines in space: a few per cent high for compact "
    "bodies, up to a quarter where thin walls meet"
)

# They follow a vibration well, by docs/validity.md.
STEPS_IN_PERIOD = 20
# Lines of beams whose local axes are drawn: those of all would hide each other.
DRAWN_SECTIONS = 5
# Holes and faces that are listed and numbered: more would hide each other.
MAX_NUMBERED = 60


def report(survey: Survey) -> Table:
    """Mesh, masses, interfaces, surfaces, frequencies, cost and doubts, a section each."""
    sections = (
        _mesh(survey),
        _rigid(survey),
        _attachments(survey),
        _surfaces(survey),
        _channels(survey),
        _frequencies(survey),
        _rotation(survey),
        _cost(survey),
        _doubts(survey),
    )
    return sectioned(survey.body.name, sections)


def scene(survey: Survey) -> Scene:
    """The boundary of solids or the lines of beams, with interfaces, surfaces and masses."""
    mesh, facets = survey.mesh, survey.facets
    markers = [
        Marker(name, interface.X, interface.rotates)
        for name, interface in survey.interfaces.items()
    ]
    markers += [
        Marker(patch.name, patch.X.mean(axis=0) + survey.structure.rigid.center, has_axes=False)
        for patch in survey.touched
    ]
    masses = [
        Marker(f"{name} {survey.body.masses[name].mass:.3g} kg", attachment.X, has_axes=False)
        for name, attachment in survey.masses.items()
    ]
    masses += [
        Marker(name, np.array(sensor.point), has_axes=False)
        for name, sensor in survey.body.sensors.items()
    ]
    masses += [_number(feature) for feature in _numbered_features(survey)]
    if facets is None:
        # Lines do not show which way a section is turned: its axes do.
        lines = mesh.points[mesh.cells["line"]]
        return Scene(lines=lines, markers=markers, masses=masses, sections=_crosses(survey))
    patches = [Patch(polygons, owners) for polygons, owners in survey.boundary()]
    return Scene(patches, markers=markers, masses=masses)


def _number(feature: Feature) -> Marker:
    # Of a plane on the side that shows it: its number would lie on another face else.
    facing = np.array(feature.axis) if feature.kind == "plane" else None
    return Marker(str(feature.number), np.array(feature.near), has_axes=False, facing=facing)


def features_to_copy(survey: Survey) -> Iterator[str]:
    """Holes, shafts and planes of a CAD file, as lines to copy with the numbers of the picture."""
    features = _numbered_features(survey)
    if features:
        yield "holes and faces by their numbers in the picture, to copy:"
    for feature in features:
        yield f"{feature.key}  # {feature.number}: {_feature_in_words(feature)}"
    if left := len(survey.mesh.geometry.features) - len(features) if survey.mesh.geometry else 0:
        yield f"# and {left} more faces, curved or small"


def _feature_in_words(feature: Feature) -> str:
    axis = list(feature.axis)
    if feature.kind == "plane":
        return f"plane of {feature.area:.4g} m^2, center {list(feature.center)}, normal {axis}"
    size = f"radius {feature.radius:.6g} m, length {feature.length:.4g} m"
    return f"{feature.kind} of {size}, center {list(feature.center)}, axis {axis}"


def _numbered_features(survey: Survey) -> list[Feature]:
    """The holes and shafts, then the largest planes of a CAD file, by their numbers."""
    geometry = survey.mesh.geometry
    found = () if geometry is None else geometry.features
    kept = [feature for feature in found if feature.kind != "curved"]
    # A part has few holes that matter, and many small faces that do not.
    round_first = sorted(kept, key=lambda feature: (feature.kind == "plane", -feature.area))
    return sorted(round_first[:MAX_NUMBERED], key=lambda feature: feature.number)


def _crosses(survey: Survey) -> list[Cross]:
    """The local axes of some lines, evenly among them."""
    points, axes = survey.section_axes()
    some = np.unique(np.linspace(0, len(points) - 1, DRAWN_SECTIONS).round().astype(int))
    return [Cross(points[i], axes[i, 1], axes[i, 2]) for i in some.tolist()]


def _mesh(survey: Survey) -> Iterator[Row]:
    mesh, structure = survey.mesh, survey.structure
    elements = ", ".join(f"{len(cells)} {kind}" for kind, cells in mesh.elements.items())
    yield "mesh", f"{mesh.name}: {len(mesh.points)} nodes, {elements}"
    if mesh.geometry is not None:
        yield "meshed by", f"gmsh {mesh.geometry.gmsh}: {mesh.geometry.quality}"
    yield "from [m]", components(mesh.points.min(axis=0))
    yield "to [m]", components(mesh.points.max(axis=0))
    yield "unknowns", f"{structure.n_u}, of which {structure.P_C.shape[0]} interface dofs are kept"


def _rigid(survey: Survey) -> Iterator[Row]:
    rigid = survey.structure.rigid
    yield "mass [kg]", f"{rigid.mass:.6g}"
    yield "center of mass [m]", _position(rigid.center, survey)
    yield (
        "principal inertia [kg m^2]",
        components(np.linalg.eigvalsh(rigid.J_rot).astype(np.float64)),
    )
    for share in survey.shares:
        label = f"  {share.group}" if share.group else "  all elements"
        yield (
            label,
            f"{share.mass:.6g} kg, {share.extent:.6g} {share.unit}, {share.elements} elements",
        )


def _channels(survey: Survey) -> Iterator[Row]:
    channels = survey.structure.channels
    if channels is None:
        return
    for pattern in channels.patterns:
        force, moment = components(pattern.force), components(pattern.moment)
        yield f"load {pattern.name}", f"{force} N, {moment} N m about the center of mass"
    for sensor in channels.sensors:
        place = components(sensor.X + survey.structure.rigid.center)
        yield f"sensor {sensor.name}", f"{sensor.kind} at {place} m"


def _surfaces(survey: Survey) -> Iterator[Row]:
    cost = survey.surfaces
    if cost is None:
        return
    yield "surfaces", f"{len(survey.touched)}"
    for patch in survey.touched:
        count = f"{len(patch.facets)} {patch.facet_type} facets of {patch.area:.4g} m^2"
        yield f"  {patch.name}", f"{count} with {patch.n} nodes"
    size = f"{cost.columns} columns, {cost.compliance_bytes / 1e6:.3g} MB"
    # The estimate is of short waves, of which a stiff body has none in its band.
    modes = max(round(cost.modes), int((survey.frequencies.values <= survey.band).sum()))
    yield "  compliance", f"{size}, beside about {modes} modes"
    if cost.fields:
        yield "  recovery", f"{cost.fields} values by forces, {cost.field_bytes / 1e6:.3g} MB"
    yield "to expect", f"about {cost.build.seconds:.2g} s and {cost.build.bytes / 1e9:.2g} GB"


def _attachments(survey: Survey) -> Iterator[Row]:
    yield "interfaces", f"{len(survey.interfaces)}, positions [m] in the axes of the mesh"
    for name, interface in survey.interfaces.items():
        yield f"  {name}", f"{_position(interface.X, survey)}\n{_carrier(interface)}"
    if survey.masses:
        yield "masses", f"{len(survey.masses)}"
    for name, attachment in survey.masses.items():
        mass = survey.body.masses[name]
        where = "" if mass.interface is None else f", on interface {mass.interface}"
        yield f"  {name}", f"{_position(attachment.X, survey)}\n{mass.mass:.6g} kg{where}"


def _carrier(attachment: Attachment) -> str:
    """The nodes and facets that carry a frame."""
    n_nodes, n_facets = len(attachment.nodes), len(attachment.facets)
    if n_nodes == 1:
        return f"one node, {attachment.rows.shape[0]} dofs"
    facets = f"{n_facets} facets of {attachment.area:.4g} m^2 with " if n_facets else ""
    return f"{'rigid' if attachment.rigid else 'average'}, {facets}{n_nodes} nodes"


def _frequencies(survey: Survey) -> Iterator[Row]:
    frequencies, band, wave = survey.frequencies, survey.band, survey.resolution
    yield (
        f"first {len(frequencies.values)} [Hz]",
        ", ".join(f"{value:.5g}" for value in frequencies.values),
    )
    yield "  found", EXACT_FREQUENCIES if frequencies.exact else ESTIMATED_FREQUENCIES
    if survey.measured is not None:
        yield "  measured", ", ".join(f"{value:.5g}" for value in survey.measured)
    inside = int((frequencies.values <= band).sum())
    held = "all" if inside == len(frequencies.values) else str(inside)
    yield "band [Hz]", f"up to {band:.5g}, which holds {held} of these"
    hint = (
        ""
        if wave.nodes >= wave.needed
        else f": the mesh is too coarse for it, {wave.needed} would do"
    )
    yield (
        f"  shortest {wave.wave} wave [m]",
        f"{wave.wavelength:.4g}, {wave.nodes:.3g} nodes where they are sparse{hint}",
    )
    if survey.body.impulse.band is not None:
        yield (
            f"  {STEPS_IN_PERIOD} steps at its end",
            f"a run needs step = {1.0 / (STEPS_IN_PERIOD * band):.3g} s "
            f"(impulse.step is {survey.body.impulse.step:.3g} s)",
        )


def _rotation(survey: Survey) -> Iterator[Row]:
    """The coordinates of second order that are asked for, of which those that matter are taken."""
    asked = survey.body.rotation
    if asked is None:
        return
    names = survey.interfaces if asked.loaded is None else asked.loaded
    most = sum(found.n_dofs for found in survey.structure.interfaces if found.name in names)
    soft = most if asked.soft == "auto" else min(asked.soft, most)
    yield (
        "[rotation]",
        f"{asked.modes} modes, up to {soft} soft shapes: r up to {asked.modes + 2 * soft}",
    )


def _cost(survey: Survey) -> Iterator[Row]:
    if survey.cost is not None:
        ways = {"factor": "with a factor", "iterative": "without a factor"}
        costs = {"factor": survey.cost.factor, "iterative": survey.cost.iterative}
        chosen, other = (
            f"{costs[way].seconds:.2g} s and {costs[way].bytes / 1e9:.2g} GB {ways[way]}"
            for way in (survey.cost.solver, survey.cost.other)
        )
        yield "to expect", f"about {chosen}, for {survey.body.impulse.steps} steps; {other}"


def _doubts(survey: Survey) -> Iterator[Row]:
    for doubt in survey.doubts:
        yield "LOOK AT", doubt


def _position(X: Array, survey: Survey) -> str:
    """Coordinates, without the rounding of those that are zero."""
    return components(np.where(np.abs(X) < 1e-12 * survey.mesh.size, 0.0, X))
