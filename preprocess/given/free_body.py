"""Checks that given matrices are those of a free elastic body."""

from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import eigh
from scipy.sparse.csgraph import connected_components

from ...superelement.validation import Array
from ..errors import MatrixError
from .matrices import GivenModel

RIGID_FORCE = 1e-8
"""Force under a rigid motion, relative to what the same displacements make with all stiffnesses
counted positive.
"""
MAX_MASS_DIFFERENCE = 1e-8  # in the three directions, relative to their mean
DEFINITENESS_STEPS = 30
"""Of Lanczos on M over its diagonal, whose negative eigenvalues, if any, lie apart from the others.
"""
MIN_LANCZOS_LENGTH = 1e-12
"""Length of a step of Lanczos that is rounding, for a matrix with ones on its diagonal."""
RIGID_MOTIONS = tuple(
    f"{kind} {axis}" for kind in ("translation along", "rotation about") for axis in "xyz"
)

HELD_ADVICE = "the body is held there, or its rows belong to other nodes and dofs than is said"
MISPLACED_ADVICE = (
    "it may translate but not rotate, so its nodes are not where they were when the matrices were "
    "made, the unit of length is another one, dofs are in local axes, "
    "or springs join nodes that lie apart"
)


def check_free_body(model: GivenModel) -> None:
    """Check that K and M are those of one free elastic body with mass on every dof.

    M must be positive definite with one mass in all directions; K must be connected and leave rigid
    motions free.

    `MatrixError` names the dof and the motion, and what may be the cause.
    """
    A, reach = _rigid_motions(model)
    _check_stiffness(model)
    _check_no_resistance(model, A, reach)
    _check_definite(model)
    _check_mass(model, A)


def _rigid_motions(model: GivenModel) -> tuple[Array, Array]:
    """Rigid motions A (n_u, 6) about the middle, and the scale (n_u,) of their entries.

    The scale is 1 for displacements and 1 / size for rotations: where entries of A are zero, it
    keeps a row of K A from being compared with rounding alone.
    """
    points, size = model.nodes.points, _size(model)
    if not size:
        raise MatrixError(
            f"{model.table.name}: expected nodes at several places, "
            f"found all at {points[0].tolist()}"
        )
    A = model.nodes.rigid_motion(points.mean(axis=0)) / np.repeat([1.0, size], 3)
    reach = np.full(model.nodes.n_dofs, 1.0 / size)
    reach[model.nodes.displacements] = 1.0
    return A, reach


def _size(model: GivenModel) -> float:
    """The size of the model [m]; of one node with generalized coordinates 1, for it has none."""
    return 1.0 if _has_one_node(model) else model.table.size


def _has_one_node(model: GivenModel) -> bool:
    """Whether it is a reduced model of one node, whose motion is rigid and has no stiffness."""
    return len(model.nodes.points) == 1 and model.nodes.generalized > 0


def _check_stiffness(model: GivenModel) -> None:
    """Every dof must have stiffness, and K alone must connect all of the body."""
    loose = np.flatnonzero(model.K.diagonal() <= 0.0)
    if _has_one_node(model):
        loose = loose[model.nodes.owner[loose] < 0]
    if len(loose):
        raise MatrixError(
            f"{model.name}: expected stiffness on every dof, found none on {len(loose)}, "
            f"first {model.dof(loose[0])}"
        )
    # Generalized coordinates connect nothing: their stiffness may be theirs alone.
    n_nodal = model.nodes.n_dofs - model.nodes.generalized
    entries = model.K[:n_nodal, :n_nodal].tocoo()
    owner, n_nodes = model.nodes.owner, len(model.nodes.points)
    graph = sp.coo_array(
        (np.ones(entries.nnz), (owner[entries.row], owner[entries.col])), shape=(n_nodes, n_nodes)
    )
    pieces, label = connected_components(graph, directed=False)
    if pieces > 1:
        sizes = np.bincount(label)
        least = model.table.labels[np.argmax(label == sizes.argmin())]
        raise MatrixError(
            f"{model.name}: expected one connected body, found {pieces} pieces of "
            f"{', '.join(map(str, sizes[:4]))}{', ...' if pieces > 4 else ''} nodes; "
            f"node {least} is in the smallest"
        )


