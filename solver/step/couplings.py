"""Joints, motions, springs, motors and contacts: wrenches, residuals, derivatives, energies.

The wrench of a row on its frames is lambda times its gradient, for L + lambda^T phi. The row of a
joint must vanish, phi = c (less the driven distance or angle; a driven rotation row turns its axis
instead, and that of an attitude has a driven axis). Where a joint forbids slip there is no c, and
phi = h dc/dt. Rows of couplers have further terms (terms.py). The row of a spring obeys

    phi_i = lambda_i + sum_j (stiffness_ij (c_j - rest_j) + damping_ij dc_j/dt)
            + laws_i(c_i - rest_i, dc_i/dt) = 0

so that springs enter Newton's matrix like joints, and couple no two bodies but by their multiplier.
Contacts are such rows as well, which are left out while they are open (contacts.py); rows with
friction come last in their coupling (friction.py).
"""

import math

from ..compiler.marks import compiled
from .contacts import set_closed
from .events import follow_contact
from .force_laws import law_of_row, law_rounding, set_law_residual
from .frames import (
    add_wrench_scale,
    coordinate,
    pull_back_pair,
    pull_back_tangent,
    width,
)
from .friction import (
    bend_bristle,
    bristle_energy,
    friction_rounding,
    set_friction_derivative,
    set_friction_residual,
)
from .measure import SUM_ROUNDING, relative
from .records.couplings import Couplings
from .records.frames import Frames
from .records.laws import Laws
from .rows import (
    ATTITUDE,
    ROTATION,
    add_row_tangent,
    carried_axis,
    evaluate_row,
    is_angle,
    measures_length,
    slips,
)
from .spin_tables import added_coefficients, elastic_table_force, table_slope_by_spin
from .system import State, System, Workspace
from .terms import (
    add_convective_terms,
    add_tangent_of_pair,
    add_term_scales,
    add_term_wrenches,
    assemble_terms,
    expect_terms,
    keep_terms,
    linearize_terms,
    term_scale,
)
from .vectors import UNIT_AXES, cross, dot, rotate, row, scale, triple


@compiled
def driven_angle(couplings: Couplings, i: int, work: Workspace) -> float:
    """The angle by which the drive of row i turns its axis."""
    d = couplings.drive[i]
    return float(work.drives.value[d]) if d >= 0 and couplings.rows.kind[i] == ROTATION else 0.0


@compiled
def _is_measured(kind: int) -> bool:
    """True where a drive is subtracted from the coordinate of a kind of rows."""
    return measures_length(kind) or is_angle(kind)


@compiled
def add_coupling_wrenches(couplings: Couplings, state: State, work: Workspace) -> None:
    """Coordinates, rates, gradients and residuals of all rows; their wrenches act on the frames."""
    out, lam = work.couplings, state.couplings.lam
    for j in range(len(couplings.range) - 1):
        first, last = couplings.range[j], couplings.range[j + 1]
        contact = couplings.contact_of[j] >= 0
        for i in range(first, last):
            if contact and i > first and not out.status[j]:
                _hold(i, state, work)
            else:
                _follow_row(couplings, i, state, work)
            if contact and i == first:
                set_closed(couplings, j, state, work)
        wrench, end = out.wrench[j], last_law(couplings, j)
        wrench[:] = 0.0
        for i in range(first, last):
            for k in range(6):
                wrench[k] += lam[i] * out.gradient[i, couplings.second[i] + k]
            if contact and not out.status[j]:
                out.phi[i], out.scale[i] = lam[i], abs(lam[i])
            elif couplings.compliant[i] and i < end:
                set_law_residual(couplings.laws, i, first, end, state, work)
        if end < last and (out.status[j] or not contact):
            set_friction_residual(couplings, j, first, state, work)
    add_term_wrenches(couplings, state, work)


@compiled
def last_law(couplings: Couplings, j: int) -> int:
    """The end of the rows of coupling j that have no friction."""
    r = couplings.friction_of[j]
    return int(couplings.friction.first[r] if r >= 0 else couplings.range[j + 1])


