"""Load patterns and sensors of superelements, made by hand."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.superelement import (
    Channels,
    Pattern,
    Sensor,
    SuperelementError,
    read,
    sample_kernel,
    write,
)

PATTERN = Pattern("push", [1.0, 0, 0], [0, 0, 2.0])
SENSORS = (Sensor("point", "motion", [0, 0, 1]), Sensor("gauge", "strain", [0, 1, 0]))


@pytest.fixture
def element(make_element):
    plain = replace(make_element(2), recovery=None)
    phi = np.random.default_rng(5).normal(size=(5, len(plain.modes.omega)))
    return replace(plain, channels=Channels((PATTERN,), SENSORS, phi))


@pytest.fixture
def marched(element):
    """The same without modes."""
    modes, kernel = element.complete_modes(element.modes), element.kernel
    channels = Channels(
        (PATTERN,),
        SENSORS,
        kernel=sample_kernel(modes, kernel.h, kernel.scheme, kernel.steps, kernel.error),
        compliance=modes.compliance,
        accelerance=modes.accelerance,
    )
    return replace(element, modes=None, channels=channels)


def test_rows_stand_behind_those_of_interfaces(element):
    assert (element.n_c, element.n_channels) == (9, 5)
    assert element.channels.pattern_row("push") == 0
    assert element.channels.rows_of_sensors() == {"point": slice(1, 4), "gauge": slice(4, 5)}
    complete = element.complete_modes(element.modes)
    np.testing.assert_array_equal(complete.phi[9:], element.channels.phi)
    np.testing.assert_array_equal(complete.phi[:9], element.modes.phi)


def test_modes_and_kernel_say_the_same(element, marched):
    h, scheme = element.kernel.h, element.kernel.scheme
    for name in ("compliance", "accelerance"):
        a, b = (getattr(e, f"complete_{name}") for e in (element, marched))
        np.testing.assert_array_equal(a, b)
    a, b = (e.complete_kernel_for(h, scheme, 7).g for e in (element, marched))
    np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12 * np.abs(a).max())
    with pytest.raises(SuperelementError, match="no modes, so the kernel is fixed"):
        marched.complete_kernel_for(0.5 * h, scheme, 7)


@pytest.mark.parametrize("kind", ["element", "marched"])
def test_channels_come_back_to_the_last_bit(kind, tmp_path, request):
    body = request.getfixturevalue(kind)
    write(tmp_path / "body.h5", body)
    again = read(tmp_path / "body.h5").channels
    assert again.patterns[0].name == "push"
    np.testing.assert_array_equal(again.patterns[0].moment, PATTERN.moment)
    assert [(s.name, s.kind) for s in again.sensors] == [("point", "motion"), ("gauge", "strain")]
    for name in ("phi", "compliance", "accelerance"):
        a, b = getattr(again, name), getattr(body.channels, name)
        assert (a is None) == (b is None)
        if a is not None:
            np.testing.assert_array_equal(a, b)


FAULTS = {
    "negative": ("channels/compliance", lambda A: -A, "channels/compliance"),
    "other interfaces": ("channels/g", lambda g: g + 1e-3 * np.eye(14), "channels/g"),
    "other size": ("channels/accelerance", lambda A: A[:3, :3], "channels/accelerance"),
    "other sensor": ("channels/sensor/kind", lambda kinds: [b"heat", b"strain"], "sensor 'point'"),
    "asymmetric": ("channels/g", lambda g: g * np.arange(1.0, 15.0), "symmetric"),
}


@pytest.mark.parametrize(("place", "change", "message"), FAULTS.values(), ids=FAULTS)
def test_a_damaged_channel_is_one_error(marched, tmp_path, place, change, message):
    write(tmp_path / "body.h5", marched)
    with h5py.File(tmp_path / "body.h5", "r+") as file:
        changed = change(file[place][()])
        del file[place]
        file[place] = changed
    with pytest.raises(SuperelementError, match=message):
        read(tmp_path / "body.h5")


def test_messages(element):
    channels = element.channels
    with pytest.raises(SuperelementError, match=r"channels: phi: expected shape \(5, m\)"):
        replace(channels, phi=channels.phi[:3])
    with pytest.raises(SuperelementError, match="expected 4 columns, one per mode, found 2"):
        replace(element, channels=replace(channels, phi=channels.phi[:, :2]))
    with pytest.raises(SuperelementError, match="without modes expected a kernel"):
        replace(element, modes=None)
    with pytest.raises(SuperelementError, match="sensors: expected different names"):
        Channels((), (SENSORS[0], SENSORS[0]), np.zeros((6, 4)))
    taken = Channels((Pattern("face 0", [1, 0, 0], [0, 0, 0]),), (), np.zeros((1, 4)))
    with pytest.raises(SuperelementError, match="other names than those of interfaces"):
        replace(element, channels=taken)
    with pytest.raises(SuperelementError, match="no load pattern 'pull'; there are: push"):
        channels.pattern_row("pull")
    with pytest.raises(SuperelementError, match="sensor 'a': kind: expected motion"):
        Sensor("a", "heat", [0, 0, 0])
