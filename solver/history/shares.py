"""The modes of bodies with surfaces in contact: which of them move, and which follow their load.

Above the band w_b, the smaller of theta / h and the band of the file, a mode is quasi-static, eta =
load / omega^2. Below it moves with the share W of its displacements and follows with the rest, so
that waves above the band leave the modes and do not ring at its edge:

    W(s) = (1 - s^8) / (1 + (2 s)^4),    s = omega / w_b,    phi_moving = sqrt(W) phi

Statics stay exact, and the body passive, for both parts are sums of positive terms.

The static rest F of the surfaces follows its load in the same way. Where a material loses energy it
creeps as the modes do: then F = psi psi^T / Omega^2 becomes modes psi too, all of them static.

Coordinates q of second order whose rates have inertia are of moving modes alone: the rates of what
follows its load are those of the load, and Coriolis forces by them would feed on themselves.
"""

from dataclasses import replace
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ...superelement import Modes, Rotation, Superelement, Surfaces
from ..arrays import Array, Index
from ..model.bodies import FlexibleBody

BAND_TIMES_STEP = 1.0
"""theta: the highest circular frequency of a moving mode, times the step"""
LEAST_MODE_SHARE = 1e-9
"""share of a mode that is left out"""
MODES_OF_RESTS: WeakKeyDictionary[Superelement, Array] = WeakKeyDictionary()
"""static rests of superelements as modes: a run needs them for each size of step"""
LEAST_REST = 1e-12
"""compliance, relative to the largest, of a mode of the static rest that is left out"""


class Shares(NamedTuple):
    """Modes of a body, split: the mode that each comes from, its factor, whether it moves."""

    source: Index
    factor: Array
    quasi_static: NDArray[np.bool_]

    def of(self, modes: Modes, second: Rotation | None) -> Modes:
        """The split modes, those of q, by which `phi` ends, without static parts of inertia."""
        phi = self.shapes(modes.phi)
        if second is not None and second.n_soft:
            phi[-second.n_soft :, self.quasi_static] = 0.0
        return replace(
            modes,
            omega=modes.omega[self.source],
            zeta=np.where(self.quasi_static, 0.0, modes.zeta[self.source]),
            phi=phi,
        )

    def shapes(self, phi: Array) -> Array:
        """The shapes (n, m) of the split modes from those of all modes."""
        return phi[:, self.source] * self.factor


def with_rest(element: Superelement, modes: Modes) -> Modes:
    """The modes of a body, with those of the static rest of its surfaces where it creeps.

    These begin at the band, and no interface sees them.
    """
    k = static_rest(element).shape[1]
    return replace(
        modes,
        omega=np.concatenate([modes.omega, np.full(k, _rest_omega(element))]),
        zeta=np.concatenate([modes.zeta, np.zeros(k)]),
        phi=np.hstack([modes.phi, np.zeros((len(modes.phi), k))]),
    )


def static_rest(element: Superelement) -> Array:
    """psi (3 n, k), the modes of the static rest at the nodes of surfaces; k = 0 without losses."""
    surfaces, modes = element.surfaces, element.modes
    assert surfaces is not None
    assert modes is not None
    if modes.chain is None:
        return np.empty((3 * surfaces.n, 0))
    if element not in MODES_OF_RESTS:
        MODES_OF_RESTS[element] = _modes_of_rest(element, surfaces, modes)
    return MODES_OF_RESTS[element]


def _modes_of_rest(element: Superelement, surfaces: Surfaces, modes: Modes) -> Array:
    """psi of F = psi psi^T / Omega^2."""
    # Of all surfaces of the body, whichever of them are in contact: bodies alike share their modes.
    values, vectors = np.linalg.eigh(surfaces.F(modes.omega))
    kept = values > LEAST_REST * values[-1]
    psi: Array = vectors[:, kept] * np.sqrt(values[kept]) * _rest_omega(element)
    return psi


def _rest_omega(element: Superelement) -> float:
    """Omega: at any frequency from the band on nothing moves by itself."""
    return 2.0 * float(np.pi) * element.band


def shares_of(body: FlexibleBody, h: float) -> Shares:
    """The shares of the modes of a body, with those of the rest of its surfaces, in steps of h [s].

    Modes that are coordinates of second order move as a whole.
    """
    element, second = body.superelement, body.rotation
    assert element.modes is not None
    omega = with_rest(element, element.modes).omega
    band = min(BAND_TIMES_STEP / h, 2.0 * np.pi * element.band)
    s = np.minimum(omega / band, 1.0)
    moving = (1.0 - s**8) / (1.0 + (2.0 * s) ** 4)
    if second is not None:
        moving[np.flatnonzero(np.any(second.T[: second.n_low], axis=0))] = 1.0
    numbers = np.arange(len(omega))
    source = np.concatenate([numbers, numbers])
    share = np.concatenate([moving, 1.0 - moving])
    quasi_static = np.repeat([False, True], len(omega))
    # Sorted by mode, so that the frequencies of a body ascend.
    order = np.argsort(source, kind="stable")
    order = order[share[order] > LEAST_MODE_SHARE]
    return Shares(source[order], np.sqrt(share[order]), quasi_static[order])