@compiled
def _follow_row(couplings: Couplings, i: int, state: State, work: Workspace) -> None:
    """Coordinate, rate, gradient and constraint of row i; its wrench acts on the frames."""
    rows, out, frames, lam = couplings.rows, work.couplings, work.frames, state.couplings.lam
    gradient = out.gradient[i]
    f, g = rows.frame_a[i], rows.frame_b[i]
    angle = driven_angle(couplings, i, work)
    out.coordinate[i] = evaluate_row(rows, i, angle, out.near[i], work, gradient)
    rate = 0.0
    for k in range(6):
        # dc/dt = gradient . V holds for every kind, so that rows need no rate of their own.
        rate += gradient[k] * frames.V[f, k] + gradient[6 + k] * frames.V[g, k]
        frames.wrench[f, k] += lam[i] * gradient[k]
        frames.wrench[g, k] += lam[i] * gradient[6 + k]
    out.rate[i] = rate
    if slips(rows.kind[i]):
        h, old = out.elapsed[0], state.couplings
        # Slip has no coordinate on a curved surface: its rate is integrated by the trapezoidal
        # rule.
        passed = 0.5 * h * (old.rate[i] + rate) if h < math.inf else 0.0
        out.coordinate[i] = old.coordinate[i] + passed
    _set_constraint_residual(couplings, i, work)


@compiled
def _hold(i: int, state: State, work: Workspace) -> None:
    """Row i does not act: its contact is open."""
    # Nothing may act by the gradient of an earlier contact.
    work.couplings.gradient[i] = 0.0
    work.couplings.coordinate[i] = state.couplings.coordinate[i]
    work.couplings.rate[i] = 0.0


@compiled
def add_coupling_scales(system: System, state: State, work: Workspace) -> None:
    """The wrenches of all rows, each by itself, join the force scales of the bodies."""
    rows, gradient = system.couplings.rows, work.couplings.gradient
    for i in range(len(rows.kind)):
        lam = state.couplings.lam[i]
        on_a = scale(lam, triple(gradient[i], 0)), scale(lam, triple(gradient[i], 3))
        on_b = scale(lam, triple(gradient[i], 6)), scale(lam, triple(gradient[i], 9))
        add_wrench_scale(system.frames, rows.frame_a[i], on_a, state, work)
        add_wrench_scale(system.frames, rows.frame_b[i], on_b, state, work)
    add_term_scales(system, state, work)


@compiled
def _time_passes(work: Workspace) -> bool:
    """Whether time passes: not at the start, nor in the search for an equilibrium."""
    elapsed: float = work.couplings.elapsed[0]
    return 0.0 < elapsed < math.inf


@compiled
def _set_constraint_residual(couplings: Couplings, i: int, work: Workspace) -> None:
    """phi = c - s of a driven length or angle, h dc/dt of slip, c elsewhere; d phi / d s of the
    drive.
    """
    out = work.couplings
    out.phi[i] = out.coordinate[i]
    if slips(couplings.rows.kind[i]):
        # At rest nothing slips, whatever the pose.
        out.phi[i] = out.elapsed[0] * out.rate[i] if _time_passes(work) else 0.0
    d = couplings.drive[i]
    if d < 0:
        return
    s = work.drives.value[d]
    if _is_measured(couplings.rows.kind[i]):
        out.phi[i] -= s
        work.drives.slope[d] = -1.0
    elif couplings.rows.kind[i] == ATTITUDE:
        f, g = couplings.rows.frame_a[i], couplings.rows.frame_b[i]
        b = rotate(work.frames.D, g, row(couplings.rows.b, i))
        for m in range(3):
            work.drives.slope[d + m] = dot(rotate(work.frames.D, f, UNIT_AXES[m]), b)
    else:
        # The derivative of an axis by the angle that turns it is the axis a quarter turn ahead.
        ahead = carried_axis(couplings.rows, i, s + 0.5 * math.pi)
        f, g = couplings.rows.frame_a[i], couplings.rows.frame_b[i]
        b = rotate(work.frames.D, g, row(couplings.rows.b, i))
        work.drives.slope[d] = dot(rotate(work.frames.D, f, ahead), b)


