"""Newton's method on the equations of a time step, with their exact tangent.

Unknowns: delta X = R^T delta x and delta Theta of every body (dr), the displacements u of the
active interface dofs, and lambda. K_ab: derivatives of the generalized forces, r rigid, a active;
B: of the rows' coordinates; A: of their residuals, A = B for a constraint, and for a spring, whose
row is lambda + stiffness c + ... = 0, times h^2 with Z = 1.

    [ h^2 (S_rr - K_rr)   -h^2 K_ra        -B_r^T            ] [ dr       ]     [ h^2 r_eq ]
    [ -w G_0 K_ar          I - w G_0 K_aa  -w G_0 B_a^T / h^2 ] [ du       ] = - [ -r_u     ]
    [ A_r                  A_a              Z                ] [ h^2 dlam ]     [ phi      ]

All blocks are of order one. In body axes nothing of a mechanism that turns as a whole changes, so
the factors of one matrix serve many steps: they are made anew when a correction is larger than
`newton.reuse` times the one before. Source: docs/theory.md, The time step; u exactly.
"""

import math
from enum import IntEnum

from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from ..compiler.parts import filled_parts, n_parts, part
from .bodies import (
    accelerate,
    largest_coordinate,
    largest_correction,
    largest_motion,
    move_body,
    set_body_rhs,
)
from .contacts import has_switched, note_status
from .couplings import move_multipliers, set_coupling_rhs
from .elimination import factorize, substitute
from .equations import assemble, evaluate, linearize, relative_residual
from .interfaces import move_interfaces, set_interface_rhs
from .surfaces import await_contacts, have_surfaces_switched
from .system import State, System, Workspace

NEGLIGIBLE_CORRECTION = 1e-15
"""correction over the largest coordinate that is lost in the rounding of positions"""
STALLED_RATIO = 0.5
"""ratio of successive corrections above which more of them do not help"""
SLOPE_ROUNDING = 1e-11
"""correction of a derivative over the largest one of a coordinate from where on it may stall"""
MAX_SLOPE_ERROR = 1e-7
"""the same where the largest number of iterations is done: above, derivatives have failed"""
MAX_FIXED_RESIDUAL = 1.0
"""relative residual from which on a fixed number of iterations has failed"""


class Outcome(IntEnum):
    """What an iteration of Newton's method, or all of them, came to."""

    CORRECTABLE = 0
    """neither converged nor failed: another correction may help"""
    CONVERGED = 1
    ENDED_EARLY = 2
    """the fixed number of iterations is done, and the residual is too large"""
    FAILED = 3
    """the largest number of iterations is done, or the matrix is singular"""


@compiled
def converge(system: System, state: State, work: Workspace) -> tuple[int, float, bool]:
    """Newton's method from the predicted state: iterations, relative residual, True if converged.

    Where it fails with old factors, or from the predicted accelerations, it starts once more from
    zero accelerations and makes every matrix anew.
    """
    # Fixed for the whole step, so that what counts as rounding cannot drift between iterations.
    reach = largest_coordinate(system.bodies, state)
    outcome, iterations, residual = _iterate(system, system.newton.reuse, reach, state, work)
    total = iterations
    # Without reuse every matrix was new already: a second attempt would only repeat the first.
    if outcome == Outcome.FAILED and system.newton.reuse > 0.0:
        _restart(system, state, work)
        outcome, iterations, residual = _iterate(system, 0.0, reach, state, work)
        total += iterations
    if outcome == Outcome.FAILED:
        # A failed iteration leaves no residual; the error message names one.
        residual = relative_residual(system, reach, iterations > 1, state, work)
    return total, residual, outcome == Outcome.CONVERGED


@compiled
def _iterate(
    system: System, reuse: float, reach: float, state: State, work: Workspace
) -> tuple[Outcome, int, float]:
    """Correct the state until it converges or fails: outcome, number of corrections, residual.

    reuse: ratio of successive corrections up to which old factors serve; reach: largest coordinate
    [m]. The residual is infinite where the iteration failed.
    """
    # Infinite, so that the first correction is never taken for a stalled one.
    change = previous = filled_parts(work.matrix.rhs[0], math.inf)
    iterations = 0
    while True:
        # Far from the solution, friction on light bodies can oscillate between stick and slip. With
        # new matrices alone it sticks at first, so that it slips in the direction of its load.
        work.couplings.holds[0] = int(reuse == 0.0 and iterations == 0)
        evaluate(system, state, work)
        is_fast = change <= max(reuse * previous, NEGLIGIBLE_CORRECTION * reach)
        # Errors of old factors do not square: below the tolerance corrections still help until they
        # no longer shrink.
        is_at_rest = change <= NEGLIGIBLE_CORRECTION * reach or change > STALLED_RATIO * previous
        is_whole = True
        if n_parts(change) > 1:
            # Derivatives go on where values rest, which may not move at all.
            scale = largest_motion(system.bodies, system.scheme.h, state)
            is_fast = is_fast and _are_slopes_fast(change, previous, reuse, scale)
            is_at_rest = is_at_rest and _are_slopes_at_rest(change, previous, scale)
            is_whole = _are_slopes_below(change, MAX_SLOPE_ERROR, scale)
        outcome, residual = _judge(system, iterations, is_at_rest, reach, state, work)
        if outcome == Outcome.CONVERGED and not is_whole:
            outcome = Outcome.FAILED
        if outcome == Outcome.CONVERGED:
            work.matrix.current[0] = int(is_fast)
        if outcome == Outcome.CORRECTABLE and not _has_factors(system, is_fast, state, work):
            outcome = Outcome.FAILED
        if outcome != Outcome.CORRECTABLE:
            return outcome, iterations, residual
        previous, change = change, correct(system, state, work)
        iterations += 1


