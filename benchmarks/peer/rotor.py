"""The paper's Case 1 in Exudyn: a beam clamped to a hub that a torque turns and stops, with three
kinds of beam.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from exudyn.itemInterface import (
    LoadTorqueVector,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodePoint2DSlope1,
    NodeRigidBody2D,
    NodeRigidBodyEP,
    ObjectANCFCable2D,
    ObjectBeamGeometricallyExact2D,
    ObjectGround,
    ObjectJointGeneric,
    ObjectJointRevolute2D,
    ObjectJointRevoluteZ,
    ObjectRigidBody,
    ObjectRigidBody2D,
    SensorNode,
    SensorSuperElement,
)

from tests.validation.exudyn_beam import EA, EI, I_T, L, a, m

from .reduced_body import Index, ReducedBody, rigid_marker
from .run import Run
from .system import System

HUB = 4.0 * I_T
TORQUE = [(2.0, 0.05), (0.0, 0.15), (-2.0, 0.2), (0.0, 0.3)]
"""of examples/case1.toml: how much [N m] until when [s]"""
CLAMPED_IN_PLANE = [1, 1, 0, 0, 0, 1]
GA = 0.3 * EA
"""of aluminium, about: the paper's beams do not shear"""
ROTARY_INERTIA = m * EI / EA


def cables(elements: int, step: float, tolerance: float, t_end: float = TORQUE[-1][1]) -> Run:
    """ANCF cables in the plane, Euler-Bernoulli."""
    system = System(step, tolerance)
    turn, rim = _planar_hub(system)
    nodes = [
        system.items.AddNode(NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0]))
        for x in _places(elements)
    ]
    section = {
        "length": L / elements,
        "massPerLength": m,
        "bendingStiffness": EI,
        "axialStiffness": EA,
    }
    parts = [
        system.items.AddObject(ObjectANCFCable2D(nodeNumbers=list(ends), **section))
        for ends in pairwise(nodes)
    ]
    root = system.items.AddMarker(
        MarkerBodyRigid(bodyNumber=parts[0], localPosition=[0.0, 0.0, 0.0])
    )
    system.items.AddObject(
        ObjectJointGeneric(markerNumbers=[rim, root], constrainedAxes=CLAMPED_IN_PLANE)
    )
    system.watch(SensorNode, nodeNumber=nodes[-1])
    return _turned(system, turn, t_end)


def exact_beams(elements: int, step: float, tolerance: float) -> Run:
    """Geometrically exact beams in the plane, which shear."""
    system = System(step, tolerance)
    turn, rim = _planar_hub(system)
    nodes = [
        system.items.AddNode(NodeRigidBody2D(referenceCoordinates=[x, 0.0, 0.0]))
        for x in _places(elements)
    ]
    section = {
        "length": L / elements,
        "massPerLength": m,
        "crossSectionInertia": ROTARY_INERTIA,
        "bendingStiffness": EI,
        "axialStiffness": EA,
        "shearStiffness": GA,
    }
    for ends in pairwise(nodes):
        system.items.AddObject(ObjectBeamGeometricallyExact2D(nodeNumbers=list(ends), **section))
    root = system.items.AddMarker(MarkerNodeRigid(nodeNumber=nodes[0]))
    system.items.AddObject(
        ObjectJointGeneric(markerNumbers=[rim, root], constrainedAxes=CLAMPED_IN_PLANE)
    )
    system.watch(SensorNode, nodeNumber=nodes[-1])
    return _turned(system, turn)


def reduced(
    bar: ReducedBody, held_at: Callable[[float], Index], step: float, tolerance: float
) -> Run:
    """A solid bar in its floating frame, clamped in space by the nodes that `held_at` finds across
    x.
    """
    system = System(step, tolerance, dense=True)
    node = system.items.AddNode(
        NodeRigidBodyEP(referenceCoordinates=[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    )
    inertia = [0.5 * HUB, 0.5 * HUB, HUB, 0.0, 0.0, 0.0]
    hub = system.items.AddObject(ObjectRigidBody(mass=0.01, inertia=inertia, nodeNumber=node))
    turn = _pivot(system, hub, ObjectJointRevoluteZ)
    rim = system.items.AddMarker(MarkerBodyRigid(bodyNumber=hub, localPosition=[a, 0.0, 0.0]))
    body = bar.add(system, [a, 0.0, 0.0], [0.0, 0.0, 0.0])
    root = rigid_marker(system, body, held_at(0.0))
    system.items.AddObject(ObjectJointGeneric(markerNumbers=[rim, root]))
    system.watch(SensorSuperElement, bodyNumber=body, meshNodeNumber=bar.nearest([L, 0.0, 0.0]))
    return _turned(system, turn)


def _places(elements: int) -> list[float]:
    return (a + np.linspace(0.0, L, elements + 1)).tolist()


def _planar_hub(system: System) -> tuple[int, int]:
    """The torque and the rim of a hub whose mass plays no part."""
    node = system.items.AddNode(NodeRigidBody2D())
    hub = system.items.AddObject(ObjectRigidBody2D(mass=0.01, inertia=HUB, nodeNumber=node))
    turn = _pivot(system, hub, ObjectJointRevolute2D)
    return turn, system.items.AddMarker(
        MarkerBodyRigid(bodyNumber=hub, localPosition=[a, 0.0, 0.0])
    )


def _pivot(system: System, hub: int, joint: type) -> int:
    """The torque on a hub that turns about z on the ground."""
    ground = system.items.AddObject(ObjectGround())
    markers = [system.items.AddMarker(MarkerBodyRigid(bodyNumber=body)) for body in (ground, hub)]
    system.items.AddObject(joint(markerNumbers=markers))
    return system.items.AddLoad(LoadTorqueVector(markerNumber=markers[1]))


def _turned(system: System, turn: Any, t_end: float = TORQUE[-1][1]) -> Run:
    """Every jump of the torque begins a march of its own, so that no step straddles one."""
    system.items.Assemble()
    for start, (torque, end) in zip([0.0, *(end for _, end in TORQUE)], TORQUE, strict=False):
        if start < t_end:
            system.items.SetLoadParameter(turn, "loadVector", [0.0, 0.0, torque])
            system.march(min(end, t_end))
    return system.run()
