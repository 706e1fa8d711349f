"""Mesh files and their named groups."""

import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path

import numpy as np

from ...files.cad_suffixes import CAD_SUFFIXES
from ...files.hdf5 import DAMAGE_ERRORS
from ...superelement.validation import Array
from ..errors import MeshError, MeshWarning, about
from .cells import CELL_DIMENSIONS, FACET_TYPES, LINE_CELLS, SHELL_CELLS, SOLID_TYPES
from .formats import abaqus, ansys, gmsh, med, nastran, through_meshio, xdmf
from .formats.abaqus_deck import abaqus_include
from .formats.draft import Draft
from .formats.nastran_deck import nastran_include
from .formats.text import files
from .mesh import Mesh

_NASTRAN = (".bdf", ".nas", ".dat", ".fem", ".asm")
_XDMF = (".xdmf", ".xmf")
_READERS = {
    ".msh": gmsh.read,
    ".inp": abaqus.read,
    ".cdb": ansys.read,
    **dict.fromkeys(_NASTRAN, nastran.read),
    ".med": med.read,
    **dict.fromkeys(_XDMF, xdmf.read),
}
"""By suffix; meshio reads what is not here."""
_OF_CAD = (
    *(".sldprt", ".sldasm", ".catpart", ".catproduct", ".prt", ".ipt", ".iam", ".par"),
    *(".x_t", ".x_b", ".sat", ".jt", ".3dm", ".f3d", ".fcstd"),
)
_NO_MESH = {
    **dict.fromkeys(
        CAD_SUFFIXES,
        "is geometry, no mesh: name it in a body file or by du.Part.from_step, with the size of "
        "elements",
    ),
    **dict.fromkeys(
        _OF_CAD,
        "is geometry of a CAD program, no mesh: save it as STEP, which body files may name, or "
        "save a mesh as .inp or .bdf there",
    ),
    ".mnf": "is a modal neutral file, which has modes and no stiffness: take the mesh that it was "
    "made from, or stiffness and mass matrices ([matrices])",
    **dict.fromkeys(
        (".odb", ".op2", ".rst", ".rth", ".frd", ".cae", ".wbpj", ".mph"),
        "is a database or results of another program: save the mesh there as .inp, .bdf, .msh or "
        ".med",
    ),
}
"""What to do with files that are often taken for meshes, by suffix."""
_FILES: dict[str, Callable[[Path], list[Path]]] = {
    ".inp": partial(files, included=abaqus_include),
    **dict.fromkeys(_NASTRAN, partial(files, included=nastran_include)),
    **dict.fromkeys(_XDMF, xdmf.files_of),
}
"""Which files a mesh is in, by suffix, of formats with more than one."""
MESH_SIZES = (1e-12, 1e12)
"""Sizes of meshes [m] whose volumes, inertias and stiffnesses are numbers; parts are far within."""
MAX_WARNED_NODES = 3


def read_mesh(path: str | os.PathLike[str], scale: float = 1.0, shells: Iterable[str] = ()) -> Mesh:
    """Read a mesh and its groups; coordinates are multiplied by `scale`, the unit of the file [m].

    The file of each format in `formats` says how it names groups. `MeshError` if the file
    cannot be read, or holds cells that are neither lines, shells nor solids. `MeshWarning` if it
    holds more than is read of it: nodes that belong to no element are left out. shells: the groups
    whose triangles and quadrangles are shells, if there are solids too.
    """
    path = Path(path)
    return finished(path, read_draft(path), scale, shells)


def finished(source: Path, draft: Draft, scale: float, shells: Iterable[str] = ()) -> Mesh:
    """The mesh of a draft, in meters; errors and warnings as of `read_mesh` name the source."""
    cells = {kind: rows for kind, rows in draft.cells.items() if len(rows)}
    points = _scaled(source, draft.points, scale)
    body_types = _body_types(source.name, cells, draft.lost)
    mesh = Mesh(source.name, points, cells, draft.groups, body_types, draft.labels)
    mesh = mesh.with_shells(shells)
    # Reference points and construction geometry would make the stiffness singular.
    loose = draft.points[~mesh.used]
    n_shells = sum(map(len, mesh.shells.values()))
    lost = [*draft.lost, *draft.deck.not_in_the_body(cells, n_shells)]
    if len(loose):
        lost.append(_described(loose))
    if lost:
        warnings.warn(
            f"{source}: left out: {'; '.join(dict.fromkeys(lost))}", MeshWarning, stacklevel=3
        )
    if draft.deck.no_shells and (n_shells or body_types[0] in FACET_TYPES):
        _warn_of_flat(
            source, draft.deck.no_shells, ", if in a group of [shells]" if n_shells else ""
        )
    return mesh.without_loose_nodes() if len(loose) else mesh


