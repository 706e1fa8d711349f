"""Armatures: the inertia of a motor as a joint feels it, by a rotor behind a gear.

    J_rotor = armature / ratio^2,     q_shaft = ratio q

The energy of the rotor is that of the armature; what it takes part in beside that, the rotation of
its parent about the axis, is smaller by the ratio.
"""

from collections.abc import Iterator

import numpy as np

from ..files.arrays import Array
from .couplings import NamedJoint
from .document import Section, table_head, tidy, without_noise
from .flexible import anchor
from .names import Names
from .poses import Pose
from .tree import Tree

# [m] of a rotor: large, so that the mass that it adds is small.
RADIUS_OF_GYRATION = 0.1
# Inertia of a rotor across its axis over that about it: a short cylinder.
ACROSS_OVER_AXIAL = 0.6


def rotor(joint: NamedJoint, tree: Tree, ratio: float, names: Names) -> Iterator[Section]:
    """The body, the joint and the coupler of a rotor on the parent of a joint."""
    axial = joint.joint.armature / ratio**2
    place = anchor(tree, joint.joint)
    axis = tree.pose[joint.joint.child].R @ joint.joint.axis
    body, shaft = names.new(f"{joint.name} rotor"), names.new(f"{joint.name} shaft")
    on = joint.parent.attach(f"{joint.joint.name} shaft", Pose(joint.parent.pose.R, place))
    yield Section(
        table_head("bodies", body),
        {
            "mass": float(f"{axial / RADIUS_OF_GYRATION**2:.6g}"),
            "inertia": without_noise(_inertia(axial, axis)),
            "position": tidy(place),
            "frames.shaft": {"position": [0.0, 0.0, 0.0]},
        },
        above=[f"armature of {joint.name}: {joint.joint.armature:g} behind a gear of {ratio:g}"],
    )
    yield Section(
        "[[joints]]",
        {
            "name": shaft,
            "type": "revolute",
            "between": [on, f"{body}.shaft"],
            "axis": tidy(axis, 1.0),
        },
    )
    yield Section(
        "[[couplers]]",
        {
            "name": f"{joint.name} gear",
            "type": "linear",
            "joints": [shaft, joint.name],
            "ratios": [1.0, -ratio],
        },
    )


def _inertia(axial: float, axis: Array) -> Array:
    """The inertia (3, 3) of a short cylinder about its axis (3,), in axes of space."""
    along = np.outer(axis, axis)
    inertia: Array = axial * (along + ACROSS_OVER_AXIAL * (np.eye(3) - along))
    return inertia
