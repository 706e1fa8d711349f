"""What an import refuses, with the words that name the place."""

from pathlib import Path

import pytest
from duhamel.robots import FlexibleLink, ImportOptions, RobotError, import_robot

from .references import BASE, joint, link, urdf_of

ARM = BASE + link("arm")
HINGE = joint("hinge", "base", "arm")
LIMIT = '<limit lower="{}" upper="{}" effort="{}" velocity="{}"/>'


def refused(folder, text, **options):
    """The message of a robot that is refused, and nothing is left behind."""
    path = urdf_of(folder, text)
    with pytest.raises(RobotError) as error:
        import_robot(path, folder / "robot.toml", ImportOptions(**options))
    assert [each.name for each in folder.iterdir()] == ["robot.urdf"]
    message = str(error.value)
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


def inertia(**given):
    values = {"ixx": 1, "ixy": 0, "ixz": 0, "iyy": 1, "iyz": 0, "izz": 1} | given
    words = (f'{key}="{value}"' for key, value in values.items())
    return f"<inertia {' '.join(words)}/>"


def massive(mass='<mass value="1"/>', moments=None, name="arm"):
    moments = inertia() if moments is None else moments
    return f'{BASE}<link name="{name}"><inertial>{mass}{moments}</inertial></link>'


ROBOTS = {
    "no links": ("", "robot: expected a <link>, found none"),
    "a link without a name": ("<link/>", "robot: expected a name of each <link>, found one"),
    "two links of a name": (
        BASE + BASE,
        "robot: expected different names, found two <link> called 'base'",
    ),
    "two joints of a name": (
        ARM + link("hand") + HINGE + joint("hinge", "arm", "hand"),
        "robot: expected different names, found two <joint> called 'hinge'",
    ),
    "an unknown parent": (
        ARM + joint("hinge", "bse", "arm"),
        "joint 'hinge': parent: no link 'bse'",
    ),
    "an unknown child": (ARM + joint("hinge", "base", "am"), "joint 'hinge': child: no link 'am'"),
    "a link on itself": (ARM + joint("hinge", "arm", "arm"), "joint 'hinge': parent and child are"),
    "several roots": (ARM, "expected one root link, found 'base', 'arm'"),
    "a loop alone": (
        link("a") + link("b") + joint("j", "a", "b") + joint("k", "b", "a"),
        "links form a loop, without a root: 'b', 'a'",
    ),
    "a loop apart": (
        ARM + link("b") + HINGE + link("c") + joint("j", "b", "c") + joint("k", "c", "b"),
        "links form a loop, apart from root 'base': 'c', 'b'",
    ),
    "two parents": (
        ARM + link("hand") + HINGE + joint("j", "base", "hand") + joint("k", "arm", "hand"),
        "link 'hand' has two parents, by joints 'j' and 'k': loops are not read",
    ),
    "a moving link without mass": (
        BASE + '<link name="arm"/>' + HINGE,
        "link 'arm': moves without a mass: give it an <inertial>",
    ),
    "no mass": (massive("") + HINGE, "link 'arm': inertial: expected <mass>, found none"),
    "no inertia": (massive(moments=" ") + HINGE, "link 'arm': inertial: expected <inertia>"),
    "a negative mass": (
        massive('<mass value="-2"/>') + HINGE,
        "link 'arm': inertial: mass: expected at least 0 kg, got -2",
    ),
    "a mass in words": (
        massive('<mass value="2 kg"/>') + HINGE,
        "link 'arm': inertial: mass: value: expected a number, got '2 kg'",
    ),
    "a mass that is no number": (
        massive('<mass value="nan"/>') + HINGE,
        "link 'arm': inertial: mass: value: expected a number, got 'nan'",
    ),
    "a mass without a value": (massive("<mass/>") + HINGE, "value: expected a number, got none"),
    "a missing moment": (
        massive(moments='<inertia ixx="1" iyy="1"/>') + HINGE,
        "link 'arm': inertial: inertia: izz: expected a number, got none",
    ),
    "a negative inertia": (
        massive(moments=inertia(izz=-1)) + HINGE,
        "link 'arm': inertia: expected no negative principal value, got [-1, 1, 1]",
    ),
    "an inertia that is not positive": (
        massive(moments=inertia(ixx=0)) + HINGE,
        "link 'arm': inertia: expected positive principal values, got [0, 1, 1]",
    ),
    "products larger than moments": (
        massive(moments=inertia(ixy=2)) + HINGE,
        "link 'arm': inertia: expected no negative principal value",
    ),
    "a negative inertia among fixed links": (
        ARM
        + massive(moments=inertia(iyy=-0.01), name="box").removeprefix(BASE)
        + HINGE
        + joint("j", "arm", "box", kind="fixed"),
        "link 'box': inertia: expected no negative principal value",
    ),
    "two inertials": (
        BASE + '<link name="arm"><inertial/><inertial/></link>' + HINGE,
        "link 'arm': expected one <inertial>, found 2",
    ),
    "an unknown type": (
        ARM + joint("hinge", "base", "arm", kind="ball"),
        "joint 'hinge': type: expected fixed, revolute, continuous, prismatic, planar, floating, "
        "got 'ball'",
    ),
    "no type": (ARM + HINGE.replace('type="continuous"', ""), "joint 'hinge': type: expected text"),
    "a zero axis": (
        ARM + joint("hinge", "base", "arm", axis="0 0 0"),
        "joint 'hinge': axis: xyz: expected a direction, got 0 0 0",
    ),
    "a short axis": (
        ARM + joint("hinge", "base", "arm", axis="0 1"),
        "joint 'hinge': axis: xyz: expected 3 numbers, got '0 1'",
    ),
    "an infinite place": (
        ARM + joint("hinge", "base", "arm", '<origin xyz="inf 0 0"/>'),
        "joint 'hinge': origin: xyz: expected 3 numbers, got 'inf 0 0'",
    ),
    "two rotations": (
        ARM + joint("hinge", "base", "arm", '<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>'),
        "joint 'hinge': origin: expected rpy or quat_xyzw, got both",
    ),
    "a quaternion of zeros": (
        ARM + joint("hinge", "base", "arm", '<origin quat_xyzw="0 0 0 0"/>'),
        "joint 'hinge': origin: quat_xyzw: expected a quaternion other than 0",
    ),
    "limits in reverse": (
        ARM + joint("hinge", "base", "arm", LIMIT.format(1, -1, 0, 0), "revolute"),
        "joint 'hinge': limit: expected lower below upper, got 1 and -1",
    ),
    "a negative effort": (
        ARM + joint("hinge", "base", "arm", LIMIT.format(-1, 1, -5, 0), "revolute"),
        "joint 'hinge': limit: effort: expected at least 0, got -5",
    ),
    "negative damping": (
        ARM + joint("hinge", "base", "arm", '<dynamics damping="-1"/>'),
        "joint 'hinge': dynamics: damping: expected at least 0, got -1",
    ),
    "a mimic of nothing": (
        ARM + joint("hinge", "base", "arm", '<mimic joint="other"/>'),
        "joint 'hinge': mimic: expected a joint with one coordinate, got 'other'",
    ),
    "a mimic of itself": (
        ARM + joint("hinge", "base", "arm", '<mimic joint="hinge"/>'),
        "joints mimic each other: 'hinge'",
    ),
    "a figure of no size": (
        BASE
        + '<link name="arm"><visual><geometry><sphere radius="0"/></geometry></visual></link>'
        + HINGE,
        "link 'arm': visual: geometry: sphere: radius: expected positive numbers, got [0.0]",
    ),
    "a figure that is none": (
        BASE + '<link name="arm"><visual><geometry/></visual></link>' + HINGE,
        "link 'arm': visual: geometry: expected one figure, found none",
    ),
    "nothing that moves": (BASE, "expected a joint that moves, or --base free"),
    "xacro": (
        '<xacro:macro name="arm"/>',
        "expected URDF, found <xacro:macro> of a xacro file: expand it first, xacro robot.urdf",
    ),
    "xacro in values": (
        massive('<mass value="${m}"/>') + HINGE,
        "expected URDF, found '${m}' of a xacro file",
    ),
    "no XML": ("<link", "expected XML: "),
}


