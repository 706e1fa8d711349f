"""Second order of elastic motion: what fast rotation and large loads do to flexible bodies.

With z = [u; d], the displacements of the interfaces and the change of inertia, quadratic in r
coordinates q of the body,

    z = y_z + 1/2 A(q, q),  q = y_q,  y = history + G_0 pi,      pi = [p; s(omega); f_q]
    J = J_0 + mat(d),       Gamma = h(q, q'),       s(omega) . d = 1/2 omega . mat(d) omega
    f_q = (A q)^T [p; s] - omega' . h(q, .) - omega . (h(q', .) - h(., q')) - dW/dq

and in the moments of the body J' omega + Gamma' + omega x Gamma beside those of J. All of it
follows from one Lagrangian, 1/2 omega . J omega + omega . Gamma - W(q) beside the linear terms, so
that it creates no energy. z itself is the unknown of Newton's method, so that couplings and loads,
which act on z, are as without it; d and q stand behind the interface dofs of their body, in all
arrays.
Source: docs/theory.md, Fast rotation.
"""

from ..arrays import Array
from ..compiler.marks import compiled
from .bodies import spin_of
from .records.elastic import Elastic
from .rotations import tangent_inverse
from .system import State, System, Workspace
from .vectors import UNIT_AXES, Vector, cross, inner, triple

INERTIA_DOFS = 6
"""number of dofs d of inertia: changes of J_11, J_22, J_33, J_23, J_13, J_12"""


@compiled
def inertia_loads(omega: Vector) -> tuple[float, float, float, float, float, float]:
    """s(omega), which does work on d."""
    x, y, z = omega
    return 0.5 * x * x, 0.5 * y * y, 0.5 * z * z, y * z, x * z, x * y


@compiled
def inertia_product(d: Array, k: int, a: Vector) -> Vector:
    """mat(d) a, d being the six numbers from k on."""
    x, y, z = a
    return (
        d[k] * x + d[k + 5] * y + d[k + 4] * z,
        d[k + 5] * x + d[k + 1] * y + d[k + 3] * z,
        d[k + 4] * x + d[k + 3] * y + d[k + 2] * z,
    )


@compiled
def inertia_column(j: int, a: Vector) -> Vector:
    """Column j of L(a), for which L(a) d = mat(d) a, and which is the gradient of s_j at a."""
    x, y, z = a
    if j == 0:
        return x, 0.0, 0.0
    if j == 1:
        return 0.0, y, 0.0
    if j == 2:
        return 0.0, 0.0, z
    if j == 3:
        return 0.0, z, y
    if j == 4:
        return z, 0.0, x
    return y, x, 0.0


@compiled
def first_coordinate(elastic: Elastic, e: int) -> int:
    """The first dof of q; those of d are the six before."""
    return int(elastic.dof[e + 1] - elastic.second.r[e])


@compiled
def add_curvatures(elastic: Elastic, state: State, work: Workspace) -> None:
    """u += 1/2 A(q, q) on all dofs of interfaces and inertia, whose u is y so far.

    `slope` is that of the last evaluation, which q has all but met.
    """
    second, u = elastic.second, state.interfaces.u
    curvature, bend = work.second.curvature, work.second.bend
    for e in range(len(second.r)):
        r, first = second.r[e], first_coordinate(elastic, e)
        if r == 0:
            continue
        i = elastic.active_range[e]
        for k in range(elastic.dof[e], first):
            if elastic.active[i] == k:
                now = active_curvature(elastic, e, i, u, work)
                i += 1
            else:
                now = _curvature(elastic, e, k, u)
            # Loads do work on this part through f_q, so that `add_elastic_work` takes it off u.
            bend[k] = now - curvature[k]
            curvature[k] = now
            u[k] += now


@compiled
def start_curvatures(elastic: Elastic, state: State, work: Workspace) -> None:
    """1/2 A(q, q) of the state at the start."""
    for e in range(len(elastic.second.r)):
        if elastic.second.r[e]:
            for k in range(elastic.dof[e], first_coordinate(elastic, e)):
                work.second.curvature[k] = _curvature(elastic, e, k, state.interfaces.u)


