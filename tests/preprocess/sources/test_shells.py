"""Bodies of shells: faces, loads, sensors, groups, what is refused, and a run with one."""

import duhamel as du
import numpy as np
import pytest
from duhamel.preprocess import Body, BodyError, MeshError, PreprocessError, assemble, build, mesh_of
from duhamel.preprocess.assembly.structure import assemble_on
from duhamel.preprocess.body.loads import LoadPattern
from duhamel.preprocess.body.sensors import SensorPoint
from duhamel.preprocess.mesh.divided import divided
from duhamel.preprocess.outline import outline_of
from duhamel.preprocess.responses.static import compliance
from duhamel.preprocess.sources.reading import read_mesh_source

from ..shell_cases import IMPULSE, KINDS, Grid

STEEL = {"E": 210e9, "nu": 0.3, "rho": 7850.0}
t = 0.02


def bent(r, s):
    """A quarter of a cylinder of radius 1, whose normals point inwards."""
    angle = 0.5 * np.pi * r
    return np.cos(angle), 0.5 * s, np.sin(angle)


def on(grid, **tables):
    """The source of the body of a grid with other tables."""
    given = grid.body.model_dump(exclude_unset=True)
    return read_mesh_source(Body.model_validate(given | {"mesh": grid.source.mesh} | tables))


@pytest.fixture(params=KINDS)
def arc(request):
    return Grid(bent, (8, 4), request.param, thickness=t, offset=0.3 * t, **STEEL)


@pytest.fixture(params=KINDS)
def plate(request):
    def place(r, s):
        return 0.4 * r + 0.02 * np.sin(9 * s) * r * (1 - r), 0.2 * s + 0.02 * r * s * (1 - s), 0.0

    return Grid(place, (8, 4), request.param, thickness=t, **STEEL)


def rigid(points, turn=(0.1, -0.2, 0.3), shift=(1.0, 2.0, -1.0)):
    return np.array(shift) + np.cross(turn, points)


def rigid_dofs(grid):
    turned = np.broadcast_to((0.1, -0.2, 0.3), grid.points.shape)
    return np.hstack([rigid(grid.points), turned]).ravel()


def test_the_outline_is_as_thick_as_the_shell_and_closed(arc):
    outline = outline_of(arc.source, np.zeros(3))
    assert outline.volume == pytest.approx(0.5 * np.pi * 0.5 * t * (1.0 - 0.3 * t), rel=0.01)
    corners = [row[row >= 0] for row in outline.cells]
    sides = {(a, b) for row in corners for a, b in zip(row, np.roll(row, -1), strict=True)}
    assert {(b, a) for a, b in sides} == sides
    radii = np.hypot(*outline.points[:, [0, 2]].T)
    # Nodes at the ends have the normals of their elements, which are flat.
    off = np.minimum(np.abs(radii - 1.0 + 0.8 * t), np.abs(radii - 1.0 - 0.2 * t))
    assert off.max() < 0.01 * t


def test_sensors_and_faces_move_as_rigid_bodies_do(arc):
    u = rigid_dofs(arc)
    point = np.array([np.cos(0.7), 0.21, np.sin(0.7)]) * [0.995, 1.0, 0.995]
    source = on(arc, sensors={"s": {"point": point.tolist()}})
    rows, _ = source.readings(source.body.sensors["s"])
    np.testing.assert_allclose(rows @ u, rigid(point), atol=1e-9)
    faces = source.field_points(stress=True)
    structure = assemble_on(source.body, source)
    T, turns = structure.T, structure.turns
    moved = (faces.displacement_rows(T, turns=turns) @ u).reshape(-1, 3)
    np.testing.assert_allclose(moved, rigid(faces.places(source.nodes)), atol=1e-12)
    stress = faces.stress_rows(T, turns=turns)
    assert np.abs(stress @ u).max() < 1e-9 * np.abs(stress).max()


