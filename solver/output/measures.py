"""How each criterion of validity is measured: its owners in a model, and their values in a state.

A criterion is a record of `CRITERIA` (results/validity.py), which says what it is called and what
is too much, and one of `MEASURES` here. Values come from what the time loop counts at every step,
`state.extremes` (step/extremes.py).
"""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...superelement import Superelement
from ..arrays import Array, Index, as_index, distinct
from ..lower.lower import LoweredModel
from ..step.bodies import largest_coordinate
from ..step.history import modal_energy
from ..step.rows import ANGLE, GAP
from ..step.system import State

TINY = 1e-300
SHARE = 0.01
"""of the kinetic energy of vibration, that the highest frequency which counts carries"""
STILL = 1e-6
"""kinetic energy of vibration over the energy that moves, below which a body does not vibrate"""
LASTING = 10.0
"""sum of the squares of vibration over the largest square of a change in a step, below which the
change is a blow and no vibration"""
SHORTEST = 0.5
"""periods in a run from which on a motion is a vibration"""
DENSITY = 8000.0
"""[kg/m^3] of a body whose volume is not known, as of lines: that of steel"""
ROUNDING = 1e-13
"""of an energy, after many steps"""
POSITION = 64 * np.finfo(float).eps
"""of a coordinate, relative to the largest one, and of an angle"""
BORNE = 0.7
"""turn of a body on joints in a step over 1 - rho_inf, from which on multipliers may grow"""
OFF_AXIS = 0.1
"""part of the lever of a joint across the spin, from which on the joint is off its axis"""

Mask = NDArray[np.bool_]


class Subjects:
    """What of a model is judged."""

    def __init__(self, lowered: LoweredModel) -> None:
        self.lowered = lowered
        elements = lowered.superelements
        elastic, frames = lowered.system.elastic, lowered.system.frames
        self.bodies = [*lowered.model.flexible_bodies]
        self.second: Mask = elastic.second.r > 0
        """flexible bodies with terms of second order"""
        self.stiffened = self.second & np.array([_stiffens(element) for element in elements], bool)
        """those of them whose stress stiffens them"""
        self.stressed = ~self.stiffened & np.array([_has_stress(e) for e in elements], bool)
        """bodies that are not, of which stress or strain is known"""
        self.stress_by_spin = np.array(
            [_stress_by_spin(e) for e, known in zip(elements, self.stressed, strict=True) if known]
        )
        """of these, in proportion to the square of their spin"""
        self.interfaces = np.flatnonzero(frames.dof >= 0)
        of_interfaces = elastic.of_body[frames.body[self.interfaces]]
        self.curved = self.stiffened[of_interfaces]
        """interfaces of stiffened bodies"""
        self.sizes = elastic.size[of_interfaces]
        """of the bodies of the interfaces"""
        self.lengths = self._lengths()
        couplings = lowered.system.couplings
        owners = [lowered.coupling_of(row) for row in range(len(couplings.compliant))]
        self.coupling = np.array(owners, dtype=np.int64)
        """the coupling of each row"""
        self.joints = distinct(self.coupling[couplings.compliant == 0])
        driven = couplings.laws.motor >= 0
        self.springs = distinct(self.coupling[(couplings.compliant == 1) & ~driven])
        self.contacts = couplings.contact
        self.hertzian, self.patches = _hertzian(lowered)
        self.balls, self.ball_radii = _balls(lowered)
        self.carried = self._carried()
        self.hinges = _hinges(lowered)
        self.jointed = distinct(frames.body[self.hinges])
        self.angles = np.flatnonzero(lowered.system.observers.kind == ANGLE)
        self.servos = np.array([motor.is_servo for motor in lowered.model.motors], dtype=bool)
        self.has_modes = bool(elastic.modes.range.any())

    def _lengths(self) -> Array:
        """Factors that make the rates of elastic dofs velocities of the body: 0 for no motions."""
        elastic, frames = self.lowered.system.elastic, self.lowered.system.frames
        lengths = np.ones(int(elastic.dof[-1]))
        for f, size in zip(self.interfaces, self.sizes, strict=True):
            if frames.rotations[f]:
                lengths[frames.dof[f] + 3 : frames.dof[f] + 6] = size**2
        bodies = self.lowered.model.flexible_bodies.values()
        for first, body in zip(elastic.dof.tolist(), bodies, strict=False):
            # amplitudes of patterns and readings of sensors are no motions of the body
            lengths[first + body.superelement.n_c : first + body.n_outer] = 0.0
        return lengths

    def _carried(self) -> Index:
        """The contacts whose shape an interface carries, by number."""
        rows, frames = self.lowered.system.couplings.rows, self.lowered.system.frames
        first = self.lowered.system.couplings.range[self.contacts]
        flexible = frames.dof[rows.frame_a[first]] >= 0
        return np.flatnonzero((rows.kind[first] == GAP) & flexible)

    def of_interfaces(self, mask: Mask) -> list[str]:
        return [self.lowered.frame_names[f] for f in self.interfaces[mask]]

    def of_bodies(self, mask: Mask) -> list[str]:
        return [name for name, chosen in zip(self.bodies, mask, strict=True) if chosen]

    def of_couplings(self, numbers: Index, kind: str) -> list[str]:
        """Their names, after their kind where it is another."""
        return [_called(self.lowered, j, kind) for j in numbers.tolist()]


