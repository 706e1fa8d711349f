"""A bracket with six holes, in millimeters: groups bolt_1 to bolt_4, lug_1 and lug_2, the holes,
and bracket.

    python meshes/bracket/make_mesh.py [--size MILLIMETRES] [-o FILE.msh]

A plate in the plane of x and y with a hole for a bolt near each corner; across its middle stand two
walls, each with a hole along x, for a pin through both. Tetrahedra of 10 nodes follow the holes.
"""

from argparse import ArgumentParser
from pathlib import Path

import gmsh

PLATE = (120.0, 80.0, 10.0)
"""along x, y and z; the underside is at z = 0"""
BOLTS, BOLT = (48.0, 28.0), 5.5
"""places on x and y, on both sides of the middle, and radius"""
WALLS, WALL = 20.0, 10.0
"""place on x of the middle of a wall, on both sides of the middle, and thickness"""
HEIGHT, WIDTH, PIN = 50.0, 17.0, 9.0
"""of the walls: height of the pin, half the width, which is the radius at the top too; radius of
the pin
"""
BLEND = 6.0
"""radius where walls meet the plate"""
SIZE = 10.0

Shape = list[tuple[int, int]]
"""Volumes as (dimension, tag)."""


def bracket() -> None:
    """The solid, and its groups."""
    occ = gmsh.model.occ
    x, y, z = PLATE
    parts: Shape = [(3, occ.addBox(-0.5 * x, -0.5 * y, 0.0, x, y, z))]
    for side in (-1.0, 1.0):
        face = side * WALLS - 0.5 * WALL
        parts.append((3, occ.addBox(face, -WIDTH, 0.0, WALL, 2.0 * WIDTH, HEIGHT)))
        parts.append((3, occ.addCylinder(face, 0.0, HEIGHT, WALL, 0.0, 0.0, WIDTH)))
    whole, _ = occ.fuse(parts[:1], parts[1:])
    bolts = [
        (side_x * BOLTS[0], side_y * BOLTS[1]) for side_x in (-1.0, 1.0) for side_y in (-1.0, 1.0)
    ]
    holes = [(3, occ.addCylinder(x, y, 0.0, 0.0, 0.0, z, BOLT)) for x, y in bolts]
    pin = [(3, occ.addCylinder(-PLATE[0], 0.0, HEIGHT, 2.0 * PLATE[0], 0.0, 0.0, PIN))]
    solid, _ = occ.cut(blended(whole), holes + pin)
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in solid], name="bracket")
    for n, (x, y) in enumerate(bolts):
        name_hole(f"bolt_{n + 1}", (x, y, 0.5 * z), (BOLT, BOLT, 0.5 * z))
    for n, x in enumerate((-WALLS, WALLS)):
        name_hole(f"lug_{n + 1}", (x, 0.0, HEIGHT), (0.5 * WALL, PIN, PIN))


def blended(whole: Shape) -> Shape:
    """The edges where walls meet the plate rounded."""
    occ = gmsh.model.occ
    occ.synchronize()
    margin, top = 1e-3, PLATE[2]
    x = WALLS + 0.5 * WALL + margin
    low, high = (-x, -WIDTH - margin, top - margin), (x, WIDTH + margin, top + margin)
    edges = gmsh.model.getEntitiesInBoundingBox(*low, *high, dim=1)
    return list(occ.fillet([tag for _, tag in whole], [tag for _, tag in edges], [BLEND]))


def name_hole(name: str, middle: tuple[float, ...], half: tuple[float, ...]) -> None:
    """Group the surfaces in a box."""
    low, high = (
        [m + side * (h + 1e-3) for m, h in zip(middle, half, strict=True)] for side in (-1.0, 1.0)
    )
    surfaces = gmsh.model.getEntitiesInBoundingBox(*low, *high, dim=2)
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in surfaces], name=name)


def write(size: float, target: Path) -> None:
    """Mesh with elements of `size` and write Gmsh's binary format."""
    gmsh.initialize(interruptible=False)
    for option, value in {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Mesh.MeshSizeMax": size,
        "Mesh.MeshSizeMin": 0.5 * size,
        "Mesh.MeshSizeFromCurvature": 12,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 2,
        "Mesh.MshFileVersion": 2.2,
        "Mesh.Binary": 1,
    }.items():
        gmsh.option.setNumber(option, value)
    bracket()
    gmsh.model.mesh.generate(3)
    gmsh.write(str(target))
    gmsh.finalize()


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=float, default=SIZE, help="of the elements [mm]")
    parser.add_argument(
        "-o", "--output", type=Path, default=Path(__file__).with_name("bracket.msh")
    )
    given = parser.parse_args()
    write(given.size, given.output)
