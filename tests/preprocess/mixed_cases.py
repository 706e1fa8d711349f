"""Meshes of solids and shells: plates that go on from one to the other, and walls on blocks."""

from typing import Any

import meshio
import numpy as np
from duhamel.preprocess import Body, mesh_of
from duhamel.preprocess.sources.reading import read_mesh_source

IMPULSE = {"step": 1e-4, "steps": 20}
STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}


def grid(*sides: Any) -> tuple[Any, Any]:
    """Points on a grid, and the number of each by its indices."""
    axes = np.meshgrid(*sides, indexing="ij")
    points = np.stack([axis.ravel() for axis in axes], axis=1)
    return points, np.arange(len(points)).reshape(axes[0].shape)


def bricks(numbers: Any) -> Any:
    a, b = slice(None, -1), slice(1, None)
    corners = [
        (a, a, a),
        (b, a, a),
        (b, b, a),
        (a, b, a),
        (a, a, b),
        (b, a, b),
        (b, b, b),
        (a, b, b),
    ]
    return np.stack([numbers[corner].ravel() for corner in corners], axis=1)


def squares(numbers: Any) -> Any:
    a, b = slice(None, -1), slice(1, None)
    return np.stack([numbers[c].ravel() for c in ((a, a), (b, a), (b, b), (a, b))], axis=1)


def merged(parts: list[tuple[Any, str, Any, str]]) -> meshio.Mesh:
    """Parts (points, type, cells, group) with common points as one."""
    points = np.concatenate([part[0] for part in parts])
    _, first, number = np.unique(
        np.round(points, 9), axis=0, return_index=True, return_inverse=True
    )
    cells, sets, start = [], {}, 0
    for i, (own, kind, rows, group) in enumerate(parts):
        cells.append((kind, number.ravel()[start + rows]))
        of_part = [np.zeros(0, dtype=int)] * len(parts)
        of_part[i] = np.arange(len(rows))
        sets[group] = of_part
        start += len(own)
    return meshio.Mesh(points[first], cells, cell_sets=sets)


def placed(mesh: meshio.Mesh, turn: Any = np.eye(3), shift: Any = (0.0, 0.0, 0.0)) -> meshio.Mesh:
    return meshio.Mesh(mesh.points @ turn.T + shift, mesh.cells, cell_sets=mesh.cell_sets)


class Case:
    """The matrices of a mesh of solids and shells, and what they do under loads."""

    def __init__(self, mesh: Any, thickness: Any, material: Any = STEEL, **tables: Any) -> None:
        thickness = thickness if isinstance(thickness, dict) else {"sheet": thickness}
        body = {
            "name": "case",
            "mesh": mesh_of(mesh, shells=thickness),
            "material": material,
            "interfaces": {"corner": {"node": mesh.points[0].tolist()}},
            "impulse": IMPULSE,
        }
        if thickness:
            shells = {
                name: t if isinstance(t, dict) else {"thickness": t}
                for name, t in thickness.items()
            }
            body["shells"] = shells
        self.body = Body.model_validate(body | tables)
        self.source = read_mesh_source(self.body)
        self.K, self.M = self.source.matrices()
        self.nodes = self.source.nodes
        self.points = self.nodes.points

    def at(self, *where: Any) -> Any:
        """The nodes at given coordinates, None for any."""
        on = np.ones(len(self.points), dtype=bool)
        for axis, value in enumerate(where):
            if value is not None:
                on &= np.abs(self.points[:, axis] - value) < 1e-7
        return np.flatnonzero(on)

    def dofs(self, nodes: Any, which: Any = (0, 1, 2, 3, 4, 5)) -> Any:
        found = [
            self.nodes.first[n] + w
            for n in nodes
            for w in which
            if w < 3 or self.nodes.rotations[n]
        ]
        return np.array(found, dtype=int)

    def solve(self, held: Any, f: Any) -> Any:
        import scipy.sparse.linalg as sl

        free = np.setdiff1d(np.arange(self.nodes.n_dofs), held)
        u = np.zeros(self.nodes.n_dofs)
        u[free] = sl.spsolve(self.K.tocsr()[free][:, free].tocsc(), f[free])
        return u

    def frequencies(self, held: Any, count: int) -> Any:
        import scipy.sparse.linalg as sl

        free = np.setdiff1d(np.arange(self.nodes.n_dofs), held)
        K, M = (A.tocsr()[free][:, free].tocsc() for A in (self.K, self.M))
        shift = 1e-4 * K.diagonal().sum() / M.diagonal().sum() * 1e-6
        squares = sl.eigsh(K, count, M, sigma=-shift, return_eigenvectors=False)
        return np.sqrt(np.abs(np.sort(squares))) / (2.0 * np.pi)