def test_a_point_is_found_in_a_long_shell_beside_many_small_ones():
    """Whose middles are all nearer."""

    def place(r, s):
        return 0.05 * min(9 * r, 8.0) + 10.0 * max(9 * r - 8.0, 0.0), 0.25 * s, 0.0

    source = Grid(place, (9, 5), thickness=t, **STEEL).source
    point = [0.41, 0.12, 0.004]
    sensor = SensorPoint(point=point)
    rows, _ = source.readings(sensor)
    turned = np.broadcast_to((0.1, -0.2, 0.3), source.mesh.points.shape)
    u = np.hstack([rigid(source.mesh.points), turned])
    np.testing.assert_allclose(rows @ u.ravel(), rigid(point), atol=1e-12)


def test_gauges_and_stresses_are_those_of_a_bent_and_stretched_plate(plate):
    """On the upper face, of curvatures k and strains e that the patch test has exactly."""
    e, k = np.array([1e-4, -2e-4, 3e-4]), np.array([-2e-3, 1e-3, 4e-3])
    x, y, _ = plate.points.T
    w = -0.5 * (k[0] * x * x + k[1] * y * y + k[2] * x * y)
    slopes = -(k[0] * x + 0.5 * k[2] * y), -(k[1] * y + 0.5 * k[2] * x)
    u = [e[0] * x + 0.5 * e[2] * y, e[1] * y + 0.5 * e[2] * x, w, slopes[1], -slopes[0], 0 * x]
    u = np.stack(u, axis=1)
    strain = e + 0.5 * t * k
    Q = 210e9 / (1 - 0.09) * np.array([[1, 0.3, 0], [0.3, 1, 0], [0, 0, 0.35]])
    stress = Q @ strain
    point = [0.11, 0.07, 0.5 * t]
    gauge = {"point": point, "direction": [0.6, 0.8, 0.0]}
    source = on(plate, sensors={"g": gauge, "s": {"point": point, "stress": True}})
    rows, _ = source.readings(source.body.sensors["g"])
    along = 0.36 * strain[0] + 0.64 * strain[1] + 0.48 * strain[2]
    np.testing.assert_allclose(rows @ u.ravel(), along, rtol=1e-8)
    rows, _ = source.readings(source.body.sensors["s"])
    expected = [stress[0], stress[1], 0.0, 0.0, 0.0, stress[2]]
    np.testing.assert_allclose(rows @ u.ravel(), expected, atol=1e-6 * abs(stress).max())
    faces = source.field_points(stress=True)
    found = faces.by_displacements @ u[:, :3].ravel() + faces.by_rotations @ u[:, 3:].ravel()
    upper = faces.places(source.nodes)[:, 2] > 0.0
    found = found.reshape(-1, 6)[upper]
    np.testing.assert_allclose(
        found, np.tile(expected, (len(found), 1)), atol=1e-6 * abs(stress).max()
    )


def test_loads_have_the_resultants_of_what_they_are_spread_over(arc):
    """Of a pressure on the inside of the arc, and of weight through its thickness."""
    whole = {"box": {"corners": [[-1, 0, 0], [1, 1, 1]]}}
    loads = {
        "pressure": {"pressure": 3.0, **whole},
        "traction": {"traction": [0.0, 2.0, 0.0], **whole},
        "weight": {"force_per_volume": [0.0, 0.0, -5.0]},
    }
    source = on(arc, loads=loads)
    A = arc.source.nodes.rigid_motion(np.zeros(3))
    pressure, traction, weight = (A.T @ source.forces(load) for load in source.body.loads.values())
    # Normals point inwards, and a pressure against them outwards.
    np.testing.assert_allclose(pressure[:3], [1.5, 0.0, 1.5], atol=1e-9)
    area = source.shares()[0].extent
    np.testing.assert_allclose(traction[:3], [0.0, 2.0 * area, 0.0], atol=1e-9)
    # In the middle of the thickness, where a force per volume acts.
    spread = LoadPattern(force_per_volume=(0.0, 2.0 / t, 0.0))
    np.testing.assert_allclose(source.forces(source.body.loads["traction"]), source.forces(spread))
    # As gravity on the mass, whose moments are those of its middle beside the nodes.
    g = np.tile([0, 0, -5.0 / 7850.0, 0, 0, 0], len(arc.points))
    np.testing.assert_allclose(weight, A.T @ (arc.M @ g), rtol=1e-9, atol=1e-9)


