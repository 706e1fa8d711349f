"""The bodies of a run in space: outlines at rest and as they move and deform."""

from collections.abc import Mapping
from typing import Any, Literal, Protocol

import numpy as np

from ..superelement import Outline, Recovery, Superelement
from ..superelement.figures import box
from ..superelement.validation import Array
from .errors import RecoveryError, ResultsError
from .motion import BodyMotion, FrameMotion
from .recovery import Instants, in_space, instants
from .schema import SuperelementFile
from .space import Space

Source = Literal["rigid", "recovery", "interfaces"]
FIELDS = ("displacement", "velocity", "von_mises")
BATCH = 1 << 22
"""numbers of weights that are held at once"""
NEAR = 1e-9
"""distance from an interface, in the size of the body, at which a point moves with it"""
SMALL = 0.05
"""edge of the box of a body of which nothing is known, in the size of the run"""


class Run(Protocol):
    """What `Results` say of a run."""

    @property
    def time(self) -> Array: ...
    @property
    def bodies(self) -> tuple[str, ...]: ...
    @property
    def frames(self) -> tuple[str, ...]: ...
    @property
    def interfaces(self) -> tuple[str, ...]: ...
    @property
    def superelement_files(self) -> Mapping[str, SuperelementFile]: ...
    def body(self, name: str) -> BodyMotion: ...
    def frame(self, name: str) -> FrameMotion: ...
    def superelement(self, body: str) -> Superelement: ...
    def recoverable(self, body: str) -> Recovery: ...
    def modal_state(self, body: str, t: Array) -> tuple[Recovery, Array]: ...
    def von_mises(self, body: str, t: Any) -> Array: ...


