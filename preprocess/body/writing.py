"""Body files from bodies that were made or changed in Python."""

import os
from pathlib import Path
from typing import Any

from ...files import renamed_when_whole
from ...inputs import toml_of
from ..errors import BodyError
from ..mesh.mesh import Mesh
from ..mesh.writing import write_mesh
from .body import Body
from .reading import AnyBody


def write_body(body: AnyBody, path: str | os.PathLike[str]) -> None:
    """Write a body as a file that reads back to an equal one; it appears whole or not at all.

    Paths of meshes and matrices are relative to the new file. A mesh in memory is written beside
    it, as a file of VTK with the same name.

    Parameters
    ----------
    body : Body or MeasuredBody
    path : path

    Raises
    ------
    BodyError, MeshError
        Names the file that cannot be written.

    Examples
    --------
    >>> import duhamel as du
    >>> steel = du.Material(E=210e9, nu=0.3, rho=7850.0)
    >>> section = du.Section.rectangle(steel, 0.02, 0.01, orientation=(0.0, 1.0, 0.0))
    >>> beam = du.Beam([(0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)], section=section)
    >>> beam.interface("tip", (1.0, 0.0, 0.0))
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     write_body(beam.body(step=1e-4), Path(folder) / "beam.toml")
    ...     sorted(path.name for path in Path(folder).iterdir())
    ['beam.toml', 'beam.vtu']
    """
    path = Path(path)
    # Only what was given: defaults may change, and a file is to stay as its author meant it.
    table = body.model_dump(exclude_unset=True, exclude_none=True, by_alias=True)
    if isinstance(body, Body) and isinstance(body.mesh, Mesh):
        beside = path.with_suffix(".vtu")
        write_mesh(body.mesh, beside)
        table["mesh"] = beside.name
    for name, derivative in body.derivatives.items() if isinstance(body, Body) else ():
        if isinstance(derivative.mesh, Mesh):
            beside = path.with_name(f"{path.stem}-{name}.vtu")
            write_mesh(derivative.mesh, beside)
            table["derivatives"][name]["mesh"] = beside.name
    with renamed_when_whole(path, failure=BodyError) as temporary:
        temporary.write_text(toml_of(_in_file(table, path.parent)), encoding="utf-8")


def _in_file(value: Any, folder: Path) -> Any:
    """Values as TOML has them: paths relative to the folder of the file."""
    if isinstance(value, dict):
        return {key: _in_file(item, folder) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_in_file(item, folder) for item in value]
    if isinstance(value, Path):
        return os.path.relpath(value, folder)
    return value
