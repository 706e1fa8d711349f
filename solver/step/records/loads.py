"""Records of loads on frames and of load patterns (step/loads.py, step/patterns.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class Loads(Struct):
    """Loads on frames."""

    frame: Index = array("n_l")
    """frame of each load"""
    kind: Index = array("n_l")
    """number of the kind of each load (step/loads.py)"""
    moment: Index = array("n_l")
    """1: acts as a moment, 0: as a force"""
    by_velocity: Index = array("n_l")
    """1: depends on the velocity of the frame"""
    first: Index = array("n_l1")
    """first of the parameters of each load"""
    parameters: Array = array("n_load_parameters")
    """parameters of all loads, one load after the other"""
    n_by_velocity: int
    """number of loads that depend on velocities"""


class LoadPatterns(Struct):
    """Loads that are spread over flexible bodies."""

    body: Index = array("n_t")
    """body of each pattern"""
    dof: Index = array("n_t")
    """elastic dof of each pattern, in u"""
    signal: Index = array("n_t")
    """number of its amplitude among the signals of loads"""
    force: Array = array("n_t", 3)
    """resultant force at amplitude 1, in body axes [N]"""
    moment: Array = array("n_t", 3)
    """resultant moment about the center of mass at amplitude 1, in body axes [N m]"""


class LoadState(Struct):
    """Loads on frames at the last step, for their work."""

    value: Array = array("n_l")
    """signal"""
    vector: Array = array("n_l", 3)
    """force [N] or moment [N m], in space"""
    position: Array = array("n_l", 3)
    """position of the loaded frame, in space [m]"""
    axes: Array = array("n_l", 3, 3)
    """rotation from the axes of the loaded frame to space"""


class PatternState(Struct):
    """Load patterns at the last step, for their work."""

    value: Array = array("n_t")
    """amplitude"""
    wrench: Array = array("n_t", 6)
    """force [N] and moment about the center of mass [N m], in space"""
    position: Array = array("n_t", 3)
    """center of mass of the loaded body, in space [m]"""
    axes: Array = array("n_t", 3, 3)
    """rotation from the axes of the loaded body to space"""


class LoadWork(Struct):
    """Signals and tangents of loads."""

    value: Array = array("n_y")
    """signals at the end of the step: those of loads on frames, then those of patterns"""
    tangent: Array = array(3, 12, real=True)
    """derivative of one load by (delta r, delta theta) and the velocities of its frame, in space"""
    forces_by_motion: Array = array(12, 12, real=True)
    """row j: generalized forces per unit of motion j of the frame, (delta r, delta theta) and
    velocities, in space"""
    frame_tangent: Array = array(12, 12, real=True)
    """derivative of the generalized forces of one load by the coordinates of its frame"""
    motion: Array = array(3)
    """displacement [m] or rotation vector [rad] of one loaded frame or body in a step, in space"""
