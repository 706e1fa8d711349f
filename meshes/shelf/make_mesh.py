"""A shelf on its wall plate, an angle of 20-node hexahedra, in meters: the faces wall and tip.

    python meshes/shelf/make_mesh.py

The wall plate stands in the plane x = 0, below the shelf that sticks out along x.
"""

from pathlib import Path

import gmsh

LENGTH, HEIGHT, WIDTH, THICKNESS = 0.165, 0.065, 0.06, 0.005
"""of the shelf along x, of the plate along z, of both along y, and of both plates"""
ALONG, DOWN, ACROSS, THROUGH = 16, 6, 6, 1
"""elements of the shelf, of the plate, across both, and through the thickness"""


def shelf() -> None:
    """The solid, its grid, and its groups: three rectangles of the profile, drawn out along y."""
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    xs, zs = (0.0, THICKNESS, LENGTH), (THICKNESS - HEIGHT, 0.0, THICKNESS)
    points = {
        (i, k): geo.addPoint(x, -0.5 * WIDTH, z)
        for i, x in enumerate(xs)
        for k, z in enumerate(zs)
        if (i, k) != (2, 0)
    }
    lines: dict[frozenset[int], int] = {}

    def line(a: tuple[int, int], b: tuple[int, int], elements: int) -> int:
        key = frozenset((points[a], points[b]))
        if key not in lines:
            lines[key] = geo.addLine(points[a], points[b])
            mesh_lines.append((lines[key], elements))
        forwards = points[a] == starts.setdefault(key, points[a])
        return lines[key] if forwards else -lines[key]

    mesh_lines: list[tuple[int, int]] = []
    starts: dict[frozenset[int], int] = {}
    faces = []
    for i, k, across, up in (
        (0, 0, THROUGH, DOWN),
        (0, 1, THROUGH, THROUGH),
        (1, 1, ALONG, THROUGH),
    ):
        corners = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)]
        sides = [
            line(a, b, n)
            for a, b, n in zip(
                corners, [*corners[1:], corners[0]], (across, up, across, up), strict=True
            )
        ]
        faces.append(geo.addPlaneSurface([geo.addCurveLoop(sides)]))
    drawn = geo.extrude(
        [(2, face) for face in faces], 0.0, WIDTH, 0.0, numElements=[ACROSS], recombine=True
    )
    geo.synchronize()
    for tag, elements in mesh_lines:
        mesh.setTransfiniteCurve(tag, elements + 1)
    for face in faces:
        mesh.setTransfiniteSurface(face)
        mesh.setRecombine(2, face)
    solids = [tag for dimension, tag in drawn if dimension == 3]
    gmsh.model.addPhysicalGroup(3, solids, name="shelf")
    for name, x in (("wall", 0.0), ("tip", LENGTH)):
        box = gmsh.model.getEntitiesInBoundingBox(x - 1e-6, -1.0, -1.0, x + 1e-6, 1.0, 1.0, 2)
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in box], name=name)


def write(target: Path) -> None:
    """Mesh and write Gmsh's binary format."""
    gmsh.initialize(interruptible=False)
    for option, value in {
        "General.Terminal": 0,
        "Mesh.ElementOrder": 2,
        "Mesh.SecondOrderIncomplete": 1,
        "Mesh.MshFileVersion": 2.2,
        "Mesh.Binary": 1,
    }.items():
        gmsh.option.setNumber(option, value)
    shelf()
    gmsh.model.mesh.generate(3)
    gmsh.write(str(target))
    gmsh.finalize()


if __name__ == "__main__":
    write(Path(__file__).with_name("shelf.msh"))
