"""Bars in Exudyn that hang one on the other by revolute joints and fall from rest along x."""

from collections.abc import Callable

from exudyn.itemInterface import (
    MarkerBodyRigid,
    ObjectGround,
    ObjectJointRevoluteZ,
    SensorSuperElement,
)

from .reduced_body import Index, ReducedBody, rigid_marker
from .run import Run
from .system import System


def chain(
    bar: ReducedBody,
    held_at: Callable[[float], Index],
    bars: int,
    length: float,
    gravity: list[float],
    end: float,
    step: float,
    tolerance: float,
) -> Run:
    """Joints hold bars at the nodes that `held_at` finds across x; the tip is the end of the last
    bar's axis.
    """
    system = System(step, tolerance, dense=bars == 1)
    ground = system.items.AddObject(ObjectGround())
    support = system.items.AddMarker(MarkerBodyRigid(bodyNumber=ground))
    for number in range(bars):
        body = bar.add(system, [number * length, 0.0, 0.0], gravity)
        root = rigid_marker(system, body, held_at(0.0))
        system.items.AddObject(ObjectJointRevoluteZ(markerNumbers=[support, root]))
        if number < bars - 1:
            support = rigid_marker(system, body, held_at(length))
    system.watch(
        SensorSuperElement, bodyNumber=body, meshNodeNumber=bar.nearest([length, 0.0, 0.0])
    )
    system.items.Assemble()
    system.march(end)
    return system.run()
