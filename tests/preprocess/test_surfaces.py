"""Surfaces of bodies: their selection and geometry, and their compliance beside the modes."""

import json
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from duhamel.preprocess import (
    InterfaceError,
    MethodError,
    assemble,
    build,
    read_body,
    static_check,
    write_body,
)
from duhamel.preprocess.assembly.surfaces import nodal_normals
from duhamel.preprocess.mesh.cells import SOLID_TYPES
from duhamel.preprocess.responses.lanczos import modes_up_to
from duhamel.preprocess.responses.static import compliance, static_solver
from duhamel.preprocess.survey import survey
from duhamel.superelement import check, read, write
from scipy.linalg import eigh

from .blocks import box_mesh, mixed_mesh, named, solid_cells

IMPULSE = {"step": 2e-5, "steps": 10, "band": 6e3}
TIP = {"plane": {"point": [1.0, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}}
CORNER_FACETS = {
    "tetra": ("triangle", 3),
    "tetra10": ("triangle6", 3),
    "hexahedron": ("quad", 4),
    "hexahedron20": ("quad8", 4),
    "hexahedron27": ("quad9", 4),
    "wedge": ("quad", 4),
}


@pytest.fixture
def touched(solid_body, box):
    """A steel bar of 1 x 0.3 x 0.2 m with the surface `face` at x = 1 m."""

    def make(kind="hexahedron", **changes):
        divisions = changes.pop("divisions", (4, 3, 3))
        mesh = changes.pop("mesh", None) or box(kind, (1.0, 0.3, 0.2), divisions)
        values = {"surfaces": {"face": TIP}, "impulse": IMPULSE, "interfaces": {}, **changes}
        return solid_body(mesh, **values)

    return make


def dense_compliance(structure):
    """P_S P K^+ P^T P_S^T by all elastic modes of the dense problem."""
    squares, shapes = eigh(structure.K.toarray(), structure.M.toarray())
    phi = structure.surfaces.rows @ shapes[:, 6:]
    return (phi / squares[6:]) @ phi.T


def test_static_fields_by_forces_on_surfaces_are_those_of_the_mesh(touched, tmp_path):
    body = touched("hexahedron20", recovery={"stress": True})
    structure, element = assemble(body), build(body)
    surfaces, recovery, modes = element.surfaces, element.recovery, element.modes
    rows = np.array([1, 5, 8, 3 * surfaces.n - 1])
    force = np.array([2.0, -1.0, 0.5, 3.0])
    load = np.zeros(3 * surfaces.n)
    load[rows] = force
    u = static_solver(structure)(structure.relieve(structure.surfaces.rows.T @ load))
    expected = np.split(structure.surfaces.fields @ u, [recovery.phi[..., 0].size])
    coordinates = np.append(load @ surfaces.phi / modes.omega**2, force)
    write(element, tmp_path / "bar.h5")
    for kept in (recovery, read(tmp_path / "bar.h5").recovery):
        found = kept.with_loads(rows)
        for field, own in zip(
            (found.displacement(coordinates), found.stresses(coordinates)), expected, strict=True
        ):
            error = np.abs(field.ravel() - own).max() / np.abs(own).max()
            assert error < 5e-5  # rounded for the file


def test_surfaces_have_the_nodes_area_and_normals_of_their_facets(touched, kind):
    body = touched(kind)
    structure = assemble(body)
    (face,) = structure.surfaces.surfaces
    points = box_mesh(kind, (1.0, 0.3, 0.2), (4, 3, 3)).points
    assert face.n == int((points[:, 0] == 1.0).sum())
    assert (face.facet_type, face.corners.shape[1]) == CORNER_FACETS[kind]
    assert face.area == pytest.approx(0.06, rel=1e-12)
    np.testing.assert_allclose(face.X + structure.rigid.center, points[face.nodes], atol=1e-15)
    np.testing.assert_allclose(face.normals, np.tile([1.0, 0.0, 0.0], (face.n, 1)), atol=1e-12)


def test_facets_turn_outward(touched, kind):
    """About x, as the normal of a polygon of the corners says."""
    (face,) = assemble(touched(kind)).surfaces.surfaces
    corners = face.X[face.corners]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, -1] - corners[:, 0])
    assert (across[:, 0] > 0.0).all()
    np.testing.assert_allclose(across[:, 1:], 0.0, atol=1e-15)


