"""State space in real modal coordinates.

    G(s) = sum_k c_k b_k / (s - lambda_k) + D

Each complex pair a +- i b is a block [[a, -b], [b, a]]; the motions that nothing resists are one
block, which is nilpotent. b_k follow from the response to the inputs at one real frequency, by the
left eigenvectors, and D from the response there that the poles leave: so nothing is inverted.
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
from .modes import LARGEST, FirstOrder, frames_of
from .outputs import Observation, observe


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = A x + B f, y = C x + D f.

    A (n, n), B (n, n_in), C (n_out, n), D (n_out, n_in), with the names of inputs and outputs.
    `scipy.signal.StateSpace(s.A, s.B, s.C, s.D)` and `control.ss` take them.
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
                f"{channel.name}: a drive moves its joint at once: state space takes loads, "
                "frequency responses take drives"
            )
    if form.n > LARGEST:
        raise ModelError(f"{form.n} states: expected at most {LARGEST} for a state space")
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
    values = form.sigma + 1.0 / mu
    upper = np.flatnonzero(values.imag >= 0.0)
    order = upper[np.argsort(np.abs(values[upper]), kind="stable")]
    for k in order[: None if modes is None else modes].tolist():
        row, column = left[:, k].conj(), right[:, k]
        row = row / (row @ column)
        paired = bool(values[k].imag > 0.0)
        whole = (U[:, :p] @ X + U[:, p:]) @ column, row @ U[:, p:].T
        x, y = whole if paired else (whole[0].real, whole[1].real)
        value = values[k] if paired else values[k].real
        blocks.append(_Block(np.array([[value]]), x[:, None], y[None], paired))
    return blocks


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
    value = complex(block.A[0, 0])
    A = np.array([[value.real, -value.imag], [value.imag, value.real]])
    return A, np.vstack([b.real, b.imag]), 2.0 * np.hstack([c.real, -c.imag])
