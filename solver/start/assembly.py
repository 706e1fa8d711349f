"""Positions and velocities made to fit the constraints, and the joint coordinates that the user
asks for at the start.

Both are least changes in the metric of the mass: with B the Jacobian of the constraints and of the
coordinates asked for, c what they miss,

    dq = -M^-1 B^T (B M^-1 B^T)^+ c          v <- v - M^-1 B^T (B M^-1 B^T)^+ (B v + c_t)

Bodies are rigid here: elastic displacements and rates start at zero, or in equilibrium
(equilibrium.py).
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, vstack

from ..arrays import Array, as_index
from ..errors import ModelError
from ..lower.lower import CompiledModel
from ..step.couplings import pull_back_pair
from ..step.equations import evaluate
from ..step.newton import linearise, set_rotation
from ..step.rotations import tangent_inverse
from ..step.rows import evaluate_row
from ..step.system import State, System, Workspace
from .independence import factorise_square, unit_rows
from .inertia import inverse_root
from .jacobian import constraint_jacobian, constraint_rows, jacobian

LARGEST_TURN = 0.2
"""rad; a joint that starts farther from its given place gets there in several steps"""


class Wish(NamedTuple):
    """A joint coordinate (the number of its observer) and what it shall be, or its rate."""

    observer: int
    value: float


def close_joints(
    compiled: CompiledModel,
    loads: Array,
    drive: Array,
    state: State,
    work: Workspace,
    wishes: list[Wish],
) -> None:
    """Move the bodies until all constraints hold."""
    starts, _ = _observe(compiled, wishes, state, work)
    wanted = np.array([wish.value for wish in wishes])
    stages = max(1, int(np.ceil(np.abs(wanted - starts).max(initial=0.0) / LARGEST_TURN)))
    every = [Wish(i, 0.0) for i in range(len(state.observed))]
    for stage in range(1, stages + 1):
        targets = starts + stage / stages * (wanted - starts)
        _close(compiled, loads, drive, state, work, wishes, targets)
        state.observed[:], _ = _observe(compiled, every, state, work)


def fit_velocities(
    compiled: CompiledModel, state: State, work: Workspace, wishes: list[Wish]
) -> float:
    """Change the velocities least until constraints and wishes hold; the largest change [m/s,
    rad/s].
    """
    system = compiled.system
    phi_t = drive_rates(compiled, work)[constraint_rows(system)]
    B = _jacobian(compiled, wishes, state, work)
    missed = B @ state.v.ravel() + np.concatenate([phi_t, [-wish.value for wish in wishes]])
    change = -_least_change(system, B, missed)
    left = missed + B @ change
    if len(left) and np.abs(left).max() > 1e-8 * max(1.0, float(np.abs(missed).max())):
        owner = _owner(compiled, int(np.argmax(np.abs(left))), wishes)
        raise ModelError(f"{owner}: no velocities of rigid motion satisfy it at the start")
    state.v[:] += change.reshape(-1, 6)
    return float(np.abs(change).max(initial=0.0))


def drive_rates(compiled: CompiledModel, work: Workspace) -> Array:
    """What the drives add to the rates of the constraints at t = 0, d phi / d s ds/dt (n_rows,)."""
    rates = np.array([*(drive.derivatives(0.0)[0] for drive in compiled.drives), 0.0])
    added: Array = work.drive_slope * rates[compiled.system.couplings.drive]
    return added


def _close(
    compiled: CompiledModel,
    loads: Array,
    drive: Array,
    state: State,
    work: Workspace,
    wishes: list[Wish],
    targets: Array,
) -> None:
    system = compiled.system
    for _ in range(30):
        missed = _missed(compiled, loads, drive, state, work, wishes, targets)
        if np.abs(missed).max(initial=0.0) < 1e-14 * _size(state, work):
            return
        change = -_least_change(system, _jacobian(compiled, wishes, state, work), missed).reshape(
            -1, 6
        )
        _move(change, state, work)
        if np.abs(change).max() < 1e-15 * _size(state, work):
            break
    left = np.abs(_missed(compiled, loads, drive, state, work, wishes, targets))
    if left.max(initial=0.0) > 1e-10 * _size(state, work):
        owner = _owner(compiled, int(np.argmax(left)), wishes)
        raise ModelError(f"{owner}: stays open by {left.max():.6g} however the bodies are placed")


def _missed(
    compiled: CompiledModel,
    loads: Array,
    drive: Array,
    state: State,
    work: Workspace,
    wishes: list[Wish],
    targets: Array,
) -> Array:
    """How far constraints and wishes are from their values; their derivatives are left in `work`."""
    evaluate(compiled.system, loads, drive, state, work)
    linearise(compiled.system, loads, drive, state, work)
    values, _ = _observe(compiled, wishes, state, work)
    return np.concatenate([work.phi[constraint_rows(compiled.system)], values - targets])


def _move(change: Array, state: State, work: Workspace) -> None:
    T = np.empty((3, 3))
    for b, step in enumerate(change):
        state.x[b] += step[:3]
        tangent_inverse(work.psi[b], T)
        work.psi[b] += T @ step[3:]
        set_rotation(b, state, work)


def _jacobian(
    compiled: CompiledModel, wishes: list[Wish], state: State, work: Workspace
) -> csr_array:
    """Derivatives of the constraints and of the wishes by (delta x, delta Theta) of all bodies."""
    system, observers = compiled.system, compiled.system.observers
    B_r, _ = constraint_jacobian(system, state, work)
    which = as_index([wish.observer for wish in wishes])
    _, gradients = _observe(compiled, wishes, state, work)
    wished = jacobian(system, observers.frame_a[which], observers.frame_b[which], gradients, state)
    return csr_array(vstack([B_r, wished[:, : B_r.shape[1]]]))


def _observe(
    compiled: CompiledModel, wishes: list[Wish], state: State, work: Workspace
) -> tuple[Array, Array]:
    """The joint coordinates that are wished for (n,) and their derivatives by those of their frames
    (n, 24).
    """
    observers, frames = compiled.system.observers, compiled.system.frames
    values, gradients, gradient = np.empty(len(wishes)), np.zeros((len(wishes), 24)), np.empty(12)
    for k, (i, _) in enumerate(wishes):
        A, B = int(observers.frame_a[i]), int(observers.frame_b[i])
        values[k] = evaluate_row(observers, i, 0.0, float(state.observed[i]), work, gradient)
        pull_back_pair(frames, A, B, gradient, state, work, gradients[k])
    return values, gradients


def _least_change(system: System, B: csr_array, missed: Array) -> Array:
    """L A^T (A A^T)^-1 c with A = B L, L L^T = M^-1, rows scaled to unit length: light bodies cost
    no digits.

    Rows that may depend on one another take the pseudo-inverse of a dense A.
    """
    if not B.shape[0]:
        return np.zeros(B.shape[1])
    L = inverse_root(system)
    A, scale = unit_rows(csr_array(B @ L))
    factors = factorise_square(A)
    if factors is None:
        y = np.linalg.lstsq(A.toarray(), scale * missed, rcond=1e-11)[0]
    else:
        y = A.T @ factors.solve(scale * missed)
    change: Array = L @ y
    return change


def _size(state: State, work: Workspace) -> float:
    return max(1.0, float(np.abs(state.x).max()), float(np.abs(work.lever).max(initial=0.0)))


def _owner(compiled: CompiledModel, row: int, wishes: list[Wish]) -> str:
    hard = constraint_rows(compiled.system)
    if row >= len(hard):
        return f"joint {compiled.observers[wishes[row - len(hard)].observer][0]!r}"
    return compiled.owner_of(int(hard[row]))
