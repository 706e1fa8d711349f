"""Contacts of surfaces of flexible bodies: exact unilateral constraints at their nodes.

The gap of a row is a mean of that of the points around its node (facing.py):

    y_i = 1/A_i sum_q w_q psi_i(q) n_q . (x_q - c_q),    0 <= P_i  _|_  y_i + P_i layer/A_i >= 0
    x_k = x + R (X_k + u_k),    u_C = phi eta + T (u - history) + G f,    f = R^T sum_i P_i b_i

with b_ik = d y_i / d x_k. The residual flexibility in G makes the forces an algebraic function of
the motion, P(xi), which is solved for at each iterate of Newton's method; there the contact acts as
a spring of the stiffness D^T W^-1 D, with D = dy/dxi and W = b G b^T of the closed rows. Tangent
planes are laid at the first two iterates of a step, then they move with their target, so that
Newton's method converges. Source: docs/theory.md, Contact of surfaces.
"""

import math

from ..compiler.marks import compiled, entry, of_surfaces
from .complementarity import solve_closed, solve_complementarity
from .cone import by_law, is_made, make_factors, solve_cone
from .facing import face_slips, face_target, set_row_gaps, slip_row
from .lu import substitute_lu
from .planes import look_at_target, place_nodes
from .records.surfaces import Surfaces
from .surface_approach import closing_speed, elastic_way, find_near, length
from .surface_motion import move_freely, set_base, set_displacements_by_load
from .surface_rows import (
    has_rows_of_W,
    is_W_outdated,
    load_nodes,
    push_bodies,
    set_compliances,
    set_derivative,
    set_gaps,
    set_gradient,
)
from .system import State, System, Workspace
from .vectors import add, rotate, row, subtract

LOOKS_PER_STEP = 2
"""iterates of a step at which tangent planes are laid"""


@entry
def await_contacts(system: System, work: Workspace) -> None:
    """The beginning of a step, or of a new search for its end: no plane is known yet."""
    if len(system.surfaces.contacts.patch):
        work.surfaces.looks[0] = 0
        work.surfaces.awake[:] = 0


@of_surfaces
@compiled
def press_surfaces(system: System, state: State, work: Workspace) -> None:
    """Solve for the forces of all contacts at the present motion; those on frames load them."""
    contacts, out = system.surfaces.contacts, work.surfaces
    if len(contacts.patch) == 0 or out.looks[0] < 0:
        return
    if out.looks[0] == 0:
        find_near(system, state, work)
    for s in range(len(system.surfaces.bodies.flexible)):
        if out.awake[s]:
            set_base(system, s, state, work)
            # Later iterates have them from the forces of the iterate before.
            if out.looks[0] == 0:
                set_displacements_by_load(system.surfaces, s, state, work)
    out.push[:] = 0.0
    for m in range(len(contacts.island_range) - 1):
        _press_island(system, m, state, work)
    out.looks[0] += 1


@of_surfaces
@compiled
def add_surface_tangents(system: System, work: Workspace) -> None:
    """K -= D^T W^-1 D: the contacts as springs between the bodies of their islands."""
    contacts, out = system.surfaces.contacts, work.surfaces
    if len(contacts.patch) == 0 or out.looks[0] < 0:
        return
    blocks = system.pattern.island_block
    # Noted with the matrix: later switches are judged against what it contains.
    for i in range(len(out.closed)):
        out.closed_in_matrix[i] = out.closed[i]
    for m in range(len(contacts.island_range) - 1):
        first = contacts.body_range[m]
        n = contacts.coordinates[m]
        for p in range(contacts.block_range[m], contacts.block_range[m + 1]):
            i, k = first + blocks[p, 0], first + blocks[p, 1]
            start, stride = blocks[p, 2], blocks[p, 3]
            rows, columns = contacts.body_coordinate[i], contacts.body_coordinate[k]
            for a in range(contacts.body_width[i]):
                source = contacts.stiffness_start[m] + (rows + a) * n + columns
                for b in range(contacts.body_width[k]):
                    work.matrix.S[start + a * stride + b] -= out.stiffness[source + b]


@compiled
def have_surfaces_switched(work: Workspace) -> bool:
    """Whether a row has closed or opened since the matrix was made."""
    changed = 0
    for i in range(len(work.surfaces.closed)):
        changed += abs(work.surfaces.closed[i] - work.surfaces.closed_in_matrix[i])
    return changed > 0


@compiled
def are_surfaces_closed(work: Workspace) -> bool:
    """Whether any row is."""
    total = 0
    for i in range(len(work.surfaces.closed)):
        total += work.surfaces.closed[i]
    return total > 0


