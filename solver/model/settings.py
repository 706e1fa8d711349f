"""Settings of a simulation: how the motion of a mechanism is integrated, and what is recorded."""

from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array
from ..errors import ModelError
from .output_request import OutputRequest
from .vectors import vector


@dataclass(frozen=True, eq=False)
class SteadyRotation:
    """All bodies turn as one: angular_velocity (3,) [rad/s] in space, about the point `center` (3,)
    [m].
    """

    angular_velocity: Array
    center: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        for name in ("angular_velocity", "center"):
            object.__setattr__(self, name, vector(f"steady_rotation: {name}", getattr(self, name)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Settings:
    """From t = 0 to t_end [s], in steps of the same length.

    step [s], rho_inf: by default those of the superelements. rule: of convolution, "consistent" or
    "paper" (eq. 55). history: "auto" (the cheapest), "recursive", "direct" or "fft", which give the
    same motion. kernel_length [s]: impulse responses are faded out and end there (those that modes
    carry do not). tolerance: of Newton's method, relative to the forces and displacements of a
    step. fixed_iterations: the most that Newton's method makes in a step before it goes on as it
    is, for steps of bounded cost; by default it converges within max_iterations or fails.

    start: "given", as the bodies say, or "equilibrium", at rest, or in a `steady_rotation`, under
    gravity and the loads at t = 0, elastic displacements included; places and joint coordinates are
    then where the search begins, and velocities are refused. A steady rotation goes on as it starts
    if gravity and loads that do not follow act along its axis. assemble: close joints however far
    they are open at the start (otherwise by no more than a thousandth of the size of the model).
    redundant: constraints that depend on one another are an "error", or the solver may "remove"
    them. output: what is recorded.
    """

    t_end: float
    step: float | None = None
    rho_inf: float | None = None
    rule: str = "consistent"
    history: str = "auto"
    kernel_length: float | None = None
    tolerance: float = 1e-10
    max_iterations: int = 20
    fixed_iterations: int | None = None
    start: str = "given"
    steady_rotation: SteadyRotation | None = None
    assemble: bool = False
    redundant: str = "error"
    output: OutputRequest = field(default_factory=OutputRequest)

    def __post_init__(self) -> None:
        if not 0.0 < self.t_end < np.inf:
            raise ModelError(f"t_end: expected a positive time, got {self.t_end}")
        for name in ("step", "kernel_length"):
            time = getattr(self, name)
            if time is not None and not 0.0 < time < np.inf:
                raise ModelError(f"{name}: expected a positive time, got {time}")
        if self.rho_inf is not None and not 0.0 <= self.rho_inf <= 1.0:
            raise ModelError(f"rho_inf: expected a number from 0 to 1, got {self.rho_inf}")
        if self.rule not in ("consistent", "paper"):
            raise ModelError(f"rule: expected 'consistent' or 'paper', got {self.rule!r}")
        if self.history not in ("auto", "recursive", "direct", "fft"):
            raise ModelError(
                f"history: expected 'auto', 'recursive', 'direct' or 'fft', got {self.history!r}"
            )
        if not 0.0 < self.tolerance < 1.0:
            raise ModelError(f"tolerance: expected a number between 0 and 1, got {self.tolerance}")
        for name in ("max_iterations", "fixed_iterations"):
            count = getattr(self, name)
            if count is not None and count < 1:
                raise ModelError(f"{name}: expected 1 or more, got {count}")
        if self.start not in ("given", "equilibrium"):
            raise ModelError(f"start: expected 'given' or 'equilibrium', got {self.start!r}")
        if self.steady_rotation is not None and self.start != "equilibrium":
            raise ModelError("steady_rotation: needs start = 'equilibrium'")
        if self.redundant not in ("error", "remove"):
            raise ModelError(f"redundant: expected 'error' or 'remove', got {self.redundant!r}")
