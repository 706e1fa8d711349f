"""How far a part that is identified from a test is from the part that was tested."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from ...files.arrays import Array
from ...superelement import Superelement
from ..measured.rigid import RigidProperties
from .free_part import FreePart, stacked_motions

SAME_MODE = 0.02
"""relative difference of frequencies within which a mode is found"""
COMPARED_LINES = 1200


@dataclass(frozen=True, eq=False)
class PredictedErrors:
    """Errors of an identified part, relative, in the band that it states.

    found, modes: how many of the modes of the part it has; frequency, damping: the largest errors
    of these; responses (3,): root mean squares of the accelerances of all interfaces, over those of
    the part, in each third of the band.
    """

    found: int
    modes: int
    frequency: float
    damping: float
    responses: Array


def predicted_errors(part: FreePart, element: Superelement, lowest: float) -> PredictedErrors:
    """The errors of a superelement that a test from `lowest` [Hz] on made of a part."""
    modes, highest = element.modes, element.kernel.band
    assert modes is not None
    assert highest is not None
    # Beyond its band the superelement states no error, and below it nothing was measured.
    frequencies = part.modes.resonances / (2.0 * np.pi)
    true = np.flatnonzero((frequencies >= lowest) & (frequencies < highest))
    omega, zeta = part.modes.resonances[true], part.damping[true]
    apart = np.abs(np.log(modes.omega[None] / omega[:, None]))
    # One to one: a mode that was found twice is not another one.
    # What is too far apart costs the same wherever it is, or one missing mode would shift all.
    rows, columns = linear_sum_assignment(np.minimum(apart, SAME_MODE))
    same = apart[rows, columns] < SAME_MODE
    rows, columns = rows[same], columns[same]
    return PredictedErrors(
        found=len(rows),
        modes=len(true),
        frequency=_largest(apart[rows, columns]),
        damping=_largest(np.abs(modes.zeta[columns] / zeta[rows] - 1.0)),
        responses=_of_responses(part, element, np.linspace(lowest, highest, COMPARED_LINES)),
    )


def _largest(errors: Array) -> float:
    """Of modes that were found; nan where there are none."""
    return float(errors.max()) if len(errors) else np.nan


def _of_responses(part: FreePart, element: Superelement, f: Array) -> Array:
    s = np.asarray(2j * np.pi * f, dtype=complex)
    assert element.modes is not None
    rigid = RigidProperties(element.mass, element.center, element.J_rot)
    found = FreePart(element.name, rigid, element.interfaces, element.modes)
    own = [found.at_interface(interface.name) for interface in element.interfaces]
    true = []
    for interface, motion in zip(element.interfaces, own, strict=True):
        whole_motion = part.at_interface(interface.name)
        # Of a point that does not turn in the test, the displacements.
        true.append(whole_motion.along(np.eye(len(motion.rigid), len(whole_motion.rigid))))
    H = found.accelerance(s, stacked_motions(own), stacked_motions(own))
    expected = part.accelerance(s, stacked_motions(true), stacked_motions(true))
    # Rotations and displacements have different units: each dof counts by its own responses.
    size = np.sqrt(np.abs(np.einsum("kaa->ka", expected)).mean(axis=0))
    weighted = np.outer(size, size)
    difference, whole = np.abs((H - expected) / weighted) ** 2, np.abs(expected / weighted) ** 2
    thirds = zip(
        np.array_split(difference.sum(axis=(1, 2)), 3),
        np.array_split(whole.sum(axis=(1, 2)), 3),
        strict=True,
    )
    return np.array([float(np.sqrt(a.sum() / b.sum())) for a, b in thirds])
