"""Sensors: what interfaces, fields and closed forms say of the same points."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.preprocess.body.body import Impulse, RecoveredFields
from duhamel.results.quantities import QuantityError, evaluate
from duhamel.solver import (
    Constant,
    Fixed,
    FlexibleBody,
    Force,
    Harmonic,
    Model,
    ModelError,
    PatternLoad,
    Results,
    Settings,
    Simulator,
    Start,
    simulate,
)
from duhamel.solver.linear.linearize import linearize
from duhamel.superelement import read, write
from scipy.spatial.transform import Rotation

from .spread import channelled_beam

H = 2e-4


@pytest.fixture(scope="module")
def element(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sensed")
    return channelled_beam(folder, 4, recovery=RecoveredFields()).element


@pytest.fixture(scope="module")
def thrown(element):
    """A beam that flies and spins, pushed at its tip and by the wind."""
    start = Start([0.3, 0.1, 0.2], [0.4, -0.2, 0.9], angular_velocity=[3.0, -8.0, 20.0])
    return Model(
        {"beam": FlexibleBody(element, start)},
        loads=[
            Force("beam.tip", [0.2, 1.0, -0.5], Harmonic(1.0, 30.0)),
            PatternLoad("beam", "wind", Harmonic(2.0, 50.0, 0.4)),
        ],
        gravity=[0.0, 0.0, -9.81],
        settings=Settings(t_end=0.05, step=H),
    )


@pytest.fixture(scope="module")
def run(thrown):
    return simulate(thrown)


def test_a_sensor_at_an_interface_reads_what_that_does(run):
    """In body axes; the acceleration is that in space."""
    sensor, frame = run.sensor("beam.end"), run.frame("beam.tip")
    np.testing.assert_allclose(sensor.value, frame.u[:, :3], rtol=0, atol=1e-15)
    back = Rotation.from_quat(run.body("beam").R, scalar_first=True).inv()
    expected = back.apply(frame.acceleration[:, :3])
    largest = np.abs(expected).max()
    np.testing.assert_allclose(sensor.acceleration, expected, rtol=0, atol=1e-12 * largest)


def test_rates_are_those_of_readings(thrown):
    """By central differences, where steps resolve what vibrates."""
    run = simulate(thrown.with_settings(step=5e-6, t_end=0.01))
    for name in ("end", "middle", "gauge"):
        sensor = run.sensor(f"beam.{name}")
        difference = (sensor.value[2:] - sensor.value[:-2]) / 1e-5
        assert np.abs(difference - sensor.rate[1:-1]).max() < 0.03 * np.abs(sensor.rate).max()


def test_a_point_reads_the_field_there(run, element):
    """Of the recovery, from the loads that were recorded, patterns among them."""
    points = element.recovery.points + element.center
    node = int(np.abs(points - [0.5, 0, 0]).sum(axis=1).argmin())
    field = run.displacement("beam", run.time)[:, node]
    expected = run.sensor("beam.end").value
    # the recovery is kept in double precision as long as it is in memory
    assert np.abs(field - expected).max() < 1e-11 * np.abs(expected).max()


@pytest.mark.parametrize("start", ["given", "equilibrium"])
def test_the_same_of_a_clamped_beam(element, start):
    model = Model(
        {"beam": FlexibleBody(element)},
        [Fixed("ground", "beam.root", name="clamp")],
        [PatternLoad("beam", "wind", Harmonic(2.0, 50.0, 0.4, 1.0))],
        settings=Settings(t_end=0.02, step=H, start=start),
    )
    run = simulate(model)
    points = element.recovery.points + element.center
    node = int(np.abs(points - [0.5, 0, 0]).sum(axis=1).argmin())
    field, expected = run.displacement("beam", run.time)[:, node], run.sensor("beam.end").value
    assert np.abs(field - expected).max() < 1e-11 * np.abs(expected).max()


def test_a_gauge_reads_the_moment_over_the_stiffness(element):
    """A cantilever at rest under a force on its tip: strain = -F L y / EI at the root."""
    model = Model(
        {"beam": FlexibleBody(element)},
        [Fixed("ground", "beam.root", name="clamp")],
        [Force("beam.tip", [0, 1e-4, 0], Constant(1.0))],
        settings=Settings(t_end=H, step=H, start="equilibrium"),
    )
    strain = simulate(model).sensor("beam.gauge").value[0, 0]
    assert strain == pytest.approx(-1e-4 * 0.5 * 0.003 / 5.5, rel=1e-7)


def test_readings_in_a_file_and_by_name(thrown, run, tmp_path):
    simulate(thrown, output=tmp_path / "run.h5")
    again = Results.read(tmp_path / "run.h5")
    assert again.sensors == ("beam.end", "beam.middle", "beam.gauge")
    assert again.patterns == ("beam.wind", "beam.pull")
    for name in again.sensors:
        np.testing.assert_array_equal(again.sensor(name).value, run.sensor(name).value)
    strain = evaluate(again, "strain:beam.gauge")
    assert strain.values.shape == (251,)
    np.testing.assert_array_equal(strain.values, run.sensor("beam.gauge").value[:, 0])
    acceleration = evaluate(again, "sensor_acceleration:beam.end:z")
    np.testing.assert_array_equal(acceleration.values, run.sensor("beam.end").acceleration[:, 2])
    assert evaluate(again, "pattern_load:beam.wind").values[0] == pytest.approx(
        2.0 * np.sin(0.4), rel=0.1
    )
    with pytest.raises(QuantityError, match=r"sensor 'beam.end' reads motion, not strain"):
        evaluate(again, "strain:beam.end")
    assert again.unit("sensors", "beam.gauge", "rate") == "s-1"
    assert again.unit("sensors", "beam.end", "acceleration") == "m s-2"
    with h5py.File(tmp_path / "run.h5") as file:
        assert file["sensor_channel"].asstr()[3] == "beam.middle.x"


def test_output_takes_sensors_by_name(thrown):
    from duhamel.solver import OutputRequest

    model = thrown.with_settings(t_end=0.002, output=OutputRequest(1, ["sensors/beam.gauge"]))
    assert simulate(model).sensors == ("beam.gauge",)


def test_a_sensor_carries_no_load(element):
    body = {"beam": FlexibleBody(element)}
    with pytest.raises(ModelError, match="no frame 'end' on 'beam'"):
        Model(body, loads=[Force("beam.end", [1, 0, 0], Constant(1.0))])


def test_sensors_do_not_change_the_motion(thrown, run, element):
    patterns = replace(
        element,
        channels=replace(
            element.channels, sensors=(), phi=element.channels.phi[: len(element.patterns)]
        ),
        recovery=None,
    )
    body = replace(thrown.bodies["beam"], superelement=patterns)
    without = simulate(replace(thrown, bodies={"beam": body}))
    found, expected = without.frame("beam.tip").u, run.frame("beam.tip").u
    # The library that multiplies matrices sums in another order where there are more rows.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())


def test_a_simulator_has_readings(thrown):
    expected = simulate(thrown.with_settings(t_end=20 * H)).sensor("beam.middle")
    names = ["sensors/beam.middle/value", "sensors/beam.middle/acceleration"]
    simulator = Simulator(thrown, names)
    for _ in range(20):
        found = simulator.step([])
    np.testing.assert_allclose(found[:3], expected.value[-1], rtol=1e-9)
    np.testing.assert_allclose(found[3:], expected.acceleration[-1], rtol=1e-9)


def test_a_frequency_response_of_a_gauge(element):
    """At 0 Hz: the moment over the stiffness, of a force and of a load pattern."""
    model = Model(
        {"beam": FlexibleBody(element)},
        [Fixed("ground", "beam.root", name="clamp")],
        [PatternLoad("beam", "wind", Constant(0.0))],
        settings=Settings(t_end=H, step=H),
    )
    linear = linearize(model)
    found = linear.static(["force:beam.tip:y"], ["strain:beam.gauge"]).values[0, 0, 0]
    assert found.real == pytest.approx(-0.5 * 0.003 / 5.5, rel=1e-7)
    spread = linear.static(["load:1"], ["strain:beam.gauge"]).values[0, 0, 0]
    # on the outer half: the moment q L^2 (1/2) (3/4), and the pull along the beam
    expected = -0.003 * (0.25 * 0.375) / 5.5 + 0.3 * 0.25 / 2.16e7
    assert spread.real == pytest.approx(expected, rel=1e-6)


def test_the_balance_of_vibration_leaves_readings_out(tmp_path):
    """Stresses of many Pascals are no motions of a body that is known by its kernel."""
    body = channelled_beam(tmp_path, 3, impulse=Impulse(step=H, steps=60, method="march"))
    names = [sensor.name for sensor in body.element.sensors]
    assert body.element.modes is None
    model = Model(
        {"beam": FlexibleBody(body.element)},
        loads=[PatternLoad("beam", "wind", Harmonic(1.0, 200.0))],
        settings=Settings(t_end=50 * H, step=H),
    )
    channels = body.element.channels
    n = body.element.n_c + len(channels.patterns)
    scale = np.ones(n + 7)
    scale[n:] = 1e9
    loud = replace(
        channels,
        kernel=replace(
            channels.kernel,
            g=channels.kernel.g * np.outer(scale, scale),
            g_initial=channels.kernel.g_initial * np.outer(scale, scale),
        ),
        compliance=channels.compliance * np.outer(scale, scale),
        accelerance=channels.accelerance * np.outer(scale, scale),
    )
    louder = replace(model, bodies={"beam": FlexibleBody(replace(body.element, channels=loud))})
    a, b = (simulate(m).validity.checks for m in (model, louder))
    np.testing.assert_array_equal(*([check.value for check in checks] for checks in (a, b)))
    assert len(names) == 3


def test_files_without_channels_are_as_before(coarse, tmp_path):
    write(tmp_path / "body.h5", coarse)
    again = read(tmp_path / "body.h5")
    assert again.channels is None
    assert again.patterns == again.sensors == ()
    np.testing.assert_array_equal(again.complete_compliance, coarse.compliance)
