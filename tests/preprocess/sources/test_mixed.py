"""Solids and shells in one mesh: how they hang together, loads, sensors, fields, refusals."""

import duhamel as du
import numpy as np
import pytest
from duhamel.preprocess import Body, MeshWarning, PreprocessError, assemble, build, mesh_of
from duhamel.preprocess.assembly.losses import lossy_parts
from duhamel.preprocess.body.measured import Measured
from duhamel.preprocess.body.sensors import SensorPoint
from duhamel.preprocess.mesh.cells import SOLID_TYPES
from duhamel.preprocess.outline import outline_of
from duhamel.preprocess.survey import survey
from scipy.spatial.transform import Rotation

from ..mixed_cases import (
    STEEL,
    Case,
    bricks,
    grid,
    half_and_half,
    merged,
    placed,
    second_order,
    simplices,
    squares,
    wall,
)

T = 0.04
SOFT = {"E": 1e9, "nu": 0.0, "rho": 1000.0}
TURN, SHIFT = np.array([0.1, -0.2, 0.3]), np.array([1.0, 2.0, -1.0])
AWAY = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix(), np.array([700.0, -500.0, 500.0])
MESHES = {
    "plate": lambda: half_and_half(),
    "plate of second order": lambda: half_and_half((3, 2, 2), order=2),
    "plate of tetrahedra": lambda: half_and_half((4, 3, 2), split=True),
    "plate of ten-node tetrahedra": lambda: half_and_half((3, 2, 2), split=True, order=2),
    "wall": lambda: wall(T),
    "leaning wall": lambda: wall(T, slope=0.7),
    "wall at the rim": lambda: wall(T, x=0.1),
    "two walls": lambda: two_walls(),
    "skin": lambda: skinned(3),
    "skin of second order": lambda: skin_of_tetrahedra(),
    "skin that goes on": lambda: skinned(3, over=2),
    "wall on a skin": lambda: wall_on_skin(),
}


def two_walls():
    """At a right angle, in a corner of each other, on a block."""
    points, numbers = grid(*[np.linspace(-0.1, 0.1, 6)] * 2, np.linspace(-0.1, 0.0, 3))
    along, up = np.linspace(-0.02, 0.1, 4), np.linspace(0.0, 0.1, 3)
    flat, sides = grid(along, up)
    still = np.full(len(flat), -0.02)
    return merged(
        [
            (points, "hexahedron", bricks(numbers), "block"),
            (np.column_stack([still, flat]), "quad", squares(sides), "sheet"),
            (
                np.column_stack([flat[:, 0], still, flat[:, 1]]),
                "quad",
                squares(sides)[:, ::-1],
                "sheet",
            ),
        ]
    )


def skinned(n=6, over=0):
    """A block with a sheet on top, which may go on beyond its end."""
    x = np.linspace(0.0, 0.5, n + 1)
    points, numbers = grid(x, np.linspace(0, 0.1, 3), np.linspace(-0.05, 0.0, 3))
    longer = np.linspace(0.0, 0.5 * (n + over) / n, n + over + 1)
    flat, sides = grid(longer, np.linspace(0, 0.1, 3))
    skin = np.column_stack([flat, np.zeros(len(flat))])
    return merged(
        [(points, "hexahedron", bricks(numbers), "block"), (skin, "quad", squares(sides), "sheet")]
    )


def skin_of_tetrahedra():
    """Of ten nodes, with triangles of six on their faces at the top."""
    block = skinned(2).cells[0].data
    kind, cells = simplices("hexahedron", block)
    points, kind, cells = second_order(skinned(2).points, kind, cells)
    faces = cells[:, SOLID_TYPES[kind].facets["triangle6"]].reshape(-1, 6)
    top = faces[np.abs(points[faces, 2]).max(axis=1) < 1e-12]
    return merged([(points, kind, cells, "block"), (points, "triangle6", top, "sheet")])


def wall_on_skin(film="sheet"):
    """A wall in the middle of a block with a skin: three shells meet in its foot."""
    mesh = skinned(4)
    along, up = np.linspace(0.0, 0.1, 3), np.linspace(0.0, 0.1, 3)
    flat, sides = grid(along, up)
    foot = np.column_stack([np.full(len(flat), 0.25), flat])
    block, skin = (cells.data for cells in mesh.cells)
    return merged(
        [
            (mesh.points, "hexahedron", block, "block"),
            (mesh.points, "quad", skin, film),
            (foot, "quad", squares(sides), "sheet"),
        ]
    )


