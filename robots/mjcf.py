"""Robots in MJCF, the XML of MuJoCo, as MuJoCo itself compiles them: bodies and joints.

Its compiler expands defaults, includes and units, and gives masses to geometries; what is read here
are the arrays of its `MjModel`. Source: https://mujoco.readthedocs.io/en/stable/XMLreference.html.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from .compiled_model import CompiledModel
from .description import COORDINATE_NAMES, Inertial, Joint, JointType, Link, Mimic, Robot
from .errors import RobotError
from .mjcf_actuators import actuators_of
from .mjcf_figures import visuals_of
from .poses import Pose, by_quaternion

# Of the coefficients by which one joint follows another, those that no coupler has.
POLYNOMIAL_TERMS = slice(2, 5)


def read_mjcf(path: Path) -> Robot:
    """The robot of a file whose root element is <mujoco>.

    `RobotError` names the file and the body or joint, also where mujoco is not installed.
    """
    try:
        import mujoco
    except ImportError as error:
        raise RobotError(
            f"{path}: MJCF is read by mujoco, which is not installed: pip install 'duhamel[robots]'"
        ) from error
    try:
        compiled: Any = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise RobotError(f"{path}: {' '.join(str(error).split())}") from error
    return Mjcf(path, mujoco, compiled).robot()


class Mjcf(CompiledModel):
    """A compiled model as the description of a robot."""

    def robot(self) -> Robot:
        m = self.model
        links = {self.body(i): self._link(i) for i in range(m.nbody)}
        # Body 0 is the world, which has no parent.
        joints = [self._joint(i) for i in range(1, m.nbody)]
        followers = dict(self._mimic(k) for k in range(m.neq) if self._is_coupler(k))
        actuators = actuators_of(self)
        self._count_rest()
        return Robot(
            _name_of(m.names) or self.path.stem,
            self.path,
            links,
            tuple(_following(joint, followers) for joint in joints),
            actuators,
            np.array(m.opt.gravity, dtype=float),
            tuple(self.left_out.elements()),
        )

    def _link(self, i: int) -> Link:
        m = self.model
        # The world has no mass, and its figures are those of the ground.
        if m.body_gravcomp[i]:
            self.leave_out(f"body {self.body(i)!r}: compensation of gravity")
        mass = float(m.body_mass[i])
        R = by_quaternion(np.roll(m.body_iquat[i], -1))
        J = R @ np.diag(m.body_inertia[i]) @ R.T
        inertial = Inertial(mass, np.array(m.body_ipos[i]), J) if mass or J.any() else None
        return Link(self.body(i), inertial, visuals_of(self, i))

    def _joint(self, i: int) -> Joint:
        """The joint between a body and its parent; without one they are fixed."""
        m, name = self.model, self.body(i)
        n, first = int(m.body_jntnum[i]), int(m.body_jntadr[i])
        parent = self.body(int(m.body_parentid[i]))
        # MuJoCo has the real part of a quaternion first.
        origin = Pose(by_quaternion(np.roll(m.body_quat[i], -1)), np.array(m.body_pos[i]))
        if n == 0:
            return Joint(f"{name} mount", "fixed", parent, name, origin)
        if n > 1:
            found = ", ".join(repr(self.joint(j)) for j in range(first, first + n))
            raise RobotError(
                f"{self.path}: body {name!r}: expected one joint, found {found}: put a body with "
                "a mass between them"
            )
        kind = self._types()[int(m.jnt_type[first])]
        if kind == "floating":
            return Joint(self.joint(first), kind, parent, name, origin)
        dof, coordinate = int(m.jnt_dofadr[first]), int(m.jnt_qposadr[first])
        single = kind in COORDINATE_NAMES
        self._leave_out_polynomials(first, dof)
        return Joint(
            self.joint(first),
            kind,
            parent,
            name,
            origin,
            axis=np.array(m.jnt_axis[first]),
            anchor=np.array(m.jnt_pos[first]),
            reference=float(m.qpos0[coordinate]) if single else 0.0,
            limits=_limits(m, first),
            damping=float(m.dof_damping[dof]),
            friction=float(m.dof_frictionloss[dof]),
            stiffness=float(m.jnt_stiffness[first]),
            rest=float(m.qpos_spring[coordinate]) if single else 0.0,
            armature=float(m.dof_armature[dof]),
        )

    def _types(self) -> dict[int, JointType]:
        types = self.mujoco.mjtJoint
        return {
            int(types.mjJNT_FREE): "floating",
            int(types.mjJNT_BALL): "spherical",
            int(types.mjJNT_SLIDE): "prismatic",
            int(types.mjJNT_HINGE): "revolute",
        }

    def _leave_out_polynomials(self, joint: int, dof: int) -> None:
        m = self.model
        for key, i in (("jnt_stiffnesspoly", joint), ("dof_dampingpoly", dof)):
            # Earlier versions of MuJoCo have linear springs and dampers alone.
            if np.any(getattr(m, key, np.zeros((i + 1, 1)))[i]):
                what = key.partition("_")[2].removesuffix("poly")
                self.leave_out(f"joint {self.joint(joint)!r}: {what} beyond its linear term")

    def _is_coupler(self, k: int) -> bool:
        """Whether an equality is a linear one between two joints; all others are left out."""
        m = self.model
        kind = self.mujoco.mjtEq(int(m.eq_type[k])).name.removeprefix("mjEQ_").lower()
        linear = not m.eq_data[k][POLYNOMIAL_TERMS].any()
        if kind == "joint" and m.eq_active0[k] and m.eq_obj2id[k] >= 0 and linear:
            return True
        name = str(m.equality(k).name) or f"number {k + 1}"
        self.leave_out(f"equality {name!r} of kind {kind}")
        return False

    def _mimic(self, k: int) -> tuple[str, Mimic]:
        """q_1 - q_1(0) = a_0 + a_1 (q_2 - q_2(0))"""
        m = self.model
        one, two = int(m.eq_obj1id[k]), int(m.eq_obj2id[k])
        constant, factor = m.eq_data[k][:2].tolist()
        start, other = (float(m.qpos0[m.jnt_qposadr[j]]) for j in (one, two))
        offset = start + constant - factor * other
        return self.joint(one), Mimic(self.joint(two), factor, offset)

    def _count_rest(self) -> None:
        m = self.model
        self.leave_out("tendons", int(m.ntendon))
        self.leave_out("sensors", int(m.nsensor))
        self.leave_out("keyframes", int(m.nkey))
        self.leave_out("flexes", int(m.nflex))
        if m.opt.density or m.opt.viscosity or np.any(m.opt.wind):
            self.leave_out("the medium: density, viscosity, wind")
        if np.any((m.geom_contype != 0) | (m.geom_conaffinity != 0)):
            self.leave_out("contacts of geometries: give [[contacts]] where parts touch")


def _limits(m: Any, j: int) -> tuple[float, float] | None:
    # A range may be given and switched off.
    if not m.jnt_limited[j]:
        return None
    lower, upper = m.jnt_range[j].tolist()
    return lower, upper


def _following(joint: Joint, followers: dict[str, Mimic]) -> Joint:
    return replace(joint, mimic=followers.get(joint.name))


def _name_of(names: bytes) -> str:
    """The name of a model, the first of all its names."""
    return names.partition(b"\0")[0].decode("utf-8", "replace")
