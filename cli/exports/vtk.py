"""ParaView: `duhamel export --to vtk`."""

from collections.abc import Sequence
from pathlib import Path

import typer

from .export import Asked, export_format

# Unless more are asked for: a run of millions of steps would fill the disk.
MAX_VTK_FRAMES = 200


@export_format(
    "vtk",
    ".vtkhdf",
    "bodies as they move and deform, frames and contacts with their forces, for ParaView (VTKHDF)",
    takes=("window", "film"),
)
def vtk(asked: Asked) -> Sequence[Path]:
    from ...results import write_vtk
    from ...results.steps import evenly

    there = asked.rows.stop - asked.rows.start
    most = there if asked.every else asked.frames or MAX_VTK_FRAMES
    steps = evenly(asked.results.time, asked.rows, most)
    # Who asked for a number of frames knows that some are left out.
    if len(steps) < there and asked.frames is None:
        typer.echo(f"{len(steps)} of {there} steps, evenly over time: --frames or --all for more")
    magnification = 1.0 if asked.magnify is None else asked.magnify
    return write_vtk(asked.results, asked.folder, asked.stem, steps, magnification)
