"""A mechanism of bodies, joints, springs, motions and loads, checked when made."""

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, field, replace
from typing import Any

from ...inputs import is_name, quoted
from ..errors import ModelError
from ..schema.entry import Entry, entry
from ..schema.values import NONE, ORIGIN, Several, Vector
from .bodies import Body, FlexibleBody, Frame
from .contacts import Contact
from .joints import Joint
from .loads import Load
from .motions import PrescribedMotion
from .settings import Settings
from .springs import Spring
from .stops import JointStop, Stop

GROUND = "ground"
Coupling = Joint | PrescribedMotion | Spring | Contact | JointStop


@entry()
class Model(Entry):
    """A mechanism: bodies by name, joints, springs, motions, loads, contacts and stops.

    gravity (3,) [m/s^2]: the acceleration of a free body; ground_frames: frames fixed in space;
    settings: how to integrate its motion, by default for one second; source, path: the text of the
    model file and its name, if there is one.
    """

    bodies: Mapping[str, Body]
    joints: Several[Joint] = NONE
    loads: Several[Load] = NONE
    springs: Several[Spring] = NONE
    motions: Several[PrescribedMotion] = NONE
    _: KW_ONLY
    contacts: Several[Contact] = NONE
    stops: Several[Stop] = NONE
    gravity: Vector = ORIGIN
    ground_frames: Mapping[str, Frame] = field(default_factory=dict)
    settings: Settings = field(default_factory=lambda: Settings(t_end=1.0))
    source: str = ""
    path: str = ""

    def validate(self) -> None:
        if not isinstance(self.settings, Settings):
            raise ModelError(f"settings: expected Settings, got {self.settings!r}")
        self._check_bodies()
        self._check_names()
        self._check_starts()
        self._check_couplings()
        self._check_loads()
        if self.settings.start == "equilibrium":
            self._check_equilibrium()

    @property
    def flexible_bodies(self) -> dict[str, FlexibleBody]:
        return {name: body for name, body in self.bodies.items() if isinstance(body, FlexibleBody)}

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """Joints, motions, springs, contacts and stops, as the solver numbers them."""
        return (*self.joints, *self.motions, *self.springs, *self.contacts, *self._joint_stops())

    def _joint_stops(self) -> Iterator[JointStop]:
        joints = {joint.name: joint for joint in self.joints}
        return (JointStop(stop, joints[stop.joint]) for stop in self.stops)

    def with_settings(self, **changes: Any) -> "Model":
        """This mechanism with some of its settings changed."""
        return replace(self, settings=replace(self.settings, **changes))

    def frames_of(self, body: str) -> Mapping[str, Frame]:
        return self.ground_frames if body == GROUND else self.bodies[body].frames

    def _check_bodies(self) -> None:
        if not self.bodies:
            raise ModelError("bodies: expected at least one body, got none")
        for name, body in self.bodies.items():
            if name == GROUND or not is_name(name):
                raise ModelError(f"bodies: a body cannot be named {quoted(name)}")
            for frame in body.frames:
                if not is_name(frame):
                    raise ModelError(f"body {name!r}: a frame cannot be named {quoted(frame)}")

    def _check_names(self) -> None:
        groups: dict[str, tuple[Joint | Spring | PrescribedMotion | Contact | Stop, ...]] = {
            "joint": self.joints,
            "spring": self.springs,
            "motion": self.motions,
            "contact": self.contacts,
            "stop": self.stops,
        }
        names: set[str] = set()
        for kind, couplings in groups.items():
            for coupling in couplings:
                if not is_name(coupling.name):
                    raise ModelError(f"{kind}s: a {kind} cannot be named {quoted(coupling.name)}")
                if coupling.name in names:
                    raise ModelError(
                        "joints, springs, motions, contacts, stops: expected different names, "
                        f"got {coupling.name!r} more than once"
                    )
                names.add(coupling.name)

    def _check_starts(self) -> None:
        for name, body in self.bodies.items():
            if (place := body.start.place) is None:
                continue
            owner = f"body {name!r}: place"
            if not place.frame:
                raise ModelError(f"{owner}: expected the name of one of its frames, got ''")
            self._check_frame(owner, f"{name}.{place.frame}")
            self._check_frame(owner, place.on)

    def _check_couplings(self) -> None:
        self._check_stops()
        joined: tuple[Joint | Spring | Contact, ...] = (
            *self.joints,
            *self.springs,
            *self.contacts,
        )
        for coupling in joined:
            first, second = coupling.between
            self._check_frame(coupling.owner, first)
            self._check_frame(coupling.owner, second)
            if first.partition(".")[0] == second.partition(".")[0]:
                raise coupling.error(f"expected frames of two bodies, got {[first, second]}")

    def _check_stops(self) -> None:
        joints = {joint.name: joint for joint in self.joints}
        for stop in self.stops:
            if stop.joint not in joints:
                known = ", ".join(joints) or "none"
                raise stop.error(f"joint: no joint {stop.joint!r}; there are: {known}")
            kind = joints[stop.joint].kind
            free = (*kind.distances, *kind.angles)
            if stop.coordinate not in free:
                raise stop.error(
                    f"coordinate: joint {stop.joint!r} has {', '.join(free) or 'none'}, "
                    f"got {stop.coordinate!r}"
                )

    def _check_loads(self) -> None:
        for load in (*self.motions, *self.loads):
            self._check_frame(load.owner, load.on)
            if load.on.partition(".")[0] == GROUND:
                raise load.error(f"expected a frame of a body, got {load.on!r}")

    def _check_equilibrium(self) -> None:
        """ModelError for a velocity, for equilibrium has none but those of a steady rotation."""
        for name, body in self.bodies.items():
            for key in ("velocity", "angular_velocity"):
                if (velocity := getattr(body.start, key)).any():
                    raise ModelError(
                        f"body {name!r}: {key}: start = 'equilibrium' takes none but "
                        f"steady_rotation, got {velocity.tolist()}"
                    )
        for joint in self.joints:
            for key, value in joint.start.items():
                driven = key.removesuffix("_rate") in joint.drives
                if key.endswith("_rate") and value != 0.0 and not driven:
                    raise joint.error(
                        f"start: {key}: start = 'equilibrium' takes no rates but "
                        f"steady_rotation, got {value}"
                    )

    def _check_frame(self, owner: str, reference: str) -> None:
        body, _, frame = reference.partition(".")
        if body not in self.bodies and body != GROUND:
            raise ModelError(
                f"{owner}: no body {body!r}; there are: {', '.join([GROUND, *self.bodies])}"
            )
        frames = self.frames_of(body)
        if frame and frame not in frames:
            known = ", ".join(frames) or "none"
            raise ModelError(f"{owner}: no frame {frame!r} on {body!r}; it has: {known}")
        if not frame and body != GROUND and isinstance(self.bodies[body], FlexibleBody):
            raise ModelError(
                f"{owner}: {body!r} is flexible: name one of its interfaces "
                f"({', '.join(frames)}) as {body}.INTERFACE"
            )
