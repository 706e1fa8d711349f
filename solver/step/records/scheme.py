"""Records of time integration: the scheme, and the settings of Newton's method."""

from ...compiler.struct import Struct


class Scheme(Struct):
    """The generalized-alpha scheme with its step (solver/lower/scheme.py)."""

    h: float
    """time step [s]"""
    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    beta_prime: float
    """change of an acceleration with its coordinate in a step [1/s^2]"""
    gamma_prime: float
    """change of a rate with its coordinate in a step [1/s]"""
    inertia_ratio: float
    """acceleration over pseudo-acceleration at the end of a step: (1 - alpha_m) / (1 - alpha_f)"""
    weight: float
    """weight of p_{n+1} against p_n in the convolution: 1, or 1/2 in eq. (55)"""
    stride: int
    """time step in units of the shortest step of the run, by which steps are counted"""
    ratio: int
    """longest step over shortest step of the run; 1: all steps are equal"""


class Newton(Struct):
    """The settings of Newton's method."""

    tolerance: float
    """relative residual at which a step has converged"""
    max_iterations: int
    """number of iterations after which a step has failed"""
    fixed_iterations: int
    """number of iterations after which a step ends without an error; 0: converge or fail"""
    reuse: float
    """ratio of successive corrections above which a new matrix is made; 0: always"""
