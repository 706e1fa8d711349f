"""A free part with modes: what loads at some places make of motions at others.

    H(s) = R_o M^-1 R_i^T + Phi_o diag(s^2 / (s^2 + 2 zeta omega s + omega^2 c)) Phi_i^T

Accelerances [1/kg] of motions `o` by loads `i`, with their rigid motions R and modes Phi; c: of
material damping, else 1. Source: docs/theory.md, Frequency response tests.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...files.arrays import Array, Complex
from ...superelement import Interface, Modes
from ...superelement.transfer import laplace_stiffness
from ..errors import MeasurementError
from ..measured.coordinates import SPACE_AXES, space_rows
from ..measured.rigid import RigidProperties


class PlaceMotion(NamedTuple):
    """Rigid motions (n, 6) about the center, and modes (n, m) [1/sqrt(kg)], of n motions."""

    rigid: Array
    phi: Array

    def along(self, rows: Array) -> "PlaceMotion":
        """Combinations rows (k, n) of the motions."""
        return PlaceMotion(rows @ self.rigid, rows @ self.phi)


def stacked_motions(motions: list[PlaceMotion]) -> PlaceMotion:
    return PlaceMotion(*(np.vstack(parts) for parts in zip(*motions, strict=True)))


@dataclass(frozen=True, eq=False)
class FreePart:
    """A part as a rigid body, and its modes at its interfaces."""

    name: str
    rigid: RigidProperties
    interfaces: tuple[Interface, ...]
    modes: Modes

    @property
    def damping(self) -> Array:
        """Damping ratios of all modes (m,), with the losses of the material."""
        return np.asarray(self.modes.zeta + 0.5 * self.modes.loss_factors)

    def at_interface(self, name: str) -> PlaceMotion:
        first = 0
        for interface in self.interfaces:
            n = 6 if interface.rotations else 3
            if interface.name == name:
                # Rotations of a frame are those of the whole part.
                turns = np.hstack([np.zeros((3, 3)), SPACE_AXES])
                rigid = np.vstack([space_rows(interface.X), turns])[:n]
                return PlaceMotion(rigid, self.modes.phi[first : first + n])
            first += n
        known = ", ".join(interface.name for interface in self.interfaces)
        raise MeasurementError(f"{self.name} has no interface {name!r}; there are: {known}")

    def accelerance(self, s: Complex, out: PlaceMotion, into: PlaceMotion) -> Complex:
        """H (k, n_o, n_i) at s (k,)."""
        h = (s[:, None] ** 2 / laplace_stiffness(self.modes, s)).T
        # One product of matrices for all pairs: an order of magnitude faster than einsum.
        pairs = (out.phi[:, None] * into.phi).reshape(-1, len(h))
        shape = (len(s), len(out.phi), len(into.phi))
        elastic = (pairs @ h.real + 1j * (pairs @ h.imag)).T.reshape(shape)
        return np.asarray(elastic + out.rigid @ np.linalg.solve(self.rigid.matrix, into.rigid.T))
