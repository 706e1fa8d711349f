"""Finite elements one by one, in plain numpy, that share nothing with the package.

Solids are isoparametric, their shapes polynomials that are 1 at a node and 0 at all others. Linear
hexahedra and wedges have the incompatible modes and the projected dilatation of docs/theory.md, and
so have quadratic ones of nearly incompressible materials. Beams follow from their differential
equation, M' + V = 0, M = EI theta', V = GA (w' - theta).

Nodes are in the order of Gmsh.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet, RefTri

VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))

_CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
_CUBE_EDGES = [
    *((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3)),
    *((2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)),
]
_CUBE_FACES = [(0, 1, 2, 3), (0, 1, 5, 4), (0, 3, 7, 4), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7)]
_TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
_TET_EDGES = [(0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3)]
_WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]


@dataclass(frozen=True)
class Kind:
    """corners (k, 3); groups: the corners whose mean each node is; exponents of its polynomials;
    gmsh: the number of the type; quadratic: along its edges.
    """

    corners: tuple
    groups: tuple
    exponents: tuple
    gmsh: int
    quadratic: bool = False

    @property
    def nodes(self):
        """In reference coordinates (k, 3)."""
        corners = np.array(self.corners, dtype=float)
        return np.array([corners[list(group)].mean(axis=0) for group in self.groups])


def _of(corners, edges=(), faces=(), middle=False):
    groups = [(i,) for i in range(len(corners))] + list(edges) + list(faces)
    return tuple(groups + [tuple(range(len(corners)))] * middle)


def _up_to(degree):
    return tuple(e for e in product(range(degree + 1), repeat=3) if sum(e) <= degree)


_LINEAR = tuple(product((0, 1), repeat=3))
_SERENDIPITY = _LINEAR + tuple(
    tuple(np.insert(others, axis, 2)) for axis in range(3) for others in product((0, 1), repeat=2)
)
_CUBIC = tuple(product((0, 1, 2), repeat=3))
_PRISM = tuple((i, j, k) for i, j, k in _LINEAR if i + j < 2)
KINDS = {
    "tet4": Kind(tuple(_TET), _of(_TET), _up_to(1), 4),
    "tet10": Kind(tuple(_TET), _of(_TET, _TET_EDGES), _up_to(2), 11, True),
    "hex8": Kind(tuple(_CUBE), _of(_CUBE), _LINEAR, 5),
    "wedge6": Kind(tuple(_WEDGE), _of(_WEDGE), _PRISM, 6),
    "hex20": Kind(tuple(_CUBE), _of(_CUBE, _CUBE_EDGES), _SERENDIPITY, 17, True),
    "hex27": Kind(tuple(_CUBE), _of(_CUBE, _CUBE_EDGES, _CUBE_FACES, True), _CUBIC, 12, True),
}


@cache
def _coefficients(kind):
    return np.linalg.inv(_monomials(KINDS[kind].exponents, KINDS[kind].nodes.T)).T


def _monomials(exponents, x):
    """(q, p) of p monomials at points (3, q)."""
    return np.stack([np.prod(x.T ** np.array(e), axis=1) for e in exponents], axis=1)


def shapes(kind, xi):
    """N (k, q) at points xi (3, q)."""
    return _coefficients(kind) @ _monomials(KINDS[kind].exponents, xi).T


def slopes(kind, xi):
    """dN/dxi (k, 3, q)."""
    found = []
    for axis in range(3):
        e = np.array(KINDS[kind].exponents)
        lower = e.copy()
        lower[:, axis] = np.maximum(e[:, axis] - 1, 0)
        found.append(_coefficients(kind) @ (_monomials(lower, xi) * e[:, axis]).T)
    return np.stack(found, axis=1)


def line(n):
    """Gauss' points and weights in [0, 1]."""
    x, weight = np.polynomial.legendre.leggauss(n)
    return 0.5 * (x + 1.0), 0.5 * weight


