"""Cords that are too stiff for the lowest lines of a test, by its mass line."""

import numpy as np

from ..identification.responses import Measurement
from .mass_line import LEAST_OF_LINE, mass_line

STIFF_SUSPENSION = 0.25
"""frequency on the cords over that of the lowest line, from which on a warning tells of it; that of
simulated tests is found within 0.04"""
SURE_OF_SUSPENSION = 2.0
"""standard deviations by which its square is above the limit"""

LEAST_PART = 0.3
"""of the rigid motion in a line: below, cords turn the part more than they hold it"""


def stiff_suspension(measured: Measurement) -> float:
    """The frequency [Hz] of a part on cords that are too stiff for the lowest lines, or 0.

    By the part alpha(f) of A in the responses, which on cords alone is f^2 / (f^2 - f_s^2):

        1 / alpha = a - b Re h(f) + c / f^2,      f_s^2 = -c / a

    h of the first mode, which without damping is f^2 / (f^2 - f_1^2). All this is smooth at the
    resonance of the cords too.
    """
    line = mass_line(measured.s, measured.H)
    if line is None:
        return 0.0
    rows = measured.outputs @ measured.rigid, measured.inputs @ measured.rigid
    A = rows[0] @ np.linalg.solve(measured.M, rows[1].T)
    alpha = np.einsum("kab,ab->k", line.H, A) / (A**2).sum()
    above = alpha > LEAST_PART
    if above.sum() < LEAST_OF_LINE:
        return 0.0
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
