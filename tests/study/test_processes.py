"""Processes of this machine that make the cases of a study."""

import multiprocessing
import struct
from pathlib import Path
from types import SimpleNamespace

import pytest
from duhamel.solver import read_model, simulate
from duhamel.study import read_study, sweep
from duhamel.study.processes import BYTES_OF_PROCESS, SPAWN_CONTEXT, _cores, _Queue, on_processes
from duhamel.study.processes import _report as report_of
from duhamel.study.workers import Report

from .conftest import datasets


def test_they_write_what_runs_alone_do(study_file):
    rows = sweep(read_study(study_file()), workers=2)
    for row in rows:
        simulate(read_model(row.case.source), output=row.case.folder / "alone.h5")
        assert datasets(row.case.folder / "alone.h5") == datasets(row.case.target)


def test_a_case_that_kills_its_workers_is_reported_and_the_others_run(study_file, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)  # processes import what they are to do
    from deadly import Deadly

    cases = read_study(study_file()).cases[:3]
    cases[0].folder.mkdir()
    reports = {
        case.name: report for case, report in on_processes(Deadly("case-0002"), cases, workers=1)
    }
    assert reports["case-0002"].failure == "4 processes died of it"
    assert [reports[name].failure for name in ("case-0001", "case-0003")] == ["", ""]
    lives = [(case.folder / f"{case.name}.lives").read_text() for case in cases]
    assert lives == ["1", "1111", "1"]


def test_what_lacks_memory_runs_once_more_alone_and_last(study_file, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)
    from deadly import Greedy

    cases = read_study(study_file()).cases[:3]
    cases[0].folder.mkdir()
    running = on_processes(Greedy("case-0002"), cases, workers=2)
    reports = {case.name: report.failure for case, report in running}
    assert reports == {"case-0001": "", "case-0002": "case-0002", "case-0003": ""}
    assert {(case.folder / f"{case.name}.lives").read_text() for case in cases} == {"11"}


def test_a_case_that_gets_all_the_machine_waits_for_the_others():
    queue = _Queue([SimpleNamespace(name="a"), SimpleNamespace(name="b")])
    first, second = queue.next(0, 2), queue.next(1, 2)
    assert queue.takes_back(first, Report("out of memory", lacks_memory=True))
    assert queue.next(1, 2) is None
    assert not queue.takes_back(second, Report())
    assert queue.next(0, 2) is first
    assert not queue.takes_back(first, Report("out of memory", lacks_memory=True))


def test_there_are_no_more_processes_than_the_memory_is_good_for(monkeypatch):
    monkeypatch.setattr("duhamel.study.processes.available", lambda: 1.5 * BYTES_OF_PROCESS)
    assert _cores() == 1


def test_nothing_outside_reaches_the_processes_of_a_sweep(study_file, monkeypatch):
    """Neither this process nor its workers listen, to the network or to a socket of the machine."""
    monkeypatch.syspath_prepend(Path(__file__).parent)
    from deadly import Listening

    cases = read_study(study_file()).cases[:2]
    cases[0].folder.mkdir()
    reports = [report.failure for _, report in on_processes(Listening("any"), cases, workers=2)]
    assert reports == ["", ""]
    assert [case.source.with_suffix(".listens").read_text() for case in cases] == ["[]", "[]"]


def test_processes_import_nothing_from_the_folder_of_the_user(study_file, tmp_path, monkeypatch):
    folder = tmp_path / "theirs"
    folder.mkdir()
    (folder / "multiprocessing.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    study = read_study(study_file())
    monkeypatch.chdir(folder)
    assert {row.status for row in sweep(study, workers=1)} == {"done"}
    assert not (tmp_path / "ran").exists()


def test_processes_end_with_the_sweep(study_file, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)
    from deadly import Deadly

    cases = read_study(study_file()).cases[:3]
    cases[0].folder.mkdir()
    before = set(multiprocessing.active_children())
    running = on_processes(Deadly("none"), cases, workers=2)
    next(running)
    assert set(multiprocessing.active_children()) > before
    running.close()
    assert set(multiprocessing.active_children()) == before


@pytest.mark.parametrize("said", [b"", struct.pack("!i", 100), struct.pack("!i", 100) + b"half"])
def test_a_process_that_dies_while_it_reports_has_died(said):
    """Connections send the number of bytes ahead of them."""
    near, far = SPAWN_CONTEXT.Pipe()
    far._send(said)
    far.close()
    worker = SimpleNamespace(pipe=near, stop=near.close)
    assert report_of(worker) is None
