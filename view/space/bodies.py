"""Bodies on stage: their outlines, where they are in the frames of a film, and their values."""

from collections.abc import Sequence

import numpy as np

from ...results import RecoveryError, Results
from ...results.recovery import in_space
from ...superelement.validation import Array
from .holding import Hold, holding_frames
from .tracks import Tracks


class Body:
    """A body of a run, at the times of a film.

    X (p, 3): points at rest, from the center of mass in body axes [m].
    """

    def __init__(
        self, results: Results, tracks: Tracks, name: str, held_at: Sequence[str] = ()
    ) -> None:
        self._results, self._times = results, tracks.times
        self.name, self.track = name, tracks.body(name)
        self.outline = results.outline(name)
        self.X: Array = np.asarray(self.outline.points, dtype=float)
        self.flexible = results.outline_source(name) != "rigid"
        found = [tracks.find(frame) for frame in held_at] if self.flexible else []
        frames = [frame for frame in found if frame is not None and frame.u is not None]
        self.hold = Hold(self.track, frames) if frames else None
        self._kept: tuple[slice, Array] | None = None

    def thicken(self, least: float) -> None:
        """Draw beams whose surface is on average nearer to their axis than this [m] so thick."""
        arms = self.X - self.outline.anchors
        radius = float(np.linalg.norm(arms, axis=1).mean()) if len(arms) else 0.0
        if 0.0 < radius < least:
            self.X = self.outline.anchors + arms * (least / radius)

    def deformation(self, u: Array, X: Array, rows: slice) -> Array:
        """What is magnified of displacements u (k, p, 3) at X (p, 3)."""
        return u if self.hold is None else self.hold.seen(u, X, rows)

    def largest_deformation(self, rows: slice) -> float:
        """[m]"""
        if not self.flexible:
            return 0.0
        moved = self.deformation(self._displacement(rows), self.X, rows)
        return float(np.sqrt((moved**2).sum(axis=-1)).max(initial=0.0))

    def position(self, rows: slice, magnification: float) -> Array:
        """x + R (X + u + (magnification - 1) u') (k, p, 3), in space [m]."""
        x, R = self.track.position[rows], self.track.rotation[rows]
        if not self.flexible:
            return in_space(x, R, np.broadcast_to(self.X, (len(x), *self.X.shape)))
        return in_space(x, R, self.X + self.displacement(rows, magnification))

    def displacement(self, rows: slice, magnification: float) -> Array:
        """u + (magnification - 1) u' (k, p, 3), in body axes [m]."""
        u = self._displacement(rows)
        if magnification != 1.0:
            u = u + (magnification - 1.0) * self.deformation(u, self.X, rows)
        return u

    def values(self, rows: slice, field: str) -> Array:
        """Magnitudes (k, p) of a field; of displacements as they are seen from where it is held."""
        found: Array = self._results.outline_field(self.name, self._times[rows], field)
        if field != "displacement" or self.hold is None:
            return found
        seen = self.deformation(self._displacement(rows), self.X, rows)
        return np.asarray(np.linalg.norm(seen, axis=-1))

    def why_unknown(self, field: str) -> str:
        """Why a field of it is unknown; "" if it is known."""
        try:
            self.values(slice(0, 1), field)
        except RecoveryError as error:
            return str(error)
        return ""

    def _displacement(self, rows: slice) -> Array:
        """Elastic displacements (k, p, 3) in body axes; the last ones are kept."""
        if self._kept is None or self._kept[0] != rows:
            found = self._results.outline_displacement(self.name, self._times[rows])
            self._kept = rows, found
        return self._kept[1]


def bodies_on_stage(results: Results, tracks: Tracks) -> tuple[Body, ...]:
    """All bodies that the run recorded."""
    recorded = set(results.recorded)
    held = holding_frames(results)
    names = [name for name in results.bodies if f"bodies/{name}" in recorded]
    return tuple(Body(results, tracks, name, held.get(name, ())) for name in names)
