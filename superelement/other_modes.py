"""What follows from the modes of a superelement when they change: damping, and the kernel."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..files.arrays import Array
from .kernel import Kernel, sample_kernel
from .modes import Modes
from .superelement import Superelement
from .validation import SuperelementError

EQUAL_RATIOS = 1e-9
"""relative difference of damping ratios, and of those of Rayleigh's, that is rounding"""
LEAST_MODES_OF_RAYLEIGH = 3
"""any two ratios are Rayleigh's of some coefficients"""
FIRST_LAGS = 10
"""of a kernel: runs take what else they need from the modes, and most need none"""


def ratios_at(element: Superelement, omega: Array) -> Array:
    """The damping ratios (m,) that its modes have once their frequencies are omega (m,) [rad/s].

    A table over frequency is read there; Rayleigh's 2 zeta omega = mass + stiffness omega^2 follow
    the frequencies; one ratio for all modes stays. `SuperelementError` for others. The body file
    tells which it is, or else the ratios, of which one or two may be of any kind.
    """
    assert element.modes is not None
    zeta, before = element.modes.zeta, element.modes.omega
    damping = element.provenance.tables.get("damping", {})
    if isinstance(modal := damping.get("modal"), dict):
        return np.interp(omega / (2.0 * np.pi), modal["frequencies"], modal["ratios"])
    if isinstance(rayleigh := damping.get("rayleigh"), dict):
        return _by_rayleigh(*_coefficients(rayleigh), omega)
    same = np.array_equal(omega, before)
    if same or np.ptp(zeta) <= EQUAL_RATIOS * zeta.max(initial=0.0):
        return zeta
    if zeta.min() > 0.0 and len(zeta) >= LEAST_MODES_OF_RAYLEIGH:
        # Relative to the ratios, that all modes count the same.
        shares = np.stack([0.5 / before, 0.5 * before], axis=1) / zeta[:, None]
        size = shares.max(axis=0)
        found = np.linalg.lstsq(shares / size, np.ones(len(zeta)), rcond=None)[0] / size
        rounding = (np.abs(shares * found) <= EQUAL_RATIOS).all(axis=0)
        mass, stiffness = np.where(rounding, 0.0, found)
        misfit = np.abs(shares @ [mass, stiffness] - 1.0).max()
        if min(mass, stiffness) >= 0.0 and misfit <= EQUAL_RATIOS:
            return _by_rayleigh(mass, stiffness, omega)
    raise SuperelementError(
        f"the damping ratios of {element.name} differ from mode to mode and are not Rayleigh's, so "
        "that those at other frequencies are not known: expected one ratio for all modes, "
        "Rayleigh's or a loss factor"
    )


def _coefficients(rayleigh: Mapping[str, Any]) -> tuple[float, float]:
    """mass [1/s] and stiffness [s] of the table of a body file, or by its two ratios."""
    if "ratios" not in rayleigh:
        return rayleigh.get("mass", 0.0), rayleigh.get("stiffness", 0.0)
    at = 2.0 * np.pi * np.array(rayleigh["frequencies"])
    mass, stiffness = np.linalg.solve(0.5 * np.stack([1.0 / at, at], axis=1), rayleigh["ratios"])
    return mass, stiffness


def _by_rayleigh(mass: float, stiffness: float, omega: Array) -> Array:
    ratios: Array = 0.5 * (mass / omega + stiffness * omega)
    return ratios


def first_lags(modes: Modes, stored: Kernel, band: float | None) -> Kernel:
    """The first lags of the kernel of modes, with the step of a stored one: that is quick."""
    lags = min(stored.steps, FIRST_LAGS)
    return sample_kernel(modes, stored.h, stored.scheme, lags, stored.error, band)
