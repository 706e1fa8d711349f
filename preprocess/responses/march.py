"""Impulse responses by stepping the full model through time."""

from collections.abc import Callable, Iterable

import numpy as np

from ...superelement import Chain, GeneralizedAlpha, Kernel
from ...superelement.validation import Array
from ..assembly.rigid import project
from ..assembly.structure import Structure
from ..body.damping import Damping
from ..solving.factor import factorize
from .damping import damping_matrix
from .static import initial_accelerations

Track = Callable[[range], Iterable[int]]
DRIFT_STEPS = 100
"""Steps after which rounding that has leaked into the rigid modes, where nothing holds it back, is
taken out.
"""


def march_kernel(
    structure: Structure,
    damping: Damping,
    h: float,
    scheme: GeneralizedAlpha,
    steps: int,
    track: Track = iter,
) -> Kernel:
    """The kernel by generalized-alpha on M u'' + C u' + K u = P^T P_C^T p, all interface loads at
    once.

        S a_{n+1} = f_{n+1} - K u* - C v* - M (alpha_m a_n - alpha_f v_dot_n) / (1 - alpha_f)
        S = inertia_ratio M + gamma h C + beta h^2 (1 + sum a_k g_k) K

    with K sum a_k q_k of a chain's springs q_k beside K u.

    g: f acts at the first step alone; g_initial: f acts at t_0 alone, so v_dot_0 = a_0 = M^-1 P^T
    P_C^T. h [s]; the kernel has steps + 1 lags. `track` sees the loop over steps. Source:
    docs/theory.md, Impulse responses.
    """
    K, M, P_C, U, loads = structure.K, structure.M, structure.P_C, structure.U, structure.loads
    C = damping_matrix(damping, structure)
    n_c = loads.shape[1]
    inertia = scheme.inertia_ratio
    springs = NodalSprings(damping.chain, h, loads.shape[0], 2 * n_c)
    S = inertia * M + scheme.beta * h * h * springs.hardened * K
    S = S if C is None else S + scheme.gamma * h * C
    solve = factorize(S, "the matrix of the time step", solvers=structure.solvers)

    # Columns: first those loaded at the first step, then those loaded at t_0.
    acc = np.hstack([np.zeros_like(loads), initial_accelerations(structure)])
    u, v, a = np.zeros_like(acc), np.zeros_like(acc), acc
    f = np.hstack([loads, np.zeros_like(loads)])
    response = np.zeros((steps + 2, n_c, 2 * n_c))
    for n in track(range(1, steps + 2)):
        before = u
        u = u + h * v + h * h * (0.5 - scheme.beta) * a
        v = v + h * (1 - scheme.gamma) * a
        carried = (scheme.alpha_m * a - scheme.alpha_f * acc) / (1 - scheme.alpha_f)
        residual = -(K @ springs.stress(u, before)) - M @ carried
        if C is not None:
            residual -= C @ v
        if n == 1:
            residual += f
        a = solve(residual)
        acc = inertia * a + carried
        u = u + scheme.beta * h * h * a
        v = v + scheme.gamma * h * a
        springs.follow(u - before)
        if n % DRIFT_STEPS == 0:
            u, v, a, acc = (project(w, U, M) for w in (u, v, a, acc))
            springs.q = [project(q, U, M) for q in springs.q]
        response[n] = P_C @ u
    return Kernel(h, scheme, _symmetric(response[1:, :, :n_c]), _symmetric(response[:-1, :, n_c:]))


class NodalSprings:
    """The springs q_k (n_u, columns) of a chain at every dof; none without one."""

    def __init__(self, chain: Chain | None, h: float, n_u: int, columns: int) -> None:
        kept, gain = (np.zeros(0), np.zeros(0)) if chain is None else chain.step(h)
        a = np.zeros(0) if chain is None else chain.amplitude
        self._elements = list(zip(kept.tolist(), gain.tolist(), a.tolist(), strict=True))
        self.q = [np.zeros((n_u, columns)) for _ in self._elements]
        self.hardened = 1.0 + float(gain @ a)

    def stress(self, u: Array, before: Array) -> Array:
        """u + sum a_k q_k of displacements that a step has moved from `before`."""
        total = u
        for (kept, gain, a), q in zip(self._elements, self.q, strict=True):
            total = total + a * (kept * q + gain * (u - before))
        return total

    def follow(self, change: Array) -> None:
        """Stretch by the change of u in the step."""
        self.q = [
            kept * q + gain * change
            for (kept, gain, _), q in zip(self._elements, self.q, strict=True)
        ]


def _symmetric(g: Array) -> Array:
    """Reciprocity, which rounding alone breaks."""
    return 0.5 * (g + g.transpose(0, 2, 1))
