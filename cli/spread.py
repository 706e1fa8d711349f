"""`duhamel preprocess` on several processes of MPI."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from .failures import INTERRUPTED_CODE, one_line

if TYPE_CHECKING:
    from ..superelement import Superelement


def run_spread(processes: int, body_file: Path, output: Path | None) -> None:
    """Run the command by mpiexec, and end as it does; `PreprocessError` where MPI is missing."""
    from ..preprocess.parallel.start import run_on

    target = [] if output is None else ["-o", str(output)]
    code = run_on(processes, [str(body_file), *target])
    # With these the first process has told why itself.
    if code not in (0, 1, INTERRUPTED_CODE):
        told = (
            f"error: {body_file}: mpiexec ended with {code}: a process was killed, perhaps for "
            "want of memory, and no superelement is written"
        )
        typer.echo(one_line(told), err=True)
        code = 1
    raise typer.Exit(code)


def spread_build() -> "Callable[..., Superelement] | None":
    """What builds a superelement here: `preprocess.build`, or all processes of mpiexec together.

    None in those that have followed the first one, until it had no more to build.
    """
    from .. import preprocess
    from ..preprocess.parallel.start import is_started, join

    if not is_started():
        return preprocess.build
    world = join()
    if world.first:
        return world.build
    world.follow()
    return None
