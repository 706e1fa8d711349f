"""The paper's beam as a solid: half a meter of square bar in 20-node hexahedra, the end faces named
root and tip.

    python meshes/beam/make_solid.py

The side of the square is that of a bar of aluminium with the mass and the bending stiffness of
beam.toml.
"""

from pathlib import Path

import gmsh

LENGTH, SIDE = 0.5, 3e-5**0.5
ELEMENTS = (50, 2)
"""along the bar, and along each side of its section"""


def bar() -> None:
    """The solid, its grid, and its groups."""
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    corners = [
        geo.addPoint(0.0, y * SIDE, z * SIDE)
        for y, z in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))
    ]
    edges = [geo.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    root = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    (_, tip), (_, solid), *_ = geo.extrude(
        [(2, root)], LENGTH, 0.0, 0.0, numElements=[ELEMENTS[0]], recombine=True
    )
    geo.synchronize()
    for edge in edges:
        mesh.setTransfiniteCurve(edge, ELEMENTS[1] + 1)
    mesh.setTransfiniteSurface(root)
    mesh.setRecombine(2, root)
    for dimension, tag, name in ((3, solid, "beam"), (2, root, "root"), (2, tip, "tip")):
        gmsh.model.addPhysicalGroup(dimension, [tag], name=name)


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
    bar()
    gmsh.model.mesh.generate(3)
    gmsh.write(str(target))
    gmsh.finalize()


if __name__ == "__main__":
    write(Path(__file__).with_name("solid.msh"))
