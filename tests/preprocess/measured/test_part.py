"""Superelements of a part that was only tested, beside the mesh whose answers the test has."""

import re

import duhamel as du
import h5py
import numpy as np
import pytest
import pyuff
import scipy.io
from duhamel import preprocess, superelement
from duhamel.preprocess import BodyError, MeasuredBody, MeasurementError

from .hammer_bench import ALL, AROUND, HITS, SENSORS, Errors, measure, replace, truth

BANDS = (20.0, 1000.0), (1000.0, 3000.0), (3000.0, 4500.0)
NAMES = [f"{label}:{axis}" for label in SENSORS for axis in "xyz"]


def built(bench, folder, **keys):
    return preprocess.build(preprocess.read_body(bench.write(folder, **keys)))


def errors_of_interfaces(element):
    """Accelerances of both interfaces against those of the mesh, rms by bands."""
    part, names = truth(), tuple(AROUND)
    own = tuple(np.vstack(rows) for rows in zip(*(part.rows(name) for name in names), strict=True))
    f = np.arange(20.0, 4500.0, 4.0)
    s = 2j * np.pi * f
    expected = part.accelerance(s, own, own)
    omega, zeta, phi = element.modes.omega, element.modes.zeta, element.modes.phi
    h = s[:, None] ** 2 / (s[:, None] ** 2 + 2.0 * zeta * omega * s[:, None] + omega**2)
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = element.mass * np.eye(3), element.J_rot
    found = np.einsum("am,km,bm->kab", phi, h, phi) + own[0] @ np.linalg.solve(M, own[0].T)
    size = np.sqrt(np.abs(np.einsum("kaa->ka", expected)).mean(axis=0))
    scaled = np.outer(size, size)
    difference, whole = np.abs((found - expected) / scaled) ** 2, np.abs(expected / scaled) ** 2
    chosen = [(f >= low) & (f < high) for low, high in BANDS]
    return [float(np.sqrt(difference[k].sum() / whole[k].sum())) for k in chosen]


def of_modes(element, count=9):
    """Largest errors of frequencies and damping ratios of the first modes."""
    part = truth()
    omega, zeta = part.element.modes.omega[:count], part.zeta[:count]
    nearest = np.abs(element.modes.omega[:, None] - omega).argmin(axis=0)
    return (
        np.abs(element.modes.omega[nearest] / omega - 1.0).max(),
        np.abs(element.modes.zeta[nearest] / zeta - 1.0).max(),
    )


@pytest.mark.parametrize(
    ("errors", "frequency", "damping", "bands"),
    [
        (Errors(), 3e-5, 3e-3, (0.01, 0.03, 0.1)),
        (replace(ALL), 1e-4, 1e-2, (0.08, 0.08, 0.12)),
        (replace(ALL, mass=0.008), 2e-3, 0.1, (0.12, 0.16, 0.2)),
        pytest.param(
            replace(ALL, window=9.2), 1e-4, 1e-2, (0.08, 0.08, 0.12), marks=pytest.mark.validation
        ),
    ],
    ids=["exact", "with errors", "sensors of 8 g", "window"],
)
def test_a_tested_part_answers_as_its_mesh(errors, frequency, damping, bands, tmp_path):
    element = built(measure(errors), tmp_path)
    found = of_modes(element)
    assert found[0] < frequency
    assert found[1] < damping
    for error, most in zip(errors_of_interfaces(element), bands, strict=True):
        assert error < most
    superelement.write(element, tmp_path / "angle.h5")
    again = superelement.read(tmp_path / "angle.h5")
    assert all(check.holds for check in superelement.check(again))
    assert re.fullmatch(
        r"measured with \d+ modes, misfit 0\.0\d+ of the responses, at most [\d.]+ % out of phase",
        again.provenance.method,
    )
    assert [sensor.name for sensor in again.sensors] == ["measured_7", "measured_8"]
    assert again.kernel.band == pytest.approx(4500.0)


