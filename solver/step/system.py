"""The arrays of a time step: the data (`System`), the state (`State`), scratch (`Workspace`).

Each is nested by contributor: bodies, frames, interfaces and modes of flexible bodies, couplings,
loads. These declarations alone list the arrays; `Struct.allocate` makes them.

Dimensions: n_b bodies of six coordinates (delta x in space, delta Theta in body axes); n_f frames;
n_j couplings (joints, motions, springs, contacts, motors) of n_i rows in all, one multiplier each,
n_k of them contacts, n_r with friction and n_motors motors; n_v events of contacts; n_o observers;
n_h numbers that force laws remember; n_l loads on frames, n_t load patterns, n_y signals of both;
n_g patterns that bodies have, n_z channels of sensors; n_d drives; n_e flexible bodies with n_u
elastic dofs in all, of which n_a are active, and n_m modes with n_x springs of chains; n_p steps
whose loads are kept; n_q coordinates of second order of a body at most. Frames that carry couplings
or loads come before those that are only observed; interface dofs of the former are `active`: no
others but those of patterns are ever loaded.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.motion import output_fields
from ..arrays import Array, Index
from ..compiler.struct import ArrayField, Struct, array

# Data of the model


class Scheme(Struct):
    """Generalized-alpha with its step."""

    h: float
    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    beta_prime: float
    gamma_prime: float
    inertia_ratio: float
    """(1 - alpha_m) / (1 - alpha_f): pseudo-acceleration to acceleration"""
    weight: float
    """of p_{n+1} against p_n in the convolution: 1, or 1/2 in eq. (55)"""
    stride: int
    """the step in steps of the shortest size of the run, by which steps are counted"""
    ratio: int
    """of the longest step to the shortest; 1: all are the same"""


class Newton(Struct):
    """Settings of Newton's method."""

    tolerance: float
    max_iterations: int
    fixed_iterations: int
    """the largest number in a step, which then ends without an error; 0: converge or fail"""
    reuse: float
    """ratio of successive corrections above which the matrix is made anew; 0: always"""


class Bodies(Struct):
    free: Index = array("n_free")
    """numbers of those that no constraint holds"""
    mass: Array = array("n_b")
    J_rot: Array = array("n_b", 3, 3)
    gravity: Array = array(3)
    size: float
    """of the model, the length that an angle is multiplied by (`model_size` in lower/size.py)"""


class Frames(Struct):
    n_acting: int
    body: Index = array("n_f")
    """-1: fixed in space"""
    X: Array = array("n_f", 3)
    """position from the center of mass, in body axes"""
    D_0: Array = array("n_f", 3, 3)
    """axes in the undeformed body"""
    quaternion_0: Array = array("n_f", 4)
    """the same"""
    dof: Index = array("n_f")
    """the first of its dofs in u, -1: a rigid offset"""
    active: Index = array("n_f")
    """the first of its active dofs, -1: none"""
    column: Index = array("n_f")
    """the first of them among the coordinates of its body, -1: none"""
    rotations: Index = array("n_f")
    """1: the interface has rotations"""


class Rows(Struct):
    """Scalar coordinates of pairs of frames; rows.py and gaps.py define their kinds."""

    kind: Index = array("n")
    frame_a: Index = array("n")
    frame_b: Index = array("n")
    a: Array = array("n", 3)
    """the axis carried by frame A, in its axes"""
    a_turned: Array = array("n", 3)
    """the axis that `a` turns to after a quarter turn"""
    b: Array = array("n", 3)
    """the axis carried by frame B, in its axes"""
    shape: Index = array("n")
    """of the surface in rows of contacts (shapes.py)"""
    size: Array = array("n")
    """in rows of contacts: radii of ball and surface together; infinite of planes and other rows"""
    first: Index = array("n_1")
    """(n + 1,) the first of the parameters of each row"""
    parameters: Array = array("n_parameters")
    zero: Array = array("n")
    """of a length or an angle: what its coordinate is measured from"""
    axis: Index = array("n")
    """the first of three drives that are the components of a in the axes of A; -1: a is fixed"""


class Motors(Struct):
    """Motors, each the law of a row of its own (motors.py)."""

    row: Index = array("n_motors")
    stiffness: Array = array("n_motors")
    damping: Array = array("n_motors")
    integral: Array = array("n_motors")
    lower: Array = array("n_motors")
    """limits of what it gives"""
    upper: Array = array("n_motors")
    speed: Array = array("n_motors")
    """without load"""
    tracking: Array = array("n_motors")
    """rate at which the integral follows a limit, 0: there is none to follow"""


