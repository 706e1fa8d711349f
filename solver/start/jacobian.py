"""Derivatives of rows by the coordinates of all bodies, as matrices."""

import numpy as np

from ..arrays import Array, Index
from ..step.records.couplings import Couplings
from ..step.system import State, System, Workspace
from .matrices import Matrix, from_entries, is_small


def constraint_rows(system: System) -> Index:
    """The rows that are constraints, not force laws."""
    return np.flatnonzero(system.couplings.compliant == 0)


def constraint_jacobian(system: System, state: State, work: Workspace) -> tuple[Matrix, Matrix]:
    """B_r (n, 6 n_b) and B_a (n, n_a) of the constraints: derivatives by bodies, by active dofs.

    As `linearize` left them.
    """
    B = coupling_jacobian(system, state, work)[constraint_rows(system)]
    n_q = 6 * len(system.bodies.mass)
    return B[:, :n_q], B[:, n_q:]


def coupling_jacobian(system: System, state: State, work: Workspace) -> Matrix:
    """Derivatives of the rows of all couplings as `linearize` left them (n_rows, 6 n_b + n_a).

    Of those with terms, derivatives of the sum.
    """
    rows, terms = system.couplings.rows, system.couplings.terms
    B = jacobian(system, rows.frame_a, rows.frame_b, work.couplings.B, state)
    if not len(terms.row):
        return B
    of_terms = jacobian(system, terms.rows.frame_a, terms.rows.frame_b, work.terms.B, state)
    shape, numbers = (len(rows.kind), len(terms.row)), np.arange(len(terms.row))
    return B + from_entries(terms.ratio, terms.row, numbers, shape, is_small(system)) @ of_terms


def row_rates(couplings: Couplings, work: Workspace) -> Array:
    """Rates of the coordinates of all rows, terms included, as `evaluate` left them (n_rows,)."""
    rates = work.couplings.rate.copy()
    np.add.at(rates, couplings.terms.row, couplings.terms.ratio * work.terms.rate)
    return rates


def jacobian(system: System, frame_a: Index, frame_b: Index, B: Array, state: State) -> Matrix:
    """The derivatives of rows as a matrix (n, 6 n_b + n_a).

    B (n, 24): by the coordinates of their frames A and B. Columns: delta x, in space, and
    delta Theta of every body; then the displacements of all active dofs.
    """
    frames, n_q = system.frames, 6 * len(system.bodies.mass)
    entries, numbers, columns = [], [], []
    for first, f in ((0, frame_a), (12, frame_b)):
        body, active = frames.body[f], frames.active[f]
        values = B[:, first : first + 12].copy()
        # Rows have delta X in body axes; assembly and velocities use delta x in space.
        values[:, :3] = np.einsum("ij,ikj->ik", values[:, :3], state.bodies.R[body])
        column = np.hstack([6 * body[:, None] + np.arange(6), n_q + active[:, None] + np.arange(6)])
        rotates = (active >= 0) & (frames.rotations[f] == 1)
        exists = np.repeat(np.stack([body >= 0, active >= 0, rotates], 1), (6, 3, 3), 1)
        entries.append(values[exists])
        numbers.append(np.nonzero(exists)[0])
        columns.append(column[exists])
    shape = len(B), n_q + len(system.elastic.active)
    return from_entries(
        np.concatenate(entries),
        np.concatenate(numbers),
        np.concatenate(columns),
        shape,
        is_small(system),
    )
