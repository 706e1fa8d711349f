"""Links as bodies: masses, centers and inertias of fixed links, frames, remarks, names."""

import numpy as np
import pytest
from duhamel.robots import ImportOptions, import_robot
from duhamel.robots.inertia import as_of_a_body
from duhamel.solver import read_model, simulate
from scipy.spatial.transform import Rotation

from .references import BASE, DATA, joint, link, model_of, urdf_of


def test_two_fixed_links_are_one_body_by_hand(tmp_path):
    """Two balls of 2 and 1 kg at 0.3 m from each other: center at 0.1 m, J = J_1 + J_2 + mu d^2."""
    text = BASE + link("arm", 2.0, (0.02, 0.02, 0.02)) + link("ball", 1.0, (0.01, 0.01, 0.01))
    text += joint("hinge", "base", "arm")
    text += joint("weld", "arm", "ball", '<origin xyz="0.3 0 0" rpy="0.5 0.6 0.7"/>', "fixed")
    body = model_of(urdf_of(tmp_path, text), tmp_path).bodies["arm"]
    assert body.mass == 3.0
    np.testing.assert_allclose(body.start.position, [0.1, 0.0, 0.0], atol=1e-15)
    across = 0.03 + 2.0 / 3.0 * 0.3**2
    np.testing.assert_allclose(body.inertia, np.diag([0.03, across, across]), rtol=1e-12)
    frame = body.frames["ball"]
    np.testing.assert_allclose(frame.position, [0.2, 0.0, 0.0], atol=1e-14)
    expected = Rotation.from_euler("xyz", [0.5, 0.6, 0.7]).as_rotvec()
    np.testing.assert_allclose(frame.rotation, expected, rtol=1e-13)


def test_the_inertia_of_turned_links_is_that_of_their_points(tmp_path):
    """Clouds of points have the same inertia, whatever the frames of their links."""
    rng = np.random.default_rng(3)
    rpy, place = rng.uniform(-1, 1, (4, 3)), rng.uniform(-0.5, 0.5, (4, 3))
    clouds = [rng.normal(0.0, 0.1, (6, 3)) for _ in range(2)]

    def cloud_link(name, k, cloud):
        # In axes of its own about its center, turned by rpy within the link.
        R = Rotation.from_euler("xyz", rpy[k]).as_matrix()
        y = (cloud - cloud.mean(0)) @ R
        J = sum(p @ p * np.eye(3) - np.outer(p, p) for p in y)
        origin = f'<origin xyz="{_words(cloud.mean(0))}" rpy="{_words(rpy[k])}"/>'
        keys = {
            "ixx": (0, 0),
            "ixy": (0, 1),
            "ixz": (0, 2),
            "iyy": (1, 1),
            "iyz": (1, 2),
            "izz": (2, 2),
        }
        moments = " ".join(f'{key}="{J[at]!r}"' for key, at in keys.items())
        moments = moments.replace("np.float64(", "").replace(")", "")
        mass = f'<mass value="{len(cloud)}"/>'
        return f'<link name="{name}"><inertial>{origin}{mass}<inertia {moments}/></inertial></link>'

    hinge = f'<origin xyz="{_words(place[2])}" rpy="{_words(rpy[2])}"/>'
    weld = f'<origin xyz="{_words(place[3])}" rpy="{_words(rpy[3])}"/>'
    text = BASE + cloud_link("arm", 0, clouds[0]) + cloud_link("box", 1, clouds[1])
    text += joint("hinge", "base", "arm", hinge) + joint("weld", "arm", "box", weld, "fixed")
    body = model_of(urdf_of(tmp_path, text), tmp_path).bodies["arm"]

    arm = Rotation.from_euler("xyz", rpy[2]).as_matrix()
    box = arm @ Rotation.from_euler("xyz", rpy[3]).as_matrix()
    points = np.vstack(
        [clouds[0] @ arm.T + place[2], clouds[1] @ box.T + place[2] + arm @ place[3]]
    )
    center = points.mean(0)
    J = sum(p @ p * np.eye(3) - np.outer(p, p) for p in points - center)
    R = Rotation.from_rotvec(body.start.rotation).as_matrix()
    assert body.mass == 12.0
    np.testing.assert_allclose(body.start.position, center, rtol=1e-12)
    np.testing.assert_allclose(R @ body.inertia @ R.T, J, rtol=0, atol=1e-12)
    np.testing.assert_allclose(R, arm, atol=1e-14)


def _words(values):
    return " ".join(repr(float(value)) for value in values)


def test_links_that_are_fixed_to_the_base_are_frames_of_the_ground(tmp_path):
    text = BASE + link("stand", 50.0) + link("arm") + joint("foot", "base", "stand", "", "fixed")
    text += joint("hinge", "stand", "arm", '<origin xyz="0 0 1"/>')
    model = model_of(urdf_of(tmp_path, text), tmp_path)
    assert set(model.bodies) == {"arm"}
    assert set(model.ground_frames) == {"hinge", "base", "stand"}