@compiled
def expect_coordinates(couplings: Couplings, h: float, state: State, work: Workspace) -> None:
    """The coordinates at the end of a step by their rates, to which angles are then the nearest."""
    old, near = state.couplings, work.couplings.near
    for i in range(len(near)):
        # The angle turns by less than half a turn against this guess; without it fast joints lose
        # turns.
        near[i] = old.coordinate[i] + h * old.rate[i]
    expect_terms(h, state, work)


@compiled
def spring_energy(couplings: Couplings, j: int, state: State, work: Workspace) -> float:
    """1/2 (c - rest)^T stiffness (c - rest) and what the laws of its rows store, of coupling j."""
    laws, c = couplings.laws, work.couplings.coordinate
    total = 0.0
    if couplings.contact_of[j] >= 0 and not work.couplings.status[j]:
        return total
    first, last = couplings.range[j], last_law(couplings, j)
    if last < couplings.range[j + 1]:
        total += bristle_energy(couplings, couplings.friction_of[j], state)
    for i in range(first, last):
        if couplings.compliant[i]:
            stretch = c[i] - laws.rest[i]
            for k in range(first, last):
                other = c[k] - laws.rest[k]
                total += 0.5 * stretch * laws.stiffness[i, k - first] * other
            total += 0.5 * stretch * elastic_table_force(laws, i, first, work)
            _, _, _, energy = law_of_row(laws, i, state, work)
            total += energy
    return total


@compiled
def linearize_couplings(system: System, state: State, work: Workspace) -> None:
    """B, B_rate and A of all rows, and K += the tangents of wrenches at constant multipliers."""
    couplings, frames, h = system.couplings, system.frames, system.scheme.h
    rows, out = couplings.rows, work.couplings
    for j in range(len(couplings.range) - 1):
        first, last = couplings.range[j], couplings.range[j + 1]
        if first == last:  # all its rows were redundant
            continue
        end = last_law(couplings, j)
        if couplings.contact_of[j] >= 0 and not work.couplings.status[j]:
            _release(first, last, work)
            continue
        pair = rows.frame_a[first], rows.frame_b[first]
        out.tangent[:] = 0.0
        for i in range(first, last):
            pull_back_pair(frames, pair, out.gradient[i], state, work, out.B[i])
            if couplings.compliant[i] or slips(rows.kind[i]):
                _set_rate_derivative(couplings, frames, i, state, work)
            angle = driven_angle(couplings, i, work)
            add_row_tangent(rows, i, angle, state.couplings.lam[i], work, out.tangent)
        for i in range(first, end):
            _set_residual_derivative(couplings, i, first, end, h, state, work)
        if end < last:
            set_friction_derivative(couplings, j, first, h, state, work)
        pull_back_tangent(frames, pair, out.tangent, state, work)
        pattern = system.pattern
        add_tangent_of_pair(frames, pattern, pair, pattern.coupling_block[j], work)
    linearize_terms(system, state, work)


@compiled
def _release(first: int, last: int, work: Workspace) -> None:
    """The derivatives of rows of an open contact, whose multipliers vanish."""
    for i in range(first, last):
        work.couplings.A[i] = 0.0
        work.couplings.B[i] = 0.0
        work.couplings.Z[i] = 0.0


@compiled
def _set_rate_derivative(
    couplings: Couplings, frames: Frames, i: int, state: State, work: Workspace
) -> None:
    """B_rate[i]: of dc/dt = gradient . V, by the gradient (V^T H) and by V."""
    out, V = work.couplings, work.frames.V
    f, g = couplings.rows.frame_a[i], couplings.rows.frame_b[i]
    _set_row_tangent(couplings, i, work)
    for k in range(12):
        total = 0.0
        for m in range(6):
            total += V[f, m] * out.rate_tangent[m, k] + V[g, m] * out.rate_tangent[6 + m, k]
        out.rate_gradient[k] = total
    pull_back_pair(frames, (f, g), out.rate_gradient, state, work, out.B_rate[i])
    for k in range(12):
        for m in range(6):
            out.B_rate[i, k] += out.gradient[i, m] * work.frames.rate_map[f, m, k]
            out.B_rate[i, 12 + k] += out.gradient[i, 6 + m] * work.frames.rate_map[g, m, k]


