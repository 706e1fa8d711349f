"""Newton's matrix taken apart: derivatives of forces and rows by positions, rates, accelerations.

    coordinates   xi = R^T delta x, delta Theta of every body; z: the active elastic dofs; lambda
    equations     r: equilibrium of the bodies; pi: loads on z; phi: rows of couplings
                  z - bend z = H(s) pi, with H of the superelements (flexibility.py)

The matrix of a step is affine in beta' and gamma', the changes of accelerations and rates with a
coordinate. With a unit step and unit weights it gives the derivatives by rates and accelerations
one by one; with G_0 = -1 in place of the compliances, that of the loads pi. In axes that turn with
their bodies

    R^T delta v = xi_x' + omega~ xi_x              delta omega = xi_t' + omega~ xi_t
    R^T delta v' = xi_x'' + 2 omega~ xi_x' + omega~^2 xi_x
    delta omega' = xi_t'' + omega~ xi_t'

so that all coefficients of a steady rotation are constant. Source: docs/theory.md, Linear analysis.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Index
from ..start.jacobian import coupling_jacobian
from ..start.matrices import dense_of
from ..step.equations import assemble, linearize
from ..step.records.elastic import Elastic
from ..step.records.matrix import Pattern
from ..step.system import System
from .pose import Pose


@dataclass(frozen=True, eq=False)
class Sizes:
    """Numbers of unknowns: n_r rigid, n_a active elastic dofs, n_i rows."""

    n_r: int
    n_a: int
    n_i: int

    @property
    def rigid(self) -> slice:
        return slice(0, self.n_r)

    @property
    def active(self) -> slice:
        return slice(self.n_r, self.n_r + self.n_a)

    @property
    def rows(self) -> slice:
        return slice(self.n_r + self.n_a, self.n_r + self.n_a + self.n_i)

    @property
    def moving(self) -> slice:
        """Rigid and elastic coordinates."""
        return slice(0, self.n_r + self.n_a)


@dataclass(frozen=True, eq=False)
class Tangent:
    """Derivatives of [r; pi; phi] by (xi, z), their rates and accelerations, and by lambda.

    K, C, M (n_r + n_a + n_i, n_r + n_a); by_rows (n_r + n_a + n_i, n_i), zero where phi is a
    constraint; gradients (n_i, n_r + n_a): of the coordinates of rows; bend (n_a, n_a): of the
    curvatures 1/2 A(q, q).
    """

    sizes: Sizes
    K: Array
    C: Array
    M: Array
    by_rows: Array
    gradients: Array
    bend: Array


def tangent_of(pose: Pose) -> Tangent:
    """The tangent at the state of a pose."""
    system = pose.system
    sizes = Sizes(
        6 * len(system.bodies.mass), len(system.elastic.active), len(system.couplings.rows.kind)
    )
    still = _matrix(pose, _weighted(system, 0.0, 0.0, 1.0))
    gradients = _gradients(pose)
    rate = _matrix(pose, _weighted(system, 0.0, 1.0, 1.0)) - still
    inertia = _matrix(pose, _weighted(system, 1.0, 0.0, 1.0)) - still
    compatibility = _matrix(pose, _weighted(system, 0.0, 0.0, 0.0))[sizes.active]
    # in the rows of active dofs stands z - bend - pi: only pi is left
    still[sizes.active] = compatibility - still[sizes.active]
    for matrix in (rate, inertia):
        matrix[sizes.active] *= -1.0
    by_rate, by_acceleration = _turning(pose, sizes)
    moving = sizes.moving
    K, C, M = still[:, moving], rate[:, moving], inertia[:, moving]
    return Tangent(
        sizes=sizes,
        K=K + C @ by_rate + M @ by_acceleration[0],
        C=C + M @ by_acceleration[1],
        M=M,
        by_rows=still[:, sizes.rows],
        gradients=gradients,
        bend=np.eye(sizes.n_a) - compatibility[:, sizes.active],
    )


def _gradients(pose: Pose) -> Array:
    """Derivatives of the coordinates of rows by (xi, z), as `linearize` left them."""
    B = dense_of(coupling_jacobian(pose.system, pose.state, pose.work)).copy()
    for b, R in enumerate(pose.state.bodies.R):
        columns = slice(6 * b, 6 * b + 3)
        B[:, columns] = B[:, columns] @ R
    return B


def _turning(pose: Pose, sizes: Sizes) -> tuple[Array, tuple[Array, Array]]:
    """What rates take of positions, and accelerations of positions and of rates."""
    n = sizes.n_r + sizes.n_a
    by_rate, by_position, twice = np.zeros((3, n, n))
    for b, velocity in enumerate(pose.state.bodies.v):
        turn = skew(velocity[3:])
        linear, angular = slice(6 * b, 6 * b + 3), slice(6 * b + 3, 6 * b + 6)
        by_rate[linear, linear] = by_rate[angular, angular] = turn
        by_position[linear, linear] = turn @ turn
        twice[linear, linear] = 2.0 * turn
        twice[angular, angular] = turn
    return by_rate, (by_position, twice)


def _weighted(system: System, beta_prime: float, gamma_prime: float, load: float) -> System:
    """The system of a unit step with such weights, and `load` for the instantaneous compliance."""
    scheme = system.scheme.replace(
        h=1.0, beta_prime=beta_prime, gamma_prime=gamma_prime, weight=1.0
    )
    elastic = system.elastic.replace(G_active=_load_matrix(system.elastic, load))
    return system.replace(scheme=scheme, elastic=elastic)


def _load_matrix(elastic: Elastic, factor: float) -> Array:
    """`factor` times the unit matrix for every flexible body, packed as G_active is."""
    numbers = np.diff(elastic.active_range).tolist()
    matrices = [factor * np.eye(n).ravel() for n in numbers]
    return np.concatenate([np.empty(0), *matrices])


def _matrix(pose: Pose, system: System) -> Array:
    """The matrix of a step, ordered as bodies, active dofs and rows."""
    pose.evaluate(system)
    linearize(system, pose.state, pose.work)
    assemble(system, pose.state, pose.work)
    order = _order(system)
    return _dense(system.pattern, pose.work.matrix.S)[np.ix_(order, order)]


def _order(system: System) -> Index:
    """The unknowns of bodies, of active dofs and of rows among those of the pattern."""
    pattern, first = system.pattern, system.pattern.first
    bodies = [np.arange(6) + first[k] for k in pattern.body]
    flexible = pattern.body[system.elastic.body]
    active = [np.arange(first[k] + 6, first[k + 1]) for k in flexible]
    rows = [np.arange(first[k], first[k + 1]) for k in pattern.coupling if k >= 0]
    return np.concatenate([*bodies, *active, *rows]).astype(np.int64)


def _dense(pattern: Pattern, S: Array) -> Array:
    """All blocks, unknowns in the order of the nodes."""
    first = pattern.first
    matrix = np.zeros((first[-1], first[-1]))
    for k, (n, width) in enumerate(zip(pattern.size, pattern.width, strict=True)):
        later = pattern.later[pattern.later_range[k] : pattern.later_range[k + 1]]
        own = np.arange(first[k], first[k + 1])
        columns = np.concatenate([own, *(np.arange(first[i], first[i + 1]) for i in later)])
        matrix[np.ix_(own, columns)] = S[pattern.row[k] :][: n * width].reshape(n, width)
        matrix[np.ix_(columns[n:], own)] = S[pattern.lower[k] :][: n * (width - n)].reshape(-1, n)
    return matrix


def skew(a: Array) -> Array:
    """a~, for which a~ b = a x b (3, 3)."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
