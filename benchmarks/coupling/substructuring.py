"""Frequency-based substructuring: virtual points, and the coupling of their responses.

    Y_v = R_o^+ H (R_i^+)^T,     Y_AB = Y - Y B^T (B Y B^T)^-1 B Y

Sources: van der Seijs, van den Bosch, Rixen and de Klerk, An improved methodology for the virtual
point transformation, Mech. Syst. Signal Process. 2016; de Klerk, Rixen and de Jong, The frequency
based substructuring (FBS) method reformulated according to the dual domain decomposition method,
IMAC 2006.
"""

import numpy as np
from scipy.linalg import block_diag

from .hammer import AROUND, HITS, SENSORS, HammerTest, truth
from .parts import Array, ComplexArray, cross


def virtual_points(test: HammerTest) -> ComplexArray:
    """Accelerances (k, 12, 12) of foot and top, each by its own sensors and hits."""
    outputs, inputs, channels, columns = [], [], [], []
    for name, sensors in AROUND.items():
        X_v, hits = truth().part.place(name), test.hits_of(name)
        outputs.append(
            np.vstack([_rows(np.eye(3), np.array(SENSORS[label]) - X_v) for label in sensors])
        )
        inputs.append(
            np.vstack([_rows(np.array([HITS[hit][1]]), HITS[hit][0] - X_v) for hit in hits])
        )
        at = [3 * list(SENSORS).index(label) for label in sensors]
        channels += [k + axis for k in at for axis in range(3)]
        columns += [test.hits.index(hit) for hit in hits]
    R_o, R_i = block_diag(*outputs), block_diag(*inputs)
    H = test.H[:, channels][:, :, columns]
    return np.asarray(np.linalg.pinv(R_o) @ H @ np.linalg.pinv(R_i).T)


def _rows(directions: Array, lever: Array) -> Array:
    """[e, lever x e] of each direction e."""
    return np.hstack([directions, directions @ cross(lever).T])


def coupled(Y_A: ComplexArray, Y_B: ComplexArray) -> ComplexArray:
    """LM-FBS: Y_A (k, 12, 12) of foot and top, Y_B (k, 9, 9) of root and tip; its result is
    (k, 9, 9), of top and tip. The foot is on the root.
    """
    k, n_A, n_B = len(Y_A), Y_A.shape[1], Y_B.shape[1]
    Y = np.zeros((k, n_A + n_B, n_A + n_B), dtype=complex)
    Y[:, :n_A, :n_A], Y[:, n_A:, n_A:] = Y_A, Y_B
    B = np.zeros((6, n_A + n_B))
    B[:, :6], B[:, n_A : n_A + 6] = np.eye(6), -np.eye(6)
    whole = Y - Y @ B.T @ np.linalg.solve(B @ Y @ B.T, B @ Y)
    kept = np.r_[6:n_A, n_A + 6 : n_A + n_B]
    return np.asarray(whole[:, kept][:, :, kept])
