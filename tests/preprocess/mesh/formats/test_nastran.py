"""Nastran: fields of every width, coordinate systems, properties with names, sets of points, and
what is left out.
"""

import numpy as np
import pytest
from duhamel.preprocess import MeshError, MeshWarning
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import places, volume

CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
SHORT = "".join(
    "GRID    {:8d}{:8s}{:8.1f}{:8.1f}{:8.1f}\n".format(i, "", *X) for i, X in enumerate(CORNERS, 1)
)
LONG = "".join(
    "GRID*   {:16d}{:16s}{:16.9E}{:16.9E}*\n*       {:16.9E}\n".format(i, "", *X)
    for i, X in enumerate(CORNERS, 1)
)
FREE = "".join("GRID,{},,{:.1f},{:.1f},{:.1f}\n".format(i, *X) for i, X in enumerate(CORNERS, 1))
CHEXA = "CHEXA   " + "".join(f"{i:8d}" for i in (1, 3, *range(1, 7))) + f"\n{'':8s}{7:8d}{8:8d}\n"


@pytest.fixture
def written(tmp_path):
    def write(text, name="mesh.bdf"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize("grids", [SHORT, LONG, FREE])
@pytest.mark.parametrize(
    "element", [CHEXA, "CHEXA,1,3,1,2,3,4,5,6,+\n+,7,8\n", "CHEXA*,1,3,1,2\n*,3,4,5,6\n*,7,8\n"]
)
def test_fields(written, grids, element):
    mesh = read_mesh(written(grids + element))
    assert mesh.points.tolist() == [list(X) for X in CORNERS]
    assert volume(mesh, "property 3") == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.5", 1.5),
        ("1.5-3", 1.5e-3),
        ("-.5+1", -5.0),
        ("1.5E-3", 1.5e-3),
        ("1.5D2", 150.0),
        ("", 0.0),
    ],
)
def test_numbers(written, text, value):
    assert read_mesh(written(FREE.replace("GRID,7,,1.0", f"GRID,7,,{text}") + CHEXA)).points[
        6, 0
    ] == pytest.approx(value)


def test_a_whole_deck(written):
    """What stands before BEGIN BULK, behind ENDDATA and in comments is no bulk data."""
    path = written(
        "SOL 101\nCEND\nSET 1 = ALL\nBEGIN BULK\n$ "
        f"GRID,9\n{SHORT}{CHEXA}ENDDATA\nGRID,9,,5.,5.,5.\n"
    )
    assert len(read_mesh(path).points) == 8
    path.write_text(path.read_text().replace("ENDDATA", "$"))
    with pytest.raises(
        MeshError, match=r"mesh\.bdf: the file breaks off: BEGIN BULK without ENDDATA"
    ):
        read_mesh(path)
    written(SHORT, "grids.bdf")
    assert volume(read_mesh(written("INCLUDE 'grids.bdf'\n" + CHEXA))) == pytest.approx(1.0)


def test_properties_and_their_names(written):
    names = '$HMNAME PROP                   3"the cube" 4\n'
    names += "$ANSA_NAME_COMMENT;4;PSHELL;bottom;;NO;NO;NO;\n$ Femap Property 5 : rods\n"
    facets = "CQUAD4,2,4,1,2,3,4\nCTRIA3,3,5,5,6,7\n"
    mesh = read_mesh(written(names + SHORT + CHEXA + facets))
    assert set(mesh.groups) == {
        "property 3",
        "property 4",
        "property 5",
        "the cube",
        "bottom",
        "rods",
    }
    assert volume(mesh, "the cube") == pytest.approx(1.0)
    assert (
        places(mesh, "bottom")
        == places(mesh, "property 4")
        == [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]]
    )


def test_sets_of_points(written):
    """Ranges may name points that are not there."""
    sets = "SET1,5,1,THRU,3,8\nSPC1,2,123456,4,THRU,99\nSPC1,2,3,1\nSPC,7,5,123,0.,6\n"
    mesh = read_mesh(written(SHORT + CHEXA + sets))
    assert mesh.group("set 5").points.tolist() == [0, 1, 2, 7]
    assert mesh.group("spc 2").points.tolist() == [0, 3, 4, 5, 6, 7]
    assert mesh.group("spc 7").points.tolist() == [4, 5]


