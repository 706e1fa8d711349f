"""Abaqus: sets of every kind, surfaces, parts and their instances, included files, and what is told
as left out.
"""

import numpy as np
import pytest
from duhamel.preprocess import MeshError, MeshWarning, assemble
from duhamel.preprocess.mesh.facets import facets_of
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import places, volume

CUBE = """*Node
1, 0., 0., 0.
2, 1., 0.
3, 1., 1., 0.D0
4, 0., 1.
5, 0., 0., 1.
6, 1., , 1.
7, 1., 1., 1.
8, 0., 1., 1.
*Element, type=C3D8R, elset=Cube
11, 1, 2, 3, 4, 5,
 6, 7, 8
"""
TETRAHEDRON = """*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
*ELEMENT, TYPE=C3D4
1, 1, 2, 3, 4
"""
WEDGE = TETRAHEDRON.replace(
    "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4",
    "5, 1, 0, 1\n6, 0, 1, 1\n*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 4, 5, 6",
)


@pytest.fixture
def written(tmp_path):
    def write(text, name="mesh.inp"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def test_sets(written):
    """Numbers, ranges of which some are not there, sets of sets, case of names, and one name for
    nodes and elements.
    """
    mesh = read_mesh(
        written(
            CUBE
            + "*Nset, nset=Bottom, generate\n1, 4\n*NSET, NSET=odd, GENERATE\n1, 100, 2\n"
            + '*Nset, nset="both of them"\nBOTTOM, 7\n*Nset, nset=bottom\n5\n'
            + "*Elset, elset=cube\n11\n*Nset, nset=Cube\n8\n"
        )
    )
    assert {name: mesh.group(name).points.tolist() for name in mesh.groups} == {
        "Bottom": [0, 1, 2, 3, 4],
        "odd": [0, 2, 4, 6],
        "both of them": [0, 1, 2, 3, 4, 6],
        "Cube": [7],
    }
    assert mesh.group("Cube").cells["hexahedron"].tolist() == [0]
    assert volume(mesh) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("solid", "faces"),
    [
        (TETRAHEDRON, {1: (2, 0), 2: (1, 0), 4: (0, 0)}),
        (WEDGE, {1: (2, 0), 2: (2, 1), 3: (1, 0), 5: (0, 0)}),
        (CUBE, {1: (2, 0), 2: (2, 1), 3: (1, 0), 4: (0, 1), 5: (1, 1), 6: (0, 0)}),
    ],
)
def test_faces(written, solid, faces):
    """Face i lies in a plane across one of the axes, and is a facet of the element."""
    number = 11 if solid is CUBE else 1
    surfaces = "".join(f"*SURFACE, NAME=face{i}\n{number}, S{i}\n" for i in faces)
    mesh = read_mesh(written(solid + surfaces))
    for i, (axis, value) in faces.items():
        ((kind, rows),) = mesh.group(f"face{i}").cells.items()
        points = mesh.points[mesh.cells[kind][rows[0]]]
        assert points[:, axis].tolist() == [value] * len(points)
        assert (facets_of(mesh).matching(kind, mesh.cells[kind][rows]) >= 0).all()


def test_the_slanted_faces(written):
    surfaces = "*SURFACE, NAME=slanted\n1, S3\n*SURFACE, NAME=nodes, TYPE=NODE\n3\n"
    mesh = read_mesh(written(TETRAHEDRON + surfaces))
    assert mesh.points[mesh.cells["triangle"][0]].sum(axis=1).tolist() == [1, 1, 1]
    assert mesh.group("nodes").points.tolist() == [2]
    mesh = read_mesh(written(WEDGE + "*SURFACE, NAME=slanted\n1, S4\n"))
    assert mesh.points[mesh.cells["quad"][0], :2].sum(axis=1).tolist() == [1, 1, 1, 1]


ASSEMBLY = (
    "*Heading\n** a comment\n*Part, name=Bar\n"
    + CUBE
    + "*Nset, nset=Corner, internal\n1\n*Nset, nset=bottom\nCorner, 2, 3, 4\n"
    + "*End Part\n*Assembly, name=Assembly\n"
    + "*Instance, name=Bar-1, part=bar\n*End Instance\n{second}"
    + "*Elset, elset=_end_S4, internal, instance=Bar-1\n11\n"
    + "*Surface, type=ELEMENT, name=end\n_end_S4, S4\n"
    + "*Nset, nset=feet,\ninstance=Bar-1\nbottom\n*End Assembly\n"
)