def test_normals_of_a_sphere_are_radial(kind):
    """However the sphere is cut into facets: within the square of the angle that a facet spans."""
    facet, local = next(iter(SOLID_TYPES[kind].facets.items()))
    grid, cells = solid_cells(kind, (8, 8, 8))
    faces = cells[:, np.array(local)].reshape(-1, len(local[0]))
    nodes, facets = np.unique(faces[(grid[faces, 2] == 0).all(axis=1)], return_inverse=True)
    if not len(nodes):
        pytest.skip("no facets of this type on that side")
    across = (grid[nodes, :2] / 16.0 - 0.5) * 0.2
    points = np.column_stack([across, -np.sqrt(1.0 - (across**2).sum(axis=1))])
    normals = nodal_normals(points, facets.reshape(-1, faces.shape[1]), facet)
    inside = (np.abs(across) < 0.09).all(axis=1)
    error = np.abs(normals - points)[inside].max()
    assert error < 0.025**2


def test_the_compliance_is_that_of_the_dense_pseudo_inverse(touched, kind):
    body = touched(kind, divisions=(3, 3, 2), interfaces={"root": {"group": "root"}})
    element, structure = build(body), assemble(body)
    H = dense_compliance(structure)
    scale = np.sqrt(np.outer(H.diagonal(), H.diagonal()))
    np.testing.assert_allclose(element.surfaces.H / scale, H / scale, atol=1e-9)


def test_modes_leave_no_cross_compliance_of_surfaces_with_interfaces_and_channels(touched):
    """H_CJ of a static solution is what the modes give: nothing is left to be static."""
    body = touched(
        interfaces={"root": {"group": "root"}, "node": {"node": [0.5, 0.3, 0.2]}},
        loads={"push": {"plane": {"point": [0, 0, 0.2], "normal": [0, 0, 1]}, "pressure": 1.0}},
        sensors={"gauge": {"point": [0.6, 0.1, 0.1], "direction": [1, 0, 0]}},
    )
    element, structure = build(body), assemble(body).with_channels()
    n = structure.P_C.shape[0]
    rows = sp.vstack([structure.P_C, structure.surfaces.rows], format="csr")
    H = compliance(replace(structure, P_C=rows))
    modes = element.complete_modes(element.modes)
    found = (element.surfaces.phi / modes.omega**2) @ modes.phi.T
    scale = np.sqrt(np.outer(H.diagonal()[n:], H.diagonal()[:n]))
    np.testing.assert_allclose(found / scale, H[n:, :n] / scale, atol=1e-8)
    assert element.kernel.error <= body.impulse.tolerance


def test_the_modes_of_the_band_are_all_of_the_mesh(touched):
    """A square bar bends alike in two directions: equal frequencies are not missed."""
    square = box_mesh("hexahedron", (1.0, 0.2, 0.2), (8, 3, 3))
    structure = assemble(touched(mesh=square))
    values, vectors = eigh(structure.K.toarray(), structure.M.toarray())
    omega = np.sqrt(values[6:])
    highest = 2.0 * np.pi * 8e3
    shapes = modes_up_to(structure, static_solver(structure), highest, lambda _: None)
    expected = omega[omega <= highest]
    found = np.sqrt(np.einsum("im,im->m", shapes, structure.K @ shapes))
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    assert (np.diff(expected) < 1e-6 * expected[1:]).any()
    inside = vectors[:, 6:][:, : len(expected)]
    # The spaces agree: nothing of a shape is beside those of the mesh.
    beside = shapes - inside @ (inside.T @ (structure.M @ shapes))
    assert np.einsum("im,im->m", beside, structure.M @ beside).max() < 1e-10


def test_interfaces_respond_as_without_surfaces(touched):
    """The transfer function of the interface dofs over the band, to the tolerances of both."""
    ends = {"root": {"group": "root"}}
    with_surface = build(touched(interfaces=ends))
    without = build(touched(interfaces=ends, surfaces={}, impulse=IMPULSE | {"method": "modal"}))
    s = 1j * 2.0 * np.pi * np.linspace(0.0, 0.9 * IMPULSE["band"], 60) * (1.0 - 0.01j)

    def receptance(modes):
        response = 1.0 / (s[:, None] ** 2 + modes.omega**2)
        return np.einsum("im,sm,jm->sij", modes.phi, response, modes.phi)

    a, b = receptance(with_surface.modes), receptance(without.modes)
    scale = np.sqrt(np.abs(np.diagonal(b, axis1=1, axis2=2)).max(axis=0))
    assert np.abs((a - b) / np.outer(scale, scale)).max() < 1e-5


