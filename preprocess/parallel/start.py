"""The start of several processes, and how one of them finds the others."""

import atexit
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ...superelement import Superelement
from ..body.body import Body
from ..errors import MethodError
from ..progress import Warn, silent

if TYPE_CHECKING:
    from .ranks import Ranks

NEEDED_PACKAGES = ("mpi4py", "petsc4py")
# Set by the launchers of MPICH, Open MPI, Slurm.
SIZE_VARIABLES = ("PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "PMIX_SIZE")
RANK_VARIABLES = ("PMI_RANK", "OMPI_COMM_WORLD_RANK", "PMIX_RANK")
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


class World:
    """All processes that mpiexec has started, to build one body together."""

    def __init__(self, ranks: "Ranks") -> None:
        self._ranks = ranks
        self._begun = False
        if self.first:
            atexit.register(self._dismiss)

    @property
    def first(self) -> bool:
        """True in the process that reads and writes; the others `follow`."""
        return bool(self._ranks.first)

    def build(self, body: Body, progress: bool = False, on_warning: Warn = silent) -> Superelement:
        """As `preprocess.build`, in the first process, with the others."""
        from .build import build_together

        self._begun = True
        self._ranks.comm.bcast(body)
        found = self._ranks.guarded(lambda: build_together(body, self._ranks, progress, on_warning))
        assert found is not None
        return found

    def follow(self) -> None:
        """What the other processes do: their part of what the first one builds, if it does."""
        from .build import build_together

        body = self._ranks.comm.bcast(None)
        if body is not None:
            self._ranks.guarded(lambda: build_together(body, self._ranks, False, silent))

    def _dismiss(self) -> None:
        if not self._begun:
            self._ranks.comm.bcast(None)


def is_started() -> bool:
    """Whether mpiexec has started this process."""
    return any(name in os.environ for name in RANK_VARIABLES)


def join() -> World:
    """The processes that mpiexec has started, of which this is one.

    `MethodError` where mpi4py or petsc4py is missing, or mpiexec belongs to another MPI.
    """
    _require_installed()
    from mpi4py import MPI

    from .ranks import Ranks

    size = MPI.COMM_WORLD.size
    told = next((os.environ[name] for name in SIZE_VARIABLES if name in os.environ), str(size))
    if told != str(size):
        raise MethodError(
            f"mpiexec has started {told} processes, of which MPI of mpi4py knows {size}: expected "
            f"the mpiexec of the same MPI, {_mpiexec() or 'which is not found'}"
        )
    return World(Ranks(MPI.COMM_WORLD))


def run_on(processes: int, arguments: Sequence[str]) -> int:
    """Run `python -m duhamel.preprocess` with arguments on this machine; its exit code.

    Each process has one thread, unless the environment says otherwise. `MethodError` where mpi4py,
    petsc4py or mpiexec is missing.
    """
    _require_installed()
    mpiexec = _mpiexec()
    if mpiexec is None:
        raise MethodError("--mpi: expected mpiexec beside Python or on the path, found none")
    # -P: without it Python imports first what lies in the folder that the user is in
    python = [sys.executable, "-P", "-m", "duhamel.preprocess"]
    command = [mpiexec, "-n", str(processes), *python]
    environment = {**dict.fromkeys(THREAD_VARIABLES, "1"), **os.environ}
    with subprocess.Popen([*command, *arguments], env=environment) as running:
        try:
            return running.wait()
        except KeyboardInterrupt:
            # mpiexec is interrupted as well, and ends its processes.
            running.wait()
            raise


def _mpiexec() -> str | None:
    """The mpiexec beside Python, where wheels put it, or the one on the path."""
    beside = Path(sys.executable).with_name("mpiexec")
    return str(beside) if beside.is_file() else shutil.which("mpiexec")


def _require_installed() -> None:
    missing = [name for name in NEEDED_PACKAGES if find_spec(name) is None]
    if missing:
        raise MethodError(
            f"MPI: expected {' and '.join(NEEDED_PACKAGES)}, found no {' and no '.join(missing)}: "
            "pip install 'duhamel[mpi]' brings them for Python 3.12 and later on Linux (x86-64)"
        )
