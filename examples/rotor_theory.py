"""A shaft with disks by finite elements of a beam in axes fixed in space.

    M w'' - i spin G w' + K w = force,    w = y + i z and its slope at each node

G: inertia about the shaft. Source: M. Geradin, D. J. Rixen, Mechanical Vibrations; G. Genta,
Dynamics of Rotating Systems, 2005.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHAPES = [Polynomial(c) for c in ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])]
"""of Hermite, over x / length of an element"""
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)
XI, WEIGHTS = 0.5 * (POINTS + 1.0), 0.5 * WEIGHTS


def rotor_matrices(
    section: Any, length: float, elements: int, masses: Mapping[int, tuple[float, float, float]]
) -> tuple[Array, Array, Array]:
    """M, G, K (n, n) of a beam with disks.

    masses: mass, polar and diametral inertia by the number of a node.
    """
    M = section.mass_per_length * _integral(0, length, elements)
    M += section.rotary_inertia_y * _integral(1, length, elements)
    G = section.polar_inertia_per_length * _integral(1, length, elements)
    K = section.EI_y * _integral(2, length, elements)
    for node, (mass, polar, diametral) in masses.items():
        M[2 * node, 2 * node] += mass
        M[2 * node + 1, 2 * node + 1] += diametral
        G[2 * node + 1, 2 * node + 1] += polar
    return M, G, K


def _integral(order: int, length: float, elements: int) -> Array:
    """int N^(order)^T N^(order) dx"""
    h = length / elements
    N = np.array([shape.deriv(order)(XI) for shape in SHAPES]) / h**order
    N = N * np.array([1.0, h, 1.0, h])[:, None]
    element, total = (N * (h * WEIGHTS)) @ N.T, np.zeros((2 * elements + 2,) * 2)
    for i in range(elements):
        total[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += element
    return total
