"""Meshes in memory: what other libraries hold makes the same part as a file of it."""

import duhamel as du
import meshio
import numpy as np
import pytest
import skfem
from duhamel import preprocess

STEEL = du.Material(E=210e9, nu=0.3, rho=7850.0)
CORNERS = [np.linspace(0.0, 1.0, 5), np.linspace(0.0, 0.2, 3), np.linspace(0.0, 0.1, 2)]


def hexahedra() -> skfem.MeshHex:
    mesh = skfem.MeshHex.init_tensor(*CORNERS)
    mesh = mesh.with_boundaries({"root": lambda x: x[0] == 0.0, "tip": lambda x: x[0] == 1.0})
    return mesh.with_subdomains({"half": lambda x: x[0] < 0.5})


def as_meshio(mesh: skfem.Mesh) -> meshio.Mesh:
    from skfem.io.meshio import to_meshio

    return to_meshio(mesh, encode_cell_data=False)


def built(mesh, root="root", tip="tip"):
    part = du.Part(mesh, STEEL)
    part.interface("root", root)
    part.interface("tip", tip)
    return part.superelement(step=2e-5)


def forms(tmp_path):
    mesh = as_meshio(hexahedra())
    yield "meshio", mesh
    yield "arrays", (mesh.points, mesh.cells_dict["hexahedron"])
    yield "arrays by type", (mesh.points, {"hexahedron": mesh.cells_dict["hexahedron"]})
    yield "pairs", (mesh.points.tolist(), [("hexahedron", mesh.cells_dict["hexahedron"])])
    mesh.write(tmp_path / "bar.vtu")
    yield "a path", tmp_path / "bar.vtu"
    yield "a path in words", str(tmp_path / "bar.vtu")


def test_every_form_of_a_mesh_makes_the_same_superelement(tmp_path):
    planes = du.plane(x=0.0), du.plane(x=1.0)
    expected = built(hexahedra(), *planes)
    for name, mesh in forms(tmp_path):
        found = built(mesh, *planes)
        np.testing.assert_array_equal(found.compliance, expected.compliance, err_msg=name)
        np.testing.assert_array_equal(found.kernel.g, expected.kernel.g, err_msg=name)


def test_a_grid_of_pyvista_makes_the_same_superelement():
    pyvista = pytest.importorskip("pyvista")
    planes = du.plane(x=0.0), du.plane(x=1.0)
    mesh = as_meshio(hexahedra())
    grid = pyvista.from_meshio(mesh)
    assert isinstance(grid, pyvista.UnstructuredGrid)
    np.testing.assert_array_equal(built(grid, *planes).compliance, built(mesh, *planes).compliance)


def test_a_session_of_gmsh_is_taken_with_its_groups():
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("block")
        gmsh.model.occ.addBox(0.0, 0.0, 0.0, 1.0, 0.2, 0.1)
        gmsh.model.occ.synchronize()
        surfaces = gmsh.model.getEntities(2)
        at = {
            side: [tag for dim, tag in surfaces if gmsh.model.occ.getCenterOfMass(dim, tag)[0] == x]
            for side, x in (("root", 0.0), ("tip", 1.0))
        }
        for side, tags in at.items():
            gmsh.model.addPhysicalGroup(2, tags, name=side)
        gmsh.model.addPhysicalGroup(3, [1], name="block")
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.1)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        part = built(gmsh)
    finally:
        gmsh.finalize()
    assert part.mass == pytest.approx(7850.0 * 0.02, rel=1e-12)
    with pytest.raises(preprocess.MeshError, match="gmsh: expected a session with a meshed model"):
        du.Part(gmsh, STEEL)


@pytest.mark.parametrize(
    "mesh",
    [
        skfem.MeshTet.init_tensor(*CORNERS),
        skfem.MeshTet2.from_mesh(skfem.MeshTet.init_tensor(*CORNERS)),
        skfem.MeshHex.init_tensor(*CORNERS),
        skfem.MeshHex2.from_mesh(skfem.MeshHex.init_tensor(*CORNERS)),
        skfem.MeshWedge1(),
    ],
    ids=["tet4", "tet10", "hex8", "hex27", "wedge6"],
)
def test_boundaries_of_scikit_fem_are_the_facets_of_a_plane(mesh):
    highest = float(mesh.p[2].max())
    named = mesh.with_boundaries({"top": lambda x: np.isclose(x[2], highest)})
    converted = preprocess.mesh_of(named)
    group = converted.group("top")
    by_kind = {kind: converted.cells[kind][rows] for kind, rows in group.cells.items()}
    on_plane = sum(len(cells) for cells in by_kind.values())
    assert on_plane == len(named.boundaries["top"]) > 0
    for cells in by_kind.values():
        points = converted.points[cells]
        np.testing.assert_allclose(points[..., 2], highest, rtol=1e-15)
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        assert (normals[:, 2] > 0.0).all(), "corners turn outwards, as those of all faces"
    part = du.Part(named, STEEL)
    part.interface("top", "top")
    structure = preprocess.assemble(part.body(step=1e-5))
    volume = float(np.prod(np.ptp(mesh.p, axis=1)))
    assert structure.rigid.mass == pytest.approx(7850.0 * volume, rel=1e-12)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (3.0, "expected a path, (points, cells), or a mesh of scikit-fem"),
        (([[0.0, 0.0]], [[0, 1]]), "points: expected an array (n, 3), found one of (1, 2)"),
        (("ab", [[0, 1]]), "points: expected numbers (n, 3)"),
        (
            (np.eye(4, 3), [[0, 1, 2, 7]]),
            "cells: tetra: expected points 0 to 3, found 7",
        ),
        (
            (np.eye(4, 3), [[0, 1, 2]]),
            "cells: expected an array (m, k) with k of 2 (line), 4 (tetra), 6 (wedge)",
        ),
        (
            (np.eye(4, 3), {"tetra": [[0, 1, 2]]}),
            "cells: tetra: expected 4 nodes each, found 3",
        ),
        (
            (np.eye(4, 3), {"tetra": [[0.0, 1.0, 2.0, 3.0]]}),
            "cells: tetra: expected integers (m, k), found float64",
        ),
        ((np.full((4, 3), np.nan), [[0, 1, 2, 3]]), "point 0 is at [nan, nan, nan]"),
        ((np.eye(4, 3), {"vertex": [[0]]}), "no body in cells of type vertex"),
    ],
)
def test_what_is_no_mesh_is_one_line(mesh, message):
    with pytest.raises(preprocess.MeshError) as failure:
        du.Part(mesh, STEEL)
    assert message in str(failure.value)
    assert "\n" not in str(failure.value)
