"""Transfer functions of superelements: elastic displacements per load at a complex frequency.

    H(s) = phi diag(1 / (s^2 + 2 zeta omega s + omega^2 c(s))) phi^T
    c(s) = 1 + sum_k a_k s tau_k / (1 + s tau_k), with the Maxwell chain of its material

for bodies with modes; for those known by a kernel alone, its z-transform where the scheme has the
frequency s: d with sigma(d) = s^2, so that what the scheme does to frequencies is undone.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...superelement import Kernel, Superelement
from ..arrays import Array, Index
from ..errors import ModelError
from ..model.bodies import FlexibleBody
from .pose import Pose

Matrix = NDArray[np.float64] | NDArray[np.complex128]
# at its end, relative to its largest response
DECAYED_KERNEL = 1e-3


@dataclass(frozen=True, eq=False)
class ModalBody:
    """A flexible body by its modes.

    phi (n_dofs, m) at all its elastic dofs; loaded: those of its dofs that can be loaded; tau (K,)
    and amplitude (K, m) of its chain, if it has one.
    """

    name: str
    stiffness: Array
    damping: Array
    phi: Array
    loaded: Index
    tau: Array
    amplitude: Array

    @property
    def m(self) -> int:
        return len(self.stiffness)

    @property
    def phi_loaded(self) -> Array:
        return self.phi[self.loaded]

    def step(self, s: complex) -> Matrix:
        """s^2 + 2 zeta omega s + omega^2 c(s) of every mode (m,), real for a real s."""
        x = s * self.tau
        c = 1.0 + (x / (1.0 + x)) @ self.amplitude
        values: Any = s * s + self.damping * s + self.stiffness * c
        return values  # type: ignore[no-any-return]

    def transfer(self, s: complex) -> Matrix:
        """Displacements of all elastic dofs per load on those loaded (n_dofs, n_loaded)."""
        values: Matrix = (self.phi / self.step(s)) @ self.phi_loaded.T
        return values


@dataclass(frozen=True, eq=False)
class KernelBody:
    """A flexible body by its impulse responses alone."""

    name: str
    element: Superelement
    kernel: Kernel
    loaded: Index

    def transfer(self, s: complex) -> Matrix:
        if s == 0.0:
            # The sum of a truncated kernel misses what comes after its end.
            return self.element.complete_compliance[:, self.loaded]
        kernel = self.kernel
        self._check(kernel)
        d = _delay(kernel, s)
        powers = d ** np.arange(len(kernel.g))
        # H(s) = sum_n g_n d^n: the z-transform at z = 1 / d.
        values: Matrix = np.tensordot(powers, kernel.g[:, :, self.loaded], axes=1)
        return values

    def _check(self, kernel: Kernel) -> None:
        largest = np.abs(kernel.g).max()
        left = float(np.abs(kernel.g[-max(len(kernel.g) // 16, 1) :]).max() / largest)
        if left > DECAYED_KERNEL:
            raise ModelError(
                f"body {self.name!r}: superelement {self.element.name!r} has no modes, "
                f"and its kernel has decayed to {left:.1g} of its largest response after "
                f"{kernel.length:.3g} s: a transfer function needs {DECAYED_KERNEL:g}, or modes"
            )


@dataclass(frozen=True, eq=False)
class StaticBody:
    """A flexible body by its static compliance (n_dofs, n_loaded) alone; rigid where that is 0."""

    name: str
    compliance: Array
    loaded: Index

    def transfer(self, s: complex) -> Matrix:
        return self.compliance


FlexibleTransfer = ModalBody | KernelBody | StaticBody


def _delay(kernel: Kernel, s: complex) -> complex:
    """d with sigma(d) = s^2, near exp(-s h)."""
    d = np.array([np.exp(-s * kernel.h)], dtype=np.complex128)
    for _ in range(20):
        value = np.sqrt(kernel.scheme.symbols(kernel.h, d)[0])
        change = 1e-6 * d
        ahead = np.sqrt(kernel.scheme.symbols(kernel.h, d + change)[0])
        # Of the two roots of sigma, that on the side of s.
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
        loaded = elastic.loaded[elastic.loaded_range[e] : elastic.loaded_range[e + 1]]
        found.append(_flexible_body(name, body, loaded - elastic.dof[e], pose))
    return found


def _flexible_body(name: str, body: FlexibleBody, loaded: Index, pose: Pose) -> FlexibleTransfer:
    element = body.superelement
    if element.modes is None:
        h, scheme = pose.lowered.longest_step, pose.lowered.scheme
        return KernelBody(name, element, element.complete_kernel_for(h, scheme, 1), loaded)
    modes = element.complete_modes(element.modes)
    if body.rotation is not None:
        modes = body.rotation.complete(modes)
    m, chain = len(modes.omega), modes.chain
    tau = np.empty(0) if chain is None else chain.tau
    amplitude = np.empty((0, m)) if chain is None else chain.amplitudes(m)
    damping = 2.0 * modes.zeta * modes.omega
    return ModalBody(name, modes.omega**2, damping, modes.phi, loaded, tau, amplitude)


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
