"""Modes of a part from its responses: poles, shapes, rest, refinement, and what is missing."""

from dataclasses import dataclass, replace

import numpy as np

from ...superelement.validation import Array
from .poles import stable_poles
from .refinement import refined_fit
from .responses import REST_DAMPING, Measurement, ModalFit, relative_size, resonances
from .shapes import ResidueShape, passive_rest, residues, shape_of

REST_PLACES = 1.06, 1.6
"""frequencies of what stands for modes beyond the band, over the highest one: one of them alone
makes twice the error"""
REST_SCALES = 1.0, 0.3, 0.1, 0.03
"""of the shapes of what stands for modes beyond the band, of which the best one is the start"""
LARGEST_DEFECT, LEAST_SIGN = 0.6, 0.5
"""of a residue that is a mode: those of true ones are within 0.05 and above 0.99, spurious poles
have defects from 0.6 on, or the wrong sign"""
FURTHER_MODES, LEAST_GAIN = 5, 0.03
"""how many modes are added where the misfit is largest, and what each of them must take off it"""
NOTHING_MISSING = 1e-3
"""misfit below which nothing is missing: no test is as exact"""
SMOOTHED_LINES = 5
"""lines over which the misfit is averaged to see where it is largest"""
DAMPING_OF_NEW = 0.008


@dataclass(frozen=True, eq=False)
class Identification:
    """A fit, and what was found on the way.

    dropped (n, 2): frequencies [Hz] and damping of poles that no mode has; added (n,): frequencies
    [Hz] at which modes were missing; defects, signs (m,): of the residues of the modes; negative:
    the part of each rest that was not passive.
    """

    fit: ModalFit
    dropped: Array
    added: Array
    defects: Array
    signs: Array
    negative: Array


def identify(measured: Measurement, poles: Array | None = None) -> Identification:
    """The modes of a part; poles (p, 2): circular frequencies and damping, sought unless given.

    A mode is added where the misfit is largest, as long as it takes off some of it.
    """
    found = _with_poles(measured, stable_poles(measured) if poles is None else poles)
    added: list[float] = []
    while len(added) < FURTHER_MODES and found.fit.misfit > NOTHING_MISSING:
        squares = (found.fit.misfits(measured) ** 2).mean(axis=(1, 2))
        smooth = np.convolve(squares, np.full(SMOOTHED_LINES, 1.0 / SMOOTHED_LINES), "same")
        omega = float(measured.s.imag[smooth.argmax()])
        own = np.column_stack([found.fit.omega, found.fit.zeta])
        trial = _with_poles(measured, np.vstack([own, [omega, DAMPING_OF_NEW]]))
        if trial.fit.misfit > (1.0 - LEAST_GAIN) * found.fit.misfit:
            break
        found = replace(trial, dropped=np.vstack([found.dropped, trial.dropped]))
        added.append(omega / (2.0 * np.pi))
    return replace(found, added=np.array(added))


def _with_poles(measured: Measurement, poles: Array) -> Identification:
    omega, zeta = poles[np.argsort(poles[:, 0])].T
    rest_omega = np.array(REST_PLACES) * measured.highest
    beyond = resonances(measured.s, rest_omega, REST_DAMPING)
    dropped: list[tuple[float, float]] = []
    while True:
        R = residues(measured, np.hstack([resonances(measured.s, omega, zeta), beyond]))
        shapes = [shape_of(residue, measured) for residue in R[: len(omega)]]
        kept = np.array([_is_mode(shape) for shape in shapes], dtype=bool)
        if kept.all():
            break
        # Without them others may turn out to be none: two poles of one mode share its residue.
        pairs = zip(omega[~kept].tolist(), zeta[~kept].tolist(), strict=True)
        dropped += [(w / (2.0 * np.pi), z) for w, z in pairs]
        omega, zeta = omega[kept], zeta[kept]
    rest, negative = zip(*(passive_rest(X, measured) for X in R[len(omega) :]), strict=True)
    psi = np.array([shape.psi for shape in shapes]).reshape(-1, measured.outputs.shape[1]).T
    # A rest whose passive part is as large as what was cut off it would lead the fit astray.
    starts = (
        ModalFit(omega, zeta, psi, rest_omega, tuple(scale * L for L in rest))
        for scale in REST_SCALES
    )
    best = min(starts, key=lambda start: relative_size(start.misfits(measured), measured))
    fit = refined_fit(best, measured)
    order = np.argsort(fit.omega)
    fit = replace(fit, omega=fit.omega[order], zeta=fit.zeta[order], shapes=fit.shapes[:, order])
    return Identification(
        fit,
        dropped=np.array(dropped).reshape(-1, 2),
        added=np.empty(0),
        defects=np.array([shape.defect for shape in shapes])[order],
        signs=np.array([shape.sign for shape in shapes])[order],
        negative=np.array(negative),
    )


def _is_mode(shape: ResidueShape) -> bool:
    return shape.defect < LARGEST_DEFECT and shape.sign > LEAST_SIGN
