"""Tables of bearings from files: units, names, dimensionless numbers, and what is refused."""

import json
import tomllib

import duhamel as du
import numpy as np
import pytest
from duhamel.solver import (
    Bearing,
    Frame,
    Model,
    ModelError,
    read_model,
    rotor_at,
    write_model,
)

SPEEDS = [100.0, 200.0, 400.0]
STIFFNESS = [[1e6, 1e5, -2e5, 2e6], [1.1e6, 3e5, -4e5, 2.2e6], [1.3e6, 5e5, -6e5, 2.1e6]]
DAMPING = [[1e3, 10.0, 10.0, 2e3], [1.2e3, 20.0, 20.0, 1.8e3], [1.1e3, 30.0, 30.0, 1.7e3]]
ROSS = """[BearingElement_film]
color = "#355d7a"
cxx = [ 1000.0, 1200.0, 1100.0,]
cxy = [ 10.0, 20.0, 30.0,]
cyx = [ 10.0, 20.0, 30.0,]
cyy = [ 2000.0, 1800.0, 1700.0,]
czz = [ 0, 0, 0,]
frequency = [ 100.0, 200.0, 400.0,]
kxx = [ 1000000.0, 1100000.0, 1300000.0,]
kxy = [ 100000.0, 300000.0, 500000.0,]
kyx = [ -200000.0, -400000.0, -600000.0,]
kyy = [ 2000000.0, 2200000.0, 2100000.0,]
kzz = [ 0, 0, 0,]
mxx = [ 0, 0, 0,]
mxy = [ 0, 0, 0,]
myx = [ 0, 0, 0,]
myy = [ 0, 0, 0,]
mzz = [ 0, 0, 0,]
n = 0
scale_factor = 1
tag = "film"
"""
"""as `BearingElement.save` of ross-rotordynamics 2.3.0 writes it"""
NAMES = "kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy"
FILM = {"load": 500.0, "clearance": 1e-4, "viscosity": 0.02, "length": 0.03, "diameter": 0.1}


def csv(factors=(1.0, 1.0, 1.0), units=("", "", ""), names=NAMES, speed="speed"):
    """The table as CSV in other units, factors over those of SI."""
    headers = [speed + units[0], *(name + units[1 + (name[0] == "c")] for name in names)]
    lines = [", ".join(headers)]
    for rate, K, C in zip(SPEEDS, STIFFNESS, DAMPING, strict=True):
        cells = [rate / factors[0], *np.divide(K, factors[1]), *np.divide(C, factors[2])]
        lines.append(", ".join(repr(float(cell)) for cell in cells))
    return "\n".join(lines) + "\n"


def film(path, **more):
    return Bearing("film", ["ground.hub", "disk"], [0.0, 0.0, 1.0], table=path, **more)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("si.csv", csv()),
        ("units.csv", csv((np.pi / 30.0, 1e3, 1e3), (" [rpm]", " [N/mm]", " [N s/mm]"))),
        ("round.csv", csv((2 * np.pi, 1e6, 1.0), (" (Hz)", " (MN/m)", " (N*s/m)"))),
        ("pounds.csv", csv((1.0, 175.12683524647636, 175.12683524647636),
                           ("", " [lbf/in]", " [lbf*s/in]"))),
        ("entries.csv", csv(names=[n.translate(str.maketrans("xy", "12")) for n in NAMES])),
        ("semicolons.csv", csv(speed="Frequency [rad/s]").replace(",", ";")),
        ("ross.toml", ROSS),
        ("ross.json", json.dumps(tomllib.loads(ROSS) | {"n_link": None})),
    ],
)  # fmt: skip
def test_a_table_is_the_same_in_every_unit_and_format(tmp_path, name, text):
    path = tmp_path / name
    path.write_text(text)
    found = film(path)
    for key, expected in {"speeds": SPEEDS, "stiffness": STIFFNESS, "damping": DAMPING}.items():
        values = getattr(found, key)
        np.testing.assert_allclose(values.reshape(np.shape(expected)), expected, rtol=1e-12)