@pytest.mark.parametrize("case", ROBOTS)
def test_a_robot_that_cannot_be(tmp_path, case):
    text, expected = ROBOTS[case]
    # Prefixes need no declaration: the parser does not resolve them.
    assert expected in refused(tmp_path, text)


OPTIONS = {
    "an unknown link": (
        {"flexible": {"am": FlexibleLink(Path("a.h5"), {})}},
        "flexible: no link 'am'; there are: base, arm",
    ),
    "a flexible root": (
        {"flexible": {"base": FlexibleLink(Path("a.h5"), {})}},
        "flexible: link 'base' is the root, which stands on the ground",
    ),
    "no superelement": (
        {"flexible": {"arm": FlexibleLink(Path("none.h5"), {"hinge": "root"})}},
        "flexible link 'arm': none.h5",
    ),
    "an unknown joint": (
        {"state": {"hing": 1.0}},
        "state: no joint 'hing' with one coordinate; there are: hinge",
    ),
    "gains of an unknown joint": (
        {"servos": {"hing": (1.0, 1.0)}},
        "servo_of: no joint 'hing' with one coordinate; there are: hinge",
    ),
    "a free base without mass": ({"base": "free"}, "link 'base': moves without a mass"),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_options_that_the_robot_has_not(tmp_path, case):
    options, expected = OPTIONS[case]
    assert expected in refused(tmp_path, ARM + HINGE, **options)


def test_entities_that_expand_to_gigabytes_are_refused_at_once(tmp_path):
    path = tmp_path / "robot.urdf"
    levels = "".join('<!ENTITY l{} "{}">'.format(k, f"&l{k - 1};" * 10) for k in range(1, 12))
    path.write_text(
        f'<!DOCTYPE robot [<!ENTITY l0 "lol">{levels}]><robot name="&l11;"/>', encoding="utf-8"
    )
    with pytest.raises(RobotError, match=r"robot\.urdf: line 1: expected no document type"):
        import_robot(path, tmp_path / "robot.toml")


def test_elements_within_one_another_without_end_are_refused(tmp_path):
    path = urdf_of(tmp_path, "<a>" * 100_000)
    with pytest.raises(RobotError, match="expected at most 100 elements within one another"):
        import_robot(path, tmp_path / "robot.toml")


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("none.urdf", None, "not a readable file: No such file"),
        ("robot.xacro", "<robot/>", "expected URDF, found a xacro file: expand it first"),
        ("robot.sdf", "<sdf/>", "expected <robot> of URDF or <mujoco> of MJCF, found <sdf>"),
        ("empty.urdf", "", "expected XML: no element found"),
        ("latin.urdf", b'<robot name="\xe9"/>', "not UTF-8"),
    ],
)
def test_a_file_that_is_no_robot(tmp_path, name, content, expected):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(RobotError) as error:
        import_robot(path, tmp_path / "robot.toml")
    assert str(error.value).startswith(str(path))
    assert expected in str(error.value)


