"""Equilibrium, static or in steady rotation, of bodies, interfaces and multipliers together.

    f_r(x, R, u, lambda) = J v_dot + v~ J v,     phi = 0,     u = compliance p + 1/2 A(q, q)

where u and p are those of inertia and of q too, for bodies with terms of second order; with all
velocities zero, or those of a steady rotation as the scheme steps it (steady.py): omega =
R^T Omega, omega' = 0, v and v_dot multiples of x - c. Solved by pseudo-transient continuation:
implicit steps of the gradient flow M dq/dtau = f, which grow as the residual falls until they are
Newton's. The flow runs down the potential, so that it tends to stable equilibria; but bodies that
start in an unstable one, as straight columns beyond their buckling loads, stay there, without a
message.
"""

import numpy as np
from numpy.lib.stride_tricks import as_strided

from ..arrays import Array, Index, as_index
from ..errors import ModelError
from ..history.layout import active_flexibility
from ..lower.lower import LoweredModel
from ..step.bodies import largest_coordinate
from ..step.elimination import factorize
from ..step.equations import assemble, evaluate, linearize, set_force_scales
from ..step.force_laws import law_rounding
from ..step.measure import SUM_ROUNDING
from ..step.newton import correct
from ..step.records.elastic import Elastic
from ..step.second_order import INERTIA_DOFS, inertia_column
from ..step.surface_rest import end_search_step
from ..step.surfaces import await_contacts
from ..step.system import State, System, Workspace
from .assembly import follow_turns
from .pressed import change_sides, follow_loads_at_rest, rounding_of_surfaces, without_speeds
from .residuals import NO_FORCE, largest_forces, relative_residuals
from .servos import Holding
from .spins import check_spins
from .steady import SteadyMotion
from .steady_checks import check_steady
from .unbalanced import causes, free_groups

MAX_ITERATIONS = 400
# largest residual, relative to forces and to the size of the model
EQUILIBRIUM_TOLERANCE = 1e-12
# where rounding allows no better
ACCEPTED_RESIDUAL = 1e-9
FIRST_STEP = 0.05
"""length of the first step, relative to the size of the model"""
LEAST_SHARE = 1e-3
"""of all forces, that the first step is taken under at least"""
MAX_RISE, SMALL_RESIDUAL, REMEMBERED = 4.0, 1e-3, 8
"""by how much the residual may rise above the largest of those remembered, unless it is small"""
TIPPING_RISE = 1.1
"""of the residual in a step, with surfaces in contact, that does not count as one"""
MAX_CAUTION = 8.0
"""steps with a rising residual that are remembered: from six on the inertia does not fall"""
# steps without progress after which the residual may be taken for rounding
IDLE_STEPS = 5
MAX_CORRECTIONS, SMALL_CORRECTION = 30, 1e-10
"""of an implicit step with surfaces in contact: how many, and which, over its way, is the last"""
NEGLIGIBLE_WAY = 4.0
"""in roundings of positions: corrections and depths that count as none"""
MAX_SIDES = 10
"""times that rows of surfaces change sides between two steps"""
LARGEST_WAY = 1.0
"""by which a body may move or turn in a step, relative to the size of the model"""
# of a step that no longer moves anything; the next power would overflow
MAX_INERTIA = 1e200
DETOUR, MAX_DETOURS = 1.3, 10
"""by how much the inertia grows where it meets a centrifugal stiffness, and how often"""


def solve_equilibrium(
    lowered: LoweredModel,
    motion: SteadyMotion | None,
    state: State,
    work: Workspace,
) -> System:
    """Bring a state into equilibrium, at rest or in steady rotation; ModelError if none is found.

    Changes positions, elastic displacements and multipliers, and sets the velocities and
    accelerations of the rotation. Returns the system that is at rest, with static compliances.
    """
    search = _Search(lowered, motion, state, work)
    check_spins(lowered, work)
    if reason := search.find():
        # the more specific message, as of a damper that cannot turn
        check_steady(lowered, motion, work)
        raise _failure(lowered, reason, state, work)
    return search.system


