"""The static compliance of a superelement against its mesh, by a solution of its own."""

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from pydantic import ValidationError

from ..files.blas import one_blas_thread
from ..superelement import Check, Superelement
from ..superelement.checks import MAX_RELATIVE_DEVIATION, deviation, scale_of
from ..superelement.validation import Array
from .body.body import Body
from .build import assemble, memory_shortage_told
from .mesh.mesh import IntArray
from .plausibility import refused_where_singular
from .responses.static import compliance

STATED_ERROR_FACTOR = 2.0
"""Times the error that a superelement states, by which its compliance may differ."""
N_CHECKED_COLUMNS = 12  # of the compliance of surfaces


def static_check(element: Superelement, body: Body) -> Check:
    """Whether the compliance of a superelement is that of its body file.

        H = P_C P K^+ P^T P_C^T

    by a factorization of the stiffness with six dofs held, which no mode and no step of the
    superelement knows of, and with it that of some dofs of its surfaces. The limit is twice the
    error that it states.

    Parameters
    ----------
    element : Superelement
    body : Body
        That it was made of.

    Returns
    -------
    Check
        The largest difference, relative to the diagonal, beside its limit.

    Raises
    ------
    PreprocessError
        As `build`; `MemoryShortageError` where the factor does not fit.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> check = static_check(beam.superelement(step=1e-4), beam.body(step=1e-4))
    >>> check.found <= check.limit
    True
    """
    columns = _checked_columns(element)
    with memory_shortage_told(), refused_where_singular(), one_blas_thread():
        structure = replace(assemble(body), channels=None)
        surfaces = structure.surfaces
        if surfaces is not None and surfaces.rows.shape[0] > columns.max(initial=-1):
            rows = [structure.P_C, surfaces.rows[columns]]
            structure = replace(structure, P_C=sp.vstack(rows, format="csr"))
        # By its own factor: modes would only confirm themselves.
        H = compliance(structure)
    stored, scale = _stored(element, columns)
    if H.shape != stored.shape:
        found, limit = np.inf, 0.0
    else:
        found = deviation(stored, H, scale)
        limit = STATED_ERROR_FACTOR * element.kernel.error + MAX_RELATIVE_DEVIATION
    return Check(
        "static/compliance",
        "the static solution of the mesh",
        "a difference, relative to the diagonal,",
        found,
        limit,
    )


def _checked_columns(element: Superelement) -> IntArray:
    """Some rows of surfaces, evenly among them; none without surfaces."""
    n = 0 if element.surfaces is None else 3 * element.surfaces.n
    return np.unique(np.linspace(0, n - 1, min(n, N_CHECKED_COLUMNS)).astype(np.int64))


def _stored(element: Superelement, columns: IntArray) -> tuple[Array, Array]:
    """The compliance of interfaces and some rows of surfaces, and the scale of each of its rows.

    What surfaces and interfaces have in common is that of the modes.
    """
    H, scale, surfaces, modes = (
        element.compliance,
        scale_of(element, element.compliance),
        element.surfaces,
        element.modes,
    )
    if surfaces is None or modes is None:
        return H, scale
    cross = (modes.phi / modes.omega**2) @ surfaces.phi[columns].T
    own = surfaces.H[np.ix_(columns, columns)]
    scale = np.concatenate([scale, np.sqrt(np.abs(own.diagonal()))])
    return np.block([[H, cross], [cross.T, own]]), scale


def body_of(element: Superelement, folder: Path) -> Body | None:
    """The body file that a superelement keeps, with the files that it was made from.

    Parameters
    ----------
    element : Superelement
    folder : path
        Where the files that the body names are looked for.

    Returns
    -------
    Body or None
        None where a file is missing, or no longer the one that the superelement was made from.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> body_of(beam.superelement(step=1e-4), Path()) is None  # its mesh was in memory
    True
    """
    kept = element.provenance
    try:
        body = Body.model_validate(_table(kept.body)).relative_to(folder)
    except (ValidationError, ValueError):
        return None
    if not all(path.is_file() for path in body.files):
        return None
    return body if body.digests == kept.mesh_sha256 else None


def _table(text: str) -> object:
    """The values of a body file, or those of a body made in Python, in JSON."""
    return json.loads(text) if text.startswith("{") else tomllib.loads(text)
