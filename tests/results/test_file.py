"""The results file: what it holds however it was written, and while it is written."""

import os
import resource
import signal
import subprocess
import sys
import time
from dataclasses import replace

import h5py
import numpy as np
import pytest
from duhamel.results import Results, ResultsError
from duhamel.results import file as file_module
from duhamel.results import journal as journal_module
from duhamel.results.batches import EventRows
from duhamel.results.contents import SuperelementFile
from duhamel.results.errors import QuantityError
from duhamel.results.file import ROW_CHUNK_BYTES, Extent, FileSource, FileWriter, chunks
from duhamel.results.motion import EVENT_QUANTITIES, QUANTITIES
from duhamel.results.quantities import evaluate
from duhamel.results.source import Memory

from .writing import NOTES, batch, make_contents, make_events, make_output


@pytest.fixture(autouse=True)
def _at_once(monkeypatch):
    monkeypatch.setattr(FileWriter, "pause", 0.0)


def write(path, contents, output, sizes):
    """Batches of some sizes."""
    writer, first = FileWriter(path, contents, NOTES, "model", sum(sizes)), 0
    for n in sizes:
        writer.append(batch(output, first, n))
        first += n
    writer.flush()
    return writer


def read(source, contents):
    """All quantities, by name."""
    wanted = [(quantity, None) for quantity in contents.quantities]
    return dict(zip([q.name for q, _ in wanted], source.read(wanted), strict=True))


@pytest.mark.parametrize("sizes", [(11,), (1, 10), (1, 2, 3, 5), (1,) * 11])
def test_rows_are_the_same_in_however_many_writes_and_in_memory(sizes, tmp_path):
    contents = make_contents()
    output = make_output(contents, 11)
    write(tmp_path / "out.h5", contents, output, sizes)
    memory = Memory(contents, NOTES, "model")
    for first in range(0, 11, 4):
        memory.append(batch(output, first, min(4, 11 - first)))
    source = FileSource(tmp_path / "out.h5")
    found, expected = read(source, contents), read(memory, contents)
    assert found.keys() == expected.keys() == {quantity.name for quantity in QUANTITIES}
    for name, array in expected.items():
        np.testing.assert_array_equal(found[name], array, err_msg=name)
    np.testing.assert_array_equal(found["body_position"], output.body_position)
    np.testing.assert_array_equal(found["frame_moment"], output.frame_moment[:, 1:])
    np.testing.assert_array_equal(found["spring_multiplier"], output.multiplier[:, 5:6])
    np.testing.assert_array_equal(found["coupler_force"], output.multiplier[:, 6:])
    np.testing.assert_allclose(found["time"], 0.1 * np.arange(11), rtol=1e-15)
    assert source.contents().recorded == contents.recorded
    assert source.contents().superelements == contents.superelements
    assert source.model() == memory.model() == "model"


@pytest.mark.parametrize(
    "few",
    [
        {"joints": ()},
        {"joints": (0,), "coordinates": 0},
        {"joints": (0, 0, 2)},
        {"springs": 0},
        {"flexible": 0},
        {"joints": (), "springs": 0, "flexible": 0, "contacts": 0, "stops": 0},
        {"contacts": 0},
        {"stops": 0},
        {"selects": lambda group: group in ("bodies/b1", "frames/b0.tip", "joints/j2", "energy")},
        {"selects": lambda group: False},
    ],
)
def test_what_there_is_none_of_is_absent(few, tmp_path):
    contents = make_contents(**few)
    output = make_output(make_contents(), 4)
    write(tmp_path / "out.h5", contents, output, (1, 3))
    with h5py.File(tmp_path / "out.h5") as file:
        variables = {name: item for name, item in file.items() if isinstance(item, h5py.Dataset)}
    no_event = [name for name in variables if name.startswith("event") and "units" not in name]
    with h5py.File(tmp_path / "out.h5") as file:
        assert all(file[name].size for name in variables if name not in no_event)
    results = Results.read(tmp_path / "out.h5")
    assert results.recorded == contents.recorded
    for name in results.joints:
        joint = results.joint(name)
        assert joint.multipliers.shape == (4, int(contents_of(name, contents)))
        assert joint.force.shape == (4, 3)
    for name in results.springs:
        assert results.spring(name).coordinates["coordinates"].shape == (4, 1)
    with pytest.raises(KeyError, match="no joints/none; there are"):
        results.joint("none")
    assert results.time.shape == (4,)


