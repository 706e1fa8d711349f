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

from ..compiler.marks import compiled, entry
from ..compiler.memory import copy
from .bodies import accelerate, largest_coordinate, largest_correction, move_body, set_body_rhs
from .contacts import has_switched, note_status
from .couplings import move_multipliers, set_coupling_rhs
from .elimination import factorize, substitute
from .equations import assemble, evaluate, linearize, relative_residual
from .interfaces import move_interfaces, set_interface_rhs
from .system import State, System, Workspace

PRECISION = 1e-15
"""the last correction, relative to positions, of a state as near as rounding allows"""
STALLED = 0.5
"""ratio of successive corrections above which more of them do not help"""
LOST = 1.0
"""relative residual at which a fixed number of iterations has failed"""


@compiled
def converge(system: System, state: State, work: Workspace) -> tuple[int, float, bool]:
    """Newton's method from the predicted state: iterations, relative residual, True if converged.

    Errors of old factors do not square, so it goes on below the tolerance until the corrections
    no longer shrink. Where it fails with old factors, or from the predicted accelerations, it
    starts once more from zero accelerations and makes every matrix anew; friction then sticks
    first, and slips the way it is dragged: from far off what is light slips to and fro for ever.
    After `newton.fixed_iterations` iterations, where that is set, it returns the state as it is.
    """
    newton, matrix = system.newton, work.matrix
    reuse = newton.reuse
    reach = largest_coordinate(system.bodies, state)
    change = previous = math.inf
    total = iterations = 0
    while True:
        work.couplings.holds[0] = int(reuse == 0.0 and iterations == 0)
        evaluate(system, state, work)
        if iterations == newton.fixed_iterations and iterations > 0:
            residual = relative_residual(system, reach, iterations > 1, state, work)
            return total, residual, residual < LOST
        fast = change <= max(reuse * previous, PRECISION * reach)
        at_rest = change <= PRECISION * reach or change > STALLED * previous
        last = iterations == newton.max_iterations
        if iterations > 0 and (at_rest or last):
            residual = relative_residual(system, reach, iterations > 1, state, work)
            if residual <= newton.tolerance:
                matrix.current[0] = int(fast)
                return total, residual, True
        solvable = not last
        fits = matrix.current[0] == 1 and not has_switched(system.couplings, work)
        if solvable and not (fits and fast):
            solvable = renew(system, state, work)
            matrix.current[0] = int(solvable)
            matrix.count[0] += 1
        if solvable:
            previous, change = change, correct(system, state, work)
            iterations += 1
            total += 1
        elif reuse > 0.0:
            reuse, iterations = 0.0, 0
            change = previous = math.inf
            _restart(system, state, work)
        else:
            residual = relative_residual(system, reach, iterations > 1, state, work)
            return total, residual, False


@entry
def renew(system: System, state: State, work: Workspace) -> bool:
    """The factors of the iteration matrix at the state of the last `evaluate`.

    False if it is singular.
    """
    linearize(system, state, work)
    assemble(system, state, work)
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
    copy(work.interfaces.u_n, state.interfaces.u)
    copy(work.couplings.lam_n, state.couplings.lam)
