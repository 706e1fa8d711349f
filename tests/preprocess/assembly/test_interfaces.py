"""Interfaces: frames that follow rigid motion exactly, spread load as a linear traction, and say
what they lack.
"""

import meshio
import numpy as np
import pytest
from duhamel.preprocess import InterfaceError, MeshError, assemble
from duhamel.preprocess.mesh.nodes import spider
from duhamel.preprocess.responses.static import compliance

E, NU = 2.1e11, 0.3
A, B = 0.2, 0.1  # the section of the bar below: y and z
LENGTH = 1.0


def bar(box, kind):
    mesh = box(kind, size=(LENGTH, A, B), divisions=(3, 2, 2))
    mesh.points -= [0.0, A / 2, B / 2]
    return mesh


def frame_motion(structure):
    """The rows of A at the interfaces: [I, -X~; 0, I]."""
    rows = []
    for interface in structure.interfaces:
        rows.append(spider(interface.X[None])[0])
        if interface.rotations:
            rows.append(np.eye(6)[3:])
    return np.vstack(rows)


CHOICES = {
    "average": {"root": {"group": "root"}, "tip": {"group": "tip"}},
    "rigid": {"root": {"group": "root", "kind": "rigid"}, "tip": {"group": "tip", "kind": "rigid"}},
    "mixed": {
        "root": {"group": "root", "kind": "rigid", "at": [-0.2, 0.1, 0]},
        "tip": {"group": "tip", "at": [2, 1, 1]},
    },
    "nodes": {"root": {"node": [0, -0.1, 0.05]}, "tip": {"node": [1, 0.1, -0.05]}},
    "shapes": {
        "side": {"box": {"corners": [[0, -0.1, -0.1], [0.7, 0.1, -0.05]]}},
        "tip": {"cylinder": {"axis": [[1, 0, 0], [2, 0, 0]], "radius": 0.2}, "kind": "rigid"},
    },
    "plane": {
        "side": {"plane": {"point": [9, 0, 0.05], "normal": [0, 0, 3]}},
        "tip": {"group": "tip"},
    },
}


@pytest.mark.parametrize("choice", CHOICES)
def test_frames_follow_rigid_motion_exactly(solid_body, box, kind, choice):
    """P_C A = [I, -X~; 0, I], so D U = U_C and no rigid motion loads an interface."""
    structure = assemble(solid_body(bar(box, kind), interfaces=CHOICES[choice]))
    np.testing.assert_allclose(
        structure.P_C @ structure.rigid.A, frame_motion(structure), rtol=0, atol=1e-12
    )


def test_frames_on_a_curved_face(solid_body, box, kind):
    mesh = bar(box, kind)
    x, y, z = mesh.points.T
    mesh.points = np.stack([x + 0.5 * y**2 + 0.1 * y, y, z + 0.1 * x * y], axis=1)
    structure = assemble(solid_body(mesh))
    np.testing.assert_allclose(
        structure.P_C @ structure.rigid.A, frame_motion(structure), rtol=0, atol=1e-12
    )


def test_a_frame_stands_at_the_centroid_unless_told(solid_body, box, kind):
    mesh = bar(box, kind)
    structure = assemble(
        solid_body(
            mesh, interfaces=CHOICES["plane"] | {"end": {"group": "root", "at": [0.3, 0, 0]}}
        )
    )
    X = np.array([i.X for i in structure.interfaces]) + structure.rigid.center
    np.testing.assert_allclose(X, [[0.5, 0, 0.05], [1, 0, 0], [0.3, 0, 0]], rtol=0, atol=1e-14)


def elongation(structure, p):
    """u_C under interface loads p that balance themselves."""
    return compliance(structure) @ p


def test_force_on_averaged_ends_is_uniform_tension(solid_body, box, kind):
    """Every element holds it exactly: elongation F L / E A."""
    structure = assemble(solid_body(bar(box, kind)))
    p = np.zeros(12)
    p[[0, 6]] = -1.0, 1.0
    u = elongation(structure, p)
    assert u[6] - u[0] == pytest.approx(LENGTH / (E * A * B), rel=1e-10)
    np.testing.assert_allclose(np.delete(u, [0, 6]) / (u[6] - u[0]), 0.0, atol=1e-8)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron20", "hexahedron27"])
def test_moment_on_averaged_ends_is_pure_bending(solid_body, box, kind):
    """The traction is linear over the face, so quadratic elements hold it exactly: rotation M L / E
    I.
    """
    structure = assemble(solid_body(bar(box, kind)))
    for axis, inertia in ((4, A * B**3 / 12), (5, B * A**3 / 12)):
        p = np.zeros(12)
        p[[axis, axis + 6]] = -1.0, 1.0
        u = elongation(structure, p)
        assert u[axis + 6] - u[axis] == pytest.approx(LENGTH / (E * inertia), rel=1e-9)


