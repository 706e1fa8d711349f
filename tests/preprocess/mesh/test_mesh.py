"""Reading meshes: groups of every element type through Gmsh's formats and others, and the errors of
bad files.
"""

import meshio
import numpy as np
import pytest
from duhamel.preprocess import BodyError, MeshError, assemble
from duhamel.preprocess.mesh.reading import read_mesh
from duhamel.preprocess.responses.static import compliance
from pydantic import ValidationError

GMSH = {
    "gmsh 2.2 text": ("gmsh22", {"binary": False}),
    "gmsh 2.2 binary": ("gmsh22", {"binary": True}),
    "gmsh 4.1 text": ("gmsh", {"binary": False}),
    "gmsh 4.1 binary": ("gmsh", {"binary": True}),
}


def places(mesh, kind, rows):
    """The points of cells: meshio's 4.1 writer sorts the points, so their numbers differ from the
    original's.
    """
    return mesh.points[mesh.cells[kind][rows]]


@pytest.mark.parametrize("version", GMSH)
def test_groups_of_solids_come_through_gmsh(save, box, kind, version):
    """Root, tip and all elements, with every node in its place; meshio's order of nodes differs
    from Gmsh's.
    """
    file_format, options = GMSH[version]
    original = box(kind, divisions=(2, 1, 1))
    mesh = read_mesh(save(original, file_format=file_format, **options))
    assert set(mesh.groups) == {"root", "tip", "box"}
    assert mesh.body_types == (kind,)
    for name, block in zip(("root", "tip", "box"), original.cells, strict=True):
        ((found, rows),) = mesh.group(name).cells.items()
        assert found == block.type
        np.testing.assert_allclose(
            places(mesh, found, rows), original.points[block.data], rtol=0, atol=1e-15
        )


@pytest.mark.parametrize("version", GMSH)
def test_groups_of_lines_come_through_gmsh(save, beam, version):
    file_format, options = GMSH[version]
    original = beam(4)
    mesh = read_mesh(save(original, file_format=file_format, **options))
    for name, block in zip(("root", "tip", "beam"), original.cells, strict=True):
        ((found, rows),) = mesh.group(name).cells.items()
        assert found == block.type
        np.testing.assert_allclose(
            places(mesh, found, rows), original.points[block.data], rtol=0, atol=1e-15
        )


def test_every_version_gives_the_same_body(solid_body, save, box, kind):
    mesh = box(kind, divisions=(2, 1, 1))
    body = solid_body(mesh)
    expected = compliance(assemble(body))
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    for file_format, options in GMSH.values():
        same = body.model_copy(update={"mesh": save(mesh, "same.msh", file_format, **options)})
        assert np.abs((compliance(assemble(same)) - expected) / scale).max() < 1e-11


def test_sets_of_other_formats(solid_body, save, box):
    """Abaqus: cell sets for elements, point sets for nodes."""
    mesh = box("hexahedron")
    points = {"tip": np.flatnonzero(mesh.points[:, 0] == 1.0), "corner": np.array([0])}
    plain = meshio.Mesh(
        mesh.points, [mesh.cells[2]], point_sets=points, cell_sets={"all": [np.arange(8)]}
    )
    path = save(plain, "mesh.inp", "abaqus", float_fmt=".16e")
    interfaces = {"tip": {"group": "tip"}, "corner": {"group": "corner"}}
    body = solid_body(
        mesh,
        interfaces=interfaces,
        material=None,
        materials={"all": {"E": 1.0, "nu": 0.0, "rho": 2.0}},
    )
    structure = assemble(body.model_copy(update={"mesh": path}))
    assert structure.rigid.mass == pytest.approx(2.0, rel=1e-14)
    X = structure.rigid.center + np.array([interface.X for interface in structure.interfaces])
    np.testing.assert_allclose(X, [[1, 0.5, 0.5], [0, 0, 0]], rtol=0, atol=1e-14)
    assert [interface.rotations for interface in structure.interfaces] == [True, False]


def test_points_in_a_plane_get_a_third_coordinate(beam_body, save):
    mesh = meshio.Mesh([[0.0, 0.0], [0.3, 0.4]], [("line", [[0, 1]])])
    path = save(mesh, "flat.vtk", "vtk", binary=False)
    np.testing.assert_allclose(read_mesh(path).points, [[0, 0, 0], [0.3, 0.4, 0]])


def test_files_that_are_no_meshes(tmp_path):
    with pytest.raises(MeshError, match=r"nowhere\.msh: no such mesh file"):
        read_mesh(tmp_path / "nowhere.msh")
    (tmp_path / "mesh.txt").write_text("points")
    with pytest.raises(
        MeshError,
        match=r"mesh\.txt: expected a mesh format that meshio reads, found the suffix '\.txt'",
    ):
        read_mesh(tmp_path / "mesh.txt")