class Laws(Struct):
    """Force laws of compliant rows: a linear one of all rows of a coupling, and some of each row.

    Or that of a motor.

    The force of row i, j over the rows of the same coupling, m over its own laws:

        lambda_i = -sum_j (stiffness_ij (c_j - rest_j) + damping_ij dc_j/dt)
                   - sum_m law_m(c_i - rest_i, dc_i/dt)
    """

    rest: Array = array("n_i")
    stiffness: Array = array("n_i", 6)
    damping: Array = array("n_i", 6)
    range: Index = array("n_i_1")
    """(n_i + 1,) the laws of each row alone"""
    number: Index = array("n_law")
    """of each law (solver/laws)"""
    first: Index = array("n_law_1")
    """(n_law + 1,) the first of the parameters of each law"""
    parameters: Array = array("n")
    memory: Index = array("n_law_1")
    """(n_law + 1,) the first number that each law remembers"""
    motor: Index = array("n_i")
    """the motor that a row is of, -1: none"""
    motors: Motors


class Friction(Struct):
    """Coulomb friction on the last rows of couplings, by the normal force of rows before them.

    The normal force is preload + the sum over groups of rows of sqrt(sum (weight lambda)^2).
    """

    first: Index = array("n_r")
    """the first row with friction"""
    n: Index = array("n_r")
    """of these rows, 1 or 2"""
    static: Array = array("n_r")
    """coefficients, which fall from this to the next with the square of the rate over `speed`"""
    sliding: Array = array("n_r")
    speed: Array = array("n_r")
    stiffness: Array = array("n_r")
    """of the bristle"""
    damping: Array = array("n_r")
    """of the bristle"""
    viscous: Array = array("n_r")
    preload: Array = array("n_r")
    weight: Array = array("n_i")
    group: Index = array("n_i")


class Terms(Struct):
    """Coordinates of other pairs of frames that join the constraints of some rows (terms.py)."""

    rows: Rows
    ratio: Array = array("n_terms")
    row: Index = array("n_terms")
    """the row that each joins"""
    number: Index = array("n_terms")
    """the same among the rows of its coupling"""
    own: Index = array("n_terms")
    """the coupling if the term is between its own frames, -1: between others"""
    range: Index = array("n_i_1")
    """(n_i + 1,) the terms of each row"""


class Couplings(Struct):
    """Joints, motions, springs and contacts: rows with a multiplier that keeps them at 0 or obeys a
    law.
    """

    rows: Rows
    terms: Terms
    laws: Laws
    friction: Friction
    friction_of: Index = array("n_j")
    """the friction of each coupling, -1: none"""
    contact: Index = array("n_k")
    """couplings whose rows act only while the law of the first is engaged"""
    contact_of: Index = array("n_j")
    """the contact that a coupling is, -1: none"""
    switching: Index = array("n_w")
    """couplings that open and close, or stick and slip"""
    n_compliant: int
    range: Index = array("n_j_1")
    """(n_j + 1,) the rows of each coupling"""
    second: Index = array("n_i")
    """offset in the gradient of the second frame that the coupling names: 6, or 0 if it is A"""
    drive: Index = array("n_i")
    """the first drive of the row, -1: none"""
    driven: Index = array("n_d")
    """the row of each drive"""
    compliant: Index = array("n_i")
    """1: obeys a law"""


class Loads(Struct):
    frame: Index = array("n_l")
    kind: Index = array("n_l")
    """loads.py has them"""
    moment: Index = array("n_l")
    """1: acts as a moment, 0: as a force"""
    by_velocity: Index = array("n_l")
    """1: depends on the velocity of the frame"""
    first: Index = array("n_l1")
    """(n_l + 1,) the first of the parameters of each"""
    parameters: Array = array("n_load_parameters")
    n_by_velocity: int


class LoadPatterns(Struct):
    """Loads that are spread over flexible bodies (patterns.py)."""

    body: Index = array("n_t")
    dof: Index = array("n_t")
    """of each, in u"""
    signal: Index = array("n_t")
    """the number of its amplitude among the values of loads"""
    force: Array = array("n_t", 3)
    """resultant at the amplitude 1, in body axes"""
    moment: Array = array("n_t", 3)
    """the same about the center of mass"""