def test_events_are_the_same_in_however_many_writes_and_in_memory(tmp_path):
    """Also in a write without rows, and of contacts of which nothing else was recorded."""
    contents = make_contents(selects=lambda group: group == "energy")
    output, events = make_output(contents, 6), make_events(contents, 50)
    memory, writer = (
        Memory(contents, NOTES, "model"),
        FileWriter(tmp_path / "out.h5", contents, NOTES, "model", 6),
    )
    memory.append(batch(output, 0, 6, events))
    parts = [EventRows(*(column[at : at + 10] for column in events)) for at in range(0, 50, 10)]
    for first, n, part in zip((0, 1, 1, 4, 4), (1, 0, 3, 0, 2), parts, strict=True):
        writer.append(batch(output, first, n, part))
    writer.flush()
    expected, results = Results(memory).events, Results.read(tmp_path / "out.h5")
    assert results.events.keys() == expected.keys() == {"k0", "k1", "e0", "e1"}
    for number, (name, found) in enumerate(results.events.items()):
        own = events.values[events.owner == number]
        assert len(found) == len(expected[name]) == len(own) > 0
        for quantity, column in zip(EVENT_QUANTITIES, own.T, strict=True):
            np.testing.assert_array_equal(getattr(found, quantity.attribute), column)
    assert results.unit("events", "k1", "peak") == "N m"  # the odd ones are angular
    assert results.unit("events", "e0", "peak") == "N"
    assert results.unit("events", "k1", "dissipated") == "J"


@pytest.mark.parametrize("owner", [-1, 4])
def test_an_event_of_nobody_is_refused(owner, tmp_path):
    contents = make_contents()
    writer = FileWriter(tmp_path / "out.h5", contents, NOTES, "model", 2)
    writer.append(batch(make_output(contents, 2), 0, 2, make_events(contents, 3)))
    writer.flush()
    with h5py.File(tmp_path / "out.h5", "a") as file:
        file["event_of"][1] = owner
    with pytest.raises(ResultsError, match=r"out.h5: variable 'event_of': .* event_owner"):
        _ = Results.read(tmp_path / "out.h5").events


def contents_of(joint, contents):
    axis = contents.axes.get("joint_constraint")
    return 0 if axis is None else len(axis.range_of(joint))


def test_a_recorded_subset_is_that_of_the_whole(tmp_path):
    output = make_output(make_contents(bodies=5), 6)
    chosen = ("bodies/b1", "bodies/b4", "joints/j2")
    contents = make_contents(bodies=5, selects=lambda group: group in chosen)
    write(tmp_path / "out.h5", contents, output, (6,))
    results = Results.read(tmp_path / "out.h5")
    assert results.recorded == chosen
    np.testing.assert_array_equal(results.body("b4").v[:, 3:], output.body_angular_velocity[:, 4])
    np.testing.assert_array_equal(results.body("b1").R, output.body_rotation[:, 1])
    joint = results.joint("j2")
    np.testing.assert_array_equal(joint.multipliers, output.multiplier[:, 2:5])
    np.testing.assert_array_equal(joint.moment, output.coupling_moment[:, 2])
    np.testing.assert_array_equal(joint.angle_1, output.joint_position[:, 1])
    np.testing.assert_array_equal(joint.angle_1_rate, output.joint_rate[:, 1])
    with pytest.raises(AttributeError, match="no coordinate 'angel'; there are: angle_0, angle_1,"):
        _ = joint.angel
    with pytest.raises(KeyError, match="no bodies/b0; there are: b1, b4"):
        results.body("b0")
    with pytest.raises(KeyError, match="no energy; there are: bodies/b1, bodies/b4, joints/j2"):
        _ = results.energy


