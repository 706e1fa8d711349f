"""What pictures show of imported robots."""

import sys

import meshio
import numpy as np
import pytest
from duhamel.robots import ImportOptions, RobotError, import_robot
from duhamel.solver import Box, Cylinder, Sphere, Surface, read_model

from .references import BASE, joint, link, urdf_of

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def tetrahedron(path):
    """A mesh of four triangles: STL, OBJ by the suffix."""
    path.parent.mkdir(parents=True, exist_ok=True)
    meshio.Mesh(CORNERS, [("triangle", TRIANGLES)]).write(path)


def visual(figure, origin=""):
    return f"<visual>{origin}<geometry>{figure}</geometry></visual>"


def imported(folder, visuals, **options):
    """The robot whose arm has visuals, its center of mass at 0.5 m along x."""
    arm = link("arm", origin='<origin xyz="0.5 0 0"/>').replace("</link>", f"{visuals}</link>")
    path = urdf_of(folder, BASE + arm + joint("hinge", "base", "arm"))
    return import_robot(path, folder / "robot.toml", ImportOptions(**options))


def shape_of(folder, visuals, **options):
    done = imported(folder, visuals, **options)
    return read_model(done.path).bodies["arm"].shape


def volume(outline):
    a, b, c = (outline.points[outline.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def test_figures_along_the_axes_are_figures_of_the_model(tmp_path):
    quarter = '<origin xyz="0.5 0 0.1" rpy="0 1.5707963267948966 0"/>'
    box = shape_of(tmp_path, visual('<box size="0.1 0.2 0.3"/>', quarter))
    assert isinstance(box, Box)
    np.testing.assert_allclose(box.edges, [0.3, 0.2, 0.1], rtol=1e-15)
    np.testing.assert_allclose(box.center, [0.0, 0.0, 0.1], atol=1e-15)
    rod = shape_of(tmp_path, visual('<cylinder radius="0.1" length="0.6"/>', quarter))
    assert isinstance(rod, Cylinder)
    np.testing.assert_allclose(rod.cylinder.axis, [1.0, 0.0, 0.0], atol=1e-15)
    ball = shape_of(tmp_path, visual('<sphere radius="0.2"/>'))
    assert isinstance(ball, Sphere)
    assert (ball.radius, ball.center.tolist()) == (0.2, [-0.5, 0.0, 0.0])


def test_an_stl_file_along_the_axes_stays_where_it_is(tmp_path):
    tetrahedron(tmp_path / "meshes" / "arm.stl")
    mesh = '<mesh filename="meshes/arm.stl" scale="0.1 0.1 0.1"/>'
    shape = shape_of(tmp_path, visual(mesh))
    assert isinstance(shape, Surface)
    assert shape.file == str(tmp_path / "meshes" / "arm.stl")
    np.testing.assert_allclose(shape.outline.points.min(0), [-0.5, 0.0, 0.0], atol=1e-7)
    assert not (tmp_path / "robot-shapes").exists()


def test_several_figures_are_one_file_with_the_volume_of_all(tmp_path):
    tetrahedron(tmp_path / "arm.obj")
    turned = '<origin xyz="0.1 0.2 0.3" rpy="0.3 0.4 0.5"/>'
    # A mirror along x: its facets are turned back.
    parts = visual('<mesh filename="arm.obj" scale="-0.3 0.2 0.1"/>', turned)
    parts += visual('<box size="0.1 0.2 0.3"/>', turned) + visual('<box size="1 1 1"/>')
    shape = shape_of(tmp_path, parts)
    assert shape.file == str(tmp_path / "robot-shapes" / "arm.stl")
    assert volume(shape.outline) == pytest.approx(0.001 + 0.006 + 1.0, rel=1e-6)
    low = shape.outline.points.min(0)
    assert low[0] == pytest.approx(-1.0, abs=1e-6)


@pytest.mark.parametrize("place", ["package", "above", "option", "file"])
def test_packages_are_found_around_the_robot_or_where_the_user_says(tmp_path, place):
    folder = tmp_path / "bot" / "urdf"
    folder.mkdir(parents=True)
    mesh = {
        "package": tmp_path / "bot" / "arm.stl",
        "above": tmp_path / "other" / "arm.stl",
        "option": tmp_path / "elsewhere" / "far" / "arm.stl",
        "file": tmp_path / "arm.stl",
    }[place]
    tetrahedron(mesh)
    package = {"package": "bot", "above": "other", "option": "far"}.get(place)
    name = f"package://{package}/arm.stl" if package else f"file://{mesh}"
    figure = visual(f'<mesh filename="{name}"/>')
    packages = [tmp_path / "elsewhere"] if place == "option" else []
    assert shape_of(folder, figure, packages=packages).file == str(mesh)


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("none.stl", None, "mesh 'none.stl': no such file"),
        ("bad.stl", "solid nothing", "mesh 'bad.stl': "),
        ("bad.dae", "<COLLADA/>", "mesh 'bad.dae': not readable: "),
        ("package://x/a.stl", None, "no such file; say where its package is by --packages"),
    ],
)
def test_meshes_that_cannot_be_shown_are_told(tmp_path, name, content, expected):
    pytest.importorskip("trimesh")
    if content is not None:
        (tmp_path / name).write_text(content)
    done = imported(tmp_path, visual(f'<mesh filename="{name}"/>'))
    (remark,) = done.remarks
    assert expected in remark
    assert read_model(done.path).bodies["arm"].shape is None


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>
<unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">
0 0 0 1000 0 0 0 1000 0 0 0 1000</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh>
</geometry></library_geometries><library_visual_scenes><visual_scene id="s"><node>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def test_a_collada_file_is_shown_in_meters(tmp_path):
    pytest.importorskip("trimesh")
    (tmp_path / "arm.dae").write_text(COLLADA)
    shape = shape_of(tmp_path, visual('<mesh filename="arm.dae"/>'))
    assert volume(shape.outline) == pytest.approx(1.0 / 6.0, rel=1e-6)


def test_without_trimesh_what_it_reads_is_told(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", None)
    (tmp_path / "arm.dae").write_text(COLLADA)
    done = imported(tmp_path, visual('<mesh filename="arm.dae"/>') * 2)
    assert done.remarks == ("meshes in .dae: pip install 'duhamel[robots]' to show them (2 times)",)


def test_shapes_of_a_model_that_is_not_written_are_removed(tmp_path, monkeypatch):
    from duhamel.robots import importing
    from duhamel.solver import ModelError

    def refuse(path):
        raise ModelError(f"{path}: no")

    monkeypatch.setattr(importing, "read_model", refuse)
    turned = '<origin rpy="0.3 0 0"/>'
    with pytest.raises(RobotError, match=r"robot\.toml: no; the model is not written"):
        imported(tmp_path, visual('<box size="1 1 1"/>', turned))
    assert [path.name for path in tmp_path.iterdir()] == ["robot.urdf"]


def test_a_mesh_of_the_robot_is_not_replaced_by_a_shape(tmp_path):
    tetrahedron(tmp_path / "robot-shapes" / "arm.stl")
    mesh = visual('<mesh filename="robot-shapes/arm.stl"/>', '<origin rpy="0.3 0 0"/>')
    with pytest.raises(ValueError, match="is a mesh of the robot, which the shape would replace"):
        imported(tmp_path, mesh)
