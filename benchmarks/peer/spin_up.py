"""The spin-up of Simo and Vu-Quoc in Exudyn: a beam whose root section is turned, by geometrically
exact beams.
"""

from itertools import pairwise
from typing import Any

import numpy as np
from exudyn.itemInterface import (
    CoordinateConstraint,
    MarkerNodeCoordinate,
    NodePointGround,
    NodeRigidBody2D,
    ObjectBeamGeometricallyExact2D,
    SensorNode,
)

from tests.validation.test_spin_up import SECTION, SPIN_UP, L

from .run import Run
from .system import System

DENSITIES = {
    "massPerLength": SECTION["mass_per_length"],
    "crossSectionInertia": SECTION["rotary_inertia_z"],
    "bendingStiffness": SECTION["EI_z"],
    "axialStiffness": SECTION["EA"],
    "shearStiffness": SECTION["GA_y"],
}


def exact_beams(elements: int, step: float, t_end: float, tolerance: float) -> Run:
    """In the plane, of two nodes each; `SPIN_UP` turns the first node."""
    system = System(step, tolerance)
    items = system.items
    nodes = [
        items.AddNode(NodeRigidBody2D(referenceCoordinates=[x, 0.0, 0.0]))
        for x in np.linspace(0.0, L, elements + 1).tolist()
    ]
    for ends in pairwise(nodes):
        items.AddObject(
            ObjectBeamGeometricallyExact2D(nodeNumbers=list(ends), length=L / elements, **DENSITIES)
        )
    still = items.AddMarker(
        MarkerNodeCoordinate(nodeNumber=items.AddNode(NodePointGround()), coordinate=0)
    )
    for coordinate in range(3):
        held = items.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
        follow: dict[str, Any] = {"offsetUserFunction": _angle} if coordinate == 2 else {}
        items.AddObject(CoordinateConstraint(markerNumbers=[still, held], **follow))
    system.watch(SensorNode, nodeNumber=nodes[-1])
    items.Assemble()
    system.march(t_end)
    return system.run()


def _angle(_system: Any, t: float, _item: int, _offset: float) -> float:
    return SPIN_UP(t)
