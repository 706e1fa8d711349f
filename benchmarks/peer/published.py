"""Published benchmarks in Exudyn: parallel linkages, Bricard's mechanism, and beams in space."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import exudyn
import numpy as np
from exudyn.itemInterface import (
    CoordinateConstraint,
    LoadForceVector,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    MarkerNodeRigid,
    NodePointGround,
    NodeRigidBody2D,
    NodeRigidBodyEP,
    NodeRigidBodyRxyz,
    ObjectBeamGeometricallyExact,
    ObjectGround,
    ObjectJointGeneric,
    ObjectJointRevolute2D,
    ObjectRigidBody,
    ObjectRigidBody2D,
    SensorBody,
    SensorNode,
    SensorObject,
)
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from .run import Run
from .system import System

Array = NDArray[np.float64]

GRAVITY = 9.81
TOLERANCE = 1e-10
"""of Newton's increments: with 1e-8 the linkages err by 5 cm where they pass singular positions"""


def four_bars(n: int, step: float, t_end: float) -> Run:
    """A02 of the IFToMM library, in the plane; the tip is the first upper pin."""
    system = System(step, TOLERANCE)
    items = system.items
    ground = items.AddObject(ObjectGround())
    uprights = []
    for i in range(n + 1):
        bar = _planar_bar(items, [i, 0.5, np.pi / 2], [0.5, 0.0, -1.0])
        _hinge(items, (ground, [i, 0.0, 0.0]), (bar, [-0.5, 0.0, 0.0]))
        uprights.append(bar)
    for i, (left, right) in enumerate(pairwise(uprights)):
        coupler = _planar_bar(items, [i + 0.5, 1.0, 0.0], [1.0, 0.0, 0.0])
        _hinge(items, (left, [0.5, 0.0, 0.0]), (coupler, [-0.5, 0.0, 0.0]))
        _hinge(items, (coupler, [0.5, 0.0, 0.0]), (right, [0.5, 0.0, 0.0]))
    system.watch(SensorBody, bodyNumber=uprights[0], localPosition=[0.5, 0.0, 0.0])
    items.Assemble()
    system.march(t_end)
    return system.run()


def _planar_bar(items: Any, place: list[float], velocity: list[float]) -> int:
    node = items.AddNode(NodeRigidBody2D(referenceCoordinates=place, initialVelocities=velocity))
    bar: int = items.AddObject(
        ObjectRigidBody2D(physicsMass=1.0, physicsInertia=1.0 / 12.0, nodeNumber=node)
    )
    weigh(items, bar, [0.0, -GRAVITY, 0.0])
    return bar


def weigh(items: Any, body: int, gravity: list[float]) -> None:
    marker = items.AddMarker(MarkerBodyMass(bodyNumber=body))
    items.AddLoad(LoadMassProportional(markerNumber=marker, loadVector=gravity))


def _hinge(items: Any, *ends: tuple[int, list[float]]) -> None:
    markers = [
        items.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=point))
        for body, point in ends
    ]
    items.AddObject(ObjectJointRevolute2D(markerNumbers=markers))


def bricard(points: Array, axes: list[Array], step: float, t_end: float) -> Run:
    """A04 of the IFToMM library; the tip is the fourth hinge.

    The last hinge leaves out one of its constraints, as ours does.
    """
    system = System(step, TOLERANCE)
    items = system.items
    ground = (items.AddObject(ObjectGround()), np.eye(3))
    rods = []
    for start, end in pairwise(points):
        turn = Rotation.align_vectors([end - start], [[1.0, 0.0, 0.0]])[0]
        rods.append((_rod(items, (start + end) / 2, turn), turn.as_matrix()))
    places = [
        (ground, points[0]),
        *(zip(rods, [(0.5, 0, 0)] * 4, strict=False)),
        (ground, points[-1]),
    ]
    ends = [(rod, (-0.5, 0.0, 0.0)) for rod in rods] + [(rods[-1], (0.5, 0.0, 0.0))]
    for k, (axis, one, other) in enumerate(zip(axes, places, ends, strict=True)):
        _revolute(items, one, other, axis, [1, 1, 1, 1, int(k < 5), 0])
    system.watch(SensorBody, bodyNumber=rods[2][0], localPosition=[0.5, 0.0, 0.0])
    items.Assemble()
    system.march(t_end)
    return system.run()


