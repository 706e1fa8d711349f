"""XDMF: arrays of tags, sets, several grids on the points of one; numbers in every storage."""

import h5py
import meshio
import numpy as np
import pytest
from duhamel.preprocess import MeshError, MeshWarning
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import eccentricity, places, volume


def tagged(mesh):
    """The parts of a box by their numbers, 1 root, 2 tip and 3 box,, and the nodes at x = 0."""
    tags = [
        np.full(len(block.data), number)
        for block, (number, _) in zip(mesh.cells, mesh.field_data.values(), strict=True)
    ]
    at_root = (mesh.points[:, 0] == 0.0).astype(np.int32)
    return meshio.Mesh(
        mesh.points, mesh.cells, cell_data={"part": tags}, point_data={"end": at_root}
    )


@pytest.mark.parametrize("data_format", ["XML", "HDF", "Binary"])
def test_boxes(box, save, kind, data_format, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # meshio writes binary files into the working directory
    path = save(
        tagged(box(kind, divisions=(2, 1, 1))), "mesh.xdmf", "xdmf", data_format=data_format
    )
    mesh = read_mesh(path)
    assert set(mesh.groups) == {"part 1", "part 2", "part 3", "end 0", "end 1", "end"}
    assert eccentricity(mesh) == 0.0
    assert volume(mesh, "part 3") == pytest.approx(1.0)
    assert np.unique(np.array(places(mesh, "part 2"))[:, 0]).tolist() == [1.0]
    assert np.unique(np.array(places(mesh, "end"))[:, 0]).tolist() == [0.0]


def test_lines(beam, save):
    original = beam(4)
    mesh = read_mesh(save(tagged(original), "mesh.xdmf", "xdmf", data_format="XML"))
    assert mesh.body_types == ("line",)
    assert mesh.cells["line"].tolist() == original.cells[2].data.tolist()
    assert mesh.group("part 2").cells["vertex"].tolist() == [1]


GRIDS = """<Xdmf Version="3.0" xmlns:xi="http://www.w3.org/2001/XInclude"><Domain>
<Grid Name="solid" GridType="Uniform">
<Topology TopologyType="Tetrahedron" NumberOfElements="1" NodesPerElement="4">
<DataItem Dimensions="1 4" NumberType="Int" Precision="8" Format="HDF">mesh.h5:/cells</DataItem>
</Topology>
<Geometry GeometryType="XYZ">
<DataItem Dimensions="4 3" Precision="8" Format="HDF">mesh.h5:/points</DataItem>
</Geometry>
<Set Name="foot" SetType="Node">
<DataItem Dimensions="2" NumberType="Int" Format="XML">0 2</DataItem></Set>
<Set Name="edges" SetType="Edge">
<DataItem Dimensions="2" NumberType="Int" Format="XML">0 2</DataItem></Set>
</Grid>
<Grid Name="facet_tags" GridType="Uniform">
<xi:include xpointer="xpointer(/Xdmf/Domain/Grid/Geometry)" />
<Topology TopologyType="Triangle" NumberOfElements="2" NodesPerElement="3">
<DataItem Dimensions="2 3" NumberType="Int" Format="XML">0 2 1 0 1 3</DataItem></Topology>
<Attribute Name="facet" AttributeType="Scalar" Center="Cell">
<DataItem Dimensions="2 1" NumberType="Int" Format="XML">5 7</DataItem></Attribute>
</Grid></Domain></Xdmf>"""


@pytest.fixture
def grids(tmp_path):
    """A tetrahedron and two tagged faces, as dolfinx writes a mesh and its tags."""
    with h5py.File(tmp_path / "mesh.h5", "w") as file:
        file["cells"] = [[0, 1, 2, 3]]
        file["points"] = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    path = tmp_path / "mesh.xdmf"
    path.write_text(GRIDS)
    return path


def test_tags_on_the_points_of_a_mesh(grids):
    with pytest.warns(MeshWarning, match=r"left out: set 'edges' of type 'edge'"):
        mesh = read_mesh(grids)
    assert set(mesh.groups) == {"solid", "facet_tags", "foot", "facet 5", "facet 7"}
    assert volume(mesh, "solid") == pytest.approx(1.0 / 6.0)
    assert places(mesh, "foot") == [[0, 0, 0], [0, 1, 0]]
    assert places(mesh, "facet 7") == [[0, 0, 0], [0, 0, 1], [1, 0, 0]]


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ('"Triangle"', '"Polygon"', "unsupported Topology of type 'polygon'"),
        ("0 2 1 0 1 3", "0 2 1 0 1 4", "Topology: expected nodes 0 to 3, found 0 to 4"),
        ("0 2 1 0 1 3", "0 2 1 0 1", r"Topology: expected \[2, 3\] numbers, found 5"),
        ("0 2 1 0 1 3", "0 2 1 0 1 x", "Topology: the numbers of its DataItem cannot be read"),
        ("h5:/cells", "h5:/elements", "Topology: the numbers of its DataItem cannot be read"),
        (
            "mesh.h5:/points",
            "other.h5:/points",
            "Geometry: the numbers of its DataItem cannot be read",
        ),
        ('"XYZ"', '"VXVYVZ"', "expected a Geometry of type XYZ or XY, found VXVYVZ"),
        ("<Domain>", "", "the file is no XML, or breaks off"),
        ("0 2</DataItem>", "0 4</DataItem>", "Set foot: expected numbers 0 to 3"),
    ],
)
def test_errors_say_what(grids, old, new, found):
    grids.write_text(GRIDS.replace(old, new))
    with pytest.raises(MeshError, match=r"mesh\.xdmf: " + found):
        read_mesh(grids)