def test_a_rest_is_left_where_an_interface_is_on_the_surface(touched):
    """Its loads are among those of the surface, whose rest the band alone must not take."""
    element = build(touched(interfaces={"tip": {"group": "tip"}}))
    surfaces, omega = element.surfaces, element.modes.omega
    of_band = np.linalg.eigvalsh(surfaces.F(omega, 2.0 * np.pi * IMPULSE["band"]))
    of_all = np.linalg.eigvalsh(surfaces.F(omega))
    assert of_band[0] > 1e-3 * of_band[-1]
    assert abs(of_all[0]) < 1e-9 * surfaces.H.diagonal().max()
    assert all(found.holds for found in check(element))


def test_bodies_with_surfaces_need_no_interface(touched, tmp_path):
    body = touched()
    element = build(body)
    assert element.n_c == 0
    assert all(found.holds for found in check(element))
    assert static_check(element, body).holds
    write(element, tmp_path / "bar.h5")
    again = read(tmp_path / "bar.h5")
    np.testing.assert_array_equal(again.surfaces.H, element.surfaces.H)
    np.testing.assert_array_equal(again.surfaces.phi, element.surfaces.phi)


def test_the_check_against_the_mesh_finds_another_compliance(touched):
    body = touched(interfaces={"root": {"group": "root"}})
    element = build(body)
    assert static_check(element, body).holds
    softer = replace(element.surfaces, H=1.01 * element.surfaces.H)
    assert not static_check(replace(element, surfaces=softer), body).holds


def test_surfaces_go_with_rotation_recovery_losses_and_masses(touched):
    """H is that of a dense solution, whatever else the body has."""
    body = touched(
        "tetra",
        order=2,
        divisions=(2, 2, 2),
        interfaces={"root": {"group": "root", "kind": "rigid"}},
        masses={"lump": {"interface": "root", "mass": 2.0}},
        rotation={"modes": 2},
        recovery={"stress": True},
        damping={"loss_factor": 0.01, "band": [10.0, 1e4]},
    )
    element, structure = build(body), assemble(body)
    H = dense_compliance(structure)
    scale = np.sqrt(np.outer(H.diagonal(), H.diagonal()))
    np.testing.assert_allclose(element.surfaces.H / scale, H / scale, atol=1e-8)
    assert element.surfaces.patches[0].facet_type == "triangle6"
    assert element.rotation is not None
    assert element.recovery.phi.shape[2] == len(element.modes.omega)
    assert all(found.holds for found in check(element))


def test_surfaces_of_a_body_keep_their_order_and_may_meet(touched):
    top = {"plane": {"point": [0, 0, 0.2], "normal": [0, 0, 1]}}
    element = build(touched(surfaces={"z": TIP, "a": top}, divisions=(4, 3, 3)))
    assert [patch.name for patch in element.surfaces.patches] == ["z", "a"]
    first, second = element.surfaces.patches
    shared = np.intersect1d(first.nodes, second.nodes)
    assert len(element.surfaces.distinct) == 3 * (first.n + second.n - len(shared))
    assert len(shared) == 4
    for patch in (first, second):
        assert element.surfaces.rows(patch.name).stop % 3 == 0
        assert element.surface(patch.name) is patch


def test_surfaces_of_wedges_are_of_one_type(touched):
    """Triangles on the faces across z, quadrilaterals on the others."""
    across = {"plane": {"point": [0, 0, 0.2], "normal": [0, 0, 1]}}
    (face,) = assemble(touched("wedge", surfaces={"top": across})).surfaces.surfaces
    assert face.facet_type == "triangle"
    with pytest.raises(InterfaceError, match=r"of one type, found .* triangle and"):
        assemble(touched("wedge", surfaces={"all": {"box": {"corners": [[0, 0, 0], [1, 1, 1]]}}}))


def test_mixed_meshes_have_surfaces(solid_body):
    on_top = {"plane": {"point": [0, 0, 2.0], "normal": [0, 0, 1]}}
    mesh = mixed_mesh(3)
    with pytest.raises(InterfaceError, match=r"mesh\.msh: surfaces\.top: expected facets of one t"):
        assemble(solid_body(mesh, interfaces={}, surfaces={"top": on_top}, impulse=IMPULSE))


