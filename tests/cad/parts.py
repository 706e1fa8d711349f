"""CAD files of parts with known holes, masses and frequencies, made on the spot by gmsh."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import pi
from pathlib import Path

import gmsh

Solids = list[tuple[int, int]]


@contextmanager
def session() -> Iterator[None]:
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield
    finally:
        gmsh.finalize()


def write(path: Path, make: Callable[[], object]) -> Path:
    """A CAD file in millimeters, by its suffix, of what is made in a session."""
    with session():
        make()
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    return path


def in_unit(path: Path, unit: str) -> Path:
    """A copy of a STEP file whose numbers are in another unit: M, or INCH."""
    text = path.read_text(encoding="utf-8")
    line = next(line for line in text.splitlines() if "LENGTH_UNIT()" in line)
    number, millimeter = line.split(" = ", 1)
    meter = millimeter.replace(".MILLI.", "$")
    assert meter != millimeter
    if unit == "M":
        new = f"{number} = {meter}"
    else:
        new = (
            f"{number} = ( CONVERSION_BASED_UNIT('INCH',#90001) LENGTH_UNIT() "
            "NAMED_UNIT(#90002) );\n"
            "#90001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#90003);\n"
            "#90002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
            f"#90003 = {millimeter}"
        )
    copy = path.with_name(f"{path.stem}-{unit}{path.suffix}")
    copy.write_text(text.replace(line, new), encoding="utf-8")
    return copy


def block() -> None:
    """60 x 40 x 20 with a hole of radius 8 along z through its middle."""
    occ = gmsh.model.occ
    box = occ.addBox(0, 0, 0, 60, 40, 20)
    occ.cut([(3, box)], [(3, occ.addCylinder(30, 20, 0, 0, 0, 20, 8))])


def plate() -> None:
    """100 x 60 x 8: a counterbore, a hole that is cut in halves, a slot, a boss, a rounded edge."""
    occ = gmsh.model.occ
    box = [(3, occ.addBox(0, 0, 0, 100, 60, 8))]
    occ.synchronize()
    edges = gmsh.model.getEntitiesInBoundingBox(-1, -1, -1, 1, 1, 9, dim=1)
    rounded = occ.fillet([tag for _, tag in box], [tag for _, tag in edges], [4.0])
    halves = [occ.addCylinder(50, 15, 0, 0, 0, 8, 6, angle=pi), _turned_half()]
    slot = [occ.addBox(70, 42, 0, 15, 6, 8)]
    slot += [occ.addCylinder(x, 45, 0, 0, 0, 8, 3) for x in (70, 85)]
    bore = [occ.addCylinder(20, 30, 0, 0, 0, 8, 4), occ.addCylinder(20, 30, 5, 0, 0, 3, 7)]
    tools = [(3, tag) for tag in (*halves, *slot, *bore)]
    cut, _ = occ.cut(rounded, tools)
    occ.fuse(cut, [(3, occ.addCylinder(50, 42, 8, 0, 0, 12, 5))])


def hub() -> None:
    """40 x 40 x 20 with a hole of radius 10 along z, with a keyway of 6 beside it, and half a hole.

    The half shell has the radius 5 and is along x, in the face y = 40.
    """
    occ = gmsh.model.occ
    box = occ.addBox(0, 0, 0, 40, 40, 20)
    keyway = occ.addBox(20, 15, 0, 13, 6, 20)
    tools = [
        occ.addCylinder(20, 18, 0, 0, 0, 20, 10),
        keyway,
        occ.addCylinder(0, 40, 10, 40, 0, 0, 5),
    ]
    occ.cut([(3, box)], [(3, tool) for tool in tools])


def _turned_half() -> int:
    half = int(gmsh.model.occ.addCylinder(50, 15, 0, 0, 0, 8, 6, angle=pi))
    gmsh.model.occ.rotate([(3, half)], 50, 15, 0, 0, 0, 1, pi)
    return half


def fork() -> None:
    """Two walls along x with a hole each, in one line, on a floor."""
    occ = gmsh.model.occ
    walls = [(3, occ.addBox(x, 0, 0, 8, 30, 40)) for x in (0, 32)]
    whole, _ = occ.fuse([(3, occ.addBox(0, 0, 0, 40, 30, 8))], walls)
    occ.cut(whole, [(3, occ.addCylinder(-5, 15, 28, 50, 0, 0, 6))])


def bar() -> None:
    """400 x 10 x 10, along x."""
    gmsh.model.occ.addBox(0, -5, -5, 400, 10, 10)


def two() -> None:
    """A base with a hole, and an arm with a pin in it, along z."""
    occ = gmsh.model.occ
    base = occ.addBox(0, 0, 0, 60, 60, 10)
    occ.cut([(3, base)], [(3, occ.addCylinder(30, 30, 0, 0, 0, 10, 6))])
    arm = [(3, occ.addBox(20, 20, 12, 120, 20, 6))]
    occ.fuse(arm, [(3, occ.addCylinder(30, 30, 0, 0, 0, 12, 5.9))])
