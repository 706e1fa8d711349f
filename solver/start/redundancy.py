"""Redundant constraints, by factorization and by name; degrees of freedom of a mechanism."""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace
from .inertia import accelerance_root, geometric_scale
from .jacobian import constraint_jacobian, constraint_rows
from .matrices import Matrix, beside, dense_of, factorize_square, unit_rows
from .nearby import poses_nearby

RANK_TOLERANCE = 1e-9
"""singular values, of a Jacobian with rows of unit length, below which rows are dependent"""


def count_degrees_of_freedom(lowered: LoweredModel, state: State, work: Workspace) -> int:
    """Degrees of freedom with all bodies rigid: six for each less the rank of the constraints."""
    J = _rigid_jacobian(lowered, state, work)
    n, n_q = J.shape
    return int(n_q - (n if _clearly_independent(J) else rank(dense_of(J))))


def redundant_rows(lowered: LoweredModel, state: State, work: Workspace) -> frozenset[int]:
    """Rows to leave out so that the others are independent, elastic interfaces included.

    ModelError names them unless redundant constraints may be removed. A drive is never redundant:
    it moves what the constraints that it depends on hold still. Nor are constraints that depend on
    one another in a singular pose alone: they are needed as soon as the mechanism leaves it.
    """
    hard = constraint_rows(lowered.system)
    J = _jacobian(lowered, state, work)
    redundancy = None if _clearly_independent(J) else find_redundancy(dense_of(J))
    if redundancy is None:
        return frozenset()
    involved = hard[redundancy.involved].tolist()
    removable = hard[redundancy.removable].tolist()
    dependent = describe_rows(lowered, involved)
    rigid = dense_of(_rigid_jacobian(lowered, state, work))
    here = len(hard) - len(removable)
    for _ in poses_nearby(lowered, state, work, rigid):
        if rank(dense_of(_jacobian(lowered, state, work))) > here:
            raise ModelError(
                f"joints: the start is a singular pose: {dependent} depend on one another there, "
                "but not beside it, so that the motion from there is not determined; start the "
                "mechanism in another pose, as by `start` of a joint"
            )
    if driven := [i for i in involved if lowered.system.couplings.drive[i] >= 0]:
        raise ModelError(
            f"joints: {describe_rows(lowered, driven)} is driven against other constraints: "
            f"on one another depend {dependent}; take away the drive or free a joint"
        )
    if coupled := [i for i in removable if _has_terms(lowered, i)]:
        owners = " and ".join(dict.fromkeys(lowered.owner_of(i) for i in coupled))
        raise ModelError(
            f"{owners}: depends on other constraints and cannot be left out: on one another "
            f"depend {dependent}; take it away or free a joint"
        )
    if lowered.model.settings.redundant == "error":
        are = "is" if len(removable) == 1 else "are"
        raise ModelError(
            f"joints: {len(hard)} constraints of which {len(removable)} {are} redundant; "
            f"on one another depend {dependent}; free a joint, or let redundant = 'remove' drop "
            f"{describe_rows(lowered, removable)}"
        )
    return frozenset(removable)


def _has_terms(lowered: LoweredModel, row: int) -> bool:
    terms = lowered.system.couplings.terms
    return bool(terms.range[row] < terms.range[row + 1])


def describe_rows(lowered: LoweredModel, rows: list[int]) -> str:
    """Rows by joint: "hinge (translation 3, rotation 1)"."""
    lengths, first = lowered.measures_lengths, lowered.system.couplings.range
    by_joint: dict[str, list[str]] = {}
    for i in rows:
        j = lowered.coupling_of(i)
        before = lengths[first[j] : i]
        kind = "translation" if lengths[i] else "rotation"
        by_joint.setdefault(lowered.coupling_names[j], []).append(
            f"{kind} {1 + int((before == lengths[i]).sum())}"
        )
    return ", ".join(f"{joint} ({', '.join(names)})" for joint, names in by_joint.items())


@dataclass(frozen=True)
class Redundancy:
    """The rows of a dependence, by number, and those to remove to leave the others independent."""

    involved: list[int]
    removable: list[int]


def find_redundancy(J: Array) -> Redundancy | None:
    """The dependent rows of a Jacobian (n, m), by its left null space; None if there are none.

    Of equal choices, later rows are removable.
    """
    if not len(J):
        return None
    null = _left_null_space(J)
    if not null.shape[1]:
        return None
    involved = np.flatnonzero(np.abs(null).max(axis=1) > 1e-6)
    later = 1.0 + 1e-3 * np.arange(len(J)) / len(J)
    from scipy.linalg import qr

    _, _, pivots = qr(null.T * later, pivoting=True, mode="economic")
    return Redundancy(involved.tolist(), sorted(pivots[: null.shape[1]].tolist()))


def rank(J: Array) -> int:
    return len(J) - _left_null_space(J).shape[1] if len(J) else 0


def _left_null_space(J: Array) -> Array:
    """Vectors y (n, k) with y^T J = 0, J's rows scaled to unit length."""
    length = np.linalg.norm(J, axis=1)
    scaled = J / np.where(length > 0.0, length, 1.0)[:, None]
    left, values, _ = np.linalg.svd(scaled, full_matrices=True)
    small = np.concatenate([values, np.zeros(len(J) - len(values))]) < RANK_TOLERANCE * max(
        1.0, values.max(initial=0.0)
    )
    return np.asarray(left[:, small])


def _rigid_jacobian(lowered: LoweredModel, state: State, work: Workspace) -> Matrix:
    """Rows of the constraints against bodies, columns scaled by their geometry."""
    B_r, _ = constraint_jacobian(lowered.system, state, work)
    return B_r @ geometric_scale(lowered.system)


def _jacobian(lowered: LoweredModel, state: State, work: Workspace) -> Matrix:
    """Rows of the constraints against bodies and interfaces, scaled."""
    _, B_a = constraint_jacobian(lowered.system, state, work)
    return beside(_rigid_jacobian(lowered, state, work), B_a @ accelerance_root(lowered))


def _clearly_independent(J: Matrix) -> bool:
    scaled, _ = unit_rows(J)
    return not J.shape[0] or factorize_square(scaled) is not None
