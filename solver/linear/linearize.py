"""`linearize`: a model as linear equations about an equilibrium, at rest or in steady rotation."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from ...files.blas import one_blas_thread
from ..errors import ModelError, ValidityWarning, about
from ..model.model import Model
from ..model.settings import SteadyRotation
from .equations import Bodies, Equations, equations_of
from .flexibility import KernelBody
from .frf import FrequencyResponse, frequency_response, static_response
from .inputs import Channel, channels, with_loads
from .modes import MAX_DENSE_STATES, FirstOrder, LinearModes, modes_of, with_chains
from .motion import Motion, motion_of
from .pose import pose_of
from .shapes import Shape, shapes_of
from .state_space import StateSpace, state_space_of
from .steady import check_constant
from .validity import LinearValidity, validity_of

# of a model that has too many for all
MAX_MODES_FOUND = 60


@dataclass(frozen=True, eq=False)
class LinearModel:
    """The linear equations of a model about an equilibrium, made by `linearize`.

    All results are amplitudes of small motions about it. In steady rotation they are those that an
    observer sees who turns with the mechanism: so are frequencies, and components of vectors.
    See `linearize` for an example.

    Parameters
    ----------
    model : Model
    rotation : SteadyRotation, optional
    """

    in_space: ClassVar[bool] = False
    """amplitudes are those that an observer sees who does not turn"""

    model: Model
    rotation: SteadyRotation | None = None

    @cached_property
    def equations(self) -> Equations:
        with one_blas_thread():
            equations = equations_of(pose_of(self.model, self.rotation))
            check_constant(equations)
        return equations

    @cached_property
    def first_order(self) -> FirstOrder:
        return FirstOrder(self.equations.relaxed)

    @property
    def spin(self) -> float:
        """The speed of the steady rotation [rad/s]."""
        return self.equations.pose.speed

    def modes(self, n: int | None = None) -> LinearModes:
        """The first n modes by frequency, or all.

        ModelError for a body that is known by a kernel alone.
        """
        with about(self.model.path), one_blas_thread():
            found = modes_of(self.first_order, n)
            if self.equations.is_chained:
                found = with_chains(self.equations, found)
            return found

    def known_modes(self) -> LinearModes | None:
        """The first modes; None where a body is known by a kernel alone."""
        if any(isinstance(body, KernelBody) for body in self.equations.bodies):
            return None
        return self.modes(None if self.first_order.n <= MAX_DENSE_STATES else MAX_MODES_FOUND)

    def validity(self, modes: LinearModes | None = None, frequencies: Any = ()) -> LinearValidity:
        """How far this analysis can be trusted: `print(linear.validity())` shows a table.

        modes: as found, frequencies [Hz]: of responses, which should be within the band of the
        superelements.
        """
        highest = float(np.max(frequencies, initial=0.0))
        with one_blas_thread():
            form = None if modes is None else self.first_order
            return validity_of(form, self.equations.pose, modes, highest)

    def motion(self, y: Any) -> Motion:
        """Motions of bodies and frames in motions y (n_y, k), as `LinearModes.y`."""
        return motion_of(self.first_order, y)

    def shapes(self, y: Any) -> list[Shape]:
        """The bodies as lines in one motion y (n_y,), a column of `LinearModes.y`."""
        return shapes_of(self.first_order, y)

    def frf(
        self,
        inputs: Sequence[str],
        outputs: Sequence[str],
        frequencies: Any,
        bodies: Bodies = "dynamic",
    ) -> FrequencyResponse:
        """Frequency responses of outputs, as `plot` names them, to inputs.

        frequencies (n,) [Hz]. inputs: "load:1", "force:FRAME:x", "torque:FRAME:x", "drive:JOINT",
        or the name of an `Input`. bodies: "dynamic", with all their modes, "static", as springs
        without inertia of their own deformation, or "rigid". ModelError for an input, QuantityError
        for an output that there is not, and ModelError for a frequency without damping at which the
        model resonates.
        """
        with about(self.model.path), one_blas_thread():
            equations, found = self._with(inputs)
            equations = equations.with_bodies(bodies)
            return frequency_response(equations, found, outputs, np.asarray(frequencies, float))

    def static(self, inputs: Sequence[str], outputs: Sequence[str]) -> FrequencyResponse:
        """Static influence coefficients: responses at 0 Hz, real.

        ModelError where a motion that nothing resists makes them infinite.
        """
        with about(self.model.path), one_blas_thread():
            equations, found = self._with(inputs)
            return static_response(equations, found, outputs)

    def state_space(
        self, inputs: Sequence[str], outputs: Sequence[str], modes: int | None = None
    ) -> StateSpace:
        """x' = A x + B f, y = C x + D f in real modal coordinates, with all modes or the first.

        Modes that are left out count with their static response.
        """
        with about(self.model.path), one_blas_thread():
            equations, found = self._with(inputs)
            return state_space_of(FirstOrder(equations), found, outputs, modes)

    def _with(self, inputs: Sequence[str]) -> tuple[Equations, list[Channel]]:
        """The equations, with frames for the unit loads among the inputs."""
        model = with_loads(self.model, inputs)
        # Without unit loads the equations of the model are those that are known already.
        if len(model.loads) == len(self.model.loads):
            equations = self.equations
        else:
            equations = equations_of(pose_of(model, self.rotation))
        return equations, channels(self.model, equations.pose.lowered, inputs)


def linearize(model: Model, rotation: SteadyRotation | None = None) -> LinearModel:
    """The linear equations of a model about the equilibrium nearest to its start.

    The equilibrium is at rest, in the steady rotation of the settings, or in `rotation`, under
    gravity, and under the loads at t = 0 if the model starts in equilibrium. In a model that starts
    as given, loads and velocities do not count: they begin at t = 0. Contacts of surfaces are open.

    Parameters
    ----------
    model : Model
    rotation : SteadyRotation, optional
        Drives that turn the mechanism follow it.

    Returns
    -------
    LinearModel

    Raises
    ------
    ModelError
        Where there is no such equilibrium; for friction that acts; for laws with a kink there, or
        with a memory other than Maxwell's; and for a steady rotation in which the equations are not
        constant.

    Examples
    --------
    2 kg on a spring of 8 pi^2 N/m:

    >>> import numpy as np
    >>> from duhamel.solver import Frame, Model, Prismatic, RigidBody, Settings, Spring
    >>> coil = Spring("coil", "point", ["ground.wall", "box"], stiffness=8.0 * np.pi**2)
    >>> linear = linearize(Model(
    ...     {"box": RigidBody(2.0, [0.1, 0.1, 0.1])}, springs=[coil],
    ...     joints=[Prismatic("ground", "box", axis=[1.0, 0.0, 0.0])],
    ...     ground_frames={"wall": Frame((-1.0, 0.0, 0.0))},
    ...     settings=Settings(t_end=1.0, step=0.01),
    ... ))
    >>> linear.modes().frequencies.round(6).tolist()
    [1.0]
    >>> response = linear.frf(["force:box:x"], ["position:box:x"], [0.5])
    >>> response.outputs, response.units, response.input_units
    (('position:box:x',), ('m',), ('N',))
    >>> linear.state_space(["force:box:x"], ["position:box:x"]).A.shape
    (2, 2)
    """
    if not isinstance(model, Model):
        raise ModelError(f"linearize: expected a Model, got {model!r}")
    linear = LinearModel(model.without_surfaces(), rotation)
    left_out = ", ".join(contact.owner for contact in model.surface_contacts)
    if left_out:
        # What closes and opens has no linear equations; that it is missing must not go unsaid.
        warnings.warn(
            f"{left_out}: contacts of surfaces are open in linear analyses",
            ValidityWarning,
            stacklevel=2,
        )
    if model.fmus:
        warnings.warn(
            f"{', '.join(fmu.owner for fmu in model.fmus)}: linear analyses leave FMUs out; what "
            "they give are inputs",
            ValidityWarning,
            stacklevel=2,
        )
    with about(model.path):
        # Evaluated now, so that a model that cannot be linearized fails here and not later.
        _ = linear.equations
    return linear