def test_only_rows_that_are_whole_count(tmp_path):
    """A run that was killed in a write may leave some variables longer."""
    contents = make_contents()
    write(tmp_path / "out.h5", contents, make_output(contents, 5), (5,))
    with h5py.File(tmp_path / "out.h5", "a") as file:
        file["time"].resize(8, axis=0)
        file["body_position"].resize(8, axis=0)
        assert np.isnan(file["body_position"][5:]).all()
    results = Results.read(tmp_path / "out.h5")
    assert len(results.time) == len(results.body("b0").x) == len(results.residual) == 5


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"version": 2},
            "results file of version 2; this Duhamel reads versions 3 to 12: run the model again",
        ),
        (
            {"format": "duhamel-superelement"},
            "expected results of a run, found a superelement: models take it as superelement of a "
            "body, duhamel info and check show it",
        ),
    ],
)
def test_another_version_or_format_is_refused_in_one_line(change, message, tmp_path):
    path = tmp_path / "out.h5"
    contents = make_contents()
    write(path, contents, make_output(contents, 2), (2,))
    with h5py.File(path, "a") as file:
        file.attrs.update(change)
    with pytest.raises(ResultsError) as caught:
        Results.read(path)
    assert str(caught.value) == f"{path}: {message}"


@pytest.mark.parametrize("version", [3, 4, 5, 6])
def test_earlier_versions_are_read_whose_bodies_have_no_second_order(version, tmp_path):
    path, contents = tmp_path / "out.h5", make_contents(second_order=0, motors=0)
    write(path, contents, make_output(contents, 2), (2,)).finish()
    with h5py.File(path, "a") as file:
        file.attrs["version"] = version
        assert "motor_torque" not in file
        assert "body_second_order_force" not in file
    assert Results.read(path).body("b0").second_order_force.shape == (2, 0)
    assert Results.read(path).motors == ()


