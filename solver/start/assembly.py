"""Assembly of joints and consistent velocities, with targets for joint coordinates.

Both are least changes in the metric of the mass: with B the Jacobian of the constraints and of the
targets, c their residuals,

    dq = -M^-1 B^T (B M^-1 B^T)^+ c          v <- v - M^-1 B^T (B M^-1 B^T)^+ (B v + c_t)

Bodies are rigid here: elastic displacements and rates start at zero, or in equilibrium
(equilibrium.py).
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Index, as_index
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..step.bodies import set_rotations
from ..step.equations import evaluate, linearize
from ..step.observers import linearize_observers
from ..step.rotations import tangent_inverse
from ..step.system import State, System, Workspace
from .dependence import least_solution, owners_of_columns
from .inertia import inverse_root
from .jacobian import constraint_jacobian, constraint_rows, jacobian
from .matrices import Matrix, above, factorize_square, unit_rows

LARGEST_TURN = 0.2
"""rad; a joint that starts farther from its target is moved in several stages"""
LARGEST_CORRECTION = 0.7
"""rad by which a body turns in an iteration"""
MAX_ITERATIONS = 100
# residual, relative to positions or in rad: some roundings of coordinates
ASSEMBLY_TOLERANCE = 1e-14
DOUBLE_EPSILON = float(np.finfo(float).eps)
# accepted where no iteration improves it: redundant rows and long chains round more than a joint
ACCEPTED_OPENING = 1e-10


class Target(NamedTuple):
    """A joint coordinate, by the number of its observer, and the value of it or of its rate."""

    observer: int
    value: float


def assemble_joints(
    lowered: LoweredModel, state: State, work: Workspace, targets: list[Target]
) -> None:
    """Move the bodies until constraints and targets hold; ModelError if a joint stays open."""
    numbers, goal = _split(targets)
    start = _coordinates(lowered, state, work)[numbers]
    driven, placed = work.drives.value.copy(), lowered.drive_starts
    largest = max(np.abs(goal - start).max(initial=0.0), np.abs(driven - placed).max(initial=0.0))
    # Newton's method closes joints near where they are: a far target would reach another branch.
    stages = max(1, int(np.ceil(largest / LARGEST_TURN)))
    for stage in range(1, stages + 1):
        part = stage / stages
        work.drives.value[:] = driven if stage == stages else placed + part * (driven - placed)
        _close(lowered, state, work, targets, start + part * (goal - start))


def fit_velocities(
    lowered: LoweredModel, state: State, work: Workspace, targets: list[Target]
) -> float:
    """Change velocities least until constraints and targets hold.

    Returns the largest change [m/s, rad/s].
    """
    system = lowered.system
    phi_t = drive_rates(lowered, work)[constraint_rows(system)]
    B = _jacobian(lowered, state, work, targets)
    _, goal = _split(targets)
    rates = B @ state.bodies.v.ravel() + np.concatenate([phi_t, -goal])
    # Least in kinetic energy: as if impulses of the joints had made it.
    change = -_least_change(system, state, B, rates)
    left = rates + B @ change
    if len(left) and np.abs(left).max() > 1e-8 * max(1.0, float(np.abs(rates).max())):
        owner = _owner(lowered, int(np.argmax(np.abs(left))), targets)
        raise ModelError(
            f"{owner}: no rigid-body velocities satisfy it at the start, with all other "
            "joints, motions and starts: check axes, drives and rates"
        )
    state.bodies.v[:] += change.reshape(-1, 6)
    return float(np.abs(change).max(initial=0.0))


def drive_rates(lowered: LoweredModel, work: Workspace) -> Array:
    """The part of the drives in the rates at the start, d phi / d s ds/dt (n_rows,)."""
    added = np.zeros(len(work.couplings.phi))
    # A row of an attitude follows three drives, which add up.
    np.add.at(added, lowered.system.couplings.driven, work.drives.slope * work.drives.rate)
    return added


def _close(
    lowered: LoweredModel, state: State, work: Workspace, targets: list[Target], goal: Array
) -> None:
    system = lowered.system
    scale = _scale(lowered, state, targets)
    for _ in range(MAX_ITERATIONS):
        residuals = _residuals(lowered, state, work, targets, goal)
        if (np.abs(residuals) <= ASSEMBLY_TOLERANCE * scale).all():
            return
        change = _approach(lowered, state, work, targets, residuals)
        # A change below rounding goes on for ever without the residuals becoming smaller.
        if np.abs(change).max() < 0.1 * ASSEMBLY_TOLERANCE * _reach(system, state):
            break
    left = np.abs(_residuals(lowered, state, work, targets, goal))
    if (left > ACCEPTED_OPENING * scale).any():
        worst = int(np.argmax(left / scale))
        owner = _owner(lowered, worst, targets)
        raise ModelError(f"{owner}: stays open by {left[worst]:.6g} however the bodies are placed")


def approach_joints(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """One step of Newton's method towards closed joints; derivatives there are left in `work`."""
    residuals = _residuals(lowered, state, work, [], np.zeros(0))
    _approach(lowered, state, work, [], residuals)
    _residuals(lowered, state, work, [], np.zeros(0))


