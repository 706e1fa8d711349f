"""Positions and velocities made to fit the constraints, and the joint coordinates that the user asks for at the start.

Both are least changes in the metric of the mass: with B the Jacobian of the constraints and of the coordinates asked
for, c what they miss,

    dq = -M^-1 B^T (B M^-1 B^T)^+ c          v <- v - M^-1 B^T (B M^-1 B^T)^+ (B v + c_t)

Bodies are rigid here: elastic displacements and rates start at zero, or in equilibrium (equilibrium.py).
"""

from typing import NamedTuple

import numpy as np

from .compilation import CompiledModel
from .compiled import Array, Index
from .couplings import pull_back_pair
from .equations import evaluate
from .errors import ModelError
from .jacobian import coupling_jacobian, jacobian
from .newton import linearise, set_rotation
from .rotations import tangent_inverse
from .rows import evaluate_row
from .system import State, System, Workspace

LARGEST_TURN = 0.2
"""rad; a joint that starts farther from its given place gets there in several steps"""


class Wish(NamedTuple):
    """A joint coordinate (the number of its observer) and what it shall be, or its rate."""

    observer: int
    value: float


def close_joints(
    compiled: CompiledModel, loads: Array, drive: Array, state: State, work: Workspace, wishes: list[Wish]
) -> None:
    """Move the bodies until all constraints hold."""
    starts = [_observed(compiled, wish.observer, state, work)[0] for wish in wishes]
    far = max((abs(wish.value - start) for wish, start in zip(wishes, starts, strict=True)), default=0.0)
    stages = max(1, int(np.ceil(far / LARGEST_TURN)))
    for stage in range(1, stages + 1):
        part = stage / stages
        targets = [start + part * (wish.value - start) for wish, start in zip(wishes, starts, strict=True)]
        _close(compiled, loads, drive, state, work, [Wish(w.observer, t) for w, t in zip(wishes, targets, strict=True)])
        for i in range(len(state.observed)):
            state.observed[i] = _observed(compiled, i, state, work)[0]


def fit_velocities(compiled: CompiledModel, state: State, work: Workspace, wishes: list[Wish]) -> float:
    """Change the velocities least until constraints and wishes hold; the largest change [m/s, rad/s]."""
    system = compiled.system
    hard = hard_rows(system)
    phi_t = drive_rates(compiled, work)[hard]
    B = _jacobian(compiled, state, work, wishes)
    missed = B @ state.v.ravel() + np.concatenate([phi_t, [-wish.value for wish in wishes]])
    change = -_least_change(system, B, missed)
    left = missed + B @ change
    if len(left) and np.abs(left).max() > 1e-8 * max(1.0, float(np.abs(missed).max())):
        owner = _owner(compiled, hard, int(np.argmax(np.abs(left))), wishes)
        raise ModelError(f"{owner}: no velocities of rigid motion satisfy it at the start")
    state.v[:] += change.reshape(-1, 6)
    return float(np.abs(change).max(initial=0.0))


def drive_rates(compiled: CompiledModel, work: Workspace) -> Array:
    """What the drives add to the rates of the constraints at t = 0, d phi / d s ds/dt (n_rows,)."""
    rates = np.array([*(drive.derivatives(0.0)[0] for drive in compiled.drives), 0.0])
    added: Array = work.drive_slope * rates[compiled.system.couplings.drive]
    return added


def inverse_inertia(system: System) -> Array:
    n_q = 6 * len(system.bodies.mass)
    inverse = np.zeros((n_q, n_q))
    for b, (mass, J_rot) in enumerate(zip(system.bodies.mass, system.bodies.J_rot, strict=True)):
        inverse[6 * b : 6 * b + 3, 6 * b : 6 * b + 3] = np.eye(3) / mass
        inverse[6 * b + 3 : 6 * b + 6, 6 * b + 3 : 6 * b + 6] = np.linalg.inv(J_rot)
    return inverse


def interface_mobility(compiled: CompiledModel) -> Array:
    """Accelerations of all active dofs under unit loads on them, at rest (n_a, n_a)."""
    elastic = compiled.system.elastic
    mobility = np.zeros((len(elastic.active), len(elastic.active)))
    for e, element in enumerate(compiled.superelements):
        rows = slice(elastic.active_range[e], elastic.active_range[e + 1])
        dofs = elastic.active[rows] - elastic.dof[e]
        mobility[rows, rows] = element.mobility[np.ix_(dofs, dofs)]
    return mobility


