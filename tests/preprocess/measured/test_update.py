"""A model with measured frequencies and damping: a plate unlike the one that was tested."""

import duhamel as du
import numpy as np
import pytest
import skfem
from duhamel import preprocess, superelement
from duhamel.preprocess import Body, MeasurementError
from duhamel.preprocess.body.measured import Measured, MeasuredRigid
from duhamel.preprocess.measured.matching import mac, matched

LENGTH, WIDTH = 0.3, 0.06
PLACES = {
    f"a{i}{k}": (x, y)
    for i, x in enumerate((0.0, 0.08, 0.16, 0.22, LENGTH))
    for k, y in enumerate((0.0, WIDTH))
}
STEP = 2e-5


def plate(thickness=0.01, E=2.1e11, rho=7850.0, sensors=False):
    """A plate whose lower face stays at z = 0."""
    lines = np.linspace(0.0, LENGTH, 16), np.linspace(0.0, WIDTH, 4), np.linspace(0.0, thickness, 3)
    mesh = skfem.MeshHex.init_tensor(*lines)
    part = du.Part(mesh, du.Material(E=E, nu=0.3, rho=rho), name="plate")
    part.interface("left", du.plane(x=0.0))
    part.interface("right", du.plane(x=LENGTH))
    if sensors:
        for name, place in PLACES.items():
            part.sensor(name, (*place, 0.0))
    return part


@pytest.fixture(scope="module")
def truth():
    """The plate that is tested, with all of its modes."""
    return preprocess.build(plate(sensors=True).body(STEP, 100 * STEP, method="modal"))


N_MEASURED = 8
ZETA = np.array([0.4, 0.7, 0.5, 1.1, 0.9, 0.6, 0.8, 1.3]) * 1e-2


def measured_modes(truth):
    """Frequencies, damping and shapes (m, 2 n) in y and z at the sensors."""
    chosen = np.argsort(truth.modes.omega)[:N_MEASURED]
    phi = truth.channels.phi.reshape(-1, 3, len(truth.modes.omega))[:, 1:, chosen]
    return truth.modes.omega[chosen] / (2.0 * np.pi), ZETA, phi.reshape(-1, N_MEASURED).T


def write_channels(path, axes=("y", "z"), scale=1.0):
    lines = ["label, x, y, z, axis"]
    for name, (x, y) in PLACES.items():
        lines += [f"{name}, {scale * x}, {scale * y}, 0.0, {axis}" for axis in axes]
    path.write_text("\n".join(lines))
    return path


def write_modes(path, frequency, damping, shapes):
    names = [f"{name}:{axis}" for name in PLACES for axis in ("y", "z")]
    rows = np.column_stack([frequency, damping, shapes])
    lines = [", ".join(["frequency", "damping", *names])]
    lines += [", ".join(f"{value:.12g}" for value in row) for row in rows]
    path.write_text("\n".join(lines))
    return path


def values_of(body):
    return {key: getattr(body, key) for key in body.model_fields_set}


def updated_by(folder, truth, changes=lambda *modes: modes, rigid=None, **options):
    """A plate that is 4 % too thick and 4 % too soft, with the test of the true one."""
    modes = changes(*measured_modes(truth))
    asked = Measured(
        modes=write_modes(folder / "modes.csv", *modes),
        channels=write_channels(folder / "channels.csv"),
        update="frequencies",
        rigid=rigid or MeasuredRigid(),
        **options,
    )
    body = plate(1.04 * 0.01, 0.96 * 2.1e11).body(STEP, 100 * STEP, method="modal")
    return Body.model_validate({**values_of(body), "measured": asked})


def transfer_errors(element, truth, f):
    """Relative errors (k,) of the compliances of the interfaces at frequencies."""
    s = 2j * np.pi * f

    def compliance(modes):
        h = 1.0 / (s[:, None] ** 2 + 2.0 * modes.zeta * modes.omega * s[:, None] + modes.omega**2)
        return np.einsum("im,km,jm->kij", modes.phi, h, modes.phi)

    exact = compliance(truth.modes)
    difference = np.abs(compliance(element.modes) - exact).max(axis=(1, 2))
    return difference / np.abs(exact).max(axis=(1, 2))


