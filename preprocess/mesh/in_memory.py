"""Meshes that exist in memory, as other libraries hold them."""

import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import meshio
import numpy as np

from ...superelement.validation import Array
from ..errors import MeshError
from .cells import FACET_TYPES, SOLID_TYPES
from .formats.draft import Draft
from .formats.through_meshio import draft_of
from .mesh import IntArray, Mesh
from .reading import check_points, finished, read_mesh

MESH_FORMS = (
    "a path, (points, cells), or a mesh of scikit-fem, meshio, PyVista or gmsh (the module, with a "
    "model that is meshed)"
)
BY_NODES = {2: "line", **{len(kind.order): name for name, kind in SOLID_TYPES.items()}}
"""the types of cells that are given by their nodes alone"""

MIRRORED_NODES = {
    "tetra": [1, 0, 2, 3],
    "tetra10": [1, 0, 2, 3, 4, 6, 5, 8, 7, 9],
    "wedge": [0, 2, 1, 3, 5, 4],
}
"""the nodes of the same cell seen in a mirror; the first four tell which of both it is"""


def mesh_of(given: Any, scale: float = 1.0, shells: Iterable[str] = ()) -> Mesh:
    """The mesh that a path or an object of another library is.

    Parameters
    ----------
    given
        A path; `(points, cells)` with points (n, 3) and cells (m, k), as an array of one type of
        solids or lines, or by type as meshio names and orders them; a mesh of scikit-fem, whose
        subdomains and boundaries become groups; of meshio, whose sets and arrays of integers do; an
        unstructured grid of PyVista, whose arrays of integers do; or the module gmsh, whose present
        model is taken as it would be saved.
    scale : float [m]
        Its unit of length.
    shells : iterable of str
        The groups whose triangles and quadrangles are shells, if there are solids too.

    Returns
    -------
    Mesh

    Raises
    ------
    MeshError
        Says what was found. `MeshWarning` says what is left out.

    Examples
    --------
    >>> mesh = mesh_of(([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]), scale=1e-3)
    >>> mesh.body_types, mesh.points.max()
    (('tetra',), np.float64(0.001))
    """
    if isinstance(given, Mesh):
        return given
    if isinstance(given, str | Path):
        return read_mesh(given, scale, shells)
    if isinstance(given, ModuleType) and given.__name__ == "gmsh":
        return _of_gmsh(given, scale, shells)
    source = Path(f"mesh in memory ({_named(given)})")
    try:
        draft = _draft(given)
    except MeshError as error:
        raise MeshError(f"{source}: {error}") from error
    check_points(source, draft)
    return finished(source, draft, scale, shells)


def _named(given: Any) -> str:
    """What an object is, in messages."""
    kind = type(given)
    return f"{kind.__module__.partition('.')[0]} {kind.__name__}".removeprefix("builtins ")


def _draft(given: Any) -> Draft:
    if isinstance(given, meshio.Mesh):
        return draft_of(given)
    if isinstance(given, tuple | list) and len(given) == 2:
        return _of_arrays(*given)
    library = type(given).__module__.partition(".")[0]
    if library == "skfem" and hasattr(given, "doflocs"):
        return _of_skfem(given)
    if library == "pyvista" and hasattr(given, "cells"):
        import pyvista

        return draft_of(pyvista.to_meshio(given))
    raise MeshError(f"expected {MESH_FORMS}, found {given!r:.80}")


def _of_gmsh(gmsh: Any, scale: float, shells: Iterable[str]) -> Mesh:
    """The model of a session, by the file that it would save."""
    if not gmsh.isInitialized():
        raise MeshError("gmsh: expected a session with a meshed model, found none")
    with tempfile.TemporaryDirectory() as folder:
        # Its file has the groups, orders and types already, which one reader knows.
        path = Path(folder) / f"{gmsh.model.getCurrent() or 'gmsh'}.msh"
        gmsh.write(str(path))
        return read_mesh(path, scale, shells)