def test_a_part_and_its_instance(written):
    """One instance: sets of the part keep their names; internal sets are no groups."""
    mesh = read_mesh(written(ASSEMBLY.format(second="")))
    assert set(mesh.groups) == {"Cube", "bottom", "feet", "end"}
    assert (
        mesh.group("feet").points.tolist() == mesh.group("bottom").points.tolist() == [0, 1, 2, 3]
    )
    assert places(mesh, "end") == [[1, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1]]


def test_instances_in_their_places(written):
    """The second is moved by 1 along x and turned by 90 degrees about the line x = 1 along z."""
    second = (
        "*Instance, name=Bar-2, part=Bar\n1., 0., 0.\n1., 0., 0., 1., 0., 1., 90.\n*End Instance\n"
    )
    mesh = read_mesh(
        written(
            ASSEMBLY.format(second=second) + "*Nset, nset=all feet\nfeet, Bar-2.bottom, Bar-2.7\n"
        )
    )
    assert set(mesh.groups) == {
        "Bar-1.Cube",
        "Bar-1.bottom",
        "Bar-2.Cube",
        "Bar-2.bottom",
        "feet",
        "end",
        "all feet",
    }
    square = [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]]
    assert places(mesh, "Bar-1.bottom") == square
    np.testing.assert_allclose(places(mesh, "Bar-2.bottom"), square, atol=1e-12)
    assert len(mesh.group("all feet").points) == 4 + 4 + 1
    assert volume(mesh, "Bar-2.Cube") == pytest.approx(1.0)


def test_the_sets_of_a_face_make_an_interface(written, solid_body, box):
    """As Abaqus/CAE writes a set: the nodes of a face, and the solids beside it, under one name."""
    sets = (
        "*Nset, nset=root\n1, 4, 5, 8\n*Elset, elset=root\n11\n"
        "*Nset, nset=tip\n2, 3, 6, 7\n*Elset, elset=tip\n11\n"
    )
    structure = assemble(solid_body(box("tetra")).model_copy(update={"mesh": written(CUBE + sets)}))
    X = structure.rigid.center + np.array([interface.X for interface in structure.interfaces])
    np.testing.assert_allclose(X, [[0, 0.5, 0.5], [1, 0.5, 0.5]], atol=1e-14)


def test_included_files(written):
    nodes, elements = CUBE.split("*Element")
    written(nodes.replace("*Node\n", ""), "nodes.txt")
    written("*Element" + elements, "elements.txt")
    path = written('*Node\n*INCLUDE, INPUT=nodes.txt\n*Include, input="elements.txt"\n')
    assert volume(read_mesh(path)) == pytest.approx(1.0)
    written("*INCLUDE, INPUT=nodes.txt\n", "nodes.txt")
    with pytest.raises(MeshError, match=r"mesh\.inp: nodes\.txt includes itself"):
        read_mesh(path)
    written("*INCLUDE, INPUT=nothing.txt\n", "nodes.txt")
    with pytest.raises(MeshError, match=r"nodes\.txt, line 1: no file nothing\.txt"):
        read_mesh(path)


