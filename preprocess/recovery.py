"""Fields of the mesh from modal coordinates: displacements and stresses of the modes."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..superelement import Recovery
from ..superelement.recovery import SurfaceRest
from ..superelement.validation import Array
from .assembly.source import FacePoints, FieldPoints, Source
from .assembly.structure import Structure
from .body.body import Body
from .errors import MethodError
from .responses.shapes import Shapes

REST_ERROR = 1e-5  # of the static rest of fields in files, over its largest value
POINTS_AT_ONCE = 2**10  # lest rows and strains of all of them take memory too


def check_recovery(body: Body, source: Source) -> None:
    """Refuse [recovery] before anything expensive is done.

    `BodyError` where the source has no such fields, `MethodError` for a method without modes.
    """
    if body.recovery is None:
        return
    source.check_fields(body.recovery.stress)
    if body.impulse.method == "march":
        raise MethodError(
            "[recovery] needs modes, which impulse.method march does not find: "
            "use auto, krylov, modal, craig-bampton or rubin"
        )


def recover(
    body: Body, source: Source, structure: Structure, shapes: Shapes, rest: Array | None = None
) -> Recovery:
    """Modes at the points of lines or on the surface of solids and shells, perhaps with stresses.

        phi = T shapes,   stress = C strain(T shapes)

    Facets keep all their nodes and turn outwards. A node where materials meet is a point for each
    of them, with stresses of its own. `shapes` gives the mode shapes of what is linear in the dofs
    of the structure. rest: that of the rows `Patches.fields`.
    """
    points = source.field_points(body.recovery is not None and body.recovery.stress)
    X = points.places(source.nodes) - structure.rigid.center

    def fields(rows: Callable[[Any, slice, Any], Any], T: Any, k: int) -> Array:
        def batch(part: slice) -> Array:
            return shapes(rows(T, part, structure.turns)).reshape(part.stop - part.start, k, -1)

        return _filled(points, batch)

    phi = fields(points.displacement_rows, structure.T, 3)
    stress = None
    if body.recovery is not None and body.recovery.stress:
        stress = fields(points.stress_rows, structure.T, 6)
    turns = None
    # Points on the faces of shells are where outlines need them; sections of beams turn.
    if source.nodes.rotations.all() and not isinstance(points, FacePoints):
        turns = fields(points.displacement_rows, structure.turns, 3)
    by_forces = None if rest is None else _rest_of_fields(rest, len(X))
    return Recovery(X, points.cells, phi, stress, turns, points.labels, by_forces)


def _rest_of_fields(rest: Array, n_points: int) -> SurfaceRest:
    """The rest (k, 3 n) of displacements and stresses of all points, rounded for the file."""
    u, stress = np.split(rest, [3 * n_points])
    fields = (field.reshape(n_points, -1, rest.shape[1]) for field in (u, stress) if len(field))
    return SurfaceRest(*map(_rounded, fields))


def _rounded(field: Array) -> Array:
    """Multiples of a power of two, the bits of which a file compresses to a quarter."""
    unit = float(2.0 ** np.floor(np.log2(REST_ERROR * np.abs(field).max())))
    return np.asarray(np.round(field / unit) * unit)


def _filled(points: FieldPoints, batch: Callable[[slice], Array]) -> Array:
    """Fields (p, k, m) of all points, POINTS_AT_ONCE points at a time."""
    n = len(points.nodes)
    # The first batch tells how many modes there are, before all of the memory is taken.
    first = batch(slice(0, min(POINTS_AT_ONCE, n)))
    fields = np.empty((n, *first.shape[1:]))
    fields[:POINTS_AT_ONCE] = first
    for start in range(POINTS_AT_ONCE, n, POINTS_AT_ONCE):
        fields[start : start + POINTS_AT_ONCE] = batch(slice(start, min(start + POINTS_AT_ONCE, n)))
    fields.flags.writeable = False  # so that the recovery keeps it without a copy
    return fields
