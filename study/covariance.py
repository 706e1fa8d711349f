"""What residuals and their derivatives tell of parameters: the covariance (J^T J)^-1."""

from typing import NamedTuple

import numpy as np

from ..files.arrays import Array

LEAST_SINGULAR_VALUE = 1e-6
"""of the largest one of J, its columns scaled, of which differences have errors of 1e-8"""


class Covariance(NamedTuple):
    """Correlations (k, k), standard deviations (k,), inf where nothing is known, and the rank."""

    correlation: Array
    deviations: Array
    rank: int


def covariance_of(J: Array, residuals: Array, noise_is_known: bool) -> Covariance:
    """The covariance of k parameters by residuals (n,) and their derivatives J (n, k).

    noise_is_known: residuals are over their standard deviations; else their own mean square is the
    variance of the noise.
    """
    k = J.shape[1]
    # With fewer samples than parameters the directions that none sees are among rows too.
    J = np.vstack([J, np.zeros((max(k - len(J), 0), k))])
    norms = np.linalg.norm(J, axis=0)
    norms[norms == 0.0] = 1.0
    _, sizes, rows = np.linalg.svd(J / norms, full_matrices=False)
    told = sizes > LEAST_SINGULAR_VALUE * sizes.max(initial=0.0)
    # The pseudo-inverse: directions that no sample sees would divide by rounding.
    scaled = rows[told].T / sizes[told]
    covariance = scaled @ scaled.T / np.outer(norms, norms)
    own = np.sqrt(np.diag(covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = covariance / np.outer(own, own)
    spare = len(residuals) - int(told.sum())
    variance = 1.0 if noise_is_known else residuals @ residuals / spare if spare > 0 else np.inf
    deviations = np.full(k, np.inf) if variance == np.inf else np.sqrt(variance) * own
    # What a direction that no sample sees has a part in is not known at all.
    unseen = (np.abs(rows[~told]) > np.sqrt(LEAST_SINGULAR_VALUE)).any(axis=0)
    deviations[unseen] = np.inf
    return Covariance(correlation, deviations, int(told.sum()))
