"""Files of robots, by what they hold."""

from pathlib import Path

from .description import Robot
from .errors import RobotError
from .mjcf import read_mjcf
from .urdf import read_urdf
from .xml import read_xml


def read_robot(path: Path) -> Robot:
    """The robot of a file in URDF or MJCF; `RobotError` names the file."""
    if path.suffix.lower() == ".xacro":
        raise RobotError(
            f"{path}: expected URDF, found a xacro file: expand it first, "
            f"xacro {path.name} > robot.urdf"
        )
    root = read_xml(path)
    if root.tag == "robot":
        return read_urdf(path, root)
    if root.tag == "mujoco":
        return read_mjcf(path)
    raise RobotError(f"{path}: expected <robot> of URDF or <mujoco> of MJCF, found <{root.tag}>")