class Sensors(Struct):
    """Channels of sensors in flexible bodies (readings.py)."""

    body: Index = array("n_z")
    dof: Index = array("n_z")
    """of each, in u"""
    axis: Index = array("n_z")
    """of a point, 0 to 2 one after the other; -1: of a gauge"""
    X: Array = array("n_z", 3)
    """place of the sensor, from the center of mass in body axes"""


class Chains(Struct):
    """Maxwell elements beside the stiffness of the modes of bodies, K_e for body e.

    Their springs stand body by body, element by element, one for each mode.
    """

    body: Index = array("n_chained")
    """the flexible bodies that have some"""
    element: Index = array("n_chained_1")
    """(n_chained + 1,) the elements of each"""
    spring: Index = array("n_chained")
    """its first spring"""
    kept: Array = array("n_elements")
    """of the stretch of a spring, in a step"""
    gain: Array = array("n_elements")
    """stretch per displacement of the mode"""
    lost: Array = array("n_elements")
    """h / tau"""
    amplitude: Array = array("n_x")
    """stiffness of each spring over that of its mode"""
    hardening: Array = array("n_m")
    """sum of gain amplitude of each mode; 0 without a chain"""


class Modes(Struct):
    """Scalar recursions that carry the history of bodies with modes."""

    range: Index = array("n_e_1")
    """(n_e + 1,) the modes of each flexible body; none: its kernel is convolved"""
    stiffness: Array = array("n_m")
    """omega^2"""
    damping: Array = array("n_m")
    """2 zeta omega"""
    step_stiffness: Array = array("n_m")
    """inertia_ratio + gamma h damping + beta h^2 stiffness (1 + hardening)"""
    phi: Array = array("n")
    """(n_c, m) one after the other; bodies may share one"""
    phi_start: Index = array("n_e")
    damped: int
    """1: some mode is damped"""
    chains: Chains


class Kernels(Struct):
    """Impulse responses of bodies whose loads are convolved."""

    g: Array = array("n")
    """(n_c, n_c, lags) from the last lag to the first, one after the other; bodies may share one"""
    g_initial: Array = array("n")
    """the same as (lags, n_c, n_c), from the first lag on"""
    g_start: Index = array("n_e")
    lags: Index = array("n_e")
    by_fft: Index = array("n_e")
    """1: blocks of past loads are convolved by FFT"""


class SecondOrder(Struct):
    """What is quadratic in r coordinates q of each flexible body (second_order.py)."""

    r: Index = array("n_e")
    """0: none; such bodies have no dofs of inertia either"""
    J_0: Array = array("n_e", 3, 3)
    """of the undeformed body"""
    A: Array = array("n")
    """(n_c + 6, r, r) of interfaces and inertia, one after the other; bodies may share one"""
    A_start: Index = array("n_e")
    A_active: Array = array("n_active")
    """(r, n, r) of the n active dofs before q, of every body"""
    A_active_start: Index = array("n_e")
    gyroscopic: Array = array("n_gyroscopic")
    """h as (r, 3, r), from its second index on; bodies may share one"""
    turned: Array = array("n_gyroscopic")
    """the same from its third index on"""
    gyroscopic_start: Index = array("n_e")
    stiff: Index = array("n_e")
    """the first coordinates that have a strain energy beyond the quadratic one"""
    cubic: Array = array("n_cubic")
    cubic_start: Index = array("n_e")
    quartic: Array = array("n_quartic")
    quartic_start: Index = array("n_e")
    row: Index = array("n_e_1")
    """(n_e + 1,) the first number of the slopes A q (n, r) of each body"""


class AxialForces(Struct):
    """Axial forces of flexible bodies over critical loads (axial.py)."""

    body: Index = array("n_axial")
    """the flexible body of each"""
    start: Index = array("n_axial")
    """first of its weights, one for each dof of the body"""
    weight: Array = array("n_weights")
    line: Array = array("n_axial", 3)
    """the direction of each, in body axes"""
    spread: Array = array("n_axial")
    """second moment of the mass along it, over the critical load and its length [s^2]"""
    share: Array = array("n_axial")
    """of a step in the time over which forces are averaged"""