class Reading:
    """A state, as far as several measures need the same of it.

    taken: steps since the extremes began to count, of the shortest size.
    """

    def __init__(self, subjects: Subjects, state: State, taken: int) -> None:
        self.subjects, self.lowered = subjects, subjects.lowered
        self.state, self.extremes, self.taken = state, state.extremes, taken

    @cached_property
    def rounding(self) -> float:
        """Of the energies that the balance sums, and of the positions that they follow."""
        energies, bodies = self.state.energies, self.lowered.system.bodies
        weight = float(bodies.mass.sum() * np.linalg.norm(bodies.gravity))
        elastic = energies.modal[0] + energies.convolved[0]
        largest = abs(energies.potential[0]) + energies.kinetic[0] + abs(elastic)
        largest += self.extremes.stored.sum() + weight * bodies.size
        return ROUNDING * float(largest) + _energy_at_rest(self.lowered, self.state)

    @cached_property
    def moved(self) -> float:
        """The energy that moves, rounding at least."""
        return max(float(self.extremes.moved[0]), self.rounding)

    @cached_property
    def rotation(self) -> Array:
        return np.sqrt(self.extremes.rotation[self.subjects.interfaces])

    @cached_property
    def displacement(self) -> Array:
        """Over the size of the body."""
        return np.sqrt(self.extremes.displacement[self.subjects.interfaces]) / self.subjects.sizes

    @cached_property
    def spin(self) -> Array:
        """Of the flexible bodies."""
        return np.sqrt(self.extremes.spin[self.lowered.system.elastic.body])

    @cached_property
    def frequencies(self) -> Array:
        """The highest that carries energy in the vibration of each flexible body [Hz], or nan."""
        elastic, extremes = self.lowered.system.elastic, self.extremes
        still = STILL * self.moved * self.taken / self.lowered.ratio
        frequencies = []
        for e, b in enumerate(elastic.body.tolist()):
            modes = slice(elastic.modes.range[e], elastic.modes.range[e + 1])
            dofs = slice(elastic.dof[e], elastic.dof[e + 1])
            if modes.start < modes.stop:
                rate, change = extremes.modal_rate[modes], extremes.modal_change[modes]
                scale = 0.5
            else:
                lengths = self.subjects.lengths[dofs]
                rate = extremes.interface_rate[dofs] * lengths
                change = extremes.interface_change[dofs] * lengths
                scale = 0.5 * float(self.lowered.system.bodies.mass[b])
            carries = scale * rate.sum() > still and change.any()  # none yet where a run starts
            highest = _highest(rate, change) / self.lowered.longest_step if carries else np.nan
            frequencies.append(highest)
        return np.array(frequencies, dtype=np.float64)

    @cached_property
    def frequencies_as_rigid(self) -> Array:
        """Of the motion of each body as a whole [Hz], nan where it does not vibrate."""
        motion, bodies = self.extremes.motion, self.lowered.system.bodies
        n = max(int(motion.steps[0]), 1)
        inertia = np.trace(bodies.J_rot, axis1=1, axis2=2) / 3.0
        weight = 0.5 * np.stack([bodies.mass, inertia], axis=1)
        mean = (motion.sum.reshape(-1, 2, 3) ** 2).sum(axis=2) / n
        unsteady = np.maximum(motion.square - mean, 0.0)
        # sums of squares of the velocity of a vibration, and its frequency, as in `_highest`
        known = (motion.bends > 0.0) & (motion.changes > 0.0)
        square = motion.bends / np.where(known, motion.changes, 1.0)
        vibration = motion.changes / np.where(known, square, 1.0)
        periods = _periods(square)
        counts = (
            known
            & (n * periods > SHORTEST)
            & (weight * vibration > STILL * self.moved * n)
            & (vibration > SHARE * unsteady)
            & (vibration > LASTING * motion.largest)
        )
        fastest = np.where(counts, periods, 0.0).max(axis=1)
        return np.where(fastest > 0.0, fastest / self.lowered.longest_step, np.nan)


