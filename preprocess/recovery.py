"""Fields of the mesh from modal coordinates: displacements and stresses of the modes."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..superelement import Recovery
from ..superelement.validation import Array
from .assembly.source import FieldPoints, Source
from .assembly.structure import Structure
from .body.body import Body
from .errors import MethodError
from .responses.shapes import Shapes

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


def recover(body: Body, source: Source, structure: Structure, shapes: Shapes) -> Recovery:
    """Modes at the points of lines or on the surface of solids, and stresses there if asked for.

        phi = T shapes,   stress = C strain(T shapes)

    Facets keep all their nodes and turn outwards. A node where materials meet is a point for each
    of them, with stresses of its own. `shapes` gives the mode shapes of what is linear in the dofs
    of the structure.
    """
    points = source.field_points(body.recovery is not None and body.recovery.stress)
    X = source.nodes.points[points.nodes] - structure.rigid.center
    phi = _at_points(points, structure.T, shapes)
    turns = None if structure.turns is None else _at_points(points, structure.turns, shapes)
    stress = _stresses(points, structure, shapes)
    return Recovery(X, points.cells, phi, stress, turns, points.labels)


def _at_points(points: FieldPoints, T: Any, shapes: Shapes) -> Array:
    """Three dofs of the nodes of all points (p, 3, m), which are T (3 n, n_u) of the structure's.

    Small rotations of nodes with six dofs, or displacements.
    """

    def batch(part: slice) -> Array:
        dofs = (3 * points.nodes[part, None] + np.arange(3)).ravel()
        return shapes(T[dofs]).reshape(part.stop - part.start, 3, -1)

    return _filled(points, batch)


def _stresses(points: FieldPoints, structure: Structure, shapes: Shapes) -> Array | None:
    """sigma = C strain (p, 6, m) of every mode at every point; None without strains.

    Order: `STRESSES`.
    """
    strains, C, owners = points.strains, points.C, points.owners
    if strains is None or C is None or owners is None:
        return None

    def batch(part: slice) -> Array:
        rows = strains[6 * part.start : 6 * part.stop] @ structure.T
        return np.asarray(C[owners[part]] @ shapes(rows).reshape(part.stop - part.start, 6, -1))

    return _filled(points, batch)


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
