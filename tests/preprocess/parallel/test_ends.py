"""How several processes end: with one message, none of them left, and nothing half-written."""

import subprocess
import sys
import time

import psutil
import pytest
from duhamel.superelement import read

from .mpi import PREPROCESS, messages, run, start

pytest.importorskip("petsc4py")

ONE_FAILS = """
import sys
from mpi4py import MPI
from duhamel.preprocess.parallel.ranks import Ranks

ranks = Ranks(MPI.COMM_WORLD)

def work():
    if ranks.comm.rank == int(sys.argv[1]):
        raise SystemExit("error: out of wits")
    ranks.comm.barrier()

ranks.guarded(work)
"""


def refused(body_file):
    """The message with which two processes refuse a body file."""
    target = body_file.with_suffix(".h5")
    target.write_bytes(b"as it was")
    done = run(2, *PREPROCESS, str(body_file))
    assert done.returncode == 1, done.stderr
    assert done.stdout == ""
    assert target.read_bytes() == b"as it was"
    assert [path.name for path in body_file.parent.glob("*.h5*")] == [target.name]
    (message,) = messages(done.stderr)
    return message.removeprefix("error: ")


def test_an_error_in_the_body_file_is_told_once(bar):
    body_file = bar({"rho = 2700.0": "rh0 = 2700.0"})
    assert refused(body_file).startswith(f"{body_file}: materials.back: unknown key 'rh0'")


def test_an_error_of_a_selection_is_told_once(bar):
    body_file = bar({'group = "tip"': 'group = "top"'})
    told = refused(body_file)
    assert told.startswith(f"{body_file}: ")
    assert "no group 'top'" in told


def test_an_error_that_all_find_is_told_once(bar):
    told = refused(bar({"E = 2.1e11": "E = 1e200"}))
    assert "expected a stiffness up to" in told


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        (
            {
                'method = "krylov"': 'method = "rubin"\nmodes = 4',
                "tolerance = 1e-5\n": "",
                "band = 10000\n": "",
            },
            "impulse.method rubin",
        ),
        ({"[impulse]": "[rotation]\n\n[impulse]"}, "[rotation]"),
    ],
)
def test_what_takes_one_process_is_refused_by_its_key(bar, changes, key):
    told = refused(bar(changes))
    assert key in told
    assert "takes one process" in told


@pytest.mark.parametrize("failing", [0, 1])
def test_a_process_that_fails_ends_the_others(failing):
    done = run(2, sys.executable, "-c", ONE_FAILS, str(failing))
    assert messages(done.stderr) == ["error: out of wits"]
    assert done.returncode != 0


@pytest.mark.parametrize("killed", [0, 1])
def test_a_process_that_is_killed_ends_the_others(bar, killed):
    # Some ten seconds of work a process, for it must not end before two of them are seen.
    body_file = bar(
        {"band = 10000": "band = 45000", "tolerance = 1e-5": "tolerance = 1e-12"}, (24, 8, 8)
    )
    with start(2, *PREPROCESS, str(body_file)) as running:
        ranks = at_work(running)
        ranks[killed].kill()
        running.communicate(timeout=60)
    assert running.returncode != 0
    psutil.wait_procs(ranks, timeout=10)
    assert not any(rank.is_running() for rank in ranks)
    assert list(body_file.parent.glob("*.h5*")) == []


def at_work(running):
    """The processes that mpiexec has started, once each has worked for two seconds."""
    until = time.monotonic() + 60.0
    while time.monotonic() < until and running.poll() is None:
        below = psutil.Process(running.pid).children(recursive=True)
        ranks = [child for child in below if "duhamel.preprocess" in command_of(child)]
        if len(ranks) == 2 and all(rank.cpu_times().user > 2.0 for rank in ranks):
            return ranks
        time.sleep(0.05)
    raise AssertionError("the processes have not begun")


def command_of(process):
    """Its words; none of one that has ended since it was listed."""
    try:
        return process.cmdline()
    except psutil.Error:
        return []


def test_the_command_starts_the_processes_itself(bar):
    body_file = bar()
    target = body_file.with_name("other.h5")
    command = [sys.executable, "-m", "duhamel", "preprocess", str(body_file), "--mpi", "2"]
    done = subprocess.run([*command, "-o", str(target)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].startswith(f"{target}: 12 dofs, ")
    assert [path.name for path in body_file.parent.glob("*.h5")] == ["other.h5"]
    told = subprocess.run(
        [*command[:4], str(body_file.with_name("none.toml")), "--mpi", "2"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert told.returncode == 1
    assert len(messages(told.stderr)) == 1


def test_without_mpiexec_one_process_builds(bar):
    body_file = bar()
    done = subprocess.run([*PREPROCESS, str(body_file)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "PETSc" not in read(body_file.with_suffix(".h5")).provenance.versions.get(
        "factorization", ""
    )