class Elastic(Struct):
    """Flexible bodies and their elastic dofs.

    Those of the interfaces, and for a body with terms of second order 6 of inertia and r more.
    """

    body: Index = array("n_e")
    of_body: Index = array("n_b")
    """the flexible body that a body is, -1: rigid"""
    size: Array = array("n_e")
    """the length that displacements of each are compared with"""
    dof: Index = array("n_e_1")
    """(n_e + 1,) the dofs of each flexible body in u"""
    active: Index = array("n_a")
    """the dofs that can be loaded"""
    active_range: Index = array("n_e_1")
    """(n_e + 1,) those of each flexible body in `active`"""
    loaded: Index = array("n_loaded")
    """the active dofs of each flexible body, and those of its patterns that carry loads"""
    loaded_range: Index = array("n_e_1")
    """(n_e + 1,) those of each flexible body in `loaded`"""
    pattern_dof: Index = array("n_g")
    """the dofs of all load patterns, whether they carry loads or not"""
    G_0: Array = array("n")
    """instantaneous compliances (n_c, n_c) one after the other"""
    G_0_start: Index = array("n_e")
    G_active: Array = array("n")
    """weight G_0 of the active dofs of every body, one after the other"""
    G_active_start: Index = array("n_e")
    length: Array = array("n_a")
    """by which a residual of each active dof is multiplied, to be a length or an angle"""
    modes: Modes
    kernels: Kernels
    second: SecondOrder
    axial: AxialForces


class Pattern(Struct):
    """The iteration matrix as blocks, its nodes in the order of elimination.

    The rows of node k hold its diagonal block and those of `later` nodes to its right, side by
    side; below stand the blocks of the same nodes in its columns. lower/elimination_order.py
    defines nodes.
    """

    size: Index = array("n")
    """unknowns of each node"""
    first: Index = array("n_1")
    """(n + 1,) the first of them"""
    width: Index = array("n")
    """of the rows: unknowns of the node and of the later ones"""
    row: Index = array("n")
    """first number of the rows"""
    lower: Index = array("n")
    """first number of the blocks below, as wide as the node"""
    later_range: Index = array("n_1")
    later: Index = array("n_later")
    """later nodes coupled with each"""
    segment_range: Index = array("n_later_1")
    segment: Index = array("n_segments", 4)
    """of the update of a later node: first number, row distance, column, width"""
    n_numbers: int
    """of all blocks"""
    body: Index = array("n_b")
    """node of every body"""
    coupling: Index = array("n_j")
    """node of every coupling, -1: no rows"""
    body_block: Index = array("n_b", 2)
    """first number and row distance of the diagonal block"""
    coupling_block: Index = array("n_j", 7, 2)
    """of the blocks (A, B), (B, A), (A, j), (j, A), (B, j), (j, B), (j, j)"""
    term_block: Index = array("n_terms", 6, 2)
    """of the first six of these, for the frames of each term"""
    force_block: Index = array("n_blocks", 4)
    """blocks in the rows of bodies: body, first number, row distance, width"""


class System(Struct):
    scheme: Scheme
    newton: Newton
    bodies: Bodies
    frames: Frames
    couplings: Couplings
    observers: Rows
    """joint coordinates that are only observed"""
    loads: Loads
    patterns: LoadPatterns
    sensors: Sensors
    elastic: Elastic
    pattern: Pattern


# The state


class BodyState(Struct):
    x: Array = array("n_b", 3)
    quaternion: Array = array("n_b", 4)
    R: Array = array("n_b", 3, 3)
    v: Array = array("n_b", 6)
    """velocity in space, angular velocity in body axes"""
    v_dot: Array = array("n_b", 6)
    a: Array = array("n_b", 6)
    """pseudo-acceleration"""


class InterfaceState(Struct):
    u: Array = array("n_u")
    """elastic displacements and rotation vectors, body axes; changes of inertia and q"""
    rate: Array = array("n_u")
    acceleration: Array = array("n_u")
    a: Array = array("n_u")
    """pseudo-acceleration"""
    p: Array = array("n_u")
    """interface loads, body axes; loads on inertia and q"""


class ModalState(Struct):
    eta: Array = array("n_m")
    rate: Array = array("n_m")
    acceleration: Array = array("n_m")
    a: Array = array("n_m")
    """pseudo-acceleration"""
    stretch: Array = array("n_x")
    """of the springs of chains"""


class PastState(Struct):
    """Past loads of bodies whose kernels are convolved."""

    p_rest: Array = array("n_u")
    """loads that have always acted, without history"""
    u_rest: Array = array("n_u")
    """their displacements beyond the instantaneous ones, (compliance - G_0) p_rest"""
    p_start: Array = array("n_u")
    """loads that begin at t = 0, convolved with g_initial"""
    p: Array = array("n_u", "n_p")
    """loads at the steps from first[0] on, without p_rest"""
    u_ahead: Array = array("n_u", "n_p")
    """displacements at the same steps by the loads before `since`"""
    first: Index = array(1)
    since: Index = array("n_e")
    """the first step whose loads the time loop convolves itself"""


