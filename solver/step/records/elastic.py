"""Records of flexible bodies: modes, kernels, terms of second order, sensors.

The code is in step/interfaces.py, step/history.py, step/chains.py, step/second_order.py,
step/axial.py and step/readings.py.
"""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Chains(Struct):
    """Maxwell elements beside the stiffness of the modes of some flexible bodies.

    Their springs stand body by body, element by element, one for each mode.
    """

    body: Index = array("n_chained")
    """flexible body of each chain"""
    element: Index = array("n_chained_1")
    """first element of each chain"""
    spring: Index = array("n_chained")
    """first spring of each chain"""
    kept: Array = array("n_elements")
    """part of the stretch of a spring that is left after a step"""
    gain: Array = array("n_elements")
    """stretch per displacement of the mode in a step"""
    lost: Array = array("n_elements")
    """step over relaxation time, h / tau"""
    amplitude: Array = array("n_x")
    """stiffness of each spring over the stiffness of its mode"""
    hardening: Array = array("n_m")
    """sum of gain amplitude over the elements of each mode; 0 without a chain"""


class Modes(Struct):
    """Scalar recursions that carry the history of bodies with modes."""

    range: Index = array("n_e_1")
    """first mode of each flexible body; a body without modes has its kernel convolved"""
    stiffness: Array = array("n_m")
    """omega^2 [1/s^2]"""
    damping: Array = array("n_m")
    """2 zeta omega [1/s]"""
    step_stiffness: Array = array("n_m")
    """inertia_ratio + gamma h damping + beta h^2 stiffness (1 + hardening); of a quasi-static mode
    beta h^2 stiffness"""
    phi: Array = array("n")
    """mode shapes (n_c, m) at the dofs of a body, one body after the other; bodies may share one"""
    phi_start: Index = array("n_e")
    """first entry of each flexible body in `phi`"""
    quasi_static: Index = array("n_quasi")
    """modes without inertia, whose displacement is load over stiffness"""
    damped: int
    """1: some mode is damped"""
    chains: Chains


class Kernels(Struct):
    """Impulse responses of bodies whose loads are convolved."""

    g: Array = array("n")
    """responses (n_c, n_c, lags), from the last lag to the first, one body after the other; bodies
    may share one"""
    g_initial: Array = array("n")
    """responses (lags, n_c, n_c) to loads that begin at t = 0, from the first lag on, one body
    after the other"""
    g_start: Index = array("n_e")
    """first entry of each flexible body in `g` and in `g_initial`"""
    lags: Index = array("n_e")
    """number of lags of each flexible body"""
    by_fft: Index = array("n_e")
    """1: blocks of past loads are convolved by FFT"""


class SecondOrder(Struct):
    """What is quadratic in r coordinates q of each flexible body."""

    r: Index = array("n_e")
    """number of coordinates q; a body with none has no dofs of inertia either"""
    J_0: Array = array("n_e", 3, 3)
    """moments of inertia of the undeformed body, in body axes [kg m^2]"""
    A: Array = array("n")
    """curvatures (n_c + 6, r, r) of interfaces and inertia, one body after the other; bodies may
    share one"""
    A_start: Index = array("n_e")
    """first entry of each flexible body in `A`"""
    A_active: Array = array("n_active")
    """curvatures (r, n, r) of the n active dofs before q, one body after the other"""
    A_active_start: Index = array("n_e")
    """first entry of each flexible body in `A_active`"""
    gyroscopic: Array = array("n_gyroscopic")
    """component i of h(e_k, e_j) at (k, i, j), shape (r, 3, r); bodies may share one"""
    turned: Array = array("n_gyroscopic")
    """component i of h(e_j, e_k) at (k, i, j), shape (r, 3, r); bodies may share one"""
    gyroscopic_start: Index = array("n_e")
    """first entry of each flexible body in `gyroscopic` and in `turned`"""
    stiff: Index = array("n_e")
    """number of the first coordinates q that have a strain energy beyond the quadratic one"""
    cubic: Array = array("n_cubic")
    """cubic strain energy (stiff, stiff, stiff), one body after the other"""
    cubic_start: Index = array("n_e")
    """first entry of each flexible body in `cubic`"""
    quartic: Array = array("n_quartic")
    """quartic strain energy (stiff, stiff, stiff, stiff), one body after the other"""
    quartic_start: Index = array("n_e")
    """first entry of each flexible body in `quartic`"""
    row: Index = array("n_e_1")
    """first entry of each flexible body in the slopes A q (n, r)"""


class AxialForces(Struct):
    """Axial forces of flexible bodies over critical loads."""

    body: Index = array("n_axial")
    """flexible body of each force"""
    start: Index = array("n_axial")
    """first weight of each force; there is one for each dof of its body"""
    weight: Array = array("n_weights")
    """axial force per load on a dof, over the critical load"""
    line: Array = array("n_axial", 3)
    """direction of each force, in body axes"""
    factor: Array = array("n_axial")
    """1 / (critical load times length) of each [1/(N m)]"""
    spread: Array = array("n_axial")
    """second moment of the mass along the line, over critical load and length [s^2]"""
    share: Array = array("n_axial")
    """step over the time over which forces are averaged"""


