"""Stiffness and inertia of a shell through its thickness, of one material or of plies."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...superelement.validation import Array
from ..body.material import Material

MAX_TURNED = 1e-9
"""Relative stiffness or mass below which what turns with the normal is rounding."""


@dataclass(frozen=True, eq=False)
class Layer:
    """A material from height z[0] to z[1] [m] over the nodes, turned by an angle [rad]."""

    material: Material
    z: tuple[float, float]
    angle: float = 0.0

    @cached_property
    def Q(self) -> Array:
        """(3, 3) [Pa]: stresses 11, 22, 12 along the axes of the shell where none is across it."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        # Strains along the fibers from those along the axes of the shell.
        T = np.array(
            [
                [c * c, s * s, c * s],
                [s * s, c * c, -c * s],
                [-2.0 * c * s, 2.0 * c * s, c * c - s * s],
            ]
        )
        return np.asarray(T.T @ self.material.plane_stress @ T)

    @cached_property
    def G(self) -> Array:
        """(2, 2) [Pa]: shear stresses 13, 23 from shear strains."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        R = np.array([[c, s], [-s, c]])
        return np.asarray(R.T @ self.material.transverse_shear @ R)

    def moments(self, n: int) -> Array:
        """int z^j dz, j < n."""
        j = np.arange(1, n + 1)
        return np.asarray((self.z[1] ** j - self.z[0] ** j) / j)


@dataclass(frozen=True, eq=False)
class Laminate:
    """Layers from the lowest to the highest, on a shell whose axis 1 is along `axis`.

    axis: a vector that is projected on the surface, None where all directions are alike.
    """

    layers: Sequence[Layer]
    axis: tuple[float, float, float] | None = None

    @cached_property
    def stiffness(self) -> Array:
        """(8, 8): forces N (3) [N/m], moments M (3) [N] and shear forces (2) [N/m] from strains.

            [N; M] = [A, B; B, D] [e; k],   A, B, D = int (1, z, z^2) Q dz

        Shear as of `shear`.
        """
        # Local axis 1 is that of the shell: plies differ from it by their angle alone.
        C = np.zeros((8, 8))
        for layer in self.layers:
            a, b, d = layer.moments(3)
            C[:6, :6] += np.kron(np.array([[a, b], [b, d]]), layer.Q)
        C[6:, 6:] = self.shear(C[:6, :6])
        return C

    def shear(self, ABD: Array) -> Array:
        """(2, 2) [N/m]: the shear stiffness, by the energy of shear stresses in equilibrium.

            s_xz(z) = -int [Q (b + z d)]_11 dz   under the shear force 1, [a, b; b^T, d] = ABD^-1
            1 / stiffness = int s G^-1 s dz

        in equilibrium with a moment in each direction alone: 5/6 G t of one material. Source: K.
        Rohwer, Composite Structures 10 (1988) 131-141, in the form without Poisson's effect across.
        """
        flexible = np.linalg.inv(ABD)
        b, d = flexible[:3, 3:], flexible[3:, 3:]
        F, before = np.zeros((2, 2)), np.zeros(2)
        for layer in self.layers:
            z0, z1 = layer.z
            constant, linear = np.diag(layer.Q @ b)[:2], np.diag(layer.Q @ d)[:2]
            # Stress is quadratic in z: three points integrate its square exactly.
            x, w = np.polynomial.legendre.leggauss(3)
            z = 0.5 * (z0 + z1) + 0.5 * (z1 - z0) * x
            s = before + np.outer(z - z0, constant) + np.outer(0.5 * (z**2 - z0**2), linear)
            # Each direction has its own shear stress; plies askew couple both by their compliance.
            F += np.linalg.inv(layer.G) * ((0.5 * (z1 - z0) * w * s.T) @ s)
            before = before + (z1 - z0) * constant + 0.5 * (z1**2 - z0**2) * linear
        return np.asarray(np.linalg.inv(F), dtype=np.float64)

    @property
    def sided(self) -> bool:
        """Whether the laminate is another one when its normal is turned to the other side."""
        C, (mass, moment, _) = self.stiffness, self.inertia
        t = self.z[1] - self.z[0]
        # About axis 1: heights change their signs, and so do the angles of plies.
        turned = [
            np.abs(C[:3, 3:6]).max() / (t * C[0, 0]),
            np.abs(C[[0, 1], 2]).max() / C[0, 0],
            np.abs(C[[3, 4], 5]).max() / C[3, 3],
            abs(C[6, 7]) / C[6, 6],
            abs(moment) / (t * mass),
        ]
        return bool(max(turned) > MAX_TURNED)

    @property
    def in_plane_shear(self) -> float:
        """A_66 [N/m]."""
        return float(self.stiffness[2, 2])

    @cached_property
    def inertia(self) -> Array:
        """int (1, z, z^2) rho dz (3,) [kg/m^2, kg/m, kg]."""
        moments = [layer.material.rho * layer.moments(3) for layer in self.layers]
        return np.asarray(np.sum(moments, axis=0))

    @property
    def rotary(self) -> float:
        """The rotary inertia about the center of mass [kg]."""
        mass, moment, inertia = self.inertia
        return float(inertia - moment**2 / mass)

    @property
    def z(self) -> tuple[float, float]:
        """The heights of the lower and the upper face over the nodes [m]."""
        return self.layers[0].z[0], self.layers[-1].z[1]

    @property
    def density(self) -> float:
        """Mass per area [kg/m^2]."""
        return float(self.inertia[0])

    def shortest_wave(self, frequency: float) -> float:
        """The length [m] of a bending wave at a frequency [Hz], 2 pi (D / (m omega^2))^(1/4).

        D of bending without forces in the plane, wherever the nodes are: D - B A^-1 B.
        """
        flexible = np.linalg.inv(self.stiffness[:6, :6])[3:, 3:]
        # The softest direction has the shortest wave.
        D = float(np.min(np.diag(np.linalg.inv(flexible))[:2]))
        omega = 2.0 * np.pi * frequency
        return float(2.0 * np.pi * (D / (self.density * omega**2)) ** 0.25)
