"""A mechanism of bodies, joints, springs, motions and loads, checked when made."""

import itertools
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import KW_ONLY, field, replace
from pathlib import Path
from typing import Any

from ...files.html import listed, table
from ...inputs import FORM_OF_NAMES, is_name, quoted
from ..couplings.bearings import Bearing
from ..couplings.contacts import Contact
from ..couplings.couplers import Coupler
from ..couplings.coupling import GROUND, Coupling
from ..couplings.joint import Joint
from ..couplings.motions import PrescribedMotion
from ..couplings.motors import Motor
from ..couplings.springs import Spring
from ..couplings.stops import Stop
from ..couplings.surface_contacts import SurfaceContact
from ..errors import ModelError
from ..schema.entry import Entry, entry
from ..schema.values import NO_ITEMS, ZERO_VECTOR, Several, Vector
from .bodies import Body, FlexibleBody, Frame
from .fmus import FMU, check_fmus
from .loads import AnyLoad, Load, PatternLoad
from .settings import Settings
from .summary import counted, rows

Named = Joint | Spring | PrescribedMotion | Contact | Stop | Motor | Coupler | Bearing


@entry()
class Model(Entry):
    """A mechanism: bodies by name, and what acts between them.

    Couplings without a name are numbered, as "revolute 2", the second revolute joint.

    Parameters
    ----------
    bodies : mapping of RigidBody, FlexibleBody or RigidSuperelement
        By name.
    joints, loads, springs, motions, contacts, stops, motors, couplers, bearings : sequence
    surface_contacts, fmus : sequence
    gravity : (3,) [m/s^2]
        The acceleration of a free body.
    ground_frames : mapping of Frame
        Frames fixed in space, by name: "ground.NAME".
    settings : Settings
        How to integrate the motion, by default for one second.
    source, path : str
        The text of the model file and its name, if there is one.

    Raises
    ------
    ModelError
        For names that do not fit each other.

    Examples
    --------
    >>> from duhamel.solver import Revolute, RigidBody
    >>> arm = RigidBody(1.0, [0.1, 0.1, 0.1], {"pin": [0.0, 0.0, 0.5]})
    >>> model = Model({"arm": arm}, joints=[Revolute("ground", "arm.pin", axis=[0.0, 1.0, 0.0])])
    >>> [joint.name for joint in model.joints]
    ['revolute 1']
    """

    bodies: Mapping[str, Body]
    joints: Several[Joint] = NO_ITEMS
    loads: Several[AnyLoad] = NO_ITEMS
    springs: Several[Spring] = NO_ITEMS
    motions: Several[PrescribedMotion] = NO_ITEMS
    _: KW_ONLY
    contacts: Several[Contact] = NO_ITEMS
    stops: Several[Stop] = NO_ITEMS
    motors: Several[Motor] = NO_ITEMS
    couplers: Several[Coupler] = NO_ITEMS
    bearings: Several[Bearing] = NO_ITEMS
    surface_contacts: Several[SurfaceContact] = NO_ITEMS
    fmus: Several[FMU] = NO_ITEMS
    gravity: Vector = ZERO_VECTOR
    ground_frames: Mapping[str, Frame] = field(default_factory=dict)
    settings: Settings = field(default_factory=lambda: Settings(t_end=1.0))
    source: str = ""
    path: str = ""

    def validate(self) -> None:
        if not isinstance(self.settings, Settings):
            raise ModelError(f"settings: expected Settings, got {self.settings!r}")
        self._check_bodies()
        # Names are given before they are checked: a number must not meet a name that a user gave.
        self._name()
        self._check_names()
        self._check_starts()
        self._check_couplings()
        self._check_surfaces()
        self._check_loads()
        check_fmus(self.fmus, self.loads, self.motors)
        if self.settings.start == "equilibrium":
            self._check_equilibrium()

    def __repr__(self) -> str:
        parts = (counted(len(entries), kind) for kind, entries in self._parts().items() if entries)
        named = listed(self.bodies)
        return f"<Model: {', '.join([f'bodies {named}', *parts])}>"

    def _repr_html_(self) -> str:
        title = f"Model {Path(self.path).stem}" if self.path else "Model"
        return table(title, rows(self.bodies, self._parts(), self.gravity, self.settings))

    def _parts(self) -> dict[str, tuple[Any, ...]]:
        """Loads and couplings, the entries of each kind by its key in model files."""
        kinds = (
            *("joints", "springs", "motions", "loads", "contacts", "stops", "motors", "couplers"),
            *("bearings", "fmus"),
        )
        parts = {kind: getattr(self, kind) for kind in kinds}
        # Files, and so their readers, know one array of contacts.
        parts["contacts"] = (*self.contacts, *self.surface_contacts)
        return parts

    @property
    def flexible_bodies(self) -> dict[str, FlexibleBody]:
        return {name: body for name, body in self.bodies.items() if isinstance(body, FlexibleBody)}

    @property
    def bodies_with_pressed_surfaces(self) -> frozenset[str]:
        """The bodies of which a surface is in contact."""
        return frozenset(b for contact in self.surface_contacts for b in contact.flexible_bodies)

    @property
    def frame_loads(self) -> tuple[Load, ...]:
        """The loads on frames."""
        return tuple(load for load in self.loads if isinstance(load, Load))

    @property
    def pattern_loads(self) -> tuple[PatternLoad, ...]:
        """The load patterns on flexible bodies."""
        return tuple(load for load in self.loads if isinstance(load, PatternLoad))

    @property
    def couplings(self) -> tuple[Coupling, ...]:
        """All couplings, in the order in which the solver numbers their rows.

        ModelError for one that names a joint, or a coordinate of a joint, that does not exist.
        """
        joints = {joint.name: joint for joint in self.joints}
        # The order numbers the rows of the step: results and checkpoints rely on it.
        parts: tuple[Named, ...] = (
            *self.joints,
            *self.motions,
            *self.springs,
            *self.contacts,
            *self.stops,
            *self.motors,
            *self.couplers,
            *self.bearings,
        )
        return tuple(part.bound(joints) for part in parts)

    def with_settings(self, **changes: Any) -> "Model":
        """This mechanism with some of its settings changed."""
        return replace(self, settings=replace(self.settings, **changes))

    def without_surfaces(self) -> "Model":
        """This mechanism without contacts of surfaces and FMUs, as linear analyses take it."""
        settings = self.settings
        if not (self.contacts or self.stops):
            # Nothing is left that short steps would be for.
            settings = replace(settings, contact_step=None)
        return replace(self, surface_contacts=(), fmus=(), settings=settings)

    def frames_of(self, body: str) -> Mapping[str, Frame]:
        return self.ground_frames if body == GROUND else self.bodies[body].frames

    def _check_bodies(self) -> None:
        if not self.bodies:
            raise ModelError("bodies: expected at least one body, got none")
        for name, body in self.bodies.items():
            _check_name("bodies", "body", name)
            _check_frame_names(f"body {name!r}", body.frames)
        _check_frame_names("ground", self.ground_frames)

    @property
    def _named(self) -> dict[str, tuple[Named | SurfaceContact | FMU, ...]]:
        """The entries that need a unique name, by kind."""
        return {
            "joint": self.joints,
            "spring": self.springs,
            "motion": self.motions,
            "contact": self.contacts,
            "stop": self.stops,
            "motor": self.motors,
            "coupler": self.couplers,
            "bearing": self.bearings,
            "surface_contact": self.surface_contacts,
            "fmu": self.fmus,
        }

    def _name(self) -> None:
        """Give numbered names to entries without a name."""
        for kind, entries in self._named.items():
            strange = next((entry for entry in entries if not hasattr(entry, "name")), None)
            if strange is not None:
                raise ModelError(f"{kind}s: expected a {kind} each, got {strange!r}")
        taken = {entry.name for entries in self._named.values() for entry in entries}
        for kind, entries in self._named.items():
            if any(entry.name == "" for entry in entries):
                # The class is frozen: only while it is made may a field be set.
                object.__setattr__(self, f"{kind}s", numbered(kind, entries, taken))

    def _check_names(self) -> None:
        groups = self._named
        names: set[str] = set()
        for kind, couplings in groups.items():
            for coupling in couplings:
                _check_name(f"{kind}s", kind.replace("_", " "), coupling.name)
                if coupling.name in names:
                    raise ModelError(
                        f"{', '.join(f'{kind}s' for kind in groups if kind != 'surface_contact')}: "
                        "expected different names, "
                        f"got {coupling.name!r} more than once"
                    )
                names.add(coupling.name)

    def _check_starts(self) -> None:
        for name, body in self.bodies.items():
            if (place := body.start.place) is None:
                continue
            owner = f"body {name!r}: place"
            if place.frame:
                self._check_frame(owner, f"{name}.{place.frame}")
            if place.on not in self.bodies:
                self._check_frame(owner, place.on)

    def _check_couplings(self) -> None:
        for coupling in self.couplings:
            first, second = coupling.between
            self._check_frame(coupling.owner, first)
            self._check_frame(coupling.owner, second)
            if first.partition(".")[0] == second.partition(".")[0]:
                raise coupling.error(f"expected frames of two bodies, got {[first, second]}")

    def _check_surfaces(self) -> None:
        for contact in self.surface_contacts:
            self._check_surface(contact, contact.body, contact.surface)
            if contact.meets_surface:
                self._check_surface(contact, *contact.target)
            else:
                self._check_frame(contact.owner, contact.carrier)

    def _check_surface(self, contact: SurfaceContact, body: str, surface: str) -> None:
        if body not in self.bodies:
            known = ", ".join(self.bodies)
            raise contact.error(f"surfaces: no body {body!r}; there are: {known}")
        if body not in self.flexible_bodies:
            raise contact.error(
                f"surfaces: {body!r} is rigid: expected a flexible body; a rigid part meets the "
                "surface of a flexible one as a shape or as facets of a file, which its frame "
                "carries, or by a contact of balls"
            )
        found = self.flexible_bodies[body].superelement.surfaces
        names = () if found is None else tuple(patch.name for patch in found.patches)
        if surface not in names:
            raise contact.error(
                f"surfaces: no surface {surface!r} on {body!r}; it has: "
                f"{', '.join(names) or 'none (write [surfaces.NAME] into its body file)'}"
            )

    def _check_loads(self) -> None:
        for load in self.frame_loads:
            self._check_frame(load.owner, load.on)
            if load.on.partition(".")[0] == GROUND:
                raise load.error(f"expected a frame of a body, got {load.on!r}")
        flexible = self.flexible_bodies
        for spread in self.pattern_loads:
            if spread.body not in flexible:
                known = ", ".join(flexible) or "none"
                raise spread.error(f"no flexible body {spread.body!r}; there are: {known}")
            spread.pattern_of(flexible[spread.body].superelement)

    def _check_equilibrium(self) -> None:
        """ModelError for a velocity: in equilibrium only a steady rotation has velocities."""
        rotation = self.settings.steady_rotation
        for name in () if rotation is None else rotation.speed_ratios:
            if name not in self.bodies:
                raise ModelError(
                    f"steady_rotation: speed_ratios: no body {name!r}; there are: "
                    f"{', '.join(self.bodies)}"
                )
        for name, body in self.bodies.items():
            for key in ("velocity", "angular_velocity"):
                if (velocity := getattr(body.start, key)).any():
                    raise ModelError(
                        f"body {name!r}: {key}: start = 'equilibrium' takes no velocity but "
                        f"steady_rotation, got {velocity.tolist()}"
                    )
        for joint in self.joints:
            for key, value in joint.start.items():
                driven = key.removesuffix("_rate") in joint.drives
                if key.endswith("_rate") and value != 0.0 and not driven:
                    raise joint.error(
                        f"start: {key}: start = 'equilibrium' allows no rates but "
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
        # The center of mass of a flexible body is no material point, so that nothing can be fixed
        # to it.
        if not frame and body != GROUND and isinstance(self.bodies[body], FlexibleBody):
            raise ModelError(
                f"{owner}: {body!r} is flexible: name one of its interfaces "
                f"({', '.join(frames)}) as {body}.INTERFACE"
            )


def _check_frame_names(owner: str, frames: Iterable[str]) -> None:
    for frame in frames:
        _check_name(owner, "frame", frame)


def _check_name(owner: str, kind: str, name: str) -> None:
    is_ground = kind == "body" and name == GROUND
    if is_ground or not is_name(name):
        other = ", other than 'ground'" if is_ground else ""
        raise ModelError(
            f"{owner}: a {kind} cannot be named {quoted(name)}: expected {FORM_OF_NAMES}{other}"
        )


def numbered(kind: str, entries: tuple[Any, ...], taken: set[str]) -> tuple[Any, ...]:
    """Entries with a name each: joints and couplers by type and number, others by their kind.

    The number is that among those of the type; where another has the name, the next that is free.
    """
    counts: Counter[str] = Counter()
    named = []
    for item in entries:
        prefix = item.type if kind in ("joint", "coupler") else kind.removeprefix("surface_")
        counts[prefix] += 1
        if item.name == "":
            # Counting starts at the place of its kind, so that names stay the same when another
            # gets one.
            numbers = itertools.count(counts[prefix])
            name = next(n for k in numbers if (n := f"{prefix} {k}") not in taken)
            taken.add(name)
            item = replace(item, name=name)
        named.append(item)
    return tuple(named)
