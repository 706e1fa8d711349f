"""What a multibody model is: bodies with frames, joints and loads between frames. Frozen, and
checked when made.
"""

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import Any

import numpy as np

from ...superelement import Superelement
from ..arrays import Array
from ..errors import ModelError, plain
from .joints import Joint
from .motions import PrescribedMotion
from .settings import Settings
from .signals import Signal
from .springs import Spring
from .vectors import vector

GROUND = "ground"
INERTIA_TOLERANCE = 1e-6
"""relative; by how much the inertia of a plate, given in a few digits, may exceed that of its two
directions
"""


@dataclass(frozen=True, eq=False)
class Frame:
    """A point and three axes fixed in a body: position (3,) [m] and rotation vector (3,) [rad] in
    body axes.
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", vector("position", self.position))
        object.__setattr__(self, "rotation", vector("rotation", self.rotation))


@dataclass(frozen=True)
class Place:
    """Put a body so that its `frame` coincides, axes included, with the frame `on` ("BODY.FRAME")
    of another.
    """

    frame: str
    on: str


@dataclass(frozen=True, eq=False)
class Start:
    """Where a body starts and how fast.

    Either `position` (3,) of the centre of mass [m] and `rotation` vector (3,) [rad] in space, or
    `place`. velocity (3,) of the centre of mass in space [m/s]; angular_velocity (3,) in body axes
    [rad/s].
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.zeros(3))
    place: Place | None = None
    velocity: Array = field(default_factory=lambda: np.zeros(3))
    angular_velocity: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        for name in ("position", "rotation", "velocity", "angular_velocity"):
            object.__setattr__(self, name, vector(name, getattr(self, name)))
        if self.place is not None and (self.position.any() or self.rotation.any()):
            raise ModelError("a body starts by `place` or by `position` and `rotation`, got both")


@dataclass(frozen=True, eq=False)
class RigidBody:
    """mass [kg]; inertia about the centre of mass in body axes, (3,) principal or (3, 3) [kg m^2];
    named frames.

    No principal inertia exceeds the sum of the other two: there is no distribution of mass that has
    it.
    """

    mass: float
    inertia: Array
    frames: Mapping[str, Frame] = field(default_factory=dict)
    start: Start = field(default_factory=Start)

    def __post_init__(self) -> None:
        if not 0.0 < self.mass < np.inf:
            raise ModelError(f"mass: expected a positive number, got {self.mass}")
        inertia = np.asarray(self.inertia, dtype=float)
        if inertia.shape == (3,):
            inertia = np.diag(inertia)
        if inertia.shape != (3, 3) or not np.allclose(inertia, inertia.T, rtol=1e-9, atol=0.0):
            raise ModelError(
                f"inertia: expected three principal values or a symmetric 3x3 matrix, got {plain(self.inertia)}"
            )
        principal = np.linalg.eigvalsh(inertia)
        if not principal[0] > 0.0:
            raise ModelError(
                f"inertia: expected positive principal values, got {principal.tolist()}"
            )
        if principal[2] > (1.0 + INERTIA_TOLERANCE) * (principal[0] + principal[1]):
            raise ModelError(
                f"inertia: expected principal values of which none exceeds the sum of the other two, "
                f"got {principal.tolist()}"
            )
        object.__setattr__(self, "inertia", inertia)


@dataclass(frozen=True, eq=False)
class FlexibleBody:
    """A superelement that moves; its frames are its interfaces. `source` is the path of its file,
    if it has one.
    """

    superelement: Superelement
    start: Start = field(default_factory=Start)
    source: str = ""

    @property
    def mass(self) -> float:
        return self.superelement.mass

    @property
    def inertia(self) -> Array:
        return self.superelement.J_rot

    @property
    def frames(self) -> Mapping[str, Frame]:
        return {interface.name: Frame(interface.X) for interface in self.superelement.interfaces}


Body = RigidBody | FlexibleBody


@dataclass(frozen=True, eq=False)
class Load:
    """A force [N] or torque [N m] on a frame: signal(t) times `direction`, whose length counts.

    `direction` (3,) is in space, or in the axes of the frame when the load follows it.
    """

    type: str
    on: str
    direction: Array
    signal: Signal
    follower: bool = False

    def __post_init__(self) -> None:
        if self.type not in ("force", "torque"):
            raise ModelError(
                f"load on {self.on}: type: expected 'force' or 'torque', got {self.type!r}"
            )
        object.__setattr__(
            self, "direction", vector(f"load on {self.on}: direction", self.direction)
        )
        if not isinstance(self.signal, Signal):
            raise ModelError(
                f"load on {self.on}: signal: expected a signal such as Constant, got {self.signal!r}"
            )


