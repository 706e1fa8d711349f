"""A spur gear with involute teeth in 8-node hexahedra, about z: groups bore, teeth and gear.

    python meshes/spur_gear/make_mesh.py

20 teeth of module 2 mm with a pressure angle of 20 degrees, 3 mm wide. Tooth 0 lies along x. Two
such gears at the distance CENTERS have a backlash of BACKLASH along the line of action. `teeth` are
the flanks of the teeth that are nearest to x, without the faces and the tips.
"""

from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

MODULE, TEETH, PRESSURE_ANGLE = 0.002, 20, np.deg2rad(20.0)
PITCH = 0.5 * MODULE * TEETH
BASE, TIP, ROOT = PITCH * np.cos(PRESSURE_ANGLE), PITCH + MODULE, PITCH - 1.25 * MODULE
BORE, WIDTH = 0.008, 0.003
CENTERS = 2.0 * PITCH
BACKLASH = 6e-5
"""along the line of action: half of it is cut from the teeth of each of two gears [m]"""
FILLET = 0.0007
"""radius between the flank and the root [m]"""
ACROSS, UP, GAP, RINGS = 8, 20, 3, 6
"""elements across a tooth, along a flank, along the root between teeth, and from there to the bore
"""
MESHING = -2, -1, 0, 1, 2
"""teeth whose flanks are a surface"""

Array = NDArray[np.float64]


def half_angle(r: Array) -> Array:
    """Half the angle of a tooth at the radius r."""
    involute = np.sqrt(np.maximum((r / BASE) ** 2 - 1.0, 0.0))
    involute -= np.arctan(involute)
    at_pitch = np.tan(PRESSURE_ANGLE) - PRESSURE_ANGLE
    angle = 0.5 * np.pi / TEETH - 0.25 * BACKLASH / BASE + at_pitch - involute
    over = np.maximum(FILLET - (r - ROOT), 0.0)
    return angle + (FILLET - np.sqrt(FILLET**2 - over**2)) / r


def tooth(s: Array, t: Array) -> tuple[Array, Array]:
    """Radius and angle from the middle of a tooth, s from -1 to 1 across it, t from 0 to 1 up."""
    # finer towards the root, where the fillet is
    r = ROOT + (TIP - ROOT) * t * (0.8 + 0.2 * t)
    return r, s * half_angle(r)


def section() -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """Points (n, 2) and quadrilaterals (m, 4) of the section, and edges (k, 2) of its flanks."""
    pitch = 2.0 * np.pi / TEETH
    quads, flanks = [], []
    for k in range(TEETH):
        s, t = np.meshgrid(np.linspace(-1, 1, ACROSS + 1), np.linspace(0, 1, UP + 1))
        r, angle = tooth(s, t)
        grid = polar(r, angle + k * pitch)
        quads.append(cells(grid))
        if (k + TEETH // 2) % TEETH - TEETH // 2 in MESHING:
            # the body is to the left of an edge, seen along z
            flanks += list(zip(grid[1:, 0], grid[:-1, 0], strict=True))
            flanks += list(zip(grid[:-1, -1], grid[1:, -1], strict=True))
        # from the middle of the gap before the tooth to the middle of that after it
        edge = tooth(np.ones(1), np.zeros(1))[1][0]
        beside = np.linspace(edge, pitch - edge, GAP + 1)
        angles = np.concatenate([angle[0], beside[1:]])
        radii = np.linspace(BORE, ROOT, RINGS + 1)
        quads.append(cells(polar(*np.broadcast_arrays(radii[:, None], angles + k * pitch))))
    every = np.concatenate(quads).reshape(-1, 2)
    edges = np.array(flanks).reshape(-1, 2)
    points, numbers = np.unique(
        np.round(np.concatenate([every, edges]), 10) + 0.0, axis=0, return_inverse=True
    )
    numbers = numbers.ravel()
    return points, numbers[: len(every)].reshape(-1, 4), numbers[len(every) :].reshape(-1, 2)


def polar(r: Array, angle: Array) -> Array:
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1)


def cells(grid: Array) -> Array:
    """Corners (n, 4, 2) of the quadrilaterals of a grid, radii first, counterclockwise."""
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    return np.stack(corners, axis=2).reshape(-1, 4, 2)


def gear() -> meshio.Mesh:
    points, quads, flanks = section()
    n = len(points)
    low, high = (np.column_stack([points, np.full(n, z)]) for z in (-0.5 * WIDTH, 0.5 * WIDTH))
    bricks = np.hstack([quads, quads + n])
    sides = np.column_stack([flanks, flanks[:, ::-1] + n])
    on_bore = np.abs(np.hypot(*points.T) - BORE) < 1e-9
    inner = np.array([quad[[3, 0]] for quad in quads if on_bore[quad[[0, 3]]].all()])
    bore = np.column_stack([inner, inner[:, ::-1] + n])
    groups = [np.full(len(block), k + 1) for k, block in enumerate((bore, sides, bricks))]
    names = {"bore": (1, 2), "teeth": (2, 2), "gear": (3, 3)}
    return meshio.Mesh(
        np.concatenate([low, high]),
        [("quad", bore), ("quad", sides), ("hexahedron", bricks)],
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
        field_data={name: np.array(value) for name, value in names.items()},
    )


if __name__ == "__main__":
    # written by Gmsh's format in doubles, as the other meshes are
    target = Path(__file__).with_name("spur_gear.msh")
    meshio.write(target, gear(), file_format="gmsh22", binary=True)
