"""Tetrahedra of ten nodes of the solid that gmsh holds, and how good they are."""

from collections.abc import Mapping

import gmsh
import numpy as np

from ..superelement.validation import Array
from .errors import CadError
from .quality import TETRAHEDRON_VOLUME, Quality
from .session import solid_size

CIRCLE_ELEMENTS = 12
"""Elements around a circle, whose area their curved edges then keep to 5e-5."""
SMALLEST_SHARE = 0.25
"""Of the size of elements, that of those which small radii ask for."""
MAX_MESH_ELEMENTS = 5e6
"""Expected number above which a size is taken for a mistake."""
TEN_NODE_TYPE = 11  # as gmsh numbers types
# HXT leaves no slivers, which the older Delaunay does; but it cannot fill every volume.
VOLUME_ALGORITHMS = (10, 1)
DOUBTFUL_JACOBIAN = 0.1
"""Smallest over largest Jacobian of a curved element below which it is optimized."""


def mesh(solid: int, size: float, sizes: Mapping[int, float], unit: float) -> Quality:
    """Mesh a solid with elements of a size, on some faces of another one.

    sizes: by the number of the face, as `size` in the unit of the session, which is `unit` [m].
    `CadError` for sizes that fit no part, and where elements are left that fold over.
    """
    _check_sizes(solid, size, sizes, unit)
    smallest = min((size, *sizes.values()))
    for option, value in {
        "Mesh.MeshSizeMax": size,
        "Mesh.MeshSizeMin": SMALLEST_SHARE * smallest,
        "Mesh.MeshSizeFromCurvature": CIRCLE_ELEMENTS,
        "Mesh.ElementOrder": 2,
        "Mesh.MshFileVersion": 4.1,
        "Mesh.Binary": 1,
    }.items():
        gmsh.option.setNumber(option, value)
    _refine(sizes)
    _generate()
    if _jacobians()[1].min(initial=1.0) < DOUBTFUL_JACOBIAN:
        gmsh.model.mesh.optimize("HighOrder")
    elements, jacobians = _jacobians()
    _check_folded(elements, jacobians, unit)
    # Of corners alone; how much edges bend is what the Jacobian tells.
    shapes = gmsh.model.mesh.getElementQualities(elements, "gamma")
    return Quality(len(elements), float(shapes.min()), float(shapes.mean()), float(jacobians.min()))


def _check_sizes(solid: int, size: float, sizes: Mapping[int, float], unit: float) -> None:
    extent = solid_size(solid)
    if size > extent:
        raise CadError(
            f"size: expected that of elements, less than the {unit * extent:.3g} m of the part, "
            f"found {unit * size:g} m"
        )
    expected = gmsh.model.occ.getMass(3, solid) / (TETRAHEDRON_VOLUME * size**3)
    # A layer of elements on each refined face: behind it they grow quickly.
    for face, fine in sizes.items():
        expected += gmsh.model.occ.getMass(2, face) / (TETRAHEDRON_VOLUME * fine**2)
    if expected > MAX_MESH_ELEMENTS:
        raise CadError(
            f"size: {unit * min((size, *sizes.values())):g} m would make about {expected:.2g} "
            f"elements, expected at most {MAX_MESH_ELEMENTS:g}: give a larger size"
        )


def _generate() -> None:
    """Fill the volume; by the second algorithm where the first one, which is better, gives up."""
    better, robust = VOLUME_ALGORITHMS
    gmsh.option.setNumber("Mesh.Algorithm3D", better)
    try:
        gmsh.model.mesh.generate(3)
    except Exception:  # gmsh has no other type
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.Algorithm3D", robust)
        gmsh.model.mesh.generate(3)


def _refine(sizes: Mapping[int, float]) -> None:
    """A field of sizes on faces; from their edges the sizes grow into the rest."""
    # Fields of facets alone: elements behind them grow as from any edge.
    fields = []
    for face, size in sorted(sizes.items()):
        field = gmsh.model.mesh.field.add("Constant")
        gmsh.model.mesh.field.setNumbers(field, "SurfacesList", [face])
        gmsh.model.mesh.field.setNumber(field, "VIn", size)
        fields.append(field)
    if fields:
        least = gmsh.model.mesh.field.add("Min")
        gmsh.model.mesh.field.setNumbers(least, "FieldsList", fields)
        gmsh.model.mesh.field.setAsBackgroundMesh(least)


def _jacobians() -> tuple[Array, Array]:
    """Numbers of the tetrahedra, and the smallest over the largest Jacobian in each.

    -1 of those whose Jacobian is nowhere positive.
    """
    elements, _ = gmsh.model.mesh.getElementsByType(TEN_NODE_TYPE)
    if not len(elements):
        raise CadError("gmsh has made no element of the solid: try another size")
    smallest, largest = (
        np.asarray(gmsh.model.mesh.getElementQualities(elements, name))
        for name in ("minDetJac", "maxDetJac")
    )
    # Of two negative ones the ratio would be positive.
    return elements, np.divide(
        smallest, largest, out=np.full(len(elements), -1.0), where=largest > 0.0
    )


def _check_folded(elements: Array, jacobians: Array, unit: float) -> None:
    folded = np.flatnonzero(jacobians <= 0.0)
    if not len(folded):
        return
    _, nodes, *_ = gmsh.model.mesh.getElement(elements[int(jacobians.argmin())])
    corners = [gmsh.model.mesh.getNode(node)[0] for node in nodes[:4]]
    middle = (unit * np.mean(corners, axis=0)).round(6).tolist()
    raise CadError(
        f"{len(folded)} of {len(elements)} curved elements fold over, their Jacobian is not "
        f"positive, the worst near {middle} m: give a smaller size, or one for the faces there "
        "([sizes.NAME])"
    )