def _rod(items: Any, center: Array, turn: Rotation) -> int:
    x, y, z, w = turn.as_quat()
    node = items.AddNode(NodeRigidBodyEP(referenceCoordinates=[*center, w, x, y, z]))
    across = 1.01 / 12.0
    rod: int = items.AddObject(
        ObjectRigidBody(mass=1.0, inertia=[0.01 / 6, across, across, 0, 0, 0], nodeNumber=node)
    )
    weigh(items, rod, [0.0, -GRAVITY, 0.0])
    return rod


def _revolute(items: Any, one: Any, other: Any, axis: Array, constrained: list[int]) -> None:
    """Of two bodies with their rotations, at points in their axes."""
    turn = Rotation.align_vectors([axis], [[0.0, 0.0, 1.0]])[0].as_matrix()
    markers = [
        items.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=list(point)))
        for (body, _), point in (one, other)
    ]
    rotations = {f"rotationMarker{k}": end[0][1].T @ turn for k, end in enumerate((one, other))}
    items.AddObject(
        ObjectJointGeneric(markerNumbers=markers, constrainedAxes=constrained, **rotations)
    )


@dataclass(frozen=True, eq=False)
class Beam:
    """Markers of its ends, and its nodes."""

    start: int
    end: int
    nodes: list[int]


def add_beam(
    items: Any, ends: tuple[Array, Array], turn: Rotation, section: Any, elements: int
) -> Beam:
    """Geometrically exact elements of two nodes along the local x axis."""
    start, end = ends
    x, y, z, w = turn.as_quat()
    parameters = [w, x, y, z]
    nodes = [
        items.AddNode(NodeRigidBodyEP(referenceCoordinates=[*place, *parameters]))
        for place in np.linspace(start, end, elements + 1)
    ]
    length = float(np.linalg.norm(end - start)) / elements
    for pair in pairwise(nodes):
        items.AddObject(
            ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=length, sectionData=section)
        )
    markers = [items.AddMarker(MarkerNodeRigid(nodeNumber=nodes[k])) for k in (0, -1)]
    return Beam(*markers, nodes)


def beam_section(stiffnesses: list[float], mass: float, inertias: list[float]) -> Any:
    """EA, GA_y, GA_z, GJ, EI_y, EI_z; mass and moments of inertia per length."""
    section = exudyn.BeamSection()
    section.stiffnessMatrix = np.diag(stiffnesses)
    section.massPerLength = mass
    section.inertia = np.diag(inertias)
    return section


def princeton_tip(length: float, section: Any, force: list[float], elements: int) -> Array:
    """Displacement (3,) [m] of the tip of a cantilever at rest under a dead force [N]."""
    container = exudyn.SystemContainer()
    items = container.AddSystem()
    ends = (np.zeros(3), np.array([length, 0.0, 0.0]))
    beam = add_beam(items, ends, Rotation.identity(), section, elements)
    ground = items.AddMarker(MarkerBodyRigid(bodyNumber=items.AddObject(ObjectGround())))
    items.AddObject(ObjectJointGeneric(markerNumbers=[ground, beam.start], constrainedAxes=[1] * 6))
    items.AddLoad(LoadForceVector(markerNumber=beam.end, loadVector=force))
    items.Assemble()
    settings = exudyn.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = 10
    settings.staticSolver.verboseMode = 0
    settings.staticSolver.newton.relativeTolerance = 1e-10
    settings.solution.file.write = False
    items.SolveStatic(settings)
    position = items.GetNodeOutput(beam.nodes[-1], exudyn.OutputVariableType.Position)
    return np.asarray(position) - ends[1]