def test_modes_have_the_frequencies_and_the_damping_of_the_test(truth, tmp_path):
    doubts = []
    element = preprocess.build(updated_by(tmp_path, truth), on_warning=doubts.append)
    assert doubts == []
    frequency, damping, _ = measured_modes(truth)
    found = element.measured
    assert found.matched.all()
    assert (found.mac > 0.98).all()
    np.testing.assert_allclose(found.complexity, 0.0, atol=1e-12)
    error = found.calculated / frequency - 1.0
    assert np.abs(error).max() > 0.005
    own = element.modes.omega / (2.0 * np.pi)
    for f, zeta in zip(frequency, damping, strict=True):
        k = int(np.abs(own - f).argmin())
        assert own[k] == pytest.approx(f, rel=1e-10)
        assert element.modes.zeta[k] == pytest.approx(zeta, rel=1e-10)
    others = np.isclose(element.modes.zeta, np.median(damping), rtol=1e-10)
    assert others.sum() == len(own) - N_MEASURED
    checks = superelement.check(element)
    assert all(check.holds for check in checks)


def test_the_model_comes_nearer_to_the_part(truth, tmp_path):
    """At resonances, with the damping of the part, by a factor of ten."""
    true = superelement.Modes(
        truth.modes.omega, np.full(len(truth.modes.omega), 0.01), truth.modes.phi
    )
    zeta = true.zeta.copy()
    zeta[np.argsort(true.omega)[:N_MEASURED]] = ZETA
    true = superelement.Modes(true.omega, zeta, true.phi)

    class Part:
        modes = true

    body = updated_by(tmp_path, truth)
    plain = preprocess.build(body.model_copy(update={"measured": None}))
    updated = preprocess.build(body)
    f = np.concatenate([np.linspace(0.97, 1.03, 61) * f0 for f0 in measured_modes(truth)[0]])
    before, after = (np.median(transfer_errors(element, Part, f)) for element in (plain, updated))
    assert after < 0.1 * before
    assert after < 0.08


def test_the_mass_that_was_weighed_scales_densities(truth, tmp_path):
    rigid = MeasuredRigid(mass=truth.mass, inertia=tuple(np.diag(truth.J_rot)))
    element = preprocess.build(updated_by(tmp_path, truth, rigid=rigid))
    assert element.mass == pytest.approx(truth.mass, rel=1e-10)
    np.testing.assert_allclose(np.diag(element.J_rot), np.diag(truth.J_rot), rtol=1e-12)
    plain = preprocess.build(updated_by(tmp_path, truth))
    assert plain.mass == pytest.approx(1.04 * truth.mass, rel=1e-10)
    # Mass-normalized shapes grow as the mass falls.
    ratio = np.linalg.norm(element.modes.phi) / np.linalg.norm(plain.modes.phi)
    assert ratio == pytest.approx(np.sqrt(1.04), rel=1e-6)


def test_files_have_what_was_matched(truth, tmp_path):
    element = preprocess.build(updated_by(tmp_path, truth))
    superelement.write(element, tmp_path / "plate.h5")
    again = superelement.read(tmp_path / "plate.h5")
    for key in ("frequency", "damping", "calculated", "mac", "complexity"):
        np.testing.assert_array_equal(getattr(again.measured, key), getattr(element.measured, key))
    assert "measured_a00" in [sensor.name for sensor in again.channels.sensors]


def test_pairs_do_not_depend_on_order_scale_and_sign(truth, tmp_path):
    rng = np.random.default_rng(1)

    def mixed(frequency, damping, shapes):
        order = rng.permutation(N_MEASURED)
        scales = rng.uniform(0.1, 10.0, N_MEASURED) * rng.choice([-1.0, 1.0], N_MEASURED)
        return frequency[order], damping[order], (scales[:, None] * shapes)[order]

    one, other = (
        preprocess.build(updated_by(tmp_path, truth, how)) for how in (lambda *m: m, mixed)
    )
    np.testing.assert_allclose(one.modes.omega, other.modes.omega, rtol=1e-10)
    np.testing.assert_allclose(one.modes.zeta, other.modes.zeta, rtol=1e-10)


def test_noise_of_five_per_cent_changes_no_pair(truth, tmp_path):
    rng = np.random.default_rng(2)

    def noisy(frequency, damping, shapes):
        size = np.sqrt((shapes**2).mean(axis=1, keepdims=True))
        return frequency, damping, shapes + 0.05 * size * rng.standard_normal(shapes.shape)

    element = preprocess.build(updated_by(tmp_path, truth, noisy))
    exact = preprocess.build(updated_by(tmp_path, truth))
    np.testing.assert_array_equal(element.measured.calculated, exact.measured.calculated)


