"""Exudyn's body in a floating frame, on the modes of Hurty, Craig and Bampton.

The modes are those of its `ComputeHurtyCraigBamptonModes` with rigid interfaces, RBE2: static ones,
six for each interface but the first, and the lowest vibrations with all interfaces held. They are
computed here with our factorization, since SciPy's would take minutes on large meshes; a step does
not know the difference.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from duhamel.preprocess import Body, assemble
from duhamel.preprocess.assembly.structure import Structure
from duhamel.preprocess.solving.factor import factorize
from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface
from exudyn.itemInterface import MarkerSuperElementRigid
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, eigsh

from .run import Array
from .system import System

Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """What Exudyn makes a body of, and the points (n, 3) of its mesh [m]."""

    interface: Any
    points: Array

    def add(
        self,
        system: System,
        position: Sequence[float],
        gravity: Sequence[float],
        velocity: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> int:
        """The number of a body with the origin of its mesh at the position [m]."""
        return self.interface.AddObjectFFRFreducedOrder(
            system.items, positionRef=position, initialVelocity=list(velocity), gravity=gravity
        )["oFFRFreducedOrder"]

    def section(self, x: float) -> Index:
        """The nodes across x."""
        return np.flatnonzero(np.isclose(self.points[:, 0], x))

    def corners(self, x: float) -> Index:
        """The four nodes across x that are farthest out on a square section."""
        section = self.section(x)
        across = self.points[section, 1:]
        return section[
            np.argsort(-np.linalg.norm(across - across.mean(axis=0), axis=1), kind="stable")[:4]
        ]

    def nearest(self, point: Sequence[float]) -> int:
        """The node nearest to the point (3,)."""
        return int(np.argmin(np.linalg.norm(self.points - point, axis=1)))


def rigid_marker(system: System, body: int, nodes: Index) -> int:
    """A frame at the mean of nodes that turns with them."""
    weights = np.full(len(nodes), 1.0 / len(nodes))
    return system.items.AddMarker(
        MarkerSuperElementRigid(
            bodyNumber=body, meshNodeNumbers=nodes.tolist(), weightingFactors=weights.tolist()
        )
    )


def reduced_body(body: Body, held: Sequence[str], modes: int) -> ReducedBody:
    """The body on `modes` modes in all, with the first of the interfaces `held` fixed in its
    floating frame.

    All interfaces of the body are rigid.
    """
    loose = {
        name: interface.model_copy(update={"kind": "average"})
        for name, interface in body.interfaces.items()
    }
    whole, tied = assemble(body.model_copy(update={"interfaces": loose})), assemble(body)
    fem = FEMinterface()
    fem.nodes = {"Position": whole.nodes.points}
    fem.massMatrix, fem.stiffnessMatrix = whole.M.tocsr(), whole.K.tocsr()
    fem.modeBasis = {"matrix": tied.T @ craig_bampton(tied, held, modes), "type": "HCBmodes"}
    return ReducedBody(ObjectFFRFreducedOrderInterface(fem), whole.nodes.points)


def craig_bampton(structure: Structure, held: Sequence[str], modes: int) -> Array:
    """Modes (n_u, modes): static ones of all rigid interfaces `held` but the first, and the lowest
    vibrations.
    """
    names = [interface.name for interface in structure.interfaces]
    rows = structure.P_C.tocsr()
    boundary = np.concatenate([rows[6 * i : 6 * i + 6].indices for i in map(names.index, held)])
    inner = np.setdiff1d(np.arange(structure.n_u), boundary)
    moved = boundary[6:]
    K, M = structure.K.tocsr()[inner], structure.M.tocsr()[inner][:, inner]
    factor = factorize(K[:, inner], "the stiffness with interfaces held")
    solve = LinearOperator(
        K[:, inner].shape, matvec=lambda b: factor(b.reshape(-1, 1)).ravel(), dtype=float
    )
    V = np.zeros((structure.n_u, modes))
    if len(moved):
        V[moved, np.arange(len(moved))] = 1.0
        V[inner, : len(moved)] = -factor(K[:, moved].toarray())
    _, V[inner, len(moved) :] = eigsh(
        K[:, inner], k=modes - len(moved), M=M, sigma=0.0, OPinv=solve
    )
    return V
