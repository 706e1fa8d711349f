"""Results as tables, MATLAB files and xarray: every number comes back as it was."""

import csv
import sys

import numpy as np
import pytest
import scipy.io
import xarray as xr
from duhamel.results import (
    ExportError,
    QuantityError,
    Results,
    ResultsError,
    write_csv,
    write_mat,
)
from duhamel.results.exports import matlab, tables
from duhamel.results.exports.matlab import identifiers
from duhamel.results.file import FileWriter
from duhamel.results.motion import EVENT_QUANTITIES
from duhamel.results.source import Memory
from duhamel.results.steps import evenly, window

from .disc import ANGLE, TIME, TRAVEL
from .writing import NOTES, batch, make_contents, make_events, make_output


@pytest.fixture(scope="module")
def run():
    """Seven steps of everything that there is, in memory."""
    return in_memory()


def in_memory():
    contents = make_contents()
    memory = Memory(contents, {**NOTES, "finished": True}, "a model")
    output = make_output(contents, 7)
    memory.append(batch(output, 0, 3, make_events(contents, 9)))
    memory.append(batch(output, 3, 4))
    return Results(memory)


def table(path):
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return header, rows


def test_the_tables_of_groups_have_every_number_that_was_recorded(run, tmp_path):
    paths = write_csv(run, tmp_path / "new" / "folder")
    assert {path.stem for path in paths} == {
        quantity.group for quantity in run.contents.quantities if quantity.group
    } | {"events"}
    for path in paths[:-1]:
        header, rows = table(path)
        columns = dict(zip(header, np.array(rows, dtype=float).T, strict=True))
        np.testing.assert_array_equal(columns.pop("time [s]"), run.time)
        for quantity in run.contents.quantities:
            if quantity.group == path.stem:
                values = run.variable(quantity.name).reshape(7, -1)
                for values_of_one in values.T:
                    key = next(iter(columns))
                    assert key.startswith(quantity.name)
                    np.testing.assert_array_equal(columns.pop(key), values_of_one)
        assert not columns


def test_a_column_is_headed_by_the_variable_its_entries_and_its_unit(run, tmp_path):
    write_csv(run, tmp_path)
    header, rows = table(tmp_path / "contacts.csv")
    k = header.index("contact_force:k1:t2 [N]")
    expected = run.variable("contact_force")[:, 1, 2]
    np.testing.assert_array_equal([float(row[k]) for row in rows], expected)
    assert "joint_multiplier:j2.1 [N]" in table(tmp_path / "joints.csv")[0]
    assert "joint_multiplier:j0.2 [N m]" in table(tmp_path / "joints.csv")[0]


def test_states_and_iterations_are_whole_numbers(run, tmp_path):
    write_csv(run, tmp_path)
    header, rows = table(tmp_path / "solver.csv")
    iterations = [row[header.index("newton_iterations [1]")] for row in rows]
    assert iterations == [str(n) for n in run.iterations.tolist()]


def test_events_stand_beside_the_names_of_their_contacts(run, tmp_path):
    write_csv(run, tmp_path)
    header, rows = table(tmp_path / "events.csv")
    assert header[0] == "of"
    assert "peak [N, N m]" in header
    assert len(rows) == 9
    for owner, events in run.events.items():
        found = [row[1:] for row in rows if row[0] == owner]
        expected = np.column_stack([getattr(events, q.attribute) for q in EVENT_QUANTITIES])
        np.testing.assert_array_equal(np.array(found, dtype=float).reshape(-1, 9), expected)


def test_reading_in_parts_changes_nothing(run, tmp_path, monkeypatch):
    write_csv(run, tmp_path / "whole")
    monkeypatch.setattr("duhamel.results.exports.tables.BATCH_NUMBERS", 40)
    write_csv(run, tmp_path / "parts")
    for path in (tmp_path / "whole").iterdir():
        assert path.read_bytes() == (tmp_path / "parts" / path.name).read_bytes()


def test_a_window_has_the_rows_of_its_times(results_file, tmp_path):
    results = Results.read(results_file)
    rows = window(results.time, 0.1, 0.2)
    write_csv(results, tmp_path, ["displacement:beam.tip:disc.rim"], rows)
    header, written = table(tmp_path / "quantities.csv")
    assert header == ["time [s]", *(f"displacement:beam.tip:disc.rim:{a} [m]" for a in "xyz")]
    time, *moved = np.array(written, dtype=float).T
    chosen = (TIME >= 0.0999) & (TIME <= 0.2001)
    np.testing.assert_array_equal(time, TIME[chosen])
    np.testing.assert_allclose(np.transpose(moved), (TRAVEL - TRAVEL[0])[chosen], atol=1e-15)


def test_spectra_have_a_table_of_their_own_and_stars_stand_for_all(results_file, tmp_path):
    results = Results.read(results_file)
    wanted = ["angle:*", "srs(acceleration:beam.tip, from=5, to=8)"]
    paths = write_csv(results, tmp_path, wanted)
    assert [path.name for path in paths] == [
        "quantities.csv",
        "srs(acceleration_beam.tip,_from=5,_to=8).csv",
    ]
    header, rows = table(paths[0])
    assert header[1:4] == [f"angle:beam:{axis} [rad]" for axis in "xyz"]
    k = header.index("angle:disc:z [rad]")
    np.testing.assert_allclose([float(row[k]) for row in rows], ANGLE, atol=1e-9)
    header, rows = table(paths[1])
    assert header[:2] == ["frequency [Hz]", "srs(acceleration:beam.tip:x, from=5, to=8) [m/s²]"]
    np.testing.assert_allclose(float(rows[0][0]), 5.0, rtol=0.06)  # a twelfth of an octave