@compiled
def _curvature(elastic: Elastic, e: int, k: int, u: Array) -> float:
    """1/2 A_k(q, q)"""
    r, first = elastic.second.r[e], first_coordinate(elastic, e)
    start, q = elastic.second.A_start[e] + (k - elastic.dof[e]) * r * r, u[first : first + r]
    total = 0.0
    for i in range(r):
        total += q[i] * inner(elastic.second.A[start + i * r : start + (i + 1) * r], q)
    return 0.5 * total


@compiled
def active_curvature(elastic: Elastic, e: int, i: int, u: Array, work: Workspace) -> float:
    """1/2 A(q, q) of active dof i of body e, with the slope at hand; 0 of the coordinates q."""
    second = elastic.second
    r, first = second.r[e], first_coordinate(elastic, e)
    if r == 0 or elastic.active[i] >= first:
        return 0.0
    row = second.row[e] + (i - elastic.active_range[e]) * r
    return 0.5 * inner(work.second.slope[row : row + r], u[first : first + r])


@compiled
def subtract_slopes(elastic: Elastic, e: int, work: Workspace, D: Array) -> None:
    """Derivatives D by y of the active dofs of body e become those by u = y + 1/2 A(q, q)."""
    r = elastic.second.r[e]
    n = elastic.active_range[e + 1] - elastic.active_range[e] - r
    if r:
        for i in range(n):
            slope = elastic.second.row[e] + i * r
            _add_scaled(-D[i], work.second.slope[slope : slope + r], D[n : n + r])


@compiled
def load_second_order(elastic: Elastic, state: State, work: Workspace) -> None:
    """pi behind the interface loads, with what the moments of the bodies need."""
    second = elastic.second
    for e in range(len(second.r)):
        if second.r[e]:
            _follow_inertia(elastic, e, state, work)
            _set_loads(elastic, e, state, work)


@compiled
def set_slopes(elastic: Elastic, state: State, work: Workspace) -> None:
    """`slope` = A q of all bodies."""
    second, u = elastic.second, state.interfaces.u
    work.second.slope[:] = 0.0
    for e in range(len(second.r)):
        if second.r[e]:
            q = u[first_coordinate(elastic, e) : elastic.dof[e + 1]]
            slope = work.second.slope[second.row[e] : second.row[e + 1]]
            _add_products(second.A_active, second.A_active_start[e], q, slope)


@compiled
def _add_products(A: Array, start: int, q: Array, out: Array) -> None:
    """out += sum_k q_k A_k, where A_k are as long as `out` and stand one after the other."""
    n = len(out)
    for k in range(len(q)):
        _add_scaled(q[k], A[start + k * n : start + (k + 1) * n], out)


@compiled
def _add_scaled(factor: float, source: Array, target: Array) -> None:
    for j in range(len(target)):
        target[j] += factor * source[j]


@compiled
def _follow_inertia(elastic: Elastic, e: int, state: State, work: Workspace) -> None:
    """J, Gamma and J' omega + Gamma' of the body, with h(q, .), h(q', .) and h(., q')."""
    second, b = elastic.second, elastic.body[e]
    r, first, start = second.r[e], first_coordinate(elastic, e), second.gyroscopic_start[e]
    rate = state.interfaces.rate[first : first + r]
    acceleration = state.interfaces.acceleration[first : first + r]
    at_q, at_rate = work.second.at_q[e, : 3 * r], work.second.at_rate[e, : 3 * r]
    by_rate = work.second.by_rate[e, : 3 * r]
    at_q[:] = 0.0
    at_rate[:] = 0.0
    by_rate[:] = 0.0
    _add_products(second.gyroscopic, start, state.interfaces.u[first : first + r], at_q)
    _add_products(second.gyroscopic, start, rate, at_rate)
    _add_products(second.turned, start, rate, by_rate)
    _set_inertia(elastic, e, state, work)
    turned = inertia_product(state.interfaces.rate, first - INERTIA_DOFS, spin_of(state, b))
    for i in range(3):
        work.bodies.relative_momentum[b, i] = inner(at_q[i * r : (i + 1) * r], rate)
        by_motion = inner(at_rate[i * r : (i + 1) * r], rate) + inner(
            at_q[i * r : (i + 1) * r], acceleration
        )
        work.bodies.relative_moment[b, i] = turned[i] + by_motion