@of_surfaces
@compiled
def add_surface_scales(system: System, state: State, work: Workspace) -> None:
    """The forces of rows, each by itself, join the force scales of the bodies."""
    contacts, patches = system.surfaces.contacts, system.surfaces.patches
    for c in range(len(contacts.patch)):
        # Contacts only push: the sum of their forces is that of the magnitudes.
        total = 0.0
        for i in range(contacts.row[c], contacts.row[c + 1]):
            total += state.surfaces.force[i]
        if total == 0.0:
            continue
        p, f = contacts.patch[c], contacts.frame[c]
        b = patches.body[p]
        other = system.frames.body[f] if f >= 0 else patches.body[contacts.target[c]]
        place = rotate(state.bodies.R, b, row(patches.center, p))
        _add_scale(b, total, length(place) + patches.radius[p], work)
        if other >= 0:
            apart = subtract(add(row(state.bodies.x, b), place), row(state.bodies.x, other))
            _add_scale(other, total, length(apart) + patches.radius[p], work)


@compiled
def _add_scale(b: int, force: float, arm: float, work: Workspace) -> None:
    work.bodies.force_scale[b, 0] += force
    work.bodies.force_scale[b, 1] += force * arm


@entry
def measure_surfaces(system: System, state: State, work: Workspace) -> None:
    """The gaps of all rows before any of them acts: their bodies are where frames and modes say."""
    surfaces = system.surfaces
    for s in range(len(surfaces.bodies.flexible)):
        move_freely(system, s, state, work)
    for c in range(len(surfaces.contacts.patch)):
        place_nodes(system, c, state, work)
        look_at_target(system, c, math.inf, work)
        set_row_gaps(surfaces, c, state, work)


