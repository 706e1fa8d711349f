"""Poles that all responses of a part share, by vector fitting of different orders.

    Y(s) sigma(s) = sum_i c_i b_i(s) + c + d s^2 + e / s^2,      sigma(s) = 1 + sum_i a_i b_i(s)

in least squares, with functions b_i of poles that are given; the zeros of sigma are better poles.
Relaxed: the mean of sigma is 1, not its value at infinity. Sources: B. Gustavsen, A. Semlyen, IEEE
Trans. Power Delivery 14 (1999) 1052-1061; B. Gustavsen, ibid. 21 (2006) 1587-1592.
"""

import numpy as np

from ...files.arrays import Array, Complex
from ..body.measured_body import BEYOND_BAND
from .responses import Measurement

POLE_PAIRS = (14, 18, 22)
"""pairs of poles; those that matter are found by most of them"""
POLE_RELOCATIONS = 6
STRONGEST_RESPONSES = 10
"""directions in which responses are strongest: a pole that none of them has is none of the part"""
LEAST_RESPONSE = 3e-3
"""of the strongest direction"""
MOST_LINES = 1000
"""of the measurement that poles are sought with"""
SAME_FREQUENCY, SAME_DAMPING = 0.01, 0.5
"""relative differences within which poles of two orders are one"""
FOUND_BY = 0.6
"""of the orders"""
DAMPING_RANGE = 1e-5, 0.6
LARGEST_DAMPING, OVER_MEDIAN = 0.1, 3.0
"""of poles of lightly damped parts, and over the median of all poles: a heavily damped one among
light ones stands for something else"""
DAMPING_AT_START = 0.01
RIDGE_OF_POLES = 1e-12
"""of the diagonal of normal equations, for poles that coincide"""
LEAST_CONSTANT = 1e-8
"""of sigma: below, its zeros would be at infinity"""


