"""Records of couplings: rows, terms, drives and observed coordinates (step/couplings.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array
from .contacts import Friction
from .laws import Laws


class Rows(Struct):
    """Scalar coordinates of pairs of frames A and B; rows.py and gaps.py define their kinds."""

    kind: Index = array("n")
    """number of the kind of each row"""
    frame_a: Index = array("n")
    """frame A"""
    frame_b: Index = array("n")
    """frame B"""
    a: Array = array("n", 3)
    """axis carried by frame A, in the axes of A"""
    a_turned: Array = array("n", 3)
    """axis that `a` becomes after a quarter turn, in the axes of A"""
    b: Array = array("n", 3)
    """axis carried by frame B, in the axes of B"""
    shape: Index = array("n")
    """number of the surface, in rows of contacts (shapes.py)"""
    size: Array = array("n")
    """radii of ball and surface together, in rows of contacts with a curved surface; infinite in
    other rows [m]"""
    first: Index = array("n_1")
    """first of the parameters of each row"""
    parameters: Array = array("n_parameters")
    """parameters of all rows, one row after the other (`gap_parameters` in gaps.py)"""
    zero: Array = array("n")
    """value that is subtracted from a length or an angle [m, rad]"""
    axis: Index = array("n")
    """first of three drives that are the components of `a` in the axes of A; -1: `a` is fixed"""


class Terms(Struct):
    """Coordinates of other pairs of frames that join the constraints of some rows (terms.py)."""

    rows: Rows
    """the coordinates"""
    ratio: Array = array("n_terms")
    """factor of each coordinate in its constraint"""
    row: Index = array("n_terms")
    """row that each term joins"""
    number: Index = array("n_terms")
    """place of that row among the rows of its coupling"""
    own: Index = array("n_terms")
    """coupling whose own frames the term is between, -1: it is between other frames"""
    range: Index = array("n_i_1")
    """first term of each row"""


class Couplings(Struct):
    """Joints, motions, springs, contacts, stops, motors and couplers.

    Each is a range of rows. A row has a multiplier, which keeps its coordinate at 0 or obeys a
    force law.
    """

    rows: Rows
    terms: Terms
    laws: Laws
    friction: Friction
    friction_of: Index = array("n_j")
    """friction of each coupling, -1: none"""
    contact: Index = array("n_k")
    """coupling of each contact; its rows act only while the law of the first is engaged"""
    contact_of: Index = array("n_j")
    """contact that each coupling is, -1: none"""
    switching: Index = array("n_w")
    """couplings that open and close, or stick and slip"""
    n_compliant: int
    """number of rows that obey a force law"""
    n_by_rate: int
    """number of rows with residuals by their rates: force laws, and slip that is forbidden"""
    range: Index = array("n_j_1")
    """first row of each coupling"""
    second: Index = array("n_i")
    """place of the second frame that the coupling names in the gradient: 6, or 0 if it is A"""
    drive: Index = array("n_i")
    """first drive of each row, -1: none"""
    driven: Index = array("n_d")
    """row of each drive"""
    compliant: Index = array("n_i")
    """1: the row obeys a force law, 0: it is a constraint"""


class CouplingState(Struct):
    """Multipliers, coordinates and memories of rows."""

    lam: Array = array("n_i")
    """multipliers: forces [N] or moments [N m]"""
    coordinate: Array = array("n_i")
    """coordinates at the last step, from which angles are continued over full turns [m, rad]"""
    rate: Array = array("n_i")
    """rates of the coordinates at the last step [m/s, rad/s]"""
    bristle: Array = array("n_i")
    """deflection of the bristles of friction [m, rad]"""
    memory: Array = array("n_h")
    """numbers that force laws remember, one law after the other"""


class TermState(Struct):
    """Coordinates of terms at the last step."""

    coordinate: Array = array("n_terms")
    """[m, rad]"""
    rate: Array = array("n_terms")
    """[m/s, rad/s]"""


class ObserverState(Struct):
    """Joint coordinates that are only observed, at the last step."""

    value: Array = array("n_o")
    """[m, rad]"""
    rate: Array = array("n_o")
    """[m/s, rad/s]"""


class DriveState(Struct):
    """Drives at the last step, for their work."""

    value: Array = array("n_d")
    """[m, rad], or a component of an axis"""
    force: Array = array("n_d")
    """work per unit of the drive [N, N m]"""


class CouplingWork(Struct):
    """Coordinates, residuals and derivatives of rows."""

    lam_n: Array = array("n_i")
    """multipliers at the start of the step [N, N m]"""
    elapsed: Array = array(1)
    """time since force laws last remembered, infinite at the start [s]"""
    status: Index = array("n_j")
    """contacts: 0 open, 1 closed; with friction 1 sticks, 2 slips"""
    status_n: Index = array("n_j")
    """status at the start of the step"""
    holds: Index = array(1)
    """1: friction sticks whatever its force, while Newton's method looks for where it would"""
    blocked: Index = array("n_i")
    """1: the ball was last beyond an end of the shape, or came in from there"""
    slip_axis: Array = array("n_i", 3)
    """axis from which the directions of slip are taken, in the axes of frame A"""
    normal_slope: Array = array("n_i", real=True)
    """derivative of the normal force of friction by each multiplier"""
    Z: Array = array("n_i", 8, real=True)
    """derivative of the residual of a row with friction by the multipliers of its coupling"""
    near: Array = array("n_i")
    """coordinates expected at the end of the step, to which angles are the nearest [m, rad]"""
    coordinate: Array = array("n_i")
    """[m, rad]"""
    rate: Array = array("n_i")
    """time derivative of the coordinates [m/s, rad/s]"""
    phi: Array = array("n_i")
    """residual: of a constraint [m, rad], or of a force law [N, N m]"""
    scale: Array = array("n_i")
    """sum of the magnitudes of the terms of a force law [N, N m]"""
    gradient: Array = array("n_i", 12)
    """derivative of the coordinates by (r, theta) of frames A and B, in space"""
    convective: Array = array("n_i")
    """second time derivative of phi where no body accelerates [m/s^2, rad/s^2]"""
    wrench: Array = array("n_j", 6)
    """force [N] and moment [N m] of each coupling on its second frame, in space"""
    B: Array = array("n_i", 24, real=True)
    """derivative of the coordinates by the generalized coordinates of frames A and B"""
    B_rate: Array = array("n_i", 24, real=True)
    """derivative of the rates by the generalized coordinates of frames A and B"""
    A: Array = array("n_i", 24, real=True)
    """derivative of phi by the generalized coordinates of frames A and B; h^2 times that for a
    force law"""
    tangent: Array = array(12, 12, real=True)
    """derivative of the wrenches of one coupling on frames A and B by their (delta r, delta
    theta), in space, at constant multipliers"""
    rate_tangent: Array = array(12, 12, real=True)
    """derivative of the wrenches of one row on frames A and B by their (delta r, delta theta), in
    space, at a multiplier of 1"""
    rate_gradient: Array = array(12, real=True)
    """derivative of the rate of one row by (r, theta) of frames A and B"""
    slope_gradient: Array = array(12)
    """gradient of one driven row whose axis is turned a quarter turn ahead"""


