"""Mesh files that robots name: where they are, and their facets."""

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from ..files import FileError, in_one_line, renamed_when_whole, require_regular
from ..files.arrays import Array, IntArray
from .errors import RobotError

COLLADA_SUFFIX = ".dae"
PACKAGE_URL = re.compile(r"(?:package|model)://([^/]+)/(.+)")
Facets = tuple[Array, IntArray]
"""points (p, 3) and triangles (t, 3)"""


class MeshError(ValueError):
    """A mesh that cannot be shown; its text is told, and the robot imported without it."""


def found_mesh(name: str, robot: Path, packages: Sequence[Path]) -> Path:
    """The path of a mesh as a robot names it; `MeshError` where there is none.

    package://NAME/REST is NAME/REST in a folder of `packages`, or in one of those around the robot,
    of which NAME itself may be one.
    """
    tried = list(_candidates(name, robot, packages))
    for path in tried:
        if path.is_file():
            return path
    hint = "; say where its package is by --packages" if PACKAGE_URL.fullmatch(name) else ""
    raise MeshError(f"mesh {name!r}: no such file{hint}")


def _candidates(name: str, robot: Path, packages: Sequence[Path]) -> Iterator[Path]:
    folder = robot.resolve().parent
    in_package = PACKAGE_URL.fullmatch(name)
    if in_package is None:
        yield folder / name.removeprefix("file://")
        return
    package, rest = in_package.groups()
    # What the user says comes before what lies around.
    for parent in packages:
        yield parent / package / rest
    for parent in (folder, *folder.parents):
        if parent.name == package:
            yield parent / rest
        yield parent / package / rest


def read_facets(path: Path, name: str = "") -> Facets:
    """The triangles of a mesh file, by meshio or else by trimesh; `MeshError` says why not.

    name: of the file in messages, its path unless given.
    """
    name = name or str(path)
    try:
        require_regular(path)
        points, triangles = _read(path)
    except (FileError, OSError, ValueError) as error:
        if isinstance(error, MeshError):
            raise
        raise MeshError(f"mesh {name!r}: not readable: {in_one_line(error)}") from error
    if not len(triangles):
        raise MeshError(f"mesh {name!r}: expected triangles, found none")
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise MeshError(f"mesh {name!r}: expected points of 3 numbers")
    return points, triangles


def _read(path: Path) -> Facets:
    # meshio opens most formats of engineers, trimesh those of graphics.
    if path.suffix.lower() in meshio.extension_to_filetypes:
        return _by_meshio(path)
    return _by_trimesh(path)


def _by_meshio(path: Path) -> Facets:
    quiet = io.StringIO()
    try:
        # meshio prints to the terminal, and calls sys.exit for what it cannot read.
        with redirect_stdout(quiet), redirect_stderr(quiet), np.errstate(all="ignore"):
            mesh = meshio.read(path)
    except (Exception, SystemExit) as error:
        raise ValueError(str(error) or quiet.getvalue() or type(error).__name__) from error
    triangles = [np.asarray(block.data) for block in mesh.cells if block.type == "triangle"]
    quads = [np.asarray(block.data) for block in mesh.cells if block.type == "quad"]
    # A quadrilateral is two triangles on either side of a diagonal.
    halves = [quad[:, corners] for quad in quads for corners in ([0, 1, 2], [0, 2, 3])]
    return np.asarray(mesh.points, float), _together([*triangles, *halves])


def _by_trimesh(path: Path) -> Facets:
    """Formats that meshio does not know, as COLLADA."""
    try:
        import trimesh
    except ImportError as error:
        raise MeshError(
            f"meshes in {path.suffix}: pip install 'duhamel[robots]' to show them"
        ) from error
    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False)
        if path.suffix.lower() == COLLADA_SUFFIX:
            # The only format of these whose files say their unit.
            mesh.convert_units("meters")
        return np.array(mesh.vertices, dtype=float), np.asarray(mesh.faces).astype(np.int64)
    except Exception as error:
        raise ValueError(str(error) or type(error).__name__) from error


def _together(triangles: Sequence[IntArray]) -> IntArray:
    none = np.zeros((0, 3), dtype=np.int64)
    return np.concatenate([none, *triangles]).astype(np.int64)


def write_stl(path: Path, facets: Facets) -> None:
    """Write triangles as a binary STL file; `RobotError` where it cannot be written."""
    points, triangles = facets
    with renamed_when_whole(path, failure=RobotError) as temporary:
        mesh = meshio.Mesh(points, [("triangle", triangles)])
        mesh.write(temporary, file_format="stl", binary=True)
