"""Superelements in place of links: where they stand, what they must have, how they move."""

from dataclasses import replace
from pathlib import Path

import duhamel as du
import numpy as np
import pytest
from duhamel import superelement
from duhamel.robots import FlexibleLink, ImportOptions, RobotError, import_robot
from duhamel.solver import FlexibleBody, RigidSuperelement, read_model, simulate

from .references import BASE, joint, link, urdf_of

LENGTH, STEP = 0.3, 5e-5
OFFSET = np.array([0.02, 0.03, 0.05])


@pytest.fixture(scope="session")
def bar(tmp_path_factory):
    """A bar along x from an origin of its own, of 1.2 kg, as a superelement of 12 dofs."""
    points = OFFSET + np.linspace([0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], 5)
    stuff = du.Material(E=5e10, nu=0.3, rho=1.2 / (LENGTH * 0.02 * 0.02))
    beam = du.Beam(points, section=du.Section.rectangle(stuff, width=0.02, height=0.02))
    beam.interface("root", points[0])
    beam.interface("tip", points[-1])
    path = tmp_path_factory.mktemp("bar") / "bar.h5"
    superelement.write(beam.superelement(step=STEP), path)
    return path


BAR = link("fore", 1.2, (8e-5, 0.009, 0.009), f'<origin xyz="{LENGTH / 2} 0 0"/>')
TURNED = '<origin xyz="0.1 0 0.2" rpy="0.3 0.4 0.5"/>'
ARM = (
    BASE
    + link("upper", 2.0, (0.02, 0.02, 0.02))
    + BAR
    + link("hand", 0.5, (1e-3, 1e-3, 1e-3))
    + joint("shoulder", "base", "upper", axis="0 1 0")
    + joint("elbow", "upper", "fore", TURNED, axis="0 1 0")
    + joint("wrist", "fore", "hand", f'<origin xyz="{LENGTH} 0 0"/>', axis="0 0 1")
)
AT_JOINTS = {"elbow": "root", "wrist": "tip"}


def imported(folder, bar, text=ARM, interfaces=None, **options):
    flexible = {"fore": FlexibleLink(bar, AT_JOINTS if interfaces is None else interfaces)}
    path = urdf_of(folder, text)
    return import_robot(path, folder / "robot.toml", ImportOptions(flexible=flexible, **options))


def test_a_superelement_stands_and_moves_as_the_rigid_link(tmp_path, bar):
    """Without its elasticity it is the link to rounding, wherever the mesh has its origin."""
    state = {"shoulder": 0.3, "elbow": 0.4, "wrist": -0.5}
    done = imported(tmp_path, bar, t_end=0.1, state=state)
    assert done.remarks == ()
    model = read_model(done.path)
    fore = model.bodies["fore"]
    assert isinstance(fore, FlexibleBody)
    stiff = RigidSuperelement(fore.superelement, fore.start, fore.source)
    settings = {"t_end": 0.1, "state": state, "step": STEP}
    import_robot(urdf_of(tmp_path, ARM), tmp_path / "rigid.toml", ImportOptions(**settings))
    rigid = read_model(tmp_path / "rigid.toml")
    # That of beams differs a little from the inertia that the link says.
    same = replace(rigid.bodies["fore"], inertia=fore.superelement.J_rot)
    ours = simulate(replace(model, bodies=model.bodies | {"fore": stiff}))
    theirs = simulate(replace(rigid, bodies=rigid.bodies | {"fore": same}))
    for name, start in state.items():
        angle = theirs.joint(name).angle
        assert angle[0] == pytest.approx(start, abs=1e-14)
        np.testing.assert_allclose(ours.joint(name).angle, angle, atol=1e-9)
    assert abs(theirs.joint("elbow").angle[-1] - 0.4) > 0.01


def test_the_step_is_that_of_the_superelement(tmp_path, bar):
    text = imported(tmp_path, bar).path.read_text()
    assert "step" not in text.partition("[bodies")[0]
    assert 'superelement = "' in text


