"""When the frames of a film are, and how fast it plays."""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from ...superelement.validation import Array
from ..errors import PictureError

# Long enough to be followed, short enough to be looped.
USUAL_SECONDS = 8.0
FRAMES_PER_SECOND = 25.0
# A film that is faster or slower by less is called real time.
REAL_TIME_TOLERANCE = 0.02


@dataclass(frozen=True, eq=False)
class Timing:
    """The times (k,) of the frames [s], and frames per second of playing."""

    times: Array
    fps: float

    @property
    def slowness(self) -> float:
        """Seconds of playing per second of the run; 0 for a single frame."""
        span = float(np.ptp(self.times))
        return (len(self.times) - 1) / self.fps / span if span else 0.0

    @property
    def words(self) -> str:
        """How fast the film plays, as "slowed down 25 x"."""
        slowness = self.slowness
        if slowness == 0.0 or abs(slowness - 1.0) < REAL_TIME_TOLERANCE:
            return "real time" if slowness else ""
        way, factor = ("slowed down", slowness) if slowness > 1.0 else ("sped up", 1.0 / slowness)
        return f"{way} {_brief(factor)} ×"


def timing(
    recorded: Array,
    start: float | None = None,
    end: float | None = None,
    frames: int | None = None,
    fps: float = FRAMES_PER_SECOND,
    seconds: float | None = None,
) -> Timing:
    """Equal steps of time from `start` to `end` [s], by default the whole of the run.

    recorded (n,): times of the run [s]; frames: how many, by default as many as `fps` frames per
    second fill `seconds` of playing; both of frames and seconds: fps follows. PictureError for
    times outside the run, and numbers that make no film.
    """
    first, last = float(recorded[0]), float(recorded[-1])
    start, end = first if start is None else start, last if end is None else end
    require_within("--from", start, first, last)
    require_within("--to", end, first, last)
    if end < start:
        raise PictureError(f"--to: expected a time after --from, {start:g} s, found {end:g} s")
    for name, number in (("--fps", fps), ("--seconds", seconds), ("--frames", frames)):
        if number is not None and not (isfinite(number) and number > 0):
            raise PictureError(f"{name}: expected a number above 0, found {number:g}")
    if frames is None:
        frames = max(round(fps * (USUAL_SECONDS if seconds is None else seconds)), 1)
    elif seconds is not None:
        fps = frames / seconds
    if end == start:
        frames = 1
    return Timing(np.linspace(start, end, frames), fps)


def require_within(name: str, time: float, first: float, last: float) -> None:
    """PictureError for a time outside a run."""
    if not first <= time <= last * (1.0 + 1e-12):
        raise PictureError(
            f"{name}: expected a time of the run, {first:g} to {last:g} s, found {time:g} s"
        )


def _brief(factor: float) -> str:
    """Two digits, or all before the point."""
    return f"{factor:.0f}" if factor >= 10.0 else f"{factor:.2g}"
