"""State space in real modal coordinates.

    G(s) = sum_k c_k b_k / (s - lambda_k) + D

Each complex pair a +- i b is a block [[a, -b], [b, a]]; the motions that nothing resists are one
block, which is nilpotent, and so are eigenvalues that nearly coincide: those of a beam with two
equal bending stiffnesses, or of one spring of a material's chain in all fast modes. b_k follow from
the response to the inputs at one real frequency, by the left eigenvectors, and D from the response
there that the poles leave: so nothing is inverted.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from .blocks import diagonal_blocks
from .frf import observed
from .inputs import Channel, forcing
from .modes import MAX_DENSE_STATES, FirstOrder, frames_of
from .outputs import Observation, observe

# relative, of eigenvalues whose motions are one block: closer ones have ill-conditioned
# eigenvectors
BLOCK_DISTANCE = 1e-3


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = A x + B f, y = C x + D f. See `linearize` for an example.

    `scipy.signal.StateSpace(s.A, s.B, s.C, s.D)` and `control.ss` take the matrices.

    Parameters
    ----------
    A : (n, n)
    B : (n, n_in)
    C : (n_out, n)
    D : (n_out, n_in)
    inputs, outputs : tuple of str
    """

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Block:
    """An invariant subspace x = right a, a' = A a, with a = left x; paired: with its conjugate."""

    A: Any
    right: Any
    left: Any
    paired: bool


def state_space_of(
    form: FirstOrder, inputs: Sequence[Channel], quantities: Sequence[str], modes: int | None
) -> StateSpace:
    """With all modes, or the first `modes` beside the motions that nothing resists."""
    for channel in inputs:
        if channel.drives:
            raise ModelError(
                f"{channel.name}: a drive cannot be an input of a state space: use a load, "
                "or a frequency response"
            )
    if form.n > MAX_DENSE_STATES:
        raise ModelError(f"{form.n} states: expected at most {MAX_DENSE_STATES} for a state space")
    observation = observe(form.equations, quantities, inputs)
    forces = forcing(form.equations.pose, inputs)
    response = form.forced(forces)
    D = observed(form.factors, observation, forces)
    parts = []
    for block in _blocks(form, modes):
        away = form.sigma * np.eye(len(block.A)) - block.A
        b, c = away @ block.left @ response, _outputs(form, observation, block)
        D = D - (2.0 if block.paired else 1.0) * (c @ np.linalg.solve(away, b)).real
        parts.append(_real(block, b, c))
    A, B, C = ([part[k] for part in parts] for k in range(3))
    return StateSpace(
        np.asarray(diagonal_blocks(A)),
        np.vstack([np.zeros((0, len(inputs))), *B]),
        np.hstack([np.zeros((len(observation.names), 0)), *C]),
        D,
        tuple(channel.name for channel in inputs),
        observation.names,
    )


def _blocks(form: FirstOrder, modes: int | None) -> list[_Block]:
    """The motions that nothing resists, then each mode."""
    from scipy.linalg import eig, schur, solve_sylvester

    def is_zero(real: float, imaginary: float) -> bool:
        return form.is_zero(form.sigma + 1.0 / complex(real, imaginary))

    T, U, p = schur(form.matrix, sort=is_zero)
    X = solve_sylvester(T[:p, :p], -T[p:, p:], -T[:p, p:])
    blocks = []
    if p:
        A = form.sigma * np.eye(p) + np.linalg.inv(T[:p, :p])
        blocks.append(_Block(A, U[:, :p], U[:, :p].T - X @ U[:, p:].T, paired=False))
    mu, left, right = eig(T[p:, p:], left=True, right=True)
    onto, whole = U[:, p:].T, U[:, :p] @ X + U[:, p:]
    count = 0
    for near in _clusters(form.sigma + 1.0 / mu):
        if modes is not None and count >= modes:
            break
        count += len(near.members)
        columns, rows = near.basis(right), near.basis(left).conj().T
        rows = np.linalg.solve(rows @ columns, rows)
        A = form.sigma * np.eye(len(rows)) + np.linalg.inv(rows @ T[p:, p:] @ columns)
        blocks.append(_Block(A, whole @ columns, rows @ onto, near.paired))
    return blocks


@dataclass(frozen=True, eq=False)
class _Cluster:
    """Eigenvalues so close that only their subspace is certain: members, one of each pair.

    paired: the conjugates are another cluster, otherwise they are among them.
    """

    values: Any
    members: Any
    paired: bool

    def basis(self, vectors: Any) -> Any:
        """Orthonormal, of eigenvectors (n, n)."""
        own = vectors[:, self.members]
        if not self.paired:
            turning = self.values[self.members].imag > 0.0
            own = np.hstack([own.real, own[:, turning].imag])
        return np.linalg.qr(own)[0]


def _clusters(values: Any) -> list[_Cluster]:
    """In the order of their least eigenvalues."""
    from scipy.sparse.csgraph import connected_components

    size = np.abs(values)
    near = np.abs(values[:, None] - values) <= BLOCK_DISTANCE * np.minimum(size[:, None], size)
    _, label = connected_components(near, directed=False)
    below = set(label[values.imag < 0.0].tolist())
    upper = np.flatnonzero(values.imag >= 0.0)
    order = upper[np.argsort(size[upper], kind="stable")]
    found: dict[int, list[int]] = {}
    for k in order.tolist():
        found.setdefault(int(label[k]), []).append(k)
    return [
        _Cluster(values, members, bool((values[members].imag > 0.0).all()) and of not in below)
        for of, members in found.items()
    ]


def _outputs(form: FirstOrder, observation: Observation, block: _Block) -> Any:
    """C of a block (n_out, p)."""
    A = block.A
    states = form.solve(*form.split(block.right @ (A - form.sigma * np.eye(len(A)))))
    q = np.vstack([states.y[: form.equations.sizes.n_r], frames_of(form, states.y)])
    P = observation.P
    return P[0] @ q + P[1] @ q @ A + P[2] @ q @ A @ A + observation.by_rows @ states.lam


def _real(block: _Block, b: Any, c: Any) -> tuple[Array, Array, Array]:
    """A, B and C of a block in real coordinates: real and imaginary part of a."""
    if not block.paired:
        return block.A, b, c
    A = np.vstack(
        [np.hstack([block.A.real, -block.A.imag]), np.hstack([block.A.imag, block.A.real])]
    )
    return A, np.vstack([b.real, b.imag]), 2.0 * np.hstack([c.real, -c.imag])