def test_cross_coupling_that_is_left_out_is_none(tmp_path):
    path = tmp_path / "plain.csv"
    rows = ["speed [rpm], kxx, kyy, cxx, cyy, note", "0, 1e6, 2e6, 10, 20, a", "60, 1, 2, 3, 4, b"]
    path.write_text("\n".join(rows))
    found = film(path)
    np.testing.assert_allclose(found.speeds, [0.0, 2.0 * np.pi])
    np.testing.assert_array_equal(found.stiffness, [np.diag([1e6, 2e6]), np.diag([1.0, 2.0])])
    np.testing.assert_array_equal(found.damping, [np.diag([10.0, 20.0]), np.diag([3.0, 4.0])])


def short_bearing_load(e):
    """W c^2 / (mu Omega R L^3) of a short bearing of eccentricity e (Ocvirk)."""
    return np.pi / 4.0 * e / (1 - e**2) ** 2 * np.sqrt(16 * e**2 / np.pi**2 + 1 - e**2)


def test_a_dimensionless_table_gives_each_speed_its_load(tmp_path):
    """A short bearing of the Sommerfeld numbers of some eccentricities carries W at each row."""
    eccentricities = np.array([0.8, 0.5, 0.2])
    W, c, mu, L, D = FILM.values()
    # S = (D / L)^2 / (4 pi f), by the definitions of S and of f.
    numbers = (D / L) ** 2 / (4.0 * np.pi * short_bearing_load(eccentricities))
    rows = [f"{s!r}, 2.0, 0.5, -1.5, 3.0, 4.0, 0.1, 0.2, 5.0" for s in numbers.tolist()]
    path = tmp_path / "ocvirk.csv"
    path.write_text("\n".join(["Sommerfeld, Kxx, Kxy, Kyx, Kyy, Cxx, Cxy, Cyx, Cyy", *rows]))
    found = film(path, film=FILM)
    carried = mu * found.speeds * 0.5 * D * L**3 / c**2 * short_bearing_load(eccentricities)
    np.testing.assert_allclose(carried, W, rtol=1e-12)
    assert (np.diff(found.speeds) > 0.0).all()
    np.testing.assert_allclose(found.stiffness[0], W / c * np.array([[2.0, 0.5], [-1.5, 3.0]]))
    np.testing.assert_allclose(
        found.damping * found.speeds[:, None, None],
        np.broadcast_to(W / c * np.array([[4.0, 0.1], [0.2, 5.0]]), (3, 2, 2)),
    )
    path.write_text("\n".join(["Sommerfeld, Kxx, Kyy, Cxx, Cyy", "3, 1, 1, 1, 1", "1, 2, 2, 2, 2"]))
    falling = film(path, film=FILM)
    assert falling.stiffness[0, 0, 0] == pytest.approx(2.0 * W / c)


def test_a_model_names_a_table_beside_it_and_is_written_with_its_numbers(tmp_path):
    (tmp_path / "films").mkdir()
    (tmp_path / "films/left.csv").write_text(csv())
    (tmp_path / "model.toml").write_text(
        """
        [simulation]
        t_end = 0.1
        step = 1e-3
        [bodies.disk]
        mass = 10
        inertia = [0.1, 0.1, 0.2]
        [ground]
        frames.hub = {position = [0, 0, 0]}
        [[bearings]]
        name = "film"
        between = ["ground.hub", "disk"]
        axis = [0, 0, 1]
        table = "films/left.csv"
        """
    )
    model = read_model(tmp_path / "model.toml")
    np.testing.assert_array_equal(model.bearings[0].speeds, SPEEDS)
    write_model(model, tmp_path / "again.toml")
    assert repr(read_model(tmp_path / "again.toml").bearings) == repr(model.bearings)
    assert "table" not in (tmp_path / "again.toml").read_text()
    # Halfway between two rows.
    plain = Bearing("film", ["ground.hub", "disk"], [0.0, 0.0, 1.0],
                    np.reshape(np.mean(STIFFNESS[:2], axis=0), (2, 2)),
                    np.reshape(np.mean(DAMPING[:2], axis=0), (2, 2)))  # fmt: skip
    constant = Model(model.bodies, bearings=[plain], ground_frames={"hub": Frame()})
    expected = rotor_at(constant, 150.0)
    np.testing.assert_allclose(
        rotor_at(model, 150.0).modes().values, expected.modes().values, rtol=1e-12, atol=1e-9
    )


