"""A connecting rod with two bores, in millimeters: groups big_end and small_end, its bores, and
rod.

    python meshes/connecting_rod/make_mesh.py [--size MILLIMETRES] [-o FILE.msh]

The rod lies along x, with the axis of the big end on z; its shank is an I. Tetrahedra of 10 nodes
follow the bores. The elements of rod.msh are of 7.5 mm, 21 thousand unknowns; --size 3 makes 96
thousand (fine.toml), --size 1.2 a million.
"""

from argparse import ArgumentParser
from pathlib import Path

import gmsh

LENGTH = 150.0
"""between the axes of the bores"""
BIG, SMALL = (22.0, 31.0), (10.0, 17.0)
"""radius of the bore, and of the eye around it"""
EYE, SHANK, WEB = 22.0, 16.0, 6.0
"""thickness, along z"""
ROOT, NECK = 16.0, 11.0
"""half the height of the shank at the axes of the big and the small end"""
FLANGE, POCKET = 5.0, (40.0, 124.0)
"""height of the flanges of the I, and where the pockets between them begin and end"""
BLEND, CORNER = 12.0, 3.5
"""radii where the shank meets the eyes, and in the corners of the pockets"""
SIZE = 7.5
SMOOTH = 2.0
"""elements below that follow the bores without smoothing, which takes gigabytes"""

Shape = list[tuple[int, int]]
"""Volumes as (dimension, tag)."""


def connecting_rod() -> None:
    """The solid, and its groups."""
    occ = gmsh.model.occ
    blank, _ = occ.fuse(shank(0.0, LENGTH, 0.0, SHANK), eyes(BIG[1], SMALL[1], SHANK))
    eye_to_eye, _ = occ.fuse(
        rounded(blank, 0.5 * BIG[1], LENGTH, BLEND), eyes(BIG[1], SMALL[1], EYE)
    )
    depth = 0.5 * (SHANK - WEB)
    pockets = [shank(*POCKET, FLANGE, depth, side * 0.5 * (WEB + depth)) for side in (-1.0, 1.0)]
    milled = [volume for pocket in pockets for volume in rounded(pocket, *POCKET, CORNER)]
    rod, _ = occ.cut(eye_to_eye, milled + eyes(BIG[0], SMALL[0], EYE))
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in rod], name="rod")
    for name, x, radius in (("big_end", 0.0, BIG[0]), ("small_end", LENGTH, SMALL[0])):
        r = radius + 1e-3
        bore = gmsh.model.getEntitiesInBoundingBox(x - r, -r, -EYE, x + r, r, EYE, dim=2)
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in bore], name=name)


def shank(start: float, end: float, inset: float, thickness: float, z: float = 0.0) -> Shape:
    """A prism about the plane z, `inset` lower on both sides than the outline of the shank."""
    occ = gmsh.model.occ
    heights = [ROOT + (NECK - ROOT) * x / LENGTH - inset for x in (start, end)]
    outline = [(start, -heights[0]), (end, -heights[1]), (end, heights[1]), (start, heights[0])]
    corners = [occ.addPoint(x, y, z - 0.5 * thickness) for x, y in outline]
    edges = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(edges)])
    return [part for part in occ.extrude([(2, face)], 0.0, 0.0, thickness) if part[0] == 3]


def eyes(big: float, small: float, thickness: float) -> Shape:
    """Cylinders of two radii about the axes of both ends."""
    add, z = gmsh.model.occ.addCylinder, -0.5 * thickness
    return [
        (3, add(x, 0.0, z, 0.0, 0.0, thickness, radius))
        for x, radius in ((0.0, big), (LENGTH, small))
    ]


def rounded(volumes: Shape, start: float, end: float, radius: float) -> Shape:
    """The edges along z between two places on x rounded off."""
    occ = gmsh.model.occ
    occ.synchronize()
    faces = gmsh.model.getBoundary(volumes, oriented=False)
    edges = []
    for edge in set(gmsh.model.getBoundary(faces, combined=False, oriented=False)):
        x, y, _, far_x, far_y, _ = gmsh.model.getBoundingBox(*edge)
        if max(far_x - x, far_y - y) < 1e-3 and start - 1e-3 < x < end:
            edges.append(edge[1])
    return list(occ.fillet([tag for _, tag in volumes], sorted(edges), [radius]))


def write(size: float, target: Path) -> None:
    """Mesh with elements of `size` and write Gmsh's binary format."""
    gmsh.initialize(interruptible=False)
    for option, value in {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Mesh.MeshSizeMax": size,
        "Mesh.MeshSizeMin": 0.6 * size,
        "Mesh.MeshSizeFromCurvature": 16,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 2 if size > SMOOTH else 1,
        "Mesh.MshFileVersion": 2.2,
        "Mesh.Binary": 1,
    }.items():
        gmsh.option.setNumber(option, value)
    connecting_rod()
    gmsh.model.mesh.generate(3)
    gmsh.write(str(target))
    gmsh.finalize()


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=float, default=SIZE, help="of the elements [mm]")
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).with_name("rod.msh"))
    given = parser.parse_args()
    write(given.size, given.output)
