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
FURTHER_MODES, LEAST_GAIN = 12, 0.03
"""how many modes are added where the misfit is largest, and what each of them must take off it"""
NOTHING_MISSING = 1e-3
"""misfit below which nothing is missing: no test is as exact"""
SMOOTHED_LINES = 5
"""lines over which the misfit is averaged to see where it is largest"""
DAMPING_OF_NEW = 0.008
HEAVY_DAMPING = 0.03
"""median of the modes, from which on residues of further ones are sought in what the fit leaves"""


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
    by_poles = True
    while len(added) < FURTHER_MODES and found.fit.misfit > NOTHING_MISSING:
        squares = (found.fit.misfits(measured) ** 2).mean(axis=(1, 2))
        smooth = np.convolve(squares, np.full(SMOOTHED_LINES, 1.0 / SMOOTHED_LINES), "same")
        omega = float(measured.s.imag[smooth.argmax()])
        enough = (1.0 - LEAST_GAIN) * found.fit.misfit
        trial = found
        if by_poles:
            own = np.column_stack([found.fit.omega, found.fit.zeta])
            trial = _with_poles(measured, np.vstack([own, [omega, DAMPING_OF_NEW]]))
            by_poles = trial.fit.misfit <= enough
            if by_poles:
                trial = replace(trial, dropped=np.vstack([found.dropped, trial.dropped]))
        heavy = len(found.fit.zeta) and float(np.median(found.fit.zeta)) > HEAVY_DAMPING
        if not by_poles and heavy:
            trial = _with_mode(measured, found, omega)
        if trial.fit.misfit > enough:
            break
        found = trial
        added.append(omega / (2.0 * np.pi))
    return replace(found, added=np.array(added))


def _with_mode(measured: Measurement, found: Identification, omega: float) -> Identification:
    """A fit with one mode more, whose shape is that of what the fit leaves.

    Residues of heavily damped poles that are free in each response are mostly noise; those of one
    more function are not.
    """
    fit = found.fit
    zeta = float(np.median(fit.zeta))
    h = resonances(measured.s, np.array([omega]), zeta)[:, 0] * measured.weights
    left = (measured.elastic - fit.responses(measured)) * measured.weights[:, None, None]
    R = np.einsum("k,kab->ab", h.conj(), left).real / float((np.abs(h) ** 2).sum())
    shape = shape_of(R, measured)
    if not shape.sign > LEAST_SIGN:
        return found
    more = replace(
        fit,
        omega=np.append(fit.omega, omega),
        zeta=np.append(fit.zeta, zeta),
        shapes=np.column_stack([fit.shapes, shape.psi]),
    )
    return _in_order(
        replace(
            found,
            fit=refined_fit(more, measured),
            defects=np.append(found.defects, shape.defect),
            signs=np.append(found.signs, shape.sign),
        )
    )


def _in_order(found: Identification) -> Identification:
    """With modes by their frequencies."""
    fit, order = found.fit, np.argsort(found.fit.omega)
    return replace(
        found,
        fit=replace(fit, omega=fit.omega[order], zeta=fit.zeta[order], shapes=fit.shapes[:, order]),
        defects=found.defects[order],
        signs=found.signs[order],
    )


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
    return _in_order(
        Identification(
            fit,
            dropped=np.array(dropped).reshape(-1, 2),
            added=np.empty(0),
            defects=np.array([shape.defect for shape in shapes]),
            signs=np.array([shape.sign for shape in shapes]),
            negative=np.array(negative),
        )
    )


def _is_mode(shape: ResidueShape) -> bool:
    return shape.defect < LARGEST_DEFECT and shape.sign > LEAST_SIGN
