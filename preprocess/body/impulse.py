"""The impulse responses that a body file asks for."""

from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, PositiveInt

from ...inputs import Table, rule

Method = Literal["auto", "modal", "march", "krylov", "craig-bampton", "rubin"]
SolverName = Literal["auto", "factor", "iterative"]
# Of as many modes as are asked for.
TRUNCATED_METHODS: tuple[Method, ...] = ("craig-bampton", "rubin")
SHORTEST, LONGEST_STEP = 1e-30, 1e6
"""steps [s]"""
DEFAULT_STEPS = 100
"""of responses that modes continue for any duration"""


class Impulse(Table):
    """The impulse responses to compute: `steps` steps of `step` seconds with the scheme of rho_inf.

    method: "modal" from all elastic modes, "krylov" from as many as it takes, "march" by stepping
    the full model, "auto" the one of the first two that fits the size. tolerance: the relative
    error of the transfer function up to `band` [Hz], half the Nyquist frequency unless given, that
    "krylov" may make; "modal" and "march" make none. "craig-bampton" and "rubin" take `modes`, the
    number of them, and the error follows from it. solver: "krylov" solves with the matrices of time
    steps by a "factor", by conjugate gradients ("iterative"), or by what takes less time ("auto").
    """

    step: PositiveFloat
    steps: PositiveInt = DEFAULT_STEPS
    rho_inf: Annotated[float, Field(ge=0.0, le=1.0)] = 0.9
    method: Method = "auto"
    tolerance: PositiveFloat = 1e-6
    band: PositiveFloat | None = None
    modes: PositiveInt | None = None
    solver: SolverName = "auto"

    @rule
    def _of_this_world(self) -> None:
        if not SHORTEST <= self.step <= LONGEST_STEP:
            raise ValueError(
                f"step: expected {SHORTEST:g} to {LONGEST_STEP:g} s, found {self.step:g}"
            )
        if self.band is not None and self.band < 1.0 / LONGEST_STEP:
            raise ValueError(
                f"band: expected at least {1.0 / LONGEST_STEP:g} Hz, found {self.band:g}"
            )

    @rule
    def _steps_of_marched(self) -> None:
        if self.method == "march" and "steps" not in self.model_fields_set:
            raise ValueError(
                "steps: needed with method march, whose responses end there; in Python the duration"
            )

    @rule
    def _below_nyquist(self) -> None:
        if self.band is not None and self.band > 0.5 / self.step:
            raise ValueError(
                "band: expected at most the Nyquist frequency of the step, "
                f"{0.5 / self.step:g} Hz, found {self.band:g}"
            )

    @rule
    def _solver_of_its_method(self) -> None:
        if "solver" in self.model_fields_set and self.method not in ("auto", "krylov"):
            raise ValueError(
                f"solver: expected only with method krylov, found it with {self.method}"
            )

    @rule
    def _modes_of_their_methods(self) -> None:
        if self.method not in TRUNCATED_METHODS:
            if self.modes is not None:
                raise ValueError(
                    f"modes: expected only with method {' or '.join(TRUNCATED_METHODS)}, "
                    f"found it with {self.method}"
                )
            return
        if self.modes is None:
            raise ValueError(f"modes: method {self.method} needs a number of modes, found none")
        if others := sorted(self.model_fields_set & {"band", "tolerance"}):
            raise ValueError(
                f"{' and '.join(others)}: expected only with other methods: with {self.method} "
                "the band and its error follow from modes"
            )
