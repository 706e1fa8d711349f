"""Robots in URDF or MJCF as model files."""

from .errors import RobotError
from .importing import ImportedRobot, import_robot
from .options import FlexibleLink, ImportOptions

__all__ = ["FlexibleLink", "ImportOptions", "ImportedRobot", "RobotError", "import_robot"]
