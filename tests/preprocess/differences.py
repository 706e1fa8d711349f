"""References for what is of second order: finite rotations, nonlinear energies, differences."""

from collections.abc import Callable, Sequence
from itertools import product
from math import factorial

import numpy as np
from duhamel.preprocess.elements.element import cofactors, solid_element

ORDER = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


def six(matrix: np.ndarray) -> np.ndarray:
    """The numbers 11, 22, 33, 23, 13, 12 of a symmetric matrix."""
    return np.array([matrix[i, j] for i, j in ORDER])


def matrix_of(six_numbers: np.ndarray) -> np.ndarray:
    matrix = np.zeros((3, 3))
    for (i, j), value in zip(ORDER, six_numbers, strict=True):
        matrix[i, j] = matrix[j, i] = value
    return matrix


def skew(w: np.ndarray) -> np.ndarray:
    return np.cross(w, np.eye(3)).T


def turning(nodes, w: np.ndarray) -> np.ndarray:
    """S (n, n): what a small turn w adds to motions, w~ on displacements, 1/2 w~ on rotations."""
    S = np.zeros((nodes.n_dofs, nodes.n_dofs))
    for first, rotates in zip(nodes.first, nodes.rotations, strict=True):
        S[first : first + 3, first : first + 3] = skew(w)
        if rotates:
            S[first + 3 : first + 6, first + 3 : first + 6] = 0.5 * skew(w)
    return S


def mixed(function: Callable, vectors: Sequence[np.ndarray], step: float = 1.0):
    """The mixed derivative of a function at zero along vectors, one for each order.

    From 2^order values; exact for polynomials of one degree more.
    """
    order = len(vectors)
    total = 0.0
    for signs in product((1.0, -1.0), repeat=order):
        point = sum(sign * step * vector for sign, vector in zip(signs, vectors, strict=True))
        total = total + np.prod(signs) * function(point)
    return total / (2.0 * step) ** order


def refined(function: Callable, vectors: Sequence[np.ndarray], step: float):
    """`mixed` without its error of second order in the step."""
    coarse, fine = (mixed(function, vectors, h) for h in (step, 0.5 * step))
    return (4.0 * fine - coarse) / 3.0


def quartic_form(energy: Callable, vectors: Sequence[np.ndarray]) -> float:
    """D4(a, b, c, d), for D4(u, u, u, u) / 8 of fourth order in the energy."""
    return 8.0 / factorial(4) * mixed(energy, vectors)


def strain_energy(mesh, materials, owners) -> Callable[[np.ndarray], float]:
    """St. Venant and Kirchhoff's energy of displacements (3 n,) of the nodes of solids."""

    def energy(u: np.ndarray) -> float:
        total = 0.0
        for kind, cells in mesh.elements.items():
            element, X = solid_element(kind), mesh.points[cells]
            _, det = cofactors(element.dN(element.xi), X)
            dN = element.gradients(element.xi, X)
            H = np.einsum("ekmq,eki->eqim", dN, u.reshape(-1, 3)[cells])
            F = H + np.eye(3)
            green = 0.5 * (np.swapaxes(F, -1, -2) @ F - np.eye(3))
            C = np.array([material.elasticity_tensor for material in materials])
            C = C[mesh.of_kind(owners, kind)]
            density = np.einsum("eqij,eijkl,eqkl->eq", green, C, green, optimize=True)
            total += 0.5 * np.sum(density * det * element.weights)
        return total

    return energy