def test_a_folder_is_no_robot(tmp_path):
    with pytest.raises(RobotError, match="expected a regular file, found a folder"):
        import_robot(tmp_path, tmp_path / "robot.toml")


def test_the_robot_itself_is_not_replaced(tmp_path):
    path = urdf_of(tmp_path, ARM + HINGE)
    with pytest.raises(ValueError, match="is the robot, which the model would replace"):
        import_robot(path, path)


def test_a_model_in_a_folder_that_is_not_there_is_an_error_that_names_it(tmp_path):
    path = urdf_of(tmp_path, ARM + HINGE)
    with pytest.raises(RobotError, match=r"none/robot\.toml: cannot be written"):
        import_robot(path, tmp_path / "none" / "robot.toml")


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"servo": (0.0, 0.0)}, "servo: expected a gain above 0, got two zeros"),
        ({"servo": (-1.0, 0.0)}, "servo: expected two gains of at least 0"),
        ({"stop_stiffness": 0.0}, "stop_stiffness: expected a positive number, got 0"),
        ({"step": float("nan")}, "step: expected a positive number, got nan"),
        ({"state": {"a": float("inf")}}, "state: a: expected a number, got inf"),
    ],
)
def test_options_that_no_model_takes(options, expected):
    with pytest.raises(ValueError, match=expected):
        ImportOptions(**options)
