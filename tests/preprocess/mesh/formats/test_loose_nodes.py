"""Nodes that belong to no element, in every format: they are left out and told, and the body is
what it was.
"""

import meshio
import numpy as np
import pytest
from duhamel.preprocess import InterfaceError, MeshWarning, assemble
from duhamel.preprocess.mesh.reading import read_mesh
from duhamel.preprocess.responses.static import compliance

LOOSE = [[0.5, 0.5, 9.0], [7.0, 0.25, 0.5]]
TOLD = r"left out: .*2 nodes that belong to no element, at \[0.5, 0.5, 9.0\], \[7.0, 0.25, 0.5\]$"
FORMATS = {
    "gmsh 2.2": (".msh", "gmsh22", {"binary": False}),
    "gmsh 4.1": (".msh", "gmsh", {"binary": False}),
    "abaqus": (".inp", "abaqus", {"float_fmt": ".16e"}),
    "nastran": (".bdf", "nastran", {"point_format": "fixed-large"}),
    "med": (".med", "med", {}),
    "vtk": (".vtk", "vtk", {"binary": False}),
    "vtu": (".vtu", "vtu", {}),
    "xdmf": (".xdmf", "xdmf", {}),
}


def with_loose(mesh, cells=slice(None), **data):
    """The same mesh with two more points, one in front of all others and one behind them."""
    points = np.vstack([LOOSE[0], mesh.points, LOOSE[1]])
    blocks = [(block.type, block.data + 1) for block in mesh.cells[cells]]
    return meshio.Mesh(points, blocks, **data)


@pytest.mark.parametrize("file_format", FORMATS)
def test_they_are_left_out_and_told(solid_body, tmp_path, box, file_format):
    name, meshio_format, options = FORMATS[file_format]
    mesh = box("hexahedron", divisions=(3, 1, 1))
    body = solid_body(
        mesh, interfaces={"root": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}}
    )
    expected = assemble(body)
    path = tmp_path / f"loose{name}"
    with_loose(mesh, slice(2, 3)).write(path, file_format=meshio_format, **options)
    with pytest.warns(MeshWarning, match=TOLD):
        found = assemble(body.model_copy(update={"mesh": path}))
    assert found.n_u == expected.n_u
    H = compliance(expected)
    scale = np.sqrt(np.diag(H))
    np.testing.assert_allclose(
        compliance(found) / np.outer(scale, scale), H / np.outer(scale, scale), atol=1e-9
    )


def test_places_are_told_in_the_unit_of_the_file_and_only_a_few(save, beam):
    mesh = beam(2)
    points = np.vstack([mesh.points, np.arange(15.0).reshape(5, 3)])
    path = save(
        meshio.Mesh(points, mesh.cells, cell_data=mesh.cell_data, field_data=mesh.field_data)
    )
    told = (
        r"5 nodes that belong to no element, at "
        r"\[0.0, 1.0, 2.0\], \[3.0, .*\], \[6.0, 7.0, 8.0\], \.\.\.$"
    )
    with pytest.warns(MeshWarning, match=told):
        found = read_mesh(path, scale=1e-3)
    np.testing.assert_allclose(found.points, 1e-3 * mesh.points, rtol=1e-15)
    assert {kind: cells.tolist() for kind, cells in found.cells.items()} == {
        "vertex": [[0], [2]],
        "line": [[0, 1], [1, 2]],
    }


def physical_point(save, mesh):
    """The origin of a frame that Gmsh has saved as a physical point, and points of the mesh in a
    group of their own.
    """
    groups = [*mesh.cells, meshio.CellBlock("vertex", np.array([[-1], [len(mesh.points)]]))]
    tags = [*mesh.cell_data["gmsh:physical"], np.array([9, 9])]
    more = with_loose(
        meshio.Mesh(mesh.points, groups),
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=mesh.field_data | {"ref": np.array([9, 0])},
    )
    return save(more, "loose.msh")


def node_set(save, mesh):
    ends = np.array([0, len(mesh.points) + 1])
    roots = 1 + np.flatnonzero(mesh.points[:, 0] == 0.0)
    more = with_loose(mesh, slice(2, 3), point_sets={"ref": np.append(ends, 3), "root": roots})
    return save(more, "mesh.inp", "abaqus", float_fmt=".16e")


def support(save, mesh):
    path = save(with_loose(mesh, slice(2, 3)), "mesh.bdf", "nastran", point_format="fixed-large")
    path.write_text(
        path.read_text().replace("ENDDATA", f"SPC1,7,123,1,{len(mesh.points) + 2}\nENDDATA")
    )
    return path


def array_of_points(save, mesh):
    values = np.zeros(len(mesh.points) + 2, dtype=int)
    values[[0, -1]] = 1
    return save(
        with_loose(mesh, slice(2, 3), point_data={"ref": values}), "mesh.vtu", "vtu", binary=False
    )


@pytest.mark.parametrize(
    ("write", "group"),
    [(physical_point, "ref"), (node_set, "ref"), (support, "spc 7"), (array_of_points, "ref")],
)
def test_a_group_that_names_them_is_an_error_once_it_is_selected(
    solid_body, save, box, write, group
):
    mesh = box("hexahedron", divisions=(3, 1, 1))
    body = solid_body(mesh, interfaces={"corner": {"node": [0, 0, 0]}})
    body = body.model_copy(update={"mesh": write(save, mesh)})
    with pytest.warns(MeshWarning, match=TOLD):
        assemble(body)
    refused = solid_body(mesh, interfaces={"hub": {"group": group}}).model_copy(
        update={"mesh": body.mesh}
    )
    message = (
        rf"interfaces.hub: group '{group}' names 2 nodes that belong to no element "
        r"and have no mass, first at \[0.5, 0.5, 9.0\]"
    )
    with pytest.warns(MeshWarning, match=TOLD), pytest.raises(InterfaceError, match=message):
        assemble(refused)


def test_cells_that_need_them_go_too_and_groups_keep_the_rest(save, box):
    """A shell that hangs on a solid at one edge: its facets are none of the solid's."""
    mesh = box("hexahedron", divisions=(3, 1, 1))
    edge = np.flatnonzero((mesh.points[:, 0] == 0.0) & (mesh.points[:, 1] == 0.0))
    n = len(mesh.points)
    shell = meshio.CellBlock("quad", np.array([[edge[0], edge[1], n, -1]]))
    tags = [*mesh.cell_data["gmsh:physical"], np.array([1])]
    more = with_loose(
        meshio.Mesh(mesh.points, [*mesh.cells, shell]),
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data=mesh.field_data,
    )
    with pytest.warns(MeshWarning, match=TOLD):
        found = read_mesh(save(more))
    np.testing.assert_array_equal(found.points, mesh.points)
    np.testing.assert_array_equal(
        found.cells["quad"], np.concatenate([block.data for block in mesh.cells[:2]])
    )
    assert found.group("root").cells["quad"].tolist() == [0]
    assert found.group("tip").cells["quad"].tolist() == [1]
    assert found.group("root").loose.tolist() == LOOSE
    assert len(found.group("tip").loose) == 0