def test_another_mass_is_told(tmp_path, bar):
    text = ARM.replace('<mass value="1.2"/>', '<mass value="1.3"/>')
    (remark,) = imported(tmp_path, bar, text).remarks
    assert remark == "flexible link 'fore': its superelement has 1.2 kg, the link 1.3 kg"


WELD = joint("weld", "fore", "{}", f'<origin xyz="{LENGTH} 0 0"/>', "fixed")
BOX = link("box", 0.4, (1e-3, 1e-3, 1e-3))


def test_what_is_fixed_to_it_is_a_body_on_an_interface(tmp_path, bar):
    text = ARM + BOX + WELD.format("box")
    done = imported(tmp_path, bar, text, AT_JOINTS | {"weld": "tip"}, t_end=0.05)
    model = read_model(done.path)
    weld = {each.name: each for each in model.joints}["weld"]
    assert (weld.type, weld.between) == ("fixed", ("fore.tip", "box.weld"))
    results = simulate(model)
    arm = np.linalg.norm(results.body("box").x - results.body("hand").x, axis=1)
    np.testing.assert_allclose(arm, 0.0, atol=1e-6)


def test_links_without_mass_on_it_are_told(tmp_path, bar):
    text = ARM + '<link name="mark"/>' + WELD.format("mark")
    assert imported(tmp_path, bar, text).remarks == (
        "link 'mark' on flexible link 'fore': no frame",
    )


FAULTS = {
    "a joint without an interface": (
        {"elbow": "root"},
        "expected an interface of each joint, wrist=NAME, found none",
    ),
    "an unknown joint": (
        AT_JOINTS | {"hand": "tip"},
        "no joint 'hand'; there are: elbow, wrist",
    ),
    "an unknown interface": (
        {"elbow": "root", "wrist": "end"},
        "joint 'wrist': {bar} has no interface 'end'; it has: root, tip",
    ),
    "interfaces in reverse": (
        {"elbow": "tip", "wrist": "root"},
        "interface 'root': expected at joint 'wrist', [0.3, 0, 0] m in the axes of the link, "
        "found at [-0.3, 0, 0] m",
    ),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_superelement_that_does_not_fit(tmp_path, bar, case):
    interfaces, expected = FAULTS[case]
    with pytest.raises(RobotError) as error:
        imported(tmp_path, bar, interfaces=interfaces)
    assert "flexible link 'fore': " in str(error.value)
    assert expected.format(bar=bar) in str(error.value)
    assert not (tmp_path / "robot.toml").exists()


def test_a_massive_link_fixed_to_it_needs_an_interface(tmp_path, bar):
    with pytest.raises(RobotError, match="expected an interface of each joint, weld=NAME"):
        imported(tmp_path, bar, ARM + BOX + WELD.format("box"))


def test_a_superelement_on_the_ground_and_one_that_flies(tmp_path, bar):
    """A fixed joint holds it at the base; a free base needs no joint to its parent."""
    text = BASE + BAR + link("hand", 0.5, (1e-3, 1e-3, 1e-3))
    text += joint("wrist", "fore", "hand", f'<origin xyz="{LENGTH} 0 0"/>')
    held = imported(
        tmp_path,
        bar,
        text + joint("foot", "base", "fore", TURNED, "fixed"),
        {"foot": "root", "wrist": "tip"},
    )
    foot = read_model(held.path).joints[0]
    assert (foot.type, foot.between) == ("fixed", ("ground.foot", "fore.root"))
    free = imported(
        tmp_path, bar, text.removeprefix(BASE), {"wrist": "tip"}, base="free", t_end=0.1
    )
    results = simulate(read_model(free.path))
    np.testing.assert_allclose(results.momentum.linear[-1, 2], -9.81 * 1.7 * 0.1, rtol=1e-6)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(RobotError, match=r"flexible link 'fore': none\.h5"):
        imported(tmp_path, Path("none.h5"))