@compiled
def _set_inertia(elastic: Elastic, e: int, state: State, work: Workspace) -> None:
    """J = J_0 + mat(d)"""
    d = first_coordinate(elastic, e) - INERTIA_DOFS
    J, J_0 = work.bodies.J[elastic.body[e]], elastic.second.J_0[e]
    for j in range(3):
        change = inertia_product(state.interfaces.u, d, UNIT_AXES[j])
        for i in range(3):
            J[i, j] = J_0[i, j] + change[i]


@compiled
def _set_loads(elastic: Elastic, e: int, state: State, work: Workspace) -> None:
    """s(omega) and f_q"""
    second, b, p = elastic.second, elastic.body[e], state.interfaces.p
    r, first, begin = second.r[e], first_coordinate(elastic, e), elastic.active_range[e]
    omega, v_dot = spin_of(state, b), state.bodies.v_dot
    loads = inertia_loads(omega)
    for j in range(INERTIA_DOFS):
        p[first - INERTIA_DOFS + j] = loads[j]
    out = p[first : first + r]
    at_q, at_rate, by_rate = work.second.at_q[e], work.second.at_rate[e], work.second.by_rate[e]
    for j in range(r):
        total = 0.0
        for i in range(3):
            k = i * r + j
            total -= v_dot[b, 3 + i] * at_q[k] + omega[i] * (at_rate[k] - by_rate[k])
        out[j] = total
    for i in range(elastic.active_range[e + 1] - begin - r):
        start = second.row[e] + i * r
        _add_scaled(p[elastic.active[begin + i]], work.second.slope[start : start + r], out)
    if second.stiff[e]:
        _subtract_hardening(elastic, e, state.interfaces.u[first : first + r], out)


@compiled
def _subtract_hardening(elastic: Elastic, e: int, q: Array, out: Array) -> None:
    """out -= dW/dq = cubic(q, q, .) / 2 + quartic(q, q, q, .) / 2"""
    second = elastic.second
    n = second.stiff[e]
    for i in range(n):
        for j in range(n):
            cubic = second.cubic_start[e] + (i * n + j) * n
            product = 0.5 * q[i] * q[j]
            _add_scaled(-product, second.cubic[cubic : cubic + n], out[:n])
            for k in range(n):
                quartic = second.quartic_start[e] + ((i * n + j) * n + k) * n
                _add_scaled(-product * q[k], second.quartic[quartic : quartic + n], out[:n])


@compiled
def hardening_energy(elastic: Elastic, e: int, u: Array) -> float:
    """W = cubic(q, q, q) / 6 + quartic(q, q, q, q) / 8 of the q in u."""
    second, total = elastic.second, 0.0
    n, q = second.stiff[e], u[first_coordinate(elastic, e) :]
    for i in range(n):
        for j in range(n):
            product = q[i] * q[j]
            for k in range(n):
                cubic = second.cubic[second.cubic_start[e] + (i * n + j) * n + k] / 6.0
                start = second.quartic_start[e] + ((i * n + j) * n + k) * n
                for m in range(n):
                    cubic += second.quartic[start + m] * q[m] / 8.0
                total += product * q[k] * cubic
    return total


@compiled
def add_second_order_residual(elastic: Elastic, state: State, work: Workspace) -> None:
    """Compatibility of z: 1/2 A(q, q) joins history + G_0 pi - z."""
    u, residual = state.interfaces.u, work.interfaces.residual
    for e in range(len(elastic.second.r)):
        for i in range(elastic.active_range[e], elastic.active_range[e + 1]):
            residual[i] += active_curvature(elastic, e, i, u, work)


@compiled
def inertia_taken(elastic: Elastic, e: int, state: State, work: Workspace) -> float:
    """The part of a moment of inertia that the elastic motion takes.

    The largest of 1 - pivot of (J - h(q, .) h(q, .)^T) / pivot of J_0, which a turn meets that q'
    follows freely; at 1 the kinetic energy is no longer positive.
    """
    J, J_0, r = work.bodies.J[elastic.body[e]], elastic.second.J_0[e], elastic.second.r[e]
    at_q, left = work.second.at_q[e], work.bodies.inertia
    for i in range(3):
        for j in range(3):
            # q has unit modal mass, so that this is the inertia that freely following q would
            # cancel.
            taken = inner(at_q[i * r : (i + 1) * r], at_q[j * r : (j + 1) * r])
            left[i, j] = J[i, j] - taken
    now, whole = _pivots(left), _pivots(J_0)
    return 1.0 - min(now[0] / whole[0], now[1] / whole[1], now[2] / whole[2])


