"""A twisted, tapered rotor blade, in meters: groups root and tip, its end faces, and blade.

    python meshes/blade/make_mesh.py [--size METRES] [-o FILE.msh]

The blade lies along x from its root, the chord along y and the thickness along z where it is not
twisted. Its sections are symmetric aerofoils of four digits of NACA, lofted and meshed with
tetrahedra of 10 nodes.
"""

from argparse import ArgumentParser
from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray

LENGTH = 0.5
CHORD, THICKNESS, TWIST = (0.06, 0.035), (0.15, 0.10), (0.50, 0.05)
"""at root and tip: chord [m], thickness over chord, angle [rad]"""
STATIONS, POINTS = 6, 12
"""sections that are lofted, and points on each side of one"""
TRAILING = 0.96
"""where the aerofoil is cut off, for no mesh likes a sharp edge"""
AXIS = 0.35
"""the part of the chord that lies on x"""
SIZE = 0.014


def blade() -> None:
    """The solid, and its groups."""
    occ = gmsh.model.occ
    sections = [section(share) for share in np.linspace(0.0, 1.0, STATIONS)]
    ((_, solid),) = occ.addThruSections(sections, makeSolid=True, maxDegree=3)
    occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [solid], name="blade")
    for name, x in (("root", 0.0), ("tip", LENGTH)):
        end = gmsh.model.getEntitiesInBoundingBox(x - 1e-4, -1.0, -1.0, x + 1e-4, 1.0, 1.0, dim=2)
        gmsh.model.addPhysicalGroup(2, [tag for _, tag in end], name=name)


def section(share: float) -> int:
    """The outline at a share of the length: two splines from the nose, and the trailing edge."""
    occ = gmsh.model.occ
    upper = [occ.addPoint(*point) for point in aerofoil(share, 1.0)]
    lower = upper[:1] + [occ.addPoint(*point) for point in aerofoil(share, -1.0)[1:]]
    sides = [occ.addSpline(upper), occ.addLine(upper[-1], lower[-1]), occ.addSpline(lower[::-1])]
    return int(occ.addWire(sides, checkClosed=True))


def aerofoil(share: float, side: float) -> NDArray[np.float64]:
    """One side of a section from the nose to the trailing edge (POINTS, 3).

        z(s) = 5 t (0.2969 sqrt(s) - 0.1260 s - 0.3516 s^2 + 0.2843 s^3 - 0.1015 s^4)

    with s along the chord and t the thickness, both over the chord. Source: Abbott, von Doenhoff,
    Theory of Wing Sections, 1959.
    """
    chord, t, twist = (a + (b - a) * share for a, b in (CHORD, THICKNESS, TWIST))
    s = TRAILING * 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, POINTS)))
    z = 5.0 * t * np.polynomial.Polynomial([0.0, -0.1260, -0.3516, 0.2843, -0.1015])(
        s
    ) + 5.0 * t * 0.2969 * np.sqrt(s)
    y, z = chord * (s - AXIS), side * chord * z
    return np.stack(
        [
            np.full(POINTS, share * LENGTH),
            np.cos(twist) * y - np.sin(twist) * z,
            np.sin(twist) * y + np.cos(twist) * z,
        ],
        axis=1,
    )


def write(size: float, target: Path) -> None:
    """Mesh with elements of `size` and write Gmsh's binary format."""
    gmsh.initialize(interruptible=False)
    for option, value in {
        "General.Terminal": 0,
        "General.NumThreads": 1,
        "Mesh.MeshSizeMax": size,
        "Mesh.MeshSizeMin": 0.4 * size,
        "Mesh.MeshSizeFromCurvature": 10,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 2,
        "Mesh.MshFileVersion": 2.2,
        "Mesh.Binary": 1,
    }.items():
        gmsh.option.setNumber(option, value)
    blade()
    gmsh.model.mesh.generate(3)
    gmsh.write(str(target))
    gmsh.finalize()


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=float, default=SIZE, help="of the elements [m]")
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).with_name("blade.msh"))
    given = parser.parse_args()
    write(given.size, given.output)