def test_an_average_edge_moves_as_the_rigid_motion_of_its_nodes(arc):
    edge = {"plane": {"point": [1.0, 0, 0], "normal": [0, 0, 1]}}
    for kind in ("average", "rigid"):
        edges = {"edge": edge | {"kind": kind}}
        structure = assemble(on(arc, interfaces=edges).body)
        moved = structure.P_C @ structure.nodes.rigid_motion(np.zeros(3))
        X = structure.frames["edge"].X
        turn = np.array([0.1, -0.2, 0.3])
        motion = moved @ np.concatenate([[1.0, 2.0, -1.0], turn])
        np.testing.assert_allclose(motion[:3], rigid(X), atol=1e-12)
        np.testing.assert_allclose(motion[3:6], turn, atol=1e-12)


def test_a_rigid_frame_on_one_node_leaves_six_rigid_motions(arc):
    """As many dofs as before, in another order."""
    one = {"node": [1.0, 0.25, 0.0]}
    at = {"sphere": {"center": [1.0, 0.25, 0.0], "radius": 0.05}, "kind": "rigid"}
    compliances = []
    for selection in (one, at):
        structure = assemble(on(arc, interfaces={"held": selection}).body)
        A = structure.rigid.A
        np.testing.assert_allclose(structure.K @ A, 0.0, atol=1e-12 * abs(structure.K).max())
        compliances.append(compliance(structure))
    scale = np.sqrt(np.diag(compliances[0]))
    np.testing.assert_allclose(*(H / np.outer(scale, scale) for H in compliances), atol=1e-6)


def second_order(kind):
    """A plate of four cells of second order, one of them in the group patch."""
    x, y = np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 2, 5), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    number = np.arange(25).reshape(5, 5)
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
    cells = [[number[i + a, j + b] for a, b in around] for i in (0, 2) for j in (0, 2)]
    cells = np.array(cells)
    if kind == "triangle6":
        halves = [[0, 1, 2, 4, 5, 8], [0, 2, 3, 8, 6, 7]]
        cells = np.concatenate([cells[:, half] for half in halves])
    if kind == "quad8":
        cells = cells[:, :8]
        used, cells = np.unique(cells, return_inverse=True)
        points, cells = points[used], cells.reshape(-1, 8)
    import meshio

    return meshio.Mesh(points, [(kind, cells)], cell_sets={"patch": [np.array([1])]})


@pytest.mark.parametrize("kind", ["triangle6", "quad8", "quad9"])
def test_shells_of_second_order_are_divided_at_their_nodes(kind):
    mesh = mesh_of(second_order(kind))
    parts = divided(mesh)
    assert parts.body_types == (("triangle",) if kind == "triangle6" else ("quad",))
    assert parts.n_elements == 4 * mesh.n_elements
    grid = {"mesh": mesh, "shell": {"thickness": t}, "material": STEEL, "name": "plate"}
    grid |= {"interfaces": {"corner": {"node": [0, 0, 0]}}, "impulse": IMPULSE}
    source = read_mesh_source(Body.model_validate(grid))
    assert source.shares()[0].extent == pytest.approx(4.0)
    cells = parts.elements[parts.body_types[0]][parts.members("patch")]
    corners = mesh.points[mesh.cells[kind][1]]
    assert set(map(tuple, parts.points[cells].reshape(-1, 3))) >= set(map(tuple, corners))
    middles = parts.points[cells].mean(axis=1)
    assert (middles > corners.min(axis=0) - 1e-9)[:, :2].all()
    assert (middles < corners.max(axis=0) + 1e-9)[:, :2].all()


def grouped(plies=None):
    """Two plates of 1 m side by side, each in a group of its own."""
    import meshio

    points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    cells = [("quad", np.array([[0, 1, 4, 3], [1, 2, 5, 4]]))]
    sets = {"thin": [np.array([0])], "thick": [np.array([1])]}
    return {
        "name": "plates",
        "mesh": mesh_of(meshio.Mesh(np.array(points, float), cells, cell_sets=sets)),
        "materials": {"steel": STEEL, "foam": {"E": 1e8, "nu": 0.3, "rho": 60.0}},
        "shells": {
            "thin": {"thickness": 0.001, "material": "steel"},
            "thick": plies or {"thickness": 0.1, "material": "foam", "offset": 0.05},
        },
        "interfaces": {"left": {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}},
        "impulse": IMPULSE,
    }


