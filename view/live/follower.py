"""The news of a run that still writes its results: the newest motion, plots, validity."""

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...files.arrays import Array
from ...results import QuantityError, Results, SeriesError
from ...results.excerpt import Excerpt
from ...results.file import FileSource
from ...results.steps import evenly
from ..errors import PictureError
from ..report.motion import MAX_DEFORMING_POINTS, Motion, staged
from ..report.plots import drawing, overview_plots, plot_of
from ..report.scene import cameras, movements, names, placed
from ..report.tables import validity_table
from ..space.stage import NO_FIELD, Stage, magnification

# Of an answer: the page asks about once a second.
MOST_INSTANTS = 30
# Of an answer: those of a short time, however many rows the run has.
MOST_ROWS = 20_000
# Points of deforming surfaces times instants of an answer, some 4 MB.
MOST_POINT_INSTANTS = 250_000
# Their scale, and how far floors reach, are known at the end of a run alone.
MARKS_LEFT_OUT = ("forces",)


class RunFollower:
    """Reads what is new in the results of a run.

    Deformations are interpolated between interfaces: modes would take all steps of the run.
    """

    def __init__(self) -> None:
        # All grow or fall with the run, so that scales do not go back and forth.
        self._deformation, self._magnification = 0.0, 1.0
        self._box: tuple[Array, ...] = ()

    def motion(self, path: Path, first: int) -> tuple[Motion, int] | None:
        """The motion from a row on, after that of the start, and how many rows there are.

        Of very many new rows the last ones; None if there are none.
        """
        source = FileSource(path)
        rows = source.extent.rows
        if rows <= first:
            return None
        results = Results(Excerpt(source, max(first, rows - MOST_ROWS), rows))
        try:
            return self._staged(results), rows
        except PictureError:  # of a run that records no body
            return None

    def _staged(self, results: Results) -> Motion:
        time = results.time
        flexible = [name for name in results.bodies if results.outline_source(name) != "rigid"]
        points = sum(len(results.outline(name).points) for name in flexible)
        most = MOST_POINT_INSTANTS // max(min(points, MAX_DEFORMING_POINTS), 1)
        new = evenly(time, slice(min(1, len(time) - 1), None), min(max(most, 2), MOST_INSTANTS))
        # The start is among them: what is drawn is chosen by the first instant.
        stage = self._stage(results, np.unique([time[0], *time[new]]))
        stage.marks = tuple(mark for mark in stage.marks if mark.kind not in MARKS_LEFT_OUT)
        found = staged(results, stage, stage, known=self._box)
        self._box = found.box
        return found

    def _stage(self, results: Results, times: Array) -> Stage:
        """The stage with deformations as much larger as the largest one so far allows."""
        stage = Stage(results, times, NO_FIELD, self._magnification)
        found = [body.largest_deformation(rows) for body in stage.bodies for rows in stage.rows]
        self._deformation = max(self._deformation, *found)
        wanted = magnification(self._deformation, stage.size)
        if wanted != self._magnification:
            self._magnification = wanted
            stage = Stage(results, times, NO_FIELD, wanted)
        return stage


def told(motion: Motion) -> dict[str, Any]:
    """The instants of a motion after its first one, as the script of the page takes them."""
    return {
        "instants": motion.time[1:].tolist(),
        "parts": [
            {"matrices": _packed(moved.matrices), "vertices": _packed(moved.vertices)}
            for moved in movements(motion)
        ],
        "marks": names(motion),
        "middles": np.mean([shape.poses[1:, :3, 3] for shape in motion.shapes], axis=0).tolist(),
        "cameras": {name: placed(camera) for name, camera in cameras(motion).items()},
        "magnification": motion.moving.magnification,
    }


def plots_and_validity(path: Path, quantities: Sequence[str]) -> dict[str, Any]:
    """Curves of the whole run so far: of these quantities, and of what is shown unasked."""
    results = Results.read(path)
    plots, refused = [], []
    for quantity in quantities:
        try:
            plots.append(plot_of(results, quantity))
        except (QuantityError, SeriesError) as error:
            refused.append(str(error))
    plots += overview_plots(results)
    return {
        "plots": [drawing(plot, results.time) for plot in plots],
        "refused": refused,
        "validity": validity_table(results),
    }


def _packed(values: Array | None) -> dict[str, Any] | None:
    if values is None:
        return None
    new = np.ascontiguousarray(values[1:], dtype="<f4")
    return {"shape": new.shape, "data": base64.b64encode(new.tobytes()).decode("ascii")}