def _check_no_resistance(model: GivenModel, A: Array, reach: Array) -> None:
    """|K A| <= RIGID_FORCE |K| reach, row by row."""
    share = np.abs(model.K @ A) / _largest_forces(model, reach)[:, None]
    worst = share.max(axis=0)
    if worst.max() <= RIGID_FORCE:
        return
    # Translations first: misplaced nodes resist rotation alone, held ones resist both.
    held = worst[:3].max() > RIGID_FORCE
    motion = int((worst[:3] if held else worst).argmax())
    cause = HELD_ADVICE if held else MISPLACED_ADVICE
    # A has rotations by 1 / size: that of one radian has more energy.
    energy = 0.5 * float(A[:, motion] @ (model.K @ A[:, motion]))
    unit, scale = ("m", 1.0) if motion < 3 else ("rad", _size(model))
    raise MatrixError(
        f"{model.name}: expected no resistance to rigid motion, found under "
        f"{RIGID_MOTIONS[motion]} forces of {worst[motion]:.1e} of the stiffness, expected "
        f"{RIGID_FORCE:g} at most, the largest "
        f"on {model.dof(int(share[:, motion].argmax()))}: {cause}; "
        f"the motion has a strain energy of {energy * scale**2:.3g} J at 1 {unit}"
    )


def _largest_forces(model: GivenModel, reach: Array) -> Array:
    """What rows of K would give with all stiffnesses counted positive (n_u,).

    Where a node has none to compare with, that of its mass at the lowest frequency of the shapes.
    """
    forces = abs(model.K) @ reach
    if not _has_one_node(model):
        return np.asarray(forces)
    modal = model.nodes.owner < 0
    K, M = model.K.diagonal(), model.M.diagonal()
    lowest = (K[modal] / np.where(M[modal] > 0.0, M[modal], 1.0)).min()
    return np.asarray(np.maximum(forces, lowest * np.where(M > 0.0, M, 1.0)))


def _check_definite(model: GivenModel) -> None:
    """Masses on every dof, and v^T M v > 0 for the v that Lanczos finds: a proof where it fails
    only.
    """
    diagonal = model.M.diagonal()
    massless = np.flatnonzero(diagonal <= 0.0)
    if len(massless):
        raise MatrixError(
            f"{model.name}: expected mass on every dof, found none or less on {len(massless)}, "
            f"first {model.dof(massless[0])}: "
            "rotations get theirs from consistent (coupled) mass, or from [masses]"
        )
    # Masses and inertias differ by orders of magnitude: scaled, they compare.
    scale = sp.diags_array(1.0 / np.sqrt(diagonal))
    lowest, v = _lowest((scale @ model.M @ scale).tocsc())
    if lowest <= 0.0:
        raise MatrixError(
            f"{model.name}: expected a positive definite mass, found one with the eigenvalue "
            f"{lowest:.1e} of its diagonal, which moves {model.dof(int(np.abs(v).argmax()))} most"
        )


def _lowest(S: Any) -> tuple[float, Array]:
    """The least of v^T S v for |v| = 1, and its v, after `DEFINITENESS_STEPS` of Lanczos."""
    V = np.zeros((min(DEFINITENESS_STEPS, S.shape[0]), S.shape[0]))
    SV = np.zeros_like(V)
    v = np.random.default_rng(0).standard_normal(S.shape[0])
    for k in range(len(V)):
        for _ in range(2):  # twice is enough to be orthogonal
            v -= V[:k].T @ (V[:k] @ v)
        length = np.linalg.norm(v)
        if length <= MIN_LANCZOS_LENGTH:
            V, SV = V[:k], SV[:k]
            break
        V[k] = v / length
        SV[k] = S @ V[k]
        v = SV[k].copy()
    values, vectors = eigh(V @ SV.T)
    return float(values[0]), V.T @ vectors[:, 0]


def _check_mass(model: GivenModel, A: Array) -> None:
    """A^T M A of a rigid body: one mass in all directions, and a skew coupling with rotations."""
    moments = A.T @ (model.M @ A)
    masses = np.diag(moments)[:3]
    mass = masses.mean()
    wrong = np.abs(moments[:3, :3] - mass * np.eye(3)).max()
    if wrong > MAX_MASS_DIFFERENCE * mass:
        raise MatrixError(
            f"{model.name}: expected one mass in all directions, found "
            f"{', '.join(f'{m:.9g}' for m in masses)} kg along x, y, z, and up to {wrong:.1e} "
            "between them: mass is missing on dofs, or dofs are in local axes"
        )
    # m (X~)^T is skew about any point, if all directions have the same center of mass.
    coupling = moments[:3, 3:]
    uneven = np.abs(coupling + coupling.T).max()
    if uneven > MAX_MASS_DIFFERENCE * mass:
        raise MatrixError(
            f"{model.name}: expected one center of mass for all directions, found several, "
            f"{uneven / mass:.1e} of the size apart: mass is missing on dofs, "
            "or nodes are not where they are said to be"
        )
