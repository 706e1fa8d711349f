"""Two sizes of steps: long ones in flight, short ones where contacts are closed or may close.

At multiples of the long step, while no contact is closed or will be after it at its present rate,
and no load jumps, steps are long. One that ends in a closed contact, or in which Newton's method
fails, is taken back, and short ones take its place, up to the next multiple. Which steps are taken
follows from the state alone, so that a run goes on from any of them to the bit. Source:
docs/theory.md, Two step sizes.
"""

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np

from .arrays import Array, Index
from .checkpoint.carried import Arrays, Snapshot, carried
from .lower.lower import LoweredModel
from .signals.signal import Signal, corners_of, jumps_of
from .step.loop import OTHER_SIZE, advance, is_contact_near
from .step.sizes import change_size
from .step.system import Inputs, Output, Run, State, Workspace

# Calls of Python for fewer steps would cost more than the steps.
MIN_STEPS_AT_ONCE = 16
# between two corners of a load, from which on they may be taken in long steps
CORNER_LONG_STEPS = 8
# of a number of steps: times are decimal numbers, divided by a rounded step
STEP_COUNT_ROUNDING = 1e-9


class Phases:
    """The steps of a run, which are of one or two sizes."""

    def __init__(
        self, lowered: LoweredModel, state: State, work: Workspace, output: Output
    ) -> None:
        self._lowered, self._state, self._work = lowered, state, work
        short = Run(system=lowered.system, state=state, work=work, output=output)
        flight = lowered.flight
        self._runs = [short, short if flight is None else short.replace(system=flight)]
        self._most = [MIN_STEPS_AT_ONCE, MIN_STEPS_AT_ONCE]
        self._refused = -1
        """the step after which a long one was taken back"""
        self._before_flight: Snapshot | None = None
        """what was carried before the steps became long, until one was taken"""
        self._corners = Corners(lowered)

    @cached_property
    def _live(self) -> Arrays:
        """What is carried from step to step; a run with one size of steps never asks for it."""
        return carried(state=self._state, work=self._work)

    def begin(self, n: int) -> tuple[int, int]:
        """The size of the next steps, in short ones, and how many to take before `n` have passed.

        With one size of steps all n.
        """
        if self._lowered.flight is None:
            return 1, n
        stride = self._lowered.ratio
        # Long steps only where a whole number of them fits before what is due.
        steps = min(n // stride, self._steps_of_flight(int(self._state.step[0])))
        in_flight = int(steps > 0)
        if in_flight != self._state.in_flight[0]:
            self._before_flight = Snapshot.of(0, self._live) if in_flight else None
            self._change_size(in_flight)
        if in_flight:
            return stride, min(steps, self._most[1])
        return 1, min(n, self._most[0])

    def advance(self, inputs: Inputs) -> tuple[int, float, bool]:
        """Take steps: how many, the residual of the last, and whether Newton's method failed.

        Fewer than there are inputs where it failed, or where other steps are due.
        """
        if self._lowered.flight is None:
            taken, residual = self._take(0, inputs)
            return taken, residual, taken < len(inputs.load)
        in_flight = int(self._state.in_flight[0])
        # A contact that closes in a long step is found after it: the step must be taken back.
        before = Snapshot.of(0, self._live) if in_flight else None
        taken, residual = self._take(in_flight, inputs)
        failed = taken < len(inputs.load) and residual != OTHER_SIZE
        # Copies of the state and inputs that are not used cost as much as steps: batches grow with
        # success.
        self._most[in_flight] = max(MIN_STEPS_AT_ONCE, 2 * taken)
        if failed and before is not None:
            self._take_back(before, inputs, taken)
            self._refused, failed = int(self._state.step[0]), False
        if taken:
            self._before_flight = None
        return taken, residual, failed

    def _take_back(self, before: Snapshot, inputs: Inputs, taken: int) -> None:
        """The state after the long steps that hold; before all, what it was with short ones."""
        # Where no long step held, the change to long steps is undone too: it alters a.
        (before if taken else self._before_flight or before).put_back(self._live)
        if taken:
            self._take(1, _first(inputs, taken))

    def _steps_of_flight(self, step: int) -> int:
        """Long steps that may follow a step before a load jumps, unless a contact closes first."""
        lowered = self._lowered
        # Long steps lie on multiples of their length, where outputs of runs without contacts have
        # theirs.
        if step % lowered.ratio or step == self._refused:
            return 0
        flight = self._corners.steps_of_flight(step)
        return 0 if flight and self._is_contact_near() else flight

    def _take(self, in_flight: int, inputs: Inputs) -> tuple[int, float]:
        return advance(self._runs[in_flight], inputs)

    def _change_size(self, in_flight: int) -> None:
        old, new = self._runs[1 - in_flight].system, self._runs[in_flight].system
        change_size(old, new, self._state, self._work)

    def _is_contact_near(self) -> bool:
        lowered = self._lowered
        return is_contact_near(lowered.system, lowered.longest_step, self._state, self._work)


class Corners:
    """Corners of loads and motors, about which steps are short."""

    def __init__(self, lowered: LoweredModel) -> None:
        sampled = [*lowered.load_signals, *lowered.motor_signals]
        corners = {time for signal in sampled for time in corners_of(signal)}
        self._ratio, self._n_steps = lowered.ratio, lowered.n_steps
        self.places: Array = np.array(sorted(corners), dtype=np.float64) / lowered.h
        """in short steps"""
        self._pulses = _pulses(sampled, lowered)

    def steps_of_flight(self, step: int) -> int:
        """Long steps that may follow a step, if no contact closes."""
        starts, ends = self._pulses
        if ((starts - 1.0 < step) & (step < ends + 1.0)).any():
            return 0
        # the samples about a jump, means over short steps, are those of short steps alone
        ahead = self.places[self.places > step - 1.0]
        if not len(ahead):
            return self._n_steps
        return int(max((ahead[0] - 1.0 - step) / self._ratio + STEP_COUNT_ROUNDING, 0.0))

    def refused(self) -> Index:
        """1 for each long step that short ones replace, wherever contacts are; 0 for all later."""
        last = min(self.places.max(initial=0.0), float(self._n_steps))
        n = int(last / self._ratio) + 2 if len(self.places) else 0
        return np.array([self.steps_of_flight(k * self._ratio) == 0 for k in range(n)], dtype=int)


def _pulses(sampled: Sequence[Signal], lowered: LoweredModel) -> Array:
    """Between which corners of profiles loads change too fast for long steps (2, n).

    In short steps.
    """
    spans = []
    for signal in sampled:
        corners = sorted(corners_of(signal))
        if len(corners) > len(jumps_of(signal)):
            spans += list(pairwise(corners))
    # A span of few long steps would be sampled too coarsely for its area.
    near = [(a, b) for a, b in spans if b - a < CORNER_LONG_STEPS * lowered.longest_step]
    return np.array(near, dtype=np.float64).reshape(-1, 2).T / lowered.h


def _first(inputs: Inputs, n: int) -> Inputs:
    return Inputs(
        load=inputs.load[:n],
        drive=inputs.drive[:n],
        motor=inputs.motor[:n],
        row=inputs.row[:n],
        ahead=0,
    )