@compiled
def _pivots(M: Array) -> Vector:
    """Those of the elimination of a symmetric matrix (3, 3)."""
    minor = M[0, 0] * M[1, 1] - M[0, 1] * M[1, 0]
    determinant = M[2, 2] * minor
    determinant += M[0, 2] * (M[1, 0] * M[2, 1] - M[1, 1] * M[2, 0])
    determinant -= M[1, 2] * (M[0, 0] * M[2, 1] - M[0, 1] * M[2, 0])
    return M[0, 0], minor / M[0, 0], determinant / minor


@compiled
def record_second_order(elastic: Elastic, state: State, out: Array) -> None:
    """The loads on q of all bodies, as forces where q is a length."""
    number = 0
    for e in range(len(elastic.second.r)):
        r, first = elastic.second.r[e], first_coordinate(elastic, e)
        begin = elastic.active_range[e + 1] - r
        for i in range(r):
            out[number] = state.interfaces.p[first + i] / elastic.length[begin + i]
            number += 1


# Newton's matrix


@compiled
def add_second_order_rows(system: System, state: State, work: Workspace) -> None:
    """The derivatives of s and f_q, in the rows of d and q, before they are weighed by -G_0."""
    elastic, pattern, S = system.elastic, system.pattern, work.matrix.S
    for m in range(len(pattern.force_block)):
        b, start = pattern.force_block[m, 0], pattern.force_block[m, 1]
        stride, width = pattern.force_block[m, 2], pattern.force_block[m, 3]
        e = elastic.of_body[b]
        if e < 0 or elastic.second.r[e] == 0:
            continue
        r, begin = elastic.second.r[e], elastic.active_range[e]
        n = elastic.active_range[e + 1] - begin - r
        # Derivatives by the body's own motion stand in its diagonal block alone.
        if start == pattern.body_block[b, 0]:
            _add_own_slopes(system, e, start + 6 * stride, stride, state, work)
        for i in range(n):
            source = start + (6 + i) * stride
            slope = elastic.second.row[e] + i * r
            for j in range(r):
                target = start + (6 + n + j) * stride
                factor = work.second.slope[slope + j]
                _add_scaled(factor, S[source : source + width], S[target : target + width])


@compiled
def _add_own_slopes(
    system: System, e: int, start: int, stride: int, state: State, work: Workspace
) -> None:
    """Derivatives of s and f_q by Theta, and of f_q by q where [p; s] does not change.

    start: the first row of active dofs in the diagonal block of the body.
    """
    elastic, scheme, S = system.elastic, system.scheme, work.matrix.S
    second, b, T = elastic.second, elastic.body[e], work.bodies.T_inverse
    r, n = second.r[e], elastic.active_range[e + 1] - elastic.active_range[e] - second.r[e]
    omega, v_dot = spin_of(state, b), state.bodies.v_dot
    tangent_inverse(work.bodies.psi[b], T)
    for j in range(INERTIA_DOFS):
        slope = inertia_column(j, omega)
        for i in range(3):
            turned = slope[0] * T[0, i] + slope[1] * T[1, i] + slope[2] * T[2, i]
            S[start + (n - INERTIA_DOFS + j) * stride + 3 + i] += scheme.gamma_prime * turned
    at_q, at_rate, by_rate = work.second.at_q[e], work.second.at_rate[e], work.second.by_rate[e]
    for j in range(r):
        target = start + (n + j) * stride
        for k in range(3):
            for i in range(3):
                change = scheme.gamma_prime * (at_rate[i * r + j] - by_rate[i * r + j])
                S[target + 3 + k] -= (scheme.beta_prime * at_q[i * r + j] + change) * T[i, k]
        for k in range(r):
            total = 0.0
            for i in range(3):
                h_kj = second.gyroscopic[second.gyroscopic_start[e] + (k * 3 + i) * r + j]
                h_jk = second.gyroscopic[second.gyroscopic_start[e] + (j * 3 + i) * r + k]
                total += v_dot[b, 3 + i] * h_kj + scheme.gamma_prime * omega[i] * (h_kj - h_jk)
            S[target + 6 + n + k] -= total
    p = state.interfaces.p
    for i in range(elastic.active_range[e], elastic.active_range[e + 1] - r):
        k = elastic.active[i]
        A = second.A_start[e] + (k - elastic.dof[e]) * r * r
        for j in range(r):
            target = start + (n + j) * stride + 6 + n
            _add_scaled(p[k], second.A[A + j * r : A + (j + 1) * r], S[target : target + r])
    if second.stiff[e]:
        q = state.interfaces.u[first_coordinate(elastic, e) :]
        _subtract_hardening_slope(elastic, e, q, S, (start + n * stride + 6 + n, stride))


