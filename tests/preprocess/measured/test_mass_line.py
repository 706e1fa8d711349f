"""One message for each thing that is wrong with a test, and none for one that is right."""

import re

import pytest
from duhamel import preprocess
from duhamel.preprocess import MeasurementError
from duhamel.preprocess.measured.doubts import doubts_of_test
from duhamel.preprocess.measured.part_test import measurement_of, read_part_test

from .hammer_bench import ALL, HITS, SENSORS, Errors, measure, replace, truth, with_fault

NAMES = [f"{label}:{axis}" for label in SENSORS for axis in "xyz"]


def doubts(bench, folder, edit=None, **keys):
    path = bench.write(folder, **keys)
    if edit is not None:
        edit(path)
    test = read_part_test(preprocess.read_body(path))
    return list(doubts_of_test(test, measurement_of(test)))


RIGID = pytest.mark.parametrize(
    "rigid", ["", 'from = "frf"'], ids=["mass given", "mass by responses"]
)


@RIGID
@pytest.mark.parametrize(
    "errors",
    [
        Errors(),
        *(replace(ALL, seed=seed) for seed in (1, 2)),
        replace(ALL, mass=0.008),
        replace(ALL, window=9.2),
    ],
    ids=["exact", "1", "2", "heavy sensors", "window"],
)
def test_a_test_that_is_right_has_no_doubts(errors, rigid, tmp_path):
    assert doubts(measure(errors), tmp_path, rigid=rigid) == []


@pytest.mark.parametrize(("low", "cords"), [(30, 0.0), (60, 0.0), (30, 6.0), (60, 12.0)])
def test_neither_a_higher_band_nor_soft_cords_are_faults(low, cords, tmp_path):
    edit = table("angle.toml", "band = [20, 5000]", f"band = [{low}, 5000]")
    for seed in (1, 2):
        assert doubts(measure(replace(ALL, cords=cords, seed=seed)), tmp_path, edit) == []


@RIGID
@pytest.mark.parametrize(
    ("low", "cords", "stiff"),
    [
        *((20, cords, cords > 5.0) for cords in (2.0, 4.0, 6.0, 8.0, 12.0)),
        (60, 18.0, True),
    ],
)
def test_stiff_cords_alone_are_one_message(low, cords, stiff, rigid, tmp_path):
    edit = table("angle.toml", "band = [20, 5000]", f"band = [{low}, 5000]")
    for errors in (ALL, replace(ALL, noise=0.05, floor=5e-3, seed=2)):
        found = doubts(measure(replace(errors, cords=cords)), tmp_path, edit, rigid=rigid)
        assert len(found) == stiff
        for doubt in found:
            said = re.match(r"the part has (\d+\.?\d*) Hz on its", doubt)
            assert float(said[1]) == pytest.approx(cords, rel=0.15)


def test_mass_by_responses_on_stiff_cords_is_none_or_told(tmp_path):
    bench = measure(replace(ALL, cords=16.0))
    (found,) = doubts(bench, tmp_path)
    assert re.match(r"the part has 1[678] Hz on its cords", found)
    with pytest.raises(MeasurementError, match=r"are its cords soft \(measured\.suspension\)"):
        doubts(bench, tmp_path, rigid='from = "frf"')


@pytest.mark.parametrize(("cords", "highest"), [(18.0, 24), (30.0, 40), (60.0, 81)])
def test_cords_with_resonances_in_the_band_are_told_by_the_highest(cords, highest, tmp_path):
    """Of six, with which the part moves on them as a rigid one."""
    for errors in (ALL, replace(ALL, noise=0.05, floor=5e-3, seed=2), replace(ALL, damping=0.3)):
        (found,) = doubts(measure(replace(errors, cords=cords)), tmp_path)
        assert found.startswith(f"the part has {highest} Hz on its cords, too much for lines from")


def test_cords_that_leave_no_line_below_the_first_mode_are_told_as_that(tmp_path):
    """Lines from 200 Hz on have the second mode, at 525 Hz, as their first."""
    bench = measure(replace(ALL, cords=30.0))
    first, second = doubts(bench, tmp_path, suspension=40.0)
    assert first.startswith("lines below 200 Hz are not used")
    assert "cannot be checked: too few lines below the first resonance, at 18" in second
    with pytest.raises(MeasurementError, match="too few lines below the first resonance, at 18"):
        doubts(bench, tmp_path, suspension=40.0, rigid='from = "frf"')


def test_all_channels_in_g_are_told_by_the_mass(tmp_path):
    bench = measure(ALL)
    (found,) = doubts(replace(bench, H=bench.H / 9.80665), tmp_path)
    assert found.startswith("the mass line says")
    assert found.endswith(" kg: are all channels in g?")


def test_a_wrong_wire_hides_no_cords(tmp_path):
    bench = with_fault(measure(replace(ALL, cords=30.0)), scaled("1:y", -1.0))
    (found,) = doubts(bench, tmp_path)
    assert re.match(r"the part has (30|36|40) Hz on its cords", found)


def test_sensors_and_hits_of_points_without_rotations_are_where_they_are(tmp_path):
    """Their levers are none of the coordinates of such a point, but the mass line has them."""
    path = measure(ALL).write(tmp_path)
    path.write_text(path.read_text().replace("[impulse]", "rotations = false\n[impulse]"))
    test = read_part_test(preprocess.read_body(path))
    assert test.coordinates.interfaces["top"] == slice(6, 9)
    (said,) = doubts_of_test(test, measurement_of(test))
    assert re.fullmatch(r"interfaces\.top: rotations = false, .* levers are not counted", said)