class _Search:
    """The search for an equilibrium: its residual and its implicit steps."""

    def __init__(
        self, lowered: LoweredModel, motion: SteadyMotion | None, state: State, work: Workspace
    ) -> None:
        self.system, self.lengths = _at_rest(lowered), lowered.measures_lengths
        self.motion, self.state, self.work = motion, state, work
        self.free = free_groups(self.system)
        self.pressed = bool(lowered.model.surface_contacts)
        work.surfaces.held[:] = 1
        self.way, self.settled = 0.0, True
        self.passable, self.half_shapes = _passable(lowered)
        work.interfaces.history[:] = 0.0
        work.interfaces.rate_predicted[:] = 0.0
        self._evaluate()
        self.holding = Holding(self.system, self.lengths, *largest_forces(self.system, work))

    def saved(self) -> list[Array | Index]:
        return [array.copy() for array in self._carried()]

    def restore(self, saved: list[Array | Index]) -> None:
        for array, old in zip(self._carried(), saved, strict=True):
            array[:] = old
        self.work.bodies.quaternion_n[:] = self.state.bodies.quaternion
        self._evaluate()

    def _carried(self) -> list[Array | Index]:
        return [*self.state.arrays(), self.work.surfaces.closed]

    def find(self) -> str:
        """The equilibrium in which motors with an integral are at their references.

        With surfaces in contact first one in which all that touches sticks, and from there the one
        in which friction obeys its law.
        """
        reason = self._find_holding()
        self.work.surfaces.held[:] = 0
        if self.pressed and not reason:
            self._evaluate()
            reason = self.flow()
        return reason

    def _find_holding(self) -> str:
        # Motors with integrals have no stiffness of their own at rest: stiff springs stand for
        # them, whose forces go over into the integrals.
        exact, self.system = self.system, self.holding.stiffened(self.system)
        for _ in range(MAX_ITERATIONS):
            self._evaluate()
            if reason := self.flow():
                return reason
            if self.holding.take_over(self.state, self.work):
                self.system = exact
                self._evaluate()
                return ""
        return "a motor cannot reach its reference"

    def flow(self) -> str:
        """Pseudo-transient continuation; why it found no equilibrium, "" if it found one.

        A step may raise the residual, as those do in which contacts open and close; but not above
        all of the last ones, and where steps often do, they become shorter. Nor may it move bodies
        farther than its equations tell, by the size of the model or through one another: residuals
        are relative to forces, which are large where bodies are thrown about. Steps much shorter
        than a first one grow, however slowly the residual falls.
        """
        # beta: the inertia of an implicit step, 1 over its length in the flow; it falls as the
        # residual does, until steps are Newton's.
        beta, residual, size = self._first_inertia(), self._residual(), self.system.bodies.size
        best, nearest, recent = residual, self.saved(), [residual]
        caution, idle, singular = 0.0, 0, 0
        for _ in range(MAX_ITERATIONS):
            if residual <= EQUILIBRIUM_TOLERANCE:
                return ""
            if idle > IDLE_STEPS and (best <= ACCEPTED_RESIDUAL or self._is_rounding()):
                self.restore(nearest)
                return ""
            saved, balls = self.saved(), self._balls()
            # Centrifugal stiffness is negative: some inertia makes the matrix singular, another
            # does not.
            if not self._step(beta):
                singular, beta = singular + 1, DETOUR * beta
                if singular > MAX_DETOURS:
                    return "the equations are singular"
                continue
            previous, residual = residual, self._residual()
            astray = self.way > LARGEST_WAY * size or self._has_passed(balls) or not self.settled
            if astray or not residual < MAX_RISE * max(*recent, SMALL_RESIDUAL):
                # The step is taken back and repeated with ten times the inertia.
                self.restore(saved)
                residual, beta, idle = previous, min(10.0 * beta, MAX_INERTIA), idle + 1
                continue
            # What slides or tips over on a surface goes a long way at forces that hardly change.
            rises = residual > (TIPPING_RISE if self.pressed else 1.0) * previous
            caution = min(caution + 1.0, MAX_CAUTION) if rises else max(caution - 0.25, 0.0)
            change = residual / previous
            if not rises:
                # Steps much shorter than a first one grow, however slowly the residual falls.
                change = min(change, self.way / (FIRST_STEP * size))
            # Rising residuals of late bound how fast the inertia may fall.
            beta *= np.clip(change, min(1.0, 0.1 * 1.5**caution), 2.0)
            self._continue_angles()
            idle = 0 if residual < 0.5 * best else idle + 1
            if residual < best:
                best, nearest = residual, self.saved()
            recent = [*recent, residual][-REMEMBERED:]
        return f"relative residual {best:.3e} after {MAX_ITERATIONS} steps"

    def _balls(self) -> tuple[Array, Array]:
        """Where balls are from the shapes that they may pass (k, 3), and how far they may go (k,).

        That is half into the shape: beyond its middle the contact would push to the other side.
        """
        rows, r = self.system.couplings.rows, self.work.frames.r
        places = r[rows.frame_b[self.passable]] - r[rows.frame_a[self.passable]]
        return places, np.abs(self.work.couplings.coordinate[self.passable]) + self.half_shapes

    def _has_passed(self, balls: tuple[Array, Array]) -> bool:
        """Whether a ball has gone farther than it may, from where it was."""
        places, room = balls
        return bool((np.linalg.norm(self._balls()[0] - places, axis=1) > room).any())

    def _first_inertia(self) -> float:
        """The inertia of a first step of `FIRST_STEP`, under the forces that are out of balance.

        Or under a share of all forces, the centrifugal ones too, where that is more: with hardly
        any inertia the pivots of bodies, which are eliminated before their joints, would be
        rounding alone. A body that turns about its center, and that nothing holds, has no others.
        """
        system, (rounding, _) = self.system, self._law_rounding()
        forces, _ = largest_forces(system, self.work, (rounding / ACCEPTED_RESIDUAL, 0.0))
        loads = forces / float(system.bodies.mass.sum()) if forces > NO_FORCE else 0.0
        speed = 0.0 if self.motion is None else self.motion.speed
        least = LEAST_SHARE * (loads + speed**2 * system.bodies.size)
        pull = max(_accelerations(system, self.work), least)
        return pull / (FIRST_STEP * system.bodies.size) if pull > 0.0 else 1.0

    def _continue_angles(self) -> None:
        """Let the angles of constraints, and those that motors act on, go on over full turns."""
        follow_turns(self.system, self.work)
        rows, work = self.system.couplings.laws.motors.row, self.work.couplings
        work.near[rows] = work.coordinate[rows]

    def _step(self, beta: float) -> bool:
        """One implicit step of the flow; False where its equations are singular."""
        system, state, work = _stiffened(self.system, beta), self.state, self.work
        self.way = 0.0
        # One correction, but with surfaces in contact the step is solved for as one of time, for
        # what is exact closes and opens within it.
        for k in range(MAX_CORRECTIONS):
            linearize(system, state, work)
            assemble(system, state, work)
            # The motion is imposed anew by the next step alone.
            if self.motion is not None and k == 0:
                _add_centrifugal(system, self.motion, state, work)
            if not factorize(system.pattern, work.matrix.S, work.matrix.pivots):
                return False
            way = correct(system, state, work)
            self.way += way
            if not self.pressed:
                break
            evaluate(system, state, work)
            small = max(SMALL_CORRECTION * self.way, self._rounding_of_ways())
            self.settled = not self._change_sides() and not way > small
            if self.settled:
                break
            evaluate(system, state, work)
        # Each step begins a new increment: psi counts from here.
        work.bodies.quaternion_n[:] = state.bodies.quaternion
        work.bodies.psi[:] = 0.0
        self._evaluate()
        self._center()
        return True

    def _center(self) -> None:
        """Shift bodies that turn freely, as one, across the axis to where their forces balance.

        The centrifugal force pulls a center of mass away from the axis, so that the flow would
        leave the equilibrium of such bodies.
        """
        if self.motion is None or not self.free:
            return
        for group in self.free:
            force = self.work.bodies.residual[group, :3].sum(axis=0)
            masses = self.system.bodies.mass[group]
            weight = np.tensordot(masses, self.motion.acceleration[group], 1)
            # The centrifugal stiffness is that of the group's mass; along the axis it is zero,
            # hence pinv.
            self.state.bodies.x[group] -= np.linalg.pinv(weight) @ force
        self._evaluate()

    def _evaluate(self) -> None:
        """Residuals and the scales of forces at the positions of the state."""
        _move(self.motion, self.state)
        if self.pressed:
            end_search_step(self.system, self.state, self.work)
            await_contacts(self.system, self.work)
        evaluate(self.system, self.state, self.work)
        for _ in range(MAX_SIDES):
            if not self._change_sides():
                break
            evaluate(self.system, self.state, self.work)
        set_force_scales(self.system, self.state, self.work)

    def _change_sides(self) -> bool:
        if not self.work.surfaces.held[0]:
            return False
        return change_sides(self._rounding_of_ways(), self.state, self.work)

    def _rounding_of_ways(self) -> float:
        """What positions are rounded by, and so what of a correction or a gap is none [m]."""
        return NEGLIGIBLE_WAY * SUM_ROUNDING * largest_coordinate(self.system.bodies, self.state)

    def _residual(self, least: tuple[float, float] = (0.0, 0.0), opening: float = 0.0) -> float:
        parts = relative_residuals(self.system, self.lengths, self.state, self.work, least, opening)
        return max(float(values.max(initial=0.0)) for values in parts)

    def _is_rounding(self) -> bool:
        """Whether all that is left are openings and forces of laws by the rounding of positions.

        So it is where nothing is loaded: there forces are rounding, and so is what is left of them;
        and far from the origin, where no joint closes better than coordinates are rounded.
        """
        force, moment = self._law_rounding()
        size, reach = self.system.bodies.size, largest_coordinate(self.system.bodies, self.state)
        floors = (
            (force + moment / size) / EQUILIBRIUM_TOLERANCE,
            (moment + force * size) / EQUILIBRIUM_TOLERANCE,
        )
        return (
            self._residual(floors, SUM_ROUNDING * reach / EQUILIBRIUM_TOLERANCE)
            <= EQUILIBRIUM_TOLERANCE
        )

    def _law_rounding(self) -> tuple[float, float]:
        """The largest force and moment of a law by the rounding of positions."""
        couplings, reach = self.system.couplings, largest_coordinate(self.system.bodies, self.state)
        first = np.repeat(couplings.range[:-1], np.diff(couplings.range)).tolist()
        rounded = np.zeros(len(first))
        for i in np.flatnonzero(couplings.compliant).tolist():
            rounded[i] = law_rounding(self.system, i, first[i], reach, self.state, self.work)
        lengths = self.lengths
        by_surfaces = rounding_of_surfaces(self.system, reach, self.work)
        return float(rounded[lengths].max(initial=by_surfaces)), float(
            rounded[~lengths].max(initial=0.0)
        )


