"""The modes of a space above a band by the few motions that loads within the band make of them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from ...superelement import Modes
from ...superelement.validation import Array
from ..body.damping import Damping
from .band import Band
from .damping import damped_modes

KEPT_BAND_RATIO = 1.3  # frequencies up to this multiple of its top stay as they are
MIN_CONDENSATION_SHIFTS = 3  # before the first look at the error
MIN_NEW_LENGTH = 1e-7  # of a direction, relative to the longest


@dataclass(frozen=True, eq=False)
class Condensed:
    """Modes (m',), their coordinates Y (m, m') in terms of those before, and the error made."""

    modes: Modes
    Y: Array
    error: float


def condensed(
    modes: Modes, damping: Damping, band: Band, tolerance: float, fields: bool, loads: Array
) -> Condensed:
    """The modes up to `KEPT_BAND_RATIO` times the band, and a few for all those beyond.

        y_j = (Omega^2 + s_j)^-1 Phi^T,    Omega, Phi: of the modes beyond

    for shifts s_j = 0, statics; of the step, which make g[0] exact; and -omega^2 at the top of the
    band. The body in the space of the y_j is Rubin's with more than one residual block: at each of
    the shifts the response is exact, and that between them converges with the product of the
    distances. Shifts are added until the error is within the tolerance; modes stay as they are
    where that saves none. loads (n, m): Phi at interfaces, and at what else excites modes at rest.
    Source: S. Rubin, AIAA Journal 13 (1975) 995-1006; E. J. Grimme, Krylov projection methods for
    model reduction, thesis, University of Illinois (1997).
    """
    high = modes.omega > KEPT_BAND_RATIO * 2.0 * np.pi * band.top
    identity = np.eye(len(modes.omega))
    if not loads[:, high].any():
        return Condensed(modes, identity, 0.0)
    squares, blocks = modes.omega[high] ** 2, []
    for shift, excited in _shifts(band, len(modes.phi), len(loads)):
        blocks.append(loads[:excited, high].T / (squares + shift)[:, None])
        if len(blocks) < MIN_CONDENSATION_SHIFTS:
            continue
        Z = _orthonormal(np.hstack(blocks))
        if Z.shape[1] >= len(squares):
            break
        new, turn = eigh((Z.T * squares) @ Z)
        Y = np.hstack([identity[:, ~high], identity[:, high] @ (Z @ turn)])
        omega = np.concatenate([modes.omega[~high], np.sqrt(new)])
        found = damped_modes(damping, omega, modes.phi @ Y, modes.h_min)
        error = band.smooth_error(found, modes, tolerance)
        if fields and error <= tolerance:
            error = max(error, band.field_error(found, modes, Y))
        if error <= tolerance:
            return Condensed(found, Y, error)
    return Condensed(modes, identity, 0.0)


def _shifts(band: Band, n_c: int, n: int) -> Iterator[tuple[float, int]]:
    """Shifts s_j [1/s^2], and how many rows of loads, the first, they are for."""
    top = (2.0 * np.pi * band.top) ** 2
    finest, coarsest = (band.scheme.beta_prime(h) for h in (band.h, band.coarsest_step))
    yield 0.0, n
    yield finest, n_c
    yield -top, n_c
    yield from ((float(s), n_c) for s in np.geomspace(finest, coarsest, 4)[1:])
    yield from ((-top * share, n_c) for share in (0.8, 0.5, 0.9, 0.3))


def _orthonormal(Y: Array) -> Array:
    """An orthonormal basis of the columns of Y, each of its own size."""
    sizes = np.linalg.norm(Y, axis=0)
    U, s, _ = np.linalg.svd(Y[:, sizes > 0.0] / sizes[sizes > 0.0], full_matrices=False)
    return np.asarray(U[:, s > MIN_NEW_LENGTH * s[0]])
