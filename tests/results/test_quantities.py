"""Quantities of a results file, against closed forms."""

import copy
import pickle
import subprocess
import sys

import h5py
import numpy as np
import pytest
from duhamel.results import QuantityError, Results, ResultsError, quantities
from duhamel.results.rotations import twists

from .disc import ACCELERATION, ANGLE, RIM, SPEED, TILT, TIME, TRAVEL

E_Z = np.array([0.0, 0.0, 1.0])


@pytest.fixture
def results(results_file):
    return Results.read(results_file)


def test_names(results):
    assert results.bodies == ("beam", "disc")
    assert results.frames == ("beam.tip", "disc.rim")
    assert results.interfaces == ("beam.tip",)
    assert results.joints == ("clamp",)
    assert results.springs == ("mount",)
    np.testing.assert_array_equal(results.time, TIME)


@pytest.mark.parametrize("name", ["disc", "disc.rim", "beam.tip"])
def test_the_angle_goes_on_beyond_full_turns(results, name):
    angle = quantities.angle(results, name)
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


def test_angular_velocity_and_acceleration_are_turned_to_space(results):
    np.testing.assert_allclose(
        quantities.angular_velocity(results, "disc"), SPEED[:, None] * E_Z, rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(
        quantities.angular_acceleration(results, "disc"),
        ACCELERATION[:, None] * E_Z,
        rtol=0,
        atol=1e-12,
    )


def test_displacement_is_seen_in_the_axes_of_the_other_frame(results):
    found = quantities.displacement(results, "beam.tip", seen_from="disc.rim")
    np.testing.assert_allclose(found, TRAVEL - TRAVEL[0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(
        quantities.displacement(results, "disc.rim", seen_from="disc"), 0.0, rtol=0, atol=1e-15
    )


def test_what_stands_in_the_file_is_given_as_it_is(results):
    np.testing.assert_allclose(
        np.linalg.norm(quantities.position(results, "disc.rim"), axis=1), np.linalg.norm(RIM)
    )
    np.testing.assert_array_equal(quantities.elastic_displacement(results, "beam.tip"), TRAVEL)
    np.testing.assert_array_equal(quantities.elastic_rotation(results, "beam.tip"), 10 * TRAVEL)
    np.testing.assert_array_equal(quantities.force(results, "clamp"), TRAVEL + 1.0)
    np.testing.assert_array_equal(quantities.moment(results, "clamp"), TRAVEL + 2.0)
    np.testing.assert_array_equal(quantities.force(results, "mount"), TRAVEL + 3.0)
    np.testing.assert_array_equal(quantities.moment(results, "mount"), TRAVEL + 4.0)
    np.testing.assert_array_equal(quantities.coordinate(results, "clamp", "angle_rate"), SPEED)
    np.testing.assert_array_equal(quantities.linear_momentum(results), TRAVEL + 5.0)
    np.testing.assert_array_equal(quantities.angular_momentum(results), TRAVEL + 6.0)
    np.testing.assert_array_equal(quantities.velocity(results, "beam.tip"), TRAVEL + 7.0)
    np.testing.assert_array_equal(quantities.angular_velocity(results, "beam.tip"), TRAVEL + 8.0)
    np.testing.assert_array_equal(quantities.acceleration(results, "beam.tip"), TRAVEL + 9.0)
    np.testing.assert_array_equal(
        quantities.angular_acceleration(results, "beam.tip"), TRAVEL + 10.0
    )
    np.testing.assert_array_equal(quantities.energy(results, "kinetic"), 30.0 * SPEED**2)


@pytest.mark.parametrize("name", ["disc", "beam.tip"])
def test_attributes_have_what_plot_draws(results, name):
    """In the same axes: the angular velocity of a body is in space, in `v` in body axes."""
    is_body = name in results.bodies
    motion = results.body(name) if is_body else results.frame(name)
    linear = "" if is_body else "linear_"
    for attribute, kind in (
        ("position", "position"),
        (f"{linear}velocity", "velocity"),
        (f"{linear}acceleration", "acceleration"),
        ("angular_velocity", "angular_velocity"),
        ("angular_acceleration", "angular_acceleration"),
    ):
        found = getattr(motion, attribute)
        assert found.shape == (len(TIME), 3)
        np.testing.assert_array_equal(
            found, quantities.evaluate(results, f"{kind}:{name}").values, attribute
        )


def test_the_angular_velocity_of_a_body_is_in_space(results):
    disc = results.body("disc")
    np.testing.assert_allclose(disc.angular_velocity, SPEED[:, None] * E_Z, rtol=0, atol=1e-12)
    in_body_axes = SPEED[:, None] * TILT.inv().apply(E_Z)
    np.testing.assert_allclose(disc.v[:, 3:], in_body_axes, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(disc.rotation, disc.R)
    np.testing.assert_array_equal(disc.position, disc.x)


def test_the_parts_of_what_a_frame_has(results):
    tip = results.frame("beam.tip")
    np.testing.assert_array_equal(tip.elastic_displacement, TRAVEL)
    np.testing.assert_array_equal(tip.elastic_rotation, 10 * TRAVEL)
    np.testing.assert_array_equal(tip.velocity, np.hstack([TRAVEL + 7.0, TRAVEL + 8.0]))
    np.testing.assert_array_equal(np.hstack([tip.applied_force, tip.applied_moment]), tip.force)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_what_was_read_can_be_copied(results, copied):
    clamp, again = results.joint("clamp"), copied(results.joint("clamp"))
    assert vars(again).keys() == vars(clamp).keys()
    np.testing.assert_array_equal(again.angle, clamp.angle)


def test_results_are_not_changed_and_say_what_they_have(results):
    disc = results.body("disc")
    with pytest.raises(AttributeError, match="cannot assign to 'x'"):
        disc.x = 2.0
    assert repr(disc) == (
        "<BodyMotion: x (181, 3), R (181, 4), v (181, 6), v_dot (181, 6), "
        "second_order_force (181, 0), "
        "modal_coordinate (181, 0), surface_load (181, 0)>"
    )


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda found: quantities.angle(found, "wheel"),
            "no body or frame 'wheel'; there are: beam, disc, beam.tip, disc.rim",
        ),
        (
            lambda found: quantities.velocity(found, "wheel"),
            "no body or frame 'wheel'; there are: beam, disc, beam.tip, disc.rim",
        ),
        (
            lambda found: quantities.elastic_rotation(found, "disc.rim"),
            "no interface 'disc.rim'; there are: beam.tip",
        ),
        (
            lambda found: quantities.force(found, "pivot"),
            "no joint or spring or surface contact 'pivot'; there are: clamp, mount",
        ),
        (
            lambda found: quantities.coordinate(found, "mount", "angle"),
            "no joint 'mount'; there are: clamp",
        ),
        (
            lambda found: quantities.coordinate(found, "clamp", "distance"),
            "no coordinate of clamp 'distance'; there are: angle, angle_rate",
        ),
        (
            lambda found: quantities.energy(found, "heat"),
            "no energy 'heat'; there are: balance, dissipated, elastic, kinetic, numerical, "
            "potential",
        ),
    ],
)
def test_an_unknown_name_lists_the_known_ones(results, ask, message):
    with pytest.raises(QuantityError, match=message):
        ask(results)


def cut(file, name, data):
    del file[name]
    file[name] = data


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda file: file.attrs.update(format="other"),
            "expected results of a run, found an HDF5 file of another program",
        ),
        (
            lambda file: file.attrs.update(version=2),
            "disc-results.h5: results file of version 2; this Duhamel reads versions 3 to 12: "
            "run the model again$",
        ),
        (
            lambda file: file["solver"].attrs.update(written=0),
            "no step has been written yet",
        ),
        (lambda file: file.pop("solver"), "not a readable HDF5 file"),
        (
            lambda file: file.pop("body_rotation"),
            "variable 'body_rotation': expected numbers, found none",
        ),
        (
            lambda file: cut(file, "body_rotation", TRAVEL),
            r"variable 'body_rotation': expected shape \(181, 2, 4\), found \(181, 3\)",
        ),
    ],
)
def test_a_file_that_is_not_whole_is_an_error_that_names_it(edit, change, message):
    path = edit(change)
    with pytest.raises(ResultsError, match=message) as error:
        quantities.angle(Results.read(path), "disc")
    assert str(path) in str(error.value)


