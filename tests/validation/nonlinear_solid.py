"""A box of 27-node hexahedra of St. Venant and Kirchhoff's material, without a floating frame.

    F = I + grad u,   E = (F^T F - I) / 2,   S = lambda tr(E) I + 2 mu E,   P = F S

All elements are alike, their fields of the second order in each direction, with three Gauss points
a direction. Used for steady rotation, small vibrations about it, and bars turned about an end;
nothing of it is shared with the preprocessor.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import eig
from scipy.sparse.linalg import eigsh, splu
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

_XI, _W = np.polynomial.legendre.leggauss(3)


def _lagrange(xi: Array) -> tuple[Array, Array]:
    """Quadratic shapes on -1, 0, 1 and their slopes at points xi, (q, 3) each."""
    N = np.column_stack([0.5 * xi * (xi - 1.0), 1.0 - xi**2, 0.5 * xi * (xi + 1.0)])
    return N, np.column_stack([xi - 0.5, -2.0 * xi, xi + 0.5])


def _generalized_alpha(rho_inf: float) -> tuple[float, float, float, float, float]:
    """(1 - alpha_f) / (1 - alpha_m), alpha_m, alpha_f, beta and gamma."""
    alpha_m, alpha_f = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0), rho_inf / (rho_inf + 1.0)
    beta, gamma = 0.25 * (1.0 - alpha_m + alpha_f) ** 2, 0.5 - alpha_m + alpha_f
    return (1.0 - alpha_f) / (1.0 - alpha_m), alpha_m, alpha_f, beta, gamma


@dataclass(frozen=True)
class SolidBox:
    """A box from the origin along x, its section centered on the axis.

    size (3,) [m], divisions (3,); E, rho: modulus [Pa] and density [kg/m^3]; nu: Poisson's ratio.
    keeps: which elements stay, by their centers (n, 3) from a corner of the box.
    """

    size: tuple[float, float, float]
    divisions: tuple[int, int, int]
    E: float
    nu: float
    rho: float
    keeps: Callable[[Array], NDArray[np.bool_]] | None = None

    @cached_property
    def nodes(self) -> Array:
        """(n, 3), numbered with x slowest."""
        return self._grid[np.unique(self._grid_cells)]

    @cached_property
    def cells(self) -> NDArray[np.int64]:
        """(e, 27)"""
        _, numbers = np.unique(self._grid_cells, return_inverse=True)
        return numbers.reshape(-1, 27)

    @cached_property
    def _grid(self) -> Array:
        steps = [
            np.linspace(0.0, s, 2 * d + 1) for s, d in zip(self.size, self.divisions, strict=True)
        ]
        grid = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
        return grid - [0.0, 0.5 * self.size[1], 0.5 * self.size[2]]

    @cached_property
    def _grid_cells(self) -> NDArray[np.int64]:
        counts = 2 * np.array(self.divisions) + 1
        numbers = np.arange(np.prod(counts)).reshape(counts)
        a, b, c = self.divisions
        cells = np.array(
            [
                numbers[2 * i : 2 * i + 3, 2 * j : 2 * j + 3, 2 * k : 2 * k + 3].ravel()
                for i in range(a)
                for j in range(b)
                for k in range(c)
            ]
        )
        if self.keeps is None:
            return cells
        corner = self._grid.min(axis=0)
        return cells[self.keeps(self._grid[cells].mean(axis=1) - corner)]

    @cached_property
    def _shapes(self) -> tuple[Array, Array, Array]:
        """N (27 points, 27), its gradients (27, 27, 3) and weights [m^3] of one element."""
        N, D = _lagrange(_XI)
        half = 0.5 * np.divide(self.size, self.divisions)
        values = np.einsum("ai,bj,ck->abcijk", N, N, N).reshape(27, 27)
        slopes = [
            np.einsum("ai,bj,ck->abcijk", *parts).reshape(27, 27) / h
            for parts, h in zip(((D, N, N), (N, D, N), (N, N, D)), half, strict=True)
        ]
        weights = np.einsum("a,b,c->abc", _W, _W, _W).ravel() * half.prod()
        return values, np.stack(slopes, axis=-1), weights

    @cached_property
    def _rows(self) -> NDArray[np.int64]:
        return (3 * self.cells[:, :, None] + np.arange(3)).reshape(len(self.cells), 81)

    def _assembled(self, blocks: Array) -> sparse.csc_matrix:
        rows = np.repeat(self._rows[:, :, None], 81, axis=2)
        columns = rows.transpose(0, 2, 1)
        n = 3 * len(self.nodes)
        return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), (n, n)).tocsc()

    @cached_property
    def mass(self) -> sparse.csc_matrix:
        N, _, weights = self._shapes
        block = np.kron(self.rho * (N.T * weights) @ N, np.eye(3))
        return self._assembled(np.broadcast_to(block, (len(self.cells), 81, 81)))

    def forces(self, u: Array) -> tuple[Array, sparse.csc_matrix]:
        """Those of the stresses under displacements u (3 n,), and their tangent."""
        _, slopes, weights = self._shapes
        lame = self.E * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu))
        shear = 0.5 * self.E / (1.0 + self.nu)
        one = np.eye(3)
        F = one + np.einsum("ena,qnb->eqab", u.reshape(-1, 3)[self.cells], slopes)
        strain = 0.5 * (np.einsum("eqma,eqmb->eqab", F, F) - one)
        trace = np.einsum("eqmm->eq", strain)
        S = lame * trace[..., None, None] * one + 2.0 * shear * strain
        stress = np.einsum("eqam,eqmb,q->eqab", F, S, weights)
        f = np.zeros(u.size)
        np.add.at(f, self._rows, np.einsum("eqab,qnb->ena", stress, slopes).reshape(-1, 81))
        # dP_aA / dF_bB = delta_ab S_AB + lambda F_aA F_bB + mu (F_aB F_bA + F F^T_ab delta_AB)
        left = np.einsum("eqam,eqbm->eqab", F, F)
        slope = (
            np.einsum("ab,eqAB->eqaAbB", one, S)
            + lame * np.einsum("eqaA,eqbB->eqaAbB", F, F)
            + shear * np.einsum("eqaB,eqbA->eqaAbB", F, F)
            + shear * np.einsum("eqab,AB->eqaAbB", left, one)
        )
        half = np.einsum("eqaAbB,qmB,q->eqaAmb", slope, slopes, weights, optimize=True)
        blocks = np.einsum("eqaAmb,qnA->enamb", half, slopes, optimize=True)
        return f, self._assembled(blocks.reshape(-1, 81, 81))

    def vibrations(self, spin: float, count: int = 12) -> tuple[Array, Array]:
        """Of the box clamped at x = 0 that turns about z there: frequencies [rad/s], lowest first,
        and the displacements (count, n, 3), complex, in axes that turn along.

            M u'' + 2 spin M e_z x u' + (K(u_0) - spin^2 M P) u = 0,   P = diag(1, 1, 0)
        """
        free = np.flatnonzero(np.repeat(self.nodes[:, 0] > 1e-12, 3))
        plane = sparse.kron(sparse.eye(len(self.nodes)), np.diag([1.0, 1.0, 0.0]), format="csc")
        pull, u = spin**2 * self.mass @ plane, np.zeros(3 * len(self.nodes))
        for _ in range(12):
            f, K = self.forces(u)
            K = (K - pull)[free][:, free]
            change = splu(K.tocsc()).solve((pull @ (self.nodes.ravel() + u) - f)[free])
            u[free] += change
            if np.abs(change).max() < 1e-13 * self.size[0]:
                break
        K = (self.forces(u)[1] - pull)[free][:, free].tocsc()
        M = self.mass[free][:, free].tocsc()
        turn = sparse.kron(
            sparse.eye(len(self.nodes)), [[0, -1, 0], [1, 0, 0], [0, 0, 0]], format="csc"
        )
        G = (2.0 * spin * self.mass @ turn)[free][:, free]
        squares, V = eigsh(K, 2 * count, M, sigma=0.0)
        G = V.T @ (G @ V)
        o, one = np.zeros_like(G), np.eye(len(G))
        values, vectors = eig(np.block([[o, one], [-np.diag(squares), -G]]))
        order = np.argsort(values.imag)
        order = order[values.imag[order] > 0.0][:count]
        shapes = np.zeros((count, u.size), dtype=complex)
        shapes[:, free] = (V @ vectors[: len(G), order]).T
        return values.imag[order], shapes.reshape(count, -1, 3)

    def turned_by(
        self, angle: Callable[[float], float], step: float, steps: int, rho_inf: float = 0.9
    ) -> Array:
        """The middle of the free end (steps + 1, 3) where the face x = 0 turns about z by an angle.

        From rest, by generalized-alpha with all terms at the end of a step.
        """
        ratio, alpha_m, alpha_f, beta, gamma = _generalized_alpha(rho_inf)
        held = np.repeat(self.nodes[:, 0] < 1e-12, 3)
        free = np.flatnonzero(~held)
        tip = np.flatnonzero(np.linalg.norm(self.nodes - [self.size[0], 0, 0], axis=1) < 1e-9)[0]
        M = self.mass[free][:, free]
        driven = self.mass[free][:, np.flatnonzero(held)]
        u, v, v_dot, a = np.zeros((4, 3 * len(self.nodes)))
        path = [self.nodes[tip]]
        for n in range(1, steps + 1):
            a_star = (alpha_f * v_dot - alpha_m * a) / (1.0 - alpha_m)
            moved = u + step * v + step**2 * ((0.5 - beta) * a + beta * a_star)
            speed = v + step * ((1.0 - gamma) * a + gamma * a_star)
            u = moved + beta * ratio * step**2 * v_dot
            turn = Rotation.from_rotvec([0.0, 0.0, angle(n * step)])
            u[held] = (turn.apply(self.nodes) - self.nodes).ravel()[held]
            for _ in range(20):
                v_dot = (u - moved) / (beta * ratio * step**2)
                f, K = self.forces(u)
                residual = M @ v_dot[free] + driven @ v_dot[held] + f[free]
                S = K[free][:, free] + M / (beta * ratio * step**2)
                change = splu(S.tocsc()).solve(-residual)
                u[free] += change
                if np.abs(change).max() < 1e-10 * self.size[0]:
                    break
            v_dot = (u - moved) / (beta * ratio * step**2)
            v, a = speed + gamma * ratio * step * v_dot, a_star + ratio * v_dot
            path.append(self.nodes[tip] + u.reshape(-1, 3)[tip])
        return np.array(path)

    def thrown(
        self, spin: Array, step: float, steps: int, points: Array, rho_inf: float = 0.9
    ) -> Array:
        """Nodes at points (k, 3) of the mesh that is thrown with a spin (3,), (steps + 1, k, 3).

        Undeformed at the start and free, its center of mass where it is; steps as above.
        """
        ratio, alpha_m, alpha_f, beta, gamma = _generalized_alpha(rho_inf)
        seen = [np.linalg.norm(self.nodes - point, axis=1).argmin() for point in points]
        M, u = self.mass, np.zeros(3 * len(self.nodes))
        weight = np.asarray(M.sum(axis=0))[..., 0::3].ravel()
        center = weight @ self.nodes / weight.sum()
        v = np.cross(spin, self.nodes - center).ravel()
        v_dot = np.zeros_like(v)  # undeformed, and so without forces
        a, path = v_dot, [self.nodes[seen]]
        for _ in range(steps):
            a_star = (alpha_f * v_dot - alpha_m * a) / (1.0 - alpha_m)
            moved = u + step * v + step**2 * ((0.5 - beta) * a + beta * a_star)
            speed = v + step * ((1.0 - gamma) * a + gamma * a_star)
            u = moved + beta * ratio * step**2 * v_dot
            for _ in range(20):
                f, K = self.forces(u)
                residual = M @ (u - moved) / (beta * ratio * step**2) + f
                change = splu((K + M / (beta * ratio * step**2)).tocsc()).solve(-residual)
                u = u + change
                if np.abs(change).max() < 1e-10 * max(self.size):
                    break
            v_dot = (u - moved) / (beta * ratio * step**2)
            v, a = speed + gamma * ratio * step * v_dot, a_star + ratio * v_dot
            path.append((self.nodes + u.reshape(-1, 3))[seen])
        return np.array(path)

    def flap_and_lag(self, spin: float) -> tuple[Array, Array]:
        """Frequencies of motions out of the plane of rotation, and in it, across the box."""
        omega, shapes = self.vibrations(spin)
        along, lag, flap = np.abs(shapes).max(axis=1).T
        torsion = np.abs(shapes[:, -1] - shapes[:, -3]).max(axis=1) > 0.5 * np.maximum(flap, lag)
        bends = (np.maximum(flap, lag) > along) & ~torsion
        return omega[bends & (flap > lag)], omega[bends & (lag > flap)]
