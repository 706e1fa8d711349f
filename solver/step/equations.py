"""The equations of a time step: residuals, tangent and convective terms.

    r_eq = J v_dot + v~ J v - f_r = 0       equilibrium of every body (bodies.py)
    phi(x, R, u, lambda, t) = 0             constraints and force laws (couplings.py)
    r_u  = history + w G_0 p - u = 0        displacements of active dofs (interfaces.py)

Each contributor has a file of its own, with its residual, tangent, convective term and energies;
here they are called in turn. Source: docs/theory.md, Impulse responses and The time step.
"""

from ..compiler.marks import compiled, entry
from .bodies import (
    add_inertia,
    add_inertia_forces,
    relative_body_residual,
    set_inertia_scales,
    step_motion,
)
from .couplings import (
    add_coupling_scales,
    add_coupling_wrenches,
    assemble_rows,
    linearize_couplings,
    relative_coupling_residual,
    set_convective,
)
from .frames import (
    add_frame_tangents,
    load_bodies,
    map_frame_velocities,
    move_frame_accelerations,
    move_frame_velocities,
    move_frames,
)
from .interfaces import relative_interface_residual, set_compatibility, set_rates, weigh_forces
from .loads import add_load_scales, add_load_wrenches, linearize_loads
from .patterns import (
    add_pattern_displacements,
    add_pattern_scales,
    add_pattern_tangents,
    load_patterns,
)
from .second_order import (
    add_second_order_residual,
    add_second_order_rows,
    add_second_order_tangent,
    load_second_order,
    set_slopes,
)
from .surface_motion import load_surface_bodies
from .surface_second import add_node_curvature_slopes, load_coordinates
from .surfaces import add_surface_scales, add_surface_tangents, press_surfaces
from .system import State, System, Workspace


@entry
def evaluate(system: System, state: State, work: Workspace) -> None:
    """Wrenches, generalized forces and residuals of the present state."""
    frames = system.frames
    # The order matters: frames need rates, couplings need frames, bodies need all wrenches.
    set_rates(system.elastic, system.scheme, state, work)
    # Contacts of surfaces need them before the loads of second order do.
    set_slopes(system.elastic, state, work)
    move_frames(frames, frames.n_acting, state, work)
    move_frame_velocities(frames, frames.n_acting, state, work)
    work.frames.wrench[:] = 0.0
    add_load_wrenches(system.loads, work)
    add_coupling_wrenches(system.couplings, state, work)
    press_surfaces(system, state, work)
    load_bodies(frames, state, work)
    load_surface_bodies(system, state, work)
    load_patterns(system.patterns, state, work)
    load_second_order(system.elastic, state, work)
    load_coordinates(system, state, work)
    add_inertia_forces(system.bodies, state, work)
    set_compatibility(system.elastic, state, work)
    add_pattern_displacements(system.elastic, system.scheme, system.patterns, work)
    add_second_order_residual(system.elastic, state, work)


@entry
def linearize(system: System, state: State, work: Workspace) -> None:
    """B and A of all rows, and K alone in the matrix, at the state of the last `evaluate`."""
    frames, pattern = system.frames, system.pattern
    # Force laws, forbidden slip and drag alone depend on velocities.
    if system.couplings.n_by_rate or system.loads.n_by_velocity:
        map_frame_velocities(frames, system.scheme.gamma_prime, state, work)
    work.matrix.S[:] = 0.0
    add_frame_tangents(frames, pattern, state, work)
    linearize_couplings(system, state, work)
    linearize_loads(system, state, work)
    add_pattern_tangents(system, work)
    add_surface_tangents(system, work)


@entry
def assemble(system: System, state: State, work: Workspace) -> None:
    """The iteration matrix from K, B and A."""
    assemble_rows(system, work)
    add_second_order_rows(system, state, work)
    # After the rows of q have theirs from the loads on interfaces: those of contacts are no such.
    add_node_curvature_slopes(system, state, work)
    # After all forces, whose rows it weighs, and before the inertia, which is added as it is.
    weigh_forces(system, work)
    add_inertia(system, state, work)
    add_second_order_tangent(system, state, work)


@entry
def convective_terms(system: System, state: State, work: Workspace) -> None:
    """The second derivatives of all constraints where no body accelerates.

    For the state of the last `evaluate`, with v_dot = 0.
    """
    move_frame_accelerations(system.frames, system.frames.n_acting, state, work)
    set_convective(system, state, work)


@entry
def set_force_scales(system: System, state: State, work: Workspace) -> None:
    """The sums of the magnitudes of all forces and moments on each body.

    Of the state of the last `evaluate`. Forces that cancel at a frame count as those that cancel
    at a distance do.
    """
    set_inertia_scales(system.bodies, state, work)
    add_load_scales(system, state, work)
    add_pattern_scales(system.patterns, work)
    add_coupling_scales(system, state, work)
    add_surface_scales(system, state, work)


@compiled
def relative_residual(
    system: System, reach: float, at_rest: bool, state: State, work: Workspace
) -> float:
    """The largest residual relative to the scale of the tolerance; 0 at rounding.

    Equilibrium and force laws against the sum of the magnitudes of their terms; constraints and
    interface displacements against the largest motion of the step. Positions are rounded against
    `reach`; `at_rest`: Newton's method has come as far as it can.
    """
    set_force_scales(system, state, work)
    length, angle = step_motion(system.scheme, state, work)
    # A rotation moves the far end of the model, against which constraints are judged.
    length += angle * system.bodies.size
    by_bodies = relative_body_residual(system, reach, at_rest, state, work)
    by_rows = relative_coupling_residual(system, (length, angle), reach, at_rest, state, work)
    by_dofs = relative_interface_residual(system, length + angle, reach, work)
    return max(by_bodies, by_rows, by_dofs)
