"""Cords that are too stiff for the lowest lines of a test, by its mass line or their resonances."""

import numpy as np
from scipy.signal import find_peaks

from ...files.arrays import Array
from ..identification.responses import Measurement
from .first_resonance import BEYOND_CORDS
from .mass_line import LEAST_OF_LINE, mass_line

STIFF_SUSPENSION = 0.25
"""frequency on the cords over that of the lowest line, from which on a warning tells of it; that of
simulated tests is found within 0.04"""
SURE_OF_SUSPENSION = 2.0
"""standard deviations by which its square is above the limit"""

LEAST_PART = 0.3
"""of the rigid motion in a line: below, cords turn the part more than they hold it"""
PEAK_PROMINENCE = float(np.log(1.5))
"""of a resonance among the levels of lines"""
MOST_BENDING = 0.5
"""of the responses at a resonance of cords; they have up to 0.14, those of bending 0.75"""
LINES_BEYOND, LEAST_BEYOND = 2.0 * BEYOND_CORDS, 0.5
"""up to which of a resonance lines have so much of the rigid motion: beyond its own, a part moves
against that"""


def stiff_suspension(measured: Measurement) -> float:
    """The frequency [Hz] of a part on cords that are too stiff for the lowest lines, or 0.

    By the part alpha(f) of A in the responses, which on cords alone is f^2 / (f^2 - f_s^2):

        1 / alpha = a - b Re h(f) + c / f^2,      f_s^2 = -c / a

    h of the first mode, which without damping is f^2 / (f^2 - f_1^2). All this is smooth at the
    resonance of the cords too.
    """
    line = mass_line(measured.s, measured.H)
    if line is None:
        return _resonance_on_cords(measured)
    alpha = _part_of_rigid_motion(measured)[: len(line.f)]
    above = alpha > LEAST_PART
    if above.sum() < LEAST_OF_LINE:
        return _resonance_on_cords(measured)
    by_cords = (line.f[0] / line.f) ** 2
    functions = np.column_stack([np.ones_like(line.f), line.by_mode, by_cords])[above]
    inverse = 1.0 / alpha[above]
    found = np.linalg.lstsq(functions, inverse, rcond=None)[0]
    # With few lines noise alone can look like cords.
    variance = ((inverse - functions @ found) ** 2).sum() / (len(inverse) - len(found))
    deviation = np.sqrt(variance * np.linalg.inv(functions.T @ functions)[2, 2])
    square, error = float(-found[2] / found[0]), float(deviation / abs(found[0]))
    if square - SURE_OF_SUSPENSION * error < STIFF_SUSPENSION**2:
        return 0.0
    return float(line.f[0] * np.sqrt(square))


def _part_of_rigid_motion(measured: Measurement) -> Array:
    """alpha (k,) of A in the real parts of the responses."""
    rows = measured.outputs @ measured.rigid, measured.inputs @ measured.rigid
    A = rows[0] @ np.linalg.solve(measured.M, rows[1].T)
    return np.asarray(np.einsum("kab,ab->k", measured.H.real, A) / (A**2).sum())


def _resonance_on_cords(measured: Measurement) -> float:
    """The highest frequency [Hz] of resonances that move all channels as a rigid part, or 0."""
    f, H = measured.s.imag / (2.0 * np.pi), measured.H
    Q, _ = np.linalg.qr(measured.outputs @ measured.rigid)
    squares = (np.abs(H) ** 2).sum(axis=(1, 2))
    bent = 1.0 - (np.abs(Q.T @ H) ** 2).sum(axis=(1, 2)) / squares
    alpha, found = _part_of_rigid_motion(measured), 0.0
    for k in find_peaks(0.5 * np.log(squares), prominence=PEAK_PROMINENCE)[0]:
        if bent[k] > MOST_BENDING**2:
            break
        beyond = (f > BEYOND_CORDS * f[k]) & (f < LINES_BEYOND * f[k])
        if beyond.any() and np.median(alpha[beyond]) > LEAST_BEYOND:
            found = float(f[k])
    return found
