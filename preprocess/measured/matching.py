"""Which measured mode is which of a model, by the modal assurance criterion.

    MAC_ij = (a_i . b_j)^2 / ((a_i . a_i) (b_j . b_j))

of shapes at the same channels. Source: R. J. Allemang: The modal assurance criterion, twenty years
of use and abuse, Sound and Vibration 37 (2003).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ...superelement.validation import Array

WIDEST_RATIO = 2.0
"""of the frequencies of a pair"""
RIVAL_RATIO = 1.2
"""of the frequencies of a pair between which another mode of the model would do as well"""


@dataclass(frozen=True, eq=False)
class Matches:
    """Pairs of modes: the `mode` (m,) of the model of each measured one, -1 where there is none;
    its mac (m,), the best one that it has where there is no pair; `rivals` (m,): modes of the model
    that would do as well, by their MAC, -1 where there is none.
    """

    mode: NDArray[np.int64]
    mac: Array
    rivals: NDArray[np.int64]


def mac(a: Array, b: Array) -> Array:
    """The modal assurance criterion (k, m) of shapes a (k, n) and b (m, n)."""
    norms = np.outer((a * a).sum(axis=1), (b * b).sum(axis=1))
    # A mode that no channel sees is like no other one.
    table: Array = np.divide((a @ b.T) ** 2, norms, out=np.zeros_like(norms), where=norms > 0.0)
    return table


def matched(measured: tuple[Array, Array], model: tuple[Array, Array], least_mac: float) -> Matches:
    """Measured modes and modes of a model, each frequencies (k,) and shapes (k, n), pair by pair.

    No mode is in two pairs: of all assignments that with the largest sum of MAC, of pairs with at
    least `least_mac` and frequencies within a factor of `WIDEST_RATIO`.
    """
    table = mac(measured[1], model[1])
    ratio = model[0][None, :] / measured[0][:, None]
    table[(ratio > WIDEST_RATIO) | (ratio < 1.0 / WIDEST_RATIO)] = 0.0
    # Pairs that do not count must not push one that does to a worse place.
    rows, columns = linear_sum_assignment(np.where(table >= least_mac, table, 0.0), maximize=True)
    # An assignment pairs as many as it can, also with a MAC of zero.
    mode = np.full(len(table), -1, dtype=np.int64)
    paired = table[rows, columns] >= least_mac
    mode[rows[paired]] = columns[paired]
    best = table.max(axis=1, initial=0.0)
    own = np.where(mode >= 0, table[np.arange(len(table)), np.maximum(mode, 0)], best)
    # A mode that has a partner of its own is no rival.
    others = np.where((ratio < RIVAL_RATIO) & (ratio > 1.0 / RIVAL_RATIO), table, 0.0)
    others[mode >= 0, mode[mode >= 0]] = 0.0
    rivals = np.where((mode >= 0) & (others.max(axis=1) >= least_mac), others.argmax(axis=1), -1)
    return Matches(mode, own, rivals)
