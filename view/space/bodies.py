"""Bodies on stage: their outlines, where they are in the frames of a film, and their values."""

from collections.abc import Mapping

import numpy as np

from ...results import RecoveryError, Results
from ...results.recovery import in_space
from ...superelement.validation import Array
from .tracks import GROUND, Track, Tracks

HANGING = ("joints", "motions", "springs")
"""groups of couplings that hold a body in its place"""


class Hold:
    """The interface of a flexible body that magnified deformation leaves where it is.

    There the body hangs, by its joints, on the ground:

        u'(X) = u(X) - u_I - w_I x (X - X_I)

    is what it deforms, seen from there. u_I, w_I (k, 3): displacement and rotation there [m, rad];
    X_I (3,): its place, from the center of mass in body axes [m].
    """

    def __init__(self, body: Track, frame: Track) -> None:
        assert frame.u is not None
        self.u = frame.u
        self.X = place_of(body, frame)

    def seen(self, u: Array, X: Array, rows: slice) -> Array:
        """Displacements u (k, p, 3) at X (p, 3) as they are seen from there."""
        moved, turned = self.u[rows, None, :3], self.u[rows, None, 3:]
        relative: Array = u - moved - np.cross(turned, X - self.X)
        return relative


def place_of(body: Track, frame: Track) -> Array:
    """The place (3,) of a frame at rest, from the center of mass in body axes [m]."""
    assert frame.u is not None
    still = np.zeros((1, 3))
    back = body.rotation[:1] * [1.0, -1.0, -1.0, -1.0]
    lever = (frame.position - body.position)[:1, None]
    rest: Array = in_space(still, back, lever)[0, 0] - frame.u[0, :3]
    return rest


class Body:
    """A body of a run, at the times of a film.

    X (p, 3): points at rest, from the center of mass in body axes [m].
    """

    def __init__(self, results: Results, tracks: Tracks, name: str, held_at: str = "") -> None:
        self._results, self._times = results, tracks.times
        self.name, self.track = name, tracks.body(name)
        self.outline = results.outline(name)
        self.X: Array = np.asarray(self.outline.points, dtype=float)
        self.flexible = results.outline_source(name) != "rigid"
        frame = tracks.find(held_at) if held_at and self.flexible else None
        self.hold = None if frame is None else Hold(self.track, frame)
        self._kept: tuple[slice, Array] | None = None

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
        """(k, p): see `Results.outline_field`."""
        found: Array = self._results.outline_field(self.name, self._times[rows], field)
        return found

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


def hung_on_the_ground(results: Results) -> dict[str, str]:
    """The frame of each body by which it hangs on the ground, by the fewest joints and springs."""
    beside: dict[str, list[tuple[str, str]]] = {}
    for coupling in results.couplings:
        if coupling.group not in HANGING:
            continue
        a, b = coupling.between
        beside.setdefault(_body_of(a), []).append((_body_of(b), b))
        beside.setdefault(_body_of(b), []).append((_body_of(a), a))
    found: dict[str, str] = {}
    waiting = [GROUND]
    while waiting:
        for body, frame in beside.get(waiting.pop(0), ()):
            if body != GROUND and body not in found:
                found[body] = frame
                waiting.append(body)
    return found


def bodies_on_stage(results: Results, tracks: Tracks) -> tuple[Body, ...]:
    """All bodies that the run recorded."""
    recorded = set(results.recorded)
    held: Mapping[str, str] = hung_on_the_ground(results)
    names = [name for name in results.bodies if f"bodies/{name}" in recorded]
    return tuple(Body(results, tracks, name, held.get(name, "")) for name in names)


def _body_of(frame: str) -> str:
    return frame.partition(".")[0]