@compiled
def _subtract_hardening_slope(
    elastic: Elastic, e: int, q: Array, S: Array, block: tuple[int, int]
) -> None:
    """S -= d2W/dq2 = cubic(q, ., .) + 3/2 quartic(q, q, ., .), at the block of q."""
    second, n = elastic.second, elastic.second.stiff[e]
    for i in range(n):
        for j in range(n):
            target = block[0] + j * block[1]
            cubic = second.cubic_start[e] + (i * n + j) * n
            _add_scaled(-q[i], second.cubic[cubic : cubic + n], S[target : target + n])
            for k in range(n):
                quartic = second.quartic_start[e] + ((i * n + k) * n + j) * n
                factor = -1.5 * q[i] * q[k]
                _add_scaled(factor, second.quartic[quartic : quartic + n], S[target : target + n])


@compiled
def add_second_order_tangent(system: System, state: State, work: Workspace) -> None:
    """-A q in the rows of z, and the derivatives of the moments by d and q, times h^2."""
    elastic, pattern = system.elastic, system.pattern
    for e in range(len(elastic.second.r)):
        if elastic.second.r[e]:
            block = pattern.body_block[elastic.body[e]]
            _add_compatibility_slopes(elastic, e, block, work)
            _add_moment_slopes(system, e, block, state, work)


@compiled
def _add_compatibility_slopes(elastic: Elastic, e: int, block: Array, work: Workspace) -> None:
    second, S = elastic.second, work.matrix.S
    r, begin = second.r[e], elastic.active_range[e]
    n = elastic.active_range[e + 1] - begin - r
    for i in range(n):
        target = block[0] + (6 + i) * block[1] + 6 + n
        slope = second.row[e] + i * r
        _add_scaled(-1.0, work.second.slope[slope : slope + r], S[target : target + r])


@compiled
def _add_moment_slopes(system: System, e: int, block: Array, state: State, work: Workspace) -> None:
    elastic, scheme, S = system.elastic, system.scheme, work.matrix.S
    second, b = elastic.second, elastic.body[e]
    r, n = second.r[e], elastic.active_range[e + 1] - elastic.active_range[e] - second.r[e]
    h2, slope, curvature = scheme.h * scheme.h, scheme.gamma_prime, scheme.beta_prime
    omega, turning = spin_of(state, b), triple(state.bodies.v_dot[b], 3)
    T, d = work.bodies.T_inverse, first_coordinate(elastic, e) - INERTIA_DOFS
    tangent_inverse(work.bodies.psi[b], T)
    first = block[0] + 3 * block[1] + 6
    for j in range(3):
        turned = inertia_product(state.interfaces.rate, d, (T[0, j], T[1, j], T[2, j]))
        for i in range(3):
            S[first + i * block[1] - 3 + j] += h2 * slope * turned[i]
    for j in range(INERTIA_DOFS):
        still, moved = inertia_column(j, turning), inertia_column(j, omega)
        turned = cross(omega, moved)
        for i in range(3):
            total = still[i] + slope * moved[i] + turned[i]
            S[first + i * block[1] + n - INERTIA_DOFS + j] += h2 * total
    at_q, at_rate, by_rate = work.second.at_q[e], work.second.at_rate[e], work.second.by_rate[e]
    coordinate = first_coordinate(elastic, e)
    acceleration = state.interfaces.acceleration[coordinate : coordinate + r]
    for k in range(r):
        momentum = (
            by_rate[k] + slope * at_q[k],
            by_rate[r + k] + slope * at_q[r + k],
            by_rate[2 * r + k] + slope * at_q[2 * r + k],
        )
        turned = cross(omega, momentum)
        for i in range(3):
            start, z = second.gyroscopic_start[e] + (k * 3 + i) * r, i * r + k
            total = turned[i] + slope * (by_rate[z] + at_rate[z]) + curvature * at_q[z]
            total += inner(second.gyroscopic[start : start + r], acceleration)
            S[first + i * block[1] + n + k] += h2 * total
