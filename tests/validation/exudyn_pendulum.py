"""Pendulums of flexible beams in Exudyn: planar and geometrically exact, without a floating frame.

One beam or two hang, one on the other, from a fixed pivot; they start at rest along the x axis and
fall under gravity along -y. The cables are those of `exudyn_beam`, of the same length and section.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import exudyn
import numpy as np
from exudyn.itemInterface import (
    LoadMassProportional,
    MarkerBodyMass,
    MarkerNodePosition,
    NodePoint2DSlope1,
    ObjectANCFCable2D,
    ObjectGround,
    ObjectJointRevolute2D,
    SensorNode,
)
from exudyn.itemInterface import MarkerBodyPosition as MarkerPosition
from numpy.typing import NDArray

from .exudyn_beam import EA, EI, L, m, settings

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pendulum:
    """time (n,) [s]; ends (n, beams, 2, 2) [m]: position of the first and the last point of every
    beam.
    """

    time: Array
    ends: Array


def pendulum(
    beams: int,
    t_end: float,
    step: float,
    gravity: float = 9.81,
    n_elements: int = 16,
    stiffness: float = EI,
) -> Pendulum:
    """The motion of `beams` cables of `n_elements` each and this bending stiffness [N m^2], joined
    by revolute joints.

    Raises exudyn.SolverError when Newton does not converge.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(ObjectGround())
    support = system.AddMarker(MarkerPosition(bodyNumber=ground))
    sensors = []
    for beam in range(beams):
        nodes = _add_cable(system, beam * L, n_elements, gravity, stiffness)
        first, last = (system.AddMarker(MarkerNodePosition(nodeNumber=nodes[i])) for i in (0, -1))
        system.AddObject(ObjectJointRevolute2D(markerNumbers=[support, first]))
        support = last
        sensors += [_position_of(system, nodes[i]) for i in (0, -1)]
    system.Assemble()

    steps = int(np.ceil(t_end / step - 1e-9))
    choices = settings()
    choices.timeIntegration.endTime = t_end
    choices.timeIntegration.numberOfSteps = steps
    system.SolveDynamic(choices)
    ends = [np.asarray(system.GetSensorStoredData(sensor))[:, 1:3] for sensor in sensors]
    return Pendulum(
        np.linspace(0.0, t_end, steps + 1), np.stack(ends, axis=1).reshape(-1, beams, 2, 2)
    )


def _add_cable(
    system: Any, x: float, n_elements: int, gravity: float, stiffness: float
) -> list[int]:
    nodes = [
        system.AddNode(NodePoint2DSlope1(referenceCoordinates=[place, 0.0, 1.0, 0.0]))
        for place in x + np.linspace(0.0, L, n_elements + 1)
    ]
    for left, right in pairwise(nodes):
        cable = system.AddObject(
            ObjectANCFCable2D(
                length=L / n_elements,
                massPerLength=m,
                bendingStiffness=stiffness,
                axialStiffness=EA,
                nodeNumbers=[left, right],
            )
        )
        marker = system.AddMarker(MarkerBodyMass(bodyNumber=cable))
        system.AddLoad(LoadMassProportional(markerNumber=marker, loadVector=[0.0, -gravity, 0.0]))
    return nodes


def _position_of(system: Any, node: int) -> int:
    quantity = exudyn.OutputVariableType.Position
    return system.AddSensor(
        SensorNode(
            nodeNumber=node, outputVariableType=quantity, storeInternal=True, writeToFile=False
        )
    )
