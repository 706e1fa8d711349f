"""A model as flat arrays: what the compiled loop reads (`System`), what it moves (`State`), where
it scribbles.

Numbering: bodies b, six coordinates each (delta x in space, delta Theta in body axes); frames f;
couplings (joints, motions, springs) with their rows i, one multiplier each; loads l; flexible
bodies e with their interface dofs, numbered through in `u`. Frames that carry couplings or loads
come before those that are only observed; the interface dofs of the former are `active`: no others
are ever loaded.
"""

from typing import NamedTuple

from ..arrays import Array, Index


class Scheme(NamedTuple):
    """Generalized-alpha with its step; `weight` of p_{n+1} against p_n in the convolution: 1, or
    1/2 in eq. (55).
    """

    h: float
    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    beta_prime: float
    gamma_prime: float
    weight: float
    tolerance: float
    max_iterations: int
    corrections: (
        int  # the most that a step may take before it goes on as it is, 0: converge or fail
    )
    reuse: float  # ratio of successive corrections above which the matrix is made anew; 0: always, inf: each step


class Bodies(NamedTuple):
    mass: Array  # (n_b,)
    J_rot: Array  # (n_b, 3, 3)
    gravity: Array  # (3,)


class Frames(NamedTuple):
    n_acting: int
    body: Index  # (n_f,) -1: fixed in space
    X: Array  # (n_f, 3) position from the centre of mass, in body axes
    D_0: Array  # (n_f, 3, 3) axes in the undeformed body
    dof: Index  # (n_f,) the first of its dofs in u, -1: a rigid offset
    active: Index  # (n_f,) the first of its active dofs, -1: none
    column: Index  # (n_f,) the first of them among the coordinates of its body, -1: none
    rotations: Index  # (n_f,) 1: the interface has rotations


class Rows(NamedTuple):
    """Scalar coordinates of pairs of frames; rows.py says what the kinds are."""

    kind: Index  # (n,)
    frame_a: Index  # (n,)
    frame_b: Index  # (n,)
    a: Array  # (n, 3) the axis carried by frame A, in its axes
    a_turned: Array  # (n, 3) the axis that `a` turns to after a quarter turn
    b: Array  # (n, 3) the axis carried by frame B, in its axes


class Couplings(NamedTuple):
    """Joints and springs: rows with a multiplier each, which keeps the row at 0 or follows from a
    force law.

    The law of row i: lambda_i = -sum_j (stiffness_ij (c_j - rest_j) + damping_ij dc_j/dt) -
    table_i(c_i), j over the rows of the same coupling.
    """

    rows: Rows
    n_compliant: int
    range: Index  # (n_couplings + 1,) the rows of each coupling
    second: Index  # (n_rows,) where the second frame that the coupling names stands in the gradient: 6, or 0 if A
    drive: Index  # (n_rows,) the drive of the row, -1: none
    compliant: Index  # (n_rows,) 1: follows a law
    rest: Array  # (n_rows,)
    stiffness: Array  # (n_rows, 6)
    damping: Array  # (n_rows, 6)
    table: Index  # (n_rows + 1,) the points of each row's table
    table_coordinate: Array
    table_force: Array


class Loads(NamedTuple):
    frame: Index  # (n_l,)
    torque: Index  # (n_l,) 0: force, 1: torque
    follower: Index  # (n_l,)
    direction: Array  # (n_l, 3)


class Elastic(NamedTuple):
    body: Index  # (n_e,)
    dof: Index  # (n_e + 1,) the range of each body in u
    active: Index  # (n_a,) the dofs that can be loaded
    active_range: Index  # (n_e + 1,) the range of each body in `active`
    of_body: Index  # (n_b,) the flexible body that a body is, -1: rigid
    G_0: Array  # instantaneous compliances (n_c, n_c) one after the other
    G_0_start: Index  # (n_e,)
    G_active: Array  # weight G_0 of the active dofs of every body, one after the other
    G_active_start: Index  # (n_e,)
    mode_range: (
        Index  # (n_e + 1,) the range of each body in the modal state; empty: direct convolution
    )
    stiffness: Array  # (n_modes,) omega^2
    damping: Array  # (n_modes,) 2 zeta omega
    pivot: Array  # (n_modes,)
    phi: Array  # (n_c, m) one after the other; bodies may share one
    phi_start: Index  # (n_e,)
    g: Array  # kernels (n_c, n_c, lags), from the last lag to the first, one after the other; bodies may share one
    g_initial: Array  # the same as (lags, n_c, n_c), from the first lag on
    g_start: Index  # (n_e,)
    lags: Index  # (n_e,) how many of them there are
    looks_ahead: Index  # (n_e,) 1: blocks of past loads are convolved by FFT