def test_coordinate_systems(written):
    """The cube in systems turned and moved against each other: rectangular, cylindrical and
    spherical.
    """
    systems = (
        "CORD2R,1,,1.,0.,0.,1.,0.,1.\n,1.,1.,0.\n"  # origin (1, 0, 0), axes y, -x, z
        "CORD2C,2,1,0.,0.,0.,0.,0.,1.\n,0.,-1.,0.\n"  # in it: the axes of the mesh about (1, 0, 0)
        "CORD2S,3,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    )
    grids = {
        1: "GRID,1,1,0.,1.,0.",
        2: "GRID,2,1,0.,0.,0.",
        3: "GRID,3,2,1.,90.,0.",
        4: "GRID,4,3,1.,90.,90.",
        6: "GRID,6,2,0.,17.,1.",
        7: f"GRID,7,3,{np.sqrt(3.0):.9f},{np.rad2deg(np.arctan(np.sqrt(2.0))):.9f},45.",
    }
    lines = [grids.get(i, line) for i, line in enumerate(FREE.splitlines(), 1)]
    mesh = read_mesh(written("\n".join([*lines, systems, CHEXA])))
    np.testing.assert_allclose(mesh.points, CORNERS, rtol=0, atol=1e-8)


def test_what_is_left_out_is_told_in_one_warning(written):
    with pytest.warns(MeshWarning) as told:
        read_mesh(
            written(SHORT + CHEXA + "CONM2,5,1,,2.\nRBE2,6,1,123456,2\nCONM2,7,2,,2.\nSET1,9,100\n")
        )
    assert len(told) == 1
    for part in ("CONM2 (2)", "RBE2 (1)", "SET1 9", "which names no grid points"):
        assert part in str(told[0].message)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "expected cards of Nastran, found none"),
        ("        1       2\n", "expected a card of Nastran, found a continuation"),
        (
            SHORT.replace("0.0", "x.0", 1) + CHEXA,
            "line 1: GRID: expected a number in field 4, found 'x.0'",
        ),
        (
            SHORT + CHEXA.replace("8\n", " \n"),
            "line 9: CHEXA: expected 8 or 20 grid points, found 7",
        ),
        (SHORT + CHEXA.replace("8\n", "9\n"), "hexahedron elements: no grid point 9 in the file"),
        (SHORT + SHORT + CHEXA, "grid point 1 is there more than once"),
        (
            FREE.replace("GRID,1,,", "GRID,1,4,") + CHEXA,
            "coordinate system 4: expected a card CORD2R, CORD2C or CORD2S",
        ),
        (
            "CORD2R,4,4,1.\n" + FREE.replace("GRID,1,,", "GRID,1,4,") + CHEXA,
            "coordinate system 4 refers to itself",
        ),
        (
            "CORD2R,4,,1.\n" + FREE.replace("GRID,1,,", "GRID,1,4,") + CHEXA,
            "expected three points that are not on a line",
        ),
        (
            SHORT + "CTETRA,1,1,1,2,3,4,5,6\n,7,,1,2\n",
            "CTETRA: expected an integer in field 11, found ''",
        ),
        (SHORT + "CPYRAM,1,1,1,2,3,4,5\n", "unsupported cells pyramid"),
    ],
)
def test_errors_say_where_and_what(written, text, found):
    with pytest.raises(MeshError, match=r"mesh\.bdf: (.*)" + found):
        read_mesh(written(text))


@pytest.mark.parametrize("is_shell", [True, False])
def test_shells_and_materials_beside_solids_are_named(written, is_shell):
    """Faces without a property of shells, as Gmsh writes them, are groups alone."""
    shell = "PSHELL,7,1,0.1\n" if is_shell else ""
    deck = SHORT + CHEXA + "CQUAD4,2,7,1,2,3,4\nMAT1,1,2.1e11,,0.3,7800.\n" + shell
    with pytest.warns(MeshWarning) as told:
        read_mesh(written(deck))
    words = "stiffness and mass of 1 CQUAD4: beside solid elements, shells and beams serve as "
    assert (words in str(told[0].message)) == is_shell
    assert "materials MAT1 1: those of the body file are used" in str(told[0].message)


def test_panels_that_carry_shear_alone_are_named(written):
    deck = SHORT + "CSHEAR,1,7,1,2,3,4\nCQUAD4,2,8,5,6,7,8\nPSHEAR,7,1,0.1\n"
    with pytest.warns(MeshWarning, match=r"read as shells: 1 CSHEAR \(panels that carry shear"):
        read_mesh(written(deck))
    with pytest.warns(MeshWarning, match="left out: stiffness and mass of 1 CSHEAR"):
        read_mesh(written(deck + CHEXA))