def test_three_channels_in_a_plane_are_no_sensor_of_a_body(coarse, tmp_path):
    path = coarse.write(tmp_path, accept=1.0)
    lines = (tmp_path / "channels.csv").read_text().splitlines()
    half = f"{np.sqrt(0.5):.6f}"
    dxyz = {"x": "1,0,0", "y": "0,1,0", "z": "0,0,1"}
    turned = [f"{line[:-1]}{dxyz[line[-1]]}" for line in lines[1:]]
    turned[-1] = turned[-1].replace("0,0,1", f"{half},{half},0")
    (tmp_path / "channels.csv").write_text("\n".join(["label,x,y,z,dx,dy,dz", *turned]))
    element = preprocess.build(preprocess.read_body(path))
    assert [sensor.name for sensor in element.sensors] == ["measured_7"]


def test_the_mass_of_a_sensor_whose_motion_is_not_known_is_refused(coarse, tmp_path):
    path = coarse.write(tmp_path, sensor_mass=0.008)
    lines = (tmp_path / "channels.csv").read_text().splitlines()
    gone = [k for k, line in enumerate(lines[1:]) if line.startswith("8") and line[-1] != "x"]
    (tmp_path / "channels.csv").write_text(
        "\n".join(line for k, line in enumerate(lines) if k - 1 not in gone)
    )
    kept = [k for k in range(len(NAMES)) if k not in gone]
    np.savez(tmp_path / "angle.npz", f=coarse.f, H=coarse.H[:, kept], quantity="accelerance")
    with pytest.raises(MeasurementError, match="sensor 8 is at no interface, and does not measure"):
        preprocess.build(preprocess.read_body(path))


def test_masses_of_sensors_that_are_not_told_are_in_the_modes(tmp_path):
    bench = measure(replace(ALL, mass=0.008))
    assert of_modes(built(replace(bench, errors=ALL), tmp_path))[0] > 0.02


def write_uff(path, bench, quantity=12, power=0, signs=None, binary=0, function=4):
    """Sets 58 of all pairs; signs: of the directions of hits, else along the axes."""
    file = pyuff.UFF(str(path))
    s = 2j * np.pi * bench.f
    sets = []
    for i, (label, (_, direction)) in enumerate(HITS.items()):
        axis = int(np.abs(direction).argmax())
        sign = 1 if signs == "axes" else int(direction[axis])
        for o, name in enumerate(NAMES):
            sensor, _, letter = name.partition(":")
            # A response along -x is that along x with another sign; some programs write these.
            turned = -1 if o % 5 == 0 else 1
            data = turned * (int(direction[axis]) * sign) * bench.H[:, o, i] / s**power
            sets.append(
                pyuff.prepare_58(
                    binary=binary, func_type=function, rsp_node=int(sensor),
                    rsp_dir=turned * ("xyz".index(letter) + 1), ref_node=int(label),
                    ref_dir=sign * (axis + 1), data=data, x=bench.f, id1="frf",
                    rsp_ent_name="NONE", ref_ent_name="NONE", abscissa_spacing=0,
                    abscissa_spec_data_type=18, ordinate_spec_data_type=quantity,
                    orddenom_spec_data_type=13, ord_data_type=6, num_pts=len(bench.f), **EMPTY,
                )
            )  # fmt: skip
    # By its mode "overwrite" pyuff cuts off the head of a first set that is binary.
    path.unlink(missing_ok=True)
    file.write_sets(sets, mode="add")
    return path


EMPTY = (
    dict.fromkeys(("id2", "id3", "id4", "id5"), "none")
    | dict.fromkeys(
        (
            *("ver_num", "load_case_id", "z_axis_spec_data_type"),
            *(
                f"{axis}_{unit}_unit_exp"
                for axis in ("abscissa", "ordinate", "orddenom", "z_axis")
                for unit in ("len", "force", "temp")
            ),
        ),
        0,
    )
    | dict.fromkeys(
        (f"{axis}_axis_units_lab" for axis in ("abscissa", "ordinate", "orddenom", "z_axis")),
        "none",
    )
)


@pytest.fixture(scope="module")
def coarse():
    """Few lines, which suffice to compare files."""
    bench = measure(Errors(noise=0.01))
    kept = slice(None, None, 4)
    return replace(bench, f=bench.f[kept], H=bench.H[kept])


@pytest.fixture(scope="module")
def of_npz(coarse, tmp_path_factory):
    return built(coarse, tmp_path_factory.mktemp("npz"))