def test_groups_have_thicknesses_offsets_and_materials_of_their_own():
    body = Body.model_validate(grouped())
    shares = {share.group: share.mass for share in read_mesh_source(body).shares()}
    assert shares == pytest.approx({"thin": 7.85, "thick": 6.0})
    assert assemble(body).rigid.center[2] == pytest.approx(6.0 * 0.05 / 13.85)


@pytest.mark.parametrize(
    ("radius", "at", "found"),
    [(0.01, [0, 0, 1], "one with at"), (0.06, None, "an average of 3 nodes")],
)
def test_frames_of_which_the_second_order_is_not_known_are_refused(plate, radius, at, found):
    """A frame beside its node has an arm that turns, as those on several nodes have."""
    ball = {"sphere": {"center": [0, 0, 0], "radius": radius}, **({"at": at} if at else {})}
    source = on(plate, interfaces={"a": ball}, rotation={"level": 1})
    with pytest.raises(BodyError, match=f"interfaces.a: with .rotation. .* found {found}"):
        source.tensors(plate.M, np.zeros(3))


SOLID_CELL = {"tetra": [[0, 1, 2, 3]]}
REFUSED = [
    ({"shells": {}, "materials": {}, "material": STEEL}, "expected .shell. or .shells.GROUP"),
    ({"shell": {"thickness": 0.001}}, "expected one of shell and shells, found both"),
    ({"shells": {"thin": {"thickness": 1e-3, "material": "tin"}}}, "no material 'tin'"),
    ({"shells": {"thin": {"thickness": 1e-3}}}, "shells.thin: expected material, one of"),
    ({"shells": {"thin": {"material": "steel"}}}, "expected thickness or plies, found neither"),
    ({"shells": {"thin": {"thickness": -1.0, "material": "steel"}}}, "greater than 0"),
    ({"shells": {"all": {"thickness": 1e-3, "material": "steel"}}}, "a shell of it, found none"),
    ({"order": 2}, "order: expected 1 of shells"),
    (
        {"impulse": IMPULSE | {"method": "krylov", "solver": "iterative"}},
        "impulse.solver: expected auto or factor of shells",
    ),
    ({"rotation": {"level": 2}}, "rotation.level: expected 1 of shells"),
    ({"surfaces": {"top": {"group": "thin"}}}, "surfaces: expected a mesh of solids, found shells"),
    ({"loads": {"f": {"force_per_length": [1, 0, 0]}}}, "expected a mesh of lines, found one of s"),
    ({"loads": {"f": {"force_per_volume": [1, 0, 0], "group": "no"}}}, "no group 'no'"),
    ({"sensors": {"s": {"point": [0.5, 0.5, 0.1]}}}, "expected a point within the thickness"),
    (
        {"sensors": {"s": {"point": [1.5, 0.5, 0.05], "stress": True}}},
        "stress: expected a point on a face of the shell",
    ),
    (
        {"sensors": {"s": {"point": [1.5, 0.5, 0.05], "direction": [0, 0, 1]}}},
        "direction: expected one along the shell",
    ),
    (
        {"materials": {"steel": STEEL | {"axes": [[1, 0, 0], [0, 1, 0]]}, "foam": STEEL}},
        "axes of a material are those of solids",
    ),
    (
        {"materials": {"steel": STEEL | {"G": 8e10}, "foam": STEEL}},
        "shells.thin.orientation: missing",
    ),
    (
        {
            "shells": {
                "thin": {"thickness": 0.001, "material": "steel", "orientation": [0, 0, 1]},
                "thick": {"thickness": 0.1, "material": "foam"},
            }
        },
        "orientation: expected a vector that is not along the normal",
    ),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED)