@compiled
def _set_row_tangent(couplings: Couplings, i: int, work: Workspace) -> None:
    """`rate_tangent` = H of row i at a unit multiplier."""
    out = work.couplings
    out.rate_tangent[:] = 0.0
    add_row_tangent(
        couplings.rows, i, driven_angle(couplings, i, work), 1.0, work, out.rate_tangent
    )


@compiled
def _set_residual_derivative(
    couplings: Couplings, i: int, first: int, last: int, h: float, state: State, work: Workspace
) -> None:
    """A[i] = B[i] of a constraint, h B_rate[i] of slip; h^2 (stiffness B + damping B_rate)[i] of a
    force law.

    The slopes of the law of the row alone join the diagonal of stiffness and damping.
    """
    derivatives, laws = work.couplings, couplings.laws
    out = derivatives.A[i]
    if not couplings.compliant[i]:
        rolls = slips(couplings.rows.kind[i]) and _time_passes(work)
        for z in range(24):
            out[z] = h * derivatives.B_rate[i, z] if rolls else derivatives.B[i, z]
        return
    out[:] = 0.0
    _, slope, rate_slope, _ = law_of_row(laws, i, state, work)
    for j in range(first, last):
        stiffness = h * h * (laws.stiffness[i, j - first] + (slope if i == j else 0.0))
        damping = h * h * (laws.damping[i, j - first] + (rate_slope if i == j else 0.0))
        for z in range(24):
            out[z] += stiffness * derivatives.B[j, z] + damping * derivatives.B_rate[j, z]
    if laws.tables.of[i] >= 0:
        _add_table_derivative(laws, i, first, h, work)


@compiled
def _add_table_derivative(laws: Laws, i: int, first: int, h: float, work: Workspace) -> None:
    """A[i] += h^2 times the derivative of what the table of row i adds to its force."""
    t, derivatives = laws.tables.of[i], work.couplings
    s, out = laws.tables.spin[t], derivatives.A[i]
    for j in range(2):
        stiffness, damping = added_coefficients(laws.tables, t, j, derivatives.rate[s])
        for z in range(24):
            out[z] += h * h * stiffness * derivatives.B[first + j, z]
            out[z] += h * h * damping * derivatives.B_rate[first + j, z]
    # The coefficients themselves change with the rate of the angle.
    by_spin = h * h * table_slope_by_spin(laws, i, first, work)
    for z in range(24):
        out[z] += by_spin * derivatives.B_rate[s, z]


@compiled
def assemble_rows(system: System, work: Workspace) -> None:
    """B^T / h^2 into the rows of bodies, A and 1 for compliant rows into those of couplings."""
    couplings, frames, pattern = system.couplings, system.frames, system.pattern
    h2 = system.scheme.h * system.scheme.h
    S, derivatives = work.matrix.S, work.couplings
    for j in range(len(couplings.range) - 1):
        first, last = couplings.range[j], couplings.range[j + 1]
        blocks = pattern.coupling_block[j]
        for i in range(first, last):
            for side in range(2):
                f = couplings.rows.frame_a[i] if side == 0 else couplings.rows.frame_b[i]
                above, stride = blocks[2 + 2 * side, 0], blocks[2 + 2 * side, 1]
                beside = blocks[3 + 2 * side, 0] + (i - first) * blocks[3 + 2 * side, 1]
                for k in range(width(frames, f)):
                    z = coordinate(frames, f, k)
                    S[above + z * stride + i - first] += derivatives.B[i, 12 * side + k] / h2
                    S[beside + z] += derivatives.A[i, 12 * side + k]
            if couplings.compliant[i]:
                S[blocks[6, 0] + (i - first) * (blocks[6, 1] + 1)] = 1.0
        for i in range(last_law(couplings, j), last):
            for k in range(first, last_law(couplings, j)):
                S[blocks[6, 0] + (i - first) * blocks[6, 1] + k - first] += derivatives.Z[
                    i, k - first
                ]
    assemble_terms(system, work)


