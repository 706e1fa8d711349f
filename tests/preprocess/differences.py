"""References for what is of second order: finite rotations, nonlinear energies, differences."""

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import product
from math import factorial

import numpy as np
from duhamel.preprocess.elements.element import solid_element

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


def mode_gradients(kind: str, xi: np.ndarray) -> list[list[float]]:
    """Gradients of the incompatible modes of a type at one point, in reference coordinates."""
    x, y, z = xi
    if kind == "hexahedron":
        return [[1 - 2 * x, 0, 0], [0, 1 - 2 * y, 0], [0, 0, 1 - 2 * z]]
    if kind == "wedge":
        x, y = x - 1 / 3, y - 1 / 3
        return [[x, 0, 0], [0, y, 0], [y, x, 0], [0, 0, 1 - 2 * z]]
    return []


class ElementReference:
    """One solid, point by point: Green's strains of nodes and modes, with their trace projected."""

    def __init__(self, kind: str, X: np.ndarray, C: np.ndarray) -> None:
        element = solid_element(kind)
        self.C, self.k, self.projects = C, len(X), kind in ("hexahedron", "wedge")
        points, weights = element.xi, element.weights
        if self.projects:
            points = element.samples
            weights = np.full(points.shape[1], element.weights.sum() / points.shape[1])
        middle = element.nodes.mean(axis=1)
        J_0 = X.T @ element.dN(middle[:, None])[:, :, 0]
        self.dN, self.dV, self.terms = [], [], np.vstack([np.ones_like(weights), points])
        for xi, weight in zip(points.T, weights, strict=True):
            dN = element.dN(xi[:, None])[:, :, 0]
            J = X.T @ dN
            scale = np.linalg.det(J_0) / np.linalg.det(J)
            modes = np.reshape(mode_gradients(kind, xi), (-1, 3)) @ np.linalg.inv(J_0) * scale
            self.dN.append(np.vstack([dN @ np.linalg.inv(J), modes]))
            self.dV.append(np.linalg.det(J) * weight)

    @property
    def n_modes(self) -> int:
        return len(self.dN[0]) - self.k

    def projected(self, strains: list[np.ndarray]) -> list[np.ndarray]:
        """Strains whose trace is the polynomial 1, xi, eta, zeta that fits it best."""
        if not self.projects:
            return strains
        root = np.sqrt(self.dV)
        traces = np.array([np.trace(strain) for strain in strains])
        c = np.linalg.lstsq((self.terms * root).T, traces * root, rcond=None)[0]
        changes = (c @ self.terms - traces) / 3.0
        return [
            strain + change * np.eye(3) for strain, change in zip(strains, changes, strict=True)
        ]

    def linear(self, a: np.ndarray) -> list[np.ndarray]:
        """Strains of displacements (k + m, 3)."""
        gradients = [a.T @ dN for dN in self.dN]
        return self.projected([0.5 * (H + H.T) for H in gradients])

    def second(self, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
        """Second order strains sym(grad a^T grad b)."""
        products = [(a.T @ dN).T @ (b.T @ dN) for dN in self.dN]
        return self.projected([0.5 * (P + P.T) for P in products])

    def work(self, one: list[np.ndarray], other: list[np.ndarray]) -> float:
        """int one.C other dV"""
        terms = zip(self.dV, one, other, strict=True)
        return sum(dV * np.einsum("ij,ijkl,kl", a, self.C, b) for dV, a, b in terms)

    @cached_property
    def modes(self) -> tuple[np.ndarray, list[list[np.ndarray]]]:
        """The stiffness of the modes and the strains of each."""
        units = np.eye(3 * (self.k + self.n_modes))[3 * self.k :]
        strains = [self.linear(unit.reshape(-1, 3)) for unit in units]
        return np.array([[self.work(a, b) for a in strains] for b in strains]), strains

    def moved(self, u: np.ndarray) -> np.ndarray:
        """Displacements (k + m, 3) of nodes (k, 3) and of the modes that then have least energy."""
        full = np.vstack([u, np.zeros((self.n_modes, 3))])
        if self.n_modes:
            K, strains = self.modes
            force = [self.work(strain, self.linear(full)) for strain in strains]
            full[self.k :] = -np.linalg.solve(K, force).reshape(-1, 3)
        return full

    def relaxed(self, one: list[np.ndarray], other: list[np.ndarray]) -> float:
        """What modes take from the energy int one.C other of strains of second order."""
        if not self.n_modes:
            return 0.0
        K, strains = self.modes
        f, g = ([self.work(strain, e) for strain in strains] for e in (one, other))
        return float(np.array(f) @ np.linalg.solve(K, g))


def element_references(mesh, materials, owners) -> list[tuple[np.ndarray, ElementReference]]:
    """The nodes of every element of a mesh, and its reference."""
    found = []
    for kind, cells in mesh.elements.items():
        for nodes, owner in zip(cells, mesh.of_kind(owners, kind), strict=True):
            C = materials[owner].elasticity_tensor
            found.append((nodes, ElementReference(kind, mesh.points[nodes], C)))
    return found


def strain_energy(mesh, materials, owners) -> Callable[[np.ndarray], float]:
    """St. Venant and Kirchhoff's energy of displacements (3 n,) of the nodes of solids."""
    elements = element_references(mesh, materials, owners)

    def energy(u: np.ndarray) -> float:
        total = 0.0
        for nodes, element in elements:
            moved = element.moved(u.reshape(-1, 3)[nodes])
            pairs = zip(element.linear(moved), element.second(moved, moved), strict=True)
            green = [first + 0.5 * second for first, second in pairs]
            total += 0.5 * element.work(green, green)
        return total

    return energy


def relaxed_by_modes(mesh, materials, owners, motions: Sequence[np.ndarray]) -> float:
    """What incompatible modes take from D4(a, b, c, d)."""
    a, b, c, d = motions
    total = 0.0
    for nodes, element in element_references(mesh, materials, owners):
        p, q, r, s = (element.moved(u.reshape(-1, 3)[nodes]) for u in (a, b, c, d))
        for one, other in (((p, q), (r, s)), ((p, r), (q, s)), ((p, s), (q, r))):
            total += element.relaxed(element.second(*one), element.second(*other)) / 3.0
    return total