def same(element, other):
    for one, two in zip(
        (element.modes.omega, element.modes.zeta),
        (other.modes.omega, other.modes.zeta),
        strict=True,
    ):
        np.testing.assert_allclose(one, two, rtol=1e-6)
    np.testing.assert_allclose(
        element.compliance, other.compliance, atol=1e-6 * np.abs(other.compliance).max()
    )


@pytest.mark.parametrize(
    ("quantity", "power", "signs", "binary"),
    [(12, 0, None, 0), (11, 1, "axes", 1), (8, 2, None, 1)],
    ids=["accelerance", "mobility, 58b", "receptance, 58b"],
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # of pyuff's writer
def test_uff_files_of_all_quantities_are_one_part(
    quantity, power, signs, binary, coarse, of_npz, tmp_path
):
    write_uff(tmp_path / "angle.uff", coarse, quantity, power, signs, binary)
    same(built(coarse, tmp_path, frf="angle.uff"), of_npz)


def test_hdf5_and_matlab_files_with_names_in_another_order(coarse, of_npz, tmp_path):
    order = np.random.default_rng(0).permutation(len(NAMES))
    names, H = [NAMES[k] for k in order], coarse.H[:, order]
    with h5py.File(tmp_path / "angle.h5", "w") as file:
        file["f"], file["H"] = coarse.f, H
        file["outputs"], file["inputs"] = names, list(HITS)
        file["quantity"] = "accelerance"
    same(built(coarse, tmp_path, frf="angle.h5"), of_npz)
    cells = np.empty(len(names), dtype=object)
    cells[:] = names
    arrays = {"f": coarse.f, "H": H, "outputs": cells, "quantity": "accelerance"}
    scipy.io.savemat(tmp_path / "angle.mat", arrays)
    same(built(coarse, tmp_path, frf="angle.mat"), of_npz)


def spoilt(**changes):
    """Arrays of the file with changes."""

    def write(path, bench):
        arrays = {"f": bench.f, "H": bench.H, "quantity": "accelerance"} | changes
        np.savez(path, **{key: value for key, value in arrays.items() if value is not None})

    return write


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (lambda path, bench: path.write_bytes(b"no"), "angle.npz: not readable arrays"),
        (lambda path, bench: None, "angle.npz: no such file"),
        (spoilt(H=np.array([["a"]])), "angle.npz: not arrays of numbers"),
        (spoilt(H=None), "angle.npz: expected the arrays f and H, found no H"),
        (
            spoilt(H=np.ones((3, 2, 1))),
            r"H: expected frequencies, channels and hits \(\d+, 24, 20\)",
        ),
        (
            spoilt(quantity=None),
            "the file does not say what it has: measured.quantity: expected one",
        ),
        (
            spoilt(quantity="speed"),
            "expected one of accelerance, mobility, receptance, impulse, found 'speed'",
        ),
        (spoilt(outputs=["a"] * 24), "outputs: expected those of the table, each once; 1:x is not"),
        (spoilt(f=np.zeros(700)), r"H: expected|expected 20 frequencies \[Hz\] or more, ascending"),
    ],
)
def test_wrong_responses_are_refused_by_name(write, message, coarse, tmp_path):
    path = coarse.write(tmp_path)
    (tmp_path / "angle.npz").unlink()
    write(tmp_path / "angle.npz", coarse)
    with pytest.raises(MeasurementError, match=message):
        preprocess.build(preprocess.read_body(path))


def of_one(channel, hit, value):
    """Responses of one channel, of one hit or of both that are a number at some lines."""

    def write(path, bench):
        H = bench.H.copy()
        H[30:, channel, hit] = value
        if value == 0.0:
            H[:, channel, hit] = value
        spoilt(H=H)(path, bench)

    return write


@pytest.mark.parametrize(
    ("write", "message"),
    [
        (of_one(4, 3, np.nan), r"finite numbers, found nan.* in 2:y by 104 at \d+ Hz$"),
        (of_one(4, slice(None), np.inf), r"finite numbers, found inf.* in 2:y by 101 at \d+ Hz$"),
        (of_one(4, slice(None), 0.0), r"channel 2:y: expected responses, all are 0$"),
        (of_one(slice(None), 3, 0.0), r"hit 104: expected responses, all are 0$"),
    ],
)
def test_what_is_no_response_is_named(write, message, coarse, tmp_path):
    path = coarse.write(tmp_path)
    write(tmp_path / "angle.npz", coarse)
    with pytest.raises(MeasurementError, match=message):
        preprocess.build(preprocess.read_body(path))


