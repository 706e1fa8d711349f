"""Robots in URDF or MJCF, and assemblies of CAD files, as model files."""

from .assembly import ImportedAssembly, import_assembly
from .errors import RobotError
from .importing import ImportedRobot, import_robot
from .options import FlexibleLink, ImportOptions

__all__ = [
    "FlexibleLink",
    "ImportOptions",
    "ImportedAssembly",
    "ImportedRobot",
    "RobotError",
    "import_assembly",
    "import_robot",
]
