"""Full turns of the joint coordinates that stops, motors and couplers act on, at the start."""

from collections.abc import Iterator
from dataclasses import dataclass

from ..couplings.coupling import Coupling
from ..lower.lower import LoweredModel
from ..step.system import State, Workspace


@dataclass(frozen=True)
class _Observed:
    """A row that is a coordinate of a joint, or a sum of several, with their observers."""

    coupling: Coupling
    row: int
    first: int
    """the observer of the row's own coordinate"""
    terms: slice
    others: list[int]
    """the observers of its terms"""
    shift: float
    """how far the zero of the sum is from that of the first coordinate"""


def continue_angles(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let what acts on joint coordinates have the turns of the joints."""
    for seen in _observed(lowered):
        work.couplings.near[seen.row] = state.observers.value[seen.first] - seen.shift
        work.terms.near[seen.terms] = state.observers.value[seen.others]


def turn_joints(lowered: LoweredModel, state: State, work: Workspace) -> None:
    """Let joints have the turns of the coordinates that keep theirs."""
    for seen in _observed(lowered):
        if seen.coupling.keeps_turns:
            state.observers.value[seen.first] = work.couplings.coordinate[seen.row] + seen.shift
            state.observers.value[seen.others] = work.terms.coordinate[seen.terms]


def _observed(lowered: LoweredModel) -> Iterator[_Observed]:
    couplings, observers = lowered.system.couplings, lowered.system.observers
    for j, coupling in enumerate(lowered.model.couplings):
        if coupling.joint_coordinates:
            row = int(couplings.range[j])
            first, *others = map(lowered.observers.index, coupling.joint_coordinates)
            shift = float(couplings.rows.zero[row] - observers.zero[first])
            terms = slice(int(couplings.terms.range[row]), int(couplings.terms.range[row + 1]))
            yield _Observed(coupling, row, first, terms, others, shift)
