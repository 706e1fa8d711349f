"""A superelement at other values of its design parameters, by coupled tangents of its modes.

Source: docs/theory.md, Design parameters of superelements.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.linalg import LinAlgError

from ..files.arrays import Array
from .interface import Interface
from .modes import Modes
from .other_modes import first_lags, ratios_at
from .superelement import Superelement
from .validation import SuperelementError

COINCIDING_FREQUENCIES = 1e-9
"""relative difference of frequencies whose modes may be any of their plane"""


def design_arrays(base: Superelement, values: Mapping[str, float]) -> Superelement:
    """A superelement at values of parameters by name; see `redesigned`."""
    changes = _changes(base, values)
    modes = base.modes
    assert modes is not None

    def changed(start: Any, name: str) -> Any:
        return start + sum(dp * getattr(base.derivatives[key], name) for key, dp in changes.items())

    squares = modes.omega**2
    omega, V = _modes(squares, changed(np.diag(squares), "K"), changed(np.eye(len(squares)), "M"))
    found = Modes(
        omega, ratios_at(base, omega), changed(modes.phi, "phi") @ V, modes.h_min, modes.chain
    )
    X = changed(np.array([interface.X for interface in base.interfaces]), "X")
    return replace(
        base,
        mass=float(changed(base.mass, "mass")),
        J_rot=changed(base.J_rot, "J_rot"),
        center=changed(base.center, "center"),
        interfaces=tuple(
            Interface(one.name, x, one.rotations) for one, x in zip(base.interfaces, X, strict=True)
        ),
        kernel=first_lags(found, base.kernel, base.kernel.band),
        modes=found,
        compliance=found.compliance,
        accelerance=found.accelerance,
        # The shapes of fields change as well, by what no tangent has. An outline is for pictures.
        recovery=None,
        derivatives={},
    )


def _changes(base: Superelement, values: Mapping[str, float]) -> dict[str, float]:
    """dp by name, within the reach of each derivative."""
    changes = {}
    for name, value in values.items():
        if name not in base.derivatives:
            known = ", ".join(base.derivatives) or "none: its body file needs [derivatives]"
            raise SuperelementError(
                f"{base.name} has no derivative by {name!r}; there are: {known}"
            )
        tangent = base.derivatives[name]
        changes[name] = value - tangent.value
        if not abs(changes[name]) <= tangent.reach:
            raise SuperelementError(
                f"{name}: expected {tangent.value - tangent.reach:.6g} to "
                f"{tangent.value + tangent.reach:.6g}, where the derivatives of {base.name} hold, "
                f"found {value:.6g}: make the superelement again for other values"
            )
    return changes


def _modes(squares: Array, K: Array, M: Array) -> tuple[Array, Array]:
    """Frequencies (m,) and mass-normalized V (m, m) of K V = M V diag(omega^2), ascending.

    squares (m,): the diagonal of a K that is near.
    """
    d = 1.0 / np.sqrt(squares)
    try:
        L = np.linalg.cholesky(d[:, None] * K * d)
    except LinAlgError as error:
        raise SuperelementError("the stiffness is no longer positive definite") from error
    # Of the inverse, whose rounding is relative to the softest mode: displacements feel that of the
    # others least.
    left = np.linalg.solve(L, d[:, None] * M * d)
    A = np.linalg.solve(L, left.T)
    mu, Y = np.linalg.eigh(0.5 * (A + A.T))
    if not mu[0] > 0.0:
        raise SuperelementError("the mass is no longer positive definite")
    V = d[:, None] * np.linalg.solve(L.T, Y) / np.sqrt(mu)
    omega = 1.0 / np.sqrt(mu[::-1])
    return omega, _like_before(omega, V[:, ::-1])


def _like_before(omega: Array, V: Array) -> Array:
    """V with signs, and bases of coinciding frequencies, next to those of the modes before.

    Eigenvectors have any sign, and any basis where frequencies coincide. Then they would jump from
    one value of a parameter to the next. Of V_c, the modes of one frequency, the block B of the
    modes before of which they have most gives V_c Q with Q = U W^T, B^T = U S W^T (Procrustes).
    """
    found = np.empty_like(V)
    starts = np.flatnonzero(np.diff(omega) > COINCIDING_FREQUENCIES * omega[1:]) + 1
    for columns in np.split(np.arange(len(omega)), starts):
        modes = V[:, columns]
        most = np.argsort((modes**2).sum(axis=1))[len(omega) - len(columns) :]
        U, _, Wt = np.linalg.svd(modes[np.sort(most)].T)
        found[:, columns] = modes @ U @ Wt
    return found
