"""What is observed of a linear model: any quantity of results, as `plot` names it.

The state is moved a little in every direction (positions, rates, accelerations, multipliers), each
time recorded as a step of a run would be, and the quantity of these records is differentiated. So
all quantities are those of a run. In steady rotation components turn with the mechanism.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...results.batches import Batch
from ...results.quantities import KINDS_BY_NAME, Evaluated, evaluate
from ...results.results import Results
from ...results.rotations import product, rotate
from ...results.source import Memory
from ..arrays import Array
from ..lower.allocation import make_output
from ..output.columns import requested
from ..output.recorder import NO_ENERGIES
from ..step.equations import evaluate as evaluate_step
from ..step.extremes import start_extremes
from ..step.record import record
from ..step.system import Run
from .equations import Equations
from .inputs import Channel
from .pose import Pose
from .tangent import skew

# relative to the size of the model or in rad: of fourth order, rounding and truncation are then
# about equal
COORDINATE_CHANGE = 1e-5
DIFFERENCE_POINTS = (-2.0, -1.0, 1.0, 2.0)
DIFFERENCE_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0
"""of differences of fourth order"""
# 32 MB of rows that are recorded at once
MAX_RECORDED_NUMBERS = 1 << 22


@dataclass(frozen=True, eq=False)
class Observation:
    """Derivatives of outputs by the coordinates (xi, all elastic dofs) and their derivatives.

        y = P_0 q + P_1 q' + P_2 q'' + by_rows lambda + by_inputs f

    P (3, n_out, n_r + n_u); names, units (n_out,).
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    P: Array
    by_rows: Array
    by_inputs: Array

    def at(self, s: complex, q: Any, lam: Any, inputs: Any) -> Any:
        """Amplitudes (n_out, n) at a frequency."""
        matrix = self.P[0] + s * self.P[1] + s * s * self.P[2]
        return matrix @ q + self.by_rows @ lam + self.by_inputs @ inputs


class _Direction(NamedTuple):
    """A change of the state: what moves, the entry of it, and by how much."""

    moved: Array
    entry: Any
    size: float


def observe(
    equations: Equations, quantities: Sequence[str], inputs: Sequence[Channel]
) -> Observation:
    """The derivatives of quantities; QuantityError, with its name, for one that there is not."""
    pose = equations.pose
    recorder = _Recorder(pose)
    directions = list(recorder.directions(inputs))
    parts: list[list[Array]] = []
    found: list[Evaluated] = []
    for chunk in recorder.chunks(directions):
        found = [evaluate(recorder.results(chunk), quantity) for quantity in quantities]
        parts.append([_derivatives(one.values, chunk) for one in found])
    derivatives = np.hstack([np.vstack([np.zeros((0, len(part[0].T))), *part]) for part in parts])
    n_q, n_i = recorder.n_q, len(pose.state.couplings.lam)
    P = np.stack(np.split(derivatives[:, : 3 * n_q], 3, axis=1))
    names = [name for one, q in zip(found, quantities, strict=True) for name in _names(one, q)]
    units = [one.unit for one in found for _ in _names(one, "")]
    return Observation(
        tuple(names),
        tuple(units),
        _with_turning(pose, P),
        derivatives[:, 3 * n_q : 3 * n_q + n_i],
        derivatives[:, 3 * n_q + n_i :],
    )


def _names(one: Evaluated, quantity: str) -> list[str]:
    """The quantity, or one name for each of its components."""
    if one.values.ndim == 1:
        return [quantity]
    return [f"{quantity}:{axis}" for axis in KINDS_BY_NAME[one.kind].axes]


def _derivatives(values: Array, directions: Sequence[_Direction]) -> Array:
    """By differences of the rows after the first (n_components, n_directions)."""
    # less the first row, so that what does not move has no derivative at all
    rows = (values[1:] - values[0]).reshape(len(directions), len(DIFFERENCE_POINTS), -1)
    sizes = np.array([direction.size for direction in directions])
    derivatives: Array = np.einsum("p,dpc->cd", DIFFERENCE_WEIGHTS, rows) / sizes
    return derivatives


def _with_turning(pose: Pose, P: Array) -> Array:
    """Rates and accelerations of bodies by those of xi, as in `tangent`."""
    turned = P.copy()
    for b, velocity in enumerate(pose.state.bodies.v):
        turn = skew(velocity[3:])
        linear, angular = slice(6 * b, 6 * b + 3), slice(6 * b + 3, 6 * b + 6)
        for part in (linear, angular):
            turned[0][:, part] += P[1][:, part] @ turn
        turned[0][:, linear] += P[2][:, linear] @ turn @ turn
        turned[1][:, linear] += 2.0 * P[2][:, linear] @ turn
        turned[1][:, angular] += P[2][:, angular] @ turn
    return turned


