"""The thin beam that buckles sideways in Exudyn: geometrically exact beams on a crank."""

import numpy as np
from exudyn.itemInterface import (
    MarkerBodyRigid,
    ObjectGround,
    ObjectJointGeneric,
    ObjectRigidBody,
    SensorNode,
)
from scipy.spatial.transform import Rotation

from examples.benchmarks import lateral_buckling as problem

from .published import add_beam, beam_section, clamp_to_drive, revolute
from .run import Run
from .system import System

TOLERANCE = 1e-9
"""of Newton's increments"""


def lateral_buckling(elements: int, step: float, t_end: float) -> Run:
    """The tip is the middle of the beam, which has this even number of elements."""
    system = System(step, TOLERANCE)
    items, along = system.items, Rotation.identity()
    top = np.array([problem.L, problem.OFFSET, 0.0])
    bottom = top - [0.0, 0.0, problem.LINK]
    pivot = bottom - [problem.CRANK, 0.0, 0.0]
    downwards = Rotation.from_rotvec([0.0, np.pi / 2, 0.0])
    ends = (np.zeros(3), np.array([problem.L, 0.0, 0.0]))
    beam = add_beam(items, ends, along, section(problem.BEAM_SECTION), elements)
    link = add_beam(items, (top, bottom), downwards, section(problem.LINK_SECTION), elements // 4)
    crank = add_beam(items, (pivot, bottom), along, section(problem.CRANK_SECTION), 4)
    ground = items.AddMarker(MarkerBodyRigid(bodyNumber=items.AddObject(ObjectGround())))
    items.AddObject(ObjectJointGeneric(markerNumbers=[ground, beam.start], constrainedAxes=[1] * 6))
    lug = items.AddObject(
        ObjectRigidBody(mass=1e-3, inertia=[1e-6] * 3 + [0.0] * 3, nodeNumber=beam.nodes[-1])
    )
    ball = items.AddMarker(
        MarkerBodyRigid(bodyNumber=lug, localPosition=[0.0, problem.OFFSET, 0.0])
    )
    items.AddObject(
        ObjectJointGeneric(markerNumbers=[ball, link.start], constrainedAxes=[1, 1, 1, 0, 0, 0])
    )
    across = Rotation.align_vectors([[0.0, 1.0, 0.0]], [[0.0, 0.0, 1.0]])[0]
    revolute(items, (link.end, downwards), (crank.end, along), across)
    clamp_to_drive(items, pivot, across, (crank.start, along), angle)
    system.watch(SensorNode, nodeNumber=beam.nodes[elements // 2])
    items.Assemble()
    system.march(t_end)
    return system.run()


def section(of: tuple[float, ...]) -> object:
    *stiffnesses, mass, inertia_y, inertia_z = of
    return beam_section(stiffnesses, mass, [inertia_y + inertia_z, inertia_y, inertia_z])


def angle(t: float) -> float:
    share = (1.0 - np.cos(np.pi * min(t / problem.DURATION, 1.0))) / 2.0
    return float(problem.TURN * share)