class Outlines:
    """The outlines of the bodies of results, which are read when asked for."""

    def __init__(self, results: Run, space: Space | None) -> None:
        self._results = results
        self.space = Space() if space is None else space
        self._made = dict(self.space.outlines)
        self._blends: dict[str, Blend] = {}
        self._sources: dict[str, Source] = {}

    def at_rest(self, body: str) -> Outline:
        """The outline of a recorded body; that of an old file is made of what is known."""
        if body not in self._made:
            self._made[body] = self._without_file(body)
        return self._made[body]

    def source(self, body: str) -> Source:
        """Where its deformation is from."""
        if body not in self._sources:
            self._sources[body] = self._found_source(body)
        return self._sources[body]

    def displacement(self, body: str, t: Any) -> Array:
        """Elastic displacements (p, 3) or (k, p, 3) in body axes [m]."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        when = instants(self._results.time, times)
        source = self.source(body)
        if source == "rigid":
            moved: Array = np.zeros((len(times), len(self.at_rest(body).points), 3))
        elif source == "recovery":
            moved = self._recovered(body, times)
        else:
            moved = self._blend(body).displacement(*self._motions(body, when))
        return moved.reshape(*np.shape(t), -1, 3)

    def position(self, body: str, t: Any, magnification: float) -> Array:
        """x + R (X + magnification u) (p, 3) or (k, p, 3), in space [m]."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        points = self.at_rest(body).points + magnification * self.displacement(body, times)
        x, R = self._pose(body, times)
        return in_space(x, R, points).reshape(*np.shape(t), -1, 3)

    def field(self, body: str, t: Any, name: str) -> Array:
        """Magnitudes (p,) or (k, p) of a field."""
        if name == "displacement":
            return np.asarray(np.linalg.norm(self.displacement(body, t), axis=-1))
        if name == "velocity":
            return np.asarray(np.linalg.norm(self.velocity(body, t), axis=-1))
        if name == "von_mises":
            return self._von_mises(body, t)
        raise RecoveryError(f"field {name!r}: expected one of {', '.join(FIELDS)}")

    def _found_source(self, body: str) -> Source:
        results = self._results
        if body not in results.superelement_files:
            return "rigid"
        if self._recovers(body):
            return "recovery"
        return "interfaces" if self._interfaces(body) else "rigid"

    def _recovers(self, body: str) -> bool:
        """Whether the modes of the mesh give the motion of the outline."""
        outline = self.at_rest(body)
        try:
            recovery = self._results.recoverable(body)
        except (RecoveryError, ResultsError):
            return False
        if outline.node is None:
            return len(recovery.points) == len(outline.points)
        return recovery.phi_rotation is not None

    def _recovered(self, body: str, times: Array) -> Array:
        """Displacements by modes: of sections of beams those of a node and its rotation.

        u = u_node + theta_node x arm
        """
        outline = self.at_rest(body)
        recovery, eta = self._results.modal_state(body, times)
        u = recovery.displacement(eta)
        if outline.node is None:
            return u
        arms = outline.points - recovery.points[outline.node]
        turned: Array = np.cross(recovery.rotation(eta)[:, outline.node], arms)
        return u[:, outline.node] + turned

    def _interfaces(self, body: str) -> tuple[str, ...]:
        """The recorded interfaces of a flexible body."""
        return tuple(name for name in self._results.interfaces if name.partition(".")[0] == body)

    def _blend(self, body: str) -> "Blend":
        if body not in self._blends:
            places = [self._place(body, name) for name in self._interfaces(body)]
            self._blends[body] = Blend(self.at_rest(body), np.array(places))
        return self._blends[body]

    def _place(self, body: str, frame: str) -> Array:
        """Where an interface is at rest (3,), in body axes: R^T (r - x) - u at the start."""
        motion, one = self._results.body(body), self._results.frame(frame)
        back = motion.R[:1] * [1.0, -1.0, -1.0, -1.0]
        away = (one.position[:1] - motion.x[:1])[:, None]
        place: Array = in_space(np.zeros((1, 3)), back, away)[0, 0] - one.u[0, :3]
        return place

    def _motions(self, body: str, when: Instants) -> tuple[Array, Array]:
        """Displacements and small rotations (k, i, 3) of the interfaces, in body axes."""
        motions = []
        for name in self._interfaces(body):
            u = self._results.frame(name).u
            motions.append(when.of(u[when.before], u[when.after]))
        both = np.stack(motions, axis=1)
        return both[..., :3], both[..., 3:]

    def _pose(self, body: str, times: Array) -> tuple[Array, Array]:
        """Position (k, 3) and rotation (k, 4), linear between steps."""
        when = instants(self._results.time, times)
        motion = self._results.body(body)
        near = np.where(
            np.sum(motion.R[when.before] * motion.R[when.after], axis=1) < 0.0, -1.0, 1.0
        )
        x = when.of(motion.x[when.before], motion.x[when.after])
        return x, when.of(motion.R[when.before], near[:, None] * motion.R[when.after])

    def velocity(self, body: str, t: Any) -> Array:
        """v + R (omega x (X + u) + u'), (p, 3) or (k, p, 3), in space [m/s].

        u' by differences of u over a recorded step.
        """
        times = np.atleast_1d(np.asarray(t, dtype=float))
        motion = self._results.body(body)
        when = instants(self._results.time, times)
        v, R = when.of(motion.v[when.before], motion.v[when.after]), self._pose(body, times)[1]
        u = self.displacement(body, times)
        turning = np.cross(v[:, None, 3:], self.at_rest(body).points + u)
        moved = in_space(v[:, :3], R, turning + self._rate(body, times))
        return moved.reshape(*np.shape(t), -1, 3)

    def _rate(self, body: str, times: Array) -> Array:
        """u' (k, p, 3) by central differences over one recorded step about each time [m/s]."""
        if self.source(body) == "rigid" or len(self._results.time) < 2:
            return np.zeros((1, 1, 3))
        all_times = self._results.time
        i = np.searchsorted(all_times, times).clip(1, len(all_times) - 1)
        half = 0.5 * (all_times[i] - all_times[i - 1])
        first = (times - half).clip(all_times[0], all_times[-1])
        last = (times + half).clip(all_times[0], all_times[-1])
        both = self.displacement(body, np.concatenate([first, last]))
        k = len(times)
        rate: Array = (both[k:] - both[:k]) / (last - first)[:, None, None]
        return rate

    def _von_mises(self, body: str, t: Any) -> Array:
        """Of the recovery; of solids its points are those of the outline."""
        outline = self.at_rest(body)
        stresses = self._results.von_mises(body, t)
        if outline.node is not None:
            return stresses[..., outline.node]
        if stresses.shape[-1] != len(outline.points):
            raise RecoveryError(
                f"body {body!r}: {stresses.shape[-1]} points of recovery, but an outline of "
                f"{len(outline.points)}"
            )
        return stresses

    def _without_file(self, body: str) -> Outline:
        """The outline of a body of an old file, or of one without an outline.

        That of its superelement, its recovery, lines between its interfaces, or a box around its
        frames.
        """
        results = self._results
        if body in results.superelement_files:
            try:
                element = results.superelement(body)
            except (RecoveryError, ResultsError, ValueError):
                element = None
            if element is not None and element.outline is not None:
                return element.outline
            if element is not None and element.recovery is not None:
                return Outline(element.recovery.points, element.recovery.cells)
        results.body(body)
        frames = [name for name in results.frames if name.partition(".")[0] == body]
        places = np.array([self._place_of_frame(body, name) for name in frames]).reshape(-1, 3)
        if body in results.superelement_files and len(places):
            return _star(places)
        return _box_around(places, SMALL * self._size())

    def _place_of_frame(self, body: str, frame: str) -> Array:
        return self._place(body, frame)

    def _size(self) -> float:
        """The size of what bodies and frames pass at the start [m], 1 where they are one point."""
        results = self._results
        points = [results.body(name).x[0] for name in results.bodies]
        points += [results.frame(name).position[0] for name in results.frames]
        return float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0