class Measure(NamedTuple):
    """How a criterion is measured: names of its owners, and their values, one each."""

    criterion: str
    owners: Callable[[Subjects], list[str]]
    values: Callable[[Reading], Array]


def _axial_loads(reading: Reading) -> Array:
    """The largest of each body; nan where no Euler load is known."""
    axial, subjects = reading.lowered.system.elastic.axial, reading.subjects
    largest = np.full(len(subjects.bodies), -1.0)
    np.maximum.at(largest, axial.body, reading.extremes.axial)
    values: Array = np.where(largest < 0.0, np.nan, largest)[~subjects.stiffened]
    return values


def _missing_stress(reading: Reading) -> Array:
    """rho Omega^2 r^2 with the mean density and the farthest point from the center of mass.

    The largest stress of a free thin ring, and up to a factor of about two that of disks and bars.
    """
    stressed = reading.subjects.stressed
    stresses: Array = reading.subjects.stress_by_spin * reading.spin[stressed] ** 2
    return stresses


def _stress_by_spin(element: Superelement) -> float:
    """rho r^2 [Pa s^2]"""
    outline, density, radius = element.outline, DENSITY, 0.5 * element.size
    if outline is not None and len(outline.points):
        radius = float(np.linalg.norm(outline.points, axis=1).max())
        if volume := abs(outline.volume):
            density = element.mass / volume
    return density * radius**2


def _joint_turns(reading: Reading) -> Array:
    """Turns in a step of bodies with a joint off the axis that they spin about at last."""
    lowered, subjects, state = reading.lowered, reading.subjects, reading.state
    frames, hinges, jointed = lowered.system.frames, subjects.hinges, subjects.jointed
    omega = state.bodies.v[frames.body[hinges], 3:]
    lever = frames.X[hinges]
    lengths = np.linalg.norm(lever, axis=1) * np.linalg.norm(omega, axis=1)
    off_axis = np.linalg.norm(np.cross(omega, lever), axis=1) > OFF_AXIS * lengths
    counts = np.isin(jointed, frames.body[hinges][off_axis])
    turns = lowered.longest_step * np.sqrt(state.extremes.spin[jointed]) * counts
    return _ratio(turns, BORNE * (1.0 - lowered.scheme.rho_inf))


def _angular_momenta(reading: Reading) -> Array:
    """Over the largest of each free body; nan where it hardly turns."""
    momentum, bodies = reading.extremes.momentum, reading.lowered.system.bodies
    inertia = np.trace(bodies.J_rot, axis1=1, axis2=2) / 3.0
    turns = 0.5 * momentum.largest / inertia[bodies.free] > STILL * reading.moved
    largest = np.where(turns, momentum.largest, np.nan)
    errors: Array = np.sqrt(momentum.largest_defect / np.where(largest > 0.0, largest, np.nan))
    return errors


def _steps_per_period(reading: Reading) -> Array:
    """Of all bodies: of vibration, and of their motion as a whole."""
    frequencies = reading.frequencies_as_rigid.copy()
    body = reading.lowered.system.elastic.body
    frequencies[body] = np.fmax(frequencies[body], reading.frequencies)
    steps: Array = 1.0 / (reading.lowered.longest_step * frequencies)
    return steps


def _motor_steps(reading: Reading) -> Array:
    """Long steps in a period of the fastest pole of each servo."""
    poles = reading.state.motors.pole[reading.subjects.servos] * reading.lowered.longest_step
    steps: Array = np.where(poles > 0.0, 2.0 * np.pi / np.maximum(poles, TINY), np.inf)
    return steps


def _balance(reading: Reading) -> Array:
    balance = max(0.0, float(reading.extremes.balance[0]) - reading.rounding)
    return _ratio(np.array([balance]), reading.moved)


def _energy_at_rest(lowered: LoweredModel, state: State) -> float:
    """What bodies and springs at rest have by the rounding of positions, and of angles.

    Velocities are then that rounding over the step.
    """
    system = lowered.system
    bodies, rounded = system.bodies, POSITION * largest_coordinate(system.bodies, state)
    inertia = np.trace(bodies.J_rot, axis1=1, axis2=2).sum() * POSITION**2
    inertia += bodies.mass.sum() * rounded**2
    lengths = np.where(lowered.measures_lengths, rounded, POSITION)
    stiffness = np.abs(system.couplings.laws.stiffness).sum(axis=1)
    return float(inertia / system.scheme.h**2 + stiffness @ lengths**2)