def test_no_file_and_no_hdf5_file_are_errors(tmp_path):
    with pytest.raises(ResultsError, match="no such file"):
        Results.read(tmp_path / "absent.h5")
    (tmp_path / "text.h5").write_text("text")
    with pytest.raises(ResultsError, match="not a readable HDF5 file"):
        Results.read(tmp_path / "text.h5")


def test_the_file_is_not_held_open(results_file, results):
    quantities.angle(results, "disc")
    with h5py.File(results_file, "w"):
        pass


def test_it_loads_neither_solver_nor_preprocess():
    program = (
        "import sys, duhamel.view, duhamel.results\n"
        "absent = {'duhamel.solver', 'duhamel.preprocess', 'numba', 'skfem', 'matplotlib.pyplot'}\n"
        "print(sorted(absent & {*sys.modules}))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_names_of_earlier_files_may_have_colons(edit):
    def rename(file):
        for dataset in filter(None, map(file.get, ("joint", "joint_coordinate"))):
            dataset[:] = [text.replace("clamp", "motor:1") for text in dataset.asstr()[:]]

    results = Results.read(edit(rename))
    assert results.joints == ("motor:1",)
    np.testing.assert_array_equal(
        quantities.evaluate(results, "force:motor:1:y").values, TRAVEL[:, 1] + 1.0
    )
    np.testing.assert_array_equal(
        quantities.evaluate(results, "coordinate:motor:1:angle").values, ANGLE
    )
    with pytest.raises(QuantityError, match="force:motor:2: expected force:JOINT"):
        quantities.evaluate(results, "force:motor:2")


def test_two_bodies_of_one_name_are_refused(edit):
    def rename(file):
        file["body"][:] = [file["body"][0]] * len(file["body"])

    path = edit(rename)
    with pytest.raises(ResultsError, match=r"body: expected different names, found .* more than"):
        Results.read(path)
