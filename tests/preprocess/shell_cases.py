"""Grids of shells over the unit square, and what they do under loads."""

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse.linalg as sl
from duhamel.preprocess import Body, mesh_of
from duhamel.preprocess.sources.shells import ShellSource

KINDS = ("quad", "triangle")
IMPULSE = {"step": 1e-4, "steps": 20}


def cells_of_grid(numbers: Any, kind: str) -> Any:
    """The quadrangles of a grid of numbers, or their halves."""
    corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    quads = np.stack(corners, axis=2).reshape(-1, 4)
    halves = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return quads if kind == "quad" else halves


class Sheet:
    """Shells of one type with their matrices, and what they do under loads."""

    def __init__(
        self,
        points: Any,
        kind: str,
        cells: Any,
        *,
        thickness: float | None,
        E: float = 1.0,
        nu: float = 0.0,
        rho: float = 1.0,
        material: Any = None,
        **shell: Any,
    ) -> None:
        body = {
            "name": "grid",
            "mesh": mesh_of((points, {kind: cells})),
            "shell": shell if thickness is None else {"thickness": thickness, **shell},
            "material": material or {"E": E, "nu": nu, "rho": rho},
            "interfaces": {"corner": {"node": points[0].tolist()}},
            "impulse": IMPULSE,
        }
        self.body = Body.model_validate(body)
        self.source = ShellSource(self.body.mesh, self.body)
        self.points = self.source.mesh.points
        self.K, self.M = self.source.matrices()

    def dofs(self, nodes: Any, *which: int) -> Any:
        return (6 * np.asarray(nodes)[:, None] + np.array(which or range(6))).ravel()

    def load(self, forces: dict[int, float], nodes: Any, weights: Any = None) -> Any:
        """Forces and moments by direction, spread over nodes."""
        weights = np.full(len(nodes), 1.0 / len(nodes)) if weights is None else weights
        f = np.zeros(self.K.shape[0])
        for which, force in forces.items():
            f[6 * np.asarray(nodes) + which] = force * weights
        return f

    def solve(self, held: Any, f: Any, given: Any = 0.0) -> Any:
        """Displacements (n, 6) under loads f, with held dofs at given values."""
        free = np.setdiff1d(np.arange(self.K.shape[0]), held)
        u = np.zeros(self.K.shape[0])
        u[held] = given
        K = self.K.tocsr()[free]
        u[free] = sl.spsolve(K[:, free].tocsc(), f[free] - K[:, held] @ u[held])
        return u.reshape(-1, 6)

    def frequencies(self, held: Any, count: int) -> Any:
        """The lowest frequencies [Hz] with held dofs."""
        free = np.setdiff1d(np.arange(self.K.shape[0]), held)
        K, M = (A.tocsr()[free][:, free].tocsc() for A in (self.K, self.M))
        shift = 1e-4 * K.diagonal().sum() / M.diagonal().sum()
        squares = sl.eigsh(K, count, M, sigma=-shift, return_eigenvectors=False)
        return np.sqrt(np.abs(np.sort(squares))) / (2.0 * np.pi)


class Grid(Sheet):
    """A grid of n_r by n_s shells, mapped to space by place(r, s).

    r, s (n,): the parameters of the nodes.
    """

    def __init__(
        self,
        place: Callable[[float, float], Any],
        n: tuple[int, int],
        kind: str = "quad",
        **given: Any,
    ) -> None:
        r, s = np.meshgrid(*(np.linspace(0.0, 1.0, k + 1) for k in n), indexing="ij")
        self.r, self.s = r.ravel(), s.ravel()
        points = np.array([place(a, b) for a, b in zip(self.r, self.s, strict=True)])
        numbers = np.arange(len(points)).reshape(r.shape)
        super().__init__(points, kind, cells_of_grid(numbers, kind), **given)

    def at(self, r: float | None = None, s: float | None = None) -> Any:
        """The nodes on a line or at a point of the grid."""
        on = np.ones(len(self.r), dtype=bool)
        for given, found in ((r, self.r), (s, self.s)):
            on &= True if given is None else np.abs(found - given) < 1e-9
        return np.flatnonzero(on)
