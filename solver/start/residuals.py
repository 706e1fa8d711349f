"""How far a state is from equilibrium, relative to its forces and to the size of the model."""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..step.rows import measures_length
from ..step.system import State, System, Workspace

SERVO_ERROR_SCALE = 1e-3
"""error of a servo whose answering force is the scale of forces where nothing loads it"""
NO_FORCE = 1e-300
"""the largest force where there is none, by which others are divided"""


def relative_residuals(
    system: System,
    lengths: NDArray[np.bool_],
    state: State,
    work: Workspace,
    least: tuple[float, float] = (0.0, 0.0),
    opening: float = 0.0,
) -> tuple[Array, ...]:
    """Residuals relative to the largest forces and moments in the system, and to its size.

    Of the forces (n_b,) and moments (n_b,) on bodies, the rows (n_rows,) and the active elastic
    dofs (n_a,). least: a force [N] and a moment [N m] below which none counts as the largest.
    opening: a length [m] that lengths of constraints are relative to where the size is less.
    """
    # A body that spins about its center is loaded within: its net force is a difference of these.
    within, size = _centrifugal_scales(system, state, work), system.bodies.size
    forces, moments = largest_forces(system, work, least)
    # the length of a spring that carries nothing is right to rounding alone: laws are measured
    # against all forces
    laws = np.maximum(work.couplings.scale, np.where(lengths, forces, moments))
    constraints = np.where(lengths, max(size, opening), size)
    return (
        np.abs(work.bodies.residual[:, :3]).max(axis=1) / (forces + within[0]),
        np.abs(work.bodies.residual[:, 3:]).max(axis=1) / (moments + within[1]),
        np.abs(work.couplings.phi) / np.where(system.couplings.compliant == 1, laws, constraints),
        system.elastic.length * np.abs(work.interfaces.residual) / size,
    )


def largest_forces(
    system: System, work: Workspace, least: tuple[float, float] = (0.0, 0.0)
) -> tuple[float, float]:
    """The largest sums of forces and of moments on a body; moments at least of small levers.

    And those by which servos would answer to `SERVO_ERROR_SCALE`, where nothing loads them.
    """
    lengths, answers = _answers(system, work)
    forces = max(
        float(work.bodies.force_scale[:, 0].max()), answers[lengths].max(initial=NO_FORCE), least[0]
    )
    levered = max(forces * 1e-3 * system.bodies.size, answers[~lengths].max(initial=0.0))
    return forces, max(float(work.bodies.force_scale[:, 1].max()), levered, least[1])


def _answers(system: System, work: Workspace) -> tuple[NDArray[np.bool_], Array]:
    """For each motor, whether its coordinate is a length, and its force under a small error.

    The error is `SERVO_ERROR_SCALE` of the size of the model, of 1 rad, or of the rate.
    """
    motors, rows = system.couplings.laws.motors, system.couplings.rows.kind
    lengths = np.array([measures_length(kind) for kind in rows[motors.row].tolist()], dtype=bool)
    reach = np.where(lengths, system.bodies.size, 1.0)
    reach = np.maximum(reach, np.abs(work.couplings.coordinate[motors.row]))
    rate = np.abs(work.couplings.rate[motors.row])
    answers: Array = SERVO_ERROR_SCALE * (motors.stiffness * reach + motors.damping * rate)
    return lengths, answers


def _centrifugal_scales(system: System, state: State, work: Workspace) -> Array:
    """Centrifugal forces and moments within flexible bodies (2, n_b).

    Where a body turns about its center, and nothing holds it, all that is left is their rounding.
    """
    elastic, scales = system.elastic, np.zeros((2, len(system.bodies.mass)))
    for e, b in enumerate(elastic.body.tolist()):
        omega = state.bodies.v[b, 3:]
        scales[0, b] = system.bodies.mass[b] * (omega @ omega) * elastic.size[e]
        scales[1, b] = np.linalg.norm(omega) * np.linalg.norm(work.bodies.J[b] @ omega)
    return scales
