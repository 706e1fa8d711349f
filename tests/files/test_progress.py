"""How far work is: the time that remains, lines in logs, a bar on a terminal."""

import io
import sys
import time
from threading import Event

import pytest
from duhamel.files.progress import Progress, Work, clock

LONG = 60.0
"""seconds after which what was waited for will not come"""


def times(*readings):
    """A clock that shows these times, one after the other."""
    return iter(readings).__next__


def wait_for(condition, value):
    """What is there once it is as it should be."""
    end = time.monotonic() + LONG
    while not condition(there := value()):
        assert time.monotonic() < end, there
        time.sleep(0.01)
    return there


def test_the_time_that_remains_is_that_of_the_parts_that_took_time():
    work = Work(total=10, unit="cases")
    work.advance(free=True)
    assert work.remaining(work._started + 6.0) is None
    work.advance()
    work.advance()
    assert work.remaining(work._started + 6.0) == pytest.approx(3.0 * 7)


def test_work_of_counted_parts_tells_their_number_and_the_time_that_remains():
    work = Work(total=10, unit="cases", now=times(0.0, 6.0))
    work.advance(free=True)
    work.advance(2)
    assert str(work) == "3 of 10 cases, 0:21 left"


@pytest.mark.parametrize(("seconds", "shown"), [(9.4, "0:09"), (119.6, "2:00"), (7322, "2:02:02")])
def test_times_are_those_of_a_clock(seconds, shown):
    assert clock(seconds) == shown


def test_work_of_unknown_length_says_how_long_it_lasts_so_far():
    work = Work("impulse", now=times(100.0, 175.0))
    work.note = "40 modes"
    assert str(work) == "impulse: 40 modes, 1:15 so far"


def test_work_of_many_steps_is_told_in_percent():
    work = Work("simulating", 3000, now=times(0.0, 4.0))
    work.advance(750)
    assert str(work) == "simulating: 25 %, 0:12 left"


def test_work_of_no_steps_is_told_too():
    assert str(Work("simulating", 0)).startswith("simulating: 0 %")


def test_a_quick_piece_of_work_says_nothing(capsys, monkeypatch):
    monkeypatch.setattr("duhamel.files.progress.LINE_INTERVAL", 3600.0)
    with Progress(Work("quick", 2)) as work:
        work.advance(2)
    assert capsys.readouterr().err == ""


def test_work_that_is_not_shown_says_nothing(capsys, monkeypatch):
    monkeypatch.setattr("duhamel.files.progress.LINE_INTERVAL", 0.01)
    with Progress(Work("silent", 2), shown=False):
        time.sleep(0.05)
    assert capsys.readouterr().err == ""


def test_without_a_terminal_lines_are_told_and_no_bar(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    monkeypatch.setattr("duhamel.files.progress.LINE_INTERVAL", 0.02)
    with Progress(Work("simulating", 4)) as work:
        work.advance(1)
        told = wait_for(lambda text: text.count("\n") >= 2, sys.stderr.getvalue)
    lines = told.splitlines()
    assert {line.partition(",")[0] for line in lines} == {"simulating: 25 %"}


def test_a_terminal_has_a_bar_that_goes_when_the_work_ends(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr("duhamel.files.progress.BAR_DELAY", 0.0)
    with Progress(Work("simulating [1]", 4)) as work:
        work.advance(1)
        wait_for(lambda text: "simulating [1]: 25 %" in text, terminal.getvalue)
    assert terminal.getvalue().rstrip().endswith("\x1b[2K")


def test_a_pipe_that_nobody_reads_does_not_end_the_work(monkeypatch):
    tried = Event()

    class Broken(io.StringIO):
        def write(self, text):
            tried.set()
            raise BrokenPipeError

    monkeypatch.setattr(sys, "stderr", Broken())
    monkeypatch.setattr("duhamel.files.progress.LINE_INTERVAL", 0.01)
    with Progress(Work("simulating", 4)) as work:
        assert tried.wait(LONG)
        work.advance(4)
    assert work.done == 4
