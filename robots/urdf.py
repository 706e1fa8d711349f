"""Robots in URDF, the Unified Robot Description Format of ROS: links and joints in XML.

Source: https://wiki.ros.org/urdf/XML.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from .description import Geometry, Inertial, Joint, JointType, Link, Mimic, Robot, Visual
from .errors import RobotError
from .node import LeftOut, Node
from .poses import AT_ORIGIN, Pose, by_fixed_axes, by_quaternion
from .xml import elements

# Joints of URDF by those of a description; a continuous one is a revolute one without limits.
JOINT_TYPES: Mapping[str, JointType] = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "planar": "planar",
    "floating": "floating",
}
COLLISIONS_LEFT_OUT = "collision geometry: give [[contacts]] where parts touch"
# What values of xacro files begin with, before they are expanded.
XACRO_MARKS = "${", "$("


def read_urdf(path: Path, root: Element) -> Robot:
    """The robot of a file whose root element is <robot>.

    `RobotError` names the file and the link or joint.
    """
    _refuse_xacro(path, root)
    left_out = LeftOut()
    robot = Node(root, path, "robot", left_out)
    robot.reads(("name", "version"), ("link", "joint"), silent=("material",))
    links = {node.name: _link(node) for node in robot.named("link")}
    if not links:
        raise robot.error("expected a <link>, found none")
    joints = tuple(_joint(node) for node in robot.named("joint"))
    return Robot(root.get("name", "") or path.stem, path, links, joints, left_out=left_out.lines())


def _refuse_xacro(path: Path, root: Element) -> None:
    for element in elements(root):
        values = [value for value in element.attrib.values() if value.startswith(XACRO_MARKS)]
        if element.tag.startswith("xacro:") or values:
            found = f"<{element.tag}>" if not values else repr(values[0])
            raise RobotError(
                f"{path}: expected URDF, found {found} of a xacro file: expand it first, "
                f"xacro {path.name} > robot.urdf"
            )


def _link(node: Node) -> Link:
    node.reads(
        ("name",), ("inertial", "visual", "collision"), silent=("type", "material", "verbose")
    )
    for _ in node.element.findall("collision"):
        node.left_out.counts[COLLISIONS_LEFT_OUT] += 1
    inertial = node.child("inertial")
    visuals = tuple(visual for each in node.each("visual") if (visual := _visual(each)))
    return Link(node.name, None if inertial is None else _inertial(inertial), visuals)


def _inertial(node: Node) -> Inertial | None:
    node.reads((), ("origin", "mass", "inertia"))
    mass = node.needed("mass").reads(("value",)).number("value")
    if mass < 0.0:
        raise node.error(f"mass: expected at least 0 kg, got {mass:g}")
    J = _inertia(node)
    pose = _origin(node)
    # Exporters write out links without any mass too.
    if mass == 0.0 and not J.any():
        return None
    return Inertial(mass, pose.p, pose.R @ J @ pose.R.T)


def _inertia(node: Node) -> np.ndarray:
    keys = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")
    inertia = node.needed("inertia").reads((*keys[0], *keys[1]))
    xx, yy, zz = (inertia.number(key) for key in keys[0])
    xy, xz, yz = (inertia.number(key, 0.0) for key in keys[1])
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _origin(node: Node) -> Pose:
    """The pose of an element by its <origin>, by default none."""
    origin = node.child("origin")
    if origin is None:
        return AT_ORIGIN
    origin.reads(("xyz", "rpy", "quat_xyzw"))
    zero = (0.0, 0.0, 0.0)
    p, rpy = origin.numbers("xyz", 3, zero), origin.numbers("rpy", 3, zero)
    if "quat_xyzw" not in origin.element.attrib:
        return Pose(by_fixed_axes(rpy), p)
    if "rpy" in origin.element.attrib:
        raise origin.error("expected rpy or quat_xyzw, got both")
    quaternion = origin.numbers("quat_xyzw", 4)
    if not quaternion.any():
        raise origin.error("quat_xyzw: expected a quaternion other than 0")
    return Pose(by_quaternion(quaternion), p)


def _visual(node: Node) -> Visual | None:
    node.reads(("name",), ("origin", "geometry"), silent=("material",))
    geometry = node.needed("geometry")
    pose = _origin(node)
    found = [each.tag for each in geometry.element]
    if len(found) != 1:
        raise geometry.error(f"expected one figure, found {', '.join(found) or 'none'}")
    (kind,) = found
    figure = geometry.needed(kind)
    if kind == "box":
        return Visual(pose, Geometry("box", _sizes(figure, "size", 3)))
    if kind == "sphere":
        return Visual(pose, Geometry("sphere", _sizes(figure, "radius", 1)))
    if kind == "cylinder":
        size = np.concatenate([_sizes(figure, "radius", 1), _sizes(figure, "length", 1)])
        return Visual(pose, Geometry("cylinder", size))
    if kind == "mesh":
        scale = figure.numbers("scale", 3, (1.0, 1.0, 1.0))
        if not scale.all():
            raise figure.error(f"scale: expected 3 numbers other than 0, got {scale.tolist()}")
        return Visual(pose, Geometry("mesh", scale, figure.word("filename")))
    node.left_out.remarks.append(f"{node.where}: the figure <{kind}>")
    return None


def _sizes(figure: Node, key: str, n: int) -> np.ndarray:
    sizes = figure.numbers(key, n)
    if not (sizes > 0.0).all():
        raise figure.error(f"{key}: expected positive numbers, got {sizes.tolist()}")
    return sizes


def _joint(node: Node) -> Joint:
    node.reads(
        ("name", "type"), ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic")
    )
    given = node.word("type")
    if given not in JOINT_TYPES:
        raise node.error(f"type: expected {', '.join(JOINT_TYPES)}, got {given!r}")
    parent = node.needed("parent").reads(("link",)).word("link")
    child = node.needed("child").reads(("link",)).word("link")
    kind, origin = JOINT_TYPES[given], _origin(node)
    # Exporters give these joints axes and limits, which mean nothing.
    if kind in ("fixed", "floating"):
        return Joint(node.name, kind, parent, child, origin)
    damping, friction = _dynamics(node)
    effort, velocity, limits = _limit(node, given)
    return Joint(
        node.name,
        kind,
        parent,
        child,
        origin,
        axis=_axis(node),
        limits=limits,
        effort=effort,
        velocity=velocity,
        damping=damping,
        friction=friction,
        mimic=_mimic(node),
    )


def _axis(node: Node) -> np.ndarray:
    axis = node.child("axis")
    if axis is None:
        return np.array([1.0, 0.0, 0.0])
    given = axis.reads(("xyz",)).numbers("xyz", 3)
    # Axes need not have unit length in files.
    length = float(np.linalg.norm(given))
    if length == 0.0:
        raise axis.error("xyz: expected a direction, got 0 0 0")
    return given / length


def _dynamics(node: Node) -> tuple[float, float]:
    """Damping and Coulomb friction of a joint."""
    dynamics = node.child("dynamics")
    if dynamics is None:
        return 0.0, 0.0
    dynamics.reads(("damping", "friction"))
    damping, friction = (dynamics.number(key, 0.0) for key in ("damping", "friction"))
    for key, value in (("damping", damping), ("friction", friction)):
        if value < 0.0:
            raise dynamics.error(f"{key}: expected at least 0, got {value:g}")
    return damping, friction


def _limit(node: Node, given: str) -> tuple[float | None, float | None, tuple[float, float] | None]:
    """Effort, velocity and the two limits of a joint, None for those that it has not."""
    limit = node.child("limit")
    if limit is None:
        if given in ("revolute", "prismatic"):
            node.left_out.remarks.append(f"{node.where}: no <limit>, so it has no stop")
        return None, None, None
    limit.reads(("lower", "upper", "effort", "velocity"))
    lower, upper = (limit.number(key, 0.0, infinite=True) for key in ("lower", "upper"))
    effort, velocity = (limit.number(key, 0.0, infinite=True) for key in ("effort", "velocity"))
    bounds = {"effort": effort, "velocity": velocity}
    for key, value in bounds.items():
        if value < 0.0:
            raise limit.error(f"{key}: expected at least 0, got {value:g}")
    # 0 stands for a value that is not known, as exporters of CAD write it.
    known = {key: value if 0.0 < value < math.inf else None for key, value in bounds.items()}
    limits = None
    if given in ("revolute", "prismatic"):
        if lower > upper:
            raise limit.error(f"expected lower below upper, got {lower:g} and {upper:g}")
        if lower == upper:
            node.left_out.remarks.append(
                f"{node.where}: limits of {lower:g} and {upper:g} leave no play: no stop"
            )
        elif math.isfinite(lower) or math.isfinite(upper):
            limits = lower, upper
    return known["effort"], known["velocity"], limits


def _mimic(node: Node) -> Mimic | None:
    mimic = node.child("mimic")
    if mimic is None:
        return None
    mimic.reads(("joint", "multiplier", "offset"))
    return Mimic(mimic.word("joint"), mimic.number("multiplier", 1.0), mimic.number("offset", 0.0))