def test_what_is_left_out_is_told_in_one_warning(written):
    more = "*Element, type=MASS, elset=Masses\n12, 1\n13, 2\n*Tie, name=a\nx, y\n"
    more += "*Surface, name=skin\nCube,\n*Nset, nset=a\n3, 99\n"
    with pytest.warns(MeshWarning) as told:
        mesh = read_mesh(written(CUBE + more))
    assert len(told) == 1
    for part in (
        "elements of type MASS",
        "*TIE",
        "surface skin",
        "numbers of set a that are no nodes (1)",
    ):
        assert part in str(told[0].message)
    assert set(mesh.groups) == {"Cube", "a"}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "expected keywords of Abaqus, found none"),
        (
            "1, 2, 3\n",
            r"line 1: expected a keyword of Abaqus \(\*HEADING, \*NODE, ...\), found '1, 2, 3'",
        ),
        (
            CUBE.replace("6, 7, 8", "6, 7"),
            "expected a number and 8 nodes for each C3D8R, found 8 numbers in all",
        ),
        (CUBE.replace("6, 7, 8", "6, 7, 9"), r"\*ELEMENT, hexahedron: no node 9 in the file"),
        (
            CUBE.replace("2, 1., 0.", "2, 1.x, 0."),
            r"line 1: \*NODE: expected numbers, found \['1\.x', '0\.', ''\]",
        ),
        (CUBE.replace("2, 1., 0.", "1, 1., 0."), "node 1 is there more than once"),
        (CUBE + "*Nset, nset=a\nb\n", "no node set 'b' in the file"),
        (CUBE + "*Nset, nset=a\nb\n*Nset, nset=b\na\n", "node set 'a' contains itself"),
        (
            CUBE + "*Nset, nset=a, generate\n1, 5, 0\n",
            "GENERATE: expected first, last and a positive step",
        ),
        (CUBE + "*Nset\n1\n", r"\*NSET: expected a value of NSET"),
        (CUBE + "*Instance, name=a, part=b\n*End Instance\n", "no part 'b' before this instance"),
        (
            CUBE + "*Ngen\n1, 5, 1\n",
            r"\*NGEN is not supported; expected a mesh that is written out",
        ),
        (CUBE.replace("*Node", "*Node, system=C"), "expected nodes in rectangular coordinates"),
        (
            CUBE.replace("C3D8R", "C3D15").replace("8\n", "8, 1, 2, 3, 4, 5, 6, 7\n", 2),
            "unsupported cells wedge15",
        ),
    ],
)
def test_errors_say_where_and_what(written, text, found):
    with pytest.raises(MeshError, match=r"mesh\.inp: (.*)" + found):
        read_mesh(written(text))


def test_shells_and_materials_beside_solids_are_named(written):
    """Their numbers are those of elements, not of keywords."""
    shells = "*ELEMENT, TYPE=S4, ELSET=skin\n1, 1, 2, 3, 4\n2, 5, 6, 7, 8\n"
    others = "*ELEMENT, TYPE=MASS\n3, 1\n4, 2\n5, 3\n*MATERIAL, NAME=STEEL\n*MATERIAL, NAME=FOAM\n"
    with pytest.warns(MeshWarning) as told:
        read_mesh(written(CUBE + shells + others))
    assert str(told[0].message).partition("left out: ")[2] == (
        "elements of type MASS (3); "
        "stiffness and mass of 2 S4: beside solid elements, shells and beams serve as groups "
        "alone; materials STEEL, FOAM: those of the body file are used"
    )


def test_where_shells_are_all_there_is_they_are_the_body(written):
    """Beams beside them are named: they are lines of groups alone."""
    nodes = CUBE.partition("*Element")[0]
    shells = "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n2, 5, 6, 7, 8\n"
    assert read_mesh(written(nodes + shells)).body_types == ("quad",)
    beams = "*ELEMENT, TYPE=B31\n3, 1, 5\n"
    with pytest.warns(MeshWarning, match="stiffness and mass of 1 B31: beside shells, beams serve"):
        read_mesh(written(nodes + shells + beams))


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("CPS4", "plane stress"),
        ("CPE4R", "plane strain"),
        ("CAX4", "axially symmetric"),
        ("M3D4", "membranes"),
        ("SFM3D4R", "surfaces without stiffness"),
        ("R3D4", "rigid"),
    ],
)
def test_flat_elements_that_are_no_shells_are_named(written, kind, words):
    """Beside solids they are groups, and say nothing."""
    flat = f"*ELEMENT, TYPE={kind}, ELSET=skin\n21, 1, 2, 3, 4\n22, 5, 6, 7, 8\n"
    with pytest.warns(MeshWarning, match=rf"read as shells: 2 {kind} \({words}\); they bend"):
        read_mesh(written(CUBE.partition("*Element")[0] + flat))
    read_mesh(written(CUBE + flat))
    with pytest.warns(MeshWarning, match=rf"if in a group of \[shells\]: 2 {kind}"):
        read_mesh(written(CUBE + flat), shells=["skin"])
