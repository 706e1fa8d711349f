"""One line that names file, contact and key for every contact, stop and friction that cannot be."""

import pytest
from duhamel.solver import ModelError, read_model, simulate

MODEL = """
[simulation]
t_end = 1e-3
step = 1e-4
[ground.frames.floor]
[bodies.ball]
mass = 1
inertia = [0.1, 0.1, 0.1]
frames.a = {position = [0, 0, 0.1]}
"""
JOINT = {"name": '"j"', "type": '"revolute"', "between": '["ground", "ball"]', "axis": "[0, 0, 1]"}
CONTACT = {
    "name": '"c"',
    "between": '["ground.floor", "ball.a"]',
    "shape": '"plane"',
    "axis": "[0, 0, 1]",
    "ball": "0.01",
    "stiffness": "1e5",
}
STOP = {
    "name": '"s"',
    "joint": '"j"',
    "coordinate": '"angle"',
    "range": "[-1, 1]",
    "stiffness": "1e5",
}
ROUND = {"shape": '"sphere"', "axis": None}
HERTZ = {"stiffness": None, "hertz": "{E = [1e9, 1e9], nu = [0.3, 0.3]}"}
CONTACTS = [
    ({"shape": '"cube"'}, "shape: expected 'plane', 'sphere', 'cylinder' or 'profile', got 'cube'"),
    ({"axis": None}, "axis: a plane needs one"),
    (ROUND, "radius: a sphere needs one"),
    (ROUND | {"radius": "0.01", "hollow": "true"}, "ball: expected less than the hollow radius"),
    ({"hollow": "true"}, "hollow: a plane cannot be"),
    ({"length": "1"}, "length: a plane takes none"),
    ({"ball": "-1"}, "ball: expected 0, or a number from 1e-100 to 1e100"),
    ({"ball": None}, "ball: missing"),
    ({"restitution": "0"}, "restitution: expected a positive number"),
    ({"restitution": "1.1"}, "restitution: expected more than 0 and at most 1, got 1.1"),
    ({"restitution": "nan"}, "restitution: expected a positive number"),
    ({"restitution": "0.5", "damping": "0.1"}, "expected restitution or damping, got both"),
    ({"stiffness": None}, "expected one of hertz, stiffness and law, found none"),
    ({"hertz": HERTZ["hertz"]}, "found hertz and stiffness"),
    (HERTZ | {"ball": "0"}, "hertz: a point has no radius"),
    (HERTZ | {"hertz": "{E = [1e9], nu = [0.3, 0.3]}"}, "hertz: E: expected two positive numbers"),
    (HERTZ | {"hertz": "{E = [1, 1], nu = [0.3, 0.6]}"}, "hertz: nu: expected two numbers from 0"),
    ({"exponent": "0.5"}, "exponent: expected 1 or more, got 0.5"),
    ({"patch": "[0, 1]"}, "patch: expected with hertz"),
    (HERTZ | {"patch": "[0]"}, "patch: expected two radii"),
    ({"friction": "0.3"}, "tangential_stiffness: needed with friction"),
    ({"tangential_stiffness": "1e5"}, "friction: needed with tangential_stiffness"),
    ({"friction": "-0.3"}, "friction: sliding: expected a number of at least 0"),
    ({"friction": "{static = 0.1}"}, "friction: sliding: missing"),
    (
        {"friction": "{static = 0.1, sliding = 0.3, speed = 0.1}"},
        "friction: static: expected no less than sliding",
    ),
    ({"friction": '"rough"'}, "friction: expected a number or a table"),
    ({"between": '["ground.floor", "ball.b"]'}, "no frame 'b' on 'ball'"),
    ({"between": '["ball.a", "ball"]'}, "expected frames of two bodies"),
    ({"points": "[[0, 0], [1, 0]]"}, "points: a plane takes none"),
    ({"shape": '"profile"'}, "points: a profile needs some"),
    ({"shape": '"profile"', "points": "[[0, 0], [1, 0]]"}, "points: expected four or more, got 2"),
    ({"shape": '"profile"', "points": "[0, 1, 2]"}, "points.0: expected two numbers"),
    ({"colour": '"red"'}, "unknown key 'colour'"),
    ({"slow": "0"}, "slow: expected a positive number"),
    ({"name": '"j"'}, "expected different names, got 'j' more than once"),
]
TABLES = [
    ("[0, 1]", "[0, -1]", "law: force: expected rising numbers"),
    ("[0, 1, 1]", "[0, 1, 2]", "law: penetration: expected rising numbers"),
    ("[0.1, 1]", "[0, 2]", "law: penetration: expected two or more numbers from 0"),
    ("[0, 1]", "[0, 2, 3]", "law: expected as many forces as penetrations, got 3 and 2"),
]
STOPS = [
    ({"joint": '"k"'}, "joint: no joint 'k'; there are: j"),
    ({"coordinate": '"distance"'}, "coordinate: joint 'j' has angle, got 'distance'"),
    ({"range": "[1, -1]"}, "range: expected a lower and a higher number"),
    ({"range": "[-inf, inf]"}, "range: expected a lower and a higher number"),
    ({"range": "[nan, 1]"}, "range: expected a lower and a higher number"),
    ({"range": "[0]"}, "range: expected two numbers"),
    ({"stiffness": None}, "expected one of stiffness and law, found none"),
    ({"friction": "0.3"}, "unknown key 'friction'"),
]
FRICTIONS = [
    ("revolute", "{coefficient = 0.1}", "friction: radius: a revolute joint needs one"),
    ("spherical", "{coefficient = 0.1}", "unknown key 'friction'"),
    ("prismatic", "{radius = 0.1}", "friction: radius: a prismatic joint takes none"),
    ("revolute", "{coefficient = -1, radius = 1}", "friction: coefficient: sliding: expected"),
    ("revolute", "{mu = 0.3}", "friction: unknown key 'mu'"),
    ("revolute", "{force = 2}", "friction: force: a revolute joint takes a torque"),
    ("prismatic", "{torque = 2}", "friction: torque: a prismatic joint takes a force"),
    ("revolute", "{torque = 2, preload = 1}", "torque: constant friction takes no preload"),
    ("revolute", "{torque = 2, force = 1}", "torque: constant friction takes no force"),
    ("revolute", "{torque = -2}", "friction.torque: expected a number of at least 0"),
]


