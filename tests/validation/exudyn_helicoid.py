"""Cases 3 to 5 of the paper in Exudyn: a beam on a hub that slides along, and turns about, a
vertical axis.

Geometrically exact beams in space (`ObjectBeamGeometricallyExact`: Simo and Vu-Quoc's, with two
nodes and one point of integration), whose nodes are rigid frames: the clamp joins the first one to
the hub, all six coordinates. The absolute nodal cables of the other models have no rotation about
their axis in space and cannot be clamped so.

The strain of a linear element errs with the square of its length: 1/(4 n^2) of the deflection of a
cantilever under a force at its tip. Shear: GA = EA / 2.6, which for this section adds 1e-5 to
deflections. Gravity acts on hub, beam and tip mass, a rigid body on the last node.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import exudyn
import numpy as np
from exudyn.itemInterface import (
    LoadForceVector,
    LoadMassProportional,
    LoadTorqueVector,
    MarkerBodyMass,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodeRigidBodyEP,
    ObjectBeamGeometricallyExact,
    ObjectGround,
    ObjectJointGeneric,
    ObjectRigidBody,
    SensorBody,
    SensorNode,
)
from numpy.typing import NDArray

from .exudyn_beam import EA, EI, L, a, m, settings

Array = NDArray[np.float64]

GJ = 4.0
POLAR = 4.4e-8  # inertia per length about the axis of the beam [kg m]
HUB_MASS, HUB_INERTIA = 0.01, 0.00238
TIP_INERTIA = 1e-8
IDENTITY = [1.0, 0.0, 0.0, 0.0]  # Euler parameters


@dataclass(frozen=True, eq=False)
class Helicoid:
    """time (n,) [s]; height [m] and rotation matrix (n, 3, 3) of the hub; position of the tip (n,
    3) [m].
    """

    time: Array
    height: Array
    rotation: Array
    tip: Array

    @property
    def angle(self) -> Array:
        """Of the hub about the axis (n,) [rad], continued over full turns."""
        return np.unwrap(np.arctan2(self.rotation[:, 1, 0], self.rotation[:, 0, 0]))

    @property
    def deflection(self) -> Array:
        """Displacement of the tip seen from the hub (n, 3) [m]."""
        arm = self.tip - np.outer(self.height, [0.0, 0.0, 1.0])
        return np.einsum("nji,nj->ni", self.rotation, arm) - np.array([a + L, 0.0, 0.0])


@dataclass(frozen=True)
class Blow:
    """A force [N] in space on the tip, from start to end [s]."""

    force: tuple[float, float, float]
    start: float
    end: float


def helicoid(
    torque: float,
    force: float,
    pulse: float,
    gravity: float,
    t_end: float,
    step: float,
    n_elements: int,
    tip_mass: float = 0.0,
    blow: Blow | None = None,
) -> Helicoid:
    """The motion under a torque [N m] and a vertical force [N] that act on the hub from t = 0 until
    `pulse` [s].

    Runs of the integrator meet where loads begin and end, so that no step straddles a jump.
    Raises exudyn.SolverError when Newton does not converge.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    hub_node = system.AddNode(NodeRigidBodyEP(referenceCoordinates=[0.0, 0.0, 0.0, *IDENTITY]))
    hub = system.AddObject(
        ObjectRigidBody(
            mass=HUB_MASS, inertia=[1e-6, 1e-6, HUB_INERTIA, 0.0, 0.0, 0.0], nodeNumber=hub_node
        )
    )
    ground = system.AddObject(ObjectGround())
    center = system.AddMarker(MarkerBodyRigid(bodyNumber=hub))
    support = system.AddMarker(MarkerBodyRigid(bodyNumber=ground))
    system.AddObject(
        ObjectJointGeneric(markerNumbers=[support, center], constrainedAxes=[1, 1, 0, 1, 1, 0])
    )
    nodes = _add_beam(system, n_elements, gravity)
    rim = system.AddMarker(MarkerBodyRigid(bodyNumber=hub, localPosition=[a, 0.0, 0.0]))
    root = system.AddMarker(MarkerNodeRigid(nodeNumber=nodes[0]))
    system.AddObject(
        ObjectJointGeneric(markerNumbers=[rim, root], constrainedAxes=[1, 1, 1, 1, 1, 1])
    )
    _add_weight(system, hub, gravity)
    if tip_mass:
        ball = ObjectRigidBody(
            mass=tip_mass,
            inertia=[TIP_INERTIA, TIP_INERTIA, TIP_INERTIA, 0.0, 0.0, 0.0],
            nodeNumber=nodes[-1],
        )
        _add_weight(system, system.AddObject(ball), gravity)
    tip = system.AddMarker(MarkerNodeRigid(nodeNumber=nodes[-1]))
    turning = system.AddLoad(LoadTorqueVector(markerNumber=center, loadVector=[0.0, 0.0, torque]))
    lifting = system.AddLoad(LoadForceVector(markerNumber=center, loadVector=[0.0, 0.0, force]))
    striking = system.AddLoad(LoadForceVector(markerNumber=tip, loadVector=[0.0, 0.0, 0.0]))
    quantity = exudyn.OutputVariableType
    stored = {"storeInternal": True, "writeToFile": False}
    sensors = [
        system.AddSensor(
            SensorBody(bodyNumber=hub, outputVariableType=quantity.Position, **stored)
        ),
        system.AddSensor(
            SensorBody(bodyNumber=hub, outputVariableType=quantity.RotationMatrix, **stored)
        ),
        system.AddSensor(
            SensorNode(nodeNumber=nodes[-1], outputVariableType=quantity.Position, **stored)
        ),
    ]
    system.Assemble()

    choices = settings()
    runs = []
    instants = [0.0, pulse, *((blow.start, blow.end) if blow else ()), t_end]
    for start, end in pairwise(instants):
        steps = round((end - start) / step)
        choices.timeIntegration.startTime, choices.timeIntegration.endTime = start, end
        choices.timeIntegration.numberOfSteps = steps
        if start >= pulse:
            for load in (turning, lifting):
                system.SetLoadParameter(load, "loadVector", [0.0, 0.0, 0.0])
        if blow:
            system.SetLoadParameter(
                striking, "loadVector", list(blow.force) if start == blow.start else [0.0] * 3
            )
        system.SolveDynamic(choices, updateInitialValues=True)
        columns = [np.asarray(system.GetSensorStoredData(sensor))[:, 1:] for sensor in sensors]
        run = np.column_stack([np.linspace(start, end, steps + 1), *columns])
        runs.append(run if not runs else run[1:])
    history = np.vstack(runs)
    return Helicoid(
        history[:, 0], history[:, 3], history[:, 4:13].reshape(-1, 3, 3), history[:, 13:16]
    )


def _add_beam(system: Any, n_elements: int, gravity: float) -> list[int]:
    section = exudyn.BeamSection()
    section.massPerLength = m
    section.inertia = np.diag([POLAR, 0.5 * POLAR, 0.5 * POLAR])
    section.stiffnessMatrix = np.diag([EA, EA / 2.6, EA / 2.6, GJ, EI, EI])
    nodes = [
        system.AddNode(NodeRigidBodyEP(referenceCoordinates=[x, 0.0, 0.0, *IDENTITY]))
        for x in a + np.linspace(0.0, L, n_elements + 1)
    ]
    for pair in pairwise(nodes):
        element = system.AddObject(
            ObjectBeamGeometricallyExact(
                nodeNumbers=list(pair), length=L / n_elements, sectionData=section
            )
        )
        _add_weight(system, element, gravity)
    return nodes


def _add_weight(system: Any, body: int, gravity: float) -> None:
    marker = system.AddMarker(MarkerBodyMass(bodyNumber=body))
    system.AddLoad(LoadMassProportional(markerNumber=marker, loadVector=[0.0, 0.0, -gravity]))