class Blend:
    """Motion between interfaces, by weights of the inverse square of distances.

        u(X) = sum_i w_i (u_i + theta_i x (X - X_i)),   w_i = d_i^-2 / sum_j d_j^-2

    It is that of an interface there, value and slope. A section of a beam has the distances of its
    node. Source: D. Shepard, Proc. 23rd ACM National Conference (1968) 517-524.
    """

    def __init__(self, outline: Outline, places: Array) -> None:
        self._points, self._places = outline.points, places
        self.weights = weights_of(outline.anchors, places)

    def displacement(self, u: Array, theta: Array) -> Array:
        """(k, p, 3) from displacements and rotations of interfaces (k, i, 3).

        sum_i w_i theta_i x (X - X_i) = (sum w_i theta_i) x X - sum w_i theta_i x X_i
        """
        k = len(u)
        moved = np.empty((k, len(self._points), 3))
        own = u - np.cross(theta, self._places)
        for n in range(k):
            turn = self.weights @ theta[n]
            moved[n] = self.weights @ own[n] + np.cross(turn, self._points)
        return moved


def weights_of(points: Array, places: Array) -> Array:
    """Shepard's weights (p, i) of places (i, 3) at points (p, 3); rows sum up to 1."""
    weights = np.empty((len(points), len(places)))
    size = max(float(np.linalg.norm(np.ptp(points, axis=0))), np.finfo(float).tiny)
    batch = max(BATCH // max(3 * len(places), 1), 1)
    for first in range(0, len(points), batch):
        rows = slice(first, first + batch)
        d = np.linalg.norm(points[rows, None] - places, axis=2) / size
        w = np.maximum(d, NEAR) ** -2
        weights[rows] = w / w.sum(axis=1, keepdims=True)
    return weights


def _star(places: Array) -> Outline:
    """Lines from the center of mass to some places."""
    points = np.vstack([np.zeros(3), places])
    ends = np.arange(1, len(points))
    return Outline(points, np.column_stack([np.zeros_like(ends), ends]))


def _box_around(places: Array, least: float) -> Outline:
    """A box around the center of mass and some places, of some thickness [m]."""
    points = np.vstack([np.zeros((1, 3)), places])
    low, high = points.min(axis=0), points.max(axis=0)
    return box(np.maximum(high - low, least), 0.5 * (low + high))