class Pattern(NamedTuple):
    """The iteration matrix as blocks, its nodes in the order of elimination; pattern.py says what
    they are.

    The rows of node k hold its diagonal block and those of `later` nodes to its right, side by
    side; below stand the blocks of the same nodes in its columns.
    """

    size: Index  # (n_nodes,) unknowns
    first: Index  # (n_nodes + 1,) the first of them
    width: Index  # (n_nodes,) of the rows: unknowns of the node and of the later ones
    row: Index  # (n_nodes,) where the rows begin
    lower: Index  # (n_nodes,) where the blocks below begin, as wide as the node
    later_range: Index  # (n_nodes + 1,)
    later: Index  # (n_later,) later nodes coupled with each
    segment_range: Index  # (n_later + 1,)
    segment: Index  # (n_segments, 4) of the update of a later node: first number, row distance, column, width
    n_numbers: int  # of all blocks
    body: Index  # (n_b,) node of every body
    coupling: Index  # (n_couplings,) node of every coupling, -1: no rows
    body_block: Index  # (n_b, 2) first number and row distance of the diagonal block
    coupling_block: Index  # (n_couplings, 7, 2) of the blocks (A, B), (B, A), (A, j), (j, A), (B, j), (j, B), (j, j)
    force_block: (
        Index  # (n, 4) blocks in the rows of bodies: body, first number, row distance, width
    )


class System(NamedTuple):
    scheme: Scheme
    bodies: Bodies
    frames: Frames
    couplings: Couplings
    observers: Rows  # joint coordinates that are only watched
    loads: Loads
    elastic: Elastic
    pattern: Pattern


class State(NamedTuple):
    step: Index  # (1,)
    prepared: Index  # (1,) 1: the next step has been begun, as far as it goes without its inputs
    x: Array  # (n_b, 3)
    quaternion: Array  # (n_b, 4)
    R: Array  # (n_b, 3, 3)
    v: Array  # (n_b, 6) velocity in space, angular velocity in body axes
    v_dot: Array  # (n_b, 6)
    a: Array  # (n_b, 6) pseudo-acceleration
    lam: Array  # (n_rows,)
    u: Array  # (n_u,)
    u_rate: Array  # (n_u,)
    u_acceleration: Array  # (n_u,)
    u_a: Array  # (n_u,)
    p: Array  # (n_u,) interface loads, body axes
    eta: Array  # (n_modes,)
    eta_rate: Array  # (n_modes,)
    eta_acceleration: Array  # (n_modes,)
    eta_a: Array  # (n_modes,)
    p_rest: Array  # (n_u,) loads that have always acted: direct convolution leaves them out ...
    history_rest: Array  # (n_u,) ... and adds what they do, (compliance - G_0) p_rest
    p_start: Array  # (n_u,) loads that begin at t = 0, which kernels answer with g_initial
    p_history: Array  # (n_u, n) loads at the steps from window[0] on, without p_rest; n = 0 where all bodies have modes
    ahead: Array  # (n_u, n) displacements at the same steps by the loads before `since`
    window: Index  # (1,)
    since: Index  # (n_e,) the first step whose loads the time loop convolves itself
    load: Array  # (n_l,) values of the signals at the last step
    load_vector: Array  # (n_l, 3) force or torque at the last step, in space
    drive: Array  # (n_d,) at the last step
    drive_force: Array  # (n_d,) work per unit of the drive, at the last step
    coordinate: Array  # (n_rows,) of the couplings, at the last step
    observed: Array  # (n_observers,) at the last step
    elastic_energy: Array  # (1,) from the work of the interface loads
    work: Array  # (1,) of loads and drives
    compliance_work: Array  # (1,) of springs and dampers on the bodies