def rule(kind, low=False):
    """Points (3, q) and weights; low: those of strains that are linear, where they are sampled."""
    if kind.startswith("hex"):
        x, w = line(2 if low else 3)
        return np.array(list(product(x, repeat=3))).T, np.array(
            [np.prod(t) for t in product(w, repeat=3)]
        )
    if kind.startswith("tet"):
        return get_quadrature(RefTet, (1 if kind == "tet4" else 2) if low else 5)
    flat, areas = get_quadrature(RefTri, 2 if low else 4)
    x, w = line(2 if low else 3)
    xi = np.array([(*point, z) for point in flat.T for z in x]).T
    return xi, np.outer(areas, w).ravel()


def _modes(kind, xi):
    """Gradients (m, 3, q) of the incompatible modes."""
    x, y, z = xi
    o = np.zeros_like(x)
    if kind == "hex8":
        return np.array([[x - 0.5, o, o], [o, y - 0.5, o], [o, o, z - 0.5]])
    if kind == "wedge6":
        x, y = x - 1 / 3, y - 1 / 3
        return np.array([[x, o, o], [o, y, o], [y, x, o], [o, o, z - 0.5]])
    rest = 1 - x - y - z  # the bubble x y z (1 - x - y - z)
    return np.array([[y * z * (rest - x), x * z * (rest - y), x * y * (rest - z)]])


class Solid:
    """One solid with nodes X (k, 3) and elasticity C (6, 6); soft: nearly incompressible."""

    def __init__(self, kind, X, C, soft):
        self.kind, self.X, self.C = kind, X, C
        locks = kind in ("hex8", "wedge6")
        soft = soft and kind != "tet4"
        self.modes = locks or (soft and kind == "tet10")
        self.projects = locks or soft
        self.xi, weights = rule(kind, low=locks)
        self.dV = weights * np.linalg.det(self._jacobian(self.xi))
        B = self._plain(self.xi)
        if self.projects:
            trace = B[:, :3].sum(axis=1)
            p = self._terms(self.xi)
            self.fit = np.linalg.solve((p * self.dV) @ p.T, (p * self.dV) @ trace)
        B = self._projected(self.xi, B)
        K = np.einsum("q,qia,ij,qjb->ab", self.dV, B, C, B, optimize=True)
        n = 3 * len(X)
        self.A = np.vstack([np.eye(n), -np.linalg.solve(K[n:, n:], K[n:, :n])])
        self.K = self.A.T @ K @ self.A

    def mass(self, rho):
        xi, weights = rule(self.kind)
        N = shapes(self.kind, xi)
        density = rho * weights * np.linalg.det(self._jacobian(xi))
        return np.kron((N * density) @ N.T, np.eye(3))

    def strain(self, xi):
        """(6, 3 k) at a point (3,), shear as engineers take it."""
        xi = np.asarray(xi, dtype=float)[:, None]
        return self._projected(xi, self._plain(xi))[0] @ self.A

    def place(self, xi):
        return shapes(self.kind, np.asarray(xi, dtype=float)[:, None])[:, 0] @ self.X

    def _jacobian(self, xi):
        """dx_i / dxi_d (q, 3, 3)"""
        return np.einsum("ki,kdq->qid", self.X, slopes(self.kind, xi))

    def _plain(self, xi):
        """Strains (q, 6, 3 (k + m)) of nodes and modes."""
        J = self._jacobian(xi)
        dN = np.einsum("kdq,qdi->qki", slopes(self.kind, xi), np.linalg.inv(J))
        if self.modes:
            middle = KINDS[self.kind].nodes.mean(axis=0)[:, None]
            J_0 = self._jacobian(middle)[0]
            ratio = np.linalg.det(J_0) / np.linalg.det(J)
            of_modes = np.einsum("mdq,di,q->qmi", _modes(self.kind, xi), np.linalg.inv(J_0), ratio)
            dN = np.concatenate([dN, of_modes], axis=1)
        B = np.zeros((len(dN), 6, dN.shape[1], 3))
        for row, (i, j) in enumerate(VOIGT):
            B[:, row, :, i] += dN[:, :, j]
            if i != j:
                B[:, row, :, j] += dN[:, :, i]
        return B.reshape(len(dN), 6, -1)

    def _terms(self, xi):
        return np.vstack([np.ones(xi.shape[1]), xi])

    def _projected(self, xi, B):
        if not self.projects:
            return B
        B = B.copy()
        B[:, :3] += ((self._terms(xi).T @ self.fit - B[:, :3].sum(axis=1)) / 3.0)[:, None]
        return B


