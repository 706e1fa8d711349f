"""Mode shapes, of which only what is asked for is formed."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...superelement.validation import Array
from ..processes import ONE_PROCESS, Processes


@dataclass(frozen=True, eq=False)
class Shapes:
    """Phi = V Q (n_u, m), of the displacements V (n_u, k); V itself without Q (k, m)."""

    V: Array
    Q: Array | None = None
    processes: Processes = ONE_PROCESS

    def __call__(self, rows: Any) -> Array:
        """rows @ Phi (k, m) for sparse rows (k, n_u): chosen dofs, or what is linear in them."""
        found = self.processes.total(at(rows, self.V))
        return found if self.Q is None else found @ self.Q

    def combined(self, Y: Array) -> Array:
        """Phi Y (n_u, k) for modal coordinates Y (m, k)."""
        return np.asarray(self.V @ (Y if self.Q is None else self.Q @ Y))


def at(rows: Any, V: Array) -> Array:
    """rows @ V for sparse rows (k, n_u), of which V is read only where they touch it."""
    rows = rows.tocsc()
    touched = np.flatnonzero(np.diff(rows.indptr))
    return np.asarray(rows[:, touched] @ V[touched])
