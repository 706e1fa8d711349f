"""Gmsh: what its files may hold beyond those that it writes by default, and the errors of those
that are not read.
"""

import struct
from pathlib import Path

import pytest
from duhamel.preprocess import MeshError
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import volume

DATA = Path(__file__).parent / "data"
TEXT = (DATA / "tetra-4.1-text.msh").read_text()
OLD = (DATA / "tetra-2.2-text.msh").read_text()


@pytest.fixture
def written(tmp_path):
    def write(data):
        path = tmp_path / "mesh.msh"
        path.write_bytes(data if isinstance(data, bytes) else data.encode())
        return path

    return write


def test_numbers_of_the_other_order_of_bytes(written):
    """A tetrahedron of version 2.2 with the most significant byte first."""
    nodes = b"".join(
        struct.pack(">i3d", i, *X)
        for i, X in ((7, (0, 0, 0)), (3, (1, 0, 0)), (9, (0, 1, 0)), (4, (0, 0, 1)))
    )
    element = struct.pack(">3i", 4, 1, 2) + struct.pack(">7i", 1, 6, 1, 7, 3, 9, 4)
    mesh = read_mesh(
        written(
            b"$MeshFormat\n2.2 1 8\n" + struct.pack(">i", 1) + b"\n$EndMeshFormat\n"
            b"$Nodes\n4\n" + nodes + b"\n$EndNodes\n$Elements\n1\n" + element + b"\n$EndElements\n"
        )
    )
    assert volume(mesh, "physical volume 6") == pytest.approx(1.0 / 6.0)


def test_nodes_with_parameters(written):
    """On a surface two numbers follow the coordinates of each node."""
    nodes = (
        "$Nodes\n2 4 1 4\n2 1 1 3\n1\n2\n3\n0 0 0 .1 .2\n1 0 0 .3 .4\n0 1 0 .5 .6\n"
        "3 1 0 1\n4\n0 0 1\n$EndNodes\n"
    )
    elements = "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"
    mesh = read_mesh(written("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + nodes + elements))
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize("text", [TEXT, OLD])
def test_groups_without_names_and_other_sections(written, text):
    start, end = (
        text.index("$PhysicalNames"),
        text.index("$EndPhysicalNames\n") + len("$EndPhysicalNames\n"),
    )
    mesh = read_mesh(
        written(
            "$Comments\nby hand\n$EndComments\n" + text[:start].replace("\n", "\r\n") + text[end:]
        )
    )
    assert set(mesh.groups) == {
        *(
            "physical point 1",
            "physical point 2",
            "physical surface 1",
            "physical surface 2",
            "physical surface 7",
        ),
        *("physical volume 1", "physical volume 2", "physical volume 3"),
    }


def test_elements_of_changing_types(written):
    """Version 2: rows of every type and number of tags in turn."""
    points = "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
    rows = [
        "1 4 2 1 1 1 2 3 4",
        "2 2 2 5 1 1 2 3",
        "3 4 3 2 1 0 2 3 4 5",
        "4 2 1 5 1 2 4",
        "5 4 0 1 2 3 5",
        "6 4 2 2 1 1 2 3 4",
    ]
    elements = "$Elements\n6\n" + "\n".join(rows) + "\n$EndElements\n"
    mesh = read_mesh(written("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + points + elements))
    assert mesh.cells["tetra"].tolist() == [[0, 1, 2, 3], [1, 2, 3, 4], [0, 1, 2, 4]]
    assert mesh.group("physical volume 2").cells["tetra"].tolist() == [0, 1]
    assert mesh.group("physical surface 5").cells["triangle"].tolist() == [0, 1]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("solid", r"expected a section of Gmsh, found b'solid'"),
        ("", r"\$MeshFormat: expected version, type and size of numbers, found b''"),
        (
            TEXT.replace("4.1 0 8", "4 0 8"),
            "the file has version 4 of Gmsh's format; expected 2.2 or 4.1",
        ),
        (
            TEXT.replace("$Entities", "$PartitionedEntities").replace(
                "$EndEnt", "$EndPartitionedEnt"
            ),
            "the mesh is part",
        ),
        (
            TEXT.replace("$Elements", "$Others").replace("$EndElements", "$EndOthers"),
            r"the file has no section \$Elements",
        ),
        (TEXT.replace("$EndElements", ""), r"the file breaks off: \$Elements has no \$EndElements"),
        (
            OLD.replace("$Nodes\n12", "$Nodes\n11"),
            r"\$Nodes: 4 numbers or bytes more than it announces",
        ),
        (
            OLD.replace("$Nodes\n12", "$Nodes\n13"),
            "expected 13 rows of 4 numbers, found 48 numbers",
        ),
        (
            OLD.replace('2 1 "root"', "2 1 root"),
            r"\$PhysicalNames: expected dimension, tag and name, found '2 1 root'",
        ),
        (
            OLD.replace(" 4 2 1 1 ", " 93 2 1 1 "),
            r"\$Elements: unsupported elements of Gmsh's type 93",
        ),
        (OLD.replace("\n2 0 1 0", "\n2 0 one 0"), "expected numbers: could not convert"),
    ],
)
def test_errors_say_what(written, text, found):
    with pytest.raises(MeshError, match=r"mesh\.msh: " + found):
        read_mesh(written(text))


def test_an_element_of_an_unknown_node(written):
    *rows, last, end = OLD.splitlines()
    text = "\n".join([*rows, f"{last.rpartition(' ')[0]} 77", end])
    with pytest.raises(MeshError, match=r"mesh\.msh: \$Elements: no node 77 in the file"):
        read_mesh(written(text))