def test_what_a_body_of_shells_cannot_have_is_named(changes, words):
    with pytest.raises((ValueError, PreprocessError), match=words):
        assemble(Body.model_validate(grouped() | changes))


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        ([[0, 1, 3, 2]], "degenerate or not convex"),
        ([[0, 1, 4, 3], [4, 5, 2, 1]], "found them on opposite sides of neighbors"),
        ([[0, 1, 4, 3], [1, 2, 5, 4], [1, 2, 2, 4]], "degenerate or not convex"),
        ([[0, 1, 4, 3], [1, 2, 5, 4], [4, 3, 0, 1]], "is there 2 times, expected once"),
    ],
)
def test_meshes_that_are_no_shells_are_named(cells, words):
    points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    used = sorted({node for cell in cells for node in cell})
    points, cells = np.array(points, float)[used], np.searchsorted(used, cells)
    body = grouped() | {"mesh": mesh_of((points, {"quad": cells})), "shells": {}}
    body |= {"shell": {"thickness": 0.1, "offset": 0.1}, "materials": {}, "material": STEEL}
    with pytest.raises(MeshError, match=words):
        assemble(Body.model_validate(body))


@pytest.mark.parametrize(("angle", "sided"), [(90.0, False), (30.0, True)])
def test_normals_matter_to_plies_at_an_angle(angle, sided):
    """One ply, so nothing couples stretch and bending."""
    points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    mesh = mesh_of((points, {"quad": [[0, 1, 4, 3], [4, 5, 2, 1]]}))
    plies = [{"thickness": 0.1, "angle": angle}]
    body = grouped() | {
        "mesh": mesh,
        "shells": {},
        "materials": {},
        "material": STEEL | {"G": 4e10},
    }
    body |= {"shell": {"plies": plies, "orientation": [1, 0, 0]}}
    if not sided:
        assemble(Body.model_validate(body))
        return
    with pytest.raises(MeshError, match=r"opposite sides .* and plies at an angle need one side"):
        assemble(Body.model_validate(body))


def test_a_shell_without_a_group_beside_solids_and_a_shell_of_lines_are_refused():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    body = grouped() | {"shells": {}, "shell": {"thickness": 0.1, "material": "steel"}}
    body |= {"materials": {"steel": STEEL}}
    for cells, words in (
        (SOLID_CELL, "expected .shells.GROUP., which"),
        ({"line": [[0, 1], [1, 2]]}, "lines"),
    ):
        mesh = mesh_of((points[: 4 if "tetra" in cells else 3], cells))
        with pytest.raises(BodyError, match=words):
            assemble(Body.model_validate(body | {"mesh": mesh}))


def test_a_plate_swings_on_a_hinge_as_a_rigid_one_of_its_mass_and_inertia():
    """A pendulum of sheet metal, stiff beside its slow swing."""
    a, b, thick = 0.3, 0.1, 0.005
    grid = Grid(lambda r, s: (a * r, b * s, 0.0), (6, 2), thickness=thick, **STEEL)
    part = du.Part(grid.source.mesh, du.Material(**STEEL), shell={"thickness": thick}, name="plate")
    part.interface("edge", du.plane(x=0.0), kind="rigid")
    mechanism = du.Mechanism(gravity=[0, 0, -9.81])
    body = mechanism.add(part.superelement(step=1e-4), name="plate")
    mechanism.add(du.joints.Revolute(mechanism.ground, body["edge"], axis="y", name="hinge"))
    run = mechanism.simulate(0.1, step=1e-3)
    # phi'' = m g (a / 2) cos(phi) / J about the hinge, from rest.
    inertia = a**2 / 3.0 + thick**2 / 12.0
    from scipy.integrate import solve_ivp

    exact = solve_ivp(
        lambda _, y: [y[1], 9.81 * a / 2.0 * np.cos(y[0]) / inertia],
        (0.0, 0.1),
        [0.0, 0.0],
        rtol=1e-10,
        atol=1e-12,
    )
    assert abs(run["hinge"].angle[-1]) == pytest.approx(exact.y[0, -1], rel=1e-3)


def test_a_superelement_has_displacements_and_stresses_on_its_faces(plate):
    element = build(on(plate, recovery={"stress": True}).body)
    np.testing.assert_array_equal(element.recovery.points, element.outline.points)
    assert element.recovery.stress.shape[:2] == (len(element.outline.points), 6)
    np.testing.assert_array_equal(element.recovery.cells, element.outline.cells)
