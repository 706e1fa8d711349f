"""The mesh of an angle of steel plate in hexahedra: two legs with stiff blocks at their ends.

python meshes/angle/make_mesh.py
"""

from pathlib import Path

import meshio
import numpy as np

X = (0.0, 10.0, 25.0, *np.linspace(45.0, 260.0, 9), 280.0, 300.0)
Y = (0.0, 25.0, 50.0)
Z = (0.0, 10.0, 30.0, 60.0, 87.5, 115.0, 132.5, 150.0)
"""planes between elements [mm]"""
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
EDGES = ["01", "12", "23", "30", "45", "56", "67", "74", "04", "15", "26", "37"]


def angle_mesh() -> meshio.Mesh:
    """Legs of 10 mm, 300 and 150 mm long, 50 mm wide, in hexahedra of 20 nodes [m]."""
    x, y, z = (np.sort([*planes, *(np.add(planes[1:], planes[:-1]) / 2)]) for planes in (X, Y, Z))
    middles = [CORNERS[int(a)] + CORNERS[int(b)] for a, b in EDGES]
    local = np.vstack([2 * CORNERS, middles])
    cells = [cell for cell in np.ndindex(len(X) - 1, len(Y) - 1, len(Z) - 1) if is_solid(*cell)]
    every = (2 * np.array(cells)[:, None] + local).reshape(-1, 3)
    nodes, numbers = np.unique(every, axis=0, return_inverse=True)
    points = 1e-3 * np.column_stack([x[nodes[:, 0]], y[nodes[:, 1]], z[nodes[:, 2]]])
    return meshio.Mesh(points, [("hexahedron20", numbers.reshape(-1, 20))])


def is_solid(i: int, j: int, k: int) -> bool:
    """Whether there is an element: in the legs, or in the blocks at their ends."""
    x, z = 0.5 * (X[i] + X[i + 1]), 0.5 * (Z[k] + Z[k + 1])
    return z < 10 or x < 10 or (x > 260 and z < 30) or (z > 115 and x < 25)


if __name__ == "__main__":
    angle_mesh().write(Path(__file__).with_name("angle.vtu"))