def _passable(lowered: LoweredModel) -> tuple[Index, Array]:
    """The gaps, by row, of balls that may pass through a shape, and half the size of both (k,)."""
    couplings, found = lowered.system.couplings, []
    for j in couplings.contact.tolist():
        row = int(couplings.range[j])
        size = float(couplings.rows.size[row])
        if np.isfinite(size):
            found.append((row, 0.5 * size))
    return as_index([row for row, _ in found]), np.array([half for _, half in found])


def _at_rest(lowered: LoweredModel) -> System:
    """The system with static compliances in place of instantaneous ones."""
    elastic = lowered.system.elastic
    G_0 = elastic.G_0.copy()
    for e, compliance in enumerate(lowered.responses.compliances):
        start = elastic.G_0_start[e]
        G_0[start : start + compliance.size] = compliance.ravel()
    G_active, _ = active_flexibility(
        lowered.responses.compliances, elastic.active, elastic.active_range, elastic.dof, 1.0
    )
    # Without inertia and damping the step's equations are those of statics: no code of its own.
    scheme = lowered.system.scheme.replace(weight=1.0, gamma_prime=0.0, beta_prime=0.0)
    elastic = follow_loads_at_rest(elastic, scheme)
    # what is gyroscopic belongs to rates of q
    none = np.zeros_like(elastic.second.gyroscopic)
    second = elastic.second.replace(gyroscopic=none, turned=none)
    return lowered.system.replace(
        scheme=scheme,
        elastic=elastic.replace(G_0=G_0, G_active=G_active, second=second),
        surfaces=without_speeds(lowered.surfaces_of(elastic)),
    )


