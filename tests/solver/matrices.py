"""The blocks of the iteration matrix as a dense matrix."""

import numpy as np
from duhamel.solver.step.records.matrix import Pattern
from duhamel.solver.step.system import State, System


def dense(pattern: Pattern, S: np.ndarray) -> np.ndarray:
    """All blocks, unknowns in the order of the nodes."""
    first = pattern.first
    matrix = np.zeros((first[-1], first[-1]))
    for k, (n, width) in enumerate(zip(pattern.size, pattern.width, strict=True)):
        later = pattern.later[pattern.later_range[k] : pattern.later_range[k + 1]]
        own = np.arange(first[k], first[k + 1])
        columns = np.concatenate([own, *(np.arange(first[i], first[i + 1]) for i in later)])
        matrix[np.ix_(own, columns)] = S[pattern.row[k] :][: n * width].reshape(n, width)
        matrix[np.ix_(columns[n:], own)] = S[pattern.lower[k] :][: n * (width - n)].reshape(-1, n)
    return matrix


def in_space(system: System, state: State, S: np.ndarray) -> np.ndarray:
    """The same for delta x, in space, and delta Theta of every body, all active dofs, all rows;
    forces in space too.
    """
    pattern, first = system.pattern, system.pattern.first
    bodies = [np.arange(6) + first[k] for k in pattern.body]
    flexible = system.elastic.body
    active = [np.arange(first[k] + 6, first[k + 1]) for k in pattern.body[flexible]]
    rows = [np.arange(first[k], first[k + 1]) for k in pattern.coupling if k >= 0]
    order = np.concatenate([*bodies, *active, *rows]).astype(int)
    turn = np.eye(len(order))
    for b, R in enumerate(state.bodies.R):
        turn[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = R
    return turn @ dense(pattern, S)[np.ix_(order, order)] @ turn.T