class CouplingState(Struct):
    lam: Array = array("n_i")
    """multipliers"""
    coordinate: Array = array("n_i")
    """at the last step, from which angles are continued over full turns, as the next"""
    rate: Array = array("n_i")
    bristle: Array = array("n_i")
    """deflection in friction"""
    memory: Array = array("n_h")
    """what force laws remember, one after the other"""


class TermState(Struct):
    coordinate: Array = array("n_terms")
    """those of the last step"""
    rate: Array = array("n_terms")


class ContactState(Struct):
    """Contacts since they closed, and those that ended."""

    steps: Index = array("n_k")
    """since it closed, 0: open"""
    begin: Array = array("n_k")
    """time when it closed [s]"""
    whole: Index = array("n_k")
    """1: it was open before"""
    closing_speed: Array = array("n_k")
    peak: Array = array("n_k")
    impulse: Array = array("n_k")
    total_impulse: Array = array("n_k")
    """since t = 0"""
    work: Array = array("n_k")
    """on the bodies, before it closed"""
    work_done: Array = array("n_k")
    """the same up to now"""
    ended: Index = array("n_k")
    """how often it has, since the start of the run"""
    n_events: Index = array(1)
    event_contact: Index = array("n_v")
    """contact that each event is of"""
    place: Array = array("n_k", 3)
    """of the ball in the axes of frame A, at the last step"""
    passed: Index = array(1)
    """1 + the first contact whose ball passed unnoticed in the last step, 0: none (passages.py)"""
    event: Array = array("n_v", 9)
    """start, end, steps, peak, impulse, closing and opening speed, restitution, dissipated"""


class ObserverState(Struct):
    value: Array = array("n_o")
    rate: Array = array("n_o")


class LoadState(Struct):
    """Loads at the last step, for their work."""

    value: Array = array("n_l")
    vector: Array = array("n_l", 3)
    """force or torque, in space"""
    position: Array = array("n_l", 3)
    """of the frame that is loaded"""
    axes: Array = array("n_l", 3, 3)


class PatternState(Struct):
    """Load patterns at the last step, for their work."""

    value: Array = array("n_t")
    wrench: Array = array("n_t", 6)
    """force and moment about the center of mass, in space"""
    position: Array = array("n_t", 3)
    """of the body"""
    axes: Array = array("n_t", 3, 3)


class MotorState(Struct):
    """Motors at the last step."""

    integral: Array = array("n_motors")
    slope: Array = array("n_motors")
    """rate of the integral"""
    work: Array = array("n_motors")
    """since the start"""
    pole: Array = array("n_motors")
    """largest magnitude of a pole of its loop at the start, all bodies rigid [rad/s]"""


class DriveState(Struct):
    """Drives at the last step, for their work."""

    value: Array = array("n_d")
    force: Array = array("n_d")
    """work per unit of the drive"""


class EnergyState(Struct):
    """Energies at the last step, and work summed over all steps."""

    kinetic: Array = array(1)
    potential: Array = array(1)
    modal: Array = array(1)
    """work of the interface loads on bodies whose history modes carry"""
    convolved: Array = array(1)
    """the same on bodies whose kernels are convolved"""
    damping: Array = array(1)
    """taken by the damping of modes, and of the material"""
    work: Array = array(1)
    """of loads, drives and motors"""
    compliance: Array = array("n_j")
    """work of each spring or damper on the bodies"""


class MotionExtremes(Struct):
    """Sums over steps from which the frequencies of bodies as a whole follow (body_extremes.py).

    Of velocities in space and of angular velocities in body axes, the second index 0 and 1.
    """

    row: Index = array(1)
    """steps of the longest size in a row"""
    steps: Index = array(1)
    """such steps in all that followed another, over which all sums are"""
    velocity: Array = array("n_b", 6)
    """at the last step"""
    change: Array = array("n_b", 6)
    """in it"""
    sum: Array = array("n_b", 6)
    """of velocities"""
    square: Array = array("n_b", 2)
    """sums of their squares, as the next two"""
    changes: Array = array("n_b", 2)
    """of changes in a step"""
    bends: Array = array("n_b", 2)
    """of changes of these"""
    largest: Array = array("n_b", 2)
    """the largest square of a change"""


