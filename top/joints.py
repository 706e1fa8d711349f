"""Joints: one class each, `Joint(frame_a, frame_b, ..., name="hinge")`.

    du.joints.Revolute(m.ground, rod["root"], axis="z", name="hinge")

Frames are handles, as `rod["root"]`, a body's own handle (its center of mass) and `m.ground`.
"""

from duhamel.solver.couplings.friction import Coulomb, JointFriction, Stribeck
from duhamel.solver.couplings.joints import (
    ConstantVelocity,
    Cylindrical,
    Fixed,
    Planar,
    PointOnLine,
    PointOnPlane,
    Prismatic,
    Revolute,
    Rod,
    RollingDisc,
    Screw,
    Spherical,
    Universal,
)

__all__ = [
    "ConstantVelocity",
    "Coulomb",
    "Cylindrical",
    "Fixed",
    "JointFriction",
    "Planar",
    "PointOnLine",
    "PointOnPlane",
    "Prismatic",
    "Revolute",
    "Rod",
    "RollingDisc",
    "Screw",
    "Spherical",
    "Stribeck",
    "Universal",
]