@dataclass(frozen=True, eq=False)
class Model:
    """A mechanism: bodies by name, and what acts between them.

    gravity (3,) [m/s^2]: the acceleration of a free body; ground_frames: frames fixed in space;
    settings: how to integrate its motion, by default for one second; source, path: the text of the
    model file and its name, if there is one.
    """

    bodies: Mapping[str, Body]
    joints: tuple[Joint, ...] = ()
    loads: tuple[Load, ...] = ()
    springs: tuple[Spring, ...] = ()
    motions: tuple[PrescribedMotion, ...] = ()
    _: KW_ONLY
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    ground_frames: Mapping[str, Frame] = field(default_factory=dict)
    settings: Settings = field(default_factory=lambda: Settings(t_end=1.0))
    source: str = ""
    path: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "gravity", vector("gravity", self.gravity))
        for name in ("joints", "loads", "springs", "motions"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        if not isinstance(self.settings, Settings):
            raise ModelError(f"settings: expected Settings, got {self.settings!r}")
        self._check_names()
        self._check_start()

    @property
    def flexible_bodies(self) -> dict[str, FlexibleBody]:
        return {name: body for name, body in self.bodies.items() if isinstance(body, FlexibleBody)}

    def with_settings(self, **changes: Any) -> "Model":
        """The same mechanism with some of its settings changed."""
        return replace(self, settings=replace(self.settings, **changes))

    def frames_of(self, body: str) -> Mapping[str, Frame]:
        return self.ground_frames if body == GROUND else self.bodies[body].frames

    def _check_names(self) -> None:
        if not self.bodies:
            raise ModelError("bodies: expected at least one body, got none")
        for name in self.bodies:
            if name == GROUND or not _is_name(name):
                raise ModelError(f"bodies: a body cannot be named {name!r}")
            for frame in self.frames_of(name):
                if not _is_name(frame):
                    raise ModelError(f"body {name!r}: a frame cannot be named {frame!r}")
        named = [("joint", joint.name) for joint in self.joints]
        named += [("spring", spring.name) for spring in self.springs]
        named += [("motion", motion.name) for motion in self.motions]
        names = [name for _, name in named]
        for kind, name in named:
            if not _is_name(name):
                raise ModelError(f"{kind}s: a {kind} cannot be named {name!r}")
            if names.count(name) > 1:
                raise ModelError(
                    f"joints, springs, motions: expected different names, got {name!r} more than once"
                )
        for owner, frame in self._references():
            self._check_frame(owner, frame)

    def _check_start(self) -> None:
        """Equilibrium has no velocities but those of a steady rotation."""
        if self.settings.start != "equilibrium":
            return
        for name, body in self.bodies.items():
            for key in ("velocity", "angular_velocity"):
                if (velocity := getattr(body.start, key)).any():
                    raise ModelError(
                        f"body {name!r}: {key}: start = 'equilibrium' takes none but steady_rotation, "
                        f"got {velocity.tolist()}"
                    )
        for joint in self.joints:
            for key, value in joint.start.items():
                if key.endswith("_rate") and value != 0.0:
                    raise ModelError(
                        f"joint {joint.name!r}: start: {key}: start = 'equilibrium' takes no rates but "
                        f"steady_rotation, got {value}"
                    )

    def _references(self) -> Iterator[tuple[str, str]]:
        for name, body in self.bodies.items():
            if (place := body.start.place) is not None:
                if not place.frame:
                    raise ModelError(
                        f"body {name!r}: place: expected the name of one of its frames, got ''"
                    )
                yield f"body {name!r}: place", f"{name}.{place.frame}"
                yield f"body {name!r}: place", place.on
        for kind, couplings in (("joint", self.joints), ("spring", self.springs)):
            for coupling in couplings:
                owner, (first, second) = f"{kind} {coupling.name!r}", coupling.between
                yield owner, first
                yield owner, second
                if first.partition(".")[0] == second.partition(".")[0]:
                    raise ModelError(
                        f"{owner}: expected frames of two bodies, got {[first, second]}"
                    )
        for motion in self.motions:
            yield f"motion {motion.name!r}", motion.on
            if motion.on.partition(".")[0] == GROUND:
                raise ModelError(
                    f"motion {motion.name!r}: expected a frame of a body, got {motion.on!r}"
                )
        for load in self.loads:
            yield f"load ({load.type}) on {load.on!r}", load.on
            if load.on.partition(".")[0] == GROUND:
                raise ModelError(f"load ({load.type}): expected a frame of a body, got {load.on!r}")

    def _check_frame(self, owner: str, reference: str) -> None:
        body, _, frame = reference.partition(".")
        if body not in self.bodies and body != GROUND:
            raise ModelError(
                f"{owner}: no body {body!r}; there are: {', '.join([GROUND, *self.bodies])}"
            )
        known = ", ".join(self.frames_of(body)) or "none"
        if frame and frame not in self.frames_of(body):
            raise ModelError(f"{owner}: no frame {frame!r} on {body!r}; it has: {known}")
        if not frame and body in self.flexible_bodies:
            raise ModelError(
                f"{owner}: {body!r} is flexible: name one of its interfaces ({known}) as {body}.INTERFACE"
            )


def _is_name(name: str) -> bool:
    """Names make up paths of results and references to frames."""
    return bool(name) and "." not in name and "/" not in name