@compiled
def set_coupling_rhs(system: System, h2: float, work: Workspace) -> None:
    """-phi of constraints, -h^2 phi of force laws."""
    couplings, pattern = system.couplings, system.pattern
    for j in range(len(pattern.coupling)):
        first = couplings.range[j]
        for i in range(first, couplings.range[j + 1]):
            factor = h2 if couplings.compliant[i] else 1.0
            z = pattern.first[pattern.coupling[j]] + i - first
            work.matrix.rhs[z] = -factor * work.couplings.phi[i]


@compiled
def move_multipliers(system: System, h2: float, state: State, work: Workspace) -> None:
    """Apply the corrections of the multipliers."""
    couplings, pattern = system.couplings, system.pattern
    for j in range(len(pattern.coupling)):
        first = couplings.range[j]
        for i in range(first, couplings.range[j + 1]):
            z = pattern.first[pattern.coupling[j]] + i - first
            state.couplings.lam[i] += work.matrix.rhs[z] / h2


@compiled
def relative_coupling_residual(
    system: System,
    motion: tuple[float, float],
    reach: float,
    at_rest: bool,
    state: State,
    work: Workspace,
) -> float:
    """The largest residual of constraints over the motion of the step, of laws over their terms."""
    couplings, out, tolerance = system.couplings, work.couplings, system.newton.tolerance
    length, angle = motion
    worst = 0.0
    for j in range(len(couplings.range) - 1):
        switching = couplings.contact_of[j] >= 0 or couplings.friction_of[j] >= 0
        for i in range(couplings.range[j], couplings.range[j + 1]):
            if couplings.compliant[i] and switching:
                scale, floor = _forces_beside(system, i, reach if at_rest else 0.0, work)
                if at_rest:
                    floor += law_rounding(system, i, couplings.range[j], reach, state, work)
                    floor += friction_rounding(couplings, j, i, reach, work)
                worst = max(worst, relative(out.phi[i], scale, floor, tolerance))
            elif couplings.compliant[i]:
                floor = SUM_ROUNDING * out.scale[i]
                if at_rest:
                    floor += law_rounding(system, i, couplings.range[j], reach, state, work)
                worst = max(worst, relative(out.phi[i], out.scale[i], floor, tolerance))
            else:
                is_length = measures_length(couplings.rows.kind[i])
                moved, size = term_scale(couplings, i, motion, reach, work)
                if is_angle(couplings.rows.kind[i]):
                    size += abs(out.coordinate[i])
                moved += length if is_length else angle
                size += reach if is_length else 1.0
                worst = max(worst, relative(out.phi[i], moved, SUM_ROUNDING * size, tolerance))
    return worst


@compiled
def _forces_beside(system: System, i: int, reach: float, work: Workspace) -> tuple[float, float]:
    """What the residual of a row that opens or slips is measured by, and its rounding: all forces
    on its bodies, for its own vanish, and those of a rounding of positions up to `reach`.
    """
    couplings, bodies, frames = system.couplings, system.bodies, system.frames
    length = measures_length(couplings.rows.kind[i])
    scale, inertia = work.couplings.scale[i], 0.0
    for f in (couplings.rows.frame_a[i], couplings.rows.frame_b[i]):
        b = frames.body[f]
        if b >= 0:
            scale = max(scale, work.bodies.force_scale[b, 0 if length else 1])
            J = bodies.J_rot[b]
            inertia = max(
                inertia, bodies.mass[b] * reach if length else J[0, 0] + J[1, 1] + J[2, 2]
            )
    if reach == 0.0:
        inertia = 0.0
    return scale, SUM_ROUNDING * (scale + system.scheme.beta_prime * inertia)


