"""An FMU of a model: what it gets and gives at communication points, and between them."""

from collections import deque
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Index
from ..errors import ModelError
from ..lower.lower import LoweredModel
from ..model.fmus import FMU, reactions
from ..output.chatter import ENOUGH_STEPS, chatters
from ..signals.curves import Input
from ..step.records.laws import Motors
from ..step.system import Inputs, Output
from .description import read_description
from .instance import FMUInstance
from .slope import Slopes, check_slopes

# relative, of a ratio of steps: both are decimal numbers
RATIO_ROUNDING = 1e-9
# At its limits a controller that chatters stays for two exchanges each.
SWING_EXCHANGES = 4


class InputColumn(NamedTuple):
    """What follows an output: a column of `load` or `motor` in the inputs of a step."""

    output: int
    kind: str
    column: int


class Unit:
    """An FMU between its communication points, which are `steps` short steps apart.

    sources: views (1,) of its inputs in a row of output.
    """

    def __init__(self, fmu: FMU, lowered: LoweredModel, sources: list[Array]) -> None:
        self.fmu, self._sources = fmu, sources
        description = read_description(fmu)
        self._h = lowered.h
        self.steps = _communication_steps(fmu, description.step, lowered)
        self._followers = list(_followers(fmu, lowered))
        n_in, n_out = len(fmu.inputs), len(fmu.outputs)
        self._begin, self._end = np.zeros(n_out), np.zeros(n_out)
        """outputs at the last communication point, and at the next"""
        self._raw = np.zeros(n_out)
        """outputs at the last point, without the reaction in the step before"""
        self._seen = np.zeros(n_in)
        """inputs at the last communication point"""
        self._point = np.full(1, -1.0)
        """the step of that point"""
        self._given: deque[Array] = deque(maxlen=2 * ENOUGH_STEPS)
        """its last outputs at communication points"""
        self.instance = FMUInstance(description)
        self._slopes: Slopes | None = None
        try:
            if fmu.coupling == "slope":
                check_slopes(fmu, self.instance)
                found = reactions(fmu, lowered.model.motors)
                self._slopes = Slopes(self.instance, list(found))
        except BaseException:
            self.instance.close()
            raise

    def start(self, step: int) -> Array:
        """Initialize at a step; the outputs (n,) there."""
        self._seen[:] = self._gathered()
        self.instance.start(step * self._h, self._seen)
        self._begin[:] = self._end[:] = self._raw[:] = self.instance.outputs()
        return self._begin.copy()

    def begin_from(self, values: Mapping[str, float]) -> None:
        """Begin at the values of the inputs of the model, where these are not the FMU's."""
        self._begin[:] = [values[name] for name in self.fmu.outputs.values()]
        self._end[:] = self._begin

    def exchange(self, step: int) -> None:
        """Give the FMU the present outputs of the model, and let it step, at its points."""
        # After a restart in the middle of an interval the FMU is ahead already.
        if not self.is_due(step):
            return
        inputs, t, h = self._gathered(), step * self._h, self.steps * self._h
        self._begin[:] = self.values(np.array([step]))[0]
        if self._slopes is None:
            end = self.instance.step(t, h, inputs)
        else:
            # The ramp begins where the reaction has brought the output by now.
            self._begin += self._slopes.reaction(inputs - self._seen)
            end = self._slopes.step(t, h, self._seen, inputs, self._raw)
        self._seen[:], self._end[:], self._raw[:] = inputs, end, end
        self._point[0] = step
        self._given.append(end)

    def is_due(self, step: int) -> bool:
        """Whether this is a communication point that it has not stepped from."""
        return step % self.steps == 0 and step != self._point[0]

    def until_due(self, step: int) -> int:
        """Short steps from a step to the next communication point."""
        return self.steps - step % self.steps

    def values(self, steps: Index) -> Array:
        """What it gives (n, n_outputs) at the ends of steps, but for its reaction."""
        share = (
            (steps - self._point[0]) / self.steps if self._point[0] >= 0 else np.zeros(len(steps))
        )
        return self._begin + np.outer(share, self._end - self._begin)

    def fill(self, inputs: Inputs, rows: slice, steps: Index) -> None:
        """Let what follows the FMU have its values at steps, which are rows of the inputs."""
        values = self.values(steps)
        for output, kind, column in self._followers:
            getattr(inputs, kind)[rows, column] = values[:, output]
        if self._slopes is not None:
            for reaction in self._slopes.reactions:
                for place, name in enumerate((reaction.angle, reaction.rate), start=1):
                    seen = self._seen[list(self.fmu.inputs).index(name)] if name else 0.0
                    inputs.motor[rows, 3 * reaction.motor + place] = seen

    def hide_references(self, output: Output, rows: Index) -> None:
        """Motors that react as the FMU does have no reference of their own."""
        if self._slopes is not None:
            for reaction in self._slopes.reactions:
                output.motor_reference[rows, reaction.motor] = 0.0
                output.motor_error[rows, reaction.motor] = 0.0

    def check_serializes(self, key: str) -> None:
        """ModelError where states are to be written that the FMU cannot write."""
        if not self.instance.description.serializes:
            raise ModelError(
                f"{key}: {self.fmu.owner} cannot serialize its state (canSerializeFMUState): no "
                "run could go on from it"
            )

    def set_gains(self, motors: Motors) -> None:
        """Let motors react as the FMU does."""
        if self._slopes is not None:
            for reaction, (stiffness, damping) in zip(
                self._slopes.reactions, -self._slopes.gains, strict=True
            ):
                motors.stiffness[reaction.motor] = stiffness
                motors.damping[reaction.motor] = damping

    def chattering(self) -> Iterator[str]:
        """A line for each output that went up and down at each exchange until now."""
        advice = 'take coupling = "slope", ' if self._slopes is None else "take "
        for name, values in zip(self.fmu.outputs, np.array(self._given).T, strict=False):
            if len(values) >= ENOUGH_STEPS and chatters(values, SWING_EXCHANGES):
                yield (
                    f"{self.fmu.owner}: {name} chatters: it went up and down every "
                    f"{SWING_EXCHANGES} exchanges or sooner, by {np.ptp(values[-8:]):.3g}, for "
                    f"{len(values)} of them: {advice}smaller gains or a shorter step"
                )

    @property
    def memory(self) -> dict[str, Array]:
        """The arrays that a run carries on, beside the state of the FMU."""
        arrays = [self._begin, self._end, self._raw, self._seen, self._point]
        arrays += self._slopes.memory if self._slopes is not None else []
        return {str(number): array for number, array in enumerate(arrays)}

    def _gathered(self) -> Array:
        return np.array([source[0] for source in self._sources], dtype=np.float64)


