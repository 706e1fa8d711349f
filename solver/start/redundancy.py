"""Redundant constraints, by factorization and by name; degrees of freedom of a mechanism."""

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace
from .dependence import MIN_SHARE_IN_DEPENDENCE, dependences, owners_of_columns, rows_to_leave_out
from .inertia import accelerance_root, geometric_scale
from .jacobian import constraint_jacobian, constraint_rows
from .matrices import Matrix, beside, factorize_square, unit_rows
from .nearby import poses_nearby

RANK_TOLERANCE = 1e-9
"""singular values, of a Jacobian with rows of unit length, below which rows are dependent"""


def count_degrees_of_freedom(lowered: LoweredModel, state: State, work: Workspace) -> int:
    """Degrees of freedom with all bodies rigid: six for each less the rank of the constraints."""
    J = _rigid_jacobian(lowered, state, work)
    n, n_q = J.shape
    return int(n_q - (n if _clearly_independent(J) else _rank(lowered, J)))


def redundant_rows(lowered: LoweredModel, state: State, work: Workspace) -> frozenset[int]:
    """Rows to leave out so that the others are independent, elastic interfaces included.

    ModelError names them unless redundant constraints may be removed. A drive is never redundant:
    it moves what the constraints that it depends on hold still. Nor are constraints that depend on
    one another in a singular pose alone: they are needed as soon as the mechanism leaves it.
    """
    hard = constraint_rows(lowered.system)
    # With elastic interfaces: two hinges on a flexible door depend on one another only if it were
    # rigid.
    J = _jacobian(lowered, state, work)
    if _clearly_independent(J):
        return frozenset()
    null = _dependences(lowered, J)
    if not null.shape[1]:
        return frozenset()
    involved = hard[np.abs(null).max(axis=1) > MIN_SHARE_IN_DEPENDENCE].tolist()
    removable = hard[rows_to_leave_out(null)].tolist()
    dependent = describe_rows(lowered, involved)
    rigid = _rigid_jacobian(lowered, state, work)
    here = len(hard) - len(removable)
    for _ in poses_nearby(lowered, state, work, rigid):
        # Beside a singular pose the rank is full: to leave out a row would free a motion for ever.
        if _rank(lowered, _jacobian(lowered, state, work)) > here:
            raise ModelError(
                f"joints: the start is a singular pose: {dependent} are dependent constraints "
                "there, but independent in nearby poses, so that the motion is not determined; "
                "start the mechanism in another pose, for instance by `start` of a joint"
            )
    if driven := [i for i in involved if lowered.system.couplings.drive[i] >= 0]:
        raise ModelError(
            f"joints: {describe_rows(lowered, driven)} is driven against other constraints: "
            f"dependent constraints: {dependent}; remove the drive or free a joint"
        )
    if coupled := [i for i in removable if _has_terms(lowered, i)]:
        owners = " and ".join(dict.fromkeys(lowered.owner_of(i) for i in coupled))
        raise ModelError(
            f"{owners}: depends on other constraints and cannot be left out: dependent "
            f"constraints: {dependent}; remove it or free a joint"
        )
    if lowered.model.settings.redundant == "error":
        are = "is" if len(removable) == 1 else "are"
        raise ModelError(
            f"joints: {len(hard)} constraints of which {len(removable)} {are} redundant; "
            f"dependent constraints: {dependent}; free a joint, or set redundant = 'remove' to "
            f"drop {describe_rows(lowered, removable)}"
        )
    # Any choice gives the same motion of rigid bodies; forces of those left out are zero.
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


def _dependences(lowered: LoweredModel, J: Matrix) -> Array:
    """Vectors y (n, k) with y^T J = 0, J's rows scaled to unit length."""
    scaled, _ = unit_rows(J)
    return dependences(scaled, owners_of_columns(lowered.system, J), RANK_TOLERANCE)


def _rank(lowered: LoweredModel, J: Matrix) -> int:
    return int(J.shape[0] - _dependences(lowered, J).shape[1])


def _rigid_jacobian(lowered: LoweredModel, state: State, work: Workspace) -> Matrix:
    """Rows of the constraints against bodies, columns scaled by their geometry."""
    B_r, _ = constraint_jacobian(lowered.system, state, work)
    return B_r @ geometric_scale(lowered.system)


def _jacobian(lowered: LoweredModel, state: State, work: Workspace) -> Matrix:
    """Rows of the constraints against bodies and interfaces, scaled."""
    B_r, B_a = constraint_jacobian(lowered.system, state, work)
    return beside(B_r @ geometric_scale(lowered.system), B_a @ accelerance_root(lowered))


def _clearly_independent(J: Matrix) -> bool:
    scaled, _ = unit_rows(J)
    return not J.shape[0] or factorize_square(scaled) is not None