@pytest.mark.parametrize("version", GMSH)
def test_files_that_break_off(save, beam, version):
    """Wherever the bytes end, before the last section is closed, it is one error that names the
    file.
    """
    file_format, options = GMSH[version]
    path = save(beam(10), file_format=file_format, **options)
    whole = path.read_bytes()
    for kept in range(0, len(whole) - 1, 13):
        path.write_bytes(whole[:kept])
        with pytest.raises(MeshError, match=r"mesh\.msh: "):
            read_mesh(path)


def test_cells_that_make_no_body(save):
    points = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
    pyramid = meshio.Mesh(points, [("pyramid", [[0, 1, 2, 3, 4]])])
    with pytest.raises(
        MeshError,
        match=r"mesh\.vtk: unsupported cells pyramid; bodies are made of line, triangle, quad",
    ):
        read_mesh(save(pyramid, "mesh.vtk", "vtk", binary=False))
    point = meshio.Mesh(points, [("vertex", [[0]])])
    with pytest.raises(MeshError, match="no body in cells of type vertex; bodies are made of line"):
        read_mesh(save(point, "mesh.vtk", "vtk", binary=False))
    curved = meshio.Mesh(points, [("line3", [[0, 1, 2]])])
    with pytest.raises(MeshError, match="no body in cells of type line3"):
        read_mesh(save(curved, "mesh.vtk", "vtk", binary=False))


def test_sections_for_solids_and_materials_for_lines(solid_body, beam_body, box, beam, section):
    with pytest.raises(
        BodyError,
        match=r"a mesh of solids: expected \[material\] or \[materials.GROUP\], found a sec",
    ):
        assemble(solid_body(box("tetra"), material=None, section=section))
    with pytest.raises(
        BodyError, match=r"a mesh of lines: expected \[section\] or \[sections.GROUP\], found a mat"
    ):
        assemble(beam_body(beam(2), None, material={"E": 1.0, "nu": 0.0, "rho": 1.0}))


def test_elements_without_a_material_of_their_own(solid_body, box):
    steel = {"E": 1.0, "nu": 0.0, "rho": 1.0}
    with pytest.raises(
        BodyError,
        match=r"one of the groups of \[materials\] \(root\): 8 are in none and 0 in several",
    ):
        assemble(solid_body(box("hexahedron"), material=None, materials={"root": steel}))
    with pytest.raises(MeshError, match="no group 'bx'"):
        assemble(solid_body(box("hexahedron"), material=None, materials={"bx": steel}))


@pytest.mark.parametrize("scale", [1e-3, 0.0254])
def test_a_mesh_in_another_unit_of_length(solid_body, box, scale):
    """Mass grows with the cube of the unit, inertia with its fifth power; compliance falls."""
    body = solid_body(box("hexahedron", (0.3, 0.2, 0.1)))
    one, other = assemble(body), assemble(body.model_copy(update={"scale": scale}))
    assert other.rigid.mass == pytest.approx(scale**3 * one.rigid.mass, rel=1e-12)
    np.testing.assert_allclose(
        other.rigid.J_rot, scale**5 * one.rigid.J_rot, rtol=1e-10, atol=1e-12 * scale**5
    )
    np.testing.assert_allclose(other.rigid.center, scale * one.rigid.center, rtol=1e-12)
    H, scaled = compliance(one)[:3, :3], compliance(other)[:3, :3]
    np.testing.assert_allclose(scaled, H / scale, rtol=0, atol=1e-9 * np.abs(H).max() / scale)


def test_a_unit_of_length_is_positive(solid_body, box):
    with pytest.raises(ValidationError, match="scale"):
        solid_body(box("tetra"), scale=0.0)


def test_a_mesh_whose_volumes_are_no_numbers_is_refused(box, tmp_path):
    path = tmp_path / "box.vtk"
    box("tetra").write(path)
    with pytest.raises(
        MeshError, match=r"box\.vtk: expected a mesh of 1e-12 to 1e\+12 m, found 1e-300 m"
    ):
        read_mesh(path, scale=1e-300)


@pytest.mark.parametrize(
    ("suffix", "advice"),
    [
        (".step", "is geometry, no mesh: name it in a body file or by du.Part.from_step"),
        (
            ".SLDPRT",
            "is geometry of a CAD program, no mesh: save it as STEP, which body files may name",
        ),
        (".mnf", "is a modal neutral file, .* take the mesh that it was made from, or stiffness"),
        (".odb", "is a database or results of another program: save the mesh there as .inp"),
    ],
)
def test_what_is_no_mesh_is_told_what_to_do(tmp_path, suffix, advice):
    path = tmp_path / f"part{suffix}"
    path.write_bytes(b"ISO-10303-21;")
    with pytest.raises(MeshError, match=rf"part{suffix}: {advice}"):
        read_mesh(path)
