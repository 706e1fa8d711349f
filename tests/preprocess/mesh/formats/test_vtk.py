"""VTK and VTU: the arrays of integers are the groups. And what other formats of meshio keep."""

import meshio
import numpy as np
import pytest
from duhamel.preprocess import MeshWarning
from duhamel.preprocess.mesh.formats.arrays import MAX_GROUP_VALUES
from duhamel.preprocess.mesh.reading import read_mesh

from .geometry import eccentricity, places, volume
from .test_xdmf import tagged

FORMATS = {
    "legacy": ("mesh.vtk", "vtk", {"binary": True}),
    "legacy 4.2": ("mesh.vtk", "vtk42", {"binary": True}),
    "VTU": ("mesh.vtu", "vtu", {"binary": True, "compression": None}),
    "VTU compressed": ("mesh.vtu", "vtu", {"binary": True, "compression": "zlib"}),
}


@pytest.mark.parametrize("version", FORMATS)
def test_boxes(box, save, kind, version):
    name, file_format, options = FORMATS[version]
    mesh = read_mesh(save(tagged(box(kind, divisions=(2, 1, 1))), name, file_format, **options))
    assert set(mesh.groups) == {"part 1", "part 2", "part 3", "end 0", "end 1", "end"}
    assert eccentricity(mesh) == 0.0
    assert volume(mesh, "part 3") == pytest.approx(1.0)
    assert np.unique(np.array(places(mesh, "part 2"))[:, 0]).tolist() == [1.0]
    assert np.unique(np.array(places(mesh, "end"))[:, 0]).tolist() == [0.0]


def test_arrays_that_tell_no_groups(beam, save):
    """Numbers of the cells, and reals; too many values are told."""
    cells = 2 * MAX_GROUP_VALUES + 4
    mesh = meshio.Mesh(beam(cells).points, [beam(cells).cells[2]])
    mesh.cell_data = {
        "number": [np.arange(cells)],
        "size": [np.ones(cells)],
        "pair": [np.arange(cells) // 2],
    }
    with pytest.warns(
        MeshWarning,
        match=f"left out: groups of the array 'pair', which has {MAX_GROUP_VALUES + 2} values",
    ):
        assert not read_mesh(save(mesh, "mesh.vtu", "vtu", compression=None, binary=True)).groups


def test_another_format_says_that_groups_may_be_lost(box, save):
    """Medit keeps numbers of cells, and no names."""
    path = save(tagged(box("tetra")), "mesh.mesh", "medit", float_fmt=".16e")
    with pytest.warns(
        MeshWarning, match=r"left out: groups that meshio does not keep of \.mesh files"
    ):
        mesh = read_mesh(path)
    assert volume(mesh) == pytest.approx(1.0)
    assert set(mesh.groups) == {
        "medit:ref 0",
        "medit:ref 1",
        "medit:ref 2",
        "medit:ref 3",
        "medit:ref",
    }