class _Recorder:
    """Records the state of a pose, moved a little, as rows of results."""

    def __init__(self, pose: Pose) -> None:
        self.pose, self.state, self.work = pose, pose.state, pose.work
        n_b, n_u = len(pose.state.bodies.x), len(pose.state.interfaces.u)
        self.n_q = 6 * n_b + n_u
        # changes of positions, rates and accelerations, in axes of the bodies
        self.rigid, self.elastic = np.zeros((3, n_b, 6)), np.zeros((3, n_u))
        scheme = pose.system.scheme.replace(beta_prime=0.0, gamma_prime=0.0)
        self.system = pose.system.replace(scheme=scheme)
        # changes of loads, drives and what motors give
        self.given = (self.work.loads.value, self.work.drives.value, self.work.motors.value)
        self.offsets = np.cumsum([0, *map(len, self.given)]).tolist()
        self.inputs = np.zeros(self.offsets[-1])
        self.width = sum(array.size for array in make_output(pose.lowered, 1).arrays())

    def directions(self, inputs: Sequence[Channel]) -> Iterator[_Direction]:
        """Positions, rates and accelerations of (xi, u), multipliers, inputs."""
        size, lengths = self.pose.system.bodies.size, self._lengths()
        for rigid, elastic in zip(self.rigid, self.elastic, strict=True):
            for b in range(len(rigid)):
                for k in range(6):
                    yield _Direction(rigid, (b, k), COORDINATE_CHANGE * (size if k < 3 else 1.0))
            for k, length in enumerate(lengths.tolist()):
                yield _Direction(elastic, k, COORDINATE_CHANGE * size / length)
        for i in range(len(self.state.couplings.lam)):
            yield _Direction(self.state.couplings.lam, i, 1.0)
        for channel in inputs:
            size = COORDINATE_CHANGE if channel.drives else 1.0
            numbers = (channel.loads, channel.drives, [3 * m for m in channel.motors])
            yield _Direction(self.inputs, _entries(numbers, self.offsets), size)

    def _lengths(self) -> Array:
        """What turns elastic dofs into lengths (n_u,); for those that nothing loads, the size."""
        elastic, size = self.pose.system.elastic, self.pose.system.bodies.size
        lengths = np.full(len(self.state.interfaces.u), max(size, 1.0))
        lengths[elastic.active] = np.maximum(elastic.length, size)
        return lengths

    def chunks(self, directions: Sequence[_Direction]) -> Iterator[Sequence[_Direction]]:
        n = max(MAX_RECORDED_NUMBERS // (len(DIFFERENCE_POINTS) * self.width), 1)
        for first in range(0, len(directions), n):
            yield directions[first : first + n]

    def results(self, directions: Sequence[_Direction]) -> Results:
        """A row for the state as it is, and one for each point of each difference."""
        lowered = self.pose.lowered
        n = 1 + len(DIFFERENCE_POINTS) * len(directions)
        run = Run(
            system=self.system, state=self.state, work=self.work, output=make_output(lowered, n)
        )
        kept = (*self.state.arrays(), *self.work.couplings.arrays())
        before_all = [array.copy() for array in kept]
        self._record(run, 0)
        for k, direction in enumerate(directions):
            before = np.copy(direction.moved[direction.entry])
            for m, point in enumerate(DIFFERENCE_POINTS):
                direction.moved[direction.entry] = before + point * direction.size
                self._record(run, 1 + len(DIFFERENCE_POINTS) * k + m)
            direction.moved[direction.entry] = before
        for array, old in zip(kept, before_all, strict=True):
            array[:] = old
        memory = Memory(requested(lowered), {"every": 1}, lowered.model.source)
        memory.append(Batch(np.zeros(n, dtype=np.int64), lowered.h, run.output, NO_ENERGIES))
        elements = {name: b.superelement for name, b in lowered.model.flexible_bodies.items()}
        return Results(memory, elements)

    def _record(self, run: Run, row: int) -> None:
        state, work = self.state, self.work
        arrays = (*state.bodies.arrays(), *state.interfaces.arrays(), *self.given)
        saved = [array.copy() for array in arrays]
        self._move()
        self.pose.settle(self.elastic[1])
        evaluate_step(self.system, state, work)
        state.interfaces.acceleration[:] = self.elastic[2]
        start_extremes(self.system, state, work)  # observed coordinates
        record(run, row)
        for array, old in zip(arrays, saved, strict=True):
            array[:] = old

    def _move(self) -> None:
        motion, interfaces = self.state.bodies, self.state.interfaces
        x, v, v_dot = self.rigid
        motion.x[:] += _in_space(motion.R, x[:, :3])
        motion.v[:] += np.hstack([_in_space(motion.R, v[:, :3]), v[:, 3:]])
        motion.v_dot[:] += np.hstack([_in_space(motion.R, v_dot[:, :3]), v_dot[:, 3:]])
        for b in np.flatnonzero(x[:, 3:].any(axis=1)).tolist():
            turned = product(motion.quaternion[b : b + 1], _quaternion(x[b, 3:]))
            motion.quaternion[b] = turned[0]
            motion.R[b] = rotate(np.repeat(turned, 3, axis=0), np.eye(3)).T
        for array, first in zip(self.given, self.offsets, strict=False):
            array[:] += self.inputs[first : first + len(array)]
        interfaces.u[:] += self.elastic[0]
        interfaces.rate[:] = self.elastic[1]


def _entries(numbers: Sequence[Sequence[int]], offsets: Sequence[int]) -> list[int]:
    return [first + k for own, first in zip(numbers, offsets, strict=False) for k in own]


def _in_space(R: Array, vectors: Array) -> Array:
    turned: Array = np.einsum("bij,bj->bi", R, vectors)
    return turned


def _quaternion(turn: Array) -> Array:
    """Of a small rotation vector, the scalar first."""
    half = 0.5 * np.linalg.norm(turn)
    return np.array([np.cos(half), *(0.5 * np.sinc(half / np.pi) * turn)])