def test_rigid_ends_are_stiffer(solid_body, box, kind):
    """Tied faces take away freedom: the compliance falls, in the sense of quadratic forms."""
    soft = compliance(assemble(solid_body(bar(box, kind), interfaces=CHOICES["average"])))
    stiff = compliance(assemble(solid_body(bar(box, kind), interfaces=CHOICES["rigid"])))
    eigenvalues = np.linalg.eigvalsh(soft - stiff)
    assert eigenvalues.min() > -1e-9 * np.abs(soft).max()
    assert eigenvalues.max() > 1e-3 * np.abs(soft).max()


def test_a_plane_is_the_group_of_its_facets(solid_body, box, kind):
    by_plane = {"tip": {"plane": {"point": [LENGTH, 0, 0], "normal": [1, 0, 0]}}}
    a = assemble(solid_body(bar(box, kind), interfaces=by_plane)).P_C
    b = assemble(solid_body(bar(box, kind), interfaces={"tip": {"group": "tip"}})).P_C
    assert abs(a - b).max() < 1e-13


def test_corner_facets_name_quadratic_ones(solid_body, box):
    """A group of linear facets on a quadratic mesh means the faces with those corners."""
    mesh = bar(box, "tetra10")
    linear = meshio.CellBlock("triangle", mesh.cells[1].data[:, :3])
    mesh.cells[1] = linear
    a = assemble(solid_body(mesh)).P_C
    b = assemble(solid_body(bar(box, "tetra10"))).P_C
    assert abs(a - b).max() < 1e-13


def with_group(mesh, kind, rows):
    """The mesh with its tip named by other cells."""
    mesh.cells[1] = meshio.CellBlock(kind, np.asarray(rows))
    mesh.cell_data = {
        key: [data[0], np.full(len(rows), 2), data[2]] for key, data in mesh.cell_data.items()
    }
    mesh.field_data = {**mesh.field_data, "tip": np.array([2, mesh.cells[1].dim])}
    return mesh


