"""All modes of a free body up to a frequency, by Lanczos' method with blocks of vectors."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from ...superelement.validation import Array
from ..assembly.structure import RIGID_DOFS, Structure
from ..errors import MethodError
from ..solving.factor import Solve
from .krylov import MIN_BLOCKS, KrylovSpace
from .search import MAX_UNCHECKED_GROWTH, Watch

BLOCK_VECTORS = 8
"""Vectors of a block: solutions take as many at the price of fewer, and no body has as many modes
of the same frequency.
"""
MAX_FREQUENCY_CHANGE = 1e-12
"""of a mode by the last block, relative: the square of the error of its shape"""
MAX_SHARE_OF_GAP = 0.1
"""What the last block may change the first mode beyond the band by, over its distance from it."""


def modes_up_to(structure: Structure, solve: Solve, highest: float, watch: Watch) -> Array:
    """The shapes (n_u, m) of all elastic modes up to `highest` [rad/s], phi^T M phi = 1.

    solve: f -> P K^+ f, for loads that balance themselves. The space grows from random loads, which
    excite all modes, until the modes up to `highest`, and the next one, do not change any more.
    `MethodError` where that takes more vectors than there is time and memory for. Source: G. H.
    Golub, R. Underwood, Mathematical Software III (1977) 361-377.
    """
    motions = np.random.default_rng(0).standard_normal((structure.n_u, BLOCK_VECTORS))
    # Loads in proportion to the mass: others would excite what is local to fine parts of the mesh.
    started = replace(structure, P_C=sp.csr_array((structure.M @ motions).T))
    space = KrylovSpace(started, 0.0, solver=lambda *_: solve)
    check, inside = MIN_BLOCKS, 0
    while space.grow():
        if space.blocks < check:
            continue
        omega, Q = space.ritz(space.blocks)
        inside = int(np.searchsorted(omega, highest, side="right"))
        watch(f"{inside} modes in {space.dimension} vectors")
        changes = space.frequency_changes(omega, Q)
        if inside < len(omega):
            # The next one, which is found too high, stays beyond.
            beyond = MAX_SHARE_OF_GAP * (omega[inside] / highest - 1.0)
            still = changes[:inside].max(initial=0.0) <= MAX_FREQUENCY_CHANGE
            if still and changes[inside] <= max(beyond, MAX_FREQUENCY_CHANGE):
                break
        check = space.blocks + 1 + int(MAX_UNCHECKED_GROWTH * space.blocks)
        if space.basis.columns + (check - space.blocks) * BLOCK_VECTORS > space.room:
            raise MethodError(
                f"impulse.band: the modes up to {highest / (2.0 * np.pi):g} Hz take more than the "
                f"{space.room} vectors that there is time and memory for, found {inside} modes in "
                f"{space.dimension}: lower impulse.band"
            )
    else:
        omega, Q = space.ritz(space.blocks)
        inside = int(np.searchsorted(omega, highest, side="right"))
    shapes: Array = space.basis.V[:, RIGID_DOFS : RIGID_DOFS + len(Q)] @ Q[:, :inside]
    return shapes
