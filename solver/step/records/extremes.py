"""Records of energies and of the largest values of a run (step/extremes.py, body_extremes.py)."""

from ...arrays import Array, Index
from ...compiler.struct import Struct, array


class EnergyState(Struct):
    """Energies at the last step, and work summed over all steps [J]."""

    kinetic: Array = array(1)
    """kinetic energy of the rigid motion"""
    potential: Array = array(1)
    """potential energy in gravity"""
    modal: Array = array(1)
    """work of the interface loads on bodies whose history modes carry"""
    convolved: Array = array(1)
    """work of the interface loads on bodies whose kernels are convolved"""
    residual: Array = array(1)
    """energy of the residual flexibility of surfaces in contact"""
    damping: Array = array(1)
    """energy taken by the damping of modes and of the material"""
    friction: Array = array(1)
    """energy taken by friction in contacts of surfaces"""
    switching: Array = array(1)
    """work of contacts of surfaces on gaps that close or open within a step, which is an error"""
    work: Array = array(1)
    """work of loads, drives and motors"""
    compliance: Array = array("n_j")
    """work of each spring or damper on the bodies"""


class MotionExtremes(Struct):
    """Sums over steps from which the frequencies of bodies as a whole follow.

    Where the second index is 0 or 1, 0 stands for velocities in space [m/s] and 1 for angular
    velocities in body axes [rad/s].
    """

    row: Index = array(1)
    """steps of the longest size in a row"""
    steps: Index = array(1)
    """number of steps in all sums: those of the longest size that followed another such step"""
    velocity: Array = array("n_b", 6)
    """v at the last step"""
    change: Array = array("n_b", 6)
    """change of v in the last step"""
    sum: Array = array("n_b", 6)
    """sum of v"""
    square: Array = array("n_b", 2)
    """sum of |v|^2"""
    changes: Array = array("n_b", 2)
    """sum of the squared changes of v in a step"""
    bends: Array = array("n_b", 2)
    """sum of the squared changes, from step to step, of the change of v"""
    largest: Array = array("n_b", 2)
    """largest squared change of v in a step"""


class MomentumExtremes(Struct):
    """Angular momentum of free bodies about their centers of mass, in space."""

    momentum: Array = array("n_free", 3)
    """angular momentum at the last step [kg m^2/s]"""
    moment: Array = array("n_free", 3)
    """moment that acts at the last step [N m]"""
    defect: Array = array("n_free", 3)
    """change of the angular momentum that moments do not explain [kg m^2/s]"""
    largest: Array = array("n_free")
    """largest squared angular momentum"""
    largest_defect: Array = array("n_free")
    """largest squared defect"""


class ExtremeState(Struct):
    """The largest values of all steps, recorded or not, and sums over them."""

    displacement: Array = array("n_f")
    """largest squared elastic displacement of each frame [m^2]"""
    rotation: Array = array("n_f")
    """largest squared elastic rotation of each frame [rad^2]"""
    spin: Array = array("n_b")
    """largest squared angular velocity of each body [rad^2/s^2]"""
    inertia_taken: Array = array("n_e")
    """largest part of a moment of inertia that the elastic motion takes"""
    opening: Array = array("n_i")
    """largest constraint violation of the rows of joints and motions [m, rad]"""
    force: Array = array("n_i")
    """largest magnitude of the multipliers of the rows of joints and motions [N, N m]"""
    missed: Array = array("n_o")
    """largest distance of an observed coordinate from what its mean rate over a step predicts
    [m, rad]"""
    modal_rate: Array = array("n_m")
    """sum of the squared rates of each mode"""
    modal_change: Array = array("n_m")
    """sum of the squared changes of the rate of each mode in a step"""
    interface_rate: Array = array("n_u")
    """sum of the squared rates of each dof of bodies whose kernels are convolved"""
    interface_change: Array = array("n_u")
    """sum of the squared changes of the rate, in a step, of each dof of bodies whose kernels are
    convolved"""
    start: Array = array(2)
    """total and potential energy at t = 0 [J]"""
    moved: Array = array(1)
    """largest energy that moves: kinetic, elastic, and the work of all else [J]"""
    balance: Array = array(1)
    """largest error of the balance of energies [J]"""
    stored: Array = array("n_j")
    """largest energy in each spring [J]"""
    dissipated: Array = array("n_j")
    """largest energy that each spring or damper has taken [J]"""
    returned: Array = array("n_j")
    """largest part of `dissipated` that each spring or damper has given back [J]"""
    shortest: Index = array("n_touching")
    """steps from closing to opening of the shortest event that does not graze, 0: none yet"""
    shortest_peak: Array = array("n_touching")
    """largest normal force of the shortest event [N, N m]"""
    peak: Array = array("n_touching")
    """largest normal force of all events [N, N m]"""
    depth: Array = array("n_k")
    """largest penetration [m, rad]"""
    arm: Array = array("n_k")
    """largest squared arm of the normal force about the frame that carries the shape [m^2]"""
    axial: Array = array("n_axial")
    """largest magnitude of each averaged axial force over its critical load"""
    axial_mean: Array = array("n_axial")
    """averaged axial force over its critical load at the last step, tension positive"""
    motion: MotionExtremes
    momentum: MomentumExtremes
    left: Index = array(1)
    """1 + the first frame that left the range of linear elasticity, 0: none"""