def test_what_there_is_not_is_named_and_nothing_is_written(results_file, tmp_path):
    with pytest.raises(QuantityError, match="velocity:hub: no body or frame 'hub'"):
        write_csv(Results.read(results_file), tmp_path, ["velocity:hub"])
    assert not list(tmp_path.glob("*.csv"))


def test_a_folder_that_cannot_be_made_is_named(run, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ExportError, match=r"file.*: cannot be made a folder"):
        write_csv(run, tmp_path / "file")


def test_matlab_has_the_attributes_of_every_owner_with_names_and_units(run, tmp_path):
    path = write_mat(run, tmp_path / "run.mat")
    found = scipy.io.loadmat(path, simplify_cells=True)
    np.testing.assert_array_equal(found["time"], run.time)
    np.testing.assert_array_equal(found["bodies"]["b1"]["v"], run.body("b1").v)
    tip = found["frames"]["b1_tip"]
    assert tip["name"] == "b1.tip"
    np.testing.assert_array_equal(tip["force"], run.frame("b1.tip").force)
    assert tip["units"]["force"] == "N, N m"
    joint = found["joints"]["j2"]
    np.testing.assert_array_equal(joint["angle_1"], run.joint("j2").angle_1)
    np.testing.assert_array_equal(joint["multipliers"], run.joint("j2").multipliers)
    assert found["stops"]["e1"]["units"]["force"] == "N m"
    np.testing.assert_array_equal(found["energy"]["kinetic"], run.energy.kinetic)
    np.testing.assert_array_equal(found["momentum"]["linear"], run.momentum.linear)
    np.testing.assert_array_equal(found["solver"]["iterations"], run.iterations)
    for name, events in run.events.items():
        np.testing.assert_array_equal(found["events"][name]["peak"], events.peak)
    assert found["run"]["h"] == 0.1
    assert found["model"] == "a model"


def test_series_are_columns_in_matlab(run, tmp_path):
    found = scipy.io.loadmat(write_mat(run, tmp_path / "run.mat", slice(2, 5)))
    assert found["time"].shape == (3, 1)
    assert found["energy"]["kinetic"][0, 0].shape == (3, 1)


def test_names_become_those_of_matlab():
    long = "n" * 70
    assert identifiers(["beam.tip", "beam tip", "2nd", "_a", "für", "end", long, f"{long}b"]) == [
        "beam_tip",
        "beam_tip_2",
        "x2nd",
        "x_a",
        "f_r",
        "xend",
        "n" * 63,
        "n" * 61 + "_2",
    ]


def test_more_than_matlab_can_hold_is_refused(run, tmp_path, monkeypatch):
    monkeypatch.setattr(matlab, "MAX_VARIABLE_BYTES", 1000)
    with pytest.raises(ExportError, match=r"run\.mat: frames would take .* GB, and a MATLAB file"):
        write_mat(run, tmp_path / "run.mat")
    assert not list(tmp_path.iterdir())


def test_xarray_has_the_same_of_a_file_and_of_memory(run, tmp_path):
    contents = make_contents()
    writer = FileWriter(tmp_path / "run.h5", contents, NOTES, "a model", 7)
    output = make_output(contents, 7)
    writer.append(batch(output, 0, 3, make_events(contents, 9)))
    writer.append(batch(output, 3, 4))
    writer.note(finished=True)
    writer.finish()
    with Results.read(tmp_path / "run.h5").to_xarray() as file, run.to_xarray() as memory:
        xr.testing.assert_identical(file.load(), memory.load())
        assert file.sizes["time"] == 7
        velocity = file.body_velocity.sel(body="b1", axis="y")
        np.testing.assert_array_equal(velocity, run.body("b1").v[:, 1])


@pytest.mark.parametrize("missing", ["xarray", "h5netcdf"])
def test_without_a_package_xarray_is_refused_in_a_line(run, missing, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(ExportError, match=f"to_xarray needs {missing}: pip install"):
        run.to_xarray()


def test_frames_are_even_over_time_where_steps_are_not():
    time = np.concatenate([np.linspace(0.0, 1.0, 11), 1.0 + np.linspace(0.001, 1.0, 1000)])
    chosen = evenly(time, slice(None), 5)
    np.testing.assert_allclose(time[chosen], [0.0, 0.5, 1.0, 1.5, 2.0], atol=1e-9)
    np.testing.assert_array_equal(evenly(time, slice(3, 6), 5), [3, 4, 5])
    np.testing.assert_array_equal(evenly(time[:1], slice(None), 5), [0])


def test_a_window_outside_the_run_is_refused():
    with pytest.raises(ExportError, match=r"nothing was recorded from 2 to 3 s: .* 0 to 1 s"):
        window(np.array([0.0, 1.0]), 2.0, 3.0)


def test_an_export_that_fails_leaves_the_files_of_an_earlier_one(run, tmp_path, monkeypatch):
    before = {path: path.read_bytes() for path in write_csv(run, tmp_path)}
    monkeypatch.setattr(tables, "_events", damaged)
    with pytest.raises(ResultsError, match="damaged"):
        write_csv(run, tmp_path, rows=slice(0, 1))
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def damaged(*_):
    raise ResultsError("damaged")
