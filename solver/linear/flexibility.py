"""Transfer functions of superelements: elastic displacements per load at a complex frequency.

    H(s) = phi diag(1 / (s^2 + 2 zeta omega s + omega^2)) phi^T

for bodies with modes; for those known by a kernel alone, its z-transform where the scheme has the
frequency s: d with sigma(d) = s^2, so that what the scheme does to frequencies is undone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...superelement import Kernel, Superelement
from ..arrays import Array, Index
from ..errors import ModelError
from ..model.bodies import FlexibleBody
from .pose import Pose

Matrix = NDArray[np.float64] | NDArray[np.complex128]
LEFT = 1e-3
"""of a kernel at its end, relative to its largest response: below, it counts as decayed"""


@dataclass(frozen=True, eq=False)
class ModalBody:
    """A flexible body by its modes.

    phi (n_dofs, m) at all its elastic dofs; active: those of its dofs that can be loaded.
    """

    name: str
    stiffness: Array
    damping: Array
    phi: Array
    active: Index

    @property
    def m(self) -> int:
        return len(self.stiffness)

    @property
    def phi_active(self) -> Array:
        return self.phi[self.active]

    def step(self, s: complex) -> Matrix:
        """s^2 + 2 zeta omega s + omega^2 of every mode (m,), real for a real s."""
        values: Matrix = s * s + self.damping * s + self.stiffness
        return values

    def transfer(self, s: complex) -> Matrix:
        """Displacements of all elastic dofs per load on the active ones (n_dofs, n_active)."""
        values: Matrix = (self.phi / self.step(s)) @ self.phi_active.T
        return values

    def static(self) -> Matrix:
        return self.transfer(0.0)


@dataclass(frozen=True, eq=False)
class KernelBody:
    """A flexible body by its impulse responses alone."""

    name: str
    element: Superelement
    active: Index

    def transfer(self, s: complex) -> Matrix:
        if s == 0.0:
            return self.static()
        kernel = self.element.kernel
        d = _delay(kernel, s)
        self._check(kernel)
        g, powers = self.element.complete_kernel.g, d ** np.arange(len(kernel.g))
        values: Matrix = np.tensordot(powers, g[:, :, self.active], axes=1)
        return values

    def static(self) -> Matrix:
        return self.element.complete_compliance[:, self.active]

    def _check(self, kernel: Kernel) -> None:
        largest = np.abs(kernel.g).max()
        left = float(np.abs(kernel.g[-max(len(kernel.g) // 16, 1) :]).max() / largest)
        if left > LEFT:
            raise ModelError(
                f"body {self.name!r}: superelement {self.element.name!r} is known by a kernel "
                f"alone, which after {kernel.length:.3g} s still has {left:.1g} of its largest "
                f"response: a transfer function needs one that has decayed to {LEFT:g}, or modes"
            )


FlexibleTransfer = ModalBody | KernelBody


def _delay(kernel: Kernel, s: complex) -> complex:
    """d with sigma(d) = s^2, near exp(-s h)."""
    d = np.array([np.exp(-s * kernel.h)], dtype=np.complex128)
    for _ in range(20):
        value = np.sqrt(kernel.scheme.symbols(kernel.h, d)[0])
        change = 1e-6 * d
        ahead = np.sqrt(kernel.scheme.symbols(kernel.h, d + change)[0])
        value, ahead = (root * np.sign((root * np.conj(s)).real) for root in (value, ahead))
        step = (s - value) / ((ahead - value) / change)
        d += step
        if abs(step[0]) < 1e-14:
            break
    return complex(d[0])


def flexible_bodies(pose: Pose) -> list[FlexibleTransfer]:
    """The transfer functions of all flexible bodies of a pose, in the order of the solver."""
    elastic = pose.system.elastic
    found: list[FlexibleTransfer] = []
    for e, (name, body) in enumerate(pose.lowered.model.flexible_bodies.items()):
        active = elastic.active[elastic.active_range[e] : elastic.active_range[e + 1]]
        found.append(_flexible_body(name, body, active - elastic.dof[e]))
    return found


def _flexible_body(name: str, body: FlexibleBody, active: Index) -> FlexibleTransfer:
    modes = body.superelement.modes
    if modes is not None:
        modes = body.superelement.complete_modes(modes)
    if modes is None:
        return KernelBody(name, body.superelement, active)
    if body.rotation is not None:
        modes = body.rotation.complete(modes)
    return ModalBody(name, modes.omega**2, 2.0 * modes.zeta * modes.omega, modes.phi, active)


def bends(pose: Pose) -> Array:
    """Derivatives of the curvatures 1/2 A(q, q) of all elastic dofs by q (n_u, n_u)."""
    elastic, u = pose.system.elastic, pose.state.interfaces.u
    second, matrix = elastic.second, np.zeros((len(u), len(u)))
    for e, r in enumerate(second.r.tolist()):
        if not r:
            continue
        begin, end = int(elastic.dof[e]), int(elastic.dof[e + 1])
        start, n = int(second.A_start[e]), end - begin - r
        A = second.A[start : start + n * r * r].reshape(n, r, r)
        matrix[begin : end - r, end - r : end] = A @ u[end - r : end]
    return matrix
