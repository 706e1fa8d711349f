"""Model files: every key that is documented, and starts."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from duhamel.solver import (
    JOINTS,
    OutputRequest,
    RigidBody,
    Settings,
    Spline,
    SteadyRotation,
    read_model,
    simulate,
)
from duhamel.solver.schema.entry import former_keys
from duhamel.solver.schema.tables import keys_of
from duhamel.solver.signals.drives import ANGULAR_RATES, LINEAR_RATES
from duhamel.superelement import write

DOCUMENT = Path(__file__).parents[2] / "docs" / "file-formats.md"
ROTOR = """
[simulation]
t_end = 0.02
step = 1e-3
gravity = [0, 0, -9.81]
{simulation}

[bodies.disk]
mass = 2.0
inertia = [0.1, 0.1, 0.2]
position = [0.3, 0, 0]
frames.pin = {{position = [-0.3, 0, 0]}}

[[joints]]
name = "pin"
type = "revolute"
between = ["ground.pin", "disk.pin"]
axis = [0, 0, 1]
{joint}

[ground]
frames.pin = {{position = [{gap}, 0, 0]}}
"""


def documented():
    """The model file of the documentation with all that is commented out: key = value   # what it
    means.
    """
    section = DOCUMENT.read_text().split("## Model file")[1].split("\n| joint |")[0]
    lines = [line[4:] for line in section.splitlines() if line.startswith("    ")]
    return "\n".join(re.sub(r"^# (?=[a-z_.]+ = )", "", line) for line in lines)


def test_the_documented_file_is_read_whole(beam, tmp_path):
    write(tmp_path / "beam.h5", beam.element)
    path = tmp_path / "model.toml"
    path.write_text(documented())
    model = read_model(path)
    assert (model.settings.start, model.settings.assemble, model.settings.redundant) == (
        "equilibrium",
        True,
        "remove",
    )
    np.testing.assert_array_equal(model.settings.steady_rotation.angular_velocity, [0, 0, 50])
    assert model.joints[0].start == {"angle": 0.3, "angle_rate": 0.0}
    assert model.motions[1].angle == Spline((0.0, 0.1, 0.2), (0.0, 0.1, 0.4))
    assert [spring.name for spring in model.springs] == ["mount", "stop"]


def test_the_documented_file_leaves_nothing_out(tmp_path):
    """All that a `Model` takes can stand in a file: fields of its entries are keys of the
    document.
    """
    text = tomllib.loads(documented())
    keys = {"kernel_length": "memory", "fixed_iterations": "corrections"}
    settings = {keys.get(name, name) for name in Settings.__dataclass_fields__} - {"output"}
    assert set(text["simulation"]) == settings | {"gravity"}
    assert set(text["output"]) == set(OutputRequest.__dataclass_fields__)
    keys = set().union(*text["joints"])
    drives = set(LINEAR_RATES) | set(ANGULAR_RATES)
    fields = {name for joint in JOINTS.values() for name in keys_of(joint)}
    former = {name for joint in JOINTS.values() for name in former_keys(joint)}
    # The radius of a rolling disc is told in the table of joints.
    assert keys == {"type", *fields} - drives - former - {"radius"}
    section = DOCUMENT.read_text().split("### Drives")[1].split("\n\n    ")[0]
    assert all(f"`{key}`" in section for key in drives)
    assert set(text["bodies"]["hub"]) >= set(RigidBody.__dataclass_fields__) - {"start"}


@pytest.fixture
def rotor(tmp_path):
    def make(simulation="", joint="", gap="0"):
        path = tmp_path / "rotor.toml"
        path.write_text(ROTOR.format(simulation=simulation, joint=joint, gap=gap))
        return read_model(path)

    return make


def test_a_file_starts_in_steady_rotation(rotor):
    steady = "steady_rotation = {angular_velocity = [0, 0, 30], center = [0, 0, 0]}"
    model = rotor(f"start = 'equilibrium'\nrho_inf = 0.99\n{steady}")
    assert isinstance(model.settings.steady_rotation, SteadyRotation)
    results = simulate(model)
    np.testing.assert_allclose(results.body("disk").v[:, 5], 30.0, rtol=1e-12)
    assert results.joint("pin").force[0, 0] == pytest.approx(-2.0 * 0.3 * 30.0**2, rel=1e-3)


def test_a_file_starts_at_rest_in_equilibrium(rotor):
    results = simulate(rotor("start = 'equilibrium'"))
    assert np.abs(results.body("disk").v).max() < 1e-12
    np.testing.assert_allclose(
        results.joint("pin").force, np.tile([0, 0, 2.0 * 9.81], (21, 1)), rtol=0, atol=1e-9
    )


def test_a_file_closes_joints_however_far_they_are_open(rotor):
    results = simulate(rotor("assemble = true", gap="0.2"))
    assert results.solver["assembly_error"] == pytest.approx(0.2)
    np.testing.assert_allclose(
        results.frame("disk.pin").position[0], [0.2, 0, 0], rtol=0, atol=1e-12
    )


def test_a_file_lets_redundant_constraints_go(rotor):
    again = "[[joints]]\nname = 'again'\ntype = 'spherical'\nbetween = ['ground.pin', 'disk.pin']"
    results = simulate(rotor("redundant = 'remove'", again))
    assert results.solver["removed"] == "again (translation 1, translation 2, translation 3)"
    assert results.solver["degrees_of_freedom"] == 1


def test_a_file_starts_from_a_joint_angle_and_its_rate(rotor):
    coordinates = (
        simulate(rotor(joint="start = {angle = 0.4, angle_rate = 2}")).joint("pin").coordinates
    )
    assert coordinates["angle"][0] == pytest.approx(0.4, abs=1e-12)
    assert coordinates["angle_rate"][0] == pytest.approx(2.0, rel=1e-12)
