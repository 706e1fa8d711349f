"""The second order of a superelement made by hand, of random numbers that fit its modes."""

import numpy as np
from duhamel.superelement import Modes, Rotation
from duhamel.superelement.validation import Array


def any_rotation(seed: int, modes: Modes, J_rot: Array, level: int = 1) -> Rotation:
    """One of the modes and two soft shapes (fewer of few modes), perhaps with energies."""
    rng = np.random.default_rng(seed)
    n_c, m = modes.phi.shape
    n = min(3, m)
    Y = np.eye(m)[:, :n]
    Y[1:, 1:] = np.linalg.qr(rng.normal(size=(m - 1, n - 1)))[0]
    beside = rng.normal(size=(n - 1, m)) @ (np.eye(m) - Y @ Y.T)
    T = np.vstack([Y.T[:1], Y.T[1:] + beside, Y.T[1:]])
    r = len(T)
    J = np.diag(J_rot)
    inertia = rng.normal(size=(6, m))
    inertia *= 0.9 * (np.sqrt(np.r_[4.0 * J, J]) / np.linalg.norm(inertia, axis=1))[:, None]
    energies = [np.zeros((n,) * order) for order in (3, 4)]
    for energy, order in zip(energies, (3, 4), strict=True):
        for factor in rng.normal(size=(2, n)):
            term = factor
            for _ in range(order - 1):
                term = np.multiply.outer(term, factor)
            energy += term
    # small beside the linear energy, so that their sum is not negative along a coordinate
    energies[0] *= 0.3 * min(1.0, np.sqrt((Y.T**2 @ modes.omega**2).min()))
    cubic, quartic = energies if level == 2 else (None, None)
    return Rotation(
        phi_inertia=inertia,
        T=T,
        A_interface=_symmetric(rng.normal(size=(n_c, r, r))),
        A_inertia=_symmetric(rng.normal(size=(6, r, r))),
        gyroscopic=rng.normal(size=(3, r, r)),
        kappa=np.sort(rng.random(5))[::-1],
        n_low=1,
        cubic=cubic,
        quartic=quartic,
    )


def _symmetric(A: Array) -> Array:
    return A + A.transpose(0, 2, 1)