def test_contacts_of_earlier_files_are_read_without_their_impulse(tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    earlier = replace(contents, quantities=tuple(q for q in contents.quantities if q.since < 8))
    output = make_output(contents, 2)
    write(path, earlier, output, (2,)).finish()
    with h5py.File(path, "a") as file:
        assert "contact_impulse" not in file
        file.attrs["version"] = 7
    results = Results.read(path)
    np.testing.assert_array_equal(results.contact("k0").gap, output.gap[:, 0])
    message = (
        f"{path}: variable 'stop_impulse': expected numbers, found none in a file of version 7; "
        f"files have it since version 8"
    )
    with pytest.raises(ResultsError, match=f"^{message}$"):
        _ = results.stop("e0").impulse
    with pytest.raises(QuantityError, match=f"^impulse:e0: {message}$"):
        evaluate(results, "impulse:e0")
    write(tmp_path / "new.h5", contents, output, (2,)).finish()
    new = Results.read(tmp_path / "new.h5")
    np.testing.assert_array_equal(new.contact("k0").impulse, output.normal_impulse[:, 0])
    np.testing.assert_array_equal(evaluate(new, "impulse:e0").values, new.stop("e0").impulse)


def test_an_earlier_file_stays_until_the_run_has_ended_well(tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    write(path, contents, make_output(contents, 3), (3,)).finish()
    output = make_output(contents, 4, seed=1)
    writer = FileWriter(path, contents, NOTES, "model", 4)
    before = Results.read(path)
    writer.append(batch(output, 0, 4))
    assert len(before.time) == len(Results.read(path).time) == 3
    running = Results.read(tmp_path / "out.h5.partial")
    np.testing.assert_array_equal(running.body("b0").x, output.body_position[:, 0])
    writer.flush()
    writer.finish()
    np.testing.assert_array_equal(Results.read(path).body("b0").x, output.body_position[:, 0])
    with pytest.raises(ResultsError, match="another run has replaced this file: read it again"):
        _ = before.time
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


def test_a_run_that_fails_leaves_its_rows_beside_an_earlier_file_until_the_next(tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    write(path, contents, make_output(contents, 3), (3,)).finish()
    for rows in (4, 2):
        failed = write(path, contents, make_output(contents, rows), (rows,))
        assert failed.place == tmp_path / "out.h5.partial"
        failed.leave()
        assert len(Results.read(path).time) == 3
        assert len(Results.read(failed.place).time) == rows
        assert sorted(entry.name for entry in tmp_path.iterdir()) == ["out.h5", "out.h5.partial"]
    write(path, contents, make_output(contents, 5), (5,)).finish()
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


def test_a_run_without_a_step_leaves_an_earlier_file(tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    first = write(path, contents, make_output(contents, 3), (3,))
    assert not first.abandon()
    first.finish()
    assert FileWriter(path, contents, NOTES, "model", 4).abandon()
    assert len(Results.read(path).time) == 3
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


@pytest.mark.parametrize("earlier", [False, True])
def test_rows_of_a_run_that_goes_on_are_not_abandoned(tmp_path, earlier):
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 4)
    if earlier:
        write(path, contents, output, (4,)).finish()
    first = write(path, contents, output, (4,))
    first.leave()
    again = FileWriter.resume(path, contents, NOTES, "model", Extent(2), first.run)
    assert not again.abandon()
    again.leave()
    assert len(Results.read(first.place).time) >= 2


@pytest.mark.parametrize("earlier", [False, True])
def test_of_two_runs_the_second_is_refused(tmp_path, earlier):
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 4)
    if earlier:
        write(path, contents, output, (1,)).finish()
    first = FileWriter(path, contents, NOTES, "first", 4)
    first.append(batch(output, 0, 2))
    message = f"^{path}: another run writes to this file \\(process {os.getpid()}\\)$"
    with pytest.raises(ResultsError, match=message):
        FileWriter(path, contents, NOTES, "second", 4)
    first.append(batch(output, 2, 2))
    first.finish()
    assert Results.read(path).model == "first"
    np.testing.assert_array_equal(Results.read(path).body("b1").R, output.body_rotation[:, 1])
    FileWriter(path, contents, NOTES, "second", 4).leave()


def test_rows_wait_for_those_who_read(tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 6)
    writer = FileWriter(path, contents, NOTES, "model", 6)
    writer.append(batch(output, 0, 1))
    buffer = make_output(contents, 2, seed=2)
    with h5py.File(path) as reader:
        for first in (1, 3):  # a run uses its buffer again
            for name, array in vars(buffer).items():
                array[:] = getattr(output, name)[first : first + 2]
            steps = batch(output, first, 2).steps
            writer.append(batch(output, first, 2)._replace(steps=steps, output=buffer))
        assert reader["solver"].attrs["written"] == len(reader["time"]) == 1
    assert len(Results.read(path).time) == 1
    writer.append(batch(output, 5, 1))
    np.testing.assert_array_equal(
        Results.read(path).body("b0").v_dot[:, :3], output.body_acceleration[:, 0]
    )


@pytest.mark.parametrize("wait", ["at the end", "with a full buffer"])
def test_readers_who_never_close_the_file_do_not_end_a_run(tmp_path, monkeypatch, wait):
    """They keep the file as it was; the run goes on in a copy."""
    monkeypatch.setattr(file_module, "LOCK_WAIT", 0.01)
    if wait == "with a full buffer":
        monkeypatch.setattr(file_module, "MAX_WAITING_BYTES", 0)
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 4)
    writer = write(path, contents, output, (2,))
    with h5py.File(path) as reader:
        writer.append(batch(output, 2, 1))
        if wait == "at the end":
            writer.flush()
        assert len(Results.read(path).time) == 3
        assert len(reader["time"]) == 2
        np.testing.assert_array_equal(reader["body_position"][:], output.body_position[:2])
    writer.append(batch(output, 3, 1))
    writer.finish()
    np.testing.assert_array_equal(Results.read(path).body("b1").x, output.body_position[:, 1])
    assert [entry.name for entry in tmp_path.iterdir()] == ["out.h5"]


@pytest.mark.parametrize("durable", [False, True])
def test_a_copy_is_on_the_disk_where_the_file_is_to_be(tmp_path, monkeypatch, durable):
    moved = []

    def replace_durably(source, target):
        moved.append(target)
        source.replace(target)

    monkeypatch.setattr(file_module, "LOCK_WAIT", 0.01)
    monkeypatch.setattr(journal_module, "replace_durably", replace_durably)
    path, contents = tmp_path / "out.h5", make_contents()
    writer = FileWriter(path, contents, NOTES, "model", 4, durable)
    writer.append(batch(make_output(contents, 4), 0, 2))
    with h5py.File(path):
        writer.flush()
    assert moved == ([path] if durable else [])
    writer.leave()


def test_writes_are_apart(tmp_path, monkeypatch):
    """Rows that come sooner wait, as they were when they came."""
    monkeypatch.setattr(FileWriter, "pause", float("inf"))
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 9)
    writer = write(path, contents, output, (1,))
    buffer = make_output(contents, 1)
    for first in range(1, 8):
        for name, array in vars(buffer).items():
            array[:] = getattr(output, name)[first]
        writer.append(batch(output, first, 1)._replace(output=buffer))
    assert rows_in(path) == 1
    monkeypatch.setattr(FileWriter, "pause", 0.0)
    writer.append(batch(output, 8, 1))
    assert rows_in(path) == 9
    np.testing.assert_array_equal(Results.read(path).body("b0").x, output.body_position[:, 0])