def _warn_of_flat(source: Path, no_shells: Mapping[str, int], which: str) -> None:
    """`MeshWarning` for flat elements of a deck that are no shells there, and are to be some."""
    counts = ", ".join(f"{count} {name}" for name, count in no_shells.items())
    warnings.warn(
        f"{source}: read as shells{which}: {counts}; they bend and twist as shells do, which they "
        "do not in the deck",
        MeshWarning,
        stacklevel=4,
    )


def _scaled(source: Path, points: Array, scale: float) -> Array:
    """Points in meters; `MeshError` for a mesh so small or large that its volumes are no numbers.

    A mesh whose points all coincide passes: what its elements lack is told where they are read.
    """
    size = scale * float(np.ptp(points, axis=0).max())
    if np.ptp(points, axis=0).any() and not MESH_SIZES[0] <= size <= MESH_SIZES[1]:
        raise MeshError(
            f"{source}: expected a mesh of {MESH_SIZES[0]:g} to {MESH_SIZES[1]:g} m, found "
            f"{size:g} m (scale = {scale:g})"
        )
    return scale * points


def read_draft(path: Path) -> Draft:
    """Read a mesh file, of any cells; `MeshError` if it cannot be read."""
    with _about(path):
        if (advice := _NO_MESH.get(path.suffix.lower())) is not None:
            raise MeshError(advice)
        # Own readers where meshio loses groups, node numbers, or the place of an error.
        draft = _READERS.get(path.suffix.lower(), through_meshio.read)(path)
    check_points(path, draft)
    return draft


def check_points(source: Path, draft: Draft) -> None:
    """`MeshError` for a mesh without points, or with one that is nowhere."""
    if not len(draft.points):
        raise MeshError(f"{source}: the mesh has no points")
    if not np.isfinite(draft.points).all():
        point = int(np.flatnonzero(~np.isfinite(draft.points).all(axis=1))[0])
        raise MeshError(f"{source}: point {point} is at {draft.points[point].tolist()}")


def files_of(path: Path) -> list[Path]:
    """The files that a mesh is in: with those that it includes, and those of its numbers."""
    with _about(path):
        found = _FILES.get(path.suffix.lower())
        return [path] if found is None else found(path)


def _about(path: Path) -> AbstractContextManager[None]:
    """Errors name the file; whatever a reader stumbles over is damage of it."""
    damage = (*DAMAGE_ERRORS, MemoryError)
    return about(path, MeshError, "mesh file", "damaged, or more than the memory holds", damage)


def _described(loose: Array) -> str:
    """Nodes (k, 3), in the unit of the file."""
    listed = [
        *(str(point) for point in loose[:MAX_WARNED_NODES].tolist()),
        *(["..."] if len(loose) > MAX_WARNED_NODES else []),
    ]
    return f"{len(loose)} nodes that belong to no element, at {', '.join(listed)}"


def _body_types(name: str, kinds: Iterable[str], lost: Sequence[str]) -> tuple[str, ...]:
    """The types of the cells that make the body: the solid ones, else shells, else lines.

    lost: what else the file has, for messages.
    """
    unsupported = [kind for kind in kinds if kind not in (*SOLID_TYPES, *CELL_DIMENSIONS)]
    if unsupported:
        raise MeshError(
            f"{name}: unsupported cells {', '.join(unsupported)}; bodies are made of "
            f"{_supported()}: mesh the part in these alone, or split the cells into tetrahedra"
        )
    solids = tuple(kind for kind in kinds if kind in SOLID_TYPES)
    if solids:
        return solids
    if flat := tuple(kind for kind in kinds if kind in FACET_TYPES):
        return flat
    if "line" in kinds and all(kind in ("vertex", "line") for kind in kinds):
        return LINE_CELLS
    besides = f"; left out: {'; '.join(dict.fromkeys(lost))}" if lost else ""
    raise MeshError(
        f"{name}: no body in cells of type {', '.join(kinds) or 'none'}; "
        f"bodies are made of {_supported()}{besides}"
    )


def _supported() -> str:
    return ", ".join((*LINE_CELLS, *SHELL_CELLS, *SOLID_TYPES))
