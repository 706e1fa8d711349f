"""The shifts of the Krylov space: of the time step, and a low one."""

import numpy as np

from ...superelement import GeneralizedAlpha
from ..assembly.structure import Structure
from ..body.damping import Damping, Rayleigh
from .band import Band
from .lowest import first_square

LOW_SHIFT_RATIO = 0.1  # to the square of the first frequency, about
SHARED_SHIFT_FACTOR = 4.0
"""A step whose shift is within this factor of the low one, squared, serves for both."""
MAX_HELD_SHIFT = 10.0
"""A space that holds the band holds responses with shifts up to this multiple of the square of its
top: of 7, g[0] was right to 1e-11 where the band was to 1e-7.
"""


def shifts(structure: Structure, damping: Damping, band: Band) -> tuple[float, float | None]:
    """s of the time step, and a low one.

    Where the first is low enough, there is no other. A low shift tells low frequencies apart, and
    static responses are nearly its own; it takes the fewest blocks for the whole of the band.
    """
    shift = _shift(damping, band.scheme, band.h)
    low = LOW_SHIFT_RATIO * first_square(structure)
    return shift, low if shift > SHARED_SHIFT_FACTOR**2 * low else None


def far_above(shift: float, band: Band) -> bool:
    """Whether a shift is so far above the band that a space which holds the band does not hold
    responses with that shift: g[0], if the shift is that of the step.
    """
    return shift > MAX_HELD_SHIFT * (2.0 * np.pi * band.top) ** 2


def _shift(damping: Damping, scheme: GeneralizedAlpha, h: float) -> float:
    """s for which K + s M is the matrix of the time step, up to a factor.

    Modal ratios add no matrix to it.
    """
    mass, stiffness = (damping.rayleigh or Rayleigh()).coefficients
    velocity, hardening = scheme.gamma_prime(h), 0.0
    if (chain := damping.chain) is not None:
        hardening = float(chain.step(h)[1] @ chain.amplitude)
    return (scheme.beta_prime(h) + velocity * mass) / (1.0 + hardening + velocity * stiffness)
