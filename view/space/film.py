"""Films and pictures of a run in space."""

import os
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ...results import Results
from ...results.transforms import Window
from ...superelement.validation import Array
from ..camera import Camera, Fitting, chosen_axes, following, spread_of
from ..errors import PictureError
from ..field_kinds import WORST_TIME, scale_of
from ..worst import worst_time
from .bodies import bodies_on_stage
from .lettering import Clock, Frame, Image, Lettering, lettered
from .stage import NO_FIELD, Batch, Stage, chosen_field
from .studio import Studio
from .surface import pyvista
from .timing import FRAMES_PER_SECOND, Timing, require_within, timing
from .tracks import Tracks
from .writing import GIF_SUFFIX, require_format, written

FILM_SIZE = (1280, 720)  # [pixels]
# [pixels]: a GIF packs badly, and stands in pages.
GIF_SIZE = (640, 360)
# Letters end where they are a pixel high, and drivers of OpenGL at 8192 or 16384 pixels.
LEAST_SIZE = 36
MAX_SIZE = 8192
OnFrame = Callable[[int, int], object]
"""is told how many frames are made, of how many"""


@dataclass(frozen=True)
class Film:
    """What was made, see `animate` for an example.

    Parameters
    ----------
    frames : int
    seconds : float [s]
        Of playing.
    magnification : float
        Of deformation.
    field : str
        That colors show, "" for none.
    largest : float
        Of all frames, in the unit of the field.
    limit : float
        The end of their scale: the largest value, unless given.
    warnings : tuple of str
        What is missing, a line each.
    """

    frames: int
    seconds: float
    magnification: float
    field: str
    largest: float
    limit: float
    warnings: tuple[str, ...] = ()

    @property
    def scale_end(self) -> str:
        """The end of the scale of colors with its unit; "" without colors."""
        return scale_of(self.field, self.limit).text(3) if self.field else ""


def animate(
    results: Results,
    path: str | os.PathLike[str],
    *,
    field: str | None = None,
    limit: float | None = None,
    magnify: float | None = None,
    start: float | None = None,
    end: float | None = None,
    at: float | str | None = None,
    frames: int | None = None,
    fps: float = FRAMES_PER_SECOND,
    seconds: float | None = None,
    size: tuple[int, int] | None = None,
    view: str = "",
    marks: bool = True,
    title: str = "",
    on_frame: OnFrame | None = None,
    on_warning: Callable[[str], None] | None = None,
) -> Film:
    """Make a film (.mp4, .gif) of a run, or a picture of one time (.png).

    Parameters
    ----------
    results : Results
    path : path
        The suffix says what is made; frame-%04d.png makes a picture of each frame.
    field : {"displacement", "velocity", "von_mises", "pressure", "none"}, optional
        By default stresses where all flexible bodies know them, else displacements.
    limit : float, optional
        Where colors end, in the SI unit of the field; by default the largest value of all frames.
    magnify : float, optional
        Of deformation; by default so that it is seen.
    start, end : float [s], optional
        The part of the run.
    at : float [s] or "worst", optional
        One time, or where the field is largest from start to end.
    frames, fps, seconds : optional
        Of playing; by default 25 frames a second for 8 s.
    size : (int, int) [pixels], optional
        Width and height.
    view : str
        "iso", "xy", "xz", "yz" or "x,y,z", the direction towards the eye; by default what shows
        most of the motion.
    marks : bool
        Joints, springs, contacts, forces.
    title : str
    on_frame : callable, optional
        Is told how many frames are made, of how many.
    on_warning : callable, optional
        Is told the `warnings` of the film before its first frame.

    Raises
    ------
    PictureError
        For what cannot be drawn or written.

    Examples
    --------
    >>> from duhamel import view
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> film = view.animate(results, "ball.png", at=0.5, size=(320, 180))
    >>> film.frames, film.magnification
    (1, 1.0)
    """
    path = Path(path)
    size = size or (GIF_SIZE if path.suffix.lower() == GIF_SUFFIX else FILM_SIZE)
    require_size(size)
    if magnify is not None and not (np.isfinite(magnify) and magnify >= 0.0):
        raise PictureError(f"--magnify: expected a number from 0 on, found {magnify:g}")
    if limit is not None and not (np.isfinite(limit) and limit > 0.0):
        raise PictureError(f"--limit: expected a positive number, found {limit:g}")
    when = timing(results.time, start, end, frames, fps, seconds)
    if at is not None:
        first, last = (-np.inf if start is None else start), (np.inf if end is None else end)
        when = Timing(np.array([the_time(results, at, field, (first, last))]), fps)
    require_format(path, size, several=at is None)
    pyvista()
    stage = Stage(results, when.times, field, magnify, marks, limit)
    warnings = *(f"drawn without colors: {why}" for why in stage.untold.values()), *stage.remarks
    if on_warning is not None:
        for warning in warnings:
            on_warning(warning)
    axes = _camera_axes(results, stage, view)
    film = _shoot(stage, when, path, size, axes, title, on_frame)
    return replace(film, warnings=warnings)


