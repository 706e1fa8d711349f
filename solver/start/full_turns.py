"""Full turns of the angles that stops and motors act on, at the start."""

from collections.abc import Iterator
from typing import Any

from ..lower.lower import LoweredModel
from ..model.motors import JointMotor
from ..model.stops import JointStop
from ..step.system import State, Workspace


def continue_angles(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let the coordinates of stops and motors have the turns of the joints that they belong to."""
    for row, observer in _observed(lowered, JointStop | JointMotor):
        work.couplings.near[row] = state.observers.value[observer]


def turn_joints(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let joints have the turns of the coordinates that motors act on."""
    for row, observer in _observed(lowered, JointMotor):
        state.observers.value[observer] = work.couplings.coordinate[row]


def _observed(lowered: LoweredModel, kinds: Any) -> Iterator[tuple[int, int]]:
    """The rows of couplings on joint coordinates, with the observers of these."""
    first = lowered.system.couplings.range
    for j, coupling in enumerate(lowered.model.couplings):
        if isinstance(coupling, kinds):
            yield (
                int(first[j]),
                lowered.observers.index((coupling.joint.name, coupling.coordinate)),
            )