def _communication_steps(fmu: FMU, own: float | None, lowered: LoweredModel) -> int:
    """The communication step in short steps, a multiple of the longest; own: that of the FMU."""
    longest, ratio = lowered.longest_step, lowered.ratio
    step = fmu.step or own or longest
    n = round(step / longest)
    # An FMU of shorter steps takes several of them in one of the model.
    if fmu.step is None and 0.0 < step < longest and _is_whole(longest / step):
        n = 1
    elif n < 1 or not _is_whole(step / longest):
        whose = "got" if fmu.step else f"found {step:.9g} s, the step of {fmu.file}: give one, not"
        raise fmu.error(
            f"step: expected a multiple of the time step, {longest:.9g} s, {whose} {step:.9g} s"
        )
    return n * ratio


def _is_whole(ratio: float) -> bool:
    return abs(ratio - round(ratio)) <= RATIO_ROUNDING * ratio


def _followers(fmu: FMU, lowered: LoweredModel) -> Iterator[InputColumn]:
    """The columns of the inputs of a step that follow the outputs of an FMU."""
    outputs = {name: number for number, name in enumerate(fmu.outputs.values())}
    for kind, signals in (("load", lowered.load_signals), ("motor", lowered.motor_signals)):
        for column, signal in enumerate(signals):
            if isinstance(signal, Input) and signal.name in outputs:
                yield InputColumn(outputs[signal.name], kind, column)
