"""Static equilibrium, and equilibrium in steady rotation, of bodies, interfaces and multipliers together.

    f_r(x, R, u, lambda) = J v_dot + v~ J v,     phi = 0,     u = compliance p

with all velocities zero, or those of one rotation Omega about a point c: x' = Omega x (x - c), omega = R^T Omega,
x'' = Omega x (Omega x (x - c)), omega' = 0. Solved by pseudo-transient continuation: implicit steps of the gradient
flow M dq/dtau = f, which grow as the residual falls until they are Newton's. It runs down into stable equilibria.
"""

import numpy as np
from numpy.lib.stride_tricks import as_strided

from .blocks import factorise
from .compilation import CompiledModel
from .compiled import Array
from .equations import evaluate
from .errors import ModelError
from .flexibility import active_flexibility
from .model import SteadyRotation
from .newton import assemble, correct, linearise
from .rows import DISTANCE, TRANSLATION
from .system import State, System, Workspace

MAX_ITERATIONS = 400
TOLERANCE = 1e-12
"""largest residual, relative to forces and to the size of the model, that counts as equilibrium"""
GOOD_ENOUGH = 1e-9
"""the same where rounding allows no better"""
FIRST_STEP = 0.05
"""how far the first step moves bodies, relative to the size of the model"""


def settle(
    compiled: CompiledModel, loads: Array, drive: Array, rotation: SteadyRotation | None, state: State, work: Workspace
) -> None:
    """Bring a state into equilibrium: positions, displacements, multipliers, and the motion of a steady rotation."""
    system = _at_rest(compiled)
    work.history[:] = 0.0
    work.u_rate_predicted[:] = 0.0
    _rotate_steadily(rotation, state)
    evaluate(system, loads, drive, state, work)
    pull = _accelerations(system, work)
    beta = pull / (FIRST_STEP * _size(state, work)) if pull > 0.0 else 1.0
    residual, best, idle = _residual(system, state, work), np.inf, 0
    for _ in range(MAX_ITERATIONS):
        if residual <= TOLERANCE or (idle > 5 and best <= GOOD_ENOUGH):
            return
        saved = [array.copy() for array in state]
        _step(_stiffened(system, beta), loads, drive, rotation, state, work)
        _rotate_steadily(rotation, state)
        evaluate(system, loads, drive, state, work)
        previous, residual = residual, _residual(system, state, work)
        if not residual < 4.0 * max(previous, 1e-3):
            for array, old in zip(state, saved, strict=True):
                array[:] = old
            evaluate(system, loads, drive, state, work)
            residual, beta = previous, 10.0 * beta
            continue
        beta *= np.clip(residual / previous, 0.1, 2.0)
        idle = 0 if residual < 0.5 * best else idle + 1
        best = min(best, residual)
    raise ModelError(f"no equilibrium found at the start: relative residual {best:.3e} after {MAX_ITERATIONS} steps")


def _step(
    system: System, loads: Array, drive: Array, rotation: SteadyRotation | None, state: State, work: Workspace
) -> None:
    linearise(system, loads, drive, state, work)
    assemble(system, state, work)
    if rotation is not None:
        _add_centrifugal(system, rotation, state, work)
    if not factorise(system.pattern, work.S, work.pivots):
        raise ModelError("no equilibrium found at the start: the mechanism is singular there")
    correct(system, state, work)
    work.quaternion[:] = state.quaternion
    work.psi[:] = 0.0


def _at_rest(compiled: CompiledModel) -> System:
    """The system with static compliances in place of instantaneous ones."""
    elastic = compiled.system.elastic
    G_0 = elastic.G_0.copy()
    for e, compliance in enumerate(compiled.compliances):
        start = elastic.G_0_start[e]
        G_0[start : start + compliance.size] = compliance.ravel()
    G_active, _ = active_flexibility(compiled.compliances, elastic.active, elastic.active_range, elastic.dof, 1.0)
    scheme = compiled.system.scheme._replace(weight=1.0, gamma_prime=0.0)
    return compiled.system._replace(scheme=scheme, elastic=elastic._replace(G_0=G_0, G_active=G_active))


def _stiffened(system: System, beta: float) -> System:
    """With the inertia of an implicit step of the gradient flow: beta J on dq."""
    return system._replace(scheme=system.scheme._replace(beta_prime=beta, h=0.01))


def _rotate_steadily(rotation: SteadyRotation | None, state: State) -> None:
    state.v[:] = 0.0
    state.v_dot[:] = 0.0
    if rotation is not None:
        Omega = rotation.angular_velocity
        state.v[:, :3] = np.cross(Omega, state.x - rotation.center)
        state.v[:, 3:] = np.einsum("bji,j->bi", state.R, Omega)
        state.v_dot[:, :3] = np.cross(Omega, state.v[:, :3])


def _add_centrifugal(system: System, rotation: SteadyRotation, state: State, work: Workspace) -> None:
    """h^2 d(J v_dot + v~ J v) where x'' = Omega~ Omega~ (x - c) and omega = R^T Omega follow the increments."""
    h2 = system.scheme.h**2
    spin = _skew(rotation.angular_velocity)
    for b, (mass, J) in enumerate(zip(system.bodies.mass, system.bodies.J_rot, strict=True)):
        omega, R = state.v[b, 3:], state.R[b]
        start, stride = system.pattern.body_block[b]
        block = as_strided(work.S[start:], (6, 6), (stride * work.S.itemsize, work.S.itemsize))
        block[:3, :3] += h2 * mass * R.T @ spin @ spin @ R
        block[3:, 3:] += h2 * (_skew(omega) @ J - _skew(J @ omega)) @ _skew(omega)


def _residual(system: System, state: State, work: Workspace) -> float:
    """Largest residual relative to the forces and moments in the system, and to its size."""
    forces, size = max(float(work.force_scale[:, 0].max()), 1e-300), _size(state, work)
    moments = max(float(work.force_scale[:, 1].max()), forces * 1e-3 * size)
    # a spring that carries nothing knows its length to rounding alone: laws count against all forces
    lengths = np.isin(system.couplings.rows.kind, (TRANSLATION, DISTANCE))
    laws = np.maximum(work.law_scale, np.where(lengths, forces, moments))
    phi = work.phi / np.where(system.couplings.compliant == 1, laws, size)
    parts = (
        work.residual[:, :3] / forces,
        work.residual[:, 3:] / moments,
        phi,
        work.u_residual / size,
    )
    return max(float(np.abs(part).max(initial=0.0)) for part in parts)


def _accelerations(system: System, work: Workspace) -> float:
    inertia = np.trace(system.bodies.J_rot, axis1=1, axis2=2)
    linear = np.abs(work.residual[:, :3]).max(axis=1) / system.bodies.mass
    return float(max(linear.max(), (np.abs(work.residual[:, 3:]).max(axis=1) / inertia).max() * 1e-3))


def _size(state: State, work: Workspace) -> float:
    return float(max(np.ptp(state.x, axis=0).max(), np.abs(work.lever).max(initial=0.0), 1e-3))


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
