"""Load patterns and sensors of body files, against closed forms."""

import numpy as np
import pytest
from duhamel.preprocess import Body, PreprocessError, assemble, build, read_body
from duhamel.preprocess.sources.reading import read_source
from duhamel.superelement import read, write

SIZE = (2.0, 0.5, 0.3)
TOP = {"plane": {"point": [0, 0, SIZE[2]], "normal": [0, 0, 1]}}
E, NU, RHO = 2.1e11, 0.3, 7800.0


def pattern_of(structure, name):
    (found,) = (p for p in structure.channels.patterns if p.name == name)
    return found


@pytest.fixture
def block(solid_body, box):
    """A box of one type of solid with loads and sensors."""

    def make(kind="hexahedron20", divisions=(4, 1, 2), **changes):
        return solid_body(box(kind, SIZE, divisions), **changes)

    return make


def test_resultants_of_loads_on_every_solid(block, kind):
    """Forces, and moments about the center of mass, of a load on the top and in the volume."""
    loads = {
        "pressure": {"pressure": 3.0, **TOP},
        "traction": {"traction": [1.0, -2.0, 0.5], **TOP},
        "weight": {"force_per_volume": [0.0, 0.0, -7.0]},
        "all round": {
            "pressure": 5.0,
            "box": {"corners": [[-1, -1, -1], [3, 1, 1]]},
        },
    }
    structure = assemble(block(kind, loads=loads))
    area, volume = SIZE[0] * SIZE[1], np.prod(SIZE)
    traction = area * np.array([1.0, -2.0, 0.5])
    expected = {
        "pressure": ([0, 0, -3.0 * area], [0, 0, 0]),
        "traction": (traction, np.cross([0, 0, 0.5 * SIZE[2]], traction)),
        "weight": ([0, 0, -7.0 * volume], [0, 0, 0]),
        "all round": ([0, 0, 0], [0, 0, 0]),
    }
    for name, (force, moment) in expected.items():
        found = pattern_of(structure, name)
        np.testing.assert_allclose(found.force, force, atol=1e-12)
        np.testing.assert_allclose(found.moment, moment, atol=1e-12)


def test_what_only_accelerates_a_body_does_not_deform_it(block):
    """A weight: inertia takes it where it acts."""
    structure = assemble(block(loads={"weight": {"force_per_volume": [1.0, 2.0, 3.0]}}))
    assert not structure.channels.deforming.any()
    element = build(block(loads={"weight": {"force_per_volume": [1.0, 2.0, 3.0]}}))
    assert not element.channels.phi.any()
    np.testing.assert_allclose(element.patterns[0].force, np.prod(SIZE) * np.array([1, 2, 3]))


def test_pressure_all_round_compresses_evenly(block):
    """sigma = -p I, so strain -p (1 - 2 nu) / E in every direction: exactly, by inertia relief."""
    everywhere = {"box": {"corners": [[-1, -1, -1], [3, 1, 1]]}}
    d = [0.6, 0.0, 0.8]
    body = block(
        loads={"p": {"pressure": 1e6, **everywhere}},
        sensors={
            "gauge": {"point": [0.7, 0.2, 0.1], "direction": d},
            "long": {"point": [0.7, 0.2, 0.1], "direction": d, "length": 0.1},
            "stress": {"point": [1.3, 0.5, 0.3], "stress": True},
        },
        impulse={"step": 1e-4, "steps": 4, "method": "modal"},
    )
    element = build(body)
    H = element.complete_compliance
    response = H[element.n_c + 1 :, element.n_c]
    strain = -1e6 * (1.0 - 2.0 * NU) / E
    np.testing.assert_allclose(response[:2], strain, rtol=1e-7)
    np.testing.assert_allclose(response[2:5], -1e6, rtol=1e-7)
    np.testing.assert_allclose(response[5:], 0.0, atol=0.1)


