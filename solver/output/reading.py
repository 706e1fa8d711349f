"""A state of a run, as far as several measures of validity need the same of it."""

from functools import cached_property

import numpy as np

from ..arrays import Array
from ..lower.lower import LoweredModel
from ..step.bodies import largest_coordinate
from ..step.system import State
from .subjects import Subjects

# of the kinetic energy of vibration: the highest frequency that carries it counts
ENERGY_SHARE = 0.01
# kinetic energy of vibration over the energy that moves: below, a body does not vibrate
NEGLIGIBLE_VIBRATION = 1e-6
# sum of the squares of vibration over the largest square of a change in a step: below, the change
# is a blow and no vibration
MIN_LASTING_SQUARES = 10.0
# periods in a run from which on a motion is a vibration
MIN_PERIODS = 0.5
# of an energy, after many steps
ENERGY_ROUNDING = 1e-13
# of a coordinate, relative to the largest one, and of an angle: a few roundings of each step
POSITION_ROUNDING = 64 * np.finfo(float).eps


class Reading:
    """A state, as far as several measures need the same of it.

    taken: steps since the extremes began to count, of the shortest size.
    """

    def __init__(self, subjects: Subjects, state: State, taken: int) -> None:
        self.subjects, self.lowered = subjects, subjects.lowered
        self.state, self.extremes, self.taken = state, state.extremes, taken

    @cached_property
    def rounding(self) -> float:
        """Rounding of the energies in the balance, and of the positions that they depend on [J]."""
        energies, bodies = self.state.energies, self.lowered.system.bodies
        # Heights count from the origin: energies are rounded relative to weight times size at
        # least.
        weight = float(bodies.mass.sum() * np.linalg.norm(bodies.gravity))
        elastic = energies.modal[0] + energies.convolved[0]
        largest = abs(energies.potential[0]) + energies.kinetic[0] + abs(elastic)
        largest += self.extremes.stored.sum() + weight * bodies.size
        return ENERGY_ROUNDING * float(largest) + _energy_at_rest(self.lowered, self.state)

    @cached_property
    def moved(self) -> float:
        """The energy that moves, rounding at least."""
        return max(float(self.extremes.moved[0]), self.rounding)

    @cached_property
    def rotation(self) -> Array:
        return np.sqrt(self.extremes.rotation[self.subjects.interfaces])

    @cached_property
    def displacement(self) -> Array:
        """Elastic displacements over the size of the body."""
        return np.sqrt(self.extremes.displacement[self.subjects.interfaces]) / self.subjects.sizes

    @cached_property
    def shortest(self) -> Array:
        """Steps of the shortest event of each contact; nan if it had none."""
        shortest: Array = np.where(self.extremes.shortest > 0, self.extremes.shortest, np.nan)
        return shortest

    @cached_property
    def spin(self) -> Array:
        """The largest spins of flexible bodies [rad/s]."""
        return np.sqrt(self.extremes.spin[self.lowered.system.elastic.body])

    @cached_property
    def frequencies(self) -> Array:
        """The highest frequency that carries energy in each flexible body [Hz]; nan if none."""
        elastic, extremes = self.lowered.system.elastic, self.extremes
        still = NEGLIGIBLE_VIBRATION * self.moved * self.taken / self.lowered.ratio
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
        """Frequencies of the motion of each body as a whole [Hz]; nan without vibration."""
        motion, bodies = self.extremes.motion, self.lowered.system.bodies
        n = max(int(motion.steps[0]), 1)
        inertia = np.trace(bodies.J_rot, axis1=1, axis2=2) / 3.0
        weight = 0.5 * np.stack([bodies.mass, inertia], axis=1)
        # Sum of squares less square of the sum: the variance, without a steady motion.
        mean = (motion.sum.reshape(-1, 2, 3) ** 2).sum(axis=2) / n
        unsteady = np.maximum(motion.square - mean, 0.0)
        # sums of squares of the velocity of a vibration, and its frequency, as in `_highest`
        known = (motion.bends > 0.0) & (motion.changes > 0.0)
        # Second over first differences: (2 sin(omega h / 2))^2, as rates over positions in
        # `_highest`.
        square = motion.bends / np.where(known, motion.changes, 1.0)
        vibration = motion.changes / np.where(known, square, 1.0)
        periods = _periods(square)
        counts = (
            known
            & (n * periods > MIN_PERIODS)
            & (weight * vibration > NEGLIGIBLE_VIBRATION * self.moved * n)
            & (vibration > ENERGY_SHARE * unsteady)
            & (vibration > MIN_LASTING_SQUARES * motion.largest)
        )
        fastest = np.where(counts, periods, 0.0).max(axis=1)
        return np.where(fastest > 0.0, fastest / self.lowered.longest_step, np.nan)


def _energy_at_rest(lowered: LoweredModel, state: State) -> float:
    """The energy of bodies and springs at rest by rounding of positions and angles.

    Velocities are then that rounding over the step.
    """
    system = lowered.system
    bodies, rounded = system.bodies, POSITION_ROUNDING * largest_coordinate(system.bodies, state)
    inertia = np.trace(bodies.J_rot, axis1=1, axis2=2).sum() * POSITION_ROUNDING**2
    inertia += bodies.mass.sum() * rounded**2
    lengths = np.where(lowered.measures_lengths, rounded, POSITION_ROUNDING)
    stiffness = np.abs(system.couplings.laws.stiffness).sum(axis=1)
    return float(inertia / system.scheme.h**2 + stiffness @ lengths**2)


def _highest(rate: Array, change: Array) -> float:
    """The highest frequency of motions with `ENERGY_SHARE` of the kinetic energy at it and above.

    In periods a step, at most 1/2. rate, change (n,): sums of squares of rates and of their changes
    in a step, whose ratio is (2 sin(omega h / 2))^2 of a vibration, and a mean of several.
    """
    moving = rate > 0.0
    square = change[moving] / rate[moving]
    # From the highest down, until their sum is the share that counts.
    order = np.argsort(square)[::-1]
    carried = np.cumsum(rate[moving][order])
    square = square[order][np.searchsorted(carried, ENERGY_SHARE * carried[-1])]
    return float(_periods(square))


def _periods(square: Array) -> Array:
    """omega h / 2 pi from (2 sin(omega h / 2))^2"""
    periods: Array = np.arcsin(np.minimum(1.0, 0.5 * np.sqrt(square))) / np.pi
    return periods