def test_lines_that_go_back_are_named(coarse, tmp_path):
    path = coarse.write(tmp_path)
    spoilt(f=np.concatenate([coarse.f[:9], coarse.f[:-9]]))(tmp_path / "angle.npz", coarse)
    with pytest.raises(MeasurementError, match=r"ascending, found 20 after 52$"):
        preprocess.build(preprocess.read_body(path))


def test_the_band_is_that_of_the_lines_there_are(coarse, tmp_path):
    low = coarse.f < 2000.0
    element = built(replace(coarse, f=coarse.f[low], H=coarse.H[low]), tmp_path)
    assert element.kernel.band == pytest.approx(0.9 * coarse.f[low][-1])


def test_responses_per_displacement_or_over_time_are_refused(coarse, tmp_path):
    path = coarse.write(tmp_path, frf="angle.uff")
    few = replace(coarse, f=coarse.f[:40], H=coarse.H[:40])
    text = write_uff(tmp_path / "angle.uff", few).read_text().splitlines(keepends=True)
    # Records 9 and 11 of a set: abscissa and denominator.
    for record, message in ((10, r"set 1: expected frequencies \(18\)"), (12, "per force")):
        spoilt_lines = list(text)
        first = next(k for k, line in enumerate(text) if line.strip() == "58")
        k = first + record - 2
        spoilt_lines[k] = f"{17:10d}" + spoilt_lines[k][10:]
        (tmp_path / "angle.uff").write_text("".join(spoilt_lines))
        with pytest.raises(MeasurementError, match=message):
            preprocess.build(preprocess.read_body(path))


def test_uff_sets_that_cannot_be_read_or_are_missing_are_named(coarse, tmp_path):
    path = coarse.write(tmp_path, frf="angle.uff")
    few = replace(coarse, f=coarse.f[:40], H=coarse.H[:40])
    write_uff(tmp_path / "angle.uff", few)
    text = (tmp_path / "angle.uff").read_text()
    sets = text.split("    -1\n    -1\n")
    (tmp_path / "angle.uff").write_text("    -1\n    -1\n".join(sets[:-1]) + "    -1\n")
    with pytest.raises(MeasurementError, match=r"found no set of 8:z by 302$"):
        preprocess.build(preprocess.read_body(path))
    (tmp_path / "angle.uff").write_text(text + text)
    with pytest.raises(MeasurementError, match=r"expected each pair once, found 1:x by 101 twice"):
        preprocess.build(preprocess.read_body(path))
    (tmp_path / "angle.uff").write_text(text + "    -1\n    -1\n")
    with pytest.raises(MeasurementError, match=r"set 481: expected a UFF set, found none"):
        preprocess.build(preprocess.read_body(path))
    (tmp_path / "angle.uff").write_text(text.replace("E+", "no", 3).replace("e+", "no", 3))
    with pytest.raises(MeasurementError, match=r"angle.uff: not a readable UFF file"):
        preprocess.build(preprocess.read_body(path))
    (tmp_path / "angle.uff").write_text("    -1\n   151\n    -1\n")
    with pytest.raises(
        MeasurementError, match="expected sets 58 of frequency or impulse responses, found none"
    ):
        preprocess.build(preprocess.read_body(path))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("mass = 2", "mass = -2", "measured.rigid.mass: input should be greater than 0, found -2"),
        ("band = [20, 5000]", "band = [5000, 20]", "band: expected the lower frequency first"),
        ("band = [20, 5000]", "band = [20, 22]", r"measured.band: expected \d+ frequencies"),
        ("steps = 100", "steps = 100\nband = 900", "impulse: expected step, steps and rho_inf"),
        ("'1', '2', '3'", "'1', '2', '9'", "interfaces.foot.channels: no '9' in the table"),
        (
            "'1', '2', '3'",
            "'1', '2', '4'",
            "expected each of channels at one of them, found '4' twice",
        ),
        ("'1', '2', '3'", "'1'", "interfaces.foot: its channels do not tell its turn about"),
        (
            "'101', '102', '103', '104', '105', '106', '107', '108', '109'",
            "'101', '102', '103', '104'",
            "interfaces.foot: its hits do not (push|turn) it (along|about)",
        ),
        ('frf = "angle.npz"', 'frf = "angle.txt"', "expected a file .uff, .unv, .npz, .h5, .mat"),
        ("inertia = [[", "inertia = [[9", "inertia: expected three positive principal moments"),
    ],
)
def test_a_body_file_that_contradicts_itself_is_refused(old, new, message, coarse, tmp_path):
    path = coarse.write(tmp_path)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises((BodyError, MeasurementError), match=message):
        preprocess.build(preprocess.read_body(path))


