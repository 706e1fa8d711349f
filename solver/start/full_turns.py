"""Full turns of the angles that stops and motors act on, at the start."""

from collections.abc import Iterator
from typing import Any

from ..couplings.couplers import JointCoupler
from ..couplings.motors import JointMotor
from ..couplings.stops import JointStop
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace


def continue_angles(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let the coordinates of stops and motors have the turns of the joints that they belong to."""
    for row, observer in _observed(lowered, JointStop | JointMotor):
        work.couplings.near[row] = state.observers.value[observer]
    _continue_couplers(lowered, state, work)


def _continue_couplers(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let couplers have the turns of their joints."""
    for row, terms, first, others, shift in _coupled(lowered):
        work.couplings.near[row] = state.observers.value[first] - shift
        work.terms.near[terms] = state.observers.value[others]


def _turn_coupled(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let the joints of couplers have their turns."""
    for row, terms, first, others, shift in _coupled(lowered):
        state.observers.value[first] = work.couplings.coordinate[row] + shift
        state.observers.value[others] = work.terms.coordinate[terms]


def _coupled(lowered: LoweredModel) -> Iterator[tuple[int, slice, int, list[int], float]]:
    """Rows of couplers, their terms, the observers of both, and of the first how far the zero of
    the sum is from its own.
    """
    couplings, observers = lowered.system.couplings, lowered.system.observers
    for j, coupling in enumerate(lowered.model.couplings):
        if isinstance(coupling, JointCoupler):
            row = int(couplings.range[j])
            names = zip(coupling.joints, coupling.coordinates, strict=True)
            first, *others = (lowered.observers.index((joint.name, name)) for joint, name in names)
            shift = float(couplings.rows.zero[row] - observers.zero[first])
            terms = slice(int(couplings.terms.range[row]), int(couplings.terms.range[row + 1]))
            yield row, terms, first, others, shift


def turn_joints(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let joints have the turns of the coordinates that motors act on."""
    for row, observer in _observed(lowered, JointMotor):
        state.observers.value[observer] = work.couplings.coordinate[row]
    _turn_coupled(lowered, state, work)


def _observed(lowered: LoweredModel, kinds: Any) -> Iterator[tuple[int, int]]:
    """The rows of couplings on joint coordinates, with the observers of these."""
    first = lowered.system.couplings.range
    for j, coupling in enumerate(lowered.model.couplings):
        if isinstance(coupling, kinds):
            yield (
                int(first[j]),
                lowered.observers.index((coupling.joint.name, coupling.coordinate)),
            )
