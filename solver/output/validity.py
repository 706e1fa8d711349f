"""The validity of a run, from the extremes that its state has counted (results/validity.py)."""

import numpy as np
from numpy.typing import NDArray

from ...results.validity import CRITERIA, MEND_DEFORMATION, Check, Validity
from ...superelement import Superelement
from ..arrays import Array, Index, as_index
from ..errors import OutOfRangeError
from ..lower.lower import LoweredModel
from ..step.extremes import FARTHEST_MOVE, FARTHEST_TURN
from ..step.history import modal_energy
from ..step.rows import ANGLE
from ..step.system import State

TINY = 1e-300
SHARE = 0.01
"""of the kinetic energy of vibration, that the highest frequency which counts carries"""
STILL = 1e-6
"""kinetic energy of vibration over the energy that moves, below which a body counts as rigid"""
ROUNDING = 1e-13
"""of an energy, after many steps"""
BORNE = 0.7
"""turn of a body on joints in a step over 1 - rho_inf, from which on multipliers may grow"""
OFF_AXIS = 0.1
"""part of the lever of a joint across the spin, from which on the joint is off its axis"""
CAUSES = (
    "elastic_rotation",
    "elastic_displacement",
    "second_order_rotation",
    "second_order_displacement",
    "spin",
    "spin_turn",
    "inertia_taken",
    "joint_turn",
)
"""criteria beyond whose limits Newton's method may fail"""