class MomentumExtremes(Struct):
    """Angular momentum of free bodies, in space (body_extremes.py)."""

    momentum: Array = array("n_free", 3)
    """at the last step"""
    moment: Array = array("n_free", 3)
    """that acts there"""
    defect: Array = array("n_free", 3)
    """what moments do not explain"""
    largest: Array = array("n_free")
    """squares, of the momentum"""
    largest_defect: Array = array("n_free")


class ExtremeState(Struct):
    """The largest values of all steps, recorded or not, and sums over them (extremes.py)."""

    displacement: Array = array("n_f")
    """squares of elastic displacements of frames"""
    rotation: Array = array("n_f")
    """squares of their elastic rotations"""
    spin: Array = array("n_b")
    """squares of angular velocities"""
    inertia_taken: Array = array("n_e")
    """by elastic motion, of a moment of inertia"""
    opening: Array = array("n_i")
    """of the rows of joints and motions"""
    force: Array = array("n_i")
    """multipliers of these rows"""
    missed: Array = array("n_o")
    """of observed angles: by how much their rate missed them"""
    modal_rate: Array = array("n_m")
    """sums of the squares of the rates of modes"""
    modal_change: Array = array("n_m")
    """the same of their changes in a step"""
    interface_rate: Array = array("n_u")
    """as modal_rate, of the dofs of bodies whose kernels are convolved"""
    interface_change: Array = array("n_u")
    start: Array = array(2)
    """total and potential energy at t = 0"""
    moved: Array = array(1)
    """energy that moves: kinetic, elastic, and the work of all else"""
    balance: Array = array(1)
    """of energies"""
    stored: Array = array("n_j")
    """energy of each spring"""
    dissipated: Array = array("n_j")
    """energy that each spring or damper took"""
    returned: Array = array("n_j")
    """energy that each gave back of it"""
    shortest: Index = array("n_k")
    """steps of the shortest contact from closing to opening, 0: none yet; grazes do not count"""
    shortest_peak: Array = array("n_k")
    """its largest force"""
    peak: Array = array("n_k")
    """the largest force of contacts that have ended"""
    depth: Array = array("n_k")
    """penetration"""
    arm: Array = array("n_k")
    """square of the arm of the normal force about the frame that carries the shape"""
    axial: Array = array("n_axial")
    """largest axial forces over critical loads"""
    axial_mean: Array = array("n_axial")
    """the same of late, with their signs"""
    motion: MotionExtremes
    momentum: MomentumExtremes
    left: Index = array(1)
    """1 + the first frame that left the range of linear elasticity, 0: none"""


class State(Struct):
    step: Index = array(1)
    """time, in steps of the shortest size"""
    taken: Index = array(1)
    """steps of whatever size"""
    recorded: Index = array(1)
    """rows, but for the first, and for a last one that is recorded for that alone"""
    in_flight: Index = array(1)
    """1: pseudo-accelerations are those of the longest step"""
    prepared: Index = array(1)
    """1: the next step is prepared, as far as it does not depend on its inputs"""
    bodies: BodyState
    interfaces: InterfaceState
    modes: ModalState
    past: PastState
    couplings: CouplingState
    terms: TermState
    contacts: ContactState
    observers: ObserverState
    loads: LoadState
    patterns: PatternState
    drives: DriveState
    motors: MotorState
    energies: EnergyState
    extremes: ExtremeState


# Scratch of one step


class BodyWork(Struct):
    quaternion_n: Array = array("n_b", 4)
    """at the start of the step"""
    psi: Array = array("n_b", 3)
    """rotation increment"""
    x_predicted: Array = array("n_b", 3)
    """for v_dot = 0, as the next two"""
    v_predicted: Array = array("n_b", 6)
    psi_predicted: Array = array("n_b", 3)
    force: Array = array("n_b", 6)
    """generalized forces of loads and couplings"""
    force_scale: Array = array("n_b", 2)
    """sums of the magnitudes of forces and of moments"""
    residual: Array = array("n_b", 6)
    """of equilibrium"""
    J: Array = array("n_b", 3, 3)
    """moments of inertia of the deformed body"""
    relative_momentum: Array = array("n_b", 3)
    """Gamma, angular momentum of the elastic motion"""
    relative_moment: Array = array("n_b", 3)
    """J' omega + Gamma'"""
    increment: Array = array(4)
    """quaternion of psi"""
    T_inverse: Array = array(3, 3)
    """of psi"""
    inertia: Array = array(3, 3)
    """derivative of the moments of inertia by delta psi"""