def test_a_mode_that_the_model_does_not_have_is_left_out_with_a_word(truth, tmp_path):
    rng = np.random.default_rng(3)

    def strange(frequency, damping, shapes):
        shapes = shapes.copy()
        shapes[3] = rng.standard_normal(shapes.shape[1])
        return frequency, damping, shapes

    doubts = []
    element = preprocess.build(updated_by(tmp_path, truth, strange), on_warning=doubts.append)
    f = measured_modes(truth)[0][3]
    (doubt,) = doubts
    assert f"the mode at {f:.5g} Hz is not used" in doubt
    assert element.measured.matched.sum() == N_MEASURED - 1


def test_shapes_of_other_channels_are_like_no_mode(truth, tmp_path):
    """Those of sensors along one edge alone, while the channels are those of both."""

    def one_edge(frequency, damping, shapes):
        seen = shapes.reshape(N_MEASURED, len(PLACES), 2).copy()
        seen[:, :, 0] = 0.0
        seen[:, 1::2] = 0.0
        return frequency, damping, seen.reshape(N_MEASURED, -1)

    with pytest.raises(MeasurementError, match="no mode of the mesh is like a measured one"):
        preprocess.build(updated_by(tmp_path, truth, one_edge, least_mac=0.9))


def test_channels_that_do_not_tell_modes_apart_are_named(tmp_path):
    """Of shapes that differ where no channel is."""
    shapes = np.array([[1.0, 0.5, 0.0], [1.0, 0.5, 0.01], [0.0, 0.1, 1.0]])
    pairs = matched((np.array([100.0]), shapes[:1]), (np.array([98.0, 110.0, 120.0]), shapes), 0.8)
    assert pairs.mode.tolist() == [0]
    assert pairs.rivals.tolist() == [1]
    # A mode far away is no rival, whatever its shape.
    far = matched((np.array([100.0]), shapes[:1]), (np.array([98.0, 150.0, 120.0]), shapes), 0.8)
    assert far.rivals.tolist() == [-1]


def test_no_mode_is_in_two_pairs():
    """The best pair of each alone would take the same mode twice."""
    model = np.array([[1.0, 0.0, 0.0], [0.9, 0.4, 0.0]])
    measured = np.array([[1.0, 0.1, 0.0], [1.0, 0.15, 0.0]])
    frequencies = np.array([100.0, 101.0])
    pairs = matched((frequencies, measured), (frequencies, model), 0.8)
    assert mac(measured, model).argmax(axis=1).tolist() == [0, 0]
    assert pairs.mode.tolist() == [0, 1]


def test_surfaces_keep_what_the_modes_do_not_have(truth, tmp_path):
    """The compliance of nodes changes by that of the modes alone."""
    part = plate(1.04 * 0.01, 0.96 * 2.1e11)
    part.surface("low", du.plane(z=0.0))
    body = part.body(STEP, 100 * STEP, band=4000.0)
    asked = updated_by(tmp_path, truth).measured
    changed = Body.model_validate({**values_of(body), "measured": asked})
    # The sensors of the test give the plain one the same modes.
    for name, place in PLACES.items():
        part.sensor(f"measured_{name}", (*place, 0.0))
    body = part.body(STEP, 100 * STEP, band=4000.0)
    plain, element = preprocess.build(body), preprocess.build(changed)

    def rest(element):
        surfaces, modes = element.surfaces, element.modes
        return surfaces.H - (surfaces.phi * modes.omega**-2.0) @ surfaces.phi.T

    scale = np.abs(plain.surfaces.H).max()
    np.testing.assert_allclose(rest(element), rest(plain), rtol=0.0, atol=1e-9 * scale)
    assert np.abs(element.surfaces.H - plain.surfaces.H).max() > 1e-3 * scale


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        (
            "modes.csv",
            ("damping", "dampin"),
            r"modes.csv: expected a column for each channel, found no damping and dampin, which",
        ),
        (
            "modes.csv",
            ("0.004", "0.4"),
            r"modes.csv: damping: expected ratios .* found 0.4: is it in per cent\?",
        ),
        (
            "channels.csv",
            ("a00, 0.0", "a00, ?"),
            r"channels.csv: line 2: x, y, z: expected numbers, found '\?'",
        ),
        (
            "channels.csv",
            ("0.0, y\n", "0.0, w\n"),
            r"channels.csv: line 2: axis: expected x, y or z, found 'w'",
        ),
        (
            "channels.csv",
            ("label,", "name,"),
            r"channels.csv: expected the columns label, x, y, z and either",
        ),
    ],
)
def test_wrong_tables_are_one_line(truth, tmp_path, name, change, message):
    body = updated_by(tmp_path, truth)
    path = tmp_path / name
    text = path.read_text()
    assert change[0] in text
    path.write_text(text.replace(*change, 1))
    with pytest.raises(MeasurementError, match=message) as caught:
        preprocess.build(body)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["modes.csv", "channels.csv", "modes.npz"])
