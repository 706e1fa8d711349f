"""Runs of mpiexec, as a user would start them."""

import os
import subprocess
import sys
from pathlib import Path

MPIEXEC = Path(sys.executable).with_name("mpiexec")
PREPROCESS = (sys.executable, "-m", "duhamel.preprocess")
ALONE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def start(processes: int, *command: str) -> subprocess.Popen:
    """Some processes of a command, which end with pipes for what they print."""
    return subprocess.Popen(
        [str(MPIEXEC), "-n", str(processes), *command],
        env={**os.environ, **ALONE},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def run(processes: int, *command: str) -> subprocess.CompletedProcess:
    """The same to their end, which is soon."""
    with start(processes, *command) as running:
        try:
            output, errors = running.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            running.kill()
            raise
    return subprocess.CompletedProcess(command, running.returncode, output, errors)


def messages(errors: str) -> list[str]:
    """What is told of errors, without the progress before it."""
    return [line for line in errors.splitlines() if line.startswith(("error:", "Traceback"))]