class Beam:
    """One beam between X (2, 3); values: of its section, as in a body file."""

    def __init__(self, X, values):
        along = X[1] - X[0]
        self.L = float(np.linalg.norm(along))
        e = along / self.L
        y = np.array(values.get("orientation", np.cross([0, 0, 1], e)))
        if np.linalg.norm(y) < 1e-3:
            y = np.array([0.0, 1.0, 0.0])
        y = y - (y @ e) * e
        y /= np.linalg.norm(y)
        self.axes = np.array([e, y, np.cross(e, y)])
        turn, m, v = np.kron(np.eye(4), self.axes), values["mass_per_length"], values
        bar, mean = np.array([[1, -1], [-1, 1]]) / self.L, self.L * np.array([[2, 1], [1, 2]]) / 6
        K, M = np.zeros((12, 12)), np.zeros((12, 12))
        K[np.ix_([0, 6], [0, 6])], M[np.ix_([0, 6], [0, 6])] = v["EA"] * bar, m * mean
        K[np.ix_([3, 9], [3, 9])] = v["GJ"] * bar
        M[np.ix_([3, 9], [3, 9])] = v["polar_inertia_per_length"] * mean
        self.bending = {}
        for plane, about, dofs, sign in (
            ("y", "z", [1, 5, 7, 11], 1.0),
            ("z", "y", [2, 4, 8, 10], -1.0),
        ):
            EI, GA = v[f"EI_{about}"], v.get(f"GA_{plane}", np.inf)
            usual = 0.0 if np.isinf(GA) else m * EI / v["EA"]
            rotary = v.get(f"rotary_inertia_{about}", usual)
            signs = np.array([1.0, sign, 1.0, sign])  # theta_y = -w' where w is along z
            k, mass, curve = self._in_plane(EI, GA, m, rotary)
            K[np.ix_(dofs, dofs)] = k * np.outer(signs, signs)
            M[np.ix_(dofs, dofs)] = mass * np.outer(signs, signs)
            self.bending[plane] = (dofs, lambda xi, curve=curve, signs=signs: curve(xi) * signs)
        self.K, self.M, self.turn = turn.T @ K @ turn, turn.T @ M @ turn, turn

    def _in_plane(self, EI, GA, m, rotary):
        """By w(0), theta(0), the moment at 0 and its slope Q, of which all else is a polynomial."""
        L = self.L

        def w(x):
            return np.array([1.0, x, 0.5 * x * x / EI, x**3 / (6.0 * EI) - x / GA])

        def theta(x):
            return np.array([0.0, 1.0, x / EI, 0.5 * x * x / EI])

        inverse = np.linalg.inv(np.array([w(0), theta(0), w(L), theta(L)]))
        K, M = np.zeros((4, 4)), np.zeros((4, 4))
        for xi, weight in zip(*line(5), strict=True):
            moment, shear = np.array([0, 0, 1.0, xi * L]), np.array([0, 0, 0, 1.0])
            K += weight * L * (np.outer(moment, moment) / EI + np.outer(shear, shear) / GA)
            a, b = w(xi * L), theta(xi * L)
            M += weight * L * (m * np.outer(a, a) + rotary * np.outer(b, b))
        return (
            inverse.T @ K @ inverse,
            inverse.T @ M @ inverse,
            lambda xi: np.array([0, 0, 1.0, xi * L]) / EI @ inverse,
        )

    def strain(self, xi, y, z):
        """Along the axis (12,), beside it: u' - y w_y'' - z w_z'', of bending alone."""
        row = np.zeros(12)
        row[[0, 6]] = -1 / self.L, 1 / self.L
        for plane, arm in (("y", y), ("z", z)):
            dofs, curve = self.bending[plane]
            row[dofs] -= arm * curve(xi)
        return row @ self.turn