REFUSED = {
    "few": (
        {"divisions": (2, 1, 1)},
        r"mesh\.msh: surfaces\.face: expected 10 to 1000 nodes, found 4",
    ),
    "none": (
        {"surfaces": {"face": {"box": {"corners": [[2, 2, 2], [3, 3, 3]]}}}},
        r"surfaces\.face: no facet of the boundary lies as a whole in box",
    ),
    "rigid": (
        {"interfaces": {"tip": {"group": "tip", "kind": "rigid"}}},
        r"surfaces\.face: expected nodes that can move .* found 16 on the rigid interface tip",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_surfaces_that_cannot_be_are_refused(touched, name):
    changes, message = REFUSED[name]
    with pytest.raises(InterfaceError, match=message):
        assemble(touched(**changes))


def test_a_band_that_leaves_no_rest_is_refused(touched):
    wide = IMPULSE | {"step": 1e-7, "band": 1e6}
    with pytest.raises(MethodError, match=r"impulse\.band = 1e\+06 Hz is too wide for this mesh"):
        build(touched(impulse=wide))


def test_facets_within_a_body_are_no_surface(save, touched):
    """A group of faces between elements."""
    grid, cells = solid_cells("hexahedron", (4, 3, 3))
    faces = cells[:, np.array(SOLID_TYPES["hexahedron"].facets["quad"])].reshape(-1, 4)
    inner = np.unique(np.sort(faces[(grid[faces, 0] == 4).all(axis=1)], axis=1), axis=0)
    inner = inner[:, [0, 1, 3, 2]]
    mesh = named(grid / 8.0, [("inner", "quad", inner), ("box", "hexahedron", cells)])
    with pytest.raises(InterfaceError, match="facets of the boundary, found 9 of 9 in the body"):
        assemble(touched(mesh=mesh, surfaces={"face": {"group": "inner"}}))


WRONG = {
    "neither": ({"surfaces": {}}, r"expected \[interfaces.NAME\] or \[surfaces.NAME\], found nei"),
    "no band": ({"impulse": {"step": 1e-5, "steps": 5}}, r"impulse\.band: surfaces need the freq"),
    "method": ({"impulse": IMPULSE | {"method": "krylov"}}, r"expected auto, found krylov"),
    "solver": ({"impulse": IMPULSE | {"solver": "iterative"}}, r"solver: surfaces need a factor"),
    "node": ({"surfaces": {"face": {"node": [0, 0, 0]}}}, r"expected facets, by .* found node"),
    "empty": ({"surfaces": {"face": {}}}, r"expected facets, by one or more of group.* found none"),
    "name": ({"interfaces": {"face": TIP}}, r"surfaces: 'face' is the name of an interface"),
    "dots": ({"surfaces": {"a.b": TIP}}, r"surfaces: expected a name"),
    "sensor": ({"sensors": {"face": {"point": [0, 0, 0]}}}, r"'face' is the name of a load or a s"),
}


@pytest.mark.parametrize("name", WRONG)
def test_body_files_with_wrong_surfaces_are_refused(touched, name):
    changes, message = WRONG[name]
    with pytest.raises(ValueError, match=message):
        touched(**changes)


def test_lines_have_no_surfaces(beam_body, beam):
    with pytest.raises(ValueError, match="surfaces: expected a mesh of solids, found section"):
        beam_body(beam(4), surfaces={"face": TIP}, impulse=IMPULSE)


def test_body_files_with_surfaces_are_written_and_read(touched, tmp_path):
    body = touched()
    write_body(body, tmp_path / "body.toml")
    again = read_body(tmp_path / "body.toml")
    assert again.surfaces == body.surfaces
    assert json.loads(body.text)["surfaces"].keys() == {"face"}


def test_dry_runs_report_surfaces(touched):
    body = touched(interfaces={"root": {"group": "root"}})
    found = survey(body)
    assert [patch.name for patch in found.touched] == ["face"]
    assert found.surfaces.columns == 48
    assert found.surfaces.compliance_bytes == 48 * 48 * 8
    assert found.cost is None
    marked = sum(int((owners == 1).sum()) for _, owners in found.boundary())
    assert marked == 9
    built = build(body)
    inside = int((built.modes.frequencies <= IMPULSE["band"]).sum())
    assert 0.4 < found.surfaces.modes / inside < 2.5
