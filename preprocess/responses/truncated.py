"""Truncated modes, and the band in which they are right."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from ...superelement import Modes
from ...superelement.validation import Array
from ..assembly.structure import Structure
from ..body.damping import Damping
from .modal import FULL_MODAL_UNKNOWNS, elastic_shapes
from .reduction import Reduction, craig_bampton, rubin
from .search import Request, krylov_modes
from .shapes import Shapes

TRUNCATION_ERROR = 1e-2  # of the transfer function, up to which modes count as right
REFERENCE_SHARE = 0.1  # that the modes may err by which they are measured
REDUCTION_METHODS: dict[str, Callable[[Structure, Damping, int], Reduction]] = {
    "craig-bampton": craig_bampton,
    "rubin": rubin,
}


@dataclass(frozen=True, eq=False)
class Truncation:
    """Modes, their shapes, and their error from 0 to `limit` [Hz]."""

    modes: Modes
    shapes: Shapes
    error: float
    limit: float


def truncated_modes(request: Request, reduction: Reduction) -> Truncation:
    """The modes of a reduction, with the part of the requested band in which they are right.

    At most up to the frequency of the last mode that was asked for. They are measured: against all
    modes of a small mesh, and against Krylov's of a large one, which are right to a tenth of that.
    Where no band is found, the error is that in the narrowest one looked at.
    """
    band = replace(request.band, limit=min(request.band.limit, reduction.cutoff))
    # The measure must be finer than what it measures.
    tolerance = REFERENCE_SHARE * request.tolerance
    better, shapes, own = _reference(replace(request, band=band, tolerance=tolerance))
    turn = _turn(request.structure, reduction.shapes, shapes) if request.fields else None
    right, error = band.within(request.tolerance, reduction.modes, better, turn)
    modes = replace(reduction.modes, h_min=0.25 / right.limit)
    return Truncation(modes, reduction.shapes, error + own, right.limit)


def _reference(request: Request) -> tuple[Modes, Shapes, float]:
    """Modes that are right in the band, their shapes, and their error."""
    if request.structure.n_u <= FULL_MODAL_UNKNOWNS:
        return *elastic_shapes(request.structure, request.damping), 0.0
    return krylov_modes(request)


def _turn(structure: Structure, shapes: Shapes, better: Shapes) -> Array:
    """phi'^T M phi (m', m): the modes of one space in terms of those of a better one."""
    rows = sp.csr_array(shapes(sp.eye_array(structure.n_u, format="csr")).T @ structure.M)
    return np.ascontiguousarray(better(rows).T)