def stable_poles(measured: Measurement) -> Array:
    """Circular frequencies and damping ratios (p, 2) of poles that several orders find."""
    # Poles need no more lines than that, and their search takes time for each of them.
    every = max(1, len(measured.s) // MOST_LINES)
    s, weights = measured.s[::every], measured.weights[::every]
    responses = _strongest(measured)[::every]
    low, high = float(s.imag.min()), float(s.imag.max())
    found = []
    for order in POLE_PAIRS:
        # Lightly damped ones all over the band: heavily damped ones move little.
        start = np.asarray((1j - DAMPING_AT_START) * np.linspace(1.5 * low, 1.1 * high, order))
        found.append(relocated(s, responses, weights, start))
    poles, by = np.concatenate(found), np.repeat(range(len(found)), [len(p) for p in found])
    taken, kept = np.zeros(len(poles), dtype=bool), []
    # The poles of the highest order first, which are the most exact.
    for k in np.argsort(-by, kind="stable"):
        if taken[k]:
            continue
        size = abs(poles[k])
        near = np.abs(np.abs(poles) - size) < SAME_FREQUENCY * size
        apart = np.abs(poles.real - poles[k].real)
        # Of those that are left: a stray pole beside a mode would be that mode once more.
        same = near & (apart < SAME_DAMPING * abs(poles[k].real) + 0.002 * size) & ~taken
        taken |= same
        omega = float(np.median(np.abs(poles[same])))
        zeta = float(-np.median(poles[same].real)) / omega
        # Poles of noise are others in each order.
        if len(set(by[same])) < FOUND_BY * len(POLE_PAIRS):
            continue
        if low < omega < BEYOND_BAND * high and DAMPING_RANGE[0] < zeta < DAMPING_RANGE[1]:
            kept.append((omega, zeta))
    poles_of_part = np.array(sorted(kept)).reshape(-1, 2)
    if not len(poles_of_part):
        return poles_of_part
    largest = max(LARGEST_DAMPING, OVER_MEDIAN * float(np.median(poles_of_part[:, 1])))
    return np.asarray(poles_of_part[poles_of_part[:, 1] < largest])


def _strongest(measured: Measurement) -> Complex:
    """Combinations (k, r) of all responses that hold nearly all of them."""
    weights = measured.weights[:, None]
    every = (measured.elastic.reshape(len(measured.s), -1)) * weights
    # The small Gram matrix has the same directions as an SVD of all responses.
    squares, directions = np.linalg.eigh((every.conj().T @ every).real)
    sizes = np.sqrt(np.maximum(squares[::-1], 0.0))
    count = min(STRONGEST_RESPONSES, int((sizes > LEAST_RESPONSE * sizes[0]).sum()))
    return np.asarray(every @ directions[:, ::-1][:, :count] / weights)


def relocated(s: Complex, responses: Complex, weights: Array, poles: Complex) -> Complex:
    """Poles with positive imaginary parts (p,) that the columns of responses (k, r) share."""
    for _ in range(POLE_RELOCATIONS):
        poles = _zeros_of_sigma(s, responses, weights, poles)
    return poles


def _zeros_of_sigma(s: Complex, responses: Complex, weights: Array, poles: Complex) -> Complex:
    largest = float(np.abs(s).max())
    basis = _basis(s, poles)
    further = np.column_stack([np.ones_like(s), (s / largest) ** 2, 1e-4 * (largest / s) ** 2])
    own = _real_columns(np.hstack([basis, further]), weights)
    sigma = np.hstack([basis, np.ones((len(s), 1))])
    sizes = np.linalg.norm(sigma, axis=0)
    normal = own.T @ own
    # Two poles that have come together make two columns the same.
    normal[np.diag_indices(len(normal))] *= 1.0 + RIDGE_OF_POLES
    # The coefficients of each response are eliminated: Gram matrices do it far faster than QR.
    left = np.zeros((sigma.shape[1],) * 2)
    for response in responses.T:
        common = -(response * weights)[:, None] * (sigma / sizes)
        common = np.vstack([common.real, common.imag])
        mixed = own.T @ common
        left += common.T @ common - mixed.T @ np.linalg.solve(normal, mixed)
    # Without a condition sigma = 0 would solve it all.
    mean = (sigma / sizes).real.sum(axis=0)
    strength = (np.linalg.norm(responses * weights[:, None]) / len(s)) ** 2
    b = np.linalg.lstsq(
        left + strength * np.outer(mean, mean), strength * len(s) * mean, rcond=1e-15
    )[0]
    b /= sizes
    constant = b[-1] if abs(b[-1]) > LEAST_CONSTANT else LEAST_CONSTANT
    return _completed(_zeros(poles, b[:-1] / constant), len(poles), s)


def _basis(s: Complex, poles: Complex) -> Complex:
    """A real basis (k, 2 p) of functions with pairs of poles, for real coefficients."""
    first, second = 1.0 / (s[:, None] - poles), 1.0 / (s[:, None] - poles.conj())
    return np.stack([first + second, 1j * (first - second)], axis=2).reshape(len(s), -1)


def _real_columns(columns: Complex, weights: Array) -> Array:
    """Weighted columns as real ones of twice the length, scaled to length 1."""
    weighted = columns * weights[:, None]
    stacked = np.vstack([weighted.real, weighted.imag])
    return np.asarray(stacked / np.linalg.norm(stacked, axis=0))


def _zeros(poles: Complex, b: Array) -> Complex:
    """Zeros of 1 + sum_i b_i basis_i, with positive imaginary and negative real parts."""
    A = np.zeros((2 * len(poles), 2 * len(poles)))
    for i, pole in enumerate(poles):
        pair = slice(2 * i, 2 * i + 2)
        A[pair, pair] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
    A[::2] -= 2.0 * b
    zeros = np.linalg.eigvals(A)
    # One of each pair stands for both.
    zeros = zeros[zeros.imag > 0.0]
    return np.where(zeros.real > 0.0, -zeros.conj(), zeros)


def _completed(poles: Complex, count: int, s: Complex) -> Complex:
    """As many poles as there were: real ones, which no vibration has, start in the widest gaps."""
    poles = poles[np.argsort(poles.imag)]
    while len(poles) < count:
        places = np.concatenate([[s.imag.min()], poles.imag, [s.imag.max()]])
        k = int(np.argmax(np.diff(places)))
        new = (1j - DAMPING_AT_START) * 0.5 * (places[k] + places[k + 1])
        poles = np.insert(poles, np.searchsorted(poles.imag, new.imag), new)
    return poles