def skew_four_bar(
    points: Array,
    sections: list[Any],
    skew: float,
    angle: Callable[[float], float],
    elements: int,
    step: float,
    t_end: float,
) -> tuple[Run, Array]:
    """Bars of `elements`, twice as many and `elements`; the tip is the end of the second.

    With it the torque of the drive (n,) [N m], which follows `angle(t)`.
    """
    system = System(step, TOLERANCE)
    system.settings.timeIntegration.generalizedAlpha.spectralRadius = 0.5
    items = system.items
    counts = (elements, 2 * elements, elements)
    turns = [Rotation.from_rotvec([0.0, 0.0, angle]) for angle in (np.pi / 2, 0.0, -np.pi / 2)]
    bars = [
        add_beam(items, ends, turn, section, count)
        for ends, turn, section, count in zip(
            pairwise(points), turns, sections, counts, strict=True
        )
    ]
    ground = items.AddObject(ObjectGround())
    foot = items.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=list(points[3])))
    drive = clamp_to_drive(items, points[0], Rotation.identity(), (bars[0].start, turns[0]), angle)
    tilt, straight = Rotation.from_rotvec([0.0, skew, 0.0]), Rotation.identity()
    first, second, third = zip(bars, turns, strict=True)
    revolute(items, (first[0].end, first[1]), (second[0].start, second[1]), straight)
    revolute(items, (second[0].end, second[1]), (third[0].start, third[1]), tilt)
    revolute(items, (foot, straight), (third[0].end, third[1]), straight)
    system.watch(SensorNode, nodeNumber=bars[1].nodes[-1])
    torque = exudyn.OutputVariableType.TorqueLocal
    sensor = items.AddSensor(
        SensorObject(
            objectNumber=drive, outputVariableType=torque, storeInternal=True, writeToFile=False
        )
    )
    items.Assemble()
    system.march(t_end)
    return system.run(), np.asarray(items.GetSensorStoredData(sensor))[:, 3]


Side = tuple[int, Rotation]
"""a marker and how its axes are turned"""


def revolute(items: Any, one: Side, other: Side, axes: Rotation) -> None:
    """About z of `axes`, in space at the start."""
    items.AddObject(
        ObjectJointGeneric(
            markerNumbers=[one[0], other[0]],
            constrainedAxes=[1, 1, 1, 1, 1, 0],
            rotationMarker0=(one[1].inv() * axes).as_matrix(),
            rotationMarker1=(other[1].inv() * axes).as_matrix(),
        )
    )


def clamp_to_drive(
    items: Any,
    place: Array,
    axes: Rotation,
    clamped: Side,
    angle: Callable[[float], float],
    axis: int = 2,
) -> int:
    """A hub that turns about an axis of `axes`, by six prescribed coordinates, with a beam clamped
    to it.

    The joint of the clamp. About x take axis 0 of straight axes: Tait and Bryan's angles, about x,
    y and z in turn, are singular where z points along x.
    """
    reference = [*place, *axes.as_euler("XYZ")]
    hub = items.AddNode(NodeRigidBodyRxyz(referenceCoordinates=reference))
    items.AddObject(ObjectRigidBody(mass=1.0, inertia=[1e-3] * 3 + [0.0] * 3, nodeNumber=hub))
    still = items.AddMarker(
        MarkerNodeCoordinate(nodeNumber=items.AddNode(NodePointGround()), coordinate=0)
    )
    for coordinate in range(6):
        held = items.AddMarker(MarkerNodeCoordinate(nodeNumber=hub, coordinate=coordinate))
        follow: dict[str, Any] = {"offsetUserFunction": lambda _m, t, _i, _o: angle(t)}
        items.AddObject(
            CoordinateConstraint(
                markerNumbers=[still, held], **(follow if coordinate == 3 + axis else {})
            )
        )
    marker, turn = clamped
    drive: int = items.AddObject(
        ObjectJointGeneric(
            markerNumbers=[items.AddMarker(MarkerNodeRigid(nodeNumber=hub)), marker],
            constrainedAxes=[1] * 6,
            rotationMarker1=(turn.inv() * axes).as_matrix(),
        )
    )
    return drive
