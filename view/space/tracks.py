"""Where bodies and frames are at the times of a film."""

from dataclasses import dataclass

import numpy as np

from ...results import Results
from ...results.recovery import Instants, instants
from ...results.rotations import inverse, rotate
from ...superelement.validation import Array

GROUND_NAME = "ground"


@dataclass(frozen=True, eq=False)
class Track:
    """A moving frame: position (k, 3) in space [m], unit quaternion (k, 4) of its axes.

    body: that carries it, "" for the ground; u (k, 6): elastic displacement [m] and rotation [rad]
    there in body axes; force (k, 6): force [N] and moment [N m] on the body there, in space.
    """

    position: Array
    rotation: Array
    body: str = ""
    u: Array | None = None
    force: Array | None = None

    def turned(self, vector: Array) -> Array:
        """A vector (3,) of its axes in space (k, 3)."""
        return rotate(self.rotation, vector)

    def seen_from(self, position: Array) -> Array:
        """Positions (k, 3) in space from its own, in its axes."""
        return rotate(inverse(self.rotation), position - self.position)


class Tracks:
    """The tracks of a run at some of its times (k,) [s], linear between recorded steps."""

    def __init__(self, results: Results, times: Array) -> None:
        self._results, self.times = results, times
        self._instants: Instants = instants(results.time, times)
        self._recorded = set(results.recorded)
        self._bodies: dict[str, Track] = {}
        self._frames: dict[str, Track] = {}

    def at(self, rows: Array) -> Array:
        """Rows (n, ...) of the recorded steps at the times (k, ...)."""
        when = self._instants
        return when.of(rows[when.before], rows[when.after])

    def rotation_at(self, quaternions: Array) -> Array:
        """Unit quaternions (k, 4) of those of the recorded steps (n, 4)."""
        when = self._instants
        before, after = quaternions[when.before], quaternions[when.after]
        # Both signs are the same rotation: the nearer one is gone to.
        after = after * np.where((before * after).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
        between = when.of(before, after)
        unit: Array = between / np.linalg.norm(between, axis=1)[:, None]
        return unit

    def body(self, name: str) -> Track:
        if name not in self._bodies:
            motion = self._results.body(name)
            self._bodies[name] = Track(self.at(motion.x), self.rotation_at(motion.R), name)
        return self._bodies[name]

    def nearest(self, rows: Array) -> Array:
        """Rows (n, ...) of the recorded steps that are nearest to the times (k, ...)."""
        when = self._instants
        nearest: Array = rows[np.where(when.share < 0.5, when.before, when.after)]
        return nearest

    def find(self, name: str) -> Track | None:
        """The track of "BODY.FRAME", "BODY" or "ground.FRAME"; None where it is not known."""
        body, _, frame = name.partition(".")
        if body == GROUND_NAME:
            known = self._results.ground_frames
            return self._still(known[frame]) if frame in known else None
        if f"frames/{name}" in self._recorded:
            return self._frame(name)
        return self.body(body) if not frame and f"bodies/{body}" in self._recorded else None

    def end(self, name: str, other: str) -> Track | None:
        """The track of an end of a coupling; "ground" is where the other end starts."""
        if name != GROUND_NAME:
            return self.find(name)
        if f"frames/{other}" in self._recorded:
            return self._still(self._results.frame(other).position[0])
        if f"bodies/{other}" in self._recorded:
            return self._still(self._results.body(other).x[0])
        return None

    def _frame(self, name: str) -> Track:
        if name not in self._frames:
            motion = self._results.frame(name)
            self._frames[name] = Track(
                self.at(motion.position),
                self.rotation_at(motion.rotation),
                name.partition(".")[0],
                self.at(motion.u),
                self.at(motion.force),
            )
        return self._frames[name]

    def _still(self, position: Array) -> Track:
        shape = (len(self.times), 1)
        return Track(np.tile(position, shape), np.tile([1.0, 0.0, 0.0, 0.0], shape))