def _stiffened(system: System, beta: float) -> System:
    """The system with the inertia of an implicit step of the gradient flow: beta J on dq."""
    # The flow has no time: any h will do that keeps the matrix well scaled.
    return system.replace(scheme=system.scheme.replace(beta_prime=beta, h=0.01))


def _move(motion: SteadyMotion | None, state: State) -> None:
    state.bodies.v[:] = 0.0
    state.bodies.v_dot[:] = 0.0
    state.bodies.a[:] = 0.0
    if motion is not None:
        motion.impose(state)


def _add_centrifugal(system: System, motion: SteadyMotion, state: State, work: Workspace) -> None:
    """S += h^2 d(J v_dot + v~ J v) where v_dot follows x, and omega = R^T Omega follows R.

    And -G_0 d(s, f_q) in the rows of elastic dofs, since s follows omega.
    """
    h2, itemsize = system.scheme.h**2, work.matrix.S.itemsize
    for b, (mass, J) in enumerate(zip(system.bodies.mass, work.bodies.J, strict=True)):
        omega, R = state.bodies.v[b, 3:], state.bodies.R[b]
        start, stride = system.pattern.body_block[b]
        n = int(system.pattern.size[system.pattern.body[b]])
        block = as_strided(work.matrix.S[start:], (n, 6), (stride * itemsize, itemsize))
        # Rows of equilibrium are scaled by h^2, as in the time step.
        block[:3, :3] += h2 * mass * R.T @ motion.acceleration[b] @ R
        block[3:6, 3:] += h2 * (_skew(omega) @ J - _skew(J @ omega)) @ _skew(omega)
        e = int(system.elastic.of_body[b])
        if e >= 0 and system.elastic.second.r[e]:
            block[6:, 3:] -= _centrifugal_slopes(system.elastic, e, omega, work) @ _skew(omega)