def _of_arrays(points: Any, cells: Any) -> Draft:
    """Points (n, 3), and cells as an array, by type, or as pairs of a type and an array."""
    try:
        nodes = np.array(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise MeshError(f"points: expected numbers (n, 3), found {points!r:.80}") from error
    if nodes.ndim != 2 or nodes.shape[1] != 3:
        raise MeshError(f"points: expected an array (n, 3), found one of {nodes.shape}")
    blocks = [
        meshio.CellBlock(kind, _rows(kind, rows, len(nodes))) for kind, rows in _blocks(cells)
    ]
    return draft_of(meshio.Mesh(nodes, blocks))


def _blocks(cells: Any) -> Iterable[tuple[str, Any]]:
    if isinstance(cells, Mapping):
        return cells.items()
    if isinstance(cells, list | tuple) and all(
        isinstance(block, list | tuple) and len(block) == 2 and isinstance(block[0], str)
        for block in cells
    ):
        return cells
    rows = np.asarray(cells)
    width = rows.shape[1] if rows.ndim == 2 else 0
    if width not in BY_NODES:
        known = ", ".join(f"{nodes} ({kind})" for nodes, kind in sorted(BY_NODES.items()))
        raise MeshError(
            f"cells: expected an array (m, k) with k of {known}, or arrays by type, "
            f"found one of {rows.shape}"
        )
    return [(BY_NODES[width], rows)]


def _rows(kind: str, given: Any, n_points: int) -> IntArray:
    rows = np.asarray(given)
    if rows.ndim != 2 or rows.dtype.kind not in "iu":
        raise MeshError(
            f"cells: {kind}: expected integers (m, k), found {rows.dtype} of {rows.shape}"
        )
    width = (
        2
        if kind == "line"
        else len(SOLID_TYPES[kind].order)
        if kind in SOLID_TYPES
        else rows.shape[1]
    )
    if rows.shape[1] != width:
        raise MeshError(f"cells: {kind}: expected {width} nodes each, found {rows.shape[1]}")
    outside = rows[(rows < 0) | (rows >= n_points)]
    if outside.size:
        raise MeshError(
            f"cells: {kind}: expected points 0 to {n_points - 1}, found {outside.flat[0]}"
        )
    return rows.astype(np.int64)


def _of_skfem(mesh: Any) -> Draft:
    """A mesh of scikit-fem: subdomains are groups of cells, boundaries groups of facets."""
    from skfem.io.meshio import TYPE_MESH_MAPPING, to_meshio

    if type(mesh) not in TYPE_MESH_MAPPING:
        raise MeshError(
            f"expected one of {_supported()} of scikit-fem, found {type(mesh).__name__}"
        )
    whole = to_meshio(mesh, encode_cell_data=False)
    kind = TYPE_MESH_MAPPING[type(mesh)]
    if kind in MIRRORED_NODES:
        _turn(whole.cells[0].data, whole.points, MIRRORED_NODES[kind])
    draft = draft_of(whole)
    for name, members in (mesh.subdomains or {}).items():
        draft.mark(name, kind, members)
    for name, members in (mesh.boundaries or {}).items():
        facets = np.asarray(members, dtype=np.int64)
        if kind not in SOLID_TYPES:
            draft.mark_points(name, np.unique(mesh.facets[:, facets]))
            continue
        # scikit-fem sorts the nodes of facets, and so loses which way they turn.
        corners = np.sort(mesh.facets[:, facets], axis=0).T
        cells = draft.cells[kind][mesh.f2t[0, facets]]
        for facet_kind, rows in _facets(kind, cells, corners):
            draft.mark(name, facet_kind, draft.add(facet_kind, rows))
    return draft


def _turn(cells: IntArray, points: Array, reflection: list[int]) -> None:
    """Give cells (m, k) a positive volume: scikit-fem leaves the order of their nodes open."""
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    volumes = np.einsum("mi,mi->m", np.cross(b - a, c - a), d - a)
    inverted = volumes < 0.0
    cells[inverted] = cells[inverted][:, reflection]


def _facets(kind: str, cells: IntArray, corners: IntArray) -> Iterator[tuple[str, IntArray]]:
    """The faces of cells (m, k) that have given corners, which are sorted (m, c)."""
    for facet_kind, faces in SOLID_TYPES[kind].facets.items():
        n_corners = FACET_TYPES[facet_kind].corners
        for face in faces:
            nodes = cells[:, face]
            found = np.sort(nodes[:, :n_corners], axis=1)
            # scikit-fem repeats a corner of the triangles of wedges
            same = [
                len(set(row)) == n_corners and set(row) == set(own)
                for row, own in zip(corners.tolist(), found.tolist(), strict=True)
            ]
            if any(same):
                yield facet_kind, nodes[np.array(same)]


def _supported() -> str:
    from skfem.io.meshio import TYPE_MESH_MAPPING

    kinds = {"line", *SOLID_TYPES}
    return ", ".join(mesh.__name__ for mesh, kind in TYPE_MESH_MAPPING.items() if kind in kinds)