class Workspace(NamedTuple):
    """Scratch memory of one step, made once."""

    # the start of the step
    quaternion: Array  # (n_b, 4)
    psi: Array  # (n_b, 3) rotation increment
    u_n: Array  # (n_u,)
    p_n: Array  # (n_u,)
    u_predicted: Array  # (n_u,) for u_acceleration = 0
    u_rate_predicted: Array  # (n_u,)
    lam_n: Array  # (n_rows,)
    load_position: Array  # (n_l, 3)
    load_axes: Array  # (n_l, 3, 3)
    # kinematics of frames
    r: Array  # (n_f, 3)
    D: Array  # (n_f, 3, 3)
    lever: Array  # (n_f, 3) X + u, body axes
    T: Array  # (n_f, 3, 3) tangent of the small rotation
    wrench: Array  # (n_f, 6) force and moment on the body at the frame, in space
    V: Array  # (n_f, 6) velocity and angular velocity of frames, in space
    # couplings
    coordinate: Array  # (n_rows,)
    rate: Array  # (n_rows,)
    phi: Array  # (n_rows,) residual: of the constraint, or of the force law
    law_scale: Array  # (n_rows,) sum of the magnitudes in a force law
    gradient: Array  # (n_rows, 12) with respect to (r, theta) of frames A and B, in space
    coupling_wrench: Array  # (n_couplings, 6) on B, in space
    drive_slope: Array  # (n_rows,) d phi / d drive
    # equations
    force: Array  # (n_b, 6) generalized forces of loads and joints
    force_scale: Array  # (n_b, 2) sums of the magnitudes of forces and of moments
    residual: Array  # (n_b, 6) of equilibrium
    history: Array  # (n_u,)
    modal: Array  # (n_modes,)
    u_residual: Array  # (n_a,)
    # Newton's matrix; coordinates of a frame: delta X, delta Theta, delta u, delta w, all in body
    # axes
    rate_map: Array  # (n_f, 6, 12) derivative of V by the coordinates
    frame_tangent: Array  # (12, 12) derivative of the wrenches on two frames by their (delta r, delta theta), in space
    half_tangent: Array  # (12, 24)
    pair_tangent: Array  # (24, 24) the same for generalized forces and coordinates of both frames
    B: Array  # (n_rows, 24) derivative of the rows' coordinates by the coordinates of frames A and B
    B_rate: Array  # (n_rows, 24) derivative of their rates
    A: Array  # (n_rows, 24) derivative of the residuals phi; h^2 times that of a force law
    S: Array  # (n_numbers,) the blocks of the iteration matrix, or their factors
    pivots: Index  # (n,) row exchanges
    rhs: Array  # (n,) right-hand side, then corrections, in the order of the nodes
    forces: Array  # the rows of a block that belong to active dofs
    renewed: Index  # (2,) 1 when S holds factors that the time loop may use again; how often it was made anew
    x_predicted: Array  # (n_b, 3) for v_dot = 0
    v_predicted: Array  # (n_b, 6)
    psi_predicted: Array  # (n_b, 3)
    scratch_3: Array
    scratch_3b: Array
    scratch_12: Array
    scratch_4: Array
    scratch_4b: Array
    scratch_33: Array


class Inputs(NamedTuple):
    """Signals at the next steps, and what to do besides."""

    load: Array  # (n, n_l)
    drive: Array  # (n, n_d)
    row: Index  # (n,) of the output for the step, -1: it is not recorded
    ahead: int  # 1: prepare the step after them


class Output(NamedTuple):
    """What a step leaves behind; one row per step."""

    x: Array  # (n, n_b, 3)
    R: Array  # (n, n_b, 4)
    v: Array  # (n, n_b, 6)
    v_dot: Array  # (n, n_b, 6)
    frame_position: Array  # (n, n_f, 3)
    frame_rotation: Array  # (n, n_f, 4)
    frame_u: Array  # (n, n_f, 6)
    frame_force: Array  # (n, n_f, 6)
    frame_velocity: Array  # (n, n_f, 6)
    frame_acceleration: Array  # (n, n_f, 6)
    multipliers: Array  # (n, n_rows)
    coordinates: Array  # (n, n_rows)
    observed: Array  # (n, n_observers)
    observed_rates: Array  # (n, n_observers)
    coupling_wrench: Array  # (n, n_couplings, 6)
    energy: Array  # (n, 7) kinetic, elastic, springs, potential, work, compliance work, modal
    momentum: Array  # (n, 6) linear, and angular about the origin, in space
    iterations: Index  # (n,)
    residual: Array  # (n,)
