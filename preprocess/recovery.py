"""Fields of the mesh from modal coordinates: displacements and stresses of the modes."""

import numpy as np

from ..superelement import Recovery
from ..superelement.validation import Array
from .assembly.source import FieldPoints, Source
from .assembly.structure import Structure
from .body.body import Body
from .errors import MethodError
from .responses.shapes import Shapes

BATCH = 2**10
"""Points at which stresses are made at once, lest strains and stresses of all of them take memory
twice.
"""


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
    dofs = (3 * points.nodes[:, None] + np.arange(3)).ravel()
    phi = shapes(structure.T[dofs]).reshape(len(points.nodes), 3, -1)
    X = source.nodes.points[points.nodes] - structure.rigid.center
    turns = _rotations(points, structure, shapes)
    return Recovery(X, points.cells, phi, _stresses(points, structure, shapes), turns)


def _rotations(points: FieldPoints, structure: Structure, shapes: Shapes) -> Array | None:
    """Small rotations (p, 3, m) of modes at nodes with six dofs; None of solids."""
    if structure.turns is None:
        return None
    dofs = (3 * points.nodes[:, None] + np.arange(3)).ravel()
    return shapes(structure.turns[dofs]).reshape(len(points.nodes), 3, -1)


def _stresses(points: FieldPoints, structure: Structure, shapes: Shapes) -> Array | None:
    """sigma = C strain (p, 6, m) of every mode at every point; None without strains.

    Order: `STRESSES`.
    """
    if points.strains is None or points.C is None or points.owners is None:
        return None
    rows = (points.strains @ structure.T).tocsr()
    batches = []
    for first in range(0, len(points.nodes), BATCH):
        owners = points.owners[first : first + BATCH]
        strains = shapes(rows[6 * first : 6 * (first + len(owners))]).reshape(len(owners), 6, -1)
        batches.append(points.C[owners] @ strains)
    return np.concatenate(batches)
