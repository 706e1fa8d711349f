"""CAD files: their solids, holes and faces, and meshes of them.

gmsh reads and meshes them, in a process of its own (`worker.py`), which alone imports it.
"""

from .errors import CadError
from .feature import Feature
from .reading import Geometry, is_cad, knows_unit, mesh_solid, solids_of
from .solid import Solid

__all__ = [
    "CadError",
    "Feature",
    "Geometry",
    "Solid",
    "is_cad",
    "knows_unit",
    "mesh_solid",
    "solids_of",
]