def test_responses_of_another_part_are_refused(coarse, tmp_path):
    noise = np.random.default_rng(0).standard_normal(coarse.H.shape)
    with pytest.raises(
        MeasurementError, match=r"modes differ from those measured by 1\.\d+ of these"
    ):
        built(replace(coarse, H=noise.astype(complex)), tmp_path)


def test_three_directions_suffice_where_an_interface_does_not_turn(coarse, tmp_path):
    # Hits that turn it are no forces on a point: the fit is poor, which is no matter here.
    path = coarse.write(tmp_path, accept=1.0)
    text = path.read_text().replace("[impulse]", "rotations = false\n[impulse]")
    path.write_text(text.replace("channels = ['4', '5', '6']", "channels = ['4']"))
    body = preprocess.read_body(path)
    assert isinstance(body, MeasuredBody)
    element = preprocess.build(body)
    assert [interface.rotations for interface in element.interfaces] == [True, False]
    assert element.n_c == 9
    assert [sensor.name for sensor in element.sensors][:2] == ["measured_5", "measured_6"]


def test_a_part_of_python_has_a_mesh(coarse, tmp_path):
    with pytest.raises(BodyError, match="expected a mesh or matrices, found a test alone"):
        du.Part.read(coarse.write(tmp_path))


def held(element):
    """The part on the ground by its foot."""
    m = du.Mechanism()
    angle = m.add(element, name="angle", position=element.center)
    m.add(du.joints.Fixed(m.ground, angle["foot"]), name="weld")
    return m


def struck(element):
    """The force on its top, of a steel ball of 10 mm that hits it at 1 m/s."""
    m = held(element)
    place = element.center + element.interface("top").X + [0.01, 0.0, 0.0]
    ball = du.RigidBody(0.1, [4e-6] * 3)
    ball = m.add(ball, name="ball", position=place, velocity=[-1.0, 0.0, 0.0])
    hertz = {"stiffness": 1.54e10, "exponent": 1.5}
    m.add(du.contacts.plane(m["angle"]["top"], ball, "x", ball=0.01, **hertz), name="strike")
    return m.simulate(4e-4, step=2e-6).results.contact("strike").force[:, 0]


@pytest.mark.filterwarnings(
    "ignore:angle. modes for steps down to:duhamel.superelement.StepWarning"
)
def test_a_tested_part_in_a_model_vibrates_and_is_struck_as_its_mesh(tmp_path):
    element, whole = built(measure(ALL), tmp_path), truth().element
    found, expected = (held(part).modes(5).frequencies for part in (element, whole))
    np.testing.assert_allclose(found, expected, rtol=0.04)
    peaks = [struck(part).max() for part in (element, whole)]
    assert peaks[1] > 1000.0
    assert peaks[0] == pytest.approx(peaks[1], rel=0.01)


def test_a_body_that_was_changed_in_python_is_kept_as_it_is(coarse, tmp_path):
    body = preprocess.read_body(coarse.write(tmp_path))
    assert body.text == (tmp_path / "angle.toml").read_text()
    changed = body.model_copy(update={"name": "other"})
    assert '"name":"other"' in changed.text
    with pytest.raises(ValueError, match=r"name: expected 1 to \d+ characters, found ''"):
        MeasuredBody.model_validate(body.model_dump() | {"name": ""})
