"""The block Krylov space of a body's matrices, its interface loads, and one or two shifts."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from ...files.memory import available, scratch
from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import RIGID_DOFS, Structure
from ..errors import MethodError
from ..solving.cost import EXPECTED_BLOCKS, NUMBER_BYTES, WORK_BLOCKS
from ..solving.factor import Factor, Solve
from ..solving.gradients import NotConvergedError
from ..solving.solver import Patient, SolverFactory, factorized
from .basis import Basis
from .ritz import ritz_modes, space_shapes

MIN_BLOCKS = 2  # that a space must have room for
MAX_KRYLOV_VECTORS = 4000
"""Vectors at most: beyond, the dense eigenproblems of the space take minutes and its basis
gigabytes.
"""
SHIFT_RISE = 100.0  # of the low shift, where solutions do not converge with it
MODES_AT_ONCE = 16  # as many as solutions take at the price of fewer


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
    Without `at_once` the first one is as well, and the shift of the step is not used.
    Source: A. Ruhe, Linear Algebra Appl. 58 (1984) 391-405.

    known (n_u, k): modes that the space holds from the start, and that loads need not find.
    solver: makes of a shift what solves with the matrix of that shift, to an accuracy relative in
    energy. Where it has a quick way, all blocks but the first are made in that way unless
    `refined`; `correct` then adds what they have missed. `MemoryShortageError` if a solver does not
    fit into the memory together with the basis that is to be expected.
    """

    def __init__(
        self,
        structure: Structure,
        shift: float,
        lower: float | None = None,
        solver: SolverFactory = factorized,
        accuracy: float = 0.0,
        at_once: bool = True,
        refined: bool = True,
        known: Array | None = None,
    ) -> None:
        self.structure, n_u = structure, structure.n_u
        self._solver, self._accuracy, self._highest = solver, accuracy, shift
        self._refined = refined
        self._lower: float | None = None
        self._solve: Solve | None = None
        self.inexact = self.rough = False
        if lower is None or at_once:
            expected = EXPECTED_BLOCKS if lower is None else 1
            self._solve_with(shift, "the matrix of the time step", expected)
            self._first = self._next(structure.loads)
        if lower is not None:
            self._lower = lower
            self._solve_low()
            if not at_once:
                self._first = self._next(structure.loads)
        memory, disk = (self._vectors(place) for place in (available, scratch))
        n_c = structure.P_C.shape[0]
        in_file = memory < RIGID_DOFS + (EXPECTED_BLOCKS + WORK_BLOCKS) * n_c and disk > memory
        self._most = min(MAX_KRYLOV_VECTORS, disk if in_file else memory)
        if self._most < RIGID_DOFS + MIN_BLOCKS * n_c:
            raise MethodError(
                f"impulse.method krylov: {MIN_BLOCKS} blocks of {n_c} vectors, the fewest, take "
                f"more than the {self._most} vectors that there is time and memory for: fewer "
                "interface dofs, loads and sensors would do, or method march"
            )
        self.basis = Basis(structure, min(n_u, self._most), in_file)
        self.basis.extend(structure.U)
        if known is not None:
            self.basis.extend(known)
        self._ends = [self.basis.columns]
        self._newest = self.basis.columns
        self._stiffness = np.zeros((0, 0))

    @property
    def blocks(self) -> int:
        return len(self._ends) - 1

    @property
    def dimension(self) -> int:
        return self.basis.columns - RIGID_DOFS

    @property
    def room(self) -> int:
        """The number of vectors that time, and memory or disk, allow, the basis included."""
        free = self._vectors(scratch if self.basis.in_file else available)
        n_c: int = self.structure.P_C.shape[0]
        return min(self._most, self.basis.columns + free - WORK_BLOCKS * n_c)

    def _vectors(self, place: Callable[[], int]) -> int:
        """The number of vectors that the bytes of a place hold, in all processes."""
        vectors = place() // (NUMBER_BYTES * self.structure.n_here)
        return -int(self.structure.processes.largest(-vectors))

    def grow(self) -> bool:
        """Add a block; False if nothing is left to add, for the space holds all that interface
        loads excite.
        """
        # S^-1 M is symmetric in M: what it makes of a block has parts along that block and its two
        # neighbors alone, those with another S aside.
        near = self._ends[self.blocks - 2] if self.blocks > 1 else RIGID_DOFS
        if not self.blocks:
            W = self._first
        else:
            shift = self._lower
            W = self._next(self.structure.M @ self.basis.V[:, self._newest :], self._refined)
            if self._lower != shift:
                near = 0
        if not self.basis.extend(W, near=near):
            return False
        self._end_block()
        return True

    def add(self, W: Array) -> None:
        """Add displacements W (n_u, k) as a block that no other grows from."""
        self.basis.extend(W)
        self._end_block()

    def correct(self, omega: Array, Q: Array, limit: float) -> None:
        """Add as a block what modes up to `limit` [rad/s] and static responses miss.

            S^-1 (K X - M X diag(omega^2)),    S^-1 (F - K X_0),    X_0 = X diag(1 / omega^2) X^T F

        of all modes X, omega (m,) and Q (r, m) as `ritz` has them. These solutions are refined, so
        that what they change tells what is missed, however wrong the quick ones are. Source: E. R.
        Davidson, J. Comput. Phys. 17 (1975) 87-94.
        """
        if not self.rough:  # this is a block of its own then, not the rest of one
            self._newest = self._ends[-1]
        for residuals in self._residuals(omega, Q, limit):
            self.basis.extend(self._next(residuals))
        self._ends.append(self.basis.columns)
        self.rough = False

    def _residuals(self, omega: Array, Q: Array, limit: float) -> Iterator[Array]:
        """What the equations of modes and of static responses leave, by `MODES_AT_ONCE` columns."""
        K, M = self.structure.K, self.structure.M
        V = self.basis.V[:, RIGID_DOFS : RIGID_DOFS + len(Q)]
        inside = int(np.searchsorted(omega, limit))
        for start in range(0, inside, MODES_AT_ONCE):
            chosen = slice(start, min(start + MODES_AT_ONCE, inside))
            X = V @ Q[:, chosen]
            yield K @ X - (M @ X) * omega[chosen] ** 2
        loads = self.structure.loads
        X_0 = V @ (Q @ ((Q.T @ self.structure.total(V.T @ loads)) / omega[:, None] ** 2))
        yield loads - K @ X_0

    def _end_block(self) -> None:
        self._newest = self._ends[-1]
        self._ends.append(self.basis.columns)

    def _solve_with(
        self, shift: float, name: str = "the matrix of a low shift", blocks: int = EXPECTED_BLOCKS
    ) -> None:
        """Solve with the matrix of a shift from now on."""
        self._solve = None  # two might not fit
        self._solve = self._solver(self.structure, shift, name, self._accuracy, blocks)
        self.inexact |= not isinstance(self._solve, Factor)

    def _solve_low(self) -> None:
        """Solve with the low shift, or with the first higher one that gradients begin with."""
        assert self._lower is not None
        try:
            self._solve_with(self._lower)
        except NotConvergedError as error:
            self._solve_higher(error)

    def _solve_higher(self, error: NotConvergedError) -> None:
        """Solve with a higher low shift; raise `error` if it would be above that of the step."""
        if self._lower is None or SHIFT_RISE * self._lower > self._highest:
            raise error
        self._lower *= SHIFT_RISE
        self._solve_low()

    def _next(self, B: Array, refined: bool = True) -> Array:
        """S^-1 B, with a higher shift from here on where the low one asks too much of gradients."""
        while True:
            solve = self._solve
            assert solve is not None
            quick = solve.quick if isinstance(solve, Patient) and not refined else None
            self.rough |= quick is not None
            try:
                return (quick or solve)(B)
            except NotConvergedError as error:
                self._solve_higher(error)

    def ritz(self, blocks: int) -> tuple[Array, Array]:
        """omega (m,) [rad/s] and Q (r, m) of the first blocks, as `ritz_modes` has them."""
        self._reduce_stiffness()
        size = self._ends[blocks] - RIGID_DOFS
        V = self.basis.V[:, RIGID_DOFS : RIGID_DOFS + size]
        return ritz_modes(self.structure, V, self._stiffness[:size, :size])

    def frequency_changes(self, omega: Array, Q: Array) -> Array:
        """The relative changes (m,) of the frequencies omega of all blocks by the last one, and by
        what has corrected it.

            q^T (V^T K V - omega^2) q / (2 omega^2)

        of the part q of a mode in them: Ritz values are stationary.
        """
        self._reduce_stiffness()
        start = self._newest - RIGID_DOFS
        K, q = self._stiffness[start:, start:], Q[start:]
        K = np.triu(K) + np.triu(K, 1).T
        energy = np.einsum("ik,ik->k", q, K @ q) / omega**2
        return np.asarray(np.abs(0.5 * (energy - np.einsum("ik,ik->k", q, q))))

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
            V = self.basis.V[:, RIGID_DOFS:]
            new = self.structure.total(V.T @ (self.structure.K @ V[:, done:]))
            left = np.pad(self._stiffness, ((0, self.dimension - done), (0, 0)))
            self._stiffness = np.hstack([left, new])