def test_a_group_of_points_weighs_them_alike(solid_body, box):
    mesh = bar(box, "hexahedron")
    corners = np.flatnonzero(
        (np.abs(mesh.points - [LENGTH, 0, 0]) == [0, A / 2, B / 2]).all(axis=1)
    )[:, None]
    assert len(corners) == 4
    structure = assemble(solid_body(with_group(mesh, "vertex", corners)))
    np.testing.assert_allclose(
        structure.P_C @ structure.rigid.A, frame_motion(structure), rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(structure.P_C[6:9].sum(axis=1), 1.0, rtol=1e-12)
    row = structure.P_C[[6]].toarray().ravel()
    np.testing.assert_allclose(row[row != 0], 0.25, rtol=1e-12)


def test_a_group_of_one_point_is_a_node(solid_body, box):
    mesh = bar(box, "hexahedron")
    node = int(np.argmax(mesh.points @ [1, 1, 1]))
    structure = assemble(solid_body(with_group(mesh, "vertex", [[node]])))
    assert not structure.interfaces[1].rotations
    np.testing.assert_allclose(
        structure.interfaces[1].X + structure.rigid.center, mesh.points[node], atol=1e-15
    )


@pytest.mark.parametrize(
    ("tip", "message"),
    [
        (
            {"node": [1.01, 0, 0]},
            r"mesh.msh: interfaces.tip: no node at \[1.01, 0.0, 0.0\]: "
            r"the nearest is at \[1.0, 0.0, 0.0\], 0.01 m",
        ),
        (
            {"group": "box"},
            "interfaces.tip: expected a group of facets or of points, found hexahedron in 'box'",
        ),
        (
            {"plane": {"point": [0.77, 0, 0], "normal": [1, 0, 0]}},
            r"interfaces.tip: no facet of the boundary lies as a whole in plane "
            r"\(point=\(0.77, .*, nor does a node",
        ),
    ],
)
def test_selections_that_find_nothing(solid_body, box, tip, message):
    with pytest.raises(InterfaceError, match=message):
        assemble(solid_body(bar(box, "hexahedron"), interfaces={"tip": tip}))


def test_a_missing_group_lists_those_there_are(solid_body, beam_body, box, beam):
    with pytest.raises(
        MeshError, match=r"mesh.msh: no group 'tpi'; the groups of the mesh are: box, root, tip"
    ):
        assemble(solid_body(bar(box, "tetra10"), interfaces={"tip": {"group": "tpi"}}))
    with pytest.raises(
        MeshError, match="no group 'end'; the groups of the mesh are: beam, root, tip"
    ):
        assemble(beam_body(beam(2), interfaces={"tip": {"group": "end"}}))


def test_facets_that_are_no_faces(solid_body, box):
    mesh = bar(box, "hexahedron")
    stray = np.vstack([mesh.cells[1].data, [[0, 1, 2, 20]]])
    with pytest.raises(
        InterfaceError, match=r"interfaces.tip: 1 of 5 quad cells are no face.*\[0, 1, 2, 20\]"
    ):
        assemble(solid_body(with_group(mesh, "quad", stray)))
    mesh = bar(box, "hexahedron")
    with pytest.raises(
        InterfaceError, match=r"interfaces.tip: 4 of 4 triangle cells are no face of an element"
    ):
        assemble(solid_body(with_group(mesh, "triangle", mesh.cells[1].data[:, :3])))


def test_points_on_a_line_carry_no_frame(solid_body, box):
    mesh = bar(box, "hexahedron")
    edge = np.flatnonzero((mesh.points[:, 1:] == [A / 2, B / 2]).all(axis=1))[:, None]
    message = r"interfaces.tip: a frame needs three nodes that are not on a line, found 4"
    with pytest.raises(InterfaceError, match=message):
        assemble(solid_body(with_group(mesh, "vertex", edge)))


def test_rigid_interfaces_share_no_nodes(solid_body, box):
    interfaces = {
        "tip": {"group": "tip", "kind": "rigid"},
        "side": {"plane": {"point": [0, A / 2, 0], "normal": [0, 1, 0]}, "kind": "rigid"},
    }
    message = r"interfaces.side: rigid interfaces must not share nodes, found point \d+ also in tip"
    with pytest.raises(InterfaceError, match=message):
        assemble(solid_body(bar(box, "hexahedron"), interfaces=interfaces))


def test_what_lies_on_a_rigid_interface_moves_with_it(solid_body, box, kind):
    """Wholly on it: by the rows of the rigid frame, [I, -r~; 0, I], and nothing else; in part: D A
    = I all the same.
    """
    tip = {"group": "tip", "kind": "rigid", "at": [1.2, 0.1, 0]}
    side = {"plane": {"point": [0, A / 2, 0], "normal": [0, 1, 0]}}
    mesh = bar(box, kind)
    corner = mesh.points[np.argmax(mesh.points @ [1, 1, 1])].tolist()
    interfaces = {"tip": tip, "same": {"group": "tip"}, "corner": {"node": corner}, "side": side}
    structure = assemble(solid_body(mesh, interfaces=interfaces))
    np.testing.assert_allclose(
        structure.P_C @ structure.rigid.A, frame_motion(structure), rtol=0, atol=1e-12
    )
    X = np.array([interface.X for interface in structure.interfaces])
    frame = structure.P_C[:6]
    arm = spider(X[[1]] - X[0])[0]
    np.testing.assert_allclose(
        (structure.P_C[6:12] @ frame.T).toarray(), np.vstack([arm, np.eye(6)[3:]]), atol=1e-12
    )
    np.testing.assert_allclose(
        (structure.P_C[12:15] @ frame.T).toarray(), spider(X[[2]] - X[0])[0], atol=1e-12
    )
    for rows in (structure.P_C[6:12], structure.P_C[12:15]):
        assert abs(rows - rows @ frame.T @ frame).max() < 1e-12


@pytest.mark.parametrize("choice", ["average", "rigid"])
def test_many_interfaces(solid_body, box, choice):
    """Pads in rows and columns: 24 frames on a plate, where and as they were asked for."""
    places = np.stack(
        np.meshgrid(np.arange(6), np.arange(4), [0.5], indexing="ij"), axis=-1
    ).reshape(-1, 3)
    corners = np.stack([places - [0.3, 0.3, 0.0], places + 0.3], axis=1).tolist()
    pads = {f"pad{i}": {"box": {"corners": corners[i]}, "kind": choice} for i in range(24)}
    mesh = box("hexahedron", size=(6.0, 4.0, 0.5), divisions=(24, 16, 1))
    mesh.points -= [0.5, 0.5, 0.0]
    structure = assemble(solid_body(mesh, interfaces=pads))
    assert structure.P_C.shape == (144, structure.n_u)
    X = np.array([interface.X for interface in structure.interfaces]) + structure.rigid.center
    np.testing.assert_allclose(X, places, atol=1e-12)
    np.testing.assert_allclose(
        structure.P_C @ structure.rigid.A, frame_motion(structure), rtol=0, atol=1e-11
    )


@pytest.mark.parametrize(
    ("tip", "message"),
    [
        (
            {"group": "beam"},
            r"interfaces.tip: expected one node of the lines, found 4 in group 'beam': points 0 at",
        ),
        (
            {"box": {"corners": [[0.1, 0, 0], [1, 0, 0]]}},
            r"interfaces.tip: expected one node .*, found 3 in box \(corn",
        ),
        (
            {"sphere": {"center": [0, 1, 0], "radius": 0.1}},
            r"interfaces.tip: no node lies in sphere \(center=",
        ),
        ({"group": "tip", "kind": "rigid"}, "interfaces.tip: kind and at belong to facets"),
        (
            {"node": [0.3, 0, 0]},
            r"interfaces.tip: no node at \[0.3, 0.0, 0.0\]: .* allows 0.0005 m",
        ),
    ],
)
def test_selections_that_beams_do_not_have(beam_body, beam, tip, message):
    with pytest.raises(InterfaceError, match=message):
        assemble(beam_body(beam(3), interfaces={"tip": tip}))


def test_a_wider_tolerance_finds_the_node(beam_body, beam):
    structure = assemble(
        beam_body(beam(3), interfaces={"tip": {"node": [0.3, 0, 0], "tolerance": 0.1}})
    )
    assert structure.interfaces[0].X[0] + structure.rigid.center[0] == pytest.approx(1 / 3)
