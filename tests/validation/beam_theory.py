"""Rotating, loaded and whirling beams of Euler and Bernoulli: references of their own.

Hermite elements on [0, length], n of them, two dofs a node: deflection and slope. All integrals are
of the form

    int c(x) w^(k) v^(k) dx,    k = 0, 1, 2:   mass, tension and rotary inertia, bending.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.linalg import eigh, eigvals
from scipy.optimize import brentq

Array = NDArray[np.float64]

SHAPES = [Polynomial(c) for c in ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])]
"""of xi in [0, 1], under unit deflections and slopes (times the length) of the ends"""
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)
XI, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS


def integral(
    n: int, length: float, order: int, coefficient: Callable[[Array], Array | float] = lambda x: 1.0
) -> Array:
    """int c(x) N^(order)^T N^(order) dx (2 n + 2, 2 n + 2)"""
    L = length / n
    scale = np.array([1.0, L, 1.0, L])
    N = np.array([shape.deriv(order)(XI) for shape in SHAPES]) * scale[:, None] / L**order
    total = np.zeros((2 * n + 2, 2 * n + 2))
    for i in range(n):
        c = WEIGHTS * L * coefficient(L * (i + XI))
        total[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += (c * N) @ N.T
    return total


def rotating_cantilever(gamma: float, n: int = 30) -> tuple[Array, Array]:
    """Frequencies out of the plane of rotation and in it, lowest first, in units of sqrt(EI / (m
    L^4)); clamped on the axis, spin gamma in the same unit.

        K + gamma^2 int (1 - x^2) / 2 w'^2,      less gamma^2 M in the plane
    """
    K, M = integral(n, 1.0, 2), integral(n, 1.0, 0)
    K = K + gamma**2 * integral(n, 1.0, 1, lambda x: 0.5 * (1.0 - x**2))
    flap = eigh(K[2:, 2:], M[2:, 2:], eigvals_only=True)
    return np.sqrt(flap), np.sqrt(flap - gamma**2)


def whirl(
    spin: float,
    length: float,
    EI: float,
    mass_per_length: float,
    rotary_inertia: float,
    disk: tuple[float, float, float],
    at: float,
    n: int = 30,
) -> Array:
    """Whirl of a round shaft on two short bearings with a disk: (omega,) [rad/s] in space, those
    along the spin positive, in the order of their magnitude.

    disk: mass, inertia about the shaft, inertia about a diameter; at: a share of the length. With
    w = y + i z = W exp(i omega t) in axes fixed in space,

        (K + omega spin G - omega^2 M) W = 0,    G of the inertia about the shaft.
    """
    K = EI * integral(n, length, 2)
    slopes = rotary_inertia * integral(n, length, 1)
    M = mass_per_length * integral(n, length, 0) + slopes
    G = 2.0 * slopes
    node = round(at * n)
    mass, polar, diametral = disk
    M[2 * node, 2 * node] += mass
    M[2 * node + 1, 2 * node + 1] += diametral
    G[2 * node + 1, 2 * node + 1] += polar
    free = np.delete(np.arange(2 * n + 2), [0, 2 * n])
    K, M, G = (matrix[np.ix_(free, free)] for matrix in (K, M, spin * G))
    # on the lowest modes at rest, where the matrices are well scaled
    squares, V = eigh(K, M, subset_by_index=[0, 15])
    m = len(squares)
    first_order = np.block([[np.zeros((m, m)), np.eye(m)], [np.diag(squares), V.T @ G @ V]])
    omega = eigvals(first_order).real
    return omega[np.argsort(np.abs(omega))]


def loaded_between_clamps(P: float, EA: float) -> tuple[float, float]:
    """Deflection and tension under a force P at midspan, clamps that do not move: von Karman, in
    units of EI and L.

        w'''' = N w'' on either half,    N = EA / 2 int w'^2 dx
    """

    points, weights = np.polynomial.legendre.leggauss(40)
    x, weights = 0.25 * (points + 1.0), 0.25 * weights

    def shape(N: float) -> tuple[float, float]:
        b = np.sqrt(N)
        c, s = np.cosh(0.5 * b), np.sinh(0.5 * b)
        # w = A + B x + C cosh bx + D sinh bx: clamped at 0, level at 1/2, where -N w' + w''' = P/2
        rows = [[1, 0, 1, 0], [0, 1, 0, b], [0, 1, b * s, b * c], [0, -N, 0, 0]]
        A, B, C, D = np.linalg.solve(rows, [0, 0, 0, -0.5 * P])
        slope = B + b * C * np.sinh(b * x) + b * D * np.cosh(b * x)
        return A + 0.5 * B + C * c + D * s, 2.0 * float(weights @ slope**2)

    N = brentq(lambda N: N - 0.5 * EA * shape(N)[1], 1e-6, 1e4)
    return shape(N)[0], N


def buckling_loads() -> dict[str, float]:
    """Of EI / L^2, by how the ends are held."""
    return {
        "pinned-pinned": np.pi**2,
        "clamped-free": np.pi**2 / 4.0,
        "clamped-pinned": 20.190728556,
        "clamped-guided": 4.0 * np.pi**2,
    }


def stretch_of_spinning_bar(spin: float, length: float, EA: float, mass_per_length: float) -> float:
    """Of a bar that turns about its clamped end, its stretch included [m].

    u'' + k^2 (x + u) = 0, k^2 = m spin^2 / EA: tan(k L) / k - L
    """
    k = spin * np.sqrt(mass_per_length / EA)
    return float(np.tan(k * length) / k - length)