def table(head, keys):
    lines = [f"{key} = {value}" for key, value in keys.items() if value is not None]
    return "\n".join([f"[[{head}]]", *lines, ""])


def refused(tmp_path, *tables):
    path = tmp_path / "model.toml"
    path.write_text(MODEL + "".join(tables))
    with pytest.raises(ModelError) as raised:
        simulate(read_model(path))
    message = str(raised.value)
    assert "\n" not in message
    assert message.startswith(str(path))
    return message


@pytest.mark.parametrize(("changes", "expected"), CONTACTS)
def test_a_contact_that_cannot_be(tmp_path, changes, expected):
    rubs = {}
    if "friction" in changes and "needed" not in expected:
        rubs = {"tangential_stiffness": "1e5"}
    message = refused(tmp_path, table("joints", JOINT), table("contacts", CONTACT | rubs | changes))
    assert expected in message
    assert any(name in message for name in ("contact 'c'", "contacts.c", "contacts, stops"))


@pytest.mark.parametrize(("penetration", "force", "expected"), TABLES)
def test_a_table_that_cannot_be(tmp_path, penetration, force, expected):
    law = f"{{penetration = {penetration}, force = {force}}}"
    changes = {"stiffness": None, "law": law}
    message = refused(tmp_path, table("contacts", CONTACT | changes))
    assert f"contact 'c': {expected}" in message


@pytest.mark.parametrize(("changes", "expected"), STOPS)
def test_a_stop_that_cannot_be(tmp_path, changes, expected):
    message = refused(tmp_path, table("joints", JOINT), table("stops", STOP | changes))
    assert expected in message
    assert "stop 's'" in message or "stops.s" in message


@pytest.mark.parametrize(("kind", "friction", "expected"), FRICTIONS)
def test_friction_that_a_joint_cannot_have(tmp_path, kind, friction, expected):
    axis = {"axis": None} if kind == "spherical" else {}
    keys = JOINT | axis | {"type": f'"{kind}"', "friction": friction}
    assert expected in refused(tmp_path, table("joints", keys))
