"""Impulse responses from the block Krylov space of the time step's own matrix."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from ...files.memory import available, scratch
from ...superelement import GeneralizedAlpha, Modes
from ...superelement.validation import Array
from ..assembly.structure import RIGID, Structure
from ..body.damping import Damping, Rayleigh
from ..errors import MethodError
from ..solving.cost import BLOCKS, REAL, WORK
from ..solving.factor import Factor
from ..solving.gradients import NotConvergedError
from ..solving.solver import Solver, factorized
from .band import LEAST_DAMPING, Band
from .basis import Basis
from .condensation import condensed
from .damping import damped_modes
from .lowest import first_square
from .ritz import ritz_modes, space_shapes
from .shapes import Shapes
from .static import slow_chain

FEWEST = 2
"""Blocks before the first estimate of the error."""
LIMIT = 4000
"""Vectors at most: beyond, the dense eigenproblems of the space take minutes and its basis
gigabytes.
"""
GROWTH = 0.1
"""The error is estimated at the latest when the space has grown by this share of itself."""
SAFETY = 2.0
"""What the last block has changed counts so many times: alone, it is down to 0.6 of the error at
times.
"""
LOW = 0.1
"""The shift of all blocks but the first, over the square of the first frequency, about."""
RISE = 100.0
"""Of the low shift, where solutions do not converge with it."""
NEAR = 4.0
"""A step whose shift is within this factor of the low one, squared, serves for both."""
STALLED = 0.3
"""An error that has not fallen to so much of the least before is no longer falling."""
LOWEST = 6
"""Modes, the lowest, whose frequencies rounding disturbs most."""
SMALL_ERROR = 1e-3
"""No larger error is put down to rounding."""
CONDENSED = 0.1
"""Share of the tolerance that may be spent on condensing the modes above the band."""
UNSOLVED = 0.1
"""Share that may be spent on solutions without a factor."""
AMPLIFIED = 1e3
"""What the square of the error of solutions, in energy, is in the transfer function: five hundred
times as much was seen.
"""
FINEST = 1e-11
"""The accuracy that solutions can reach, whatever is asked for."""
OF_FIELDS = 0.1
"""Part of it where fields count: stresses at a point err by some times the error in energy."""
Watch = Callable[[str], None]
Mask = NDArray[np.bool_]
RitzModes = Callable[[int], tuple[Modes, Array]]
"""modes of the first blocks of a space, and their coordinates in it"""


class KrylovSpace:
    """V = span{P S^-1 F, P S^-1 M P S^-1 F, ...} with S = K + s M and F = P^T P_C^T, orthonormal in
    M.

    k blocks hold what k steps of the march with S visit, if s is the shift of a time step, so that
    the first k lags of the kernel that its modes make are exact (of g_initial too, unless damping
    in proportion to K meets rho_inf < 1: the scheme then keeps a trace of the accelerations at t_0,
    which no block holds). The rigid modes head the basis, so that nothing else in it contains them.
    Source: docs/theory.md, Large meshes.

    Every block sees waves travel for one step, so low frequencies take many where steps are far
    finer than they need. With a second, `lower` shift the first block is as before, which makes
    g[0] exact, and all others are made with the matrix of that shift: a rational Krylov space.
    Source: A. Ruhe, Linear Algebra Appl. 58 (1984) 391-405.

    solver: makes of a shift what solves with the matrix of that shift, to an accuracy relative in
    energy. `MemoryShortageError` if that does not fit into the memory together with the basis that
    is to be expected.
    """

    def __init__(
        self,
        structure: Structure,
        shift: float,
        lower: float | None = None,
        solver: Solver = factorized,
        accuracy: float = 0.0,
    ) -> None:
        self.structure, n_u = structure, structure.n_u
        self._solver, self._accuracy, self._highest = solver, accuracy, shift
        expected = BLOCKS if lower is None else 1
        self._solve = solver(structure, shift, "the matrix of the time step", accuracy, expected)
        self._first = self._solve(structure.loads)
        self.inexact = not isinstance(self._solve, Factor)
        self._lower = lower
        if lower is not None:
            self._solve_with(lower)
        memory, disk = (self._vectors(place) for place in (available, scratch))
        n_c = structure.P_C.shape[0]
        in_file = memory < RIGID + (BLOCKS + WORK) * n_c and disk > memory
        self._most = min(LIMIT, disk if in_file else memory)
        if self._most < RIGID + FEWEST * n_c:
            raise MethodError(
                f"impulse.method krylov: {FEWEST} blocks of {n_c} vectors, the fewest, take more "
                f"than the {self._most} vectors that there is time and memory for: fewer interface "
                "dofs, loads and sensors would do, or method march"
            )
        self.basis = Basis(structure, min(n_u, self._most), in_file)
        self.basis.extend(structure.U)
        self._ends = [RIGID]
        self._stiffness = np.zeros((0, 0))

    @property
    def blocks(self) -> int:
        return len(self._ends) - 1

    @property
    def dimension(self) -> int:
        return self.basis.columns - RIGID

    @property
    def room(self) -> int:
        """The number of vectors that time, and memory or disk, allow, the basis included."""
        free = self._vectors(scratch if self.basis.in_file else available)
        n_c: int = self.structure.P_C.shape[0]
        return min(self._most, self.basis.columns + free - WORK * n_c)

    def _vectors(self, place: Callable[[], int]) -> int:
        """The number of vectors that the bytes of a place hold, in all processes."""
        vectors = place() // (REAL * self.structure.n_here)
        return -int(self.structure.processes.largest(-vectors))

    def grow(self) -> bool:
        """Add a block; False if nothing is left to add, for the space holds all that interface
        loads excite.
        """
        # S^-1 M is symmetric in M: what it makes of a block has parts along that block and its two
        # neighbors alone, those with another S aside.
        near = self._ends[max(0, self.blocks - 2)]
        if not self.blocks:
            W = self._first
        else:
            shift = self._lower
            W = self._next(self.structure.M @ self.basis.V[:, self._ends[-2] :])
            if self._lower != shift:
                near = 0
        if not self.basis.extend(W, near=near):
            return False
        self._ends.append(self.basis.columns)
        return True

    def _solve_with(self, lower: float) -> None:
        """Solve with the matrix of a low shift from now on."""
        del self._solve  # two might not fit
        self._lower = lower
        name = "the matrix of a low shift"
        self._solve = self._solver(self.structure, lower, name, self._accuracy, BLOCKS)
        self.inexact |= not isinstance(self._solve, Factor)

    def _next(self, B: Array) -> Array:
        """S^-1 B, with a higher shift from here on where the low one asks too much of gradients."""
        while True:
            try:
                return self._solve(B)
            except NotConvergedError:
                if self._lower is None or RISE * self._lower > self._highest:
                    raise
                self._solve_with(RISE * self._lower)

    def add(self, W: Array) -> None:
        """Add displacements W (n_u, k) as a block that no other grows from."""
        self.basis.extend(W)
        self._ends.append(self.basis.columns)

    def ritz(self, blocks: int) -> tuple[Array, Array]:
        """omega (m,) [rad/s] and Q (r, m) of the first blocks, as `ritz_modes` has them."""
        self._reduce_stiffness()
        size = self._ends[blocks] - RIGID
        V = self.basis.V[:, RIGID : RIGID + size]
        return ritz_modes(self.structure, V, self._stiffness[:size, :size])

    def frequency_changes(self, omega: Array, Q: Array) -> Array:
        """The relative changes (m,) of the frequencies omega of all blocks by the last one.

            q^T (V^T K V - omega^2) q / (2 omega^2)

        of the part q of a mode in that block: Ritz values are stationary.
        """
        self._reduce_stiffness()
        start = self._ends[-2] - RIGID
        K, q = self._stiffness[start:, start:], Q[start:]
        K = np.triu(K) + np.triu(K, 1).T
        energy = np.einsum("ik,ik->k", q, K @ q) / omega**2
        changes: Array = np.abs(0.5 * (energy - np.einsum("ik,ik->k", q, q)))
        return changes

    def with_rotation(self, modes: Modes, Q: Array) -> Modes:
        """The same modes, which loads of rotation excite beside those on interfaces: phi (n_c + 6,
        m).
        """
        rows = sp.csr_array(self.structure.inertia_loads.T)
        inertia = space_shapes(self.basis, Q)(rows)
        return replace(modes, phi=np.vstack([modes.phi, inertia]))

    def _reduce_stiffness(self) -> None:
        """Extend V^T K V, the upper half, by the new columns: many are as quick as a few."""
        done = len(self._stiffness)
        if done < self.dimension:
            V = self.basis.V[:, RIGID:]
            new = self.structure.total(V.T @ (self.structure.K @ V[:, done:]))
            left = np.pad(self._stiffness, ((0, self.dimension - done), (0, 0)))
            self._stiffness = np.hstack([left, new])


def krylov_modes(
    structure: Structure,
    damping: Damping,
    band: Band,
    tolerance: float,
    watch: Watch,
    fields: bool = False,
    solver: Solver = factorized,
) -> tuple[Modes, Shapes, float]:
    """Modes right to `tolerance` in the band, their shapes, and the estimated error.

    The estimate is the change by the last block, times `SAFETY`, and what condensing the modes
    above the band and leaving out those that loads hardly excite makes, each a tenth of the
    tolerance at most; without a factor another tenth, for the solutions. Where the space is
    exhausted it holds every mode that the interfaces can excite. Where rounding keeps the error
    above the tolerance, it is stated as it is. With `fields` it includes the displacements and
    strains of the whole body; where the structure has loads of rotation, their slow responses.
    `watch` is called with the progress as text. `MethodError` if the tolerance asks for a larger
    space than `LIMIT` or the memory allows.
    """
    chain, agreed = slow_chain(structure), structure.processes.agreed
    shift, lower = shifts(structure, damping, band)
    accuracy = solution_accuracy(tolerance, fields)
    space = KrylovSpace(structure, shift, lower, solver, accuracy)
    unsolved = unsolved_error(accuracy, fields) if space.inexact else 0.0

    def modes_of(blocks: int) -> tuple[Modes, Array]:
        omega, Q = space.ritz(blocks)
        phi = space_shapes(space.basis, Q)(structure.P_C)
        return damped_modes(damping, omega, phi, band.finest_step), Q

    check, errors = FEWEST, dict[int, float]()
    while space.grow():
        if space.blocks < check:
            continue
        modes, Q = modes_of(space.blocks)
        before, Q_before = modes_of(space.blocks - 1)
        turn = Q[: len(Q_before)].T @ Q_before if fields else None
        error = agreed(partial(_change, band, before, modes, turn, tolerance))
        enough = (1.0 - 2.0 * CONDENSED) * tolerance - unsolved
        earlier = min(errors.values(), default=np.inf)
        stalled = STALLED * earlier <= error <= rounding_error(space, modes, Q)
        if error <= enough or stalled:
            weak = _weak(space, modes, Q, band, max(error, tolerance))
            lost = agreed(partial(_lost, band, modes, weak, fields))
            if lost <= CONDENSED * max(error, tolerance):
                watch(f"{space.blocks} blocks, error {error:.1e}")
                break
            error = max(error, lost)
        errors[space.blocks] = error
        watch(f"{space.blocks} blocks, error {error:.1e}")
        check = _next_check(errors, space.blocks, enough)
        room = space.room
        more = (check - space.blocks) * structure.P_C.shape[0] + sum(W.shape[1] for W in chain)
        if space.basis.columns + more > room:
            raise MethodError(
                f"impulse.method krylov: an error of {tolerance:g} up to {band.limit:g} Hz takes "
                f"more than the {room} vectors that there is time and memory for, found "
                f"{error:.1e} with {space.dimension}: raise impulse.tolerance, lower "
                "impulse.band, or use method march"
            )
    else:
        (modes, Q), error, lost = modes_of(space.blocks), 0.0, 0.0
        weak = np.zeros(len(modes.omega), dtype=bool)

    if chain:
        modes, Q, slow_error = _with_rotation(space, chain, modes_of, band, tolerance)
        error = max(error, slow_error)
        weak = _weak(space, modes, Q, band, max(error, tolerance))
        lost = agreed(partial(_lost, band, modes, weak, fields))
    modes, Q = _only(modes, ~weak), Q[:, ~weak]
    loads = space.with_rotation(modes, Q).phi if chain else modes.phi
    share = CONDENSED * tolerance * (OF_FIELDS if fields else 1.0)
    few = agreed(lambda: condensed(modes, damping, band, share, fields, loads))
    stated = error + lost + few.error + unsolved
    return few.modes, space_shapes(space.basis, Q @ few.Y), stated


def _weak(space: KrylovSpace, modes: Modes, Q: Array, band: Band, error: float) -> Mask:
    """The modes (m,) in the band whose frequency is not right to the error yet.

    They are those that loads hardly excite, which converge last. Kept, they would be listed with a
    frequency that no mode of the body has.
    """
    inside = modes.omega <= 2.0 * np.pi * band.top
    weak: Mask = inside & (SAFETY * space.frequency_changes(modes.omega, Q) > error)
    return weak


def _only(modes: Modes, chosen: Any) -> Modes:
    return replace(
        modes, omega=modes.omega[chosen], zeta=modes.zeta[chosen], phi=modes.phi[:, chosen]
    )


def _lost(band: Band, modes: Modes, weak: Mask, fields: bool) -> float:
    """The error that leaving out the weak modes makes."""
    if not weak.any():
        return 0.0
    few, turn = _only(modes, ~weak), np.eye(len(modes.omega))[:, ~weak]
    error = band.error(few, modes)
    return max(error, band.field_error(few, modes, turn)) if fields else error


def rounding_error(space: KrylovSpace, modes: Modes, Q: Array) -> float:
    """What rounding of the stiffness may make of the largest error, up to `SMALL_ERROR`.

        eps x^T D x / omega^2,    x: a mode,    D: the diagonal of K

    of a squared frequency, which counts 1 / (2 LEAST_DAMPING) times at a resonance. Elements that
    are far stiffer than the body, as short ones of a slender beam, have much of it.
    """
    structure, lowest = space.structure, np.argsort(modes.omega)[:LOWEST]
    X = space_shapes(space.basis, Q[:, lowest]).combined(np.eye(len(lowest)))
    stiffness = structure.total(np.einsum("i,ik,ik->k", structure.K.diagonal(), X, X))
    share = np.finfo(float).eps * float((stiffness / modes.omega[lowest] ** 2).max())
    return min(SMALL_ERROR, 0.5 * share / LEAST_DAMPING)


def _next_check(errors: dict[int, float], blocks: int, tolerance: float) -> int:
    """The number of blocks at which the error is to be estimated next: where it would be within the
    tolerance if it went on falling as it did, at the latest by `GROWTH`.
    """
    latest = 1 + int(GROWTH * blocks)
    if len(errors) > 1:
        (earlier, before), (_, error) = list(errors.items())[-2:]
        decades = np.log(before / error) / (blocks - earlier) if 0.0 < error < before else 0.0
        if decades > 0.0:
            latest = min(latest, max(1, int(np.ceil(np.log(error / tolerance) / decades))))
    return blocks + latest


def shifts(structure: Structure, damping: Damping, band: Band) -> tuple[float, float | None]:
    """s of the time step, for the first block, and a low one for all others.

    Where the first is low enough, there is no other. A low shift tells low frequencies apart, and
    static responses are nearly its own; it takes the fewest blocks for the whole of the band.
    """
    shift = _shift(damping, band.scheme, band.h)
    low = LOW * first_square(structure)
    return shift, low if shift > NEAR**2 * low else None


def solution_accuracy(tolerance: float, fields: bool) -> float:
    """The error of solutions, in energy, that takes its share of the tolerance.

    Transfer functions, which see loads where they act, err with its square; fields with itself.
    """
    share = UNSOLVED * tolerance
    error = share / np.sqrt(AMPLIFIED) if fields else np.sqrt(share / AMPLIFIED)
    return max(FINEST, float(error))


def unsolved_error(accuracy: float, fields: bool) -> float:
    """What solutions of an accuracy leave of the error, the other way round."""
    return float(np.sqrt(AMPLIFIED) * accuracy if fields else AMPLIFIED * accuracy**2)


def _with_rotation(
    space: KrylovSpace, chain: list[Array], modes_of: RitzModes, band: Band, tolerance: float
) -> tuple[Modes, Array, float]:
    """The modes once the space holds slow responses to loads of rotation too, and their error.

    It takes blocks of the chain until the last changes these responses by less than the tolerance.
    """
    error = 0.0
    better: Modes | None = None
    for W in chain:
        space.add(W)
        modes, Q = modes_of(space.blocks)
        before, better = better, space.with_rotation(modes, Q)
        if before is not None:
            error = SAFETY * band.slow_error(before, better)
            if error <= tolerance:
                break
    return modes, Q, error


def _shift(damping: Damping, scheme: GeneralizedAlpha, h: float) -> float:
    """s for which K + s M is the matrix of the time step, up to a factor.

    Modal ratios add no matrix to it.
    """
    mass, stiffness = (damping.rayleigh or Rayleigh()).coefficients
    velocity, hardening = scheme.gamma_prime(h), 0.0
    if (chain := damping.chain) is not None:
        hardening = float(chain.step(h)[1] @ chain.amplitude)
    return (scheme.beta_prime(h) + velocity * mass) / (1.0 + hardening + velocity * stiffness)


def _change(band: Band, before: Modes, modes: Modes, turn: Array | None, enough: float) -> float:
    """The error that the last block leaves to be expected: what it has changed, times `SAFETY`.

    turn (m, m'): the modes before it in terms of those with it, where fields count.
    """
    error = SAFETY * band.error(before, modes, enough)
    return error if turn is None else max(error, SAFETY * band.field_error(before, modes, turn))