class Elastic(Struct):
    """Flexible bodies and their elastic dofs.

    The dofs are those of the interfaces, and for a body with terms of second order 6 of inertia
    and r coordinates q more.
    """

    body: Index = array("n_e")
    """body of each flexible body"""
    of_body: Index = array("n_b")
    """flexible body of each body, -1: rigid"""
    size: Array = array("n_e")
    """length with which the displacements of each flexible body are compared [m]"""
    dof: Index = array("n_e_1")
    """first dof of each flexible body, in u"""
    active: Index = array("n_a")
    """active dofs, as places in u"""
    active_range: Index = array("n_e_1")
    """first entry of each flexible body in `active`"""
    loaded: Index = array("n_loaded")
    """active dofs and dofs of patterns that carry loads, as places in u, body by body"""
    loaded_range: Index = array("n_e_1")
    """first entry of each flexible body in `loaded`"""
    pattern_dof: Index = array("n_g")
    """dofs of all load patterns, with or without loads, as places in u"""
    G_0: Array = array("n")
    """instantaneous compliances (n_c, n_c), one body after the other; bodies may share one"""
    G_0_start: Index = array("n_e")
    """first entry of each flexible body in `G_0`"""
    G_active: Array = array("n")
    """weight G_0 at the active dofs, one body after the other"""
    G_active_start: Index = array("n_e")
    """first entry of each flexible body in `G_active`"""
    length: Array = array("n_a")
    """factor that makes the residual of each active dof a length or an angle"""
    modes: Modes
    kernels: Kernels
    second: SecondOrder
    axial: AxialForces


class Sensors(Struct):
    """Channels of sensors in flexible bodies."""

    body: Index = array("n_z")
    """body of each channel"""
    dof: Index = array("n_z")
    """elastic dof of each channel, in u"""
    axis: Index = array("n_z")
    """0, 1, 2: axis of a point, whose channels follow one another; -1: a gauge"""
    X: Array = array("n_z", 3)
    """place of the sensor from the center of mass, in body axes [m]"""


class InterfaceState(Struct):
    """Elastic dofs: displacements and rotation vectors of interfaces, changes of inertia, q."""

    u: Array = array("n_u")
    """values of the dofs, in body axes [m, rad]"""
    rate: Array = array("n_u")
    """first time derivative of u"""
    acceleration: Array = array("n_u")
    """second time derivative of u"""
    a: Array = array("n_u")
    """pseudo-acceleration of generalized-alpha for u"""
    p: Array = array("n_u")
    """loads on the dofs, in body axes [N, N m]"""


class ModalState(Struct):
    """Modal coordinates, for mode shapes of unit modal mass."""

    eta: Array = array("n_m")
    """modal coordinates [m sqrt(kg)]"""
    rate: Array = array("n_m")
    """first time derivative of eta"""
    acceleration: Array = array("n_m")
    """second time derivative of eta"""
    a: Array = array("n_m")
    """pseudo-acceleration of generalized-alpha for eta"""
    stretch: Array = array("n_x")
    """stretch of the springs of chains [m sqrt(kg)]"""


class PastState(Struct):
    """Past loads of bodies whose kernels are convolved."""

    p_rest: Array = array("n_u")
    """loads that have always acted, without history [N, N m]"""
    u_rest: Array = array("n_u")
    """displacements by p_rest beyond the instantaneous ones, (compliance - G_0) p_rest [m, rad]"""
    p_start: Array = array("n_u")
    """loads that begin at t = 0, convolved with g_initial [N, N m]"""
    p: Array = array("n_u", "n_p")
    """loads at the steps from first[0] on, less p_rest [N, N m]"""
    u_ahead: Array = array("n_u", "n_p")
    """displacements at the steps from first[0] on by the loads before step `since` [m, rad]"""
    first: Index = array(1)
    """step of the first column of `p` and `u_ahead`"""
    since: Index = array("n_e")
    """first step whose loads the time loop convolves itself"""


class InterfaceWork(Struct):
    """Elastic dofs at the start of a step, predicted, and their residual."""

    u_n: Array = array("n_u")
    """u at the start of the step"""
    p_n: Array = array("n_u")
    """p at the start of the step"""
    u_predicted: Array = array("n_u")
    """u at the end of the step for acceleration = 0"""
    rate_predicted: Array = array("n_u")
    """rate at the end of the step for acceleration = 0"""
    rate_n: Array = array("n_u")
    """rate at the start of the step"""
    history: Array = array("n_u")
    """u at the end of the step by past loads alone"""
    residual: Array = array("n_a")
    """residual of compatibility at the active dofs"""
    p_active: Array = array("n_a")
    """p at the active dofs"""


class SecondOrderWork(Struct):
    """Products of the terms of second order with q and its rates."""

    slope: Array = array("n_slopes")
    """A q (n, r) of the active dofs before q, one body after the other"""
    curvature: Array = array("n_u")
    """1/2 A(q, q) at the end of the last step"""
    bend: Array = array("n_u")
    """change of 1/2 A(q, q) in the last step"""
    at_q: Array = array("n_e", "n_3q")
    """h(q, .) (3, r)"""
    at_rate: Array = array("n_e", "n_3q")
    """h(q', .) (3, r)"""
    by_rate: Array = array("n_e", "n_3q")
    """h(., q') (3, r)"""


class ModalWork(Struct):
    """Modes within a step."""

    a: Array = array("n_m")
    """pseudo-acceleration at the end of the step"""
    load: Array = array("n_m")
    """modal loads"""
    rate_n: Array = array("n_m")
    """rate at the start of the step"""
    eta_n: Array = array("n_m")
    """eta at the start of the step, where some body has a chain"""
    eta_change: Array = array("n_m")
    """change of eta in the step, of bodies with a chain"""
