"""Bodies, frames and contacts as they move, as VTKHDF files for ParaView."""

import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...files import write_rows
from ...files.arrays import Array, Index, IntArray
from ...files.whole_hdf5 import written_whole
from ...superelement import von_mises
from ..errors import ExportError, RecoveryError
from ..pressed import Pressed, pressed_surfaces
from ..recovery import in_space
from ..results import Results
from ..steps import batches
from .folder import exported
from .pressed import write_pressed
from .vtkhdf import BATCH_POINTS, Cells, Grid

# VTK has xx, yy, zz, xy, yz, xz; stresses here are xx, yy, zz, yz, xz, xy.
VTK_STRESS_ORDER = [0, 1, 2, 5, 3, 4]
NUMBERS_OF_SOURCES = {"rigid": 0, "recovery": 1, "interfaces": 2}
EQUIVALENT, TENSOR = "von_mises", "stress"
# 32 MiB: up to here rows are read with all those between them, longer ranges are halved.
SCATTERED_READ_NUMBERS = 1 << 22
Fields = dict[str, Array]


def write_vtk(
    results: Results,
    folder: str | os.PathLike[str],
    name: str,
    steps: Index,
    magnification: float = 1.0,
) -> tuple[Path, ...]:
    """Write the motion at some recorded steps for ParaView.

    NAME.vtkhdf has the outlines of all recorded bodies, NAME-points.vtkhdf recorded frames and
    contacts as points, with their forces, NAME-surfaces.vtkhdf surfaces in contact with their
    pressures, where the run recorded their `nodes`, and NAME-names.csv the names of bodies, points
    and surfaces by their numbers.

    Parameters
    ----------
    results : Results
    folder : path
    name : str
    steps : (k,) of int
        Rows of the recorded steps.
    magnification : float
        Of elastic displacements, in positions alone.

    Returns
    -------
    tuple of Path

    Raises
    ------
    ExportError
        Where the run recorded neither bodies nor frames, or a file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import duhamel as du
    >>> import numpy as np
    >>> m = du.Mechanism()
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.5).results
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in write_vtk(results, folder, "run", np.arange(3))]
    ['run.vtkhdf', 'run-names.csv']
    """
    bodies, points, pressed = results.bodies, _points(results), pressed_surfaces(results)
    if not bodies and not points:
        raise ExportError(
            "the run recorded no body, frame or contact, so there is nothing to export"
        )
    with exported(folder) as export:
        if bodies:
            with export.file(f"{name}.vtkhdf") as path:
                _write_bodies(results, path, steps, magnification)
        if points:
            with export.file(f"{name}-points.vtkhdf") as path:
                _write_points(results, path, steps)
        if pressed:
            with export.file(f"{name}-surfaces.vtkhdf") as path:
                write_pressed(results, pressed, path, steps, magnification)
        with export.file(f"{name}-names.csv") as path:
            write_rows(path, _names(results, pressed))
    return export.paths


