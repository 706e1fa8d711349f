"""The shaft that runs through its critical speed in Exudyn: geometrically exact beams."""

import numpy as np
from exudyn.itemInterface import (
    LoadForceVector,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodeRigidBodyEP,
    ObjectGround,
    ObjectJointGeneric,
    ObjectRigidBody,
    SensorNode,
)
from scipy.spatial.transform import Rotation

from examples.benchmarks import rotating_shaft as problem

from .published import add_beam, beam_section, clamp_to_drive, weigh
from .run import Run
from .system import System

TOLERANCE = 1e-9
"""of Newton's increments"""


def rotating_shaft(elements: int, step: float, t_end: float) -> Run:
    """The tip is the middle of the shaft, which has this even number of elements."""
    system = System(step, TOLERANCE)
    system.settings.timeIntegration.generalizedAlpha.spectralRadius = 0.5
    items, along = system.items, Rotation.identity()
    of, right = problem.SECTION, np.array([problem.L, 0.0, 0.0])
    stiffnesses = [of.EA, of.GA_y, of.GA_z, of.GJ, of.EI_y, of.EI_z]
    inertias = [of.polar_inertia_per_length, of.rotary_inertia_y, of.rotary_inertia_z]
    section = beam_section(stiffnesses, of.mass_per_length, inertias)
    shaft = add_beam(items, (np.zeros(3), right), along, section, elements)
    clamp_to_drive(items, np.zeros(3), along, (shaft.start, along), angle, axis=0)
    bearing = MarkerBodyRigid(bodyNumber=items.AddObject(ObjectGround()), localPosition=list(right))
    items.AddObject(
        ObjectJointGeneric(
            markerNumbers=[items.AddMarker(bearing), shaft.end], constrainedAxes=[0, 1, 1, 0, 1, 1]
        )
    )
    place = [problem.L / 2, 0.0, problem.ECCENTRICITY, 1.0, 0.0, 0.0, 0.0]
    node = items.AddNode(NodeRigidBodyEP(referenceCoordinates=place))
    inertia = [*problem.DISK_INERTIA, 0.0, 0.0, 0.0]
    disk = items.AddObject(ObjectRigidBody(mass=problem.DISK, inertia=inertia, nodeNumber=node))
    weigh(items, disk, [0.0, 0.0, -problem.G])
    hub = MarkerBodyRigid(bodyNumber=disk, localPosition=[0.0, 0.0, -problem.ECCENTRICITY])
    markers = [items.AddMarker(MarkerNodeRigid(nodeNumber=n)) for n in shaft.nodes]
    items.AddObject(
        ObjectJointGeneric(
            markerNumbers=[markers[elements // 2], items.AddMarker(hub)], constrainedAxes=[1] * 6
        )
    )
    weight = problem.G * of.mass_per_length * problem.L / elements
    for k, marker in enumerate(markers):
        share = weight if 0 < k < elements else weight / 2
        items.AddLoad(LoadForceVector(markerNumber=marker, loadVector=[0.0, 0.0, -share]))
    system.watch(SensorNode, nodeNumber=shaft.nodes[elements // 2])
    items.Assemble()
    system.march(t_end)
    return system.run()


def angle(t: float) -> float:
    """The integral of both steps of the speed."""
    steps = problem.SPEED.signals
    return sum(step.values[1] * step_integral(t, *step.over) for step in steps)


def step_integral(t: float, start: float, end: float) -> float:
    """Of a step by (1 - cos) / 2 from 0 to 1."""
    duration = end - start
    s = float(np.clip((t - start) / duration, 0.0, 1.0))
    rise = duration * (s / 2.0 - np.sin(np.pi * s) / (2.0 * np.pi))
    return float(rise + max(t - end, 0.0))
