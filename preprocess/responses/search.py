"""The search for modes that are right to a tolerance, in a growing Krylov space."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.damping import Damping
from ..errors import MethodError
from ..progress import silent
from ..solving.solver import SolverFactory, factorized
from .accuracy import rounding_error, solution_accuracy, unsolved_error
from .band import Band
from .condensation import condensed
from .damping import damped_modes
from .krylov import MIN_BLOCKS, KrylovSpace
from .ritz import space_shapes
from .shapes import Shapes
from .shifts import far_above, shifts
from .static import slow_chain

MAX_UNCHECKED_GROWTH = 0.1
"""The error is estimated at the latest when the space has grown by this share of itself."""
CHANGE_FACTOR = 2.0
"""What the last block has changed counts so many times: alone, it is down to 0.6 of the error at
times.
"""
STALL_RATIO = 0.3  # of the least error before: one that is above does not fall
CONDENSATION_ERROR_SHARE = 0.1  # of the tolerance, spent on condensing the modes above the band
OF_FIELDS = 0.1
"""Part of it where fields count: stresses at a point err by some times the error in energy."""
Watch = Callable[[str], None]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Request:
    """Modes of a structure that are to be right to a tolerance in a band.

    fields: whether displacements and strains of the whole body count, and not interfaces alone;
    watch: called with the progress as text; solver: what solves with the matrices of shifts.
    """

    structure: Structure
    damping: Damping
    band: Band
    tolerance: float
    fields: bool = False
    watch: Watch = silent
    solver: SolverFactory = factorized


def krylov_modes(request: Request) -> tuple[Modes, Shapes, float]:
    """The modes that a request asks for, their shapes, and the estimated error.

    The estimate is the change by the last block, times `CHANGE_FACTOR`, and what condensing the
    modes above the band and leaving out those that loads hardly excite makes, each a tenth of the
    tolerance at most; without a factor another tenth, for the solutions. Where the space is
    exhausted it holds every mode that the interfaces can excite. Where rounding keeps the error
    above the tolerance, it is stated as it is. Where the structure has loads of rotation, it
    includes their slow responses. `MethodError` if the tolerance asks for a larger space than
    `MAX_KRYLOV_VECTORS` or the memory allows.
    """
    structure, band, fields = request.structure, request.band, request.fields
    chain = slow_chain(structure)
    shift, lower = shifts(structure, request.damping, band)
    accuracy = solution_accuracy(request.tolerance, fields)
    at_once = far_above(shift, band)
    space = KrylovSpace(structure, shift, lower, request.solver, accuracy, at_once, refined=fields)
    unsolved = unsolved_error(accuracy, fields) if space.inexact else 0.0
    return modes_in(request, space, chain, unsolved)


def modes_in(
    request: Request, space: KrylovSpace, chain: list[Array], unsolved: float = 0.0
) -> tuple[Modes, Shapes, float]:
    """What `krylov_modes` finds, in a space that grows; chain: blocks for loads of rotation."""
    band, fields, agreed = request.band, request.fields, request.structure.processes.agreed
    search = Search(request, space, unsolved, reserved=sum(W.shape[1] for W in chain))
    found = search.run()
    if chain:
        found = search.with_rotation(found, chain)
    modes, Q = _only(found.modes, ~found.weak), found.Q[:, ~found.weak]
    loads = space.with_rotation(modes, Q).phi if chain else modes.phi
    share = CONDENSATION_ERROR_SHARE * request.tolerance * (OF_FIELDS if fields else 1.0)
    few = agreed(lambda: condensed(modes, request.damping, band, share, fields, loads))
    stated = found.error + found.lost + few.error + unsolved
    return few.modes, space_shapes(space.basis, Q @ few.Y), stated


@dataclass(frozen=True, eq=False)
class Found:
    """Modes (m,) of a space and their coordinates Q (r, m) in it.

    error: what the last block leaves to be expected; weak (m,): the modes in the band that are not
    right to it and are to be left out; lost: the error that this makes; enough: whether both are as
    small as they are to be, or can be.
    """

    modes: Modes
    Q: Array
    error: float
    weak: Mask
    lost: float = 0.0
    enough: bool = True


@dataclass(frozen=True, eq=False)
class Search:
    """The growth of a space until its modes are right.

    unsolved: the part of the tolerance that is spent on solutions; reserved: columns of the space
    that are set aside for what is added at the end.
    """

    request: Request
    space: KrylovSpace
    unsolved: float
    reserved: int

    def run(self) -> Found:
        """The modes once they are right, or once the space is exhausted."""
        space, check, errors = self.space, MIN_BLOCKS, dict[int, float]()
        while space.grow():
            if space.blocks < check:
                continue
            found = self._found(min(errors.values(), default=np.inf))
            if found.enough:
                return self._corrected(found)
            errors[space.blocks] = max(found.error, found.lost)
            check = _next_check(errors, space.blocks, self._goal)
            n_c: int = space.structure.P_C.shape[0]
            more = (check - space.blocks) * n_c
            self._require_room(found, more + (self._corrections(found) if space.rough else 0))
        modes, Q = self._modes_of(space.blocks)
        return Found(modes, Q, 0.0, np.zeros(len(modes.omega), dtype=bool))

    def with_rotation(self, found: Found, chain: list[Array]) -> Found:
        """The modes once the space holds slow responses to loads of rotation too.

        It takes blocks of the chain until the last changes these responses by less than the
        tolerance.
        """
        error = 0.0
        better: Modes | None = None
        for W in chain:
            self.space.add(W)
            modes, Q = self._modes_of(self.space.blocks)
            before, better = better, self.space.with_rotation(modes, Q)
            if before is not None:
                error = CHANGE_FACTOR * self.request.band.slow_error(before, better)
                if error <= self.request.tolerance:
                    break
        return self._without_weak(modes, Q, max(found.error, error))

    def _corrected(self, found: Found) -> Found:
        """The modes once what quick solutions have missed is in the space.

        The error is at least that of before: what corrections change says nothing of blocks to
        come.
        """
        space, before = self.space, found
        while space.rough or not found.enough:
            self._require_room(found, self._corrections(found))
            space.correct(found.modes.omega, found.Q, 2.0 * np.pi * self.request.band.top)
            found = self._found(found.error)
        return replace(found, error=max(found.error, before.error))

    def _corrections(self, found: Found) -> int:
        """The vectors that a correction adds: of modes in the band, and of static responses."""
        inside = found.modes.omega <= 2.0 * np.pi * self.request.band.top
        return int(inside.sum()) + int(self.space.structure.P_C.shape[0])

    @property
    def _goal(self) -> float:
        """The error of the space that leaves room for the others."""
        return (1.0 - 2.0 * CONDENSATION_ERROR_SHARE) * self.request.tolerance - self.unsolved

    def _found(self, earlier: float) -> Found:
        """The modes of the space; earlier: the least error before, which says whether it falls."""
        blocks, agreed = self.space.blocks, self.space.structure.processes.agreed
        modes, Q = self._modes_of(blocks)
        before, Q_before = self._modes_of(blocks - 1)
        request = self.request
        turn = Q[: len(Q_before)].T @ Q_before if request.fields else None
        error = agreed(partial(_change, request.band, before, modes, turn, request.tolerance))
        stalled = STALL_RATIO * earlier <= error <= rounding_error(self.space, modes, Q)
        if error <= self._goal or stalled:
            found = self._without_weak(modes, Q, error)
        else:
            found = Found(modes, Q, error, np.zeros(len(modes.omega), dtype=bool), enough=False)
        request.watch(f"{blocks} blocks, error {max(error, found.lost):.1e}")
        return found

    def _without_weak(self, modes: Modes, Q: Array, error: float) -> Found:
        """Modes of an error, those left out that are not right to it."""
        largest = max(error, self.request.tolerance)
        weak = _weak(self.space, modes, Q, self.request.band, largest)
        agreed = self.space.structure.processes.agreed
        lost = agreed(partial(_lost, self.request.band, modes, weak, self.request.fields))
        return Found(modes, Q, error, weak, lost, lost <= CONDENSATION_ERROR_SHARE * largest)

    def _modes_of(self, blocks: int) -> tuple[Modes, Array]:
        """The modes of the first blocks, and their coordinates."""
        omega, Q = self.space.ritz(blocks)
        phi = space_shapes(self.space.basis, Q)(self.space.structure.P_C)
        return damped_modes(self.request.damping, omega, phi, self.request.band.finest_step), Q

    def _require_room(self, found: Found, more: int) -> None:
        """`MethodError` if the space has no room for more vectors."""
        space, request, room = self.space, self.request, self.space.room
        if space.basis.columns + more + self.reserved > room:
            march = ", or use method march" if space.structure.surfaces is None else ""
            raise MethodError(
                f"impulse.method krylov: an error of {request.tolerance:g} up to "
                f"{request.band.limit:g} Hz takes more than the {room} vectors that there is time "
                f"and memory for, found {max(found.error, found.lost):.1e} with "
                f"{space.dimension}: raise impulse.tolerance, lower impulse.band{march}"
            )


def _weak(space: KrylovSpace, modes: Modes, Q: Array, band: Band, error: float) -> Mask:
    """The modes (m,) in the band whose frequency is not right to the error yet.

    They are those that loads hardly excite, which converge last. Kept, they would be listed with a
    frequency that no mode of the body has.
    """
    inside = modes.omega <= 2.0 * np.pi * band.top
    return np.asarray(inside & (CHANGE_FACTOR * space.frequency_changes(modes.omega, Q) > error))


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


def _next_check(errors: dict[int, float], blocks: int, tolerance: float) -> int:
    """The number of blocks at which the error is to be estimated next: where it would be within the
    tolerance if it went on falling as it did, at the latest by `MAX_UNCHECKED_GROWTH`.
    """
    latest = 1 + int(MAX_UNCHECKED_GROWTH * blocks)
    if len(errors) > 1:
        (earlier, before), (_, error) = list(errors.items())[-2:]
        decades = np.log(before / error) / (blocks - earlier) if 0.0 < error < before else 0.0
        if decades > 0.0:
            latest = min(latest, max(1, int(np.ceil(np.log(error / tolerance) / decades))))
    return blocks + latest


def _change(band: Band, before: Modes, modes: Modes, turn: Array | None, enough: float) -> float:
    """The error to expect after the last block: what that has changed, times `CHANGE_FACTOR`.

    turn (m, m'): the modes before it in terms of those with it, where fields count.
    """
    error = CHANGE_FACTOR * band.error(before, modes, enough)
    return (
        error if turn is None else max(error, CHANGE_FACTOR * band.field_error(before, modes, turn))
    )
