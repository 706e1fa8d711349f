"""Residues of given poles, and the shapes that make them."""

from typing import NamedTuple

import numpy as np

from ...files.arrays import Array, Complex
from .responses import Measurement

SHAPE_STEPS = 30
SHAPE_TRIES = 12
SEEN_PART = 1e-6
"""of the largest singular value of sensors or hits, below which they do not see a coordinate"""
LEAST_SQUARE = 1e-9
"""of the largest eigenvalue of a rest, which is then left out"""
REST_RANK = 1e-4
"""of the largest singular value of the equations of a rest"""


def residues(measured: Measurement, h: Complex) -> Array:
    """Real residues (n, n_o, n_i) of the functions h (k, n), each response for itself."""
    A = h * measured.weights[:, None]
    B = (measured.elastic * measured.weights[:, None, None]).reshape(len(measured.s), -1)
    found = np.linalg.lstsq(np.vstack([A.real, A.imag]), np.vstack([B.real, B.imag]), rcond=None)[0]
    return np.asarray(found.reshape(-1, *measured.H.shape[1:]))


class ResidueShape(NamedTuple):
    """A shape psi (q,) of a residue R = R_o psi psi^T R_i^T.

    defect: the part of the residue that is of another form; sign: of the driving points, the cosine
    between the shape as sensors and as hits see it.
    """

    psi: Array
    defect: float
    sign: float


def shape_of(R: Array, measured: Measurement) -> ResidueShape:
    """The shape nearest to a residue, by Levenberg and Marquardt's method."""
    # Of the best product of two vectors, which need not be one shape.
    left, sizes, right = np.linalg.svd(R)
    root = np.sqrt(sizes[0])
    by_sensors = np.linalg.lstsq(measured.outputs, left[:, 0] * root, rcond=SEEN_PART)[0]
    by_hits = np.linalg.lstsq(measured.inputs, right[0] * root, rcond=SEEN_PART)[0]
    sensed, hit = (np.abs(rows).sum(axis=0) > 0.0 for rows in (measured.outputs, measured.inputs))
    both = sensed & hit
    # Only where both see a coordinate can they agree or not.
    a, b = by_sensors[both], by_hits[both]
    lengths = np.linalg.norm(a), np.linalg.norm(b)
    if not min(lengths) > 0.0:
        return ResidueShape(np.zeros(len(both)), 1.0, 0.0)
    sign = float(a @ b / (lengths[0] * lengths[1]))
    # Only their product is known: both get the same length.
    scale = np.sqrt(lengths[1] / lengths[0])
    by_sensors, by_hits = by_sensors * scale, np.copysign(1.0, sign) * by_hits / scale
    psi = np.where(both, 0.5 * (by_sensors + by_hits), np.where(sensed, by_sensors, by_hits))
    if sign < 0.0:
        psi = 1e-3 * psi  # which is far from any
    psi = _improved(psi, R, measured)
    return ResidueShape(psi, float(np.sqrt(_square(psi, R, measured)) / np.linalg.norm(R)), sign)


def _square(psi: Array, R: Array, measured: Measurement) -> float:
    return float(((R - np.outer(measured.outputs @ psi, measured.inputs @ psi)) ** 2).sum())


def _improved(psi: Array, R: Array, measured: Measurement) -> Array:
    R_o, R_i, damping = measured.outputs, measured.inputs, 1e-3
    best = _square(psi, R, measured)
    for _ in range(SHAPE_STEPS):
        a, b = R_o @ psi, R_i @ psi
        error = R - np.outer(a, b)
        slope = R_o.T @ (error @ b) + R_i.T @ (error.T @ a)
        mixed = np.outer(R_o.T @ a, R_i.T @ b)
        normal = (b @ b) * R_o.T @ R_o + (a @ a) * R_i.T @ R_i + mixed + mixed.T
        diagonal = np.diag(normal) + 1e-12 * np.trace(normal)
        for _ in range(SHAPE_TRIES):
            trial = psi + np.linalg.solve(normal + damping * np.diag(diagonal), slope)
            if (found := _square(trial, R, measured)) < best:
                break
            damping *= 5.0
        else:
            break
        # The nearer, the more of Gauss's full step.
        psi, best, damping = trial, found, max(damping / 5.0, 1e-12)
    return psi


def passive_rest(X: Array, measured: Measurement) -> tuple[Array, float]:
    """L (q, n) of the least |X - R_o L L^T R_i^T|, nearly, and the part that is not passive.

    The nearest symmetric matrix, without its negative eigenvalues, rows scaled by its diagonal.
    """
    sensed, hit = (np.abs(rows).sum(axis=0) > 0.0 for rows in (measured.outputs, measured.inputs))
    own = np.flatnonzero(sensed & hit)
    R_o, R_i = measured.outputs[:, own], measured.inputs[:, own]
    i, j = np.triu_indices(len(own))
    pairs = np.einsum("an,bn->nab", R_o[:, i], R_i[:, j])
    other = np.einsum("an,bn->nab", R_o[:, j], R_i[:, i])
    pairs = np.where((i != j)[:, None, None], pairs + other, pairs)
    # What hardly any pair of channel and hit tells stays zero.
    values = np.linalg.lstsq(pairs.reshape(len(i), -1).T, X.ravel(), rcond=REST_RANK)[0]
    Q = np.zeros((len(own), len(own)))
    Q[i, j] = Q[j, i] = values
    diagonal = np.abs(np.diag(Q))
    # Rotations and displacements have different units: unscaled, one would drown the other.
    scale = np.sqrt(np.maximum(diagonal, 1e-12 * diagonal.max(initial=1e-300)))
    squares, vectors = np.linalg.eigh(Q / np.outer(scale, scale))
    kept = squares > LEAST_SQUARE * max(squares.max(initial=0.0), 0.0)
    L = np.zeros((len(sensed), int(kept.sum())))
    L[own] = scale[:, None] * vectors[:, kept] * np.sqrt(squares[kept])
    positive = squares[squares > 0.0].sum()
    negative = -squares[squares < 0.0].sum()
    return L, float(negative / positive) if positive > 0.0 else 1.0
