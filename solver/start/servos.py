"""Motors at the start: what their integrals hold in equilibrium, and the poles of their loops."""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..lower.lower import LoweredModel
from ..step.equations import linearize
from ..step.records.laws import Motors
from ..step.system import State, System, Workspace
from .inertia import inverse_root
from .jacobian import constraint_rows, coupling_jacobian
from .matrices import dense_of

# relative to the forces in the model: as a penalty, so stiff that few rounds are left, not so stiff
# that it costs digits
HOLDING_STIFFNESS = 100.0
# error of such a motor, relative to its coordinate, or in rad
HOLDING_TOLERANCE = 1e-13


class Holding:
    """Motors whose integrals hold them at their references in equilibrium.

    There the integral is what the load takes. It is found as an augmented Lagrangian: the motor is
    a stiff spring about its reference, whose force is taken into the integral until none is left.
    """

    def __init__(
        self, system: System, lengths: NDArray[np.bool_], forces: float, moments: float
    ) -> None:
        motors = system.couplings.laws.motors
        self.motors = np.flatnonzero(motors.integral > 0.0)
        own = motors.row[self.motors]
        size = system.bodies.size
        self.stiffness = motors.stiffness[self.motors] + motors.integral[self.motors]
        # A model without moments would hold its angles by nothing.
        moments = max(moments, forces * size)
        self.stiffness += HOLDING_STIFFNESS * np.where(lengths[own], forces / size, moments)
        self.size = np.where(lengths[own], size, 1.0)
        self.rows = own

    def stiffened(self, system: System) -> System:
        """A system in which these motors are springs without limits."""
        if not len(self.motors):
            return system
        couplings = system.couplings
        laws = couplings.laws
        stiffness, bounds = laws.motors.stiffness.copy(), []
        stiffness[self.motors] = self.stiffness
        for limit, sign in ((laws.motors.lower, -1.0), (laws.motors.upper, 1.0)):
            free = limit.copy()
            free[self.motors] = sign * np.inf
            bounds.append(free)
        motors = laws.motors.replace(stiffness=stiffness, lower=bounds[0], upper=bounds[1])
        return system.replace(couplings=couplings.replace(laws=laws.replace(motors=motors)))

    def take_over(self, state: State, work: Workspace) -> bool:
        """Let the integrals take the forces of the springs; True where there was none left."""
        error = work.motors.error[self.motors]
        # The force of the spring moves over into the integral: the error is then zero at the same
        # force.
        state.motors.integral[self.motors] += self.stiffness * error
        scale = np.maximum(self.size, np.abs(work.couplings.coordinate[self.rows]))
        return bool((np.abs(error) <= HOLDING_TOLERANCE * scale).all())


def check_holding(lowered: LoweredModel, state: State) -> None:
    """ModelError for a motor that its limit keeps from holding its reference in equilibrium."""
    motors = lowered.system.couplings.laws.motors
    for m, motor in enumerate(lowered.model.motors):
        lam = float(state.couplings.lam[motors.row[m]])
        if motor.integral > 0.0 and not motors.lower[m] <= lam <= motors.upper[m]:
            limit = motors.lower[m] if lam < 0.0 else motors.upper[m]
            raise motor.error(
                f"start = 'equilibrium': it takes {lam:.6g} to hold the reference, more than the "
                f"limit, {limit:.6g}"
            )


def set_poles(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """The largest magnitude of a pole of each motor's loop, where all other motors are free.

        s^3 + (damping s^2 + stiffness s + integral) w = 0

    w: the acceleration of its coordinate by a unit torque, with bodies as rigid.
    """
    motors: Motors = lowered.system.couplings.laws.motors
    if not len(motors.row):
        return
    mobility = _mobilities(lowered.system, state, work)
    for m, w in enumerate(mobility.tolist()):
        gains = w * np.array([motors.damping[m], motors.stiffness[m], motors.integral[m]])
        roots = np.roots([1.0, *gains])
        state.motors.pole[m] = np.abs(roots).max(initial=0.0)


def _mobilities(system: System, state: State, work: Workspace) -> Array:
    """Accelerations of the coordinates of motors by their own torques (n_motors,)."""
    linearize(system, state, work)
    n = 6 * len(system.bodies.mass)
    J = coupling_jacobian(system, state, work)[:, :n] @ inverse_root(system)
    C, own = J[constraint_rows(system)], dense_of(J[system.couplings.laws.motors.row])
    if C.shape[0]:
        C = dense_of(C)
        # The part of the motor's row that constraints leave free; lstsq, for rows may be redundant.
        own = own - np.linalg.lstsq(C.T, own.T, rcond=1e-11)[0].T @ C
    mobilities: Array = np.einsum("ij,ij->i", own, own)
    return mobilities
