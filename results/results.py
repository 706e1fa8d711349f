"""`Results`: the record of a run, in memory or in a file, read when asked for."""

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..files.arrays import Array
from ..files.html import listed, table
from ..superelement import Modes, Outline, Recovery, Superelement, SuperelementError, von_mises
from .contents import Contents, SuperelementFile, attributes_of
from .errors import ExportError, RecoveryError, ResultsError
from .file import FileSource, netcdf
from .motion import (
    EVENT_QUANTITIES,
    TIME_QUANTITY,
    BodyMotion,
    ContactMotion,
    CouplerMotion,
    Energy,
    Events,
    FmuMotion,
    FrameMotion,
    JointMotion,
    Momentum,
    MotorMotion,
    PatternMotion,
    SensorMotion,
    Solution,
    SpringMotion,
    StopMotion,
    SurfaceContactMotion,
)
from .outlines import Outlines
from .outlines import Source as OutlineSource
from .quantity import Quantity, Recorded
from .recovery import (
    MAX_KEPT_MODAL_BYTES,
    STARTS_AT_REST,
    Instants,
    ModalSteps,
    RecordedModes,
    as_in_run,
    in_space,
    instants,
    interface_loads,
    read_again,
    second_order_loads,
    stepping,
)
from .search import LENGTH_OF_FIELD, MODAL_BLOCK_STEPS, Extremes, Field, extremes
from .source import ALL_ROWS, Selection, Source
from .space import Connection, Place
from .summary import rows, spanned
from .validity import Check, Validity

Motion = TypeVar("Motion", bound=Recorded)


