"""Recovered surfaces: which points and facets, and strains that are exact or converge as they
should.
"""

import meshio
import numpy as np
import pytest
from duhamel.preprocess import BodyError, MeshWarning, MethodError, assemble, build
from duhamel.preprocess.body.body import Damping
from duhamel.preprocess.recovery import recover
from duhamel.preprocess.responses.band import Band
from duhamel.preprocess.responses.modal import elastic_shapes
from duhamel.preprocess.responses.search import Request, krylov_modes
from duhamel.preprocess.solving.factor import factorize
from duhamel.preprocess.sources.reading import read_source
from duhamel.superelement import GeneralizedAlpha, read, write
from scipy.sparse import eye_array

E, NU = 2.1e11, 0.3
QUADRATIC = ["tetra10", "hexahedron20", "hexahedron27"]
STRESS = {"stress": True}
ORTHOTROPIC = {
    "E": [1.4e11, 1e10, 8e9],
    "nu": [0.3, 0.25, 0.4],
    "G": [5e9, 4e9, 3e9],
    "rho": 1600.0,
    "axes": [[1.0, 1.0, 0.2], [0.0, 1.0, 0.5]],
}


def mesh_of(points, parts):
    """A mesh of named parts (name, type, cells)."""
    cells = [(kind, np.asarray(rows)) for _, kind, rows in parts]
    tags = [np.full(len(rows), i + 1) for i, (_, rows) in enumerate(cells)]
    block = {kind: meshio.CellBlock(kind, rows).dim for kind, rows in cells}
    names = {name: np.array([i + 1, block[kind]]) for i, (name, kind, _) in enumerate(parts)}
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    return meshio.Mesh(points, cells, cell_data=data, field_data=names)


def field(body, displacement):
    """The recovery of a body and its structure, for which the one mode shape is a field of
    displacements.
    """
    structure, source = assemble(body), read_source(body)
    u = displacement(structure.nodes.points).ravel()[:, None]
    return recover(body, source, structure, lambda rows: rows @ u), structure


def shaken(mesh, amount=0.05):
    """Elements that are neither alike nor, where they have nodes for it, straight-sided."""
    x, y, z = mesh.points.T
    mesh.points = mesh.points + amount * np.stack([y * z, x * z, x * y], axis=1)
    return mesh


def test_a_constant_strain_is_exact_at_every_node(solid_body, box, kind):
    gradient = np.random.default_rng(1).normal(size=(3, 3))
    body = solid_body(shaken(box(kind)), material=ORTHOTROPIC, recovery=STRESS)
    recovery, _ = field(body, lambda X: X @ gradient.T)
    e = 0.5 * (gradient + gradient.T)
    strain = [e[0, 0], e[1, 1], e[2, 2], 2 * e[1, 2], 2 * e[0, 2], 2 * e[0, 1]]
    expected = body.material.elasticity @ strain
    np.testing.assert_allclose(
        recovery.stress[:, :, 0], expected + 0 * recovery.stress[:, :, 0], atol=1e-2, rtol=1e-11
    )


@pytest.mark.parametrize("kind", ["hexahedron", *QUADRATIC])
def test_pure_bending_is_exact(solid_body, box, kind):
    """u = (xy, -x^2/2 - nu (y^2 - z^2)/2, -nu yz) has stress E y along x and none other: sigma = M
    y / I.
    """

    def bent(points):
        x, y, z = (points - [0.0, 0.5, 0.5]).T
        return np.stack([x * y, -(x**2) / 2 - NU * (y**2 - z**2) / 2, -NU * y * z], axis=1)

    recovery, structure = field(solid_body(box(kind), recovery=STRESS), bent)
    y = (recovery.points + structure.rigid.center)[:, 1] - 0.5
    np.testing.assert_allclose(recovery.stress[:, 0, 0], E * y, rtol=0, atol=1e-11 * E)
    np.testing.assert_allclose(recovery.stress[:, 1:, 0], 0.0, rtol=0, atol=1e-11 * E)


