"""The unknowns of a finite element model: nodes with three or six dofs each."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...superelement.validation import Array
from .mesh import IntArray


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes at points (n, 3) [m] in mesh coordinates, with six dofs where `rotations` (n,), else
    three.

    The dofs of the nodes follow each other in the order of the nodes. Behind them come
    `generalized` ones: amplitudes of shapes of a reduced model that leave all nodes at rest.
    """

    points: Array
    rotations: NDArray[np.bool_]
    generalized: int = 0

    @cached_property
    def first(self) -> IntArray:
        """The first dof of each node (n,)."""
        return np.concatenate([[0], np.cumsum(self._counts)[:-1]]).astype(np.int64)

    @property
    def n_dofs(self) -> int:
        return int(self._counts.sum()) + self.generalized

    @property
    def owner(self) -> IntArray:
        """The node of each dof (n_dofs,), -1 of generalized ones."""
        of_nodes = np.repeat(np.arange(len(self.points)), self._counts)
        return np.concatenate([of_nodes, np.full(self.generalized, -1)])

    @property
    def displacements(self) -> IntArray:
        """The dofs of the displacements (n, 3)."""
        return self.first[:, None] + np.arange(3)

    @property
    def _counts(self) -> IntArray:
        return np.where(self.rotations, 6, 3)

    def rigid_motion(self, center: Array) -> Array:
        """A (n_dofs, 6): dofs under unit translations and unit small rotations about `center`.

        A = [I, -(X - center)~; 0, I] at each node; the second row for nodes with rotations. No
        generalized dof takes part.
        """
        motion = spider(self.points - center)
        A = np.zeros((self.n_dofs, 6))
        A[self.displacements] = motion
        turning = self.first[self.rotations][:, None] + np.arange(3, 6)
        A[turning, np.arange(3, 6)] = 1.0
        return A


def spider(arms: Array) -> Array:
    """[I, -r~] (n, 3, 6): displacements at the ends of rigid arms r (n, 3) [m].

    Under displacement and small rotation of the point from which they reach.
    """
    x, y, z = arms.T
    o, one = np.zeros_like(x), np.ones_like(x)
    rows = [[one, o, o, o, z, -y], [o, one, o, -z, o, x], [o, o, one, y, -x, o]]
    return np.array(rows).transpose(2, 0, 1)


def node_dofs(cells: IntArray, per_node: int) -> IntArray:
    """The dofs (n, k * per_node) of elements (n, k) whose nodes all have `per_node` dofs."""
    return (per_node * cells[:, :, None] + np.arange(per_node)).reshape(len(cells), -1)
