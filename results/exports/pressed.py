"""Surfaces in contact as they move, with pressures, as VTKHDF files for ParaView."""

from pathlib import Path

import numpy as np

from ...files.arrays import Array, Index, IntArray
from ...files.whole_hdf5 import written_whole
from ..pressed import Pressed
from ..recovery import in_space
from ..results import Results
from ..steps import batches
from .vtkhdf import BATCH_POINTS, Cells, Grid

OF_ROWS = {"pressure": "pressure", "gap": "gaps", "traction": "traction"}
"""fields of corners, and the quantities that they are"""


def write_pressed(
    results: Results, pressed: tuple[Pressed, ...], path: Path, steps: Index, magnification: float
) -> None:
    """A grid of surfaces in contact, with pressures, gaps and tractions at their nodes.

    Their numbers are a field of the cells. Where a surface is far from what it meets, its nodes are
    where its body as a rigid one has them.
    """
    parts = [Cells.of_rows(one.surface.n, one.surface.facets) for one in pressed]
    cells = Cells.joined(parts)
    numbers: IntArray = np.repeat(np.arange(len(pressed)), [len(part) for part in parts])
    with written_whole(path) as file:
        grid = Grid(file, results.time[steps], cells, {"contact": numbers})
        for rows in batches(len(steps), BATCH_POINTS // max(cells.points, 1)):
            moved = [_at(results, one, steps[rows], magnification) for one in pressed]
            fields = {
                name: np.concatenate([own[name] for own in moved], axis=1) for name in moved[0]
            }
            grid.put(fields.pop("position"), fields)


def _at(results: Results, pressed: Pressed, steps: Index, magnification: float) -> dict[str, Array]:
    """Positions in space and fields of the nodes of a surface at some steps (k, n, ...)."""
    x, R = (
        _read(results, f"body_{name}", steps, pressed.body) for name in ("position", "rotation")
    )
    known = _read(results, "surface_contact_node_displacement", steps, pressed.contact)
    u = np.nan_to_num(known, nan=0.0)
    fields = {"position": in_space(x, R, pressed.surface.X + magnification * u)}
    fields["displacement"] = in_space(np.zeros_like(x), R, u)
    by_rows = pressed.by_rows
    for name, quantity in OF_ROWS.items():
        values = _read(results, f"surface_contact_{quantity}", steps, pressed.contact)
        fields[name] = np.einsum("ir,kr...->ki...", by_rows, values)
    return fields


def _read(results: Results, variable: str, steps: Index, owner: str) -> Array:
    """What of a variable belongs to an owner, at some steps."""
    return np.concatenate(
        [results.variable(variable, slice(k, k + 1), owner) for k in steps.tolist()]
    )
