"""`linearize`: a model as linear equations about an equilibrium, at rest or in steady rotation."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..errors import ModelError, about
from ..model.model import Model
from ..model.settings import SteadyRotation
from .equations import Equations, equations_of
from .frf import FrequencyResponse, frequency_response, static_response
from .inputs import Channel, channels, with_loads
from .modes import FirstOrder, Modes, modes_of
from .pose import pose_of
from .state_space import StateSpace, state_space_of


@dataclass(frozen=True, eq=False)
class LinearModel:
    """The linear equations of a model about an equilibrium.

    All results are amplitudes of small motions about it. In steady rotation they are those that an
    observer sees who turns with the mechanism: so are frequencies, and components of vectors.
    """

    model: Model
    rotation: SteadyRotation | None = None

    @cached_property
    def equations(self) -> Equations:
        with about(self.model.path):
            return equations_of(pose_of(self.model, self.rotation))

    @cached_property
    def first_order(self) -> FirstOrder:
        with about(self.model.path):
            return FirstOrder(self.equations)

    @property
    def spin(self) -> float:
        """The speed of the steady rotation [rad/s]."""
        return self.equations.pose.speed

    def modes(self, n: int | None = None) -> Modes:
        """The first n modes by frequency, or all.

        ModelError for a body that is known by a kernel alone.
        """
        with about(self.model.path):
            return modes_of(self.first_order, n)

    def frf(
        self, inputs: Sequence[str], outputs: Sequence[str], frequencies: Array
    ) -> FrequencyResponse:
        """Frequency responses of outputs, as `plot` names them, to inputs.

        frequencies (n,) [Hz]. inputs: "load:1", "force:FRAME:x", "torque:FRAME:x", "drive:JOINT",
        or the name of an `Input`. ModelError for an input, QuantityError for an output that there
        is not, and ModelError for a frequency without damping at which the model resonates.
        """
        with about(self.model.path):
            equations, found = self._with(inputs)
            return frequency_response(equations, found, outputs, np.asarray(frequencies))

    def static(self, inputs: Sequence[str], outputs: Sequence[str]) -> FrequencyResponse:
        """Static influence coefficients: responses at 0 Hz, real.

        ModelError where a motion that nothing resists makes them infinite.
        """
        with about(self.model.path):
            equations, found = self._with(inputs)
            return static_response(equations, found, outputs)

    def state_space(
        self, inputs: Sequence[str], outputs: Sequence[str], modes: int | None = None
    ) -> StateSpace:
        """x' = A x + B f, y = C x + D f in real modal coordinates, with all modes or the first.

        Modes that are left out count with their static response.
        """
        with about(self.model.path):
            equations, found = self._with(inputs)
            return state_space_of(FirstOrder(equations), found, outputs, modes)

    def _with(self, inputs: Sequence[str]) -> tuple[Equations, list[Channel]]:
        """The equations, with frames for the unit loads among the inputs."""
        model = with_loads(self.model, inputs)
        if len(model.loads) == len(self.model.loads):
            equations = self.equations
        else:
            equations = equations_of(pose_of(model, self.rotation))
        return equations, channels(self.model, equations.pose.lowered, inputs)


def linearize(model: Model, rotation: SteadyRotation | None = None) -> LinearModel:
    """The linear equations of a model about the equilibrium nearest to its start.

    Under gravity and the loads at t = 0, at rest, or in the steady rotation of its settings, or in
    `rotation`. Velocities of the start count for nothing. `ModelError` where there is no such
    equilibrium, and for friction that acts, for laws with a memory other than Maxwell's, and for a
    steady rotation in which the equations are not constant.
    """
    linear = LinearModel(model, rotation)
    if not isinstance(model, Model):
        raise ModelError(f"linearize: expected a Model, got {model!r}")
    _ = linear.equations
    return linear