class Judge:
    """The checks of a model by name, "CRITERION:OWNER", and their values in a state."""

    def __init__(self, lowered: LoweredModel) -> None:
        self._lowered = lowered
        elastic, frames = lowered.system.elastic, lowered.system.frames
        self._interfaces = np.flatnonzero(frames.dof >= 0)
        self._second = elastic.second.r > 0
        """flexible bodies with terms of second order"""
        self._stiffened = self._second & _stiffened(lowered.superelements)
        """those of them whose stress stiffens them"""
        self._curved = self._stiffened[elastic.of_body[frames.body[self._interfaces]]]
        """interfaces of such bodies"""
        self._sizes = elastic.size[elastic.of_body[frames.body[self._interfaces]]]
        self._lengths = np.ones(int(elastic.dof[-1]))
        for f, size in zip(self._interfaces, self._sizes, strict=True):
            if frames.rotations[f]:
                self._lengths[frames.dof[f] + 3 : frames.dof[f] + 6] = size**2
        for first, body in zip(
            elastic.dof.tolist(), lowered.model.flexible_bodies.values(), strict=False
        ):
            # amplitudes of patterns and readings of sensors are no motions of the body
            self._lengths[first + body.superelement.n_c : first + body.n_outer] = 0.0
        compliant = lowered.system.couplings.compliant
        owners = [lowered.coupling_of(row) for row in range(len(compliant))]
        self._owners = np.array(owners, dtype=np.int64)
        self._joints = np.unique(self._owners[compliant == 0])
        motors = lowered.system.couplings.laws.motor
        self._springs = np.unique(self._owners[(compliant == 1) & (motors < 0)])
        self._contacts = lowered.system.couplings.contact
        self._hertzian, self._patches = _hertzian(lowered)
        self._balls, self._ball_radii = _balls(lowered)
        self._hinges = _hinges(lowered)
        self._jointed = np.unique(frames.body[self._hinges])
        self._angles = np.flatnonzero(lowered.system.observers.kind == ANGLE)
        self.names = tuple(f"{name}:{owner}" for name in CRITERIA for owner in self._named(name))

    @property
    def _of_order(self) -> dict[str, NDArray[np.bool_]]:
        """Of the criteria of bodies with or without terms of second order: the owners."""
        return {
            "elastic_rotation": ~self._curved,
            "elastic_displacement": ~self._curved,
            "second_order_rotation": self._curved,
            "second_order_displacement": self._curved,
            "spin": ~self._stiffened,
            "spin_turn": self._second,
            "inertia_taken": self._second,
        }

    def values(self, state: State, taken: int) -> Array:
        """The values of all checks after so many steps, in their order."""
        measured = self._measure(state, taken)
        return np.concatenate([np.empty(0), *(measured[name] for name in CRITERIA)])

    def validity(self, state: State, taken: int) -> Validity:
        checks = zip(self.names, self.values(state, taken).tolist(), strict=True)
        return Validity(tuple(Check.of(name, value) for name, value in checks))

    def cause(self, state: State, taken: int) -> str:
        """Why Newton's method may have failed: the first warning of a body beyond the range."""
        poor = (check for check in self.validity(state, taken).checks if check.verdict == "poor")
        causes = (check.warning for check in poor if check.criterion.name in CAUSES)
        return next(causes, "")

    def _named(self, criterion: str) -> list[str]:
        """The owners of a criterion, as messages name them."""
        lowered = self._lowered
        couplings, bodies = lowered.coupling_names, [*lowered.model.flexible_bodies]
        owners: dict[str, list[str]] = {
            "interface": [lowered.frame_names[f] for f in self._interfaces],
            "body": bodies,
            "joint": [couplings[j] for j in self._joints],
            "jointed body": [lowered.body_names[b] for b in self._jointed],
            "spring": [_called(lowered, j, "spring") for j in self._springs],
            "contact": [_called(lowered, j, "contact") for j in self._contacts],
            "angle": [".".join(lowered.observers[i]) for i in self._angles],
            "motor": [motor.name for motor in lowered.model.motors if motor.is_servo],
            "model": [""],
        }
        has_modes = lowered.system.elastic.modes.range.any()
        if criterion == "numerical_dissipation" and not has_modes:
            return []
        if criterion in self._of_order:
            chosen = self._of_order[criterion]
            names = owners[CRITERIA[criterion].owner]
            return [name for name, applies in zip(names, chosen, strict=True) if applies]
        if criterion == "contact_depth":
            return [couplings[self._contacts[k]] for k in self._balls]
        if criterion == "hertz_radius":
            return [couplings[self._contacts[k]] for k in self._hertzian]
        return owners[CRITERIA[criterion].owner]

    def _measure(self, state: State, taken: int) -> dict[str, Array]:
        extremes, lowered = state.extremes, self._lowered
        elastic = lowered.system.elastic
        moved = float(extremes.moved[0])
        frequencies = self._frequencies(state, taken)
        balance = max(0.0, float(extremes.balance[0]) - self._rounding(state))
        rotation = np.sqrt(extremes.rotation[self._interfaces])
        displacement = np.sqrt(extremes.displacement[self._interfaces]) / self._sizes
        spin = np.sqrt(extremes.spin[elastic.body])
        created = np.maximum(extremes.returned - ROUNDING * extremes.stored, 0.0)[self._springs]
        return {
            "elastic_rotation": rotation[~self._curved],
            "elastic_displacement": displacement[~self._curved],
            "second_order_rotation": rotation[self._curved],
            "second_order_displacement": displacement[self._curved],
            "spin": (spin / _first(lowered.superelements))[~self._stiffened],
            "spin_turn": lowered.longest_step * spin[self._second],
            "inertia_taken": extremes.inertia_taken[self._second],
            "joint_turn": self._joint_turns(state),
            "steps_per_period": 1.0 / (lowered.longest_step * frequencies),
            "kernel_error": np.array([e.kernel.error for e in lowered.superelements])
            + lowered.responses.truncations,
            "kernel_band": frequencies / _bands(lowered.superelements),
            "energy_balance": _ratio(np.array([balance]), moved),
            "created_energy": _ratio(created, moved),
            "contact_steps": np.where(extremes.shortest > 0, extremes.shortest, np.nan),
            "contact_depth": extremes.depth[self._balls] / self._ball_radii,
            "hertz_radius": np.sqrt(extremes.depth[self._hertzian]) * self._patches,
            "numerical_dissipation": self._numerical(state, moved),
            "joint_opening": self._openings(state),
            "motor_steps": self._motor_steps(state),
            "missed_turn": extremes.missed[self._angles],
        }

    def _joint_turns(self, state: State) -> Array:
        """Turns in a step of bodies with a joint off the axis that they spin about at last."""
        lowered, frames = self._lowered, self._lowered.system.frames
        omega = state.bodies.v[frames.body[self._hinges], 3:]
        lever = frames.X[self._hinges]
        lengths = np.linalg.norm(lever, axis=1) * np.linalg.norm(omega, axis=1)
        off_axis = np.linalg.norm(np.cross(omega, lever), axis=1) > OFF_AXIS * lengths
        counts = np.isin(self._jointed, frames.body[self._hinges][off_axis])
        turns = lowered.longest_step * np.sqrt(state.extremes.spin[self._jointed]) * counts
        return _ratio(turns, BORNE * (1.0 - lowered.scheme.rho_inf))

    def _motor_steps(self, state: State) -> Array:
        """Long steps in a period of the fastest pole of each servo."""
        servos = np.array([motor.is_servo for motor in self._lowered.model.motors], dtype=bool)
        poles: Array = state.motors.pole[servos] * self._lowered.longest_step
        return np.where(poles > 0.0, 2.0 * np.pi / np.maximum(poles, TINY), np.inf)

    def _rounding(self, state: State) -> float:
        """Of the energies that the balance sums, and of the positions that they follow."""
        energies, bodies = state.energies, self._lowered.system.bodies
        weight = float(bodies.mass.sum() * np.linalg.norm(bodies.gravity))
        elastic = energies.modal[0] + energies.convolved[0]
        largest = abs(energies.potential[0]) + energies.kinetic[0] + abs(elastic)
        largest += state.extremes.stored.sum() + weight * bodies.size
        return ROUNDING * float(largest)

    def _numerical(self, state: State, moved: float) -> Array:
        elastic, energies = self._lowered.system.elastic, state.energies
        if not len(elastic.modes.stiffness):
            return np.empty(0)
        taken = energies.modal - energies.damping - modal_energy(elastic, state)
        return _ratio(np.abs(taken), moved)

    def _openings(self, state: State) -> Array:
        """The largest of the rows of each joint."""
        lowered = self._lowered
        size = np.where(lowered.measures_lengths, lowered.system.bodies.size, 1.0)
        largest = np.zeros(len(lowered.coupling_names))
        np.maximum.at(largest, self._owners, state.extremes.opening / size)
        of_joints: Array = largest[self._joints]
        return of_joints

    def _frequencies(self, state: State, taken: int) -> Array:
        """The highest frequency that carries energy in each flexible body [Hz]; nan: none does."""
        lowered, extremes = self._lowered, state.extremes
        system = lowered.system
        elastic, still = system.elastic, STILL * float(extremes.moved[0]) * taken / lowered.ratio
        frequencies = []
        for e, b in enumerate(elastic.body.tolist()):
            modes = slice(elastic.modes.range[e], elastic.modes.range[e + 1])
            dofs = slice(elastic.dof[e], elastic.dof[e + 1])
            if modes.start < modes.stop:
                rate, change = extremes.modal_rate[modes], extremes.modal_change[modes]
                scale = 0.5
            else:
                lengths = self._lengths[dofs]
                rate = extremes.interface_rate[dofs] * lengths
                change = extremes.interface_change[dofs] * lengths
                scale = 0.5 * float(system.bodies.mass[b])
            carries = scale * rate.sum() > still and change.any()  # none yet where a run starts
            highest = _highest(rate, change) / lowered.longest_step if carries else np.nan
            frequencies.append(highest)
        return np.array(frequencies, dtype=np.float64)


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
    return float(np.arcsin(min(1.0, 0.5 * np.sqrt(square))) / np.pi)


