"""CAD files: their solids, holes and faces, and meshes of them.

gmsh reads and meshes them, in a process of its own (`worker.py`), which alone imports it.
"""

from .errors import CadError
from .feature import Feature
from .reading import CadGeometry, is_cad, knows_unit, mesh_solid, solids_in
from .solid import Solid

__all__ = [
    "CadError",
    "CadGeometry",
    "Feature",
    "Solid",
    "is_cad",
    "knows_unit",
    "mesh_solid",
    "solids_in",
]
