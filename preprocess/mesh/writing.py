"""Meshes as files that `read_mesh` reads back."""

import os
from pathlib import Path

import meshio
import numpy as np

from ...files import renamed_when_whole
from ..errors import MeshError
from .mesh import Mesh


def write_mesh(mesh: Mesh, path: str | os.PathLike[str]) -> None:
    """Write a mesh and its groups as a file of VTK (.vtu); it appears whole or not at all.

    A group is an array of 0 and 1 on cells, on points, or on both. `MeshError` names a file that
    cannot be written.
    """
    kinds = list(mesh.cells)
    cell_data, point_data = {}, {}
    for name, group in mesh.groups.items():
        if group.cells:
            marks = [np.zeros(len(mesh.cells[kind]), dtype=np.int32) for kind in kinds]
            for mark, kind in zip(marks, kinds, strict=True):
                # VTK knows no sets; the reader turns arrays of 0 and 1 back into groups.
                mark[group.cells.get(kind, ())] = 1
            cell_data[name] = marks
        if len(group.points):
            point_data[name] = np.zeros(len(mesh.points), dtype=np.int32)
            point_data[name][group.points] = 1
    whole = meshio.Mesh(
        mesh.points, list(mesh.cells.items()), point_data=point_data, cell_data=cell_data
    )
    with renamed_when_whole(Path(path), failure=MeshError) as temporary:
        meshio.vtu.write(str(temporary), whole)