def flexure(points):
    """A cantilever under an end force, nu = 0, E = 1 and a depth of 1: sigma_xx = -x y, tau_xy =
    (y^2 - 1/4) / 2.
    """
    x, y, z = (points - [0.0, 0.5, 0.0]).T
    u = np.stack([y**3 / 3 - x**2 * y / 2, x**3 / 6 - x / 4, 0 * z], axis=1)
    stress = np.stack([-x * y, 0 * x, 0 * x, 0 * x, 0 * x, (y**2 - 0.25) / 2], axis=1)
    return u, stress


def error_of_flexure(body):
    """The largest error of a stress at a node: the mesh is held at both ends as the exact solution
    is there.
    """
    structure, source = assemble(body), read_source(body)
    x = structure.nodes.points[:, 0]
    held = np.repeat((x < 1e-9) | (x > 2 - 1e-9), 3)
    u = np.where(held, flexure(structure.nodes.points)[0].ravel(), 0.0)
    free = np.flatnonzero(~held)
    u[free] = factorize(structure.K[free][:, free], "K")(-(structure.K @ u)[free, None])[:, 0]
    recovery = recover(body, source, structure, lambda rows: rows @ u[:, None])
    _, expected = flexure(recovery.points + structure.rigid.center)
    return np.abs(recovery.stress[:, :, 0] - expected).max()


def test_the_order_of_stresses_at_the_surface(solid_body, box, kind):
    """h^2 for quadratic elements, h for linear ones, in the largest error of all nodes, corners of
    the bar included.
    """
    material = {"E": 1.0, "nu": 0.0, "rho": 1.0}
    divisions = [(4, 2, 2), (8, 4, 4)]
    meshes = [box(kind, (2.0, 1.0, 1.0), n) for n in divisions]
    coarse, fine = (
        error_of_flexure(solid_body(mesh, material=material, recovery=STRESS)) for mesh in meshes
    )
    assert np.log2(coarse / fine) > (1.95 if kind in QUADRATIC else 0.85)


def test_the_surface_closes_and_turns_outwards(solid_body, box, kind):
    """int x . n dA = 3 V over the facets, whose corners are a plane triangle or parallelogram."""
    recovery, structure = field(solid_body(box(kind, (2.0, 1.0, 0.5)), recovery={}), lambda X: X)
    assert recovery.stress is None
    assert np.isin(np.arange(len(recovery.points)), recovery.cells).all()
    nodes = np.sum(recovery.cells >= 0, axis=1)
    flux = 0.0
    for facet, triangle in zip(recovery.cells, np.isin(nodes, (3, 6)), strict=True):
        a, b, c = recovery.points[facet[:3]]
        flux += a @ np.cross(b - a, c - a) * (0.5 if triangle else 1.0)
    assert flux == pytest.approx(3 * structure.rigid.mass / 7800.0, rel=1e-12)
    assert np.abs(recovery.phi[:, :, 0] - recovery.points - structure.rigid.center).max() < 1e-15


def test_wedges_and_tetrahedra_side_by_side(solid_body, box):
    """A wedge on a tetrahedron: facets of three and four nodes in one surface, and one strain."""
    points = np.array(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1), (0.2, 0.2, 1.7)]
    )
    parts = [
        ("root", "triangle", [[0, 2, 1]]),
        ("tip", "triangle", [[3, 4, 6]]),
        ("prism", "wedge", [[0, 1, 2, 3, 4, 5]]),
        ("top", "tetra", [[3, 4, 5, 6]]),
    ]
    gradient = np.random.default_rng(1).normal(size=(3, 3))
    body = solid_body(mesh_of(points, parts), recovery=STRESS)
    recovery, _ = field(body, lambda X: X @ gradient.T)
    assert sorted(np.sum(recovery.cells >= 0, axis=1).tolist()) == [3, 3, 3, 3, 4, 4, 4]
    uniform = np.broadcast_to(recovery.stress[0], (7, 6, 1))
    rounding = 1e-14 * np.abs(uniform).max()
    np.testing.assert_allclose(recovery.stress, uniform, rtol=0, atol=rounding)
    trace = recovery.stress[0, :3, 0].sum()
    assert trace == pytest.approx(E / (1 - 2 * NU) * np.trace(gradient), rel=1e-12)


