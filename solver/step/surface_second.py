"""Second order of the nodes of surfaces, as of interfaces (second_order.py).

    u_C = y_C + 1/2 A_C(q, q),      f_q = (A q)^T [p; s] + (A_C q)^T f + ...

y_C: displacements of first order (surface_motion.py); f: forces of contacts on the nodes, which do
work on q by the slopes S = A_C q. Source: docs/theory.md, Contact of surfaces.
"""

from ..arrays import Array
from ..compiler.marks import compiled, of_surfaces
from .second_order import first_coordinate
from .system import State, System, Workspace
from .vectors import Vector, inner


@compiled
def set_node_slopes(system: System, s: int, state: State, work: Workspace) -> None:
    """S of the nodes of body s."""
    bodies, elastic = system.surfaces.bodies, system.elastic
    e = bodies.flexible[s]
    r, first = elastic.second.r[e], first_coordinate(elastic, e)
    if r == 0:
        return
    # Kept for the whole evaluation: gaps, loads on q and their derivatives all need them.
    q, A = state.interfaces.u[first : first + r], bodies.A[bodies.A_start[s] :]
    for i in range(bodies.slope[s], bodies.slope[s + 1]):
        place = (i - bodies.slope[s]) * r
        work.surfaces.slope[i] = inner(A[place : place + r], q)


@compiled
def node_curvature(system: System, s: int, k: int, x: int, state: State, work: Workspace) -> float:
    """1/2 A(q, q) of node k of body s along axis x, with the slopes at hand."""
    elastic, place = system.elastic, _place(system, s, k, x)
    e = system.surfaces.bodies.flexible[s]
    r, first = elastic.second.r[e], first_coordinate(elastic, e)
    if r == 0:
        return 0.0
    slope = work.surfaces.slope[place : place + r]
    return 0.5 * inner(slope, state.interfaces.u[first : first + r])


@compiled
def _place(system: System, s: int, k: int, x: int) -> int:
    """The first slope of node k of body s along axis x."""
    bodies = system.surfaces.bodies
    row = 3 * (k - bodies.node[s]) + x
    return int(bodies.slope[s] + row * system.elastic.second.r[bodies.flexible[s]])


@of_surfaces
@compiled
def load_coordinates(system: System, state: State, work: Workspace) -> None:
    """f_q += S^T f of all bodies that contacts press."""
    surfaces, elastic = system.surfaces, system.elastic
    if len(surfaces.contacts.patch) == 0 or work.surfaces.looks[0] < 0:
        return
    for s in range(len(surfaces.bodies.flexible)):
        e = surfaces.bodies.flexible[s]
        # A body that sleeps has no forces, and the slopes of an earlier step.
        if elastic.second.r[e] == 0 or not work.surfaces.awake[s]:
            continue
        loads = state.interfaces.p[first_coordinate(elastic, e) : elastic.dof[e + 1]]
        for k in range(surfaces.bodies.node[s], surfaces.bodies.node[s + 1]):
            f = state.surfaces.load
            add_slopes(system, s, k, (f[k, 0], f[k, 1], f[k, 2]), loads, work)


@compiled
def add_slopes(system: System, s: int, k: int, b: Vector, out: Array, work: Workspace) -> None:
    """out (r,) += S^T b of node k of body s."""
    r = system.elastic.second.r[system.surfaces.bodies.flexible[s]]
    for x in range(3):
        if r > 0 and b[x] != 0.0:
            place = _place(system, s, k, x)
            for j in range(r):
                out[j] += b[x] * work.surfaces.slope[place + j]


@of_surfaces
@compiled
def add_node_curvature_slopes(system: System, state: State, work: Workspace) -> None:
    """The derivatives of S^T f by q where f does not change, in the rows of q."""
    surfaces, elastic, S = system.surfaces, system.elastic, work.matrix.S
    bodies = surfaces.bodies
    if len(surfaces.contacts.patch) == 0 or work.surfaces.looks[0] < 0:
        return
    for s in range(len(bodies.flexible)):
        e = bodies.flexible[s]
        r = elastic.second.r[e]
        if r == 0 or not work.surfaces.awake[s]:
            continue
        block = system.pattern.body_block[elastic.body[e]]
        n = elastic.active_range[e + 1] - elastic.active_range[e] - r
        # The block of q, behind rigid coordinates, interfaces and changes of inertia.
        first, stride = block[0] + (6 + n) * block[1] + 6 + n, block[1]
        for k in range(bodies.node[s], bodies.node[s + 1]):
            for x in range(3):
                f = state.surfaces.load[k, x]
                if f == 0.0:
                    continue
                # The matrix of A at this displacement, of which S is the product with q.
                A = bodies.A_start[s] + (3 * (k - bodies.node[s]) + x) * r * r
                for i in range(r):
                    for j in range(r):
                        S[first + i * stride + j] += f * bodies.A[A + i * r + j]