@compiled
def _are_slopes_fast(change: float, previous: float, reuse: float, scale: float) -> bool:
    """Whether corrections of all derivatives shrink fast enough with the factors at hand."""
    for i in range(1, n_parts(change)):
        allowed = max(reuse * part(previous, i), SLOPE_ROUNDING * part(scale, i))
        if part(change, i) > allowed:
            return False
    return True


@compiled
def _are_slopes_at_rest(change: float, previous: float, scale: float) -> bool:
    """Whether another correction is not expected to help any derivative.

    One that stalls above rounding waits for new factors: those of values that rest may be old.
    """
    for i in range(1, n_parts(change)):
        own = part(change, i)
        stalled = own > STALLED_RATIO * part(previous, i) and own <= SLOPE_ROUNDING * part(scale, i)
        if own > NEGLIGIBLE_CORRECTION * part(scale, i) and not stalled:
            return False
    return True


@compiled
def _are_slopes_below(change: float, bound: float, scale: float) -> bool:
    """Whether the last corrections of all derivatives were less than a bound of their scale."""
    excess = 0.0
    for i in range(1, n_parts(change)):
        excess = max(excess, part(change, i) - bound * part(scale, i))
    return excess <= 0.0


@compiled
def _judge(
    system: System, iterations: int, is_at_rest: bool, reach: float, state: State, work: Workspace
) -> tuple[Outcome, float]:
    """What the corrections so far came to, and the residual where it was asked for.

    is_at_rest: another correction is not expected to help.
    """
    newton = system.newton
    is_last = iterations == newton.max_iterations
    is_fixed = iterations == newton.fixed_iterations
    residual = math.inf
    # It takes the magnitudes of all forces, so it is evaluated only where it can decide.
    if iterations > 0 and (is_fixed or is_at_rest or is_last):
        residual = relative_residual(system, reach, iterations > 1, state, work)
        if is_fixed:
            # A fixed number bounds the cost, not the error: only a residual as large as the forces
            # fails.
            small = residual < MAX_FIXED_RESIDUAL
            return (Outcome.CONVERGED if small else Outcome.ENDED_EARLY), residual
        if residual <= newton.tolerance:
            return Outcome.CONVERGED, residual
    return (Outcome.FAILED if is_last else Outcome.CORRECTABLE), residual


@compiled
def _has_factors(system: System, is_fast: bool, state: State, work: Workspace) -> bool:
    """Whether there are factors for the next correction; they are made where the old do not serve.

    is_fast: corrections shrink fast enough with the old ones.
    """
    matrix = work.matrix
    # A contact or limit that switches changes rows of the matrix by more than corrections repair.
    switched = has_switched(system.couplings, work) or have_surfaces_switched(work)
    serves = matrix.current[0] == 1 and not switched
    if not (serves and is_fast):
        matrix.current[0] = int(renew(system, state, work))
        matrix.count[0] += 1
    return bool(matrix.current[0] == 1)


@entry
def renew(system: System, state: State, work: Workspace) -> bool:
    """The factors of the iteration matrix at the state of the last `evaluate`.

    False if it is singular.
    """
    linearize(system, state, work)
    assemble(system, state, work)
    # Noted with the matrix: later switches are judged against what this matrix contains.
    note_status(system.couplings, work)
    return factorize(system.pattern, work.matrix.S, work.matrix.pivots)


@entry
def correct(system: System, state: State, work: Workspace) -> float:
    """Solve for the corrections with the factors at hand and apply them; the largest of a body."""
    scheme, elastic, pattern = system.scheme, system.elastic, system.pattern
    h2 = scheme.h * scheme.h
    set_body_rhs(pattern, h2, state, work)
    set_interface_rhs(elastic, pattern, work)
    set_coupling_rhs(system, h2, work)
    substitute(pattern, work.matrix.S, work.matrix.pivots, work.matrix.rhs)
    move_interfaces(elastic, pattern, state, work)
    for b in range(len(pattern.body)):
        move_body(b, pattern.first[pattern.body[b]], scheme, state, work)
    move_multipliers(system, h2, state, work)
    return largest_correction(pattern, system.bodies.size, work)


@compiled
def _restart(system: System, state: State, work: Workspace) -> None:
    """The safest guess: no accelerations, displacements and multipliers of the last step."""
    state.bodies.v_dot[:] = 0.0
    accelerate(system.scheme, state, work)
    # Predicted displacements belong to the accelerations that have just been dropped.
    copy(work.interfaces.u_n, state.interfaces.u)
    copy(work.couplings.lam_n, state.couplings.lam)
    await_contacts(system, work)
