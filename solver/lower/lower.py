"""A model as flat arrays, made once per simulation."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from ...superelement import GeneralizedAlpha, Superelement
from ..arrays import Array, as_index, as_rows, starts
from ..couplings.friction import Bristle
from ..couplings.rows import Pose, Row
from ..history.layout import Horizon, Responses, Stepping, lay_out_elastic
from ..model.loads import AnyLoad
from ..model.model import Model
from ..model.settings import StartFrom
from ..signals.signal import Signal, SmoothSignal
from ..step.records.bodies import Bodies
from ..step.records.couplings import Couplings
from ..step.records.elastic import Elastic, Sensors
from ..step.records.loads import LoadPatterns, Loads
from ..step.records.surfaces import Surfaces
from ..step.rows import measures_length
from ..step.system import System
from .checks import check_assembled, check_masses, check_moments
from .elimination_order import lay_out_pattern
from .friction import inertia_between
from .numbering import NumberedFrames, number_frames
from .placement import place_bodies
from .rows import lay_out_couplings, lay_out_rows
from .scheme import lay_out_newton, lay_out_scheme, round_up, stepping_of
from .size import model_size
from .sizes import sizes_of
from .surfaces import SurfaceLayout, lay_out_surfaces, plan_surfaces


@dataclass(frozen=True, eq=False)
class LoweredModel:
    """A system with the names and signals that belong to its arrays, and its poses at the start."""

    model: Model
    system: System
    scheme: GeneralizedAlpha
    n_steps: int
    horizon: Horizon
    without: frozenset[int]
    """redundant rows that are left out, by their numbers"""
    poses: list[Pose]
    body_names: list[str]
    frame_names: list[str]
    frame_poses: list[Pose]
    coupling_names: list[str]
    observers: list[tuple[str, str]]
    """joint and coordinate of each observer row"""
    observer_starts: Array
    starts: Array
    """coordinates of all rows, to which angles are then the nearest"""
    memories: Array
    """of the force laws, before the start"""
    term_starts: Array
    """of all terms, likewise"""
    drives: list[SmoothSignal]
    drive_starts: Array
    """of the coordinates that drives move, where the bodies are placed"""
    load_signals: list[Signal]
    motor_signals: list[Signal]
    """three of each motor: what it gives without an error, its reference, and the rate of that"""
    superelements: list[Superelement]
    responses: Responses
    """of every flexible body"""
    surfaces_of: Callable[[Elastic], Surfaces]
    """contacts of surfaces whose bodies have other compliances"""
    flight: System | None = None
    """the system in the longest steps, away from contacts; None where all steps are the same"""

    @property
    def loads(self) -> tuple[AnyLoad, ...]:
        """The loads in the order of their signals: those on frames first."""
        return _loads_of(self.model)

    @property
    def h(self) -> float:
        """The shortest step, by which steps are counted."""
        return float(self.system.scheme.h)

    @property
    def ratio(self) -> int:
        """The ratio of the longest step to the shortest."""
        return int(self.system.scheme.ratio)

    @property
    def longest_step(self) -> float:
        return self.h * self.ratio

    @cached_property
    def sizes(self) -> dict[str, int]:
        """The dimensions of `State`, `Workspace` and `Output` by name."""
        return sizes_of(self.system, self.n_steps)

    @cached_property
    def measures_lengths(self) -> NDArray[np.bool_]:
        """True for every row whose coordinate is a length, not an angle (n_rows,)."""
        return np.array(
            [measures_length(kind) for kind in self.system.couplings.rows.kind.tolist()], dtype=bool
        )

    def coupling_of(self, row: int) -> int:
        """The number of the coupling that a row belongs to."""
        return int(np.searchsorted(self.system.couplings.range, row, side="right")) - 1

    def owner_of(self, row: int) -> str:
        """The coupling that a row belongs to, as messages name it: "joint 'hinge'"."""
        return self.model.couplings[self.coupling_of(row)].owner


def lower(
    model: Model, without: frozenset[int] = frozenset(), earlier: Horizon | None = None
) -> LoweredModel:
    """Number bodies, frames, rows and dofs of a model, and lay them out for the time loop.

    without: rows to leave out, by their numbers; earlier: the horizon of the run that this one
    continues. `ModelError` for a model that cannot be laid out.
    """
    stepping = stepping_of(model, earlier)
    poses = place_bodies(model)
    frames = number_frames(model, poses)
    rows = _rows(model, frames, without)
    couplings, drives = lay_out_couplings(
        list(rows.values()),
        _bristles(model, poses, frames, stepping),
        [coupling.opens for coupling in model.couplings],
    )
    laid_out = [row for coupling in rows.values() for row in coupling]
    laws = [law for row in laid_out for law in row.laws]
    observers = _observers(model, frames)
    size = model_size(model, poses, frames)
    if not (model.settings.assemble or isinstance(model.settings.start, StartFrom)):
        check_assembled(model, size, frames)
    # After the rows are made: whether one measures an angle is known only then.
    check_moments(model, frames, rows)
    check_masses(model)
    elastic, responses = lay_out_elastic(model, frames.arrays, stepping)
    surfaces = plan_surfaces(model, frames)
    surfaces_of = partial(lay_out_surfaces, model, surfaces, frames, stepping=stepping)
    system = System(
        scheme=lay_out_scheme(stepping),
        newton=lay_out_newton(model),
        bodies=_lay_out_bodies(model, size, frames, couplings),
        frames=frames.arrays,
        couplings=couplings,
        observers=lay_out_rows(list(observers.values())),
        loads=_lay_out_loads(model, frames),
        patterns=_lay_out_patterns(model, elastic),
        sensors=_lay_out_sensors(model, elastic),
        elastic=elastic,
        surfaces=surfaces_of(elastic),
        pattern=lay_out_pattern(
            len(model.bodies), frames.arrays, couplings, elastic, surfaces.island_bodies
        ),
    )
    return LoweredModel(
        model=model,
        system=system,
        scheme=stepping.scheme,
        # Counted in short steps, but always a whole number of long ones.
        n_steps=stepping.ratio * round_up(model.settings.t_end / stepping.in_flight.h),
        horizon=Horizon(stepping.planned, stepping.n_steps),
        without=without,
        poses=[poses[name] for name in model.bodies],
        body_names=list(model.bodies),
        frame_names=list(frames.poses),
        frame_poses=list(frames.poses.values()),
        coupling_names=list(rows),
        observers=list(observers),
        observer_starts=np.array([row.start for row in observers.values()]),
        starts=np.array([row.start for row in laid_out], dtype=float),
        memories=np.array([number for law in laws for number in law.memories()], dtype=float),
        term_starts=np.array([t.row.start for r in laid_out for t in r.terms], dtype=float),
        drives=drives,
        drive_starts=np.array([x for row in laid_out for x in _drive_starts(row)], dtype=float),
        load_signals=[load.signal for load in _loads_of(model)],
        motor_signals=[signal for motor in model.motors for signal in motor.signals],
        superelements=[body.superelement for body in model.flexible_bodies.values()],
        responses=responses,
        surfaces_of=surfaces_of,
        flight=_in_flight(model, frames, surfaces, stepping, system),
    )


def _in_flight(
    model: Model,
    frames: NumberedFrames,
    surfaces: SurfaceLayout,
    stepping: Stepping,
    system: System,
) -> System | None:
    """The system in the longest steps, which shares all that does not depend on the step."""
    if stepping.ratio == 1:
        return None
    elastic, _ = lay_out_elastic(model, frames.arrays, stepping.in_flight)
    # All other arrays are shared: both sizes of steps change one state.
    return system.replace(
        scheme=lay_out_scheme(stepping.in_flight),
        elastic=elastic,
        surfaces=lay_out_surfaces(model, surfaces, frames, elastic, stepping.in_flight),
    )


def _rows(model: Model, frames: NumberedFrames, without: frozenset[int]) -> dict[str, list[Row]]:
    """The rows of each coupling that are not left out, by its name."""
    rows: dict[str, list[Row]] = {}
    number = 0
    for coupling in model.couplings:
        rows[coupling.name] = []
        for row in coupling.rows([frames.sides(framing) for framing in coupling.framed_by]):
            if number not in without:
                rows[coupling.name].append(row)
            # Counted over all rows, left out or not: `without` has the numbers of the whole model.
            number += 1
    return rows


def _drive_starts(row: Row) -> list[float]:
    """The values of the drives of a row where the bodies are placed."""
    return [drive(0.0) if row.reference is None else row.reference for drive in row.drives]


def _bristles(
    model: Model, poses: Mapping[str, Pose], frames: NumberedFrames, stepping: Stepping
) -> list[Bristle | None]:
    """The friction of each coupling, resolved by the longest step in which it acts."""
    bristles = []
    for coupling in model.couplings:
        acting = stepping if coupling.opens else stepping.in_flight
        moved = inertia_between(coupling, model, poses)
        bristles.append(coupling.bristle(moved, frames.sides(coupling), acting.h))
    return bristles


def _observers(model: Model, frames: NumberedFrames) -> dict[tuple[str, str], Row]:
    """The rows that only observe joint coordinates, by joint and coordinate."""
    return {
        (coupling.name, coordinate): row
        for coupling in model.couplings
        for coordinate, row in coupling.observed(frames.sides(coupling)).items()
    }


def _lay_out_bodies(
    model: Model, size: float, frames: NumberedFrames, couplings: Couplings
) -> Bodies:
    bodies = model.bodies.values()
    rows, hard = couplings.rows, couplings.compliant == 0
    # Bodies that no constraint holds: their angular momentum must be conserved, and is checked.
    held = frames.arrays.body[np.concatenate([rows.frame_a[hard], rows.frame_b[hard]])]
    free = np.ones(len(bodies), dtype=bool)
    free[held[held >= 0]] = False
    return Bodies(
        free=np.flatnonzero(free),
        mass=np.array([body.mass for body in bodies], dtype=float),
        J_rot=np.array([body.inertia for body in bodies], dtype=float),
        gravity=model.gravity.copy(),
        size=size,
    )


def _loads_of(model: Model) -> tuple[AnyLoad, ...]:
    on_frames: tuple[AnyLoad, ...] = model.frame_loads
    return on_frames + model.pattern_loads


def _lay_out_patterns(model: Model, elastic: Elastic) -> LoadPatterns:
    names = list(model.bodies)
    dofs = dict(zip(pattern_names(model), elastic.pattern_dof.tolist(), strict=True))
    loads = model.pattern_loads
    patterns = [load.pattern_of(model.flexible_bodies[load.body].superelement) for load in loads]
    first = len(model.frame_loads)
    return LoadPatterns(
        body=as_index([names.index(load.body) for load in loads]),
        dof=as_index([dofs[load.owner_of_pattern] for load in loads]),
        signal=as_index(range(first, first + len(loads))),
        force=as_rows([pattern.force for pattern in patterns]),
        moment=as_rows([pattern.moment for pattern in patterns]),
    )


def pattern_names(model: Model) -> list[str]:
    """All load patterns as BODY.PATTERN, in the order of their dofs."""
    return [
        f"{name}.{pattern.name}"
        for name, body in model.flexible_bodies.items()
        for pattern in body.superelement.patterns
    ]


def _lay_out_sensors(model: Model, elastic: Elastic) -> Sensors:
    rows: list[tuple[int, int, int]] = []
    places = []
    for e, body in enumerate(model.flexible_bodies.values()):
        element = body.superelement
        dof = int(elastic.dof[e]) + element.n_c + len(element.patterns)
        for sensor in element.sensors:
            for c in range(len(sensor.channels)):
                # Strains and stresses have no axis: they turn with the body as they are.
                axis = c if sensor.kind == "motion" else -1
                rows.append((int(elastic.body[e]), dof, axis))
                places.append(sensor.X)
                dof += 1
    bodies, dofs, axes = zip(*rows, strict=True) if rows else ((), (), ())
    return Sensors(
        body=as_index(bodies), dof=as_index(dofs), axis=as_index(axes), X=as_rows(places)
    )


def _lay_out_loads(model: Model, frames: NumberedFrames) -> Loads:
    loads = model.frame_loads
    by_velocity = [load.kind.by_velocity for load in loads]
    parameters = [load.parameters for load in loads]
    return Loads(
        frame=as_index([frames.number(load.on) for load in loads]),
        kind=as_index([load.kind.number for load in loads]),
        moment=as_index([load.kind.moment for load in loads]),
        by_velocity=as_index(by_velocity),
        first=starts(map(len, parameters)),
        parameters=np.array([number for numbers in parameters for number in numbers], dtype=float),
        n_by_velocity=sum(by_velocity),
    )
