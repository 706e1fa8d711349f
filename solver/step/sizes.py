"""Changes between two sizes of steps: how a state goes on with steps of the other size.

Source: docs/theory.md, Two step sizes.
"""

from ..compiler.marks import compiled, differentiable, entry
from .records.bodies import BodyState
from .records.scheme import Scheme
from .system import State, System, Workspace


@differentiable
@entry
def change_size(old: System, new: System, state: State, work: Workspace) -> None:
    """Let a state go on with the steps of another system, which differs from the old in them alone.

    Positions, velocities and accelerations stay, and all loads. The pseudo-acceleration a, which
    lags behind the acceleration by a part of the step, begins anew: that of a body as its
    acceleration, with v + h (1/2 - alpha_f) (a - v') as its velocity, which the scheme changes by
    the mean of the forces alone; that of a mode as the share of its acceleration that a step of the
    new size keeps, so that modes which it does not resolve do not overshoot; that of what
    interfaces move by terms of second order as its acceleration.
    """
    _change_bodies(old.scheme, state.bodies)
    modes = new.elastic.modes
    for i in range(len(modes.step_stiffness)):
        kept = new.scheme.inertia_ratio / modes.step_stiffness[i]
        state.modes.a[i] = state.modes.acceleration[i] * kept
    for e in range(len(new.elastic.body)):
        _change_interfaces(new, e, state)
    work.matrix.current[0] = 0
    # Steps of another size have another compliance within the step.
    work.surfaces.W_count[:] = 0
    state.in_flight[0] = int(new.scheme.stride > 1)


@compiled
def _change_bodies(old: Scheme, bodies: BodyState) -> None:
    lag = old.h * (0.5 - old.alpha_f)
    for b in range(len(bodies.v)):
        for i in range(6):
            bodies.v[b, i] += lag * (bodies.a[b, i] - bodies.v_dot[b, i])
            bodies.a[b, i] = bodies.v_dot[b, i]


@compiled
def _change_interfaces(system: System, e: int, state: State) -> None:
    """Pseudo-accelerations of the interfaces of flexible body e: of its modes, and by its rates."""
    modes, interfaces = system.elastic.modes, state.interfaces
    first, m = modes.range[e], modes.range[e + 1] - modes.range[e]
    for i in range(system.elastic.dof[e + 1] - system.elastic.dof[e]):
        dof, start = system.elastic.dof[e] + i, modes.phi_start[e] + i * m
        a = acceleration = 0.0
        for k in range(m):
            a += modes.phi[start + k] * state.modes.a[first + k]
            acceleration += modes.phi[start + k] * state.modes.acceleration[first + k]
        by_rates = interfaces.acceleration[dof] - acceleration
        interfaces.a[dof] = a + (by_rates if system.elastic.second.r[e] > 0 else 0.0)
