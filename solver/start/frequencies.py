"""Natural frequencies of an assembled model about its start.

With y the motions of bodies over the root of their inertia, and eta the modes of flexible bodies,

    K (y, eta) = omega^2 (y, eta)   on   C (y, eta) = 0,     K = diag(0, omega_j^2) + D^T S D

C: the derivatives of constraints, D: those of springs and servos with stiffness S. Without the
stiffness that forces, gravity and spin give.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...files.kept_warnings import kept_warnings
from ..arrays import Array
from ..laws.law import LAW_KINDS
from ..lower.lower import LoweredModel
from ..step.equations import linearize
from ..step.system import State, System, Workspace
from .inertia import inverse_root
from .initial import InitialState, initialize, modes_of
from .jacobian import constraint_rows, coupling_jacobian
from .matrices import dense_of

# The dense eigenvalue problem takes seconds there, and grows with the cube.
MAX_FREQUENCY_UNKNOWNS = 2000
# times the rounding of eigenvalues: those below are motions without stiffness
EIGENVALUE_NOISE = 100.0


@dataclass(frozen=True, eq=False)
class Vibrations:
    """Undamped vibrations about the initial state, with static stiffness.

    omega (r,) [rad/s], ascending; shapes (n, r): of y and the m modes eta, orthonormal; B (n_rows,
    n): the derivatives of all rows. Motions that nothing resists are left out.
    """

    omega: Array
    shapes: Array
    B: Array
    m: int

    @property
    def frequencies(self) -> Array:
        """In Hz."""
        return self.omega / (2.0 * np.pi)


def unknowns_of(system: System) -> int | None:
    """The number of y and eta; None where a body has no modes."""
    modes = system.elastic.modes
    if not np.diff(modes.range).all():
        return None
    return 6 * len(system.bodies.mass) + len(modes.stiffness)


def without_surfaces(initial: InitialState) -> InitialState:
    """The start of the same model with all contacts of surfaces open.

    Those divide each mode into a part that moves and one that follows its load, which are no
    vibrations of their own. About the given places, for nothing else may hold what rests on them.
    """
    model = initial.lowered.model
    if not model.surface_contacts:
        return initial
    if model.settings.start == "equilibrium":
        model = model.with_settings(start="given", steady_rotation=None)
    # Nothing steps here: modes that end below the band of a step are right as they are.
    with kept_warnings():
        return initialize(model.without_surfaces())


def vibrations(initial: InitialState, largest: int = MAX_FREQUENCY_UNKNOWNS) -> Vibrations | None:
    """The undamped vibrations of a model about its initial state.

    None for bodies without modes, and for models of more than `largest` unknowns.
    """
    lowered, system = initial.lowered, initial.lowered.system
    stiffness, n = system.elastic.modes.stiffness, unknowns_of(system)
    if n is None or n > largest:
        return None
    B = _jacobian(lowered, initial.state, initial.work)
    K = np.diag(np.concatenate([np.zeros(n - len(stiffness)), stiffness]))
    # In y a mass of 1 for every unknown: K alone is left of the eigenvalue problem.
    K += B.T @ spring_slopes(system, initial.state, initial.work) @ B
    free = null_space(B[constraint_rows(system)])
    values, vectors = np.linalg.eigh(free.T @ K @ free)
    # Eigenvalues are rounded relative to the largest of them.
    rounding = EIGENVALUE_NOISE * n * np.finfo(float).eps * np.abs(values).max(initial=0.0)
    resisted = values > rounding
    return Vibrations(np.sqrt(values[resisted]), free @ vectors[:, resisted], B, len(stiffness))


def _jacobian(lowered: LoweredModel, state: State, work: Workspace) -> Array:
    """Derivatives of all rows by y and eta (n_rows, 6 n_b + m)."""
    system, elastic = lowered.system, lowered.system.elastic
    linearize(system, state, work)
    B, n_q = dense_of(coupling_jacobian(system, state, work)), 6 * len(system.bodies.mass)
    phi = np.zeros((len(elastic.active), len(elastic.modes.stiffness)))
    for e in range(len(elastic.body)):
        rows = slice(elastic.active_range[e], elastic.active_range[e + 1])
        columns = slice(elastic.modes.range[e], elastic.modes.range[e + 1])
        phi[rows, columns] = modes_of(lowered, e)[elastic.active[rows] - elastic.dof[e]]
    return np.hstack([B[:, :n_q] @ dense_of(inverse_root(system)), B[:, n_q:] @ phi])


def spring_slopes(system: System, state: State, work: Workspace, rates: bool = False) -> Array:
    """S (n_rows, n_rows) of linear springs, servos and the slopes of force laws; 0 for constraints.

    By deformations, or by their rates. Laws that relax have done so, and those that hysteresis
    bends have the slope of a reversal.
    """
    laws, first = system.couplings.laws, system.couplings.range
    S = np.zeros((len(laws.rest), len(laws.rest)))
    linear = laws.damping if rates else laws.stiffness
    for j in range(len(first) - 1):
        rows = slice(first[j], first[j + 1])
        S[rows, rows] = linear[rows, : first[j + 1] - first[j]]
    deformation = work.couplings.coordinate - laws.rest
    for m, i in enumerate(np.repeat(np.arange(len(laws.rest)), np.diff(laws.range)).tolist()):
        parameters = laws.parameters[laws.first[m] : laws.first[m + 1]]
        memory = state.couplings.memory[laws.memory[m] : laws.memory[m + 1]]
        law = LAW_KINDS[laws.number[m]]
        # An infinite step: what relaxes has relaxed.
        slopes = law.evaluate(parameters, memory, math.inf, float(deformation[i]), 0.0)
        S[i, i] += slopes[2 if rates else 1]
    motors = laws.motors
    S[motors.row, motors.row] += motors.damping if rates else motors.stiffness
    return S


def null_space(C: Array) -> Array:
    """An orthonormal basis (n, n - rows) of what independent rows leave free."""
    length = np.linalg.norm(C, axis=1)
    Q, _ = np.linalg.qr((C / np.where(length > 0.0, length, 1.0)[:, None]).T, mode="complete")
    return Q[:, len(C) :]