def _centrifugal_slopes(elastic: Elastic, e: int, omega: Array, work: Workspace) -> Array:
    """G_0 d(p, s, f_q) / d omega of the active dofs of a body with terms of second order (n, 3)."""
    r, n = int(elastic.second.r[e]), int(np.diff(elastic.active_range)[e])
    slopes = np.zeros((n, 3))
    by_omega = np.array([inertia_column(j, tuple(omega)) for j in range(INERTIA_DOFS)])
    slopes[n - r - INERTIA_DOFS : n - r] = by_omega
    last = int(elastic.second.row[e + 1])
    slopes[n - r :] = (
        work.second.slope[last - INERTIA_DOFS * r : last].reshape(INERTIA_DOFS, r).T @ by_omega
    )
    first = int(elastic.G_active_start[e])
    by_loads: Array = elastic.G_active[first : first + n * n].reshape(n, n) @ slopes
    return by_loads


def _failure(lowered: LoweredModel, reason: str, state: State, work: Workspace) -> ModelError:
    """The error where no equilibrium was found: the reason, and the largest residual."""
    forces, moments, rows, dofs = relative_residuals(
        lowered.system, lowered.measures_lengths, state, work
    )
    bodies = np.maximum(forces, moments)
    elastic = lowered.system.elastic
    for e, b in enumerate(elastic.body.tolist()):
        bodies[b] = max(
            bodies[b], dofs[elastic.active_range[e] : elastic.active_range[e + 1]].max(initial=0.0)
        )
    worst = f"body {lowered.body_names[int(np.argmax(bodies))]!r}"
    # A joint that stays open says more than the bodies that it pulls.
    if rows.max(initial=0.0) > bodies.max():
        worst = lowered.owner_of(int(np.argmax(rows)))
    return ModelError(
        f"start = 'equilibrium': none found, {reason}; the largest residual is that of {worst}. "
        f"In the last state: {causes(lowered, state, work)}"
    )


def _accelerations(system: System, work: Workspace) -> float:
    inertia = np.trace(system.bodies.J_rot, axis1=1, axis2=2)
    linear = np.abs(work.bodies.residual[:, :3]).max(axis=1) / system.bodies.mass
    return float(
        max(linear.max(), (np.abs(work.bodies.residual[:, 3:]).max(axis=1) / inertia).max() * 1e-3)
    )


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