def test_a_quaternion_is_a_rotation_as_rpy_is(tmp_path):
    x, y, z, w = Rotation.from_euler("xyz", [0.3, -0.2, 0.9]).as_quat()
    bodies = []
    for origin in ('rpy="0.3 -0.2 0.9"', f'quat_xyzw="{x} {y} {z} {w}"'):
        text = BASE + link("arm") + joint("hinge", "base", "arm", f"<origin {origin}/>")
        bodies.append(model_of(urdf_of(tmp_path, text), tmp_path).bodies["arm"])
    np.testing.assert_allclose(*(body.start.rotation for body in bodies), rtol=1e-14)


def test_the_nearest_inertia_of_a_body_keeps_its_axes_and_the_largest_moment():
    turn = Rotation.from_euler("xyz", [0.4, 0.5, 0.6]).as_matrix()
    J = turn @ np.diag([1.0, 2.0, 5.0]) @ turn.T
    nearest, said = as_of_a_body(J, 1e-6)
    # Second moments 3, 2 and -1: without the last one 2 + 0, 3 + 0 and 3 + 2.
    np.testing.assert_allclose(np.linalg.eigvalsh(nearest), [2.0, 3.0, 5.0], rtol=1e-12)
    np.testing.assert_allclose(nearest @ turn[:, 2], 5.0 * turn[:, 2], rtol=1e-12)
    assert "principal inertias [1, 2, 5]" in said
    assert as_of_a_body(np.diag([1.0, 2.0, 3.0]), 1e-6) == (pytest.approx(np.diag([1, 2, 3])), "")


def imported(folder, text, **options):
    return import_robot(urdf_of(folder, text), folder / "robot.toml", ImportOptions(**options))


def test_an_inertia_of_no_body_is_told(tmp_path):
    done = imported(tmp_path, BASE + link("arm", 1.0, (1, 1, 3)) + joint("hinge", "base", "arm"))
    assert any("link 'arm': principal inertias [1, 1, 3]" in remark for remark in done.remarks)
    assert "# principal inertias [1, 1, 3]" in done.path.read_text()


def test_what_is_not_taken_is_told_with_its_number(tmp_path):
    text = BASE + link("arm").replace("</link>", "<collision/><collision/></link>")
    text += "<gazebo/><transmission/>"
    limit = '<limit lower="0" upper="0" effort="1" velocity="1"/>'
    inner = limit + '<safety_controller/><dynamics damping="0" D="3"/>'
    text += joint("hinge", "base", "arm", inner, "revolute")
    text += link("stone") + joint("flight", "base", "stone", kind="floating")
    remarks = imported(tmp_path, text).remarks
    assert remarks == (
        "<gazebo> of <robot>",
        "<transmission> of <robot>",
        "collision geometry: give [[contacts]] where parts touch (2 times)",
        "<safety_controller> of <joint>",
        "attribute 'D' of <dynamics>",
        "joint 'hinge': limits of 0 and 0 leave no play: no stop",
        "joint 'flight': floating: link 'stone' is free",
    )
    head = (tmp_path / "robot.toml").read_text().partition("[simulation]")[0]
    assert all(f"# - {remark}" in head for remark in remarks)


def test_names_are_made_those_of_a_model(tmp_path):
    text = BASE + link("left/arm.1") + link("left:arm.1") + link("ground")
    text += joint("left/arm.1", "base", "left/arm.1") + joint("b", "left/arm.1", "left:arm.1")
    text += joint("ground.b", "left:arm.1", "ground")
    model = model_of(urdf_of(tmp_path, text), tmp_path, servo=(1.0, 1.0))
    assert list(model.bodies) == ["left_arm_1", "left_arm_1 2", "ground 2"]
    assert [each.name for each in model.joints] == ["left_arm_1 3", "b", "ground_b"]


def test_numbers_of_the_robot_are_those_of_the_model(tmp_path):
    mass, moments = 0.1 + 0.2, (1.0 / 3.0, 0.234567890123456789, 2e-1)
    text = BASE + link("arm", repr(mass), moments) + joint("hinge", "base", "arm")
    body = model_of(urdf_of(tmp_path, text), tmp_path).bodies["arm"]
    assert body.mass == mass
    np.testing.assert_allclose(np.diag(body.inertia), moments, rtol=1e-15)


def test_a_planar_joint_slides_and_turns(tmp_path):
    text = BASE + link("puck") + joint("table", "base", "puck", kind="planar", axis="0 1 0")
    model = model_of(urdf_of(tmp_path, text), tmp_path, t_end=0.1)
    results = simulate(model)
    np.testing.assert_allclose(results.body("puck").x[-1], [0, 0, -0.5 * 9.81 * 0.01], atol=1e-7)


def test_an_import_reads_back_in_python_too(tmp_path):
    import duhamel as du

    import_robot(DATA / "two_links.urdf", tmp_path / "arm.toml", ImportOptions(servo=(100.0, 5.0)))
    mechanism = du.Mechanism.read(tmp_path / "arm.toml")
    assert mechanism.model().bodies.keys() == read_model(tmp_path / "arm.toml").bodies.keys()


def test_a_chain_of_two_thousand_links_is_read(tmp_path):
    names = [f"l{k}" for k in range(2000)]
    text = BASE + "".join(link(name) for name in names)
    pairs = zip(["base", *names], names, strict=False)
    text += "".join(
        joint(f"j{b}", a, b, kind="fixed" if b != "l0" else "continuous") for a, b in pairs
    )
    done = imported(tmp_path, text)
    assert (done.bodies, done.mass) == (1, pytest.approx(2000.0))