class FrameWork(Struct):
    r: Array = array("n_f", 3)
    D: Array = array("n_f", 3, 3)
    lever: Array = array("n_f", 3)
    """X + u, body axes"""
    T: Array = array("n_f", 3, 3)
    """tangent of the small rotation"""
    wrench: Array = array("n_f", 6)
    """force and moment on the body at the frame, in space"""
    V: Array = array("n_f", 6)
    """velocity and angular velocity, in space"""
    A: Array = array("n_f", 6)
    """their derivatives"""
    rate_map: Array = array("n_f", 6, 12)
    """derivative of V by the coordinates delta X, delta Theta, delta u, delta w, in body axes"""
    half_tangent: Array = array(12, 24)
    """derivative of the wrenches on two frames, pulled back from one side"""
    pair_tangent: Array = array(24, 24)
    """the same for generalized forces and coordinates of both frames"""
    small_rotation: Array = array(3, 3)
    """exp(w~)"""
    small_quaternion: Array = array(4)
    """the same"""
    body_quaternion: Array = array(4)
    """of R exp(w~)"""
    T_inverse: Array = array(3, 3)
    """of the rotation increment of a body"""
    minus_w: Array = array(3)
    moment: Array = array(3)
    T_slope: Array = array(3, 3)
    """derivative of T(w) m"""


class InterfaceWork(Struct):
    u_n: Array = array("n_u")
    p_n: Array = array("n_u")
    u_predicted: Array = array("n_u")
    """for acceleration = 0"""
    rate_predicted: Array = array("n_u")
    rate_n: Array = array("n_u")
    history: Array = array("n_u")
    """displacements by past loads alone"""
    residual: Array = array("n_a")
    p_active: Array = array("n_a")


class SecondOrderWork(Struct):
    slope: Array = array("n_slopes")
    """A q (n, r) of the active dofs before q, of every body"""
    curvature: Array = array("n_u")
    """1/2 A(q, q) at the end of the last step"""
    bend: Array = array("n_u")
    """its change in that step"""
    at_q: Array = array("n_e", "n_3q")
    """h(q, .) (3, r), as the next two"""
    at_rate: Array = array("n_e", "n_3q")
    """h(q', .)"""
    by_rate: Array = array("n_e", "n_3q")
    """h(., q')"""


class ModalWork(Struct):
    a: Array = array("n_m")
    """new pseudo-acceleration"""
    load: Array = array("n_m")
    rate_n: Array = array("n_m")
    """at the start of the step"""
    eta_n: Array = array("n_m")
    """the same, where a body has a chain; then the move since"""


class CouplingWork(Struct):
    lam_n: Array = array("n_i")
    elapsed: Array = array(1)
    """time since the memories are those of the state, infinite at the start [s]"""
    status: Index = array("n_j")
    """contacts and friction: 0 open, 1 closed, or sticks, 2 slips"""
    status_n: Index = array("n_j")
    """the status at the start of the step"""
    holds: Index = array(1)
    """1: friction sticks whatever its force, as long as Newton's method looks for where it would"""
    blocked: Index = array("n_i")
    """1: the ball was last beyond an end of the shape, or came in from there"""
    slip_axis: Array = array("n_i", 3)
    """from which slip is counted, in the axes of frame A"""
    normal_slope: Array = array("n_i")
    """derivative of the normal force by multipliers"""
    Z: Array = array("n_i", 8)
    """derivative of the residuals of friction by the multipliers of their coupling"""
    near: Array = array("n_i")
    """coordinates expected at the end of the step"""
    coordinate: Array = array("n_i")
    rate: Array = array("n_i")
    phi: Array = array("n_i")
    """residual: of the constraint, or of the force law"""
    scale: Array = array("n_i")
    """sum of the magnitudes in a force law"""
    gradient: Array = array("n_i", 12)
    """with respect to (r, theta) of frames A and B, in space"""
    convective: Array = array("n_i")
    """second derivative of the coordinate, less the drive, where no body accelerates"""
    wrench: Array = array("n_j", 6)
    """on the second frame, in space"""
    B: Array = array("n_i", 24)
    """derivative of the coordinates by those of frames A and B"""
    B_rate: Array = array("n_i", 24)
    """derivative of their rates"""
    A: Array = array("n_i", 24)
    """derivative of the residuals phi; h^2 times that of a force law"""
    tangent: Array = array(12, 12)
    """derivative of the wrenches on two frames by their (delta r, delta theta), in space"""
    rate_tangent: Array = array(12, 12)
    """the same of one row, at a unit multiplier"""
    rate_gradient: Array = array(12)
    """derivative of a rate by (r, theta) of two frames"""
    slope_gradient: Array = array(12)
    """gradient of a driven row whose axis is a quarter turn ahead"""