def test_a_node_between_materials_has_the_stresses_of_both(solid_body, box):
    """Two cubes that share a face, one ten times as stiff, under one strain along x."""
    mesh = box("hexahedron20", size=(2.0, 1.0, 1.0), divisions=(2, 1, 1))
    block = mesh.cells[2].data
    parts = [(name, c.type, c.data) for name, c in zip(("root", "tip"), mesh.cells, strict=False)]
    parts += [("soft", "hexahedron20", block[:1]), ("stiff", "hexahedron20", block[1:])]
    materials = {
        name: {"E": E * factor, "nu": 0.0, "rho": 1.0}
        for name, factor in (("soft", 1.0), ("stiff", 10.0))
    }
    body = solid_body(
        mesh_of(mesh.points, parts), material=None, materials=materials, recovery=STRESS
    )
    recovery, structure = field(body, lambda X: X * [1.0, 0.0, 0.0])
    x = (recovery.points + structure.rigid.center)[:, 0]
    assert len(recovery.points) == len(mesh.points) + 8
    axial = recovery.stress[:, 0, 0]
    np.testing.assert_allclose(axial[x < 0.9], E, rtol=1e-12)
    np.testing.assert_allclose(axial[x > 1.1], 10 * E, rtol=1e-12)
    between = np.sort(axial[np.abs(x - 1.0) < 1e-9])
    np.testing.assert_allclose(between, np.repeat([E, 10 * E], 8), rtol=1e-12)
    of_cell = axial[recovery.cells]
    assert (np.ptp(of_cell, axis=1) < 1e-9 * E).all()


def test_tied_nodes_follow_their_frame(solid_body, box, kind):
    """Rigid motions of the structure move the surface as one piece, without stress."""
    interfaces = {"root": {"group": "root", "kind": "rigid"}, "tip": {"group": "tip"}}
    body = solid_body(box(kind), interfaces=interfaces, recovery=STRESS)
    structure, source = assemble(body), read_source(body)
    recovery = recover(body, source, structure, lambda rows: rows @ structure.rigid.A)
    for i, axis in enumerate(np.eye(3)):
        np.testing.assert_allclose(
            recovery.phi[:, :, i], axis + 0 * recovery.points, rtol=0, atol=1e-14
        )
        turned = np.cross(axis, recovery.points)
        np.testing.assert_allclose(recovery.phi[:, :, 3 + i], turned, rtol=0, atol=1e-14)
    assert np.abs(recovery.stress).max() < 1e-11 * E


def test_a_built_solid_keeps_its_recovery_in_the_file(solid_body, box, tmp_path):
    """The mean of the modes over the nodes of a rigid face is that of its frame."""
    interfaces = {"root": {"group": "root", "kind": "rigid"}, "tip": {"group": "tip"}}
    element = build(solid_body(box("hexahedron"), interfaces=interfaces, recovery=STRESS))
    recovery, root = element.recovery, element.interface("root")
    face = np.abs(recovery.points[:, 0] - root.X[0]) < 1e-9
    np.testing.assert_allclose(
        recovery.phi[face].mean(axis=0), element.modes.phi[:3], rtol=0, atol=1e-12
    )
    write(tmp_path / "box.h5", element)
    again = read(tmp_path / "box.h5").recovery
    for name in ("points", "cells"):
        np.testing.assert_array_equal(getattr(again, name), getattr(recovery, name))
    for name in ("phi", "stress"):
        np.testing.assert_allclose(getattr(again, name), getattr(recovery, name), rtol=2.0**-24)


def test_lines_have_points_and_displacements(beam_body, beam):
    element = build(beam_body(beam(4), recovery={}))
    recovery = element.recovery
    np.testing.assert_array_equal(recovery.cells, [[0, 1], [1, 2], [2, 3], [3, 4]])
    np.testing.assert_allclose(
        recovery.points[:, 0], np.linspace(-0.25, 0.25, 5), rtol=0, atol=1e-15
    )
    np.testing.assert_array_equal(recovery.phi[0], element.modes.phi[:3])
    np.testing.assert_array_equal(recovery.phi[-1], element.modes.phi[6:9])
    assert recovery.stress is None


