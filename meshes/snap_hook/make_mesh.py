"""A cantilever snap-fit hook of 8-node hexahedra, in meters.

    python meshes/snap_hook/make_mesh.py

A beam of 20 x 2 x 6 mm along x from its root at x = 0, with a nose under its end: an upright back
at x = 17 mm, 1 mm high, then 0.4 mm of crest and a ramp to the tip.
"""

from pathlib import Path

import meshio
import numpy as np
import skfem
from skfem.io.meshio import to_meshio

LENGTH, THICKNESS, WIDTH = 0.02, 0.002, 0.006
BACK, CREST, HEIGHT, TIP = 0.017, 0.0004, 0.001, 0.0001
"""of the nose: place along x, length of the crest, height there and at the tip"""
CELLS = 34, 4, 2
"""of the beam along x, y, z"""
CREST_CELLS, RAMP_CELLS, NOSE_CELLS = 4, 26, 2


def hook() -> meshio.Mesh:
    beam, crest = np.linspace(0.0, BACK, CELLS[0] + 1), np.linspace(0.0, CREST, CREST_CELLS + 1)
    ramp = np.linspace(BACK + CREST, LENGTH, RAMP_CELLS + 1)
    x = np.concatenate([beam, BACK + crest[1:], ramp[1:]])
    half = 0.5 * THICKNESS
    y = np.concatenate(
        [np.linspace(-1.0, 0.0, NOSE_CELLS + 1), np.linspace(0.0, 1.0, CELLS[1] + 1)[1:]]
    )
    z = np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, CELLS[2] + 1)
    block = skfem.MeshHex.init_tensor(x, y, z)
    centers = block.p[:, block.t].mean(axis=1)
    block = block.restrict(np.flatnonzero((centers[1] > 0.0) | (centers[0] > BACK)))
    X, Y, Z = block.p
    down = (X - BACK - CREST).clip(0.0) / (LENGTH - BACK - CREST)
    nose = HEIGHT + (TIP - HEIGHT) * down
    place = np.where(Y < 0.0, -half + Y * nose, -half + Y * THICKNESS)
    return to_meshio(skfem.MeshHex(np.array([X, place, Z]), block.t))


if __name__ == "__main__":
    # written by Gmsh's format in doubles, as the other meshes are
    target = Path(__file__).with_name("snap_hook.msh")
    meshio.write(target, hook(), file_format="gmsh22", binary=True)