@pytest.mark.parametrize("room", [0, 3000, 100_000])
def test_a_full_disk_is_one_line_and_keeps_what_was_written(room, tmp_path):
    """At whichever byte it is full; HDF5 itself would bring the process down."""
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 600)
    writer = write(path, contents, output, (3,))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + room, limits[1]))
    try:
        message = f"^{path}: cannot be written: File too large; 3 rows are in it$"
        for _ in range(2):
            with pytest.raises(ResultsError, match=message):
                writer.append(batch(output, 3, 597))
        assert len(Results.read(path).time) == 3
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    writer.leave()
    np.testing.assert_array_equal(Results.read(path).body("b0").x, output.body_position[:3, 0])


@pytest.mark.parametrize("earlier", [False, True])
def test_a_run_that_wrote_no_row_leaves_no_file(earlier, tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    output = make_output(contents, 4000)
    if earlier:
        write(path, contents, output, (3,)).finish()
    writer = FileWriter(path, contents, NOTES, "model", 4000)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (writer.place.stat().st_size, limits[1]))
    try:
        with pytest.raises(ResultsError, match=r"written: File too large$"):
            writer.append(batch(output, 0, 4000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    writer.leave()
    assert [entry.name for entry in tmp_path.iterdir()] == (["out.h5"] if earlier else [])
    assert not earlier or len(Results.read(path).time) == 3


def test_a_link_is_followed(tmp_path):
    path, link, contents = tmp_path / "out.h5", tmp_path / "link.h5", make_contents()
    link.symlink_to(path)
    for rows in (2, 3):
        write(link, contents, make_output(contents, rows), (rows,)).finish()
        assert link.is_symlink()
        assert len(Results.read(path).time) == rows


@pytest.mark.parametrize(
    ("shape", "rows"), [((), 10**7), ((2, 3), 5001), ((2000, 3), 21), ((10**6, 4), 3), ((1, 3), 2)]
)
def test_chunks_are_neither_large_nor_many(shape, rows):
    found = chunks(shape, rows)
    assert len(found) == len(shape) + 1
    assert all(0 < chunk <= size for chunk, size in zip(found, (rows, *shape), strict=True))
    assert 8 * np.prod(found) <= ROW_CHUNK_BYTES
    count = np.prod(np.ceil(np.divide((rows, *shape), found)))
    assert count <= 4 * (8 * rows * np.prod(shape) / ROW_CHUNK_BYTES + 1)


WRITER = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from duhamel.results.file import FileWriter
from tests.results.writing import NOTES, batch, make_contents, make_output
contents = make_contents()
output = make_output(contents, 20_000)
FileWriter.pause = 0.0
writer = FileWriter(Path(sys.argv[1]), contents, NOTES, "model", 20_000)
print("begun", flush=True)
for first in range(0, 20_000, 5):
    writer.append(batch(output, first, 5))
"""


DYING = """
import os, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from duhamel.results.file import FileWriter
from duhamel.results.journal import JournaledFile
from tests.results.writing import NOTES, batch, make_contents, make_output

def die(file, pieces):
    for at, piece in pieces:
        os.pwrite(file._handle, bytes(len(piece)), at)
    os._exit(3)

contents = make_contents()
writer = FileWriter(Path(sys.argv[1]), contents, NOTES, "model", 7)
JournaledFile._replace = die
writer.append(batch(make_output(contents, 7), 0, 7))
writer.flush()
"""
"""a run that dies while it replaces bytes of its file"""
ROOT = os.fspath(__file__).removesuffix("/tests/results/test_file.py")


@pytest.fixture
def half_replaced(tmp_path):
    """The path of results whose run has died, and of the file that it wrote."""

    def half_replaced(earlier):
        path, contents = tmp_path / "out.h5", make_contents()
        if earlier:
            write(path, contents, make_output(contents, 3), (3,)).finish()
        dead = subprocess.run([sys.executable, "-c", DYING, path, ROOT], check=False)
        assert dead.returncode == 3
        file = tmp_path / "out.h5.partial" if earlier else path
        with pytest.raises(OSError, match="signature"):
            h5py.File(file)
        return path, file

    return half_replaced


@pytest.mark.parametrize("earlier", [False, True])
def test_the_next_reader_ends_what_a_killed_run_was_writing(earlier, half_replaced):
    _, file = half_replaced(earlier)
    assert len(Results.read(file).time) == 7
    h5py.File(file).close()


@pytest.mark.parametrize("earlier", [False, True])
def test_the_next_run_passes_over_what_a_killed_one_was_writing_to_a_file_that_is_gone(
    earlier, half_replaced
):
    path, file = half_replaced(earlier)
    file.unlink()
    contents = make_contents()
    write(path, contents, make_output(contents, 5), (5,)).finish()
    assert len(Results.read(path).time) == 5
    assert os.listdir(path.parent) == ["out.h5"]


@pytest.fixture
def running(tmp_path):
    """The path of a file that a process is writing without pause, the process, and the output."""
    path = tmp_path / "out.h5"
    command = [sys.executable, "-c", WRITER, os.fspath(path), ROOT]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "begun\n"
        yield path, process, make_output(make_contents(), 20_000)
        process.kill()


def rows_in(path):
    return int(Results.read(path).solver["written"])


def test_readers_and_the_writer_do_not_fail_for_each_other(running):
    path, process, output = running
    counts = []
    end = time.monotonic() + 60.0
    while len(counts) < 12 or counts[-1] == counts[0]:
        assert time.monotonic() < end
        if n := rows_in(path):
            results = Results.read(path)
            x, t = results.body("b1").x, results.time
            assert len(x) == len(t) >= n
            np.testing.assert_array_equal(x, output.body_position[: len(x), 1])
            counts.append(n)
    assert process.poll() is None


def test_a_writer_that_is_killed_leaves_a_readable_file(running):
    path, process, output = running
    while rows_in(path) < 50:
        assert process.poll() is None
    process.send_signal(signal.SIGKILL)
    process.wait()
    results = Results.read(path)
    n = results.solver["written"]
    assert n >= 50
    assert n % 5 == 0
    np.testing.assert_array_equal(
        results.frame("b0.tip").u[:, :3], output.frame_elastic_displacement[:n, 1]
    )
    np.testing.assert_array_equal(results.iterations, output.newton_iterations[:n])


def test_a_run_that_goes_on_names_the_superelements_of_now(tmp_path):
    path, contents = tmp_path / "out.h5", make_contents()
    writer = write(path, contents, make_output(contents, 4), (4,))
    writer.leave()
    moved = {"b0": SuperelementFile("/elsewhere/0.h5", "1" * 64)}
    later = FileWriter.resume(
        path, replace(contents, superelements=moved), NOTES, "model", Extent(4), writer.run
    )
    later.flush()
    later.leave()
    with h5py.File(path) as file:
        assert file["superelement_file"].asstr()[()].tolist() == ["/elsewhere/0.h5"]
        assert file["superelement_sha256"].asstr()[()].tolist() == ["1" * 64]