def test_wrong_wires_of_a_part_on_stiff_cords_are_told_too(tmp_path):
    bench = with_fault(measure(replace(ALL, cords=8.0)), scaled("1:y", -1.0))
    first, second = doubts(bench, tmp_path)
    assert "Hz on its cords" in first
    assert second == "sensor 1: channel y is reversed"


def test_lines_on_stiff_cords_are_left_out(tmp_path):
    bench = measure(replace(ALL, cords=8.0))
    assert doubts(bench, tmp_path, suspension=8.0) == [
        "lines below 40 Hz are not used: on its cords the part has up to 8 Hz, by "
        "measured.suspension"
    ]
    test = read_part_test(preprocess.read_body(tmp_path / "angle.toml"))
    assert test.data.f[0] == 40.0
    assert doubts(bench, tmp_path, suspension=3.0) == []


def scaled(name, factor):
    def change(H):
        H[:, [k for k, channel in enumerate(NAMES) if channel.startswith(name)]] *= factor

    return change


def exchanged(first, second):
    def change(H):
        a, b = ([k for k, n in enumerate(NAMES) if n.startswith(x)] for x in (first, second))
        H[:, a + b] = H[:, b + a]

    return change


def hit(label, factor):
    def change(H):
        H[:, :, list(HITS).index(label)] *= factor

    return change


@RIGID
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (scaled("1:y", -1.0), "sensor 1: channel y is reversed"),
        (scaled("8:z", -1.0), "sensor 8: channel z is reversed"),
        (exchanged("2:x", "2:y"), "sensor 2: x and y are exchanged"),
        (scaled("3:", 1.0 / 9.80665), r"sensor 3: reads 0\.1 of what it should: in g\?"),
        (scaled("7:", 1e3), r"sensor 7: reads (1e\+03|9\.9e\+02) of what it should: in mm\?"),
        (scaled("5:z", 1.25), r"sensor 5: channel z reads 1\.[23] of what it should"),
        (hit("105", -1.0), "hit 105 has the other direction: the table wants that of the force .*"),
        (hit("206", 1.5), r"hit 206: a force of 1\.5 of what it should be"),
    ],
)
def test_each_wrong_wire_is_one_message(change, message, rigid, tmp_path):
    (found,) = doubts(with_fault(measure(ALL), change), tmp_path, rigid=rigid)
    assert re.fullmatch(message, found)


def test_sensors_in_each_other_s_place_are_told_by_their_places(tmp_path):
    first, second = doubts(with_fault(measure(ALL), exchanged("1:", "2:")), tmp_path)
    assert first.startswith("sensor 1: is where the table has sensor 2: ")
    assert second.startswith("sensor 2: is where the table has sensor 1: ")


def table(name, old, new):
    def edit(path):
        text = (path.parent / name).read_text()
        assert old in text
        (path.parent / name).write_text(text.replace(old, new))

    return edit


@RIGID
@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (
            table("hits.csv", "103,0.26,0.0,0.0", "103,0.23,0.0,0.0"),
            "hit 103: .. mm beside its place",
        ),
        (
            table("hits.csv", "107,0.28,0.0,0.005,0,1", "107,0.28,0.0,0.005,1,0"),
            "hit 107: (8|9). degrees off",
        ),
        (table("channels.csv", "7,0.1525", "7,0.1125"), "sensor 7: is not where the table has it"),
    ],
)
def test_wrong_lines_of_tables_are_one_message(edit, message, rigid, tmp_path):
    (found,) = doubts(measure(ALL), tmp_path, edit, rigid=rigid)
    assert re.match(message, found)


def test_a_wrong_mass_is_one_message(tmp_path):
    mass = truth().element.mass
    edit = table("angle.toml", f"mass = {mass}", f"mass = {1.15 * mass}")
    (found,) = doubts(measure(ALL), tmp_path, edit)
    assert "says that the part has 2.2" in found
    (found,) = doubts(measure(ALL), tmp_path, rigid=f'from = "frf"\nmass = {1.15 * mass}')
    assert "says that the part has 2.2" in found
    heavy = replace(measure(replace(ALL, mass=0.03)), errors=ALL)
    (found,) = doubts(heavy, tmp_path)
    assert "kg with what is mounted on it, and [measured] has 2.247 kg" in found


@pytest.mark.parametrize(("low", "damping"), [(110, 0.0), (120, 0.0), (160, 0.0), (128, 0.1)])
def test_a_band_without_a_mass_line_says_that_nothing_was_checked(low, damping, tmp_path):
    """Nor that something is wrong, which noise of a short line would say."""
    edit = table("angle.toml", "band = [20, 5000]", f"band = [{low}, 5000]")
    for seed in (1, 2, 3):
        (found,) = doubts(measure(replace(ALL, damping=damping, seed=seed)), tmp_path, edit)
        assert re.fullmatch(
            r"whether channels, hits and mass are right cannot be checked: too few lines below "
            r"the first resonance, at 1\d\d(\.\d)? Hz: expected 8 or more, from \d+(\.\d)? Hz or "
            "less on",
            found,
        )


def test_warnings_and_refusals_name_what_is_wrong(tmp_path):
    told = []
    bench = with_fault(measure(ALL), scaled("8:z", -1.0))
    preprocess.build(preprocess.read_body(bench.write(tmp_path)), on_warning=told.append)
    assert [one for one in told if one.endswith("sensor 8: channel z is reversed")]
    bench = with_fault(measure(ALL), scaled("3:", 30.0))
    bench = replace(bench, f=bench.f[::4], H=bench.H[::4])
    with pytest.raises(MeasurementError, match=r"differ from .*accept = 0.3; sensor 3: reads 30"):
        preprocess.build(preprocess.read_body(bench.write(tmp_path)))
