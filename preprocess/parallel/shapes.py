"""Mode shapes whose rows are spread over processes: the first one asks, the others answer."""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from mpi4py import MPI

from ...superelement.validation import Array
from ..mesh.mesh import IntArray
from ..responses.shapes import Shapes, at
from .ranks import Ranks


@dataclass(frozen=True, eq=False)
class AskedShapes(Shapes):
    """Phi = V Q (n_u, m) in the first process, which has its own rows of V alone.

    A call takes rows (k, n_u) of the whole body; the other processes are in `answer` meanwhile,
    until `close`. starts (n_processes + 1,): where the unknowns of each process begin.
    """

    ranks: Ranks = field(kw_only=True)
    starts: IntArray = field(kw_only=True)

    def __call__(self, rows: Any) -> Array:
        columns = rows.tocsc()
        # Only the columns of a process, which are few, travel to it.
        shares = [columns[:, first:last] for first, last in pairwise(self.starts.tolist())]
        part = at(self.ranks.comm.scatter(shares), self.V)
        found = np.empty_like(part, order="C")
        self.ranks.comm.Reduce(np.ascontiguousarray(part), found, op=MPI.SUM)
        return found if self.Q is None else found @ self.Q

    def close(self) -> None:
        """Nothing more is asked."""
        self.ranks.comm.scatter([None] * self.ranks.size)


def answer(shapes: Shapes, ranks: Ranks) -> None:
    """Add the own part of what the first process asks for, until it asks no more."""
    while (rows := ranks.comm.scatter(None)) is not None:
        ranks.comm.Reduce(np.ascontiguousarray(at(rows, shapes.V)), None, op=MPI.SUM)