@compiled
def _press_island(system: System, m: int, state: State, work: Workspace) -> None:
    """Forces of the contacts of island m at the present motion, and its stiffness."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    looks = out.looks[0] < LOOKS_PER_STEP
    if looks:
        out.count[m] = 0
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        c = contacts.island[w]
        if out.near[c] and looks:
            place_nodes(system, c, state, work)
            _find_candidates(system, m, c, state, work)
        # A contact that is not near has no force left from an earlier step.
        elif out.looks[0] == 0:
            for i in range(contacts.row[c], contacts.row[c + 1]):
                _open(surfaces, c, i, state, work)
    n = out.count[m]
    has_friction = False
    for r in range(n):
        set_gradient(system, m, r, state, work)
        # The rows that were closed before are the guess from which the problem is solved.
        if out.kind[m, r] == 0:
            out.active[r] = int(out.closed[out.candidate[m, r]] > 0)
        else:
            out.active[r] = out.active[r - 1]
            has_friction = not out.held[0]
    # New gradients: the same forces of rows are other forces on nodes.
    if looks:
        load_nodes(system, m, False, state, work)
    # Factors of other candidates with the same status are not theirs; and a run that goes on from a
    # checkpoint has none of the step before.
    if out.looks[0] == 0 or not has_rows_of_W(m, work):
        out.made[m, 0] = -1
    if is_W_outdated(surfaces, m, work):
        set_compliances(surfaces, m, work)
    for w in range(contacts.island_range[m], contacts.island_range[m + 1]):
        c = contacts.island[w]
        if out.near[c]:
            # Placed again, for new forces on nodes displace them.
            place_nodes(system, c, state, work)
            set_gaps(system, m, c, state, work)
    if has_friction:
        count = _solve_with_friction(system, m, state, work)
    else:
        # Its factor takes the room of those with friction.
        out.made[m, 0] = -1
        count = solve_complementarity(
            n,
            out.W[m],
            out.q,
            out.held[0] == 1,
            out.active,
            out.factored[m],
            out.factor[m],
            out.order[m],
            out.lam,
            out.y,
        )
    for r in range(n):
        i = out.candidate[m, r]
        if out.kind[m, r] == 0:
            # The status of a row with friction is that of its slips: it sticks or slips.
            out.closed[i] = out.active[r + int(has_friction and _has_slips(m, r, work))]
        # No motion goes on from where there is no solution.
        state.surfaces.force[i] = out.lam[r] if count >= 0 else math.nan
        state.surfaces.gap[i] = out.y[r]
    # The next look sees all nodes, later iterates those of candidates alone.
    load_nodes(system, m, out.looks[0] + 1 < LOOKS_PER_STEP, state, work)
    push_bodies(system, m, state, work)
    _set_stiffness(system, m, max(count, 0), has_friction, state, work)


@compiled
def _has_slips(m: int, r: int, work: Workspace) -> bool:
    """Whether the candidate has friction: its slips follow it."""
    return bool(r + 1 < work.surfaces.count[m] and work.surfaces.kind[m, r + 1] > 0)


@compiled
def _solve_with_friction(system: System, m: int, state: State, work: Workspace) -> int:
    """Forces and slips of the candidates of island m, from those at hand; see `solve_cone`."""
    out, contacts, n = work.surfaces, system.surfaces.contacts, work.surfaces.count[m]
    for r in range(n):
        c = out.contact[m, r]
        out.lam[r] = state.surfaces.force[out.candidate[m, r]]
        out.mu[r, 0] = contacts.friction[c, 0] if out.kind[m, r] == 0 else -1.0
        out.mu[r, 1] = contacts.friction[c, 1]
        out.mu[r, 2] = contacts.friction[c, 2] * system.scheme.h
    return int(
        solve_cone(
            n,
            out.W[m],
            out.q,
            out.mu,
            out.active,
            out.factor[m],
            out.order[m],
            out.pivots,
            out.made[m],
            out.lam,
            out.y,
            out.law,
            out.trial,
        )
    )


@compiled
def _find_candidates(system: System, m: int, c: int, state: State, work: Workspace) -> None:
    """Rows of contact c that may be closed at the end of the step, with their gradients."""
    surfaces, out = system.surfaces, work.surfaces
    contacts = surfaces.contacts
    margin = contacts.margin[c]
    if math.isnan(margin):
        way = system.scheme.h * closing_speed(system, c, state, work)
        way += elastic_way(surfaces, contacts.patch[c], state, work)
        if contacts.frame[c] < 0:
            way += elastic_way(surfaces, contacts.target[c], state, work)
        # Twice, for the motion within the step is not known yet.
        margin = 2.0 * way
    look_at_target(system, c, margin, work)
    set_row_gaps(surfaces, c, state, work)
    for i in range(contacts.row[c], contacts.row[c + 1]):
        gap = state.surfaces.gap[i]
        # Without its force a closed row would penetrate: it stays a candidate while it is covered.
        if gap < margin or (out.closed[i] and not math.isnan(gap)):
            r = out.count[m]
            out.candidate[m, r], out.contact[m, r], out.kind[m, r] = i, c, 0
            out.count[m] = r + 1
            face_target(surfaces, c, i, work)
            if contacts.slip_row[c] >= 0:
                for kind in range(1, 3):
                    out.candidate[m, r + kind] = slip_row(surfaces, c, i, kind)
                    out.contact[m, r + kind], out.kind[m, r + kind] = c, kind
                out.count[m] = r + 3
                face_slips(surfaces, c, i, work)
        else:
            _open(surfaces, c, i, state, work)


@compiled
def _open(surfaces: Surfaces, c: int, i: int, state: State, work: Workspace) -> None:
    """Row i of contact c is open."""
    work.surfaces.closed[i], state.surfaces.force[i] = 0, 0.0
    if surfaces.contacts.slip_row[c] >= 0:
        for kind in range(1, 3):
            state.surfaces.force[slip_row(surfaces, c, i, kind)] = 0.0


@compiled
def _set_stiffness(
    system: System, m: int, count: int, has_friction: bool, state: State, work: Workspace
) -> None:
    """D^T W^-1 D of island m, of its `count` closed rows; with friction D^T A^-1 P r D.

    A = I - P (I - r W), P: the derivative of the projection on the cone.
    """
    contacts, out = system.surfaces.contacts, work.surfaces
    width_of_D, start = contacts.coordinates[m], contacts.stiffness_start[m]
    for a in range(count):
        set_derivative(system, m, out.order[m, a], out.D[a], state, work)
    if has_friction:
        # It has the room of Cholesky's factor, which is to be made anew without friction.
        out.factored[m, 0] = -1
        n = out.count[m]
        if not is_made(n, out.active, out.made[m]):
            make_factors(
                n,
                count,
                out.W[m],
                out.active,
                out.law,
                out.order[m],
                out.pivots,
                out.factor[m],
                out.made[m],
            )
    for z in range(width_of_D):
        _answer(m, count, z, has_friction, work)
        for x in range(width_of_D):
            total = 0.0
            for a in range(count):
                total += out.D[a, x] * out.y[a]
            out.stiffness[start + x * width_of_D + z] = total


@compiled
def _answer(m: int, count: int, z: int, has_friction: bool, work: Workspace) -> None:
    """y: less the forces of the closed rows that keep their law as coordinate z moves."""
    out = work.surfaces
    if not has_friction:
        for a in range(count):
            out.y[a] = out.D[a, z]
        solve_closed(count, out.factor[m], out.y)
        return
    for a in range(count):
        out.trial[out.order[m, a]] = out.D[a, z]
    for a in range(count):
        r = out.order[m, a]
        out.y[a] = -by_law(out.active, out.law, r, r, out.trial, False)
    substitute_lu(count, out.factor[m], out.pivots, out.y)