def test_a_point_moves_as_its_element_does(block, kind):
    """A rigid motion, and strains of a linear field, at a point between nodes."""
    point = [0.83, 0.21, 0.13]
    d = np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0)
    sensors = {
        "p": {"point": point},
        "g": {"point": point, "direction": (3e200 * d).tolist()},
        "l": {"point": point, "direction": d.tolist(), "length": 0.05},
        "s": {"point": point, "stress": True},
    }
    structure = assemble(block(kind, sensors=sensors))
    X = structure.nodes.points
    slope = np.random.default_rng(1).normal(size=(3, 3))
    u = (X @ slope.T + [0.1, 0.2, 0.3]).ravel()
    found = structure.channels.rows @ u
    np.testing.assert_allclose(found[:3], slope @ point + [0.1, 0.2, 0.3], rtol=1e-10)
    strain = 0.5 * (slope + slope.T)
    np.testing.assert_allclose(found[3:5], d @ strain @ d, rtol=1e-9)
    mu, lam = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
    stress = 2 * mu * strain + lam * np.trace(strain) * np.eye(3)
    i, j = np.array([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]).T
    np.testing.assert_allclose(found[5:], stress[i, j], rtol=1e-8)
    turned = structure.rigid.A @ [0, 0, 0, 0.1, 0.2, 0.3]
    np.testing.assert_allclose((structure.channels.rows @ turned)[3:5], 0.0, atol=1e-13)


def test_a_pattern_on_a_rigid_interface_is_taken_by_its_frame(block):
    """The traction on a face that follows its frame is a force on that."""
    faces = {"root": {"group": "root"}, "tip": {"group": "tip", "kind": "rigid"}}
    load = {"pull": {"traction": [1.0, 0.0, 0.5], "group": "tip"}}
    structure = assemble(block(interfaces=faces, loads=load))
    area = SIZE[1] * SIZE[2]
    f = structure.rows["tip"].T @ np.array([area, 0, 0.5 * area, 0, 0, 0])
    expected = f - structure.M @ (structure.U @ (structure.U.T @ f))
    np.testing.assert_allclose(structure.channels.rows.toarray()[0], expected, atol=1e-13)


LINE = {"q": {"force_per_length": [0.0, 2.0, 0.0], "group": "beam"}}


def test_the_forces_of_a_line_load_are_those_of_its_shapes(beam_body, beam):
    """q L / 2 and q L^2 / 12 on the ends of one element; the same of five of them in all."""
    for elements in (1, 5):
        structure = assemble(beam_body(beam(elements), loads=LINE))
        found = pattern_of(structure, "q")
        np.testing.assert_allclose(found.force, [0.0, 1.0, 0.0], atol=1e-15)
        np.testing.assert_allclose(found.moment, 0.0, atol=1e-15)


def test_a_gauge_on_a_beam_reads_bending_and_stretch(beam_body, beam, section):
    """u' + y curvature, of a beam whose nodes lie on a parabola and are pulled apart."""
    y, z = 0.004, -0.003
    sensors = {"g": {"point": [0.23, y, z], "direction": [1, 0, 0]}}
    structure = assemble(beam_body(beam(5), sensors=sensors))
    X = structure.nodes.points[:, 0]
    u = np.zeros((len(X), 6))
    u[:, 0] = 1e-3 * X
    u[:, 1], u[:, 5] = 0.5 * 0.2 * X**2, 0.2 * X
    u[:, 2], u[:, 4] = 0.5 * 0.3 * X**2, -0.3 * X
    (strain,) = structure.channels.rows @ u.ravel()
    assert strain == pytest.approx(1e-3 - 0.2 * y - 0.3 * z, rel=1e-10)


