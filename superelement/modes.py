"""Elastic modes at the interfaces: the form of a superelement without a step size."""

from dataclasses import dataclass

import numpy as np

from ..files.arrays import Array, Complex
from .chain import Chain
from .validation import SuperelementError, check_positive, checked

# Above it nothing would move during a run. Rayleigh damping gives the highest modes of fine meshes
# ratios of some hundred, which must pass.
MAX_MODAL_DAMPING_RATIO = 1e6

RESONANCE_ITERATIONS = 20


@dataclass(frozen=True, eq=False)
class Modes:
    """Mass-normalized elastic modes at the interface dofs.

        u = phi eta,     eta_i'' + 2 zeta_i omega_i eta_i' + omega_i^2 eta_i = phi_i . p

    Parameters
    ----------
    omega : (m,) [rad/s]
        Natural frequencies, all positive: rigid modes are not among them.
    zeta : (m,)
        Damping ratios.
    phi : (n_c, m) [1/sqrt(kg)]
    h_min : float [s]
        The finest step that they are made for, 0 if any: they are right up to 1 / (4 h_min) [Hz].
    chain : Chain, optional
        Material damping; omega is then that of the relaxed body.

    Raises
    ------
    SuperelementError
        For arrays that do not fit each other, and numbers out of range.

    Examples
    --------
    >>> import numpy as np
    >>> modes = Modes(omega=np.array([10.0, 20.0]), zeta=np.zeros(2), phi=np.array([[1.0, 2.0]]))
    >>> modes.compliance.round(6).tolist(), modes.accelerance.tolist()
    ([[0.02]], [[5.0]])
    """

    omega: Array
    zeta: Array
    phi: Array
    h_min: float = 0.0
    chain: Chain | None = None

    def __post_init__(self) -> None:
        omega = checked("modes: omega", self.omega, ("m",))
        m = len(omega)
        zeta = checked("modes: zeta", self.zeta, (m,))
        phi = checked("modes: phi", self.phi, ("n_c", m))
        if m and omega.min() <= 0.0:
            raise SuperelementError(
                f"modes: omega: expected positive frequencies, found {omega.min()} rad/s"
            )
        if m:
            check_positive("modes: omega", float(omega.min()))
        if m and zeta.min() < 0.0:
            raise SuperelementError(f"modes: zeta: expected ratios >= 0, found {zeta.min()}")
        if m and zeta.max() > MAX_MODAL_DAMPING_RATIO:
            raise SuperelementError(
                f"modes: zeta: expected ratios up to {MAX_MODAL_DAMPING_RATIO:g}, found "
                f"{zeta.max()}"
            )
        if not (np.isfinite(self.h_min) and self.h_min >= 0.0):
            raise SuperelementError(f"modes: h_min: expected a step >= 0 s, found {self.h_min}")
        if self.chain is not None and self.chain.amplitude.shape[1:] not in ((), (m,)):
            raise SuperelementError(
                f"modes: chain: expected amplitudes of {m} modes, or of all, "
                f"found shape {self.chain.amplitude.shape}"
            )
        for name, array in (("omega", omega), ("zeta", zeta), ("phi", phi)):
            object.__setattr__(self, name, array)

    @property
    def frequencies(self) -> Array:
        """Natural frequencies [Hz], in the order of `omega`: with a chain, of the relaxed body."""
        return self.omega / (2.0 * np.pi)

    @property
    def resonances(self) -> Array:
        """Frequencies [rad/s] of the stiffness there, w^2 = omega^2 Re c(w): omega without a chain.

        By iteration, for the stiffness changes far less than the frequency.
        """
        w = self.omega
        # A fixed number of steps: each gains digits, for c(w) varies slowly with frequency.
        for _ in range(RESONANCE_ITERATIONS if self.chain is not None else 0):
            w = self.omega * np.sqrt(self._factor(w).real)
        return w

    @property
    def loss_factors(self) -> Array:
        """Im c / Re c (m,) of the material at the resonances, 0 without a chain."""
        if self.chain is None:
            return np.zeros_like(self.omega)
        c = self._factor(self.resonances)
        return c.imag / c.real

    def _factor(self, omega: Array) -> Complex:
        assert self.chain is not None
        return self.chain.at(omega)

    @property
    def compliance(self) -> Array:
        """Static compliance phi diag(1 / omega^2) phi^T (n_c, n_c), the sum of their kernel.

        With a chain it is that of the relaxed body.
        """
        return (self.phi / self.omega**2) @ self.phi.T

    @property
    def accelerance(self) -> Array:
        """Accelerations of the interfaces under unit loads at rest, phi phi^T (n_c, n_c)."""
        return self.phi @ self.phi.T