def test_what_cannot_be_recovered(beam_body, beam, solid_body, box):
    with pytest.raises(
        BodyError, match=r"recovery.stress: expected a mesh of solids, found mesh.msh, one of lines"
    ):
        build(beam_body(beam(2), recovery=STRESS))
    impulse = {"step": 1e-4, "steps": 20, "method": "march"}
    with pytest.raises(
        MethodError, match=r"\[recovery\] needs modes, which impulse.method march does not find"
    ):
        build(solid_body(box("tetra"), impulse=impulse, recovery={}))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_fields_of_krylov_modes_err_by_no_more_than_the_tolerance(solid_body, box, tolerance):
    """Beside all modes, in the norm of strain energy over the band; a kernel to the same tolerance
    leaves more.
    """
    h = 5e-6
    structure = assemble(solid_body(box("hexahedron20", (0.2, 0.05, 0.05), (6, 2, 2))))
    band = Band(h, GeneralizedAlpha(0.9), 0.25 / h)
    every, every_shapes = elastic_shapes(structure, Damping())
    everywhere = eye_array(structure.n_u, format="csr")

    def errors(fields):
        modes, shapes, stated = krylov_modes(Request(structure, Damping(), band, tolerance, fields))
        turn = every_shapes(everywhere).T @ (structure.M @ shapes(everywhere))
        return band.field_error(modes, every, turn), stated

    true, stated = errors(fields=True)
    assert true <= stated <= tolerance
    assert errors(fields=False)[0] > 2.0 * true


def test_batches_of_points_change_nothing(solid_body, box, monkeypatch):
    """Displacements and stresses of several modes, of all points at once and of a few at a time."""
    body = solid_body(box("tetra10", divisions=(3, 2, 2)), recovery=STRESS)
    structure, source = assemble(body), read_source(body)
    modes = np.random.default_rng(0).normal(size=(structure.n_u, 4))
    whole = recover(body, source, structure, lambda rows: rows @ modes)
    monkeypatch.setattr("duhamel.preprocess.recovery.POINTS_AT_ONCE", 7)
    assert len(whole.points) % 7
    parts = recover(body, source, structure, lambda rows: rows @ modes)
    np.testing.assert_array_equal(parts.phi, whole.phi)
    np.testing.assert_allclose(parts.stress, whole.stress, rtol=1e-12, atol=1e-3)
    dofs = 3 * source.field_points(True).nodes[:, None] + np.arange(3)
    np.testing.assert_array_equal(whole.phi, (structure.T @ modes)[dofs])


def test_batches_of_nodes_with_rotations_change_nothing(beam_body, beam, monkeypatch):
    body = beam_body(beam(9), recovery={})
    structure, source = assemble(body), read_source(body)
    modes = np.random.default_rng(0).normal(size=(structure.n_u, 3))
    whole = recover(body, source, structure, lambda rows: rows @ modes)
    monkeypatch.setattr("duhamel.preprocess.recovery.POINTS_AT_ONCE", 4)
    parts = recover(body, source, structure, lambda rows: rows @ modes)
    np.testing.assert_array_equal(parts.phi, whole.phi)
    np.testing.assert_array_equal(parts.phi_rotation, whole.phi_rotation)
    assert parts.stress is None


DECK = """*Node
 900, 0, 0, 0
 {}
*Element, type=C3D8, elset=all
 1, 10, 20, 30, 40, 50, 60, 70, 80
*Nset, nset=root
 10, 40, 50, 80
*Nset, nset=tip
 20, 30, 60, 70
"""


def test_points_have_the_numbers_of_their_nodes_in_the_file(solid_body, box, tmp_path):
    """A node that no element has comes first, and is left out."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    places = {10 * (i + 1): (x, y, i // 4) for i, (x, y, _) in enumerate(2 * corners)}
    lines = [f"{label}, {x}, {y}, {z}" for label, (x, y, z) in places.items()]
    (tmp_path / "cube.inp").write_text(DECK.format("\n ".join(lines)))
    body = solid_body(box("hexahedron"), recovery=STRESS)
    body = body.model_copy(update={"mesh": tmp_path / "cube.inp"})
    with pytest.warns(MeshWarning, match="1 nodes that belong to no element"):
        recovery, structure = field(body, lambda X: X)
    found = dict(
        zip(recovery.nodes.tolist(), recovery.points + structure.rigid.center, strict=True)
    )
    assert set(found) == set(places)
    for label, place in places.items():
        np.testing.assert_allclose(found[label], place, atol=1e-12)