def _created(reading: Reading) -> Array:
    extremes = reading.extremes
    created = np.maximum(extremes.returned - ROUNDING * extremes.stored, 0.0)
    return _ratio(created[reading.subjects.springs], reading.moved)


def _contact_arms(reading: Reading) -> Array:
    """Over the size of the body that carries the shape."""
    subjects, system = reading.subjects, reading.lowered.system
    couplings, elastic = system.couplings, system.elastic
    first = couplings.range[subjects.contacts[subjects.carried]]
    body = system.frames.body[couplings.rows.frame_a[first]]
    arms: Array = np.sqrt(reading.extremes.arm[subjects.carried])
    return arms / elastic.size[elastic.of_body[body]]


def _numerical(reading: Reading) -> Array:
    elastic, energies = reading.lowered.system.elastic, reading.state.energies
    if not reading.subjects.has_modes:
        return np.empty(0)
    taken = energies.modal - energies.damping - modal_energy(elastic, reading.state)
    return _ratio(np.abs(taken), reading.moved)


def _openings(reading: Reading) -> Array:
    """The largest of the rows of each joint."""
    lowered, subjects = reading.lowered, reading.subjects
    size = np.where(lowered.measures_lengths, lowered.system.bodies.size, 1.0)
    largest = np.zeros(len(lowered.coupling_names))
    np.maximum.at(largest, subjects.coupling, reading.extremes.opening / size)
    of_joints: Array = largest[subjects.joints]
    return of_joints


_LIST = (
    Measure(
        "elastic_rotation",
        lambda s: s.of_interfaces(~s.curved),
        lambda r: r.rotation[~r.subjects.curved],
    ),
    Measure(
        "elastic_displacement",
        lambda s: s.of_interfaces(~s.curved),
        lambda r: r.displacement[~r.subjects.curved],
    ),
    Measure(
        "second_order_rotation",
        lambda s: s.of_interfaces(s.curved),
        lambda r: r.rotation[r.subjects.curved],
    ),
    Measure(
        "second_order_displacement",
        lambda s: s.of_interfaces(s.curved),
        lambda r: r.displacement[r.subjects.curved],
    ),
    Measure("axial_load", lambda s: s.of_bodies(~s.stiffened), _axial_loads),
    Measure(
        "spin",
        lambda s: s.of_bodies(~s.stiffened),
        lambda r: (r.spin / _first(r.lowered.superelements))[~r.subjects.stiffened],
    ),
    Measure("missing_stress", lambda s: s.of_bodies(s.stressed), _missing_stress),
    Measure(
        "spin_turn",
        lambda s: s.of_bodies(s.second),
        lambda r: r.lowered.longest_step * r.spin[r.subjects.second],
    ),
    Measure(
        "inertia_taken",
        lambda s: s.of_bodies(s.second),
        lambda r: r.extremes.inertia_taken[r.subjects.second],
    ),
    Measure(
        "joint_turn", lambda s: [s.lowered.body_names[b] for b in s.jointed.tolist()], _joint_turns
    ),
    Measure(
        "angular_momentum",
        lambda s: [s.lowered.body_names[b] for b in s.lowered.system.bodies.free.tolist()],
        _angular_momenta,
    ),
    Measure("steps_per_period", lambda s: s.lowered.body_names, _steps_per_period),
    Measure(
        "kernel_error",
        lambda s: s.bodies,
        lambda r: (
            np.array([e.kernel.error for e in r.lowered.superelements])
            + r.lowered.responses.truncations
        ),
    ),
    Measure(
        "kernel_band",
        lambda s: s.bodies,
        lambda r: r.frequencies / bands_of(r.lowered.superelements),
    ),
    Measure("energy_balance", lambda s: [""], _balance),
    Measure("created_energy", lambda s: s.of_couplings(s.springs, "spring"), _created),
    Measure(
        "contact_steps",
        lambda s: s.of_couplings(s.contacts, "contact"),
        lambda r: np.where(r.extremes.shortest > 0, r.extremes.shortest, np.nan),
    ),
    Measure(
        "contact_arm",
        lambda s: s.of_couplings(s.contacts[s.carried], "contact"),
        _contact_arms,
    ),
    Measure(
        "contact_depth",
        lambda s: s.of_couplings(s.contacts[s.balls], "contact"),
        lambda r: r.extremes.depth[r.subjects.balls] / r.subjects.ball_radii,
    ),
    Measure(
        "hertz_radius",
        lambda s: s.of_couplings(s.contacts[s.hertzian], "contact"),
        lambda r: np.sqrt(r.extremes.depth[r.subjects.hertzian]) * r.subjects.patches,
    ),
    Measure("numerical_dissipation", lambda s: [""] if s.has_modes else [], _numerical),
    Measure("joint_opening", lambda s: s.of_couplings(s.joints, "joint"), _openings),
    Measure(
        "motor_steps",
        lambda s: [motor.name for motor in s.lowered.model.motors if motor.is_servo],
        _motor_steps,
    ),
    Measure(
        "missed_turn",
        lambda s: [".".join(s.lowered.observers[i]) for i in s.angles.tolist()],
        lambda r: r.extremes.missed[r.subjects.angles],
    ),
)
MEASURES = {measure.criterion: measure for measure in _LIST}
"""by the name of the criterion"""


