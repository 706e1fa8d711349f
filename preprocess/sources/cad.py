"""Meshes of the CAD files that bodies name."""

import tempfile
from dataclasses import replace
from pathlib import Path

from ...cad import CadError, knows_unit, mesh_solid
from ..body.body import Body
from ..body.cad import picks_of
from ..errors import MeshError
from ..mesh.mesh import Mesh
from ..mesh.reading import finished, read_draft


def mesh_of_cad(body: Body, path: Path) -> Mesh:
    """Mesh a CAD file as its body asks for; each hole and face that is selected is a group.

    `MeshError` names the file, and the key whose hole or face it does not have.
    """
    assert body.size is not None
    unit = None if knows_unit(path) else body.scale
    # By a file, whose groups, orders and types its reader knows already.
    with tempfile.TemporaryDirectory() as folder:
        meshed = Path(folder, "part.msh")
        try:
            geometry, in_file = mesh_solid(
                path, meshed, body.size, picks_of(body), solid=body.solid, unit=unit
            )
        except CadError as error:
            raise MeshError(str(error)) from error
        mesh = finished(path, read_draft(meshed), in_file)
    return replace(mesh, geometry=geometry)