def test_a_table_in_python(tmp_path):
    (tmp_path / "left.csv").write_text(csv())
    m = du.Mechanism()
    disk = m.add(du.RigidBody(10.0, [0.1, 0.1, 0.2]), name="disk")
    m.add(du.springs.bearing(m.ground.frame("hub"), disk, "z", table=tmp_path / "left.csv"))
    np.testing.assert_array_equal(m.model().bearings[0].speeds, SPEEDS)


ONE = "1e6, 0, 0, 1e6, 10, 0, 0, 10"
HEADER = "speed, " + ", ".join(NAMES)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", f"{HEADER}\n0, {ONE}\n9, {ONE.replace('1e6', 'soft')}",
         r"bearing 'film': table: file: .*a.csv: line 3, column 'kxx': expected a number, found"),
        ("a.csv", f"{HEADER}\n0, {ONE}\n9, 1, 2",
         r"a.csv: line 3, column 'k..': expected a number, found nothing"),
        ("a.csv", f"{HEADER}\n9, {ONE}\n0, {ONE}",
         r"a.csv: row 2 of the table: expected speeds that increase, found 0 rad/s after 9 rad/s"),
        ("a.csv", f"{HEADER}\n9, {ONE}\n9, {ONE}", "expected speeds that increase"),
        ("a.csv", f"{HEADER}\n9, {ONE}", "a.csv: expected two or more speeds, found 1"),
        ("a.csv", "kxx, kyy, cxx\n1, 1, 1",
         r"expected the columns speed \(or sommerfeld\), cyy too, found kxx, kyy, cxx"),
        ("a.csv", f"0, {ONE}\n9, {ONE}", "expected the columns speed .* found none of these"),
        ("a.csv", f"{HEADER.replace('kxx', 'kxx [N]')}\n0, {ONE}\n9, {ONE}",
         r"column 'kxx \[N\]': expected a unit of stiffness, N/m, .*, found 'N'"),
        ("a.csv", f"{HEADER.replace('speed', 'speed [m/s]')}\n0, {ONE}\n9, {ONE}",
         r"expected a unit of speed, rad/s, rpm, Hz, found 'm/s'"),
        ("a.csv", f"{HEADER.replace('kxy', 'k11')}\n0, {ONE}\n9, {ONE}",
         "more than one column is kxx"),
        ("a.csv", f"{HEADER}, mxx\n0, {ONE}, 0\n9, {ONE}, 2",
         "column mxx: expected zeros, for added masses are not supported"),
        ("a.csv", "sommerfeld, kxx, kyy, cxx, cyy\n1, 1, 1, 1, 1\n2, 1, 1, 1, 1",
         "column sommerfeld: expected film = {load, clearance, viscosity, length, diameter}"),
        ("a.json", json.dumps({key: [1, 2] for key in ("sommerfeld", *NAMES)}),
         "a.json: column sommerfeld: expected film = {load, "),
        ("a.csv", f"{HEADER.replace('speed', 'Frequency')}\n0, {ONE}\n9, {ONE}",
         r"column 'Frequency': expected a unit in brackets, rad/s, rpm, Hz, found none"),
        ("a.csv", "", "a.csv: expected rows of numbers, found none"),
        ("a.xlsx", "", "expected a CSV file, got a spreadsheet: export it as CSV"),
        ("a.toml", ROSS.replace("1100000.0", '"x"'),
         "a.toml: BearingElement_film.kxx: row 2: expected a number, found 'x'"),
        ("a.toml", ROSS.replace("[ 1000.0, 1200.0, 1100.0,]", "[1000.0]"),
         "a.toml: expected arrays of one length, found cxx 1, cxy 3"),
        ("a.toml", ROSS + ROSS.replace("_film", "_seal"), "found 'BearingElement_film', 'Bearing"),
        ("a.toml", ROSS.replace("kzz = [ 0, 0, 0,]", "kzz = [ 0, 0, 5,]"),
         "column kzz: expected zeros, for a bearing acts across its axis alone"),
        ("a.toml", "x = ", "a.toml: not a readable file: not a TOML file"),
        ("a.json", "[1]", "a.json: expected one table of a bearing, with kxx, found none"),
        ("a.json", "{", "a.json: not a readable file"),
    ],
)  # fmt: skip
def test_what_a_table_refuses(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(ModelError, match=message):
        film(tmp_path / name)


def dimensionless(suffix, numbers, more=()):
    """A table over Sommerfeld numbers, with more columns."""
    columns = {"sommerfeld": numbers, **dict(more)}
    columns |= dict.fromkeys(("kxx", "kyy", "cxx", "cyy"), [1.0] * len(numbers))
    if suffix == "json":
        return json.dumps(columns)
    if suffix == "toml":
        return "[film]\n" + "".join(f"{key} = {values}\n" for key, values in columns.items())
    rows = [columns, *zip(*columns.values(), strict=True)]
    return "\n".join(", ".join(map(str, row)) for row in rows)


@pytest.mark.parametrize("suffix", ["csv", "toml", "json"])
@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (([0.0, 0.5],), "sommerfeld: row 1 of the table: expected a number above 0, found 0"),
        (([0.5, -1.0],), "row 2 of the table: expected a number above 0, found -1"),
        (([0.1, 0.5], {"speed": [10.0, 20.0]}), "one of speed, frequency and sommerfeld, found"),
        (([0.5],), "expected two or more speeds, found 1"),
        (([3.0, 2.0, 2.5, 1.0],), "row 3 of the table: expected speeds that decrease, found"),
        (([1.0, 3.0, 2.0, 4.0],), "row 3 of the table: expected speeds that increase, found"),
    ],
)  # fmt: skip
def test_what_a_dimensionless_table_refuses(tmp_path, suffix, columns, message):
    path = tmp_path / f"a.{suffix}"
    path.write_text(dimensionless(suffix, *columns))
    with pytest.raises(ModelError, match=message):
        film(path, film=FILM)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"stiffness": 1e6}, "expected a table, or stiffness, damping and speeds, not both"),
        ({"damping": 1.0}, "expected a table, or stiffness, damping and speeds, not both"),
        ({"film": {"load": 1.0}}, "film: expected load, clearance, .*, diameter, got load"),
        ({"film": FILM | {"load": 0.0}}, "film: load: expected a number above 0, got 0"),
        ({"film": FILM}, "expected a column sommerfeld, for film is given"),
        ({"table": None, "film": FILM}, "film: expected a dimensionless table with it"),
        ({"table": None}, "bearing 'film': expected stiffness, or a table"),
        ({"table": "absent.csv"}, "absent.csv: not a readable file: No such file"),
    ],
)
def test_what_a_bearing_with_a_table_refuses(tmp_path, more, message):
    (tmp_path / "a.csv").write_text(csv())
    with pytest.raises(ModelError, match=message):
        film(**({"path": tmp_path / "a.csv"} | {"path" if k == "table" else k: v
                                                for k, v in more.items()}))  # fmt: skip
