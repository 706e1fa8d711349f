"""Checks of a force law, for those who write one."""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np

from .law import Evaluation, ForceLaw

DIFFERENCE_STEP = 1e-6
"""step of differences, over the largest deformation"""
SLOPE_TOLERANCE = 1e-6
"""relative error of a derivative that differences may show"""
FORCE_ROUNDING = 1e-14
"""relative rounding of forces and energies, of which differences are taken"""


def check_law(
    law: ForceLaw, deformations: Sequence[float], rates: Sequence[float] = (0.0,), h: float = 1e-3
) -> None:
    """Compare a law with central differences, at some deformations and rates.

    A law is checked where it is smooth: leave its kinks out.

    Parameters
    ----------
    law : ForceLaw
    deformations : sequence of float [m, rad]
    rates : sequence of float [m/s, rad/s]
    h : float [s]
        The time after the start.

    Raises
    ------
    ModelError
        For derivatives that are not those of the force, for a law without memory whose stored
        energy is not the work of its force at rest, and for one that gives another force after it
        has remembered. See `UserLaw` for an example.
    """
    largest = max(map(abs, deformations), default=0.0)
    for c, rate in product(deformations, rates):
        _check_at(law, h, c, rate, DIFFERENCE_STEP * (largest or 1.0))


def _check_at(law: ForceLaw, h: float, c: float, rate: float, e: float) -> None:
    parameters, memory = np.array(law.parameters(), float), np.array(law.memories(), float)

    def at(c: float, rate: float) -> Evaluation:
        return law.evaluate(parameters, memory, h, c, rate)

    force, by_c, by_rate, energy = at(c, rate)
    steepness = abs(force) / e
    found = [
        ("derivative by c", by_c, _slope(lambda x: at(x, rate)[0], c, e), steepness),
        ("derivative by dc/dt", by_rate, _slope(lambda x: at(c, x)[0], rate, e), steepness),
    ]
    if len(memory):
        law.remember(parameters, memory, h, c, rate)
        again = law.evaluate(parameters, memory, 0.0, c, rate)
        found += [
            ("force before it has remembered", force, again[0], 0.0),
            ("stored energy before it has remembered", energy, again[3], 0.0),
        ]
    else:
        work = _slope(lambda x: at(x, 0.0)[3], c, e)
        found += [("force without rate", at(c, 0.0)[0], work, abs(energy) / e)]
    for what, value, expected, size in found:
        if not abs(value - expected) <= SLOPE_TOLERANCE * abs(expected) + FORCE_ROUNDING * size:
            raise law.error(
                f"{type(law).__name__}: {what} at c = {c:g}, dc/dt = {rate:g}: got {value:.9g}, "
                f"expected {expected:.9g}"
            )


def _slope(function: Callable[[float], float], x: float, e: float) -> float:
    return (function(x + e) - function(x - e)) / (2.0 * e)