def check_range(lowered: LoweredModel, state: State, taken: int) -> None:
    """`OutOfRangeError` where an interface has left the range of linear elasticity by far."""
    if not (left := int(state.extremes.left[0])):
        return
    f, extremes = left - 1, state.extremes
    passed = _beyond(lowered, f, np.sqrt(extremes.rotation[f]), np.sqrt(extremes.displacement[f]))
    raise OutOfRangeError(
        taken, taken * lowered.h, lowered.frame_names[f], passed, lowered.model.path
    )


def torn(lowered: LoweredModel, state: State) -> str:
    """The interface that is far out of range in a state that need not be that of a step, or ""."""
    frames, u = lowered.system.frames, state.interfaces.u
    for f in np.flatnonzero(frames.dof >= 0).tolist():
        dof = int(frames.dof[f])
        rotation = np.linalg.norm(u[dof + 3 : dof + 6]) if frames.rotations[f] else 0.0
        if passed := _beyond(lowered, f, float(rotation), float(np.linalg.norm(u[dof : dof + 3]))):
            return passed
    return ""


def _beyond(lowered: LoweredModel, f: int, rotation: float, move: float) -> str:
    """How frame f has left the range at which runs end, in words; "" if it has not."""
    elastic, frames = lowered.system.elastic, lowered.system.frames
    size = float(elastic.size[elastic.of_body[frames.body[f]]])
    if rotation > FARTHEST_TURN:
        passed = f"turned by {rotation:.3g} rad by elasticity, more than {FARTHEST_TURN:.3g} rad"
    elif move > FARTHEST_MOVE * size:
        passed = (
            f"moved by {move:.3g} m by elasticity, more than the size of its body, {size:.3g} m"
        )
    else:
        return ""
    return (
        f"interface {lowered.frame_names[f]!r} has {passed}, where linear elasticity has no "
        f"meaning: {MEND_DEFORMATION}"
    )


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
    frames = np.unique([couplings.rows.frame_a[hard], couplings.rows.frame_b[hard]])
    hinges: Index = frames[body[frames] >= 0]
    return hinges


def _ratio(values: Array, scale: float) -> Array:
    return values / scale if scale > 0.0 else np.where(values > 0.0, np.inf, 0.0)


def _stiffened(elements: list[Superelement]) -> NDArray[np.bool_]:
    """Of which superelements the terms of second order know what stress does."""
    return np.array([e.rotation is not None and e.rotation.stiffens for e in elements], bool)


def _first(elements: list[Superelement]) -> Array:
    """The first elastic frequency of each free body [rad/s]; nan without modes."""
    modes = [element.modes for element in elements]
    return np.array([np.nan if m is None or not len(m.omega) else m.omega.min() for m in modes])


def _bands(elements: list[Superelement]) -> Array:
    """The frequency up to which each superelement is right [Hz]; infinite where it is exact."""
    bands = []
    for element in elements:
        h_min = 0.0 if element.modes is None else element.modes.h_min
        by_modes = 0.25 / h_min if h_min > 0.0 else np.inf
        bands.append(min(by_modes, element.kernel.band or np.inf))
    return np.array(bands)
