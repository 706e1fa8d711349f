"""The motion read from a results file, against closed forms."""

import subprocess
import sys

import h5py
import numpy as np
import pytest
from duhamel import view
from duhamel.view.rotations import twists

from .conftest import ACCELERATION, ANGLE, RIM, SPEED, TIME, TRAVEL

E_Z = np.array([0.0, 0.0, 1.0])


@pytest.fixture
def recording(results_file):
    return view.read(results_file)


def test_names(recording):
    assert recording.bodies == ("beam", "disc")
    assert recording.frames == ("beam.tip", "disc.rim")
    assert recording.interfaces == ("beam.tip",)
    assert recording.joints == ("clamp",)
    assert recording.springs == ("mount",)
    np.testing.assert_array_equal(recording.time, TIME)


@pytest.mark.parametrize("name", ["disc", "disc.rim", "beam.tip"])
def test_the_angle_goes_on_beyond_full_turns(recording, name):
    angle = recording.angle(name)
    assert ANGLE[-1] > 3 * 2 * np.pi
    np.testing.assert_allclose(angle, ANGLE[:, None] * E_Z, rtol=0, atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_twists_about_each_axis(axis):
    half = np.linspace(0.0, -20.0, 60)
    q = np.zeros((60, 4))
    q[:, 0], q[:, 1 + axis] = np.cos(half), np.sin(half)
    np.testing.assert_allclose(twists(q), 2 * half[:, None] * np.eye(3)[axis], rtol=0, atol=1e-12)


def test_the_twist_of_a_turn_and_a_tilt_is_the_turn():
    """R = R_x(tilt) R_z(angle): a swing of z towards y after the twist."""
    angle, tilt = np.linspace(0.0, 15.0, 40), 0.3
    w, x = np.cos(tilt / 2), np.sin(tilt / 2)
    c, s = np.cos(angle / 2), np.sin(angle / 2)
    q = np.stack([w * c, x * c, -x * s, w * s], axis=1)
    np.testing.assert_allclose(twists(q)[:, 2], angle, rtol=0, atol=1e-12)


def test_angular_velocity_and_acceleration_are_turned_to_space(recording):
    np.testing.assert_allclose(
        recording.angular_velocity("disc"), SPEED[:, None] * E_Z, rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(
        recording.angular_acceleration("disc"), ACCELERATION[:, None] * E_Z, rtol=0, atol=1e-12
    )


def test_displacement_is_seen_in_the_axes_of_the_other_frame(recording):
    found = recording.displacement("beam.tip", seen_from="disc.rim")
    np.testing.assert_allclose(found, TRAVEL - TRAVEL[0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        recording.displacement("disc.rim", seen_from="disc"), 0.0, rtol=0, atol=1e-15
    )


def test_what_stands_in_the_file_is_given_as_it_is(recording):
    np.testing.assert_allclose(
        np.linalg.norm(recording.position("disc.rim"), axis=1), np.linalg.norm(RIM)
    )
    np.testing.assert_array_equal(recording.elastic_displacement("beam.tip"), TRAVEL)
    np.testing.assert_array_equal(recording.elastic_rotation("beam.tip"), 10 * TRAVEL)
    np.testing.assert_array_equal(recording.force("clamp"), TRAVEL + 1.0)
    np.testing.assert_array_equal(recording.moment("clamp"), TRAVEL + 2.0)
    np.testing.assert_array_equal(recording.force("mount"), TRAVEL + 3.0)
    np.testing.assert_array_equal(recording.moment("mount"), TRAVEL + 4.0)
    np.testing.assert_array_equal(recording.coordinate("clamp", "angle_rate"), SPEED)
    np.testing.assert_array_equal(recording.linear_momentum(), TRAVEL + 5.0)
    np.testing.assert_array_equal(recording.angular_momentum(), TRAVEL + 6.0)
    np.testing.assert_array_equal(recording.velocity("beam.tip"), TRAVEL + 7.0)
    np.testing.assert_array_equal(recording.angular_velocity("beam.tip"), TRAVEL + 8.0)
    np.testing.assert_array_equal(recording.acceleration("beam.tip"), TRAVEL + 9.0)
    np.testing.assert_array_equal(recording.angular_acceleration("beam.tip"), TRAVEL + 10.0)
    np.testing.assert_array_equal(recording.energy("kinetic"), 30.0 * SPEED**2)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda found: found.angle("wheel"),
            "no body or frame 'wheel'; there are: beam, disc, beam.tip, disc.rim",
        ),
        (
            lambda found: found.velocity("wheel"),
            "no body or frame 'wheel'; there are: beam, disc, beam.tip, disc.rim",
        ),
        (
            lambda found: found.elastic_rotation("disc.rim"),
            "no interface 'disc.rim'; there are: beam.tip",
        ),
        (lambda found: found.force("pivot"), "no joint or spring 'pivot'; there are: clamp, mount"),
        (lambda found: found.coordinate("mount", "angle"), "no joint 'mount'; there are: clamp"),
        (
            lambda found: found.coordinate("clamp", "distance"),
            "no coordinate of clamp 'distance'; there are: angle, angle_rate",
        ),
        (
            lambda found: found.energy("heat"),
            "no energy 'heat'; there are: balance, elastic, kinetic",
        ),
    ],
)
def test_an_unknown_name_lists_the_known_ones(recording, ask, message):
    with pytest.raises(view.QuantityError, match=message):
        ask(recording)


def cut(file, name, data):
    del file[name]
    file[name] = data


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda file: file.attrs.update(format="other"),
            "attribute 'format': expected duhamel-results, found other",
        ),
        (lambda file: file.attrs.update(version=2), "attribute 'version': expected 1, found 2"),
        (lambda file: file.pop("time"), "dataset 'time' is missing or empty"),
        (lambda file: file.pop("joints"), "not a readable results file"),
        (lambda file: file.pop("bodies/disc/R"), "dataset 'bodies/disc/R' is missing"),
        (
            lambda file: cut(file, "bodies/disc/R", TRAVEL),
            r"dataset 'bodies/disc/R': expected shape \(181, 4\), found",
        ),
    ],
)
def test_a_file_that_is_not_whole_is_an_error_that_names_it(edit, change, message):
    path = edit(change)
    with pytest.raises(view.ResultsError, match=message) as error:
        view.read(path).angle("disc")
    assert str(path) in str(error.value)


def test_no_file_and_no_hdf5_file_are_errors(tmp_path):
    with pytest.raises(view.ResultsError, match="no such file"):
        view.read(tmp_path / "absent.h5")
    (tmp_path / "text.h5").write_text("text")
    with pytest.raises(view.ResultsError, match="not a readable results file"):
        view.read(tmp_path / "text.h5")


def test_the_file_is_not_held_open(results_file, recording):
    recording.angle("disc")
    with h5py.File(results_file, "w"):
        pass


def test_it_loads_neither_solver_nor_preprocess():
    program = (
        "import sys, duhamel.view\n"
        "absent = {'duhamel.solver', 'duhamel.preprocess', 'numba', 'skfem', 'matplotlib.pyplot'}\n"
        "print(sorted(absent & {*sys.modules}))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