def rigid(points):
    return SHIFT + np.cross(TURN, points)


def rigid_dofs(case):
    return case.nodes.rigid_motion(np.zeros(3)) @ np.concatenate([SHIFT, TURN])


@pytest.mark.parametrize("offset", [0.0, 0.2 * T])
@pytest.mark.parametrize("name", MESHES)
def test_six_rigid_motions_are_free_of_strain_and_no_others(name, offset):
    case = Case(MESHES[name](), {"sheet": {"thickness": T, "offset": offset}})
    A = case.nodes.rigid_motion(case.points.mean(axis=0))
    assert np.abs(case.K @ A).max() < 1e-13 * np.abs(case.K).max()
    frequencies = case.frequencies([], 7)
    assert frequencies[5] < 1e-4 * frequencies[6]
    mass = sum(share.mass for share in case.source.shares())
    assert (A.T @ (case.M @ A))[0, 0] == pytest.approx(mass, rel=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_a_kilometer_away_and_turned_frequencies_are_the_same(name):
    mesh = MESHES[name]()
    here, there = (Case(given, T) for given in (mesh, placed(mesh, *AWAY)))
    np.testing.assert_allclose(there.frequencies([], 9)[6:], here.frequencies([], 9)[6:], rtol=1e-7)


def tip_loads(case, which):
    """A force or moment on the end of the shells, spread as along a side of equal elements."""
    tip = case.at(1.0)
    weights = np.full(len(tip), 1.0)
    y = case.points[tip, 1]
    weights[(y == y.min()) | (y == y.max())] = 0.5
    f = np.zeros(case.nodes.n_dofs)
    f[case.dofs(tip, (which,))] = weights / weights.sum()
    return f, lambda u, way: u[case.dofs(tip, (way,))] @ weights / weights.sum()


def symmetric_root(case):
    return np.concatenate(
        [
            case.dofs(case.at(0.0), (0,)),
            case.dofs(case.at(0, 0, 0), (1, 2)),
            case.dofs(case.at(0, 0.2, 0), (2,)),
        ]
    )


@pytest.mark.parametrize("layers", [2, 4, 6, 10])
@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_a_constant_stress_goes_through_a_junction(layers, nu):
    """The patch test: also with lateral contraction, which both have alike."""
    case = Case(half_and_half((4, 3, layers)), T, SOFT | {"nu": nu})
    f, _ = tip_loads(case, 0)
    u = case.solve(symmetric_root(case), f)
    strain = 1.0 / (0.2 * T * 1e9)
    moved = np.stack([u[case.dofs(range(len(case.points)), (way,))] for way in range(3)], axis=1)
    expected = strain * case.points * [1.0, -nu, -nu]
    np.testing.assert_allclose(moved, expected, atol=1e-9 * strain)


def test_a_pure_bending_moment_goes_through_a_junction():
    case = Case(half_and_half(), T, SOFT)
    f, tip = tip_loads(case, 4)
    u = case.solve(symmetric_root(case), f)
    curvature = 1.0 / (1e9 * 0.2 * T**3 / 12.0)
    assert tip(u, 2) == pytest.approx(-0.5 * curvature, rel=1e-9)
    assert tip(u, 4) == pytest.approx(curvature, rel=1e-9)


@pytest.mark.parametrize(
    ("mesh", "within"),
    [
        (half_and_half, 1e-3),
        (lambda **given: half_and_half((4, 2, 2), order=2, **given), 0.02),
    ],
)
def test_a_plate_half_of_shells_is_between_those_of_one_kind(mesh, within):
    """In bending, twist, shear and stretch, and free."""
    block, sheet, both = (
        Case(mesh(**given), t)
        for given, t in (({"all_of": "block"}, {}), ({"all_of": "sheet"}, T), ({}, T))
    )
    pure = np.array([case.frequencies([], 12)[6:] for case in (block, sheet)])
    found = both.frequencies([], 12)[6:]
    assert (found > (1.0 - within) * pure.min(axis=0)).all()
    assert (found < (1.0 + within) * pure.max(axis=0)).all()


@pytest.mark.parametrize("way", [0, 1, 2])
def test_a_clamped_plate_half_of_shells_deflects_as_one_of_solids(way):
    block, both = Case(half_and_half(all_of="block"), {}), Case(half_and_half(), T)
    deflections = []
    for case in (block, both):
        f, tip = tip_loads(case, way)
        deflections.append(tip(case.solve(case.dofs(case.at(0.0), (0, 1, 2)), f), way))
    assert deflections[1] == pytest.approx(deflections[0], rel=0.015)


def test_a_wall_on_a_block_vibrates_as_one_of_solids():
    """Clamped at its base: bending, twist, and in its plane. On a hinge it would be free."""
    solid, shell = Case(wall(n_t=4, n=8, solid=True), {}), Case(wall(n_t=4, n=8), 0.02)
    found = [
        case.frequencies(case.dofs(case.at(None, None, -0.08), (0, 1, 2)), 4)
        for case in (solid, shell)
    ]
    np.testing.assert_allclose(found[1], found[0], rtol=0.02)


def test_finer_solids_make_the_foot_of_a_wall_no_softer():
    """Unlike moments and forces on single nodes, whose compliance has no limit."""
    frequencies = []
    for layers in (2, 4, 8):
        case = Case(wall(n_t=layers, n=5), 0.02)
        frequencies.append(case.frequencies(case.dofs(case.at(None, None, -0.08), (0, 1, 2)), 1)[0])
    assert abs(frequencies[2] - frequencies[1]) < 0.6 * abs(frequencies[1] - frequencies[0])


def test_a_skin_stiffens_a_block_as_a_layer_of_solids():
    """Stiff and thin: the stretch of the skin beside the neutral axis counts most."""
    t, n = 0.004, 12
    steel = SOFT | {"E": 5e10, "nu": 0.3}
    skin = {"thickness": t, "offset": 0.5 * t, "material": "steel"}
    materials = {"block": SOFT | {"nu": 0.3}, "steel": steel}
    shell = Case(skinned(n), {"sheet": skin}, materials=materials, material=None)
    block = skinned(n).cells[0].data
    points = skinned(n).points
    top = block[:, 4:][np.abs(points[block[:, 4:], 2]).max(axis=1) < 1e-12]
    raised = points + np.array([0.0, 0.0, t])
    layer = np.hstack([top, len(points) + top])
    parts = [(points, "hexahedron", block, "block")]
    parts.append((np.vstack([points, raised]), "hexahedron", layer, "steel"))
    solid = Case(_used(merged(parts)), {}, materials=materials, material=None)
    found = [case.frequencies([], 11)[6:] for case in (shell, solid)]
    np.testing.assert_allclose(found[0], found[1], rtol=0.01)


def _used(mesh):
    """Without the points that belong to no cell."""
    import meshio

    used = np.unique(np.concatenate([block.data.ravel() for block in mesh.cells]))
    cells = [(block.type, np.searchsorted(used, block.data)) for block in mesh.cells]
    return meshio.Mesh(mesh.points[used], cells, cell_sets=mesh.cell_sets)


def test_a_skin_that_goes_on_beyond_its_block_keeps_its_own_turn():
    case = Case(skinned(over=3), 0.004)
    assert not case.source.parts.joined.any()
    A = case.nodes.rigid_motion(case.points.mean(axis=0))
    assert np.abs(case.K @ A).max() < 1e-13 * np.abs(case.K).max()
    frequencies = case.frequencies([], 7)
    assert frequencies[5] < 1e-4 * frequencies[6]


def tables(**given):
    return Case(half_and_half((3, 2, 2)), T, **given)


def test_loads_have_the_resultants_of_what_they_are_spread_over():
    loads = {
        "sheet": {"pressure": 3.0, "group": "sheet"},
        "end": {"pressure": 5.0, "plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}},
        "weight": {"force_per_volume": [0.0, 0.0, -2.0]},
        "block": {"force_per_volume": [0.0, 1.0, 0.0], "group": "block"},
    }
    case = tables(loads=loads)
    A = case.nodes.rigid_motion(np.zeros(3))
    sheet, end, weight, block = (
        A.T @ case.source.forces(load) for load in case.source.body.loads.values()
    )
    area, volume = 0.5 * 0.2, 0.5 * 0.2 * T
    np.testing.assert_allclose(sheet, [0, 0, -3 * area, -0.3 * area, 2.25 * area, 0], atol=1e-12)
    np.testing.assert_allclose(end, [5 * 0.2 * T, 0, 0, 0, 0, -0.5 * 0.2 * T], atol=1e-12)
    np.testing.assert_allclose(weight[:3], [0, 0, -4.0 * volume], atol=1e-12)
    np.testing.assert_allclose(weight[4], 2.0 * volume * 0.25 + 2.0 * volume * 0.75, atol=1e-12)
    np.testing.assert_allclose(block[:3], [0, volume, 0], atol=1e-12)


@pytest.mark.parametrize("x", [0.21, 0.5, 0.83])
def test_sensors_move_as_rigid_bodies_do(x):
    case = tables()
    point = [x, 0.07, 0.013]
    u = rigid_dofs(case)
    rows, _ = case.source.readings(SensorPoint(point=point))
    np.testing.assert_allclose(rows @ u, rigid(point), atol=1e-12)
    rows, _ = case.source.readings(SensorPoint(point=point, direction=(1.0, 0.0, 0.0)))
    assert abs(rows @ u) < 1e-12


def test_points_of_the_outline_move_as_rigid_bodies_and_have_the_stress_of_a_patch():
    case = tables()
    structure = assemble(case.body)
    points = case.source.field_points(stress=True)
    u = rigid_dofs(case)
    places = points.places(case.nodes)
    part = slice(3, len(places) - 2)
    moved = points.displacement_rows(structure.T, part, structure.turns) @ u
    np.testing.assert_allclose(moved.reshape(-1, 3), rigid(places[part]), atol=1e-12)
    f, _ = tip_loads(case, 0)
    u = case.solve(symmetric_root(case), f)
    stress = (points.stress_rows(structure.T, slice(None), structure.turns) @ u).reshape(-1, 6)
    expected = [1.0 / (0.2 * T), 0, 0, 0, 0, 0]
    np.testing.assert_allclose(stress, np.tile(expected, (len(places), 1)), atol=1e-7 * expected[0])


def test_the_outline_is_as_thick_as_both():
    outline = outline_of(tables().source, np.zeros(3))
    assert outline.volume == pytest.approx(1.0 * 0.2 * T)


def test_interfaces_may_be_on_solids_shells_and_their_junction():
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    for kind in ("average", "rigid"):
        interfaces = {
            name: {"plane": plane | {"point": [x, 0, 0]}, "kind": kind}
            for name, x in (("root", 0.0), ("tip", 1.0))
        }
        structure = assemble(tables(interfaces=interfaces).body)
        A = structure.nodes.rigid_motion(np.zeros(3)) @ np.concatenate([SHIFT, TURN])
        moved = (structure.P_C @ A).reshape(2, 6)
        for name, motion in zip(("root", "tip"), moved, strict=True):
            np.testing.assert_allclose(motion[:3], rigid(structure.frames[name].X), atol=1e-12)
            np.testing.assert_allclose(motion[3:], TURN, atol=1e-12)
        A = structure.rigid.A
        assert np.abs(structure.K @ A).max() < 1e-12 * np.abs(structure.K).max()


def test_an_interface_on_the_foot_of_a_wall_turns_with_the_block():
    foot = {"box": {"corners": [[0.0, 0.0, 0.0], [0.0, 0.2, 0.0]]}}
    structure = assemble(Case(wall(), 0.02, interfaces={"foot": foot}).body)
    moved = structure.P_C @ structure.nodes.rigid_motion(np.zeros(3)) @ [*SHIFT, *TURN]
    np.testing.assert_allclose(moved, [*rigid(structure.frames["foot"].X), *TURN], atol=1e-12)
    with pytest.raises(PreprocessError, match="three nodes that are not on a line"):
        assemble(Case(wall(), 0.02, interfaces={"foot": foot | {"kind": "rigid"}}).body)


def test_a_part_in_python_names_its_shells():
    part = du.Part(
        half_and_half((3, 2, 2)), du.Material(**STEEL), shells={"sheet": {"thickness": T}}
    )
    part.interface("tip", du.plane(x=1.0), kind="rigid")
    element = part.superelement(step=1e-4)
    assert element.mass == pytest.approx(7850.0 * 0.2 * T)


def test_a_superelement_of_both_has_modes_of_the_mesh_and_stresses():
    tip = {"tip": {"plane": {"point": [1.0, 0, 0], "normal": [1, 0, 0]}}}
    case = tables(interfaces=tip, recovery={"stress": True})
    element = build(case.body)
    expected = case.frequencies([], 8)[6:]
    np.testing.assert_allclose(element.modes.frequencies[:2], expected, rtol=1e-6)
    assert element.recovery.stress.shape[:2] == (len(element.outline.points), 6)


def test_a_superelement_of_both_takes_frequencies_of_a_modal_test(tmp_path):
    """A test of the same body, 5 % higher."""
    tip = {"tip": {"plane": {"point": [1.0, 0, 0], "normal": [1, 0, 0]}}}
    modal = {"step": 1e-5, "steps": 50, "method": "modal"}
    places = {f"a{k}": (x, y, 0.0) for k, (x, y) in enumerate([(x, y) for x in (0, 0.33, 0.66, 1)
                                                               for y in (0, 0.2)])}  # fmt: skip
    sensors = {name: {"point": place} for name, place in places.items()}
    truth = build(tables(interfaces=tip, impulse=modal, sensors=sensors).body)
    first = np.argsort(truth.modes.omega)[:3]
    omega, shapes = truth.modes.omega[first], truth.channels.phi[:, first].T
    labels = [f"{name}:{axis}" for name in places for axis in "xyz"]
    rows = np.column_stack([1.05 * omega / (2 * np.pi), [0.01] * 3, shapes]).tolist()
    lines = [["frequency", "damping", *labels], *rows]
    (tmp_path / "modes.csv").write_text("\n".join(", ".join(map(str, line)) for line in lines))
    lines = [(name, *place, axis) for name, place in places.items() for axis in "xyz"]
    lines = [("label", "x", "y", "z", "axis"), *lines]
    (tmp_path / "channels.csv").write_text("\n".join(", ".join(map(str, row)) for row in lines))
    test = Measured(
        modes=tmp_path / "modes.csv", channels=tmp_path / "channels.csv", update="frequencies"
    )
    body = tables(interfaces=tip, impulse=modal, measured=test).body
    np.testing.assert_allclose(survey(body).measured, 1.05 * omega / (2 * np.pi), rtol=1e-9)
    element = build(body)
    assert element.measured.matched.all()
    np.testing.assert_allclose(np.sort(element.modes.omega)[:3], 1.05 * omega, rtol=1e-9)


def hung(first, second):
    """Two blocks on which two sheets of shells end, or in the middle of which one does."""
    parts = []
    for x in (0.0, 2.0):
        points, numbers = grid(
            x + np.linspace(0, 1, 3), np.linspace(0, 1, 3), np.linspace(-0.1, 0.1, 3)
        )
        parts.append((points, "hexahedron", bricks(numbers), "block"))
    flat, numbers = grid(np.linspace(1, 2, 3), np.linspace(first, second, 2))
    parts.append((np.column_stack([flat, 0 * flat[:, 0]]), "quad", squares(numbers), "sheet"))
    return merged(parts)


def test_a_sheet_may_join_two_blocks():
    case = Case(hung(0.0, 0.5), 0.1)
    frequencies = case.frequencies([], 7)
    assert frequencies[5] < 1e-4 * frequencies[6]


def lone():
    """A triangle that touches a block with one corner."""
    points, numbers = grid(np.linspace(0, 1, 2), np.linspace(0, 1, 2), np.linspace(0, 1, 2))
    triangle = np.array([[1.0, 1, 1], [2, 1, 1], [2, 2, 1]])
    return merged(
        [
            (points, "hexahedron", bricks(numbers), "block"),
            (triangle, "triangle", np.array([[0, 1, 2]]), "sheet"),
        ]
    )


def beside():
    """A sheet on the edge of a block, which stands out of it all over."""
    points, numbers = grid(np.linspace(0, 1, 2), np.linspace(0, 1, 2), np.linspace(-1, 0, 2))
    flat, sides = grid(np.linspace(0, 1, 2), np.linspace(1, 2, 2))
    sheet = np.column_stack([flat, 0 * flat[:, 0]])
    return merged(
        [(points, "hexahedron", bricks(numbers), "block"), (sheet, "quad", squares(sides), "sheet")]
    )


def on_a_hinge():
    """Two blocks that share an edge, with a wall on one of them."""
    parts = []
    for k in (0.0, 1.0):
        points, numbers = grid([k, k + 1.0], [0.0, 1.0], [k, k + 1.0])
        parts.append((points, "hexahedron", bricks(numbers), "block"))
    flat, sides = grid([0.0, 1.0], [1.0, 2.0])
    foot = np.column_stack([0.0 * flat[:, 0], flat])
    return merged([*parts, (foot, "quad", squares(sides), "sheet")])


def skin_of_eight_nodes():
    parts = [(skinned(2).points, cells.type, cells.data) for cells in skinned(2).cells]
    names = ("block", "sheet")
    return merged([(*second_order(*part), name) for part, name in zip(parts, names, strict=True)])


@pytest.mark.parametrize(
    ("mesh", "shells", "words"),
    [
        (skin_of_eight_nodes, 0.1, "4 shells with eight nodes lie on faces of solids"),
        (on_a_hinge, 0.1, "the body is a mechanism: it has 7 motions"),
        (lone, 0.1, "1 nodes at which a shell touches a solid alone, as a hinge"),
        (beside, {"sheet": {"thickness": 0.1, "offset": 0.1}}, "found 0 of its thickness there"),
    ],
)
def test_joints_that_would_not_hold_are_refused(mesh, shells, words):
    with pytest.raises(PreprocessError, match=words):
        Case(mesh(), shells)


REFUSED = [
    ({"shells": {}, "shell": {"thickness": T}}, r"expected \[shells.GROUP\], which tells"),
    ({"shells": {"block": {"thickness": T}}}, "shells.block: expected triangles or quadrangles"),
    ({"shells": {"other": {"thickness": T}}}, "no group 'other'"),
    ({"rotation": {}}, r"\[rotation\]: expected a mesh of solids or of shells"),
    ({"surfaces": {"top": {"group": "sheet"}}}, "surfaces: expected a mesh of solids"),
    ({"loads": {"f": {"force_per_length": [1, 0, 0]}}}, "expected a mesh of lines"),
    (
        {"interfaces": {"all": {"box": {"corners": [[-1, -1, -1], [2, 2, 2]]}}}},
        r"interfaces.all: expected facets of solids or shells, found \d+ facets",
    ),
    (
        {"sensors": {"s": {"point": [0.8, 0.1, 0.3]}}},
        "of solids: .* of shells: expected a point within",
    ),
    (
        {
            "materials": {"block": STEEL, "tin": STEEL},
            "material": None,
            "shells": {"sheet": {"thickness": T, "material": "block"}},
        },
        "materials.tin: expected a group of solids, or a shell of it",
    ),
    (
        {
            "materials": {"steel": STEEL},
            "material": None,
            "shells": {"sheet": {"thickness": T, "material": "steel"}},
        },
        "for the solids, found materials of shells alone",
    ),
    (
        {"impulse": {"step": 1e-4, "steps": 20, "method": "krylov", "solver": "iterative"}},
        "found iterative",
    ),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED)
def test_what_a_body_of_both_cannot_have_is_named(changes, words):
    case = tables()
    given = case.body.model_dump(exclude_unset=True) | {"mesh": case.body.mesh} | changes
    given = {key: value for key, value in given.items() if value is not None}
    with pytest.raises((ValueError, PreprocessError), match=words):
        build(Body.model_validate(given))


def test_a_mesh_with_shells_may_be_one_of_solids_alone():
    """A body without them leaves out what is theirs."""
    case = tables()
    given = case.body.model_dump(exclude_unset=True) | {"mesh": case.body.mesh, "shells": {}}
    structure = assemble(Body.model_validate(given))
    assert structure.rigid.mass == pytest.approx(0.5 * 7850.0 * 0.2 * T)


def test_a_mesh_in_memory_needs_to_know_its_shells():
    """Nodes of facets beside solids are left out else."""
    with pytest.warns(MeshWarning, match="nodes that belong to no element"):
        mesh = mesh_of(half_and_half((3, 2, 2)))
    given = tables().body.model_dump(exclude_unset=True) | {"mesh": mesh}
    with pytest.raises(PreprocessError, match="pass shells to mesh_of"):
        assemble(Body.model_validate(given))


def as_gmsh(mesh, path):
    import meshio

    tags = [np.full(len(block.data), tag) for tag, block in enumerate(mesh.cells, 1)]
    named = {"block": np.array([1, 3]), "sheet": np.array([2, 2])}
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    meshio.Mesh(mesh.points, mesh.cells, cell_data=data, field_data=named).write(
        path, file_format="gmsh22", binary=False
    )


def deck(mesh, node, elements):
    """Lines of nodes, and of the cells of each block."""
    lines = [node.format(i, *map(float, X)) for i, X in enumerate(mesh.points, 1)]
    number = 0
    for form, block in zip(elements, mesh.cells, strict=True):
        lines.append(form[0])
        for row in block.data + 1:
            number += 1
            lines.append(
                form[1].format(number, ",".join(map(str, row[:6])), ",".join(map(str, row[6:])))
            )
    return "\n".join(line for line in lines if line) + "\n"


def as_abaqus(mesh, path):
    blocks = [
        ("*ELEMENT, TYPE=C3D8, ELSET=block", "{},{},{}"),
        ("*ELEMENT, TYPE=S4, ELSET=sheet", "{},{}{}"),
    ]
    path.write_text("*NODE\n" + deck(mesh, "{},{!r},{!r},{!r}", blocks))


def as_nastran(mesh, path):
    blocks = [
        ('$HMNAME COMP 1 "block"', "CHEXA,{},1,{},+\n+,{}"),
        ("PSHELL,2,1,0.04", "CQUAD4,{},2,{}{}"),
    ]
    path.write_text(deck(mesh, "GRID,{},,{!r},{!r},{!r}", blocks))


@pytest.mark.parametrize(
    ("suffix", "write", "sheet"),
    [(".msh", as_gmsh, "sheet"), (".inp", as_abaqus, "sheet"), (".bdf", as_nastran, "property 2")],
)
def test_files_hold_both(tmp_path, suffix, write, sheet):
    """Without a warning that shells are left out."""
    mesh = half_and_half((3, 2, 2))
    path = tmp_path / f"plate{suffix}"
    write(mesh, path)
    case = tables()
    body = case.body.model_copy(update={"mesh": path, "shells": {sheet: case.body.shells["sheet"]}})
    structure = assemble(body)
    assert structure.n_u == case.nodes.n_dofs
    assert structure.rigid.mass == pytest.approx(7850.0 * 0.2 * T, rel=1e-6)
    largest = np.abs(case.K).max()
    assert np.abs(structure.K).max() == pytest.approx(largest, rel=1e-9)


def test_shells_of_a_deck_that_no_group_names_are_told(tmp_path):
    mesh = half_and_half((3, 2, 2))
    path = tmp_path / "plate.inp"
    as_abaqus(mesh, path)
    front, _, sheet = path.read_text().partition("*ELEMENT, TYPE=S4, ELSET=sheet\n")
    first, *rest = sheet.splitlines()
    named = "*ELEMENT, TYPE=S4, ELSET=sheet\n" + "\n".join(rest)
    path.write_text(f"{front}*ELEMENT, TYPE=S4, ELSET=other\n{first}\n{named}\n")
    with pytest.warns(MeshWarning, match="stiffness and mass of 1 shells, which are in no group"):
        assemble(tables().body.model_copy(update={"mesh": path}))


def test_a_wall_on_a_skin_is_held_by_the_solid():
    """However thin the skin: its own bending would leave the wall nearly free."""
    thin, thick = (Case(wall_on_skin("film"), {"sheet": T, "film": film}) for film in (1e-5, 1e-4))
    found = [
        case.frequencies(case.dofs(case.at(None, None, -0.05)), 1)[0] for case in (thin, thick)
    ]
    assert found[0] == pytest.approx(found[1], rel=0.01)


def test_shells_may_lose_energy_where_solids_do_not():
    materials = {"block": STEEL, "rubber": STEEL | {"loss_factor": 0.1}}
    shells = {"sheet": {"thickness": T, "material": "rubber"}}
    damping = {"band": [50.0, 2000.0]}
    tip = {"tip": {"plane": {"point": [1.0, 0, 0], "normal": [1, 0, 0]}}}
    case = Case(
        half_and_half((3, 2, 2)),
        shells,
        materials=materials,
        material=None,
        damping=damping,
        interfaces=tip,
    )
    parts = lossy_parts(case.body, case.source)
    A = case.nodes.rigid_motion(np.zeros(3))
    assert list(parts) == ["rubber"]
    assert np.abs(parts["rubber"] @ A).max() < 1e-8 * np.abs(parts["rubber"]).max()
