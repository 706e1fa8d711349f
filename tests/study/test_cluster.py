"""Studies on Dask: as many results as in one process, to the last bit, also where workers die."""

import json
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import dask
import h5py
import pytest
from distributed import LocalCluster
from duhamel.cli import app
from duhamel.solver import read_model, simulate
from duhamel.study import ClusterError, read_study, sweep
from duhamel.study.workers import on_cluster
from typer.testing import CliRunner

from .conftest import MODEL, datasets

LONG = (
    MODEL.replace("t_end = 0.05", "t_end = 3.0").replace("step = 5e-4", "step = 4e-6")
    + "[output]\nevery = 1000\n"
)
"""three quarters of a million steps: seconds of a run, which shows its file after one of them"""
LONG_STUDY = """
model = "model/hub.toml"
parameters.loads.0.signal = [1, 2, 3, 4, 5, 6]
outputs.angle = "final angle:hub:z"
"""


@pytest.fixture
def processes():
    """Starts commands, and ends them."""
    started: list[subprocess.Popen[bytes]] = []

    def start(*command: str | Path) -> subprocess.Popen[bytes]:
        started.append(subprocess.Popen(command, stderr=subprocess.DEVNULL))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()


PATIENCE = 600


def wait_for(condition, seconds=PATIENCE):
    """What a condition gives once it gives anything."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.002)
    raise TimeoutError(f"nothing within {seconds} s")


def unfinished(folder: Path) -> dict[str, str]:
    """The runs that are on their way, by case; a file that is being written shows when it is looked
    at again.
    """
    runs = {}
    for path in folder.glob("*.h5"):
        with suppress(OSError), h5py.File(path) as file:
            if not file["solver"].attrs["finished"]:
                runs[path.stem] = file["solver"].attrs["run"]
    return runs


def test_a_worker_killed_in_mid_run_loses_nothing_but_its_case(study_file, folder, processes):
    (folder / "model" / "hub.toml").write_text(LONG)
    path, address, bin = (
        study_file(LONG_STUDY),
        folder / "scheduler.json",
        Path(sys.executable).parent,
    )
    on_loopback = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    processes(bin / "dask", "scheduler", *on_loopback, "--scheduler-file", address)
    tcp = wait_for(
        lambda: address.exists() and json.loads(address.read_text() or "{}").get("address")
    )
    worker = [
        bin / "dask",
        "worker",
        "--scheduler-file",
        address,
        "--nthreads",
        "1",
        "--no-nanny",
        "--no-dashboard",
    ]
    doomed, survivor = processes(*worker), processes(*worker)
    study = processes(bin / "duhamel", "sweep", path, "--scheduler", tcp)

    def both_in_mid_run() -> dict[str, str]:
        """Two runs on their way while a worker is stopped: one of them is the one that it will not
        finish.
        """
        if study.poll() is None and len(unfinished(path.with_suffix(""))) == 2:
            doomed.send_signal(signal.SIGSTOP)
            if len(runs := unfinished(path.with_suffix(""))) == 2:
                return runs
            doomed.send_signal(signal.SIGCONT)
        return {}

    begun = wait_for(both_in_mid_run)
    doomed.kill()
    assert study.wait(timeout=PATIENCE) == 0
    assert survivor.poll() is None
    cases = read_study(path).cases
    ended = {}
    for case in cases:
        simulate(read_model(case.source), output=folder / "alone.h5")
        assert datasets(folder / "alone.h5") == datasets(case.target)
        with h5py.File(case.target) as file:
            ended[case.name] = file["solver"].attrs["run"]
    assert [ended[name] == run for name, run in begun.items()].count(
        False
    ) == 1  # that case alone was begun again


def test_a_case_that_kills_the_workers_of_a_cluster_is_reported(study_file, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parent)  # workers import what they are to do
    from deadly import Deadly

    cases = read_study(study_file()).cases[:2]
    cases[0].folder.mkdir()
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster,
    ):
        found = on_cluster(Deadly("case-0001"), cases, cluster.scheduler_address)
        reports = {case.name: report.failure for case, report in found}
    assert reports["case-0001"].startswith("KilledWorker: ")
    assert reports["case-0002"] == ""
    lives = [(case.folder / f"{case.name}.lives").read_text() for case in cases]
    assert lives == ["11", "1"]


def test_a_scheduler_that_is_not_there_is_told(study_file, monkeypatch):
    monkeypatch.setattr("duhamel.study.workers.MAX_SCHEDULER_WAIT", 1)
    with pytest.raises(ClusterError, match=r"^tcp://127\.0\.0\.1:1: no scheduler"):
        sweep(read_study(study_file()), scheduler="tcp://127.0.0.1:1")


def test_the_command_without_dask_names_the_extra_and_the_way_around(study_file, monkeypatch):
    path = study_file()
    monkeypatch.setitem(sys.modules, "distributed", None)
    result = CliRunner().invoke(app, ["sweep", str(path), "--scheduler", "tcp://127.0.0.1:1"])
    assert result.exit_code == 1
    assert "pip install 'duhamel[cluster]', or no --scheduler" in result.stderr
    result = CliRunner().invoke(app, ["sweep", str(path), "--workers", "2"])
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith(f"{path.with_suffix('') / 'summary.csv'}: 6 cases, 0 failed")


def test_the_command_tells_failures_and_exits_with_one(study_file):
    path = study_file(LONG_STUDY.replace("[1, 2, 3, 4, 5, 6]", '[1, "x"]'))
    result = CliRunner().invoke(app, ["sweep", str(path), "--workers", "0"])
    assert result.exit_code == 1
    assert result.stderr.startswith("failed: case-0002: ")
    assert "2 cases, 1 failed" in result.stdout


def test_a_scheduler_brings_its_own_workers(study_file):
    result = CliRunner().invoke(
        app, ["sweep", str(study_file()), "--workers", "0", "--scheduler", "tcp://127.0.0.1:1"]
    )
    assert result.exit_code == 2
    assert "expected one of --workers and --scheduler" in " ".join(
        result.stderr.replace("│", " ").split()
    )