def test_a_point_beside_the_axis_of_a_beam_moves_with_its_section(beam_body, lines):
    """Under a rigid motion it moves as the body does, whatever way the beam runs."""
    points = np.linspace([0.1, 0.2, 0.3], [0.4, 0.5, 0.1], 6)
    at = points[2] + [0.01, 0.02, -0.01]
    structure = assemble(beam_body(lines(points), sensors={"p": {"point": at.tolist()}}))
    motion = np.array([0.1, 0.2, 0.3, 0.4, -0.5, 0.6])
    expected = motion[:3] + np.cross(motion[3:], at - structure.rigid.center)
    found = structure.channels.rows @ (structure.rigid.A @ motion)
    np.testing.assert_allclose(found, expected, rtol=1e-10)


@pytest.mark.parametrize("method", ["krylov", "march", "rubin", "craig-bampton"])
def test_all_methods_know_the_static_response_of_patterns_and_sensors(block, method):
    """To balanced loads: what sensors read under a pattern, against all modes."""
    count = {"modes": 6} if method in ("rubin", "craig-bampton") else {}
    given = {
        "loads": {"p": {"pressure": 1.0, **TOP}, "w": {"force_per_volume": [0, 0, 1.0]}},
        "sensors": {
            "g": {"point": [1.0, 0.25, 0.3], "direction": [1, 0, 0]},
            "x": {"point": [0.6, 0.25, 0.3]},
        },
    }
    loads = {**given["loads"], "half": {"traction": [0, 0, 1.0], "group": "tip"}}
    impulse = {"step": 1e-5, "steps": 8}
    expected, found = (
        build(block(**{**given, "loads": loads}, impulse={**impulse, "method": m, **k}))
        for m, k in (("modal", {}), (method, count))
    )
    n_c = expected.n_c
    a, b = (e.complete_compliance[n_c:, n_c : n_c + 3] for e in (expected, found))
    scale = np.abs(a[3:, 2]).max()
    assert np.abs(a - b)[3:6].max() < 2e-6 * scale


def test_channels_come_back_from_a_file_to_the_last_bit(block, tmp_path):
    body = block(
        loads={"p": {"pressure": 1.0, **TOP}},
        sensors={"g": {"point": [1.0, 0.25, 0.3], "direction": [1, 0, 0]}},
    )
    for method in ("modal", "march"):
        element = build(
            body.model_copy(update={"impulse": body.impulse.model_copy(update={"method": method})})
        )
        write(tmp_path / "body.h5", element)
        again = read(tmp_path / "body.h5")
        assert [p.name for p in again.patterns] == ["p"]
        assert [(s.name, s.kind) for s in again.sensors] == [("g", "strain")]
        np.testing.assert_array_equal(again.patterns[0].force, element.patterns[0].force)
        np.testing.assert_array_equal(again.sensors[0].X, element.sensors[0].X)
        np.testing.assert_array_equal(again.complete_compliance, element.complete_compliance)
        kernels = (e.complete_kernel_for(1e-4, e.kernel.scheme, 20).g for e in (again, element))
        np.testing.assert_array_equal(*kernels)


WRONG = {
    "two kinds": (
        {"loads": {"p": {"pressure": 1.0, "traction": [1, 0, 0], **TOP}}},
        "expected one of pressure, traction.* found pressure and traction",
    ),
    "nothing to act on": ({"loads": {"p": {"pressure": 1.0}}}, "pressure: expected what it acts"),
    "a shape for a volume": (
        {"loads": {"p": {"force_per_volume": [1, 0, 0], **TOP}}},
        "force_per_volume: expected a group of elements.*found plane",
    ),
    "no load": ({"loads": {"p": {"pressure": 0.0, **TOP}}}, "pressure: expected a load"),
    "length without direction": (
        {"sensors": {"s": {"point": [1, 0, 0], "length": 0.1}}},
        "length: a strain gauge needs a direction",
    ),
    "the name of an interface": (
        {"sensors": {"tip": {"point": [1, 0, 0]}}},
        "sensors: 'tip' is the name of an interface",
    ),
}


