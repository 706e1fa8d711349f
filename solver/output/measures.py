"""How each criterion of validity is measured: its owners in a model, and their values in a state.

A criterion is a record of `CRITERIA` (results/validity.py), which says what it is called and what
is too much, and one of `MEASURE_OF_CRITERION` here. Values come from what the time loop counts at
every step, `state.extremes` (step/extremes.py).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...superelement import Superelement
from ..arrays import Array
from ..lower.lower import LoweredModel
from ..step.bodies import largest_coordinate
from ..step.history import modal_energy
from .reading import ENERGY_ROUNDING, NEGLIGIBLE_VIBRATION, Reading
from .subjects import Subjects

# a denominator where there is none; what is divided by it is not chosen
NO_MEASURE = 1e-300
# turn of a body on joints in a step over 1 - rho_inf. Beyond, multipliers grow from step to step
# (docs/theory.md).
MAX_JOINT_TURN = 0.7
MAX_WHEEL_TURN = 0.55
"""the same of a disc that rolls and is on other joints (docs/theory.md)"""
OFF_AXIS = 0.1
"""part of the lever of a joint across the spin, from which on the joint is off its axis"""

NOISE_FACTOR, NOISE_POWER = 35.0, -1.55
"""of the rounding of positions, in the forces of joints: factor and power of 1 - rho_inf"""


class Measure(NamedTuple):
    """How a criterion is measured: names of its owners, and their values, one each."""

    criterion: str
    owners: Callable[[Subjects], list[str]]
    values: Callable[[Reading], Array]


def _axial_loads(reading: Reading) -> Array:
    """The largest axial load of each body; nan where no Euler load is known."""
    axial, subjects = reading.lowered.system.elastic.axial, reading.subjects
    largest = np.full(len(subjects.bodies), -1.0)
    # A body has several axial directions; a plain index would keep the last.
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


def _kernel_errors(reading: Reading) -> Array:
    """The errors that superelements state, with those of a memory that is cut off."""
    lowered = reading.lowered
    stated = np.array([element.kernel.error for element in lowered.superelements])
    return np.asarray(stated + lowered.responses.truncations)


def _joint_turns(reading: Reading) -> Array:
    """Turns in a step of wheels, and of bodies with a joint off the axis of their last spin."""
    lowered, subjects, state = reading.lowered, reading.subjects, reading.state
    frames, hinges, jointed = lowered.system.frames, subjects.hinges, subjects.jointed
    # The last spin stands for the run's: extremes keep magnitudes alone.
    omega = state.bodies.v[frames.body[hinges], 3:]
    lever = frames.X[hinges]
    lengths = np.linalg.norm(lever, axis=1) * np.linalg.norm(omega, axis=1)
    off_axis = np.linalg.norm(np.cross(omega, lever), axis=1) > OFF_AXIS * lengths
    wheels = np.isin(jointed, subjects.wheels)
    counts = np.isin(jointed, frames.body[hinges][off_axis]) | wheels
    turns = lowered.longest_step * np.sqrt(state.extremes.spin[jointed]) * counts
    limits = np.where(wheels, MAX_WHEEL_TURN, MAX_JOINT_TURN)
    return _ratio(turns / limits, 1.0 - lowered.scheme.rho_inf)


def _angular_momenta(reading: Reading) -> Array:
    """Errors of angular momentum over its largest value, of each free body.

    nan for a body that hardly turns.
    """
    momentum, bodies = reading.extremes.momentum, reading.lowered.system.bodies
    inertia = np.trace(bodies.J_rot, axis1=1, axis2=2) / 3.0
    turns = 0.5 * momentum.largest / inertia[bodies.free] > NEGLIGIBLE_VIBRATION * reading.moved
    largest = np.where(turns, momentum.largest, np.nan)
    # The loop keeps squares, to spare a root in every step.
    errors: Array = np.sqrt(momentum.largest_defect / np.where(largest > 0.0, largest, np.nan))
    return errors


def _steps_per_period(reading: Reading) -> Array:
    """Steps per period of each body, in its vibration or its motion as a whole."""
    frequencies = reading.frequencies_as_rigid.copy()
    body = reading.lowered.system.elastic.body
    # fmax passes over nan: a body may vibrate in one way only.
    frequencies[body] = np.fmax(frequencies[body], reading.frequencies)
    steps: Array = 1.0 / (reading.lowered.longest_step * frequencies)
    return steps


def _motor_steps(reading: Reading) -> Array:
    """Long steps in a period of the fastest pole of each servo."""
    poles = reading.state.motors.pole[reading.subjects.servos] * reading.lowered.longest_step
    steps: Array = np.where(poles > 0.0, 2.0 * np.pi / np.maximum(poles, NO_MEASURE), np.inf)
    return steps


def _balance(reading: Reading) -> Array:
    # What rounding explains is no error of the balance.
    balance = max(0.0, float(reading.extremes.balance[0]) - reading.rounding)
    return _ratio(np.array([balance]), reading.moved)


def _created(reading: Reading) -> Array:
    extremes = reading.extremes
    created = np.maximum(extremes.returned - ENERGY_ROUNDING * extremes.stored, 0.0)
    return _ratio(created[reading.subjects.springs], reading.moved)


def _contact_arms(reading: Reading) -> Array:
    """Arms of contact forces over the size of the body that carries the shape."""
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
    # Work done on the modes, less what damping took and what they have: the scheme has taken the
    # rest.
    taken = energies.modal - energies.damping - modal_energy(elastic, reading.state)
    return _ratio(np.abs(taken), reading.moved)


def _set_changes(reading: Reading) -> Array:
    if not reading.lowered.model.surface_contacts:
        return np.empty(0)
    return _ratio(np.abs(reading.state.energies.switching), reading.moved)


def _openings(reading: Reading) -> Array:
    """The largest of the rows of each joint."""
    lowered, subjects = reading.lowered, reading.subjects
    size = np.where(lowered.measures_lengths, lowered.system.bodies.size, 1.0)
    largest = np.zeros(len(lowered.coupling_names))
    np.maximum.at(largest, subjects.coupling, reading.extremes.opening / size)
    of_joints: Array = largest[subjects.joints]
    return of_joints


def _force_noise(reading: Reading) -> Array:
    """Noise in the force of each joint by rounding of positions, over the largest force.

    That is at least the energy that moves over the size of the model; where nothing moves nothing
    is rounded. Short steps count where contacts have closed. Rounding of a position asks for the
    force that moves the frames of a joint by as much in a step, from rest; the scheme amplifies the
    sum of all steps (docs/theory.md, The time step).
    """
    lowered, subjects, extremes = reading.lowered, reading.subjects, reading.extremes
    system, rows = lowered.system, lowered.system.couplings.rows
    if not len(subjects.bearing) or extremes.moved[0] <= reading.rounding:
        return np.zeros(len(subjects.bearings))
    # A depth above zero says that a contact was closed, and so steps were short.
    touched = extremes.depth.any() or reading.state.contacts.total_impulse.any()
    h = lowered.h if touched else lowered.longest_step
    of_step = system.scheme.beta / system.scheme.inertia_ratio
    compliance = _frame_compliances(lowered, of_step * h**2)
    rounding = NOISE_FACTOR * (1.0 - lowered.scheme.rho_inf) ** NOISE_POWER * of_step
    rounding *= np.finfo(float).eps * largest_coordinate(system.bodies, reading.state)
    bearing = subjects.bearing
    noise = np.zeros(len(lowered.coupling_names))
    of_rows = compliance[rows.frame_a[bearing]] + compliance[rows.frame_b[bearing]]
    np.maximum.at(noise, subjects.coupling[bearing], rounding / of_rows)
    force = extremes.force[bearing].max(initial=reading.moved / system.bodies.size)
    return _ratio(noise[subjects.bearings], force)


def _frame_compliances(lowered: LoweredModel, square: float) -> Array:
    """Displacements of all frames by unit forces on them in a step (n_f,) [m/N]; 0 on the ground.

    square: of the step, as far as an acceleration at its end moves a body [s^2].
    """
    bodies, frames, elastic = lowered.system.bodies, lowered.system.frames, lowered.system.elastic
    inertia = np.trace(bodies.J_rot, axis1=1, axis2=2) / 3.0
    lever = (frames.X**2).sum(axis=1)
    rigid = square * (1.0 / bodies.mass[frames.body] + lever / inertia[frames.body])
    compliances = np.where(frames.body >= 0, rigid, 0.0)
    for f in np.flatnonzero(frames.active >= 0).tolist():
        e = elastic.of_body[frames.body[f]]
        begin, end = elastic.active_range[e : e + 2]
        first, start = frames.active[f] - begin, elastic.G_active_start[e]
        G = elastic.G_active[start : start + (end - begin) ** 2].reshape(end - begin, -1)
        # The mean over directions: noise has none.
        compliances[f] += np.trace(G[first : first + 3, first : first + 3]) / 3.0
    return compliances


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
        lambda s: s.of_bodies(~s.tested),
        lambda r: _kernel_errors(r)[~r.subjects.tested],
    ),
    Measure(
        "test_misfit",
        lambda s: s.of_bodies(s.tested),
        lambda r: _kernel_errors(r)[r.subjects.tested],
    ),
    Measure(
        "kernel_band",
        lambda s: s.bodies,
        lambda r: r.frequencies / np.array([e.band for e in r.lowered.superelements]),
    ),
    Measure("energy_balance", lambda s: [""], _balance),
    Measure("created_energy", lambda s: s.of_couplings(s.springs, "spring"), _created),
    Measure(
        "contact_steps",
        lambda s: s.of_couplings(s.contacts, "contact"),
        lambda r: r.shortest[: len(r.subjects.contacts)] * r.subjects.rises,
    ),
    Measure(
        "surface_steps",
        lambda s: [contact.name for contact in s.lowered.model.surface_contacts],
        lambda r: r.shortest[len(r.subjects.contacts) :],
    ),
    Measure(
        "set_changes", lambda s: [""] if s.lowered.model.surface_contacts else [], _set_changes
    ),
    Measure(
        "contact_arm", lambda s: s.of_couplings(s.contacts[s.carried], "contact"), _contact_arms
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
    Measure("force_noise", lambda s: s.of_couplings(s.bearings, "joint"), _force_noise),
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
MEASURE_OF_CRITERION = {measure.criterion: measure for measure in _LIST}
"""by the name of the criterion"""


def _ratio(values: Array, scale: float) -> Array:
    return values / scale if scale > 0.0 else np.where(values > 0.0, np.inf, 0.0)


def _first(elements: list[Superelement]) -> Array:
    """The first elastic frequency of each free body [rad/s]; nan without modes."""
    modes = [element.modes for element in elements]
    return np.array([np.nan if m is None or not len(m.omega) else m.omega.min() for m in modes])
