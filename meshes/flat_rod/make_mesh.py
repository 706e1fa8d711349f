"""A square steel rod of 8-node hexahedra, in meters.

    python meshes/flat_rod/make_mesh.py

8 x 8 mm and 100 mm long along x, from x = 0; its elements are 2 mm long.
"""

from pathlib import Path

import meshio
import numpy as np
import skfem
from skfem.io.meshio import to_meshio

LENGTH, WIDTH = 0.1, 0.008
CELLS = 50, 4


def rod() -> meshio.Mesh:
    side = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, CELLS[1] + 1)
    block = skfem.MeshHex.init_tensor(np.linspace(0.0, LENGTH, CELLS[0] + 1), side, side)
    return to_meshio(block)


if __name__ == "__main__":
    # written by Gmsh's format in doubles, as the other meshes are
    target = Path(__file__).with_name("flat_rod.msh")
    meshio.write(target, rod(), file_format="gmsh22", binary=True)
