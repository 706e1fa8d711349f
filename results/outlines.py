"""The bodies of a run in space: outlines at rest and as they move and deform."""

from collections.abc import Mapping
from contextlib import suppress
from functools import cached_property, partial
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np

from ..files.arrays import Array, Index
from ..superelement import Outline, Recovery, SuperelementError
from ..superelement.figures import box
from . import pressed
from .blend import Blend
from .contents import SuperelementFile
from .errors import RecoveryError, ResultsError
from .motion import BodyMotion, FrameMotion
from .recovery import in_space, instants
from .rotations import inverse
from .space import Place, Space

Source = Literal["rigid", "recovery", "interfaces"]
OUTLINE_FIELDS = ("displacement", "velocity", "von_mises", "pressure")
# 256 MiB: views go back and forth in time, and reading the motion again is slower.
MAX_KEPT_MOTION_BYTES = 1 << 28
# Relative to the size of a body.
RELATIVE_COORDINATE_ROUNDING = 1e-9
# Relative to the size of the whole model: a box for a body of which no shape is known.
RELATIVE_PLACEHOLDER_EDGE = 0.05


class Run(pressed.Run, Protocol):
    """What `Results` say of a run."""

    @property
    def time(self) -> Array: ...
    @property
    def frames(self) -> tuple[str, ...]: ...
    @property
    def interfaces(self) -> tuple[str, ...]: ...
    @property
    def superelement_files(self) -> Mapping[str, SuperelementFile]: ...
    def body(self, name: str) -> BodyMotion: ...
    def frame(self, name: str) -> FrameMotion: ...
    def recoverable(self, body: str) -> Recovery: ...
    def modal_state(self, body: str, t: Array) -> tuple[Recovery, Array]: ...
    def von_mises(self, body: str, t: Any) -> Array: ...
    def variable(self, name: str, rows: slice, owner: str) -> Array: ...


class Motion(NamedTuple):
    """The recorded motion of a body: x (n, 3), R (n, 4), v (n, 6), as `BodyMotion` has them.

    u (n, i, 6): displacements and rotations of its recorded interfaces, in body axes; places (i,
    3): where these are at rest.
    """

    x: Array
    R: Array
    v: Array
    u: Array
    places: Array

    @property
    def nbytes(self) -> int:
        return sum(array.nbytes for array in self)