def _approach(
    lowered: LoweredModel, state: State, work: Workspace, targets: list[Target], residuals: Array
) -> Array:
    """Move the bodies by the least change that takes the residuals to zero (n_b, 6).

    By a part of it where a body would turn beyond what the derivatives tell.
    """
    B = _jacobian(lowered, state, work, targets)
    change = -_least_change(lowered.system, state, B, residuals).reshape(-1, 6)
    # Beyond this angle the linearized joint may turn the body farther away from its goal.
    change *= LARGEST_CORRECTION / max(LARGEST_CORRECTION, float(np.abs(change[:, 3:]).max()))
    move_bodies(change, state, work)
    return change


def _scale(lowered: LoweredModel, state: State, targets: list[Target]) -> Array:
    """Scale of the rounding of constraints and targets: of positions for lengths, 1 for angles."""
    system = lowered.system
    reach = _reach(system, state)
    lengths = lowered.measures_lengths[constraint_rows(system)]
    return np.concatenate([np.where(lengths, reach, 1.0), np.full(len(targets), max(reach, 1.0))])


def _residuals(
    lowered: LoweredModel, state: State, work: Workspace, targets: list[Target], goal: Array
) -> Array:
    """Residuals of constraints and targets; their derivatives are left in `work`.

    Angles go on from those of the last call, over full turns.
    """
    evaluate(lowered.system, state, work)
    linearize(lowered.system, state, work)
    follow_turns(lowered.system, work)
    numbers, _ = _split(targets)
    state.observers.value[:] = _coordinates(lowered, state, work)
    gap = state.observers.value[numbers] - goal
    return np.concatenate([work.couplings.phi[constraint_rows(lowered.system)], gap])


def follow_turns(system: System, work: Workspace) -> None:
    """Constraints on angles are near where they are; angles of force laws, where they start."""
    hard = constraint_rows(system)
    # Angles come from atan2: `near` chooses the full turn, here that of the last iteration.
    work.couplings.near[hard] = work.couplings.coordinate[hard]
    work.terms.near[:] = work.terms.coordinate


def move_bodies(change: Array, state: State, work: Workspace) -> None:
    """Displace and turn the bodies by (delta x, delta Theta) (n_b, 6)."""
    T = np.empty((3, 3))
    for b, step in enumerate(change):
        state.bodies.x[b] += step[:3]
        tangent_inverse(work.bodies.psi[b], T)
        # psi is a rotation vector from the start: a rotation of the body changes it by the tangent.
        work.bodies.psi[b] += T @ step[3:]
    set_rotations(state, work)


def _jacobian(
    lowered: LoweredModel, state: State, work: Workspace, targets: list[Target]
) -> Matrix:
    """Derivatives of constraints and targets by (delta x, delta Theta) of all bodies."""
    system, observers = lowered.system, lowered.system.observers
    B, _ = constraint_jacobian(system, state, work)
    if not targets:
        return B
    numbers, _ = _split(targets)
    linearize_observers(system, state, work)
    frames = observers.frame_a[numbers], observers.frame_b[numbers]
    by_targets = jacobian(system, *frames, work.observers.B[numbers], state)
    return above(B, by_targets[:, : B.shape[1]])


def _coordinates(lowered: LoweredModel, state: State, work: Workspace) -> Array:
    """The present coordinates of all joints (n_o,)."""
    linearize_observers(lowered.system, state, work)
    return work.observers.value.copy()


def _least_change(system: System, state: State, B: Matrix, c: Array) -> Array:
    """L A^T (A A^T)^-1 c with A = B L, L L^T = M^-1.

    Its rows are scaled to unit length, so that light bodies cost no digits. Rows that may depend on
    one another take the pseudo-inverse of A; levers are differences of positions, so that far from
    the origin such rows are told apart less sharply.
    """
    if not B.shape[0]:
        return np.zeros(B.shape[1])
    L = inverse_root(system)
    A, scale = unit_rows(B @ L)
    solve = factorize_square(A)
    if solve is None:
        rounded = DOUBLE_EPSILON * _reach(system, state) * float(scale.max() * abs(L).max())
        owners = owners_of_columns(system, A)
        # Levers that are rounded by their distance from the origin make dependent rows look
        # independent.
        y = least_solution(A, scale * c, owners, max(1e-11, 10.0 * rounded))
    else:
        y = A.T @ solve(scale * c)
    change: Array = L @ y
    return change


def _reach(system: System, state: State) -> float:
    """How far from the origin a body is, at least the size of the model [m]."""
    return max(system.bodies.size, float(np.abs(state.bodies.x).max()))


def _split(targets: list[Target]) -> tuple[Index, Array]:
    """Observers and values."""
    values = np.array([target.value for target in targets])
    return as_index([target.observer for target in targets]), values


def _owner(lowered: LoweredModel, row: int, targets: list[Target]) -> str:
    hard = constraint_rows(lowered.system)
    if row >= len(hard):
        return f"joint {lowered.observers[targets[row - len(hard)].observer][0]!r}"
    return lowered.owner_of(int(hard[row]))
