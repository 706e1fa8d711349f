"""Meshes of solids and shells: plates that go on from one to the other, and walls on blocks."""

from typing import Any

import meshio
import numpy as np
import scipy.sparse.linalg as sl
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
        earlier = sets.get(group, of_part)
        sets[group] = [np.union1d(*both).astype(int) for both in zip(earlier, of_part, strict=True)]
        start += len(own)
    return meshio.Mesh(points[first], cells, cell_sets=sets)


def placed(mesh: meshio.Mesh, turn: Any, shift: Any) -> meshio.Mesh:
    return meshio.Mesh(mesh.points @ turn.T + shift, mesh.cells, cell_sets=mesh.cell_sets)


EDGES = {
    "hexahedron": [
        *[(i, (i + 1) % 4) for i in range(4)],
        *[(4 + i, 4 + (i + 1) % 4) for i in range(4)],
    ]
    + [(i, i + 4) for i in range(4)],
    "quad": [(i, (i + 1) % 4) for i in range(4)],
    "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "triangle": [(0, 1), (1, 2), (2, 0)],
}
OF_SECOND = {
    "hexahedron": "hexahedron20",
    "quad": "quad8",
    "tetra": "tetra10",
    "triangle": "triangle6",
}
TETRAHEDRA = [[0, 1, 3, 7], [0, 1, 7, 5], [0, 5, 7, 4], [1, 2, 3, 7], [1, 2, 7, 6], [1, 6, 7, 5]]


def simplices(kind: str, cells: Any) -> tuple[str, Any]:
    """Hexahedra as six tetrahedra each, quadrangles as two triangles."""
    parts = TETRAHEDRA if kind == "hexahedron" else [[0, 1, 2], [0, 2, 3]]
    of = "tetra" if kind == "hexahedron" else "triangle"
    return of, np.concatenate([cells[:, part] for part in parts])


def second_order(points: Any, kind: str, cells: Any) -> tuple[Any, str, Any]:
    """The same with nodes in the middle of all edges."""
    middles = [points[cells[:, [a, b]]].mean(axis=1) for a, b in EDGES[kind]]
    more = np.stack(middles, axis=1)
    numbers = len(points) + np.arange(more.shape[0] * more.shape[1]).reshape(more.shape[:2])
    return np.vstack([points, more.reshape(-1, 3)]), OF_SECOND[kind], np.hstack([cells, numbers])


def half_and_half(
    n: tuple[int, int, int] = (6, 3, 4),
    *,
    size: tuple[float, float, float] = (0.5, 0.2, 0.04),
    order: int = 1,
    split: bool = False,
    all_of: str = "",
) -> meshio.Mesh:
    """A plate that is of solids up to its middle, and of shells beyond; or all of one of them."""
    (length, width, t), (nx, ny, nz) = size, n
    end, start = (2 * length, 0.0) if all_of else (length, length)
    steps = 2 * nx + 1 if all_of else nx + 1
    across = np.linspace(0.0, width, ny + 1)
    parts = []
    if all_of != "sheet":
        points, numbers = grid(
            np.linspace(0, end, steps), across, np.linspace(-t / 2, t / 2, nz + 1)
        )
        parts.append((points, "hexahedron", bricks(numbers), "block"))
    if all_of != "block":
        flat, numbers = grid(np.linspace(start, 2 * length, steps), across)
        points = np.column_stack([flat, np.zeros(len(flat))])
        parts.append((points, "quad", squares(numbers), "sheet"))
    if split:
        parts = [(p, *simplices(kind, cells), name) for p, kind, cells, name in parts]
    if order == 2:
        parts = [(*second_order(p, kind, cells), name) for p, kind, cells, name in parts]
    return merged(parts)


def wall(
    t: float = 0.02,
    n_t: int = 2,
    n: int = 6,
    *,
    slope: float = 0.0,
    x: float = 0.0,
    solid: bool = False,
) -> meshio.Mesh:
    """A wall of height 0.2 on a block, in whose middle it stands unless its place x is given."""
    inner = np.linspace(-t / 2, t / 2, n_t + 1)
    left, right = np.linspace(-0.1, -t / 2, n), np.linspace(t / 2, 0.1, n)
    across = np.concatenate([left, inner[1:-1], right])
    along, up = np.linspace(0.0, 0.2, n + 1), np.linspace(0.0, 0.2, n + 3)
    points, numbers = grid(across, along, np.linspace(-0.08, 0.0, 4))
    parts = [(points, "hexahedron", bricks(numbers), "block")]
    if solid:
        points, numbers = grid(inner, along, up)
        parts.append((points, "hexahedron", bricks(numbers), "block"))
    else:
        flat, numbers = grid(along, up)
        place = across[np.abs(across - x).argmin()]
        points = np.column_stack([place + slope * flat[:, 1], flat])
        parts.append((points, "quad", squares(numbers), "sheet"))
    return merged(parts)


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
        free = np.setdiff1d(np.arange(self.nodes.n_dofs), held)
        u = np.zeros(self.nodes.n_dofs)
        u[free] = sl.spsolve(self.K.tocsr()[free][:, free].tocsc(), f[free])
        return u

    def frequencies(self, held: Any, count: int) -> Any:
        free = np.setdiff1d(np.arange(self.nodes.n_dofs), held)
        K, M = (A.tocsr()[free][:, free].tocsc() for A in (self.K, self.M))
        shift = 1e-5 * K.diagonal().sum() / M.diagonal().sum()
        squares = sl.eigsh(K, count, M, sigma=-shift, return_eigenvectors=False)
        return np.sqrt(np.abs(np.sort(squares))) / (2.0 * np.pi)
