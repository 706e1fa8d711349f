"""Impacts in Exudyn: cables and reduced bodies with its contact elements.

Contacts of coordinates have no sensor of their force, which follows by their law from where both
sides are. Steps keep their length: what the contact recommends is not heeded, and an iteration over
its switching that comes to no end is none.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import exudyn
import numpy as np
from exudyn.itemInterface import (
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    Node1D,
    NodeGenericData,
    NodePoint2DSlope1,
    NodePointGround,
    ObjectANCFCable2D,
    ObjectConnectorCoordinate,
    ObjectContactCoordinate,
    ObjectContactSphereSphere,
    ObjectGround,
    ObjectMass1D,
    SensorNode,
    SensorObject,
    SensorSuperElement,
)
from impact.exact import Rod, SphereOnBeam

from .reduced_body import ReducedBody, rigid_marker
from .run import Array, Run
from .system import System

AREA = 1e-4
"""of the rod and the beam [m^2]"""
SQUARE = 1.0 / 12.0
"""second moment of a square section over its area squared"""
ALONG, ACROSS = 0, 1
"""coordinates of a node in the plane"""


def rod_on_wall(
    rod: Rod, elements: int, speed: float, K: float, h: float, t_end: float, tolerance: float
) -> tuple[Run, Array]:
    """ANCF cables along x meet a wall at the origin; with the force (n,) [N]."""
    system = _system(h, tolerance)
    nodes = _cables(system, rod, [-rod.length, 0.0], elements, [speed, 0.0, 0.0, 0.0])
    wall = system.items.AddMarker(
        MarkerNodeCoordinate(nodeNumber=system.items.AddNode(NodePointGround()), coordinate=0)
    )
    _contact(system, _coordinate(system, nodes[-1], ALONG), wall, K, 1.0)
    system.watch(SensorNode, nodeNumber=nodes[-1])
    system.items.Assemble()
    system.march(t_end)
    run = system.run()
    return run, K * np.maximum(run.tip[:, 0], 0.0)


def sphere_on_beam(
    impact: SphereOnBeam, elements: int, h: float, t_end: float, tolerance: float
) -> tuple[Run, Array]:
    """A mass on ANCF cables, held at both ends across and at the left along; the force (n,) [N]."""
    system = _system(h, tolerance)
    nodes = _cables(system, impact, [0.0, impact.length], elements, [0.0] * 4)
    ground = system.items.AddMarker(
        MarkerNodeCoordinate(nodeNumber=system.items.AddNode(NodePointGround()), coordinate=0)
    )
    for node, coordinate in ((0, ALONG), (0, ACROSS), (-1, ACROSS)):
        held = _coordinate(system, nodes[node], coordinate)
        system.items.AddObject(ObjectConnectorCoordinate(markerNumbers=[ground, held]))
    ball = system.items.AddNode(
        Node1D(referenceCoordinates=[0.0], initialVelocities=[-impact.speed])
    )
    system.items.AddObject(ObjectMass1D(nodeNumber=ball, mass=impact.m))
    middle = nodes[elements // 2]
    _contact(
        system,
        _coordinate(system, middle, ACROSS),
        _coordinate(system, ball, 0),
        impact.K,
        1.5,
    )
    system.watch(SensorNode, nodeNumber=middle)
    fallen = _stored(system, SensorNode, exudyn.OutputVariableType.Coordinates, nodeNumber=ball)
    system.items.Assemble()
    system.march(t_end)
    run = system.run()
    depth = run.tip[:, 1] - fallen()[:, 0]
    return run, impact.K * np.maximum(depth, 0.0) ** 1.5


def bar_on_sphere(
    bar: ReducedBody,
    length: float,
    radii: tuple[float, float],
    speed: float,
    K: float,
    h: float,
    t_end: float,
    tolerance: float,
) -> tuple[Run, Array]:
    """A reduced body flies along x, a ball about its end, to one of the ground; force (n,) [N]."""
    system = _system(h, tolerance, dense=True)
    ground = system.items.AddObject(ObjectGround(referencePosition=[length + sum(radii), 0.0, 0.0]))
    body = bar.add(system, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [speed, 0.0, 0.0])
    markers = [
        rigid_marker(system, body, bar.corners(length)),
        system.items.AddMarker(MarkerBodyRigid(bodyNumber=ground)),
    ]
    node = system.items.AddNode(
        NodeGenericData(initialCoordinates=[0.0] * 4, numberOfDataCoordinates=4)
    )
    contact = system.items.AddObject(
        ObjectContactSphereSphere(
            markerNumbers=markers, nodeNumber=node, spheresRadii=list(radii), contactStiffness=K
        )
    )
    force = _stored(system, SensorObject, exudyn.OutputVariableType.Force, objectNumber=contact)
    system.watch(
        SensorSuperElement, bodyNumber=body, meshNodeNumber=bar.nearest([length, 0.0, 0.0])
    )
    system.items.Assemble()
    system.march(t_end)
    return system.run(), np.linalg.norm(force(), axis=1)


def _system(h: float, tolerance: float, dense: bool = False) -> System:
    system = System(h, tolerance, dense)
    discontinuous = system.settings.timeIntegration.discontinuous
    discontinuous.useRecommendedStepSize = False
    discontinuous.ignoreMaxIterations = True
    return system


def _cables(
    system: System,
    line: Rod | SphereOnBeam,
    ends: Sequence[float],
    elements: int,
    velocity: Sequence[float],
) -> list[int]:
    """The nodes of a square section of steel from one end on x to the other."""
    places = np.linspace(ends[0], ends[1], elements + 1)
    nodes = [
        system.items.AddNode(
            NodePoint2DSlope1(
                referenceCoordinates=[x, 0.0, 1.0, 0.0], initialVelocities=list(velocity)
            )
        )
        for x in places
    ]
    section = {
        "length": (ends[1] - ends[0]) / elements,
        "massPerLength": line.mass_per_length,
        "bendingStiffness": line.EI if isinstance(line, SphereOnBeam) else SQUARE * line.EA * AREA,
        "axialStiffness": line.EA if isinstance(line, Rod) else line.EI / (SQUARE * AREA),
    }
    for pair in pairwise(nodes):
        system.items.AddObject(ObjectANCFCable2D(nodeNumbers=list(pair), **section))
    return nodes


def _coordinate(system: System, node: int, coordinate: int) -> int:
    marker: int = system.items.AddMarker(
        MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate)
    )
    return marker


def _contact(system: System, first: int, second: int, K: float, exponent: float) -> None:
    """Where the first coordinate is beyond the second."""
    node = system.items.AddNode(
        NodeGenericData(initialCoordinates=[0.0], numberOfDataCoordinates=1)
    )
    system.items.AddObject(
        ObjectContactCoordinate(
            markerNumbers=[first, second],
            nodeNumber=node,
            contactStiffness=K,
            contactStiffnessExponent=exponent,
        )
    )


def _stored(system: System, sensor: type, variable: object, **where: int) -> Callable[[], Array]:
    """What a sensor has stored (n, k) after the march."""
    number = system.items.AddSensor(
        sensor(outputVariableType=variable, storeInternal=True, writeToFile=False, **where)
    )

    def stored() -> Array:
        values: Array = np.asarray(system.items.GetSensorStoredData(number))[:, 1:]
        return values

    return stored
