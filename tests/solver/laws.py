"""Force laws of all kinds for tests, those of a user included."""

import math

from duhamel.solver import (
    BoucWenLaw,
    DamperLaw,
    ElastoplasticLaw,
    IwanLaw,
    MaxwellLaw,
    OneSidedLaw,
    TabulatedDamperLaw,
    TabulatedLaw,
    UserLaw,
)


def cubic(parameters, memory, h, c, rate):
    """A hardening spring with a damper."""
    k, d = parameters[0], parameters[1]
    return k * c**3 + d * rate, 3.0 * k * c**2, d, 0.25 * k * c**4


def branch(parameters, memory, h, c, rate):
    """A Maxwell branch: stiffness and relaxation time; it remembers deformation and force."""
    k, tau = parameters[0], parameters[1]
    x = h / tau
    decay = math.exp(-x)
    slope = k if x == 0.0 else k * (1.0 - decay) / x
    force = decay * memory[1] + slope * (c - memory[0])
    return force, slope, 0.0, 0.5 * force**2 / k


def remember_branch(parameters, memory, h, c, rate):
    force, _, _, _ = branch_compiled(parameters, memory, h, c, rate)
    memory[0] = c
    memory[1] = force


def compiled(function):
    from numba import njit

    return njit(function)


branch_compiled = compiled(branch)

LAWS = {
    "table": TabulatedLaw((-1.0, 0.0, 1.0), (-3.0, 0.0, 8.0)),
    "stop": OneSidedLaw(gap=0.1, stiffness=40.0, exponent=1.5),
    "cable": OneSidedLaw(gap=-0.05, stiffness=30.0, side="extension"),
    "damper": DamperLaw(compression=0.8, rebound=2.0),
    "damper curve": TabulatedDamperLaw((-2.0, 0.0, 1.0, 3.0), (-4.0, 0.0, 3.0, 4.0)),
    "Bouc-Wen": BoucWenLaw(yield_deformation=0.1, stiffness=20.0, post_yield=0.2),
    "Bouc-Wen, slim": BoucWenLaw(0.2, 20.0, 0.1, exponent=1.5, beta=0.8),
    "Bouc-Wen, sharp": BoucWenLaw(0.05, 20.0, exponent=4.0),
    "Bouc-Wen, round and slim": BoucWenLaw(0.05, 20.0, beta=1.0),
    "Maxwell": MaxwellLaw((0.01, 0.3), (5.0, 7.0)),
    "plastic": ElastoplasticLaw(2.0, stiffness=20.0),
    "plastic, kinematic": ElastoplasticLaw(2.0, 20.0, post_yield=0.2),
    "plastic, mixed": ElastoplasticLaw(1.0, 20.0, 0.3, isotropic=0.4),
    "Iwan": IwanLaw(4.0, 20.0, chi=-0.4, beta=0.5, elements=5),
    "user": UserLaw(cubic, [3.0, 0.2]),
    "user with memory": UserLaw(branch, [5.0, 0.02], [0.0, 0.0], remember_branch),
}