@pytest.mark.parametrize(
    ("contents", "message"),
    [(None, "no such file"), (b"", "expected|not readable"), (b"\xff\xfe\x00" * 9, "not")],
)
def test_files_that_are_none_are_one_line(truth, tmp_path, name, contents, message):
    body = updated_by(tmp_path, truth)
    (tmp_path / name).unlink(missing_ok=True)
    if contents is not None:
        (tmp_path / name).write_bytes(contents)
    if name == "modes.npz":
        asked = body.measured.model_copy(update={"modes": tmp_path / name})
        body = body.model_copy(update={"measured": asked})
    with pytest.raises(MeasurementError, match=rf"{name}: .*{message}") as caught:
        preprocess.build(body)
    assert "\n" not in str(caught.value)


def test_sensors_beside_the_mesh_are_on_its_nearest_node(truth, tmp_path):
    """Up to where they are rather in millimeters."""
    body = updated_by(tmp_path, truth)
    exact = preprocess.build(body)
    write_channels(tmp_path / "channels.csv", scale=1.001)
    near = preprocess.build(body)
    np.testing.assert_array_equal(near.measured.mac, exact.measured.mac)
    write_channels(tmp_path / "channels.csv", scale=1e3)
    with pytest.raises(MeasurementError, match=r"sensor a01: .* in m, found .* from the nearest"):
        preprocess.build(body)


def test_complex_modes_are_warned_of_and_refused(truth, tmp_path):
    frequency, damping, shapes = measured_modes(truth)
    names = np.array([f"{name}:{axis}" for name in PLACES for axis in ("y", "z")])
    rng = np.random.default_rng(4)

    def write(part):
        turned = shapes * np.exp(1j * (0.7 + part * rng.standard_normal(shapes.shape)))
        np.savez(
            tmp_path / "m.npz",
            frequency=frequency,
            damping=damping,
            shapes=turned[:, ::-1],
            channels=names[::-1],
        )

    body = updated_by(tmp_path, truth)
    asked = body.measured.model_copy(update={"modes": tmp_path / "m.npz"})
    body = body.model_copy(update={"measured": asked})
    write(0.0)
    np.testing.assert_allclose(preprocess.build(body).measured.complexity, 0.0, atol=1e-12)
    doubts = []
    write(0.15)
    complexity = preprocess.build(body, on_warning=doubts.append).measured.complexity
    warned = [f for f, part in zip(frequency, complexity, strict=True) if part > 0.1]
    told = [doubt.split(" Hz is complex")[0] for doubt in doubts if " Hz is complex: " in doubt]
    assert [text.split("at ")[-1] for text in told] == [f"{f:.5g}" for f in sorted(warned)]
    assert 0 < len(warned) < N_MEASURED
    write(0.6)
    with pytest.raises(MeasurementError, match=r"is complex: \d\d % .* expected at most 30 %"):
        preprocess.build(body)


def test_what_does_not_go_with_a_test_is_refused(truth, tmp_path):
    values = values_of(updated_by(tmp_path, truth))
    for changes, message in (
        ({"damping": {"modal": 0.02}}, "damping: with .measured. it is that of the test"),
        ({"impulse": {"step": STEP, "steps": 10, "method": "march"}}, "measured: needs modes"),
        (
            {
                "measured": {
                    **values["measured"].model_dump(),
                    "rigid": {"inertia": (1.0, 1.0, 3.0)},
                }
            },
            "inertia: expected three positive moments",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            Body.model_validate({**values, **changes})
