"""Room for the state of a system and for the work of a step; bodies at their given places and
velocities.
"""

import numpy as np

from ..history.dyadic import Window
from ..step.rotations import quaternion_of
from ..step.system import State, Workspace
from .lower import CompiledModel


def allocate(compiled: CompiledModel) -> tuple[State, Workspace]:
    system = compiled.system
    n_b, n_f, n_j = len(system.bodies.mass), len(system.frames.body), len(compiled.coupling_names)
    n_rows, n_l, n_d = (
        len(system.couplings.rows.kind),
        len(system.loads.frame),
        len(compiled.drives),
    )
    n_u, n_a, n_modes = (
        int(system.elastic.dof[-1]),
        len(system.elastic.active),
        len(system.elastic.stiffness),
    )
    pattern, n = system.pattern, int(system.pattern.first[-1])
    n_kept = Window(system.elastic).kept(compiled.n_steps) if system.elastic.lags.any() else 0
    starts = [body.start for body in compiled.model.bodies.values()]
    state = State(
        step=np.zeros(1, dtype=np.int64),
        prepared=np.zeros(1, dtype=np.int64),
        x=np.array([pose.x for pose in compiled.poses]),
        quaternion=np.array([quaternion_of(pose.R) for pose in compiled.poses]),
        R=np.array([pose.R for pose in compiled.poses]),
        v=np.array([[*start.velocity, *start.angular_velocity] for start in starts]),
        v_dot=np.zeros((n_b, 6)),
        a=np.zeros((n_b, 6)),
        lam=np.zeros(n_rows),
        u=np.zeros(n_u),
        u_rate=np.zeros(n_u),
        u_acceleration=np.zeros(n_u),
        u_a=np.zeros(n_u),
        p=np.zeros(n_u),
        eta=np.zeros(n_modes),
        eta_rate=np.zeros(n_modes),
        eta_acceleration=np.zeros(n_modes),
        eta_a=np.zeros(n_modes),
        p_rest=np.zeros(n_u),
        history_rest=np.zeros(n_u),
        p_start=np.zeros(n_u),
        p_history=np.zeros((n_u, n_kept)),
        ahead=np.zeros((n_u, n_kept)),
        window=np.zeros(1, dtype=np.int64),
        since=np.ones(len(system.elastic.body), dtype=np.int64),
        load=np.zeros(n_l),
        load_vector=np.zeros((n_l, 3)),
        drive=np.zeros(n_d),
        drive_force=np.zeros(n_d),
        coordinate=np.zeros(n_rows),
        observed=compiled.observer_starts.copy(),
        elastic_energy=np.zeros(1),
        work=np.zeros(1),
        compliance_work=np.zeros(1),
    )
    work = Workspace(
        quaternion=state.quaternion.copy(),
        psi=np.zeros((n_b, 3)),
        u_n=np.zeros(n_u),
        p_n=np.zeros(n_u),
        u_predicted=np.zeros(n_u),
        u_rate_predicted=np.zeros(n_u),
        lam_n=np.zeros(n_rows),
        load_position=np.zeros((n_l, 3)),
        load_axes=np.zeros((n_l, 3, 3)),
        r=np.array([pose.x for pose in compiled.frame_poses]).reshape(n_f, 3),
        D=np.array([pose.R for pose in compiled.frame_poses]).reshape(n_f, 3, 3),
        lever=np.zeros((n_f, 3)),
        T=np.tile(np.eye(3), (n_f, 1, 1)),
        wrench=np.zeros((n_f, 6)),
        V=np.zeros((n_f, 6)),
        coordinate=np.zeros(n_rows),
        rate=np.zeros(n_rows),
        phi=np.zeros(n_rows),
        law_scale=np.zeros(n_rows),
        gradient=np.zeros((n_rows, 12)),
        coupling_wrench=np.zeros((n_j, 6)),
        drive_slope=np.zeros(n_rows),
        force=np.zeros((n_b, 6)),
        force_scale=np.zeros((n_b, 2)),
        residual=np.zeros((n_b, 6)),
        history=np.zeros(n_u),
        modal=np.zeros(n_modes),
        u_residual=np.zeros(n_a),
        rate_map=np.zeros((n_f, 6, 12)),
        frame_tangent=np.zeros((12, 12)),
        half_tangent=np.zeros((12, 24)),
        pair_tangent=np.zeros((24, 24)),
        B=np.zeros((n_rows, 24)),
        B_rate=np.zeros((n_rows, 24)),
        A=np.zeros((n_rows, 24)),
        S=np.zeros(pattern.n_numbers),
        pivots=np.zeros(n, dtype=np.int64),
        rhs=np.zeros(n),
        forces=np.zeros(
            int(
                (
                    pattern.force_block[:, 3]
                    * (pattern.size[pattern.body[pattern.force_block[:, 0]]] - 6)
                ).max()
            )
        ),
        renewed=np.zeros(2, dtype=np.int64),
        x_predicted=np.zeros((n_b, 3)),
        v_predicted=np.zeros((n_b, 6)),
        psi_predicted=np.zeros((n_b, 3)),
        scratch_3=np.zeros(3),
        scratch_3b=np.zeros(3),
        scratch_12=np.zeros(12),
        scratch_4=np.zeros(4),
        scratch_4b=np.zeros(4),
        scratch_33=np.zeros((3, 3)),
    )
    return state, work