def _highest(rate: Array, change: Array) -> float:
    """The highest frequency of motions with `SHARE` of the kinetic energy at it and above.

    In periods a step, at most 1/2. rate, change (n,): sums of squares of rates and of their changes
    in a step, whose ratio is (2 sin(omega h / 2))^2 of a vibration, and a mean of several.
    """
    moving = rate > 0.0
    square = change[moving] / rate[moving]
    order = np.argsort(square)[::-1]
    carried = np.cumsum(rate[moving][order])
    square = square[order][np.searchsorted(carried, SHARE * carried[-1])]
    return float(_periods(square))


def _periods(square: Array) -> Array:
    """omega h / 2 pi from (2 sin(omega h / 2))^2"""
    periods: Array = np.arcsin(np.minimum(1.0, 0.5 * np.sqrt(square))) / np.pi
    return periods


def _called(lowered: LoweredModel, j: int, kind: str) -> str:
    """The name of a coupling, after its kind where it is of another."""
    owner, name = lowered.model.couplings[j].owner, lowered.coupling_names[j]
    own = owner.partition(" ")[0]
    return name if own == kind else f"{own}/{name}"


def _hertzian(lowered: LoweredModel) -> tuple[Index, Array]:
    """The contacts by the law of Hertz: their numbers, and the size of the patch of each over the
    radius along it, at a penetration of 1 m.
    """
    contacts = lowered.model.contacts
    numbers = [k for k, contact in enumerate(contacts) if contact.hertz is not None]
    patches = [contacts[k].patch_over_radius for k in numbers]
    return as_index(numbers), np.array(patches, dtype=np.float64)


def _balls(lowered: LoweredModel) -> tuple[Index, Array]:
    """The contacts of balls, not of points: their numbers and radii [m]."""
    radii = [contact.ball for contact in lowered.model.contacts]
    numbers = [k for k, radius in enumerate(radii) if radius > 0.0]
    return as_index(numbers), np.array([radii[k] for k in numbers], dtype=np.float64)


def _hinges(lowered: LoweredModel) -> Index:
    """The frames of bodies that carry constraints, by number."""
    couplings, body = lowered.system.couplings, lowered.system.frames.body
    hard = couplings.compliant == 0
    frames = distinct([couplings.rows.frame_a[hard], couplings.rows.frame_b[hard]])
    hinges: Index = frames[body[frames] >= 0]
    return hinges


def _ratio(values: Array, scale: float) -> Array:
    return values / scale if scale > 0.0 else np.where(values > 0.0, np.inf, 0.0)


def _stiffens(element: Superelement) -> bool:
    """Whether its terms of second order know what stress does."""
    return element.rotation is not None and element.rotation.stiffens


def _has_stress(element: Superelement) -> bool:
    """Whether its stress or strain is known anywhere."""
    recovered = element.recovery is not None and element.recovery.stress is not None
    return recovered or any(sensor.kind != "motion" for sensor in element.sensors)


def _first(elements: list[Superelement]) -> Array:
    """The first elastic frequency of each free body [rad/s]; nan without modes."""
    modes = [element.modes for element in elements]
    return np.array([np.nan if m is None or not len(m.omega) else m.omega.min() for m in modes])


def bands_of(elements: list[Superelement]) -> Array:
    """The frequency up to which each superelement is right [Hz]; infinite where it is exact."""
    bands = []
    for element in elements:
        h_min = 0.0 if element.modes is None else element.modes.h_min
        by_modes = 0.25 / h_min if h_min > 0.0 else np.inf
        bands.append(min(by_modes, element.kernel.band or np.inf))
    return np.array(bands)
