"""All parameters of a fit at once, by Gauss's method with damping.

Each derivative of the responses is a function of s times a matrix, g_a(s) X_a, so that

    (J^T J)_ab = Re(sum_k w_k^2 conj(g_a) g_b) <X_a, X_b>
    (J^T r)_a = <X_a, Re sum_k w_k^2 conj(g_a) E_k>

and J itself is never made.
"""

from dataclasses import replace

import numpy as np

from ...files.arrays import Array, Complex, IntArray
from .responses import REST_DAMPING, Measurement, ModalFit, relative_size, resonances

GAUSS_STEPS = 40
DAMPING_TRIES = 8
"""dampings of a step until it is a better one"""
LEAST_IMPROVEMENT = 1e-5
"""relative gain of a step, below which it is the last one"""
LARGEST_STEPS = 0.05, 0.5
"""relative changes of a frequency and of a damping ratio in one step"""
LEAST_DIAGONAL = 1e-9
"""of the largest of the normal equations, for what the responses hardly tell"""


def refined_fit(fit: ModalFit, measured: Measurement) -> ModalFit:
    """The fit with the least misfit that is found from there."""
    damping, (fit, error) = 1e-3, _measured(fit, measured)
    for _ in range(GAUSS_STEPS):
        normal, slope = _equations(fit, error, measured)
        # By Marquardt: parameters of different units need different damping.
        diagonal = np.diag(normal)
        diagonal = np.maximum(diagonal, LEAST_DIAGONAL * diagonal.max())
        for _ in range(DAMPING_TRIES):
            step = np.asarray(np.linalg.solve(normal + damping * np.diag(diagonal), slope))
            trial, error_there = _measured(_moved(fit, step), measured)
            if trial.misfit < fit.misfit:
                break
            damping *= 10.0
        else:
            return fit
        gain = 1.0 - (trial.misfit / fit.misfit) ** 2
        fit, error, damping = trial, error_there, max(damping / 10.0, 1e-10)
        if gain < LEAST_IMPROVEMENT:
            break
    return fit


def _measured(fit: ModalFit, measured: Measurement) -> tuple[ModalFit, Complex]:
    """The fit with its misfit, and what it leaves of the responses (k, n_o n_i)."""
    error = (measured.elastic - fit.responses(measured)).reshape(len(measured.s), -1)
    weighted = error * measured.weights[:, None]
    return replace(fit, misfit=relative_size(weighted, measured)), error


def _moved(fit: ModalFit, step: Array) -> ModalFit:
    """The fit with its parameters changed, in the order of `_matrices`."""
    q, m = fit.shapes.shape
    sizes = [fit.shapes.size, m, m, *(L.size for L in fit.rest)]
    shapes, omega, zeta, *rest = np.split(step, np.cumsum(sizes)[:-1])
    # A mode that leaps over its resonance would be lost.
    by_omega, by_zeta = (
        np.clip(part, -most, most) for part, most in zip((omega, zeta), LARGEST_STEPS, strict=True)
    )
    return replace(
        fit,
        omega=fit.omega * (1.0 + by_omega),
        zeta=fit.zeta * (1.0 + by_zeta),
        shapes=fit.shapes + shapes.reshape(m, q).T,
        rest=tuple(L + part.reshape(-1, q).T for L, part in zip(fit.rest, rest, strict=True)),
    )


def _equations(fit: ModalFit, error: Complex, measured: Measurement) -> tuple[Array, Array]:
    functions = _functions(fit, measured.s)
    X, which = _matrices(fit, measured)
    weighted = (functions.conj() * measured.weights[:, None] ** 2).T
    products = (weighted @ functions).real
    normal = (X @ X.T) * products[np.ix_(which, which)]
    slope = (X * (weighted @ error).real[which]).sum(axis=1)
    return normal, np.asarray(slope)


def _functions(fit: ModalFit, s: Complex) -> Complex:
    """g (k, 3 m + r): of shapes, of relative changes of omega, of those of zeta; of each rest."""
    square = s[:, None] ** 2
    over = square / (square + 2.0 * fit.zeta * fit.omega * s[:, None] + fit.omega**2) ** 2
    by_omega = -over * (2.0 * fit.zeta * s[:, None] + 2.0 * fit.omega) * fit.omega
    by_zeta = -over * 2.0 * fit.omega * s[:, None] * fit.zeta
    rest = resonances(s, fit.rest_omega, REST_DAMPING)
    return np.hstack([resonances(s, fit.omega, fit.zeta), by_omega, by_zeta, rest])


def _matrices(fit: ModalFit, measured: Measurement) -> tuple[Array, IntArray]:
    """X (p, n_o n_i) of all parameters, and the function of each."""
    m = len(fit.omega)
    X, which = [], []
    for i in range(m):
        X.append(_by_shape(fit.shapes[:, i], measured))
        which += [i] * len(X[-1])
    # Frequency and damping of a mode change its whole residue.
    seen = [(measured.outputs @ psi, measured.inputs @ psi) for psi in fit.shapes.T]
    for first in (m, 2 * m):
        X += [np.outer(a, b).reshape(1, -1) for a, b in seen]
        which += range(first, first + m)
    for r, L in enumerate(fit.rest):
        for column in L.T:
            X.append(_by_shape(column, measured))
            which += [3 * m + r] * len(X[-1])
    return np.concatenate(X), np.array(which)


def _by_shape(psi: Array, measured: Measurement) -> Array:
    """Derivatives (q, n_o n_i) of R_o psi psi^T R_i^T."""
    R_o, R_i = measured.outputs, measured.inputs
    a, b = R_o @ psi, R_i @ psi
    found = np.einsum("aq,b->qab", R_o, b) + np.einsum("a,bq->qab", a, R_i)
    return np.asarray(found.reshape(len(psi), -1))
