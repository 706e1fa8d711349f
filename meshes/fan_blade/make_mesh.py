"""A straight blade of 8-node hexahedra whose tip is round about the axis of its rotor, in meters.

    python meshes/fan_blade/make_mesh.py

100 mm along x from its root, which is 50 mm from the axis of the rotor; 4 mm thick along y, in
which it turns; 16 mm wide along z, the axis. The tip lies on a cylinder of 150 mm about that axis.
"""

from pathlib import Path

import meshio
import numpy as np
import skfem
from skfem.io.meshio import to_meshio

LENGTH, THICKNESS, WIDTH, RIM = 0.1, 0.004, 0.016, 0.05
CELLS = 40, 6, 4
"""along x, y, z"""
ROUNDED = 8
"""power of x by which the rounding fades towards the root"""


def blade() -> meshio.Mesh:
    sizes = (0.0, LENGTH), (-0.5 * THICKNESS, 0.5 * THICKNESS), (-0.5 * WIDTH, 0.5 * WIDTH)
    lines = [np.linspace(*ends, n + 1) for ends, n in zip(sizes, CELLS, strict=True)]
    block = skfem.MeshHex.init_tensor(*lines)
    x, y, z = block.p
    tip = RIM + LENGTH
    rounded = x - (tip - np.sqrt(tip**2 - y**2)) * (x / LENGTH) ** ROUNDED
    return to_meshio(skfem.MeshHex(np.array([rounded, y, z]), block.t))


if __name__ == "__main__":
    # written by Gmsh's format in doubles, as the other meshes are
    target = Path(__file__).with_name("fan_blade.msh")
    meshio.write(target, blade(), file_format="gmsh22", binary=True)