@pytest.mark.parametrize(("tables", "message"), WRONG.values(), ids=WRONG)
def test_messages_of_body_files(tables, message):
    whole = {
        "name": "a",
        "mesh": "a.msh",
        "material": {"E": 1.0, "nu": 0.3, "rho": 1.0},
        "interfaces": {"tip": {"group": "tip"}},
        "impulse": {"step": 1e-3, "steps": 3},
    }
    with pytest.raises(ValueError, match=f"(?s){message}"):
        Body.model_validate(whole | tables)


MISPLACED = {
    "a gauge of no length": (
        {"sensors": {"s": {"point": [1, 0.2, 0.1], "direction": [1, 0, 0], "length": 1e-9}}},
        "sensors.s: length: expected at least 2.08e-06 m, found 1e-09",
    ),
    "outside": ({"sensors": {"s": {"point": [5, 0, 0]}}}, "sensors.s: expected a point within"),
    "a line load": (
        {"loads": {"p": {"force_per_length": [1, 0, 0]}}},
        "loads.p: force_per_length: expected a mesh of lines",
    ),
    "no facet": (
        {"loads": {"p": {"pressure": 1, "sphere": {"center": [9, 9, 9], "radius": 1.0}}}},
        "loads.p: no facet of the boundary",
    ),
    "elements for facets": (
        {"loads": {"p": {"pressure": 1, "group": "box"}}},
        "loads.p: expected a group of facets",
    ),
    "facets for elements": (
        {"loads": {"p": {"force_per_volume": [1, 0, 0], "group": "tip"}}},
        "loads.p: group 'tip': expected solid elements",
    ),
}


@pytest.mark.parametrize(("tables", "message"), MISPLACED.values(), ids=MISPLACED)
def test_messages_name_the_load_and_the_sensor(block, tables, message):
    with pytest.raises(PreprocessError, match=message):
        assemble(block(**tables))


def test_messages_of_beams(beam_body, beam):
    askew = {"s": {"point": [0.2, 0, 0], "direction": [1, 1, 0]}}
    with pytest.raises(PreprocessError, match=r"sensors.s: direction: expected that of the beam"):
        assemble(beam_body(beam(4), sensors=askew))
    with pytest.raises(PreprocessError, match=r"sensors.s: expected a point on a beam"):
        assemble(beam_body(beam(4), sensors={"s": {"point": [0.2, 1.0, 0]}}))
    with pytest.raises(PreprocessError, match=r"loads.p: pressure: expected force_per_length"):
        assemble(beam_body(beam(4), loads={"p": {"pressure": 1.0, "group": "tip"}}))


def test_a_body_of_matrices_has_points_and_no_loads(tmp_path):
    text = """
name = "given"
[matrices]
stiffness = "K.mtx"
mass = "M.mtx"
nodes = "nodes.csv"
[interfaces.a]
nodes = [1]
[impulse]
step = 1e-3
steps = 3
[loads.p]
force_per_volume = [1, 0, 0]
"""
    (tmp_path / "body.toml").write_text(text)
    with pytest.raises(PreprocessError, match="loads: expected a mesh, found \\[matrices\\]"):
        read_body(tmp_path / "body.toml")


def test_stresses_are_those_of_the_fields_where_one_element_is(block):
    """At a corner of the box, whatever the displacements."""
    body = block(sensors={"s": {"point": list(SIZE), "stress": True}})
    structure, source = assemble(body), read_source(body)
    points = source.field_points(stress=True)
    X = source.nodes.points[points.nodes]
    (corner,) = np.flatnonzero(np.linalg.norm(X - np.array(SIZE), axis=1) < 1e-9)
    u = np.random.default_rng(3).normal(size=structure.n_u)
    strains = (points.strains @ u).reshape(-1, 6)[corner]
    expected = points.C[points.owners[corner]] @ strains
    np.testing.assert_allclose(structure.channels.rows @ u, expected, rtol=1e-8)
