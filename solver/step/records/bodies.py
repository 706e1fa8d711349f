"""Records of the rigid motion of bodies (step/bodies.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Bodies(Struct):
    """Masses of bodies, and gravity."""

    free: Index = array("n_free")
    """numbers of the bodies that no constraint holds"""
    mass: Array = array("n_b")
    """[kg]"""
    J_rot: Array = array("n_b", 3, 3)
    """moments of inertia about the center of mass, in body axes, undeformed [kg m^2]"""
    gravity: Array = array(3)
    """acceleration of gravity, in space [m/s^2]"""
    size: float
    """size of the model, by which angles are weighed as lengths (`model_size` in lower/size.py)
    [m]"""


class BodyState(Struct):
    """Positions, velocities and accelerations of bodies."""

    x: Array = array("n_b", 3)
    """center of mass, in space [m]"""
    quaternion: Array = array("n_b", 4)
    """unit quaternion (w, x, y, z) of R"""
    R: Array = array("n_b", 3, 3)
    """rotation from body axes to space"""
    v: Array = array("n_b", 6)
    """velocity in space [m/s], angular velocity in body axes [rad/s]"""
    v_dot: Array = array("n_b", 6)
    """time derivative of v [m/s^2, rad/s^2]"""
    a: Array = array("n_b", 6)
    """pseudo-acceleration of generalized-alpha for v [m/s^2, rad/s^2]"""


class BodyWork(Struct):
    """Scratch of bodies."""

    quaternion_n: Array = array("n_b", 4)
    """quaternion at the start of the step"""
    psi: Array = array("n_b", 3)
    """rotation vector from the start of the step to now, in body axes [rad]"""
    x_predicted: Array = array("n_b", 3)
    """x at the end of the step for v_dot = 0 [m]"""
    v_predicted: Array = array("n_b", 6)
    """v at the end of the step for v_dot = 0 [m/s, rad/s]"""
    psi_predicted: Array = array("n_b", 3)
    """psi at the end of the step for v_dot = 0 [rad]"""
    force: Array = array("n_b", 6)
    """generalized forces of loads and couplings: force in space [N], moment in body axes [N m]"""
    force_scale: Array = array("n_b", 2)
    """sums of the magnitudes of all forces [N] and of all moments [N m]"""
    residual: Array = array("n_b", 6)
    """residual of equilibrium: force in space [N], moment in body axes [N m]"""
    J: Array = array("n_b", 3, 3)
    """moments of inertia of the deformed body, in body axes [kg m^2]"""
    relative_momentum: Array = array("n_b", 3)
    """Gamma, the angular momentum of the elastic motion, in body axes [kg m^2/s]"""
    relative_moment: Array = array("n_b", 3)
    """J' omega + Gamma', in body axes [N m]"""
    increment: Array = array(4)
    """quaternion of psi of one body"""
    T_inverse: Array = array(3, 3)
    """inverse tangent T^-1(psi) of one body"""
    inertia: Array = array(3, 3, real=True)
    """derivative of the inertial moments of one body by delta psi, or another matrix of moments of
    inertia"""