class Outlines:
    """The outlines of the bodies of results, which are read when asked for."""

    def __init__(self, results: Run, space: Space | None) -> None:
        self._results = results
        self.space = Space() if space is None else space
        # Old files have no outlines; `at_rest` then makes them from what else is known.
        self._made = dict(self.space.outlines)
        self._blends: dict[str, Blend] = {}
        self._sources: dict[str, Source] = {}
        self._motions: dict[str, Motion] = {}
        self._refused: dict[str, str] = {}
        self._rows: dict[str, Mapping[str, Any]] = {}

    @cached_property
    def _time(self) -> Array:
        return self._results.time

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

    def remark(self, body: str) -> str:
        """What a reader must know of the deformation of a body; "" where all is as it moved."""
        if body not in self._results.superelement_files or self.source(body) == "recovery":
            return ""
        if self.source(body) == "rigid":
            return f"body {body!r}: drawn rigid: {self._lacking(body)}"
        return f"body {body!r}: interpolated between its interfaces: {self._refused[body]}"

    def _lacking(self, body: str) -> str:
        known, wanted = len(self._motion(body).places), self.space.interfaces.get(body)
        if wanted == 0:
            return f"it has no interfaces, and {self._refused[body]}"
        of = "" if wanted is None else f" of its {wanted} interfaces"
        return f"the run recorded {known or 'none'}{of}"

    def displacement(self, body: str, t: Any) -> Array:
        """Elastic displacements (p, 3) or (k, p, 3) in body axes [m]."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        when = instants(self._time, times)
        source = self.source(body)
        if source == "rigid":
            moved: Array = np.zeros((len(times), len(self.at_rest(body).points), 3))
        elif source == "recovery":
            moved = self._recovered(body, times)
        else:
            u = self._motion(body).u
            here = when.of(u[when.before], u[when.after])
            moved = self._blend(body).displacement(here[..., :3], here[..., 3:])
        return moved.reshape(*np.shape(t), -1, 3)

    def position(self, body: str, t: Any, magnification: float) -> Array:
        """x + R (X + magnification u) (p, 3) or (k, p, 3), in space [m]."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        points = self.at_rest(body).points + magnification * self.displacement(body, times)
        x, R = self._pose(body, times)
        return in_space(x, R, points).reshape(*np.shape(t), -1, 3)

    def field(self, body: str, t: Any, name: str) -> Array:
        """Magnitudes (p,) or (k, p) of a field."""
        if name == "displacement" and self.remark(body) and self.source(body) == "rigid":
            raise RecoveryError(f"body {body!r}: no displacements: {self._lacking(body)}")
        if name == "displacement":
            return np.asarray(np.linalg.norm(self.displacement(body, t), axis=-1))
        if name == "velocity":
            return np.asarray(np.linalg.norm(self.velocity(body, t), axis=-1))
        if name == "von_mises":
            return self._von_mises(body, t)
        if name == "pressure":
            return self._pressure(body, t)
        raise RecoveryError(f"field {name!r}: expected one of {', '.join(OUTLINE_FIELDS)}")

    def place(self, body: str, point: int) -> Place:
        """Where a point is at rest: in the mesh, where the superelement is at hand."""
        outline, center, node = self.at_rest(body), None, None
        if body in self._results.superelement_files:
            # The place is a courtesy of the table: without the superelement it is in body axes.
            with suppress(RecoveryError, ResultsError, SuperelementError):
                element = self._results.superelement(body)
                center, node = element.center, _node_at(point, outline, element.recovery)
        X = outline.points + (0.0 if center is None else center)
        # Tables show 0 rather than 1e-17.
        rounding = RELATIVE_COORDINATE_ROUNDING * float(np.ptp(X, axis=0).max(initial=0.0))
        x, y, z = np.where(np.abs(X[point]) > rounding, X[point], 0.0).tolist()
        return Place((x, y, z), center is not None, node)

    def _found_source(self, body: str) -> Source:
        self.at_rest(body)
        if body not in self._results.superelement_files:
            return "rigid"
        if self._recovers(body):
            return "recovery"
        known = len(self._motion(body).places)
        return "interfaces" if known and known >= self.space.interfaces.get(body, 1) else "rigid"

    def _recovers(self, body: str) -> bool:
        """Whether the modes of the mesh give the motion of the outline."""
        outline = self.at_rest(body)
        try:
            recovery = self._results.recoverable(body)
        except (RecoveryError, ResultsError, SuperelementError) as error:
            self._refused[body] = str(error).removeprefix(f"body {body!r}: ")
            return False
        turns = outline.node is None or recovery.phi_rotation is not None
        self._refused[body] = "its superelement is older than outlines: preprocess it again"
        return turns and outline.fits(recovery)

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

    def _blend(self, body: str) -> Blend:
        if body not in self._blends:
            motion = self._motion(body)
            turns = (motion.u[..., 3:] != 0.0).any(axis=(0, 2)).tolist()
            self._blends[body] = Blend(self.at_rest(body), motion.places, turns)
        return self._blends[body]

    def _motion(self, body: str) -> Motion:
        """The motion of a body, kept as long as there is room."""
        if body not in self._motions:
            motion = self._read_motion(body)
            if (
                sum(kept.nbytes for kept in self._motions.values()) + motion.nbytes
                > MAX_KEPT_MOTION_BYTES
            ):
                self._motions.clear()
            self._motions[body] = motion
        return self._motions[body]

    def _read_motion(self, body: str) -> Motion:
        results = self._results
        own = results.body(body)
        faces = [name for name in results.interfaces if name.partition(".")[0] == body]
        u, places = np.zeros((len(own.x), len(faces), 6)), np.zeros((len(faces), 3))
        for i, name in enumerate(faces):
            frame = results.frame(name)
            u[:, i] = frame.u
            places[i] = _seen(own.x[0], own.R[0], frame.position[0]) - frame.u[0, :3]
        return Motion(own.x, own.R, own.v, u, places)

    def _pose(self, body: str, times: Array) -> tuple[Array, Array]:
        """Position (k, 3) and rotation (k, 4), linear between steps."""
        when, motion = instants(self._time, times), self._motion(body)
        before, after = motion.R[when.before], motion.R[when.after]
        same = np.sum(before * after, axis=1, keepdims=True) >= 0.0
        x = when.of(motion.x[when.before], motion.x[when.after])
        return x, when.of(before, np.where(same, after, -after))

    def velocity(self, body: str, t: Any) -> Array:
        """v + R (omega x (X + u) + u'), (p, 3) or (k, p, 3), in space [m/s].

        u' by differences of u over a recorded step.
        """
        times = np.atleast_1d(np.asarray(t, dtype=float))
        when, motion = instants(self._time, times), self._motion(body)
        v, R = when.of(motion.v[when.before], motion.v[when.after]), self._pose(body, times)[1]
        u = self.displacement(body, times)
        turning = np.cross(v[:, None, 3:], self.at_rest(body).points + u)
        moved = in_space(v[:, :3], R, turning + self._rate(body, times))
        return moved.reshape(*np.shape(t), -1, 3)

    def _rate(self, body: str, times: Array) -> Array:
        """u' (k, p, 3) by central differences over one recorded step about each time [m/s]."""
        recorded = self._time
        if self.source(body) == "rigid" or len(recorded) < 2:
            return np.zeros((1, 1, 3))
        i = np.searchsorted(recorded, times).clip(1, len(recorded) - 1)
        half = 0.5 * (recorded[i] - recorded[i - 1])
        first, last = (
            (times + side * half).clip(recorded[0], recorded[-1]) for side in (-1.0, 1.0)
        )
        before, after = np.split(self.displacement(body, np.concatenate([first, last])), 2)
        rate: Array = (after - before) / (last - first)[:, None, None]
        return rate

    def _von_mises(self, body: str, t: Any) -> Array:
        """Of the recovery; of solids its points are those of the outline."""
        stresses, outline = self._results.von_mises(body, t), self.at_rest(body)
        if outline.node is not None:
            raise RecoveryError(f"body {body!r}: beams have no stresses")
        if not outline.fits(self._results.recoverable(body)):
            raise RecoveryError(f"body {body!r}: its recovery is not at the points of its outline")
        return stresses

    def _pressure(self, body: str, t: Any) -> Array:
        """That of contacts of surfaces on its nodes, 0 elsewhere."""
        times = np.atleast_1d(np.asarray(t, dtype=float))
        if body not in self._rows:
            self._rows[body] = pressed.rows_of_outline(self._results, body, self.at_rest(body))
        when = instants(self._time, times)
        total = np.zeros((len(times), len(self.at_rest(body).points)))
        for contact, by_rows in self._rows[body].items():
            before, after = (
                self._pressures_of_rows(contact, steps) for steps in (when.before, when.after)
            )
            total += when.of(before, after) @ by_rows.T
        return total.reshape(*np.shape(t), -1)

    def _pressures_of_rows(self, contact: str, steps: Index) -> Array:
        read = partial(self._results.variable, "surface_contact_pressure", owner=contact)
        return np.concatenate([read(slice(k, k + 1)) for k in steps.tolist()])

    def _without_file(self, body: str) -> Outline:
        """The outline of a body of an old file, or of one without an outline.

        That of its superelement, its recovery, lines to its interfaces, or a box around its frames.
        """
        results = self._results
        own = results.body(body)
        flexible = body in results.superelement_files
        if flexible and (outline := self._of_superelement(body)) is not None:
            return outline
        names = [name for name in results.frames if name.partition(".")[0] == body]
        ends = [results.frame(name) for name in names]
        places = [_seen(own.x[0], own.R[0], end.position[0]) - end.u[0, :3] for end in ends]
        around = np.vstack([np.zeros(3), *places])
        if flexible and len(names):
            return _star(around)
        return _box_around(around, RELATIVE_PLACEHOLDER_EDGE * self._size())

    def _of_superelement(self, body: str) -> Outline | None:
        try:
            element = self._results.superelement(body)
        except (RecoveryError, ResultsError, SuperelementError):
            return None
        if element.outline is None and element.recovery is not None:
            return Outline(element.recovery.points, element.recovery.cells)
        return element.outline

    def _size(self) -> float:
        """The size of what bodies and frames pass at the start [m], 1 where they are one point."""
        results = self._results
        points = [results.body(name).x[0] for name in results.bodies]
        points += [results.frame(name).position[0] for name in results.frames]
        return float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0


def _node_at(point: int, outline: Outline, recovery: Recovery | None) -> int | None:
    """The number of the node of a point in the mesh file, where it is known."""
    if recovery is None or recovery.nodes is None or not outline.fits(recovery):
        return None
    return int(recovery.nodes[point if outline.node is None else outline.node[point]])


def _seen(x: Array, R: Array, point: Array) -> Array:
    """A point (3,) in space as a body at x (3,), turned by R (4,), has it: R^T (r - x)."""
    seen: Array = in_space(np.zeros((1, 3)), inverse(R[None]), (point - x)[None, None])[0, 0]
    return seen


def _star(points: Array) -> Outline:
    """Lines from the first point to the others."""
    ends = np.arange(1, len(points))
    return Outline(points, np.column_stack([np.zeros_like(ends), ends]))


def _box_around(points: Array, least: float) -> Outline:
    """A box around points, of some thickness [m]."""
    low, high = points.min(axis=0), points.max(axis=0)
    return box(np.maximum(high - low, least), 0.5 * (low + high))