@compiled
def set_convective(system: System, state: State, work: Workspace) -> None:
    """The second time derivative of phi of all rows where no body accelerates, drives included.

    With the accelerations A of frames that are left then (centripetal ones) and the tangent H,
    c'' = gradient . A + V . H V; a drive s(t) adds -s'' to a length, and to the cosine of a turned
    axis s'' c_s + s'^2 c_ss + 2 s' d(c_s)/dt, where c_ss = -c.
    """
    couplings, out, frames = system.couplings, work.couplings, work.frames
    rows = couplings.rows
    for i in range(len(rows.kind)):
        f, g = rows.frame_a[i], rows.frame_b[i]
        _set_row_tangent(couplings, i, work)
        total = 0.0
        for k in range(12):
            V_k = frames.V[f, k] if k < 6 else frames.V[g, k - 6]
            A_k = frames.A[f, k] if k < 6 else frames.A[g, k - 6]
            total += out.gradient[i, k] * A_k
            for m in range(6):
                by_f, by_g = out.rate_tangent[k, m], out.rate_tangent[k, 6 + m]
                total += V_k * (by_f * frames.V[f, m] + by_g * frames.V[g, m])
        d = couplings.drive[i]
        if d >= 0 and rows.kind[i] == ATTITUDE:
            total += _convective_of_attitude(couplings, i, work)
        elif d >= 0:
            rate, acceleration = work.drives.rate[d], work.drives.acceleration[d]
            total += acceleration * work.drives.slope[d]
            if not _is_measured(rows.kind[i]):
                ahead = driven_angle(couplings, i, work) + 0.5 * math.pi
                evaluate_row(rows, i, ahead, 0.0, work, out.slope_gradient)
                slope_rate = 0.0
                for k in range(6):
                    slope_rate += out.slope_gradient[k] * frames.V[f, k]
                    slope_rate += out.slope_gradient[6 + k] * frames.V[g, k]
                total += 2.0 * rate * slope_rate - rate * rate * out.coordinate[i]
        out.convective[i] = total
    add_convective_terms(couplings, work)


@compiled
def _convective_of_attitude(couplings: Couplings, i: int, work: Workspace) -> float:
    """(D a'') . b + 2 d((D a') . b)/dt of the driven axis a(t) of row i, with a' held."""
    rows, drives, d = couplings.rows, work.drives, couplings.drive[i]
    f, g = rows.frame_a[i], rows.frame_b[i]
    total = 0.0
    for m in range(3):
        total += drives.acceleration[d + m] * drives.slope[d + m]
    rates = drives.rate[d], drives.rate[d + 1], drives.rate[d + 2]
    turning = rotate(work.frames.D, f, rates)
    normal = cross(turning, rotate(work.frames.D, g, row(rows.b, i)))
    for k in range(3):
        total += 2.0 * normal[k] * (work.frames.V[f, 3 + k] - work.frames.V[g, 3 + k])
    return total


@compiled
def add_coupling_work(couplings: Couplings, state: State, work: Workspace) -> None:
    """Work of springs, dampers and motors on the bodies, lambda dc, and of drives, -lambda dphi/ds
    ds.
    """
    out, old, drives = work.couplings, state.couplings, state.drives
    for j in range(len(couplings.range) - 1):
        for i in range(couplings.range[j], couplings.range[j + 1]):
            if couplings.compliant[i]:
                change = out.coordinate[i] - old.coordinate[i]
                # The mean force of the step, as of loads, so that all works add up in the balance.
                mean = 0.5 * (old.lam[i] + out.lam_n[i])
                m = couplings.laws.motor[i]
                if m >= 0:
                    state.motors.work[m] += mean * change
                    state.energies.work[0] += mean * change
                else:
                    state.energies.compliance[j] += mean * change
        if couplings.friction_of[j] >= 0:
            bend_bristle(couplings, j, couplings.range[j], state, work)
        if couplings.contact_of[j] >= 0:
            follow_contact(couplings, j, state, work)
        for i in range(couplings.range[j], couplings.range[j + 1]):
            old.coordinate[i] = out.coordinate[i]
            old.rate[i] = out.rate[i]
    for d in range(len(couplings.driven)):
        force, s = -old.lam[couplings.driven[d]] * work.drives.slope[d], work.drives.value[d]
        mean = 0.5 * (force + drives.force[d])
        state.energies.work[0] += mean * (s - drives.value[d])
        drives.force[d] = force
        drives.value[d] = s
    keep_terms(state, work)