def _shoot(
    stage: Stage,
    when: Timing,
    path: Path,
    size: tuple[int, int],
    axes: Array,
    title: str,
    on_frame: OnFrame | None,
) -> Film:
    frame = Frame(size, scale=bool(stage.field))
    camera, shifts = aimed(stage, axes, frame)
    still = lettered(frame, letters(stage, when, title, axes))
    step = float(when.times[1] - when.times[0]) if len(when.times) > 1 else 0.0
    clock = Clock(frame, float(when.times[-1]), step)
    number = len(when.times)
    with Studio(stage, camera, frame) as studio, written(path, size, when.fps, number) as sink:
        for done, (image, time) in enumerate(painted(stage, studio, shifts), 1):
            sink.put(clock.write(np.minimum(image, still), time))
            if on_frame is not None:
                on_frame(done, number)
    seconds = number / when.fps
    field, ends = stage.field, (stage.largest, stage.limit)
    return Film(number, seconds, stage.magnification, field, *ends)


def painted(stage: Stage, studio: Studio, shifts: Array) -> Iterator[tuple[Image, float]]:
    """Each frame with its time; shifts (k, 3): of the camera [m]."""
    for batch in stage.batches():
        frames = studio.frames(batch, shifts[batch.rows])
        yield from zip(frames, stage.times[batch.rows].tolist(), strict=True)


def aimed(stage: Stage, axes: Array, frame: Frame) -> tuple[Camera, Array]:
    """The camera, and how it follows bodies that travel (k, 3) [m]."""
    whole, boxes = fitted(stage, axes, frame), []
    for batch in stage.batches():
        for k in range(len(batch)):
            fitting = Fitting(axes)
            for positions in batch.positions:
                fitting.take(positions[k].astype(float))
            boxes.append(fitting.box)
    height, shifts = following(boxes, whole, frame.aspect)
    return replace(whole, height=height), shifts


def fitted(stage: Stage, axes: Array, frame: Frame) -> Camera:
    """The camera that holds all points of all frames, and all marks."""
    fitting = Fitting(axes)
    for batch in stage.batches():
        for positions in batch.positions:
            fitting.take(positions.astype(float))
        for places in stage.mark_positions(batch.rows):
            fitting.take(places)
    return fitting.camera(frame.aspect)


def letters(stage: Stage, when: Timing, title: str, axes: Array) -> Lettering:
    """What is written around all frames."""
    notes = [when.words] if when.words else []
    if stage.magnification != 1.0:
        notes.append(f"deformation × {stage.magnification:g}")
    if stage.remarks:
        notes.append("elastic motion between interfaces unknown")
    scale = scale_of(stage.field, stage.limit) if stage.field else None
    ends = "of all frames" if len(when.times) > 1 else "at this time"
    ends = f"up to the\nlargest value\n{ends}"
    if stage.field and stage.limit != stage.largest:
        ends = f"largest value\n{scale_of(stage.field, stage.largest).text(3)}"
    return Lettering(title, tuple(notes), stage.legend, scale, ends, axes)


def the_time(
    results: Results, at: float | str, field: str | None, window: Window | None = None
) -> float:
    """A time of the run [s]: as given, or where a field is largest, of a window."""
    first, last = float(results.time[0]), float(results.time[-1])
    if at == WORST_TIME:
        return _worst(results, field, window)
    try:
        time = float(at)
    except ValueError as error:
        raise PictureError(f"--at: expected a time or {WORST_TIME}, found {at!r}") from error
    require_within("--at", time, first, last)
    return time


def _worst(results: Results, field: str | None, window: Window | None) -> float:
    bodies = bodies_on_stage(results, Tracks(results, results.time[:1]))
    name = chosen_field(bodies, field)
    if not name:
        raise PictureError(f"--at {WORST_TIME}: expected a field, which {NO_FIELD!r} is not")
    colored = (body for body in bodies if body.flexible or name == "velocity")
    known = [body.name for body in colored if not body.why_unknown(name)]
    return worst_time(results, known, name, window)


def require_size(size: tuple[int, int]) -> None:
    if min(size) < LEAST_SIZE or max(size) > MAX_SIZE:
        raise PictureError(
            f"--size: expected {LEAST_SIZE} to {MAX_SIZE} pixels, found {size[0]}x{size[1]}"
        )


def gravity_of(results: Results) -> Array | None:
    """The gravity (3,) of the model of a run [m/s^2], if there is any."""
    try:
        said = tomllib.loads(results.model)["simulation"]["gravity"]
        gravity: Array = np.array(said, dtype=float)
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError):
        return None
    return gravity if gravity.shape == (3,) and gravity.any() else None


def _camera_axes(results: Results, stage: Stage, view: str) -> Array:
    samples = (positions for batch in stage.batches() for positions in _some(batch))
    return chosen_axes(view, spread_of(samples), gravity_of(results))


def _some(batch: Batch) -> Iterator[Array]:
    """About a hundred points of each body in about fifty frames."""
    frames = max(len(batch) // 50, 1)
    for positions in batch.positions:
        yield positions[::frames, :: max(positions.shape[1] // 100, 1)].astype(float)
