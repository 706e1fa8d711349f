"""Commands write, replace and continue files with what Windows has; see tests/windows.py."""

import os
import shutil
import sys

import numpy as np
import pytest
from duhamel.cli import app
from duhamel.files import renamed_when_whole
from duhamel.files.handles import LOCKED_BYTE, lock
from duhamel.results import Results

from ..windows import behave_like_windows

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")

MODEL = """
[simulation]
t_end = 0.05
step = 1e-4
checkpoint = 0.01
gravity = [0, 0, -9.81]

[bodies.ball]
mass = 1.0
inertia = [1e-3, 1e-3, 1e-3]
"""
STUDY = """
model = "ball.toml"

[parameters]
"bodies.ball.mass" = [1.0, 2.0]

[outputs]
depth = "min position:ball:z"
"""


@pytest.fixture
def windows(monkeypatch, tmp_path):
    (tmp_path / "ball.toml").write_text(MODEL)
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as changed:
        behave_like_windows(changed)
        yield tmp_path


def call(runner, *words):
    done = runner.invoke(app, list(words))
    assert done.exit_code == 0, done.output
    return done


def test_a_run_replaces_earlier_results_and_leaves_nothing_beside_them(windows, runner):
    for _ in range(2):  # the second beside the results of the first, which stay until it ends
        call(runner, "run", "ball.toml")
    assert {path.suffix for path in windows.iterdir()} <= {".toml", ".h5", ".checkpoint"}
    assert not list(windows.glob(".*"))
    results = Results.read(windows / "ball-results.h5")
    assert results.body("ball").position[-1, 2] == pytest.approx(-0.5 * 9.81 * 0.05**2, rel=1e-6)


def test_a_run_is_continued_from_its_state(windows, runner):
    call(runner, "run", "ball.toml")
    text = (windows / "ball.toml").read_text()
    (windows / "ball.toml").write_text(text.replace("t_end = 0.05", "t_end = 0.08"))
    call(runner, "run", "ball.toml", "--continue", "--anyway")
    results = Results.read(windows / "ball-results.h5")
    assert results.time[-1] == pytest.approx(0.08)
    assert np.all(np.diff(results.time) > 0.0)


def test_results_are_checked_plotted_and_exported(windows, runner):
    call(runner, "check", "ball.toml")
    call(runner, "run", "ball.toml")
    call(runner, "plot", "ball-results.h5", "position:ball:z")
    for _ in range(2):
        call(runner, "export", "ball-results.h5", "tables", "--to", "csv")
    assert (windows / "tables" / "bodies.csv").exists()


def test_a_study_runs(windows, runner):
    (windows / "study.toml").write_text(STUDY)
    call(runner, "sweep", "study.toml", "--workers", "1")
    assert len(list((windows / "study").glob("*.h5"))) == 2


def test_files_of_processes_that_have_died_are_removed(windows):
    path = windows / "body.txt"
    with renamed_when_whole(path) as temporary:
        left = temporary.with_name(temporary.name.replace(f"{os.getpid()}.", "999999."))
        left.write_text("half")
        own = temporary.with_name(f"{temporary.name}x")
        shutil.copy(left, own)
        temporary.write_text("whole")
    with renamed_when_whole(path) as temporary:
        temporary.write_text("whole")
    assert not left.exists()
    assert own.exists()


def test_a_file_is_locked_by_a_byte(windows, monkeypatch):
    """As msvcrt does it: at the place where the handle stands."""
    locked = []

    class Msvcrt:
        LK_NBLCK = 2

        @staticmethod
        def locking(handle, mode, n):
            place = os.lseek(handle, 0, os.SEEK_CUR)
            if place in locked:
                raise OSError(13, "Permission denied")
            locked.append(place)

    monkeypatch.setitem(sys.modules, "msvcrt", Msvcrt)
    handle = os.open(windows / "file", os.O_RDWR | os.O_CREAT)
    assert lock(handle)
    assert locked == [LOCKED_BYTE]
    assert not lock(handle)
    os.close(handle)


def test_results_that_another_program_has_open_stay_and_the_new_ones_lie_beside(windows, runner):
    call(runner, "run", "ball.toml")
    with (windows / "ball-results.h5").open("rb"):
        done = runner.invoke(app, ["run", "ball.toml"])
    assert done.exit_code == 1
    assert "ball-results.h5: cannot be written: The process cannot access the file" in done.stderr
    assert (windows / "ball-results.h5.partial").exists()
    call(runner, "run", "ball.toml")
    assert not (windows / "ball-results.h5.partial").exists()
