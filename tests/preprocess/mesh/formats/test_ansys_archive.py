"""ANSYS archives (.cdb): nodes, solids and components in blocks."""

from pathlib import Path

import numpy as np
import pytest
from duhamel.preprocess import MeshError, MeshWarning
from duhamel.preprocess.elements.solid import volumes
from duhamel.preprocess.mesh.reading import read_draft, read_mesh

from ...ansys_files import ansys_examples

NODES = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
ELEMENT = (1, 1, 1, 1, 0, 0, 0, 0, 8, 0, 9, 10, 20, 30, 40, 50, 60, 70, 80)
CUBE = "\n".join(
    [
        "ET,        1,185",
        "NBLOCK,6,SOLID,        80,         8",
        "(3i9,6e21.13e3)",
        *(
            f"{10 * i:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13E}" for x in point)
            for i, point in enumerate(NODES, 1)
        ),
        "N,R5.3,LOC,       -1,",
        "EBLOCK,19,SOLID,         9,         1",
        "(19i9)",
        "".join(f"{number:9d}" for number in ELEMENT),
        "       -1",
        "CMBLOCK,BOTTOM  ,NODE,       2  ! users node component definition",
        "(8i10)",
        f"{10:10d}{40:10d}",
        "CMBLOCK,ALL     ,ELEM,       1",
        "(8i10)",
        f"{9:10d}",
        "MPDATA,R5.0, 1,EX  ,       1, 1, 7.000000000E+10,",
    ]
)


def write(folder: Path, text: str) -> Path:
    path = folder / "cube.cdb"
    path.write_text(text)
    return path


def test_nodes_elements_and_components(tmp_path):
    path = write(tmp_path, CUBE)
    with pytest.warns(MeshWarning, match="left out: materials 1 of material 1"):
        mesh = read_mesh(path, scale=0.1)
    assert volumes(mesh).sum() == pytest.approx(1e-3, rel=1e-14)
    assert mesh.labels.tolist() == list(range(10, 90, 10))
    assert mesh.groups["BOTTOM"].points.tolist() == [0, 3]
    assert mesh.groups["ALL"].cells["hexahedron"].tolist() == [0]


def test_an_archive_that_ansys_wrote():
    """The beam of 40 SOLID186 beside the reader of .full files."""
    with pytest.warns(MeshWarning):
        mesh = read_mesh(ansys_examples() / "HexBeam.cdb")
    assert volumes(mesh).sum() == pytest.approx(5.0, rel=1e-12)
    assert len(mesh.groups["NCOMP2"].points) == 98


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("NBLOCK", "N", r"expected one block NBLOCK, as CDWRITE writes it, found 0"),
        ("(3i9,6e21.13e3)", "(free)", r"line 3: expected a format .* found '\(free\)'"),
        ("EBLOCK,19,SOLID", "EBLOCK,10", r"expected EBLOCK,19,SOLID"),
        ("       80\n", "       70\n", r"found 1 of type hexahedron that are collapsed, .* 9"),
        ("       80\n", "       81\n", r"hexahedron elements: no node 81"),
        ("       80\n", "\n", r"EBLOCK: the block breaks off"),
        ("       80\n", "       8x\n", r"line \d+: EBLOCK: expected numbers: .*8x"),
        ("ET,        1,185", "ET,        1,181", r"no body in cells of type none"),
        (f"{10:10d}{40:10d}", f"{10:10d}{-12:10d}", r"component BOTTOM: no node 11"),
    ],
)
def test_archives_that_are_refused(tmp_path, old, new, message):
    assert old in CUBE
    with pytest.raises(MeshError, match=message):
        read_mesh(write(tmp_path, CUBE.replace(old, new)))


def test_nodes_that_are_turned_are_refused_of_matrices(tmp_path):
    """A mesh may have them: its displacements are in the axes of the file."""
    turned = f"{0:21.13E}{0:21.13E}{0:21.13E}{90:21.13E}\n"
    text = CUBE.replace(f"{0:21.13E}{0:21.13E}{0:21.13E}\n", turned, 1)
    draft = read_draft(write(tmp_path, text))
    np.testing.assert_array_equal(draft.points, NODES)
    with pytest.raises(MeshError, match=r"found 1 that are turned by NROTAT, first node 10"):
        draft.axes()