class TermWork(Struct):
    """Coordinates and derivatives of terms."""

    near: Array = array("n_terms")
    """coordinates expected at the end of the step, to which angles are the nearest [m, rad]"""
    coordinate: Array = array("n_terms")
    """[m, rad]"""
    rate: Array = array("n_terms")
    """[m/s, rad/s]"""
    gradient: Array = array("n_terms", 12)
    """derivative of the coordinates by (r, theta) of frames A and B, in space"""
    B: Array = array("n_terms", 24, real=True)
    """derivative of the coordinates by the generalized coordinates of frames A and B"""


class ObserverWork(Struct):
    """Observed coordinates and derivatives of them."""

    value: Array = array("n_o")
    """[m, rad]"""
    gradient: Array = array(12)
    """derivative of one coordinate by (r, theta) of frames A and B, in space"""
    B: Array = array("n_o", 24)
    """derivative of the coordinates by the generalized coordinates of frames A and B"""


class DriveWork(Struct):
    """Signals of drives, and derivatives of residuals by them."""

    value: Array = array("n_d")
    """signal at the end of the step [m, rad], or a component of an axis"""
    rate: Array = array("n_d")
    """first time derivative of the signal at the start of a run"""
    acceleration: Array = array("n_d")
    """second time derivative of the signal at the start of a run"""
    slope: Array = array("n_d")
    """derivative of phi by the drive"""