def _write_bodies(results: Results, path: Path, steps: Index, magnification: float) -> None:
    """A grid of all bodies; their numbers are a field of the cells."""
    bodies, times = results.bodies, results.time[steps]
    outlines = [results.outline(body) for body in bodies]
    parts = [Cells.of_rows(len(outline.points), outline.cells) for outline in outlines]
    cells = Cells.joined(parts)
    numbers = np.repeat(np.arange(len(bodies)), [len(part) for part in parts])
    sources = np.array([NUMBERS_OF_SOURCES[results.outline_source(body)] for body in bodies])
    of_cells = {"body": numbers, "deformation": sources[numbers]}
    known = _Stresses(results, parts, times[:1])
    with written_whole(path) as file:
        grid = Grid(file, times, cells, of_cells)
        for rows in batches(len(steps), BATCH_POINTS // max(cells.points, 1)):
            t = times[rows]
            motions = _motions(results, steps[rows], t, magnification)
            positions, u, v = (np.concatenate(each, axis=1) for each in zip(*motions, strict=True))
            fields = {"displacement": u, "velocity": v, **known.at(t)}
            for name, values in _recorded(results, "bodies", steps[rows]).items():
                fields[name] = np.repeat(values, [part.points for part in parts], axis=1)
            grid.put(positions, fields)


class _Motion(NamedTuple):
    """Positions [m], elastic displacements [m] and velocities [m/s] (k, p, 3), in space."""

    position: Array
    displacement: Array
    velocity: Array


def _motions(results: Results, steps: Index, t: Array, magnification: float) -> Iterator[_Motion]:
    """Those of each body at some steps (k,), of which all bodies are read together."""
    width = 4 * len(results.bodies)
    names = ("position", "rotation", "velocity", "angular_velocity")
    read = [_at(results, f"body_{name}", steps, width) for name in names]
    for number, body in enumerate(results.bodies):
        x, R, v, omega = (values[:, number] for values in read)
        X, nowhere = results.outline(body).points, np.zeros_like(x)
        at_rest = in_space(x, R, X[None])
        if results.outline_source(body) == "rigid":
            turning = in_space(v, R, np.cross(omega[:, None], X))
            yield _Motion(at_rest, np.zeros_like(at_rest), turning)
        else:
            u = in_space(nowhere, R, results.outline_displacement(body, t))
            yield _Motion(at_rest + magnification * u, u, results.outline_velocity(body, t))


class _Stresses:
    """Equivalent stresses and, of solids, stresses in body axes [Pa], of those that are known."""

    def __init__(self, results: Results, parts: Sequence[Cells], start: Array) -> None:
        self._results = results
        self._points = {body: p.points for body, p in zip(results.bodies, parts, strict=True)}
        self._known = {body: self._of(body, start) for body in results.bodies}
        found = {name for of_body in self._known.values() for name in of_body}
        self._names = [name for name in (EQUIVALENT, TENSOR) if name in found]

    def at(self, t: Array) -> Fields:
        """Of all points (k, p) and (k, p, 6), not a number where they are unknown."""
        parts: dict[str, list[Array]] = {name: [] for name in self._names}
        for body, points in self._points.items():
            found = self._of(body, t) if self._known[body] else {}
            for name, values in parts.items():
                shape = (len(t), points, 6) if name == TENSOR else (len(t), points)
                values.append(found.get(name, np.full(shape, np.nan)))
        return {name: np.concatenate(values, axis=1) for name, values in parts.items()}

    def _of(self, body: str, t: Array) -> Fields:
        """Those of one body; none where the run does not allow them."""
        results = self._results
        if body not in results.superelement_files:
            return {}
        try:
            if results.outline_source(body) == "recovery" and results.outline(body).node is None:
                stress = results.stress(body, t)
                if stress.shape[1] == self._points[body]:
                    return {EQUIVALENT: von_mises(stress), TENSOR: stress[..., VTK_STRESS_ORDER]}
            return {EQUIVALENT: results.outline_field(body, t, EQUIVALENT)}
        except RecoveryError:
            return {}


def _points(results: Results) -> tuple[str, ...]:
    return (*results.frames, *results.contacts)


def _write_points(results: Results, path: Path, steps: Index) -> None:
    """A grid of points: recorded frames, and contacts behind them."""
    names, times = _points(results), results.time[steps]
    cells = Cells.of_points(len(names))
    of_cells: dict[str, IntArray] = {
        "frame": np.arange(len(names)),
        "contact": (np.arange(len(names)) >= len(results.frames)).astype(np.int64),
    }
    with written_whole(path) as file:
        grid = Grid(file, times, cells, of_cells)
        for rows in batches(len(steps), BATCH_POINTS // max(cells.points, 1)):
            frames, contacts = _frames(results, steps[rows]), _contacts(results, steps[rows])
            grid.put(*_side_by_side([part for part in (frames, contacts) if part]))


def _side_by_side(parts: Sequence[Fields]) -> tuple[Array, Fields]:
    """Positions and fields of frames and contacts (k, p, 3), one behind the other."""
    joined = {}
    for key, of_first in parts[0].items():
        unknown = [
            np.full((*part["position"].shape[:2], *of_first.shape[2:]), np.nan) for part in parts
        ]
        found = [part.get(key, none) for part, none in zip(parts, unknown, strict=True)]
        joined[key] = np.concatenate(found, axis=1)
    return joined.pop("position"), joined


def _recorded(results: Results, group: str, steps: Index) -> Fields:
    """The fields that records of a group ask for (k, owners, ...), by attribute."""
    contents = results.contents
    return {
        one.name.partition("_")[2]: _at(
            results, one.name, steps, math.prod(one.shape(contents.axes))
        )
        for one in contents.quantities
        if one.group == group and one.in_vtk
    }


def _frames(results: Results, steps: Index) -> Fields:
    """Of frames (k, f, 3), in space: velocities, forces and moments on their bodies."""
    if not results.frames:
        return {}
    position = _at(results, "frame_position", steps, 3 * len(results.frames))
    return {"position": position, **_recorded(results, "frames", steps)}


def _contacts(results: Results, steps: Index) -> Fields:
    """Of contacts (k, c, 3), in space: the normal force on the second body."""
    if not results.contacts:
        return {}
    width = 3 * len(results.contacts)
    normal = _at(results, "contact_normal", steps, width)
    force = _at(results, "contact_force", steps, width)[..., :1] * normal
    nothing = np.full_like(force, np.nan)
    position = _at(results, "contact_point", steps, width)
    return {"position": position, "velocity": nothing, "force": force, "moment": nothing}


def _at(results: Results, variable: str, steps: Index, width: int) -> Array:
    """A variable (k, ...) of so many numbers a step at some steps, read with those between them."""
    first, last = int(steps[0]), int(steps[-1]) + 1
    if (last - first) * width <= SCATTERED_READ_NUMBERS or len(steps) == 1:
        return results.variable(variable, slice(first, last))[steps - first]
    halves = np.array_split(steps, 2)
    return np.concatenate([_at(results, variable, half, width) for half in halves])


def _names(results: Results, pressed: Sequence[Pressed]) -> Iterator[list[object]]:
    """What the numbers of bodies, points and surfaces stand for."""
    yield ["file", "number", "name", "deformation"]
    for number, body in enumerate(results.bodies):
        yield ["bodies", number, body, results.outline_source(body)]
    for number, name in enumerate(_points(results)):
        yield ["points", number, name, ""]
    for number, one in enumerate(pressed):
        yield ["surfaces", number, f"{one.contact}: {one.body}.{one.surface.name}", ""]
