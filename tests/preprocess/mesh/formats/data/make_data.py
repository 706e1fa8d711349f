"""Writes the meshes of this folder; needs gmsh from PyPI (written with 4.15.2)."""

from pathlib import Path

import gmsh

HERE = Path(__file__).parent
FORMATS = {
    "2.2-text.msh": (2.2, 0),
    "2.2-binary.msh": (2.2, 1),
    "4.1-text.msh": (4.1, 0),
    "4.1-binary.msh": (4.1, 1),
}
KINDS = {  # order, recombined across and along, incomplete
    "tetra": (1, False, False, 0),
    "tetra10": (2, False, False, 0),
    "wedge": (1, False, True, 0),
    "hexahedron": (1, True, True, 0),
    "hexahedron20": (2, True, True, 1),
    "hexahedron27": (2, True, True, 0),
}


def mesh_box(order: int, across: bool, along: bool, incomplete: int) -> None:
    """Two unit cubes along x; a volume, a surface and a point in two groups each, and a group
    without a name.
    """
    gmsh.clear()
    gmsh.model.add("box")
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
    geo = gmsh.model.geo
    corners = [geo.addPoint(0, y, z) for y, z in ((0, 0), (1, 0), (1, 1), (0, 1))]
    sides = [geo.addLine(corners[i - 1], corners[i]) for i in range(4)]
    for side in sides:
        geo.mesh.setTransfiniteCurve(side, 2)
    root = geo.addPlaneSurface([geo.addCurveLoop(sides)])
    geo.mesh.setTransfiniteSurface(root)
    if across:
        geo.mesh.setRecombine(2, root)
    (_, middle), (_, left), *_ = geo.extrude([(2, root)], 1, 0, 0, [1], recombine=along)
    (_, tip), (_, right), *_ = geo.extrude([(2, middle)], 1, 0, 0, [1], recombine=along)
    geo.synchronize()
    for dimension, tag, name, members in (
        (3, 1, "left", [left]),
        (3, 2, "right", [right]),
        (3, 3, "all of it", [left, right]),
        (2, 1, "root", [root]),
        (2, 2, "tip", [tip]),
        (2, 7, "", [root, tip]),
        (0, 1, "corner", [corners[0]]),
        (0, 2, "root", [corners[0]]),
    ):
        gmsh.model.addPhysicalGroup(dimension, members, tag, name)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)


gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
for kind, options in KINDS.items():
    mesh_box(*options)
    gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
    for suffix, (version, binary) in FORMATS.items():
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(HERE / f"{kind}-{suffix}"))
    gmsh.write(str(HERE / f"{kind}.inp"))
    if kind != "hexahedron27":  # Nastran has none
        gmsh.write(str(HERE / f"{kind}.bdf"))
    if kind in (
        "tetra10",
        "wedge",
        "hexahedron27",
    ):  # the nodes of the others are among those of these
        gmsh.write(str(HERE / f"{kind}.med"))
gmsh.finalize()