class Results:
    """The results of a run, in memory or in a file.

    Arrays are read when asked for; between reads a file is closed.

    Fields of flexible bodies (`displacement`, `stress`, `von_mises`, `position`) are superposed
    from the modes of their superelements, at one or several times t (k,) [s] of the run; between
    steps they are linear in time. They take one pass over the steps before t: ask for many times at
    once. `RecoveryError` names the missing data.

    Examples
    --------
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> results.bodies
    ('ball',)
    >>> results.body("ball").v[-1, :3].round(6).tolist()
    [0.0, 0.0, -10.0]
    """

    def __init__(
        self, source: Source, superelements: Mapping[str, Superelement] | None = None
    ) -> None:
        self._source = source
        self._superelements = dict(superelements or {})
        self._made_steps: dict[str, tuple[Superelement, Recovery, ModalSteps | RecordedModes]] = {}
        self._made_extremes: dict[tuple[str, str, int, int], Extremes] = {}

    @classmethod
    def read(
        cls, path: str | os.PathLike[str], superelements: Mapping[str, Superelement] | None = None
    ) -> "Results":
        """Open a results file.

        Parameters
        ----------
        path : path
        superelements : mapping of Superelement, optional
            By body, for fields, where the files that the run read are no longer where they were.

        Raises
        ------
        ResultsError
            Where it is no results file, or one of another version.
        """
        return cls(FileSource(Path(path)), superelements)

    @property
    def source(self) -> Source:
        """What they are read from."""
        return self._source

    def read_from(self, change: Callable[[Source], Source]) -> "Results":
        """The same results, read from what a function makes of their source."""
        return Results(change(self._source), self._superelements)

    def __repr__(self) -> str:
        bodies = listed(self.bodies)
        return f"<Results: {spanned(self.time)}, {len(self.time)} rows, bodies {bodies}>"

    def _repr_html_(self) -> str:
        shown = rows(self.time, self.solver, self.recorded, self.validity, self.never_closed)
        return table("Results", shown)

    @property
    def name(self) -> str:
        """The results file, or "results in memory"."""
        return self._source.name

    @property
    def recorded(self) -> tuple[str, ...]:
        """The groups that the run recorded, "bodies/hub", "frames/beam.tip", "energy", ...

        All groups unless the model requested fewer.
        """
        return self._source.contents().recorded

    @property
    def contents(self) -> Contents:
        """The variables of the results, and the entries of their dimensions, as in a file."""
        return self._source.contents()

    @property
    def bodies(self) -> tuple[str, ...]:
        """The names of the recorded bodies."""
        return self._names("body")

    @property
    def frames(self) -> tuple[str, ...]:
        """Frames as "BODY.FRAME"."""
        return self._names("frame")

    @property
    def interfaces(self) -> tuple[str, ...]:
        """The frames of flexible bodies."""
        flexible = self.superelement_files
        return tuple(name for name in self.frames if name.partition(".")[0] in flexible)

    @property
    def joints(self) -> tuple[str, ...]:
        """Joints and prescribed motions."""
        return self._names("joint")

    @property
    def springs(self) -> tuple[str, ...]:
        """The names of the recorded springs."""
        return self._names("spring")

    @property
    def couplers(self) -> tuple[str, ...]:
        """The names of the recorded couplers."""
        return self._names("coupler")

    @property
    def contacts(self) -> tuple[str, ...]:
        """The names of the recorded contacts of balls."""
        return self._names("contact")

    @property
    def surface_contacts(self) -> tuple[str, ...]:
        """The names of the recorded contacts of surfaces."""
        return self._names("surface_contact")

    @property
    def stops(self) -> tuple[str, ...]:
        """The names of the recorded stops."""
        return self._names("stop")

    @property
    def patterns(self) -> tuple[str, ...]:
        """Load patterns as "BODY.PATTERN"."""
        return self._names("pattern")

    @property
    def sensors(self) -> tuple[str, ...]:
        """Sensors as "BODY.SENSOR"."""
        return self._names("sensor")

    @property
    def motors(self) -> tuple[str, ...]:
        """The names of the recorded motors."""
        return self._names("motor")

    @property
    def fmus(self) -> tuple[str, ...]:
        """The names of the recorded FMUs of the model."""
        return self._names("fmu")

    @property
    def events(self) -> dict[str, Events]:
        """The events of each contact and stop, which are counted whatever was recorded."""
        return Events.by_owner(self._source.events(), self._names("event_owner"))

    @property
    def never_closed(self) -> list[str]:
        """Contacts and stops without events: they did not close in any step."""
        return [name for name, events in self.events.items() if not len(events)]

    @property
    def energies(self) -> tuple[str, ...]:
        """The energies that were recorded, as attributes of `energy`."""
        quantities = self._source.contents().quantities
        return tuple(quantity.attribute for quantity in quantities if quantity.group == "energy")

    @property
    def time(self) -> Array:
        """The recorded times (n,) [s]."""
        (time,) = self._source.read([(TIME_QUANTITY, None)])
        return time

    @property
    def energy(self) -> Energy:
        """The energies of the model over time [J]."""
        return self._whole(Energy)

    @property
    def momentum(self) -> Momentum:
        """The linear and angular momentum of the model over time."""
        return self._whole(Momentum)

    @property
    def iterations(self) -> Array:
        """The Newton iterations (n,) of each recorded step."""
        return self._whole(Solution).iterations

    @property
    def residual(self) -> Array:
        """The relative residual (n,) of each recorded step."""
        return self._whole(Solution).residual

    @property
    def solver(self) -> dict[str, Any]:
        """Notes of the run: steps, step size, seconds, rule, history, ..."""
        return self._source.notes()

    @property
    def validity(self) -> Validity:
        """How far the run can be trusted: what it passed at most, as far as it got."""
        names, values = self._source.contents().checks, self._source.checks().tolist()
        notes = self.solver
        step = float(notes.get("h", math.nan))
        in_contact = float(notes.get("contact_step", step))
        steps = step, in_contact, float(notes.get("finest_step", 0.0))
        return Validity(
            tuple(Check.of(*one).with_step(*steps) for one in zip(names, values, strict=True))
        )

    @property
    def model(self) -> str:
        """The text of the model file, if there was one."""
        return self._source.model()

    @property
    def superelement_files(self) -> dict[str, SuperelementFile]:
        """The file of the superelement of each flexible body."""
        return dict(self._source.contents().superelements)

    def variable(self, name: str, rows: slice = ALL_ROWS, owner: str = "") -> Array:
        """A variable over time by its name in a file, or some of its rows (n, ...).

        owner: what of it belongs to one alone. `KeyError` if it was not recorded.
        """
        contents = self.contents
        for quantity in contents.quantities:
            if quantity.name == name:
                entries = quantity.entries(contents.axes, owner) if owner else None
                (values,) = self._source.read([(quantity, entries)], rows)
                return values
        known = ", ".join(quantity.name for quantity in contents.quantities)
        raise KeyError(f"no variable {name}; there are: {known}")

    def to_xarray(self) -> Any:
        """All variables as an xarray.Dataset, by the names of the results file.

        That of a file is the file, opened: it is read when asked for, and stays open until
        `close()`. `ExportError` without xarray and h5netcdf.
        """
        try:
            import h5netcdf  # noqa: F401
            import xarray
        except ImportError as error:
            raise ExportError(
                f"to_xarray needs {error.name}: pip install xarray h5netcdf"
            ) from error
        return xarray.open_dataset(netcdf(self._source), engine="h5netcdf")

    def body(self, name: str) -> BodyMotion:
        """The motion of a body."""
        return self._of(BodyMotion, name)

    def frame(self, name: str) -> FrameMotion:
        """A frame as "BODY.FRAME"."""
        return self._of(FrameMotion, name)

    def joint(self, name: str) -> JointMotion:
        """A joint or a prescribed motion."""
        return self._of(JointMotion, name)

    def spring(self, name: str) -> SpringMotion:
        """The motion of a spring."""
        return self._of(SpringMotion, name)

    def contact(self, name: str) -> ContactMotion | StopMotion | SurfaceContactMotion:
        """A contact, of a ball or of surfaces, or a stop."""
        if name in self.stops:
            return self.stop(name)
        if name in self.surface_contacts:
            return self.surface_contact(name)
        return self._of(ContactMotion, name, events=self.events.get(name))

    def surface_contact(self, name: str) -> SurfaceContactMotion:
        """A contact of surfaces."""
        found = self._of(SurfaceContactMotion, name, events=self.events.get(name))
        # Without entries they were not recorded: no surface is without nodes.
        arrays = {
            key: one
            for key, one in vars(found).items()
            if not isinstance(one, np.ndarray) or one.size
        }
        return SurfaceContactMotion(arrays, (self.name, self.contents.version))

    def stop(self, name: str) -> StopMotion:
        return self._of(StopMotion, name, events=self.events.get(name))

    def coupler(self, name: str) -> CouplerMotion:
        return self._of(CouplerMotion, name)

    def pattern(self, name: str) -> PatternMotion:
        """A load pattern as "BODY.PATTERN"."""
        return self._of(PatternMotion, name)

    def sensor(self, name: str) -> SensorMotion:
        """A sensor as "BODY.SENSOR"."""
        return self._of(SensorMotion, name)

    def motor(self, name: str) -> MotorMotion:
        return self._of(MotorMotion, name)

    def fmu(self, name: str) -> FmuMotion:
        """What an FMU gives to the model."""
        return self._of(FmuMotion, name)

    def unit(self, group: str, owner: str, attribute: str) -> str:
        """The unit of an attribute, as of "joints", "hinge", "angle_rate".

        In the spelling of UDUNITS; several, joined by commas, where the attribute has several.
        """
        contents, units = self.contents, dict[str, None]()
        axes = contents.axes
        if group == "events":
            (event,) = (
                quantity for quantity in EVENT_QUANTITIES if quantity.attribute == attribute
            )
            return event.units(axes, axes["event_owner"].number(owner))[0]
        for name, quantity, entries in attributes_of(contents.quantities, axes, group, owner):
            if name == attribute:
                units |= dict.fromkeys(quantity.units(axes, entries))
        return ", ".join(units)

    def displacement(self, body: str, t: Any) -> Array:
        """Elastic displacements of the points of the recovery, in body axes [m].

        (p, 3), or (k, p, 3) for several times.
        """
        recovery, eta, _ = self._recover(body, t)
        return recovery.displacement(eta).reshape(*np.shape(t), -1, 3)

    def stress(self, body: str, t: Any) -> Array:
        """Stresses xx, yy, zz, yz, xz, xy there, (p, 6) or (k, p, 6), in body axes [Pa]."""
        recovery, eta, _ = self._recover(body, t, stress=True)
        self._stress_modes(body, recovery)
        return recovery.stresses(eta).reshape(*np.shape(t), -1, 6)

    def _stress_modes(self, body: str, recovery: Recovery) -> Array:
        try:
            return recovery.stress_modes
        except SuperelementError as error:
            raise RecoveryError(f"body {body!r}: {error}") from error

    def stress_history(self, body: str, points: Any, rows: slice = ALL_ROWS) -> Array:
        """Stresses (n, k, 6) [Pa] at some points of the recovery over the recorded steps.

        points: numbers, or a slice, of points; `recoverable(body).nodes` has their nodes.
        """
        recovery, modal = self._modal_steps(body)
        shapes = self._stress_modes(body, recovery)[points]
        eta = modal.at(np.arange(modal.n)[rows], stress=True)
        stress: Array = np.tensordot(eta, shapes, axes=(1, 2))
        return stress

    def von_mises(self, body: str, t: Any) -> Array:
        """The equivalent stress at these points, (p,) or (k, p) [Pa]."""
        return von_mises(self.stress(body, t))

    def position(self, body: str, t: Any) -> Array:
        """Positions of these points in space, x + R (X + u), (p, 3) or (k, p, 3) [m]."""
        recovery, eta, when = self._recover(body, t)
        motion = self.body(body)
        x, R = (when.of(rows[when.before], rows[when.after]) for rows in (motion.x, motion.R))
        points = in_space(x, R, recovery.points + recovery.displacement(eta))
        return points.reshape(*np.shape(t), -1, 3)

    @property
    def couplings(self) -> tuple[Connection, ...]:
        """What acts between bodies, recorded or not; none in files before version 7."""
        return self._outlines.space.connections

    @property
    def ground_frames(self) -> dict[str, Array]:
        """Positions (3,) of frames fixed in space [m]; none in files before version 7."""
        return dict(self._outlines.space.ground_frames)

    def outline(self, body: str) -> Outline:
        """What a recorded body looks like at rest.

        Of files before version 7, which have no outlines, it is made of what is known.
        """
        return self._outlines.at_rest(body)

    def outline_source(self, body: str) -> OutlineSource:
        """Where the deformation of the outline is from.

        "rigid": there is none; "recovery": the modes of the mesh; "interfaces": blended between the
        recorded motions of the interfaces.
        """
        return self._outlines.source(body)

    def outline_remark(self, body: str) -> str:
        """What a reader of a picture must know of the deformation of a body; "" if nothing.

        That it is interpolated between the interfaces, and why; or unknown, and drawn rigid.
        """
        return self._outlines.remark(body)

    def outline_displacement(self, body: str, t: Any) -> Array:
        """Elastic displacements of the outline, (p, 3) or (k, p, 3), in body axes [m]."""
        return self._outlines.displacement(body, t)

    def outline_position(self, body: str, t: Any, magnification: float = 1.0) -> Array:
        """The outline in space, x + R (X + magnification u), (p, 3) or (k, p, 3) [m]."""
        return self._outlines.position(body, t, magnification)

    def outline_velocity(self, body: str, t: Any) -> Array:
        """Velocities of the outline in space, (p, 3) or (k, p, 3) [m/s].

        The elastic ones are by differences over one recorded step.
        """
        return self._outlines.velocity(body, t)

    def outline_field(self, body: str, t: Any, name: str) -> Array:
        """Magnitudes at the outline, (p,) or (k, p).

        "displacement" [m]; "velocity" in space [m/s], with elastic rates by differences over one
        recorded step; "von_mises" and "pressure" of contacts of surfaces [Pa], of which
        `RecoveryError` says what is missing.
        """
        return self._outlines.field(body, t, name)

    def superelement(self, body: str) -> Superelement:
        """The superelement of a flexible body, read again from its file where necessary.

        `RecoveryError` if the file has changed.
        """
        file, given = self.superelement_files.get(body), self._superelements.get(body)
        found = read_again(body, file) if given is None else as_in_run(given, file)
        self._superelements[body] = found
        return found

    @property
    def bands(self) -> dict[str, float]:
        """The frequency up to which the superelement of a body is right [Hz].

        Of flexible bodies whose superelement is exact, and in files of earlier versions, none.
        """
        rows = str(self.solver.get("bands", "")).splitlines()
        pairs = [row.partition(" ") for row in rows]
        try:
            return {name: float(band) for band, _, name in pairs}
        except ValueError as error:
            raise ResultsError(
                f"{self.name}: attribute bands: expected numbers: {error}"
            ) from error

    @cached_property
    def _outlines(self) -> Outlines:
        return Outlines(self, self._source.space())

    def place(self, body: str, point: int) -> Place:
        """Where a point of the outline of a body is at rest."""
        return self._outlines.place(body, point)

    def recoverable(self, body: str) -> Recovery:
        """The recovery of a body; `RecoveryError` where the run does not allow it."""
        return self._checked_recovery(body)[1]

    def modal_state(self, body: str, t: Array) -> tuple[Recovery, Array]:
        """The recovery of a body, and its modal coordinates (k, m) at times (k,)."""
        return self._recover(body, t)[:2]

    def _checked_recovery(self, body: str) -> tuple[Superelement, Recovery, Modes]:
        element = self.superelement(body)
        if element.variation is not None and element.variation.design:
            raise RecoveryError(
                f"body {body!r}: its fields are not known with {element.variation}: make its "
                "superelement for these values"
            )
        if element.recovery is None or element.modes is None:
            raise RecoveryError(
                f"body {body!r}: superelement {element.name!r} holds no recovery: add "
                f"a table [recovery] to its body file and preprocess it again; in Python "
                "part.recover(), before part.superelement(...)"
            )
        self._check_recoverable(body, element)
        return element, element.recovery, element.modes

    def _recover(self, body: str, t: Any, stress: bool = False) -> tuple[Recovery, Array, Instants]:
        """The recovery of a body, and its modal coordinates (k, m) at times t (k,)."""
        recovery, modal = self._modal_steps(body)
        when = instants(self.time, np.atleast_1d(np.asarray(t, dtype=float)))
        steps = np.append(when.before, when.after)
        return recovery, when.of(*np.split(modal.at(steps, stress), 2)), when

    def _modal_steps(self, body: str) -> tuple[Recovery, ModalSteps | RecordedModes]:
        """The recovery of a body, and its modal coordinates at all steps, which are kept.

        They are made again where more was recorded since, or another superelement is given. Forces
        on surfaces are coordinates too.
        """
        element, recovery, of_element = self._checked_recovery(body)
        time = self.time
        made = self._made_steps.get(body)
        if made is None or made[0] is not element or made[2].n != len(time):
            made = element, *self._stepped(body, element, recovery, of_element)
            if (
                sum(steps.nbytes for _, _, steps in (made, *self._made_steps.values()))
                > MAX_KEPT_MODAL_BYTES
            ):
                self._made_steps.clear()
            self._made_steps[body] = made
            self._made_extremes = {
                key: found for key, found in self._made_extremes.items() if key[0] != body
            }
        return made[1:]

    def field_extremes(self, body: str, name: str, rows: slice = ALL_ROWS) -> Extremes:
        """The extremes over recorded steps of the largest value of a field at any point of a body.

        name: "von_mises" or "displacement"; rows: among these steps, from which its numbers of
        steps count too. All points and steps are counted, though most need not be computed; what
        was found is kept.
        """
        recovery, modal = self._modal_steps(body)
        first, last, _ = rows.indices(modal.n)
        key = body, name, first, last
        if key not in self._made_extremes:
            stress = name == "von_mises"
            shapes = self._stress_modes(body, recovery) if stress else recovery.phi
            blocks = modal.blocks(slice(first, last), MODAL_BLOCK_STEPS, stress)
            self._made_extremes[key] = extremes(Field(shapes, LENGTH_OF_FIELD[name]), blocks)
        return self._made_extremes[key]

    def _stepped(
        self, body: str, element: Superelement, recovery: Recovery, modes: Modes
    ) -> tuple[Recovery, ModalSteps | RecordedModes]:
        """The modal coordinates of a body: recorded ones, where contacts load it, with loads."""
        run = stepping(self._source.name, self.solver, self.time)
        if body not in self.pressed:
            return recovery, ModalSteps(*self._loads(body, element, modes), run)
        motion = self.body(body)
        names = (name.rpartition(".") for name in self._names("surface_load"))
        nodes = np.array([int(node) - 1 for owner, _, node in names if owner == body])
        rows, loads = 3 * nodes[:, None] + np.arange(3), motion.surface_load
        # Most nodes are never touched: their columns would only take memory.
        touched = loads.any(axis=0)
        recovery = recovery.with_loads(rows[touched])
        eta = motion.modal_coordinate * np.sqrt(element.mass)
        return recovery, RecordedModes(modes, eta, run.h, loads[:, touched])

    def _loads(self, body: str, element: Superelement, modes: Modes) -> tuple[Modes, Array]:
        """The loads that drove a body (n, n_dofs), and its modes with the rows that they act on."""
        motion, loads = self.body(body), []
        for interface in element.interfaces:
            frame = self.frame(f"{body}.{interface.name}")
            loads.append(interface_loads(motion.R, frame.u, frame.force, interface.rotations))
        if element.channels is not None:
            assert element.channels.phi is not None
            names = [f"{body}.{pattern.name}" for pattern in element.patterns]
            loads += [self.pattern(name).load[:, None] for name in names]
            rows = element.channels.phi[: len(names)]
            modes = replace(modes, phi=np.vstack([modes.phi, rows]))
        if r := motion.second_order_force.shape[1]:
            if element.rotation is None or element.rotation.r != r:
                raise RecoveryError(
                    f"body {body!r}: superelement {element.name!r}: expected {r} coordinates of "
                    f"second order, as in the run, found {getattr(element.rotation, 'r', 0)}"
                )
            modes = element.rotation.complete(modes)
            omega, force = motion.v[:, 3:], motion.second_order_force
            loads.append(second_order_loads(omega, force, element.mass))
        return modes, np.hstack(loads)

    @property
    def pressed_surfaces(self) -> tuple[tuple[str, str, str], ...]:
        """Body, surface and contact of each surface in contact; "" for a second surface.

        Contacts have pressures at the nodes of their first surface.
        """
        rows = [row.partition(" ") for row in str(self.solver.get("surfaces", "")).splitlines()]
        places = [(place.partition("."), contact) for place, _, contact in rows]
        return tuple((body, surface, contact) for (body, _, surface), contact in places)

    @property
    def pressed(self) -> frozenset[str]:
        """The bodies of these surfaces."""
        return frozenset(body for body, _, _ in self.pressed_surfaces)

    def _check_recoverable(self, body: str, element: Superelement) -> None:
        if body in self.pressed:
            self._check_modes(body, element)
            # Otherwise stresses follow from each of the steps, as those of bodies in flight do.
            if element.modes is None or element.modes.chain is None:
                return
        if (every := int(self.solver.get("every", 1))) > 1:
            raise RecoveryError(
                f"body {body!r}: fields need every step, and the run recorded one in {every}"
            )
        if (start := self.solver.get("start", "given")) not in STARTS_AT_REST:
            raise RecoveryError(
                f"body {body!r}: fields need a run from its start; this one goes on from {start}"
            )
        # The loads on its interfaces are not all that moved such a body.
        if body in self.pressed:
            return
        recorded = self.recorded
        frames = [f"frames/{body}.{interface.name}" for interface in element.interfaces]
        patterns = [f"patterns/{body}.{pattern.name}" for pattern in element.patterns]
        needed = (f"bodies/{body}", *frames, *patterns)
        if missing := [name for name in needed if name not in recorded]:
            raise RecoveryError(
                f"body {body!r}: fields need {', '.join(missing)}, which the run did not record"
            )

    def _check_modes(self, body: str, element: Superelement) -> None:
        """`RecoveryError` where a run recorded no modes of a body whose surfaces are in contact."""
        assert element.modes is not None
        is_there, expected = f"bodies/{body}" in self.recorded, len(element.modes.omega)
        found = self.body(body).modal_coordinate.shape[1] if is_there else 0
        if found != expected:
            raise RecoveryError(
                f"body {body!r}: its surfaces are in contact: fields need the coordinates of its "
                f"{expected} modes, found {found} in the results: expected a run with this "
                "superelement and [output] modes = true"
            )
        if element.recovery is not None and element.recovery.rest is None:
            raise RecoveryError(
                f"body {body!r}: its surfaces are in contact, and superelement {element.name!r} "
                "has no static fields of forces on them: preprocess it again"
            )

    def _names(self, dimension: str) -> tuple[str, ...]:
        axes = self._source.contents().axes
        return axes[dimension].names if dimension in axes else ()

    def _of(self, kind: type[Motion], owner: str, **more: Any) -> Motion:
        """What was recorded of an owner, and more of it."""
        contents = self._source.contents()
        if owner not in self._names(kind.owner):
            raise _not_recorded(contents, f"{kind.group}/{owner}")
        found = attributes_of(_there(contents, kind), contents.axes, kind.group, owner)
        arrays = self._joined([(name, (quantity, entries)) for name, quantity, entries in found])
        return kind(arrays | more, (self.name, contents.version))

    def _whole(self, kind: type[Motion]) -> Motion:
        """What was recorded of the whole run."""
        contents = self._source.contents()
        found = _there(contents, kind)
        if not found and kind is not Solution:  # which can lack in files that others made
            raise _not_recorded(contents, kind.group)
        arrays = self._joined([(quantity.attribute, (quantity, None)) for quantity in found])
        return kind(arrays, (self.name, contents.version))

    def _joined(self, selections: list[tuple[str, Selection]]) -> dict[str, Array]:
        """Arrays by attribute; those of one attribute joined along the last axis."""
        joined: dict[str, Array] = {}
        arrays = self._source.read([selection for _, selection in selections])
        for (attribute, _), array in zip(selections, arrays, strict=True):
            before = joined.get(attribute)
            joined[attribute] = array if before is None else np.hstack([before, array])
        return joined


def _there(contents: Contents, kind: type[Recorded]) -> list[Quantity]:
    """The quantities of a kind but for those of attributes that are not whole, as in old files.

    Those of which no owner has an entry are there, without a variable in the file.
    """
    names = {quantity.name for quantity in contents.quantities}
    absent = {
        quantity.attribute
        for quantity in kind.quantities
        if quantity.name not in names and (not quantity.of or quantity.of in contents.axes)
    }
    return [quantity for quantity in kind.quantities if quantity.attribute not in absent]


def _not_recorded(contents: Contents, name: str) -> KeyError:
    recorded, (group, _, _) = contents.recorded, name.partition("/")
    like = [known.removeprefix(f"{group}/") for known in recorded if known.startswith(f"{group}/")]
    return KeyError(f"no {name}; there are: {', '.join(like or recorded)}")
