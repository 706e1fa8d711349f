"""Records of frames on bodies and in space (step/frames.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Frames(Struct):
    """Frames in the undeformed bodies, and where their dofs are."""

    n_acting: int
    """number of frames that carry couplings or loads; they come first"""
    body: Index = array("n_f")
    """body of each frame, -1: fixed in space"""
    X: Array = array("n_f", 3)
    """position from the center of mass, in body axes [m]"""
    D_0: Array = array("n_f", 3, 3)
    """rotation from the axes of the frame to those of the undeformed body"""
    quaternion_0: Array = array("n_f", 4)
    """unit quaternion (w, x, y, z) of D_0"""
    dof: Index = array("n_f")
    """first of the elastic dofs of the frame in u, -1: the frame has none"""
    active: Index = array("n_f")
    """first of its elastic dofs among the active dofs, -1: none"""
    column: Index = array("n_f")
    """first of its active dofs among the coordinates of its body, -1: none"""
    rotations: Index = array("n_f")
    """1: its elastic dofs include rotations"""


class FrameWork(Struct):
    """Motion of frames, and derivatives of it."""

    r: Array = array("n_f", 3)
    """position, in space [m]"""
    D: Array = array("n_f", 3, 3)
    """rotation from the axes of the frame to space"""
    lever: Array = array("n_f", 3)
    """position X + u from the center of mass, in body axes [m]"""
    T: Array = array("n_f", 3, 3)
    """tangent T(w) of the elastic rotation w"""
    wrench: Array = array("n_f", 6)
    """force [N] and moment [N m] on the body at the frame, in space"""
    V: Array = array("n_f", 6)
    """velocity [m/s] and angular velocity [rad/s], in space"""
    A: Array = array("n_f", 6)
    """time derivative of V [m/s^2, rad/s^2], in space"""
    rate_map: Array = array("n_f", 6, 12, real=True)
    """derivative of V by the coordinates delta X, delta Theta, delta u, delta w, in body axes"""
    half_tangent: Array = array(12, 24, real=True)
    """derivative of the wrenches on two frames, in space, by the coordinates of both frames"""
    pair_tangent: Array = array(24, 24, real=True)
    """derivative of the generalized forces on two frames by the coordinates of both frames"""
    small_rotation: Array = array(3, 3)
    """rotation matrix exp(skew(w)) of the elastic rotation of one frame"""
    small_quaternion: Array = array(4)
    """unit quaternion of exp(skew(w)) of one frame"""
    body_quaternion: Array = array(4)
    """unit quaternion of R exp(skew(w)) of one frame"""
    T_inverse: Array = array(3, 3)
    """inverse tangent T^-1(psi) of the rotation of one body in the step"""
    minus_w: Array = array(3)
    """-w of one frame [rad]"""
    moment: Array = array(3)
    """moment, or rate of w, on one frame, in body axes [N m, rad/s]"""
    T_slope: Array = array(3, 3)
    """derivative d(T(w) m)/dw for one vector m"""