class TermWork(Struct):
    near: Array = array("n_terms")
    """expected coordinates, to which angles are the nearest"""
    coordinate: Array = array("n_terms")
    rate: Array = array("n_terms")
    gradient: Array = array("n_terms", 12)
    B: Array = array("n_terms", 24)


class ObserverWork(Struct):
    value: Array = array("n_o")
    gradient: Array = array(12)
    B: Array = array("n_o", 24)
    """derivative of the coordinates by those of frames A and B"""


class LoadWork(Struct):
    value: Array = array("n_y")
    """of the signals at the end of the step, those of patterns last"""
    tangent: Array = array(3, 12)
    """derivative of a load by (delta r, delta theta) and the velocities of its frame, in space"""
    half_tangent: Array = array(12, 12)
    """the same of generalized forces"""
    motion: Array = array(3)
    """displacement or rotation of a loaded frame in a step"""


class DriveWork(Struct):
    value: Array = array("n_d")
    """at the end of the step"""
    rate: Array = array("n_d")
    """at the start of a run"""
    acceleration: Array = array("n_d")
    slope: Array = array("n_d")
    """d phi / d drive"""


class MotorWork(Struct):
    value: Array = array("n_motor_signals")
    """of each motor what it gives without an error, its reference, and the rate of that"""
    error: Array = array("n_motors")
    torque: Array = array("n_motors")
    """within the limits"""
    integral: Array = array("n_motors")
    """at the end of the step"""
    slope: Array = array("n_motors")
    scale: Array = array("n_motors")
    """sum of the magnitudes of what it is asked for"""
    status: Index = array("n_motors")
    """-1, 1: at the lower or upper limit; 0: between them"""
    matrix_status: Index = array("n_motors")
    """when the matrix was made"""


class MatrixWork(Struct):
    """Newton's matrix."""

    S: Array = array("n_numbers")
    """its blocks, or their factors"""
    pivots: Index = array("n_unknowns")
    """row exchanges"""
    rhs: Array = array("n_unknowns")
    """right-hand side, then corrections, in the order of the nodes"""
    force_rows: Array = array("n_force_rows")
    """the rows of a block that belong to active dofs"""
    current: Index = array(1)
    """1: S holds factors that may be used again"""
    count: Index = array(1)
    """number of times S was made"""
    status: Index = array("n_j")
    """of contacts and friction when it was"""


class Workspace(Struct):
    bodies: BodyWork
    frames: FrameWork
    interfaces: InterfaceWork
    second: SecondOrderWork
    modes: ModalWork
    couplings: CouplingWork
    terms: TermWork
    observers: ObserverWork
    loads: LoadWork
    drives: DriveWork
    motors: MotorWork
    matrix: MatrixWork


# Inputs and outputs


class Inputs(Struct):
    """Signals at the next steps, and the rows of the output that record them."""

    load: Array = array("n", "n_y")
    drive: Array = array("n", "n_d")
    motor: Array = array("n", "n_motor_signals")
    row: Index = array("n")
    """of the output for the step, -1: it is not recorded"""
    ahead: int
    """1: prepare the step after them"""


SIZES: dict[str, int | str] = {
    "time": "n",
    "axis": 3,
    "quaternion": 4,
    "body": "n_b",
    "frame": "n_f",
    "second_order_coordinate": "n_s",
    "coupling": "n_j",
    "row": "n_i",
    "joint_coordinate": "n_o",
    "contact": "n_k",
    "contact_axis": 3,
    "tangent_axis": 2,
    "joint_with_friction": "n_r",
    "pattern": "n_g",
    "sensor_channel": "n_z",
    "motor": "n_motors",
}
"""dimensions of results as dimensions of a step"""


def _output_fields() -> dict[str, ArrayField]:
    return {
        name: ArrayField(
            tuple(SIZES[dimension] for dimension in dimensions),
            np.int64 if integer else np.float64,
        )
        for name, (dimensions, integer) in output_fields().items()
    }


class Output(Struct, fields=_output_fields()):
    """The quantities of steps, one row per step: those of the records in results/motion.py."""

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


class Run(Struct):
    """All that the time loop reads and writes."""

    system: System
    state: State
    work: Workspace
    output: Output