def _close(
    compiled: CompiledModel, loads: Array, drive: Array, state: State, work: Workspace, wishes: list[Wish]
) -> None:
    system = compiled.system
    hard = hard_rows(system)
    for _ in range(30):
        evaluate(system, loads, drive, state, work)
        linearise(system, loads, drive, state, work)
        missed_wishes = [_observed(compiled, wish.observer, state, work)[0] - wish.value for wish in wishes]
        missed = np.concatenate([work.phi[hard], missed_wishes])
        if np.abs(missed).max(initial=0.0) < 1e-14 * _size(state, work):
            return
        change = -_least_change(system, _jacobian(compiled, state, work, wishes), missed).reshape(-1, 6)
        _move(change, state, work)
        if np.abs(change).max() < 1e-15 * _size(state, work):
            break
    evaluate(system, loads, drive, state, work)
    missed_wishes = [_observed(compiled, wish.observer, state, work)[0] - wish.value for wish in wishes]
    left = np.abs(np.concatenate([work.phi[hard], missed_wishes]))
    if left.max(initial=0.0) > 1e-10 * _size(state, work):
        owner = _owner(compiled, hard, int(np.argmax(left)), wishes)
        raise ModelError(f"{owner}: stays open by {left.max():.6g} however the bodies are placed")


def _move(change: Array, state: State, work: Workspace) -> None:
    T = np.empty((3, 3))
    for b, step in enumerate(change):
        state.x[b] += step[:3]
        tangent_inverse(work.psi[b], T)
        work.psi[b] += T @ step[3:]
        set_rotation(b, state, work)


def _jacobian(compiled: CompiledModel, state: State, work: Workspace, wishes: list[Wish]) -> Array:
    n_q = 6 * len(compiled.system.bodies.mass)
    wished = [_observed(compiled, wish.observer, state, work)[1] for wish in wishes]
    B = coupling_jacobian(compiled.system, state, work).toarray()
    return np.vstack([B[hard_rows(compiled.system), :n_q], *wished])


def _observed(compiled: CompiledModel, i: int, state: State, work: Workspace) -> tuple[float, Array]:
    """The value of a joint coordinate and its derivative by (delta x, delta Theta) of all bodies."""
    observers, frames = compiled.system.observers, compiled.system.frames
    n_q = 6 * len(compiled.system.bodies.mass)
    gradient, B = np.empty(12), np.zeros((1, 24))
    value = evaluate_row(observers, i, 0.0, float(state.observed[i]), work, gradient)
    pull_back_pair(frames, int(observers.frame_a[i]), int(observers.frame_b[i]), gradient, state, work, B[0])
    own = slice(i, i + 1)
    row = jacobian(compiled.system, observers.frame_a[own], observers.frame_b[own], B, state)
    return value, row.toarray()[0, :n_q]


def _least_change(system: System, B: Array, missed: Array) -> Array:
    """M^-1 B^T (B M^-1 B^T)^+ missed, from L^-1 B with L L^T = M^-1 and scaled rows: light bodies cost no digits."""
    L = np.linalg.cholesky(inverse_inertia(system))
    length = np.linalg.norm(B @ L, axis=1)
    scale = 1.0 / np.where(length > 0.0, length, 1.0)
    least: Array = L @ np.linalg.lstsq(scale[:, None] * (B @ L), scale * missed, rcond=1e-11)[0]
    return least


def hard_rows(system: System) -> Index:
    """The rows that are constraints, not force laws."""
    return np.flatnonzero(system.couplings.compliant == 0)


def _size(state: State, work: Workspace) -> float:
    return max(1.0, float(np.abs(state.x).max()), float(np.abs(work.lever).max(initial=0.0)))


def _owner(compiled: CompiledModel, hard: Index, row: int, wishes: list[Wish]) -> str:
    if row >= len(hard):
        return f"joint {compiled.observers[wishes[row - len(hard)].observer][0]!r}"
    return compiled.owner_of(int(hard[row]))
