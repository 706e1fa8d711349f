"""All modes of a free body up to a frequency, by Lanczos' method."""

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from ...superelement.validation import Array
from ..assembly.rigid import project, relieve
from ..assembly.structure import RIGID_DOFS, Structure
from ..errors import MethodError
from ..solving.factor import Solve
from .search import Watch

MODES_OF_A_RUN = 48
"""Modes that a run of Lanczos' method looks for: more take more memory, fewer more solutions."""
N_CHECKED_MODES = 4
"""Modes looked for beside those found: of equal frequencies Lanczos' method may miss one."""
MAX_MODES_SHARE = 0.5
"""of the unknowns: beyond, the band holds what no mesh resolves, and nothing is left to be static
"""


def modes_up_to(
    structure: Structure, solve: Solve, highest: float, watch: Watch
) -> tuple[Array, Array]:
    """omega (m,) [rad/s], ascending, up to `highest`, and shapes (n_u, m) with phi^T M phi = 1.

    solve: f -> P K^+ f, by which rigid modes have the value 0 and are not looked for. Each run
    looks beside what is found already, the last one for what others have missed. `MethodError` for
    more than `MAX_MODES_SHARE` of the unknowns.
    """
    squares, shapes = np.zeros(0), np.zeros((structure.n_u, 0))
    most = int(MAX_MODES_SHARE * structure.n_u)
    count = MODES_OF_A_RUN
    while True:
        free = structure.n_u - RIGID_DOFS - len(squares)
        found, more = _run(structure, solve, shapes, min(count, free // 2))
        inside = found <= highest**2
        squares = np.concatenate([squares, found[inside]])
        shapes = np.hstack([shapes, more[:, inside]])
        watch(f"{len(squares)} modes")
        if len(squares) > most:
            raise MethodError(
                f"impulse.band: more than {most} of the {structure.n_u} modes of the mesh are "
                f"below {highest / (2.0 * np.pi):g} Hz: a lower band or a finer mesh"
            )
        if not inside.any():
            order = np.argsort(squares)
            return np.sqrt(squares[order]), shapes[:, order]
        # What was found beyond the band tells that only modes that were missed are left in it.
        count = MODES_OF_A_RUN if inside.all() else N_CHECKED_MODES


def _run(
    structure: Structure, solve: Solve, known: Array, count: int
) -> tuple[Array, Array]:
    """The squares (m,) [1/s^2] and shapes (n_u, m) of the lowest modes beside the known ones.

        P' K^+ P'^T M phi = phi / omega^2,    P': without rigid motion and the known modes
    """
    U, M = np.hstack([structure.U, known]), structure.M

    def response(f: Array) -> Array:
        return project(solve(relieve(f[:, None], U, M)), U, M)[:, 0]

    inverse = LinearOperator(structure.K.shape, matvec=response, dtype=np.float64)
    start = project(np.random.default_rng(0).standard_normal((structure.n_u, 1)), U, M)[:, 0]
    squares, shapes = eigsh(structure.K, count, M, sigma=0.0, OPinv=inverse, v0=start)
    return squares, shapes
