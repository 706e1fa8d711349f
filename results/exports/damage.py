"""Damage of a body as files: a table of its points, and its surface for ParaView."""

import os
from pathlib import Path

import numpy as np

from ...files import write_rows
from ...files.whole_hdf5 import written_whole
from ..fatigue import DamageField
from ..results import Results
from .folder import exported
from .vtkhdf import Cells, Grid


def write_damage(
    results: Results, found: DamageField, folder: str | os.PathLike[str], stem: str
) -> tuple[Path, ...]:
    """Write STEM-BODY-damage.csv and STEM-BODY-damage.vtkhdf into a folder.

    Both have the damage of one run at each point of the recovery, in body axes, and the number of
    its node in the mesh file, 0 where that is not known.

    Raises
    ------
    ExportError
        Where a file cannot be written.
    RecoveryError
        Where the results have no recovery of the body.
    """
    nodes = np.zeros(len(found.points), np.int64) if found.nodes is None else found.nodes
    name = f"{stem}-{found.body}-damage"
    columns = zip(nodes.tolist(), *found.points.T.tolist(), found.damage.tolist(), strict=True)
    cells = results.recoverable(found.body).cells
    with exported(folder) as export:
        with export.file(f"{name}.csv") as path:
            write_rows(path, [("node", "x [m]", "y [m]", "z [m]", "damage"), *columns])
        with export.file(f"{name}.vtkhdf") as path, written_whole(path) as file:
            grid = Grid(file, np.zeros(1), Cells.of_rows(len(found.points), cells), {})
            grid.put(
                found.points[None],
                {"damage": found.damage[None], "node": nodes[None].astype(float)},
            )
    return export.paths
