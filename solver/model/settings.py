"""Settings of a simulation: time integration, start and record."""

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Annotated, Any, Literal

from ...inputs import Shown
from ..schema.entry import Entry, FieldSpec, NameInFile, entry
from ..schema.forms import Family
from ..schema.tables import member
from ..schema.values import (
    ZERO_VECTOR,
    Count,
    Fraction,
    Iterations,
    NumbersByName,
    PositiveTime,
    Tolerance,
    Vector,
)
from .output_request import OutputRequest


@entry()
class SteadyRotation(Entry):
    """A rotation of bodies about one axis: all as one, unless bearings part them.

    The bodies that carry the supports of bearings stand, see docs/how-to/rotors.md.

    Parameters
    ----------
    angular_velocity : (3,) [rad/s]
    center : (3,) [m]
        A point of the axis; both in space.
    speed_ratios : mapping of float, optional
        The angular velocity of bodies over `angular_velocity`, by name: 0 for one that stands, -1.2
        for a shaft that turns the other way round. A body takes that of the bodies that it is
        coupled to, by anything but bearings.

    Examples
    --------
    >>> SteadyRotation((0.0, 0.0, 50.0)).center.tolist()
    [0.0, 0.0, 0.0]
    """

    label = "steady_rotation"

    angular_velocity: Vector
    center: Vector = ZERO_VECTOR
    speed_ratios: NumbersByName = field(default_factory=dict)


@entry(eq=True)
class StartFrom(Entry):
    """The state at the end of another run.

    Parameters
    ----------
    path : path
        Its results file.

    Examples
    --------
    >>> StartFrom("spinup.h5").path.endswith("spinup.h5")
    True
    """

    label = "start"

    path: Annotated[str, NameInFile("from")]

    def beside(self, folder: Path) -> "StartFrom":
        """This start with its path relative to a folder."""
        return StartFrom(str(folder / self.path))


NAMED_STARTS = ("given", "equilibrium")


def _start(value: Any) -> "str | StartFrom":
    if isinstance(value, Mapping) and value.keys() == {"from"} and isinstance(value["from"], str):
        return StartFrom(value["from"])
    if isinstance(value, StartFrom) or value in NAMED_STARTS:
        return value  # type: ignore[no-any-return]
    raise ValueError


def _start_in_file(value: "str | StartFrom") -> Any:
    return {"from": value.path} if isinstance(value, StartFrom) else value


def _start_schema() -> dict[str, Any]:
    run = {"type": "object", "properties": {"from": {"type": "string"}}, "required": ["from"]}
    return {"anyOf": [{"enum": list(NAMED_STARTS)}, run | {"additionalProperties": False}]}


AnyStart = Annotated[
    str | StartFrom,
    FieldSpec(
        "'given', 'equilibrium' or {'from': FILE}",
        _start,
        Annotated[Any, Shown(_start_schema)],
        _start_in_file,
    ),
]
INTERVAL_FORMS = Family("interval")


@INTERVAL_FORMS.bare_number
@entry(eq=True)
class Seconds(Entry):
    """An interval of wall time in seconds."""

    seconds: PositiveTime


@INTERVAL_FORMS.in_files("every")
@entry(eq=True)
class EverySteps(Entry):
    """An interval of a number of time steps."""

    every: Count


Interval = Annotated[
    Seconds | EverySteps,
    INTERVAL_FORMS,
    member(INTERVAL_FORMS, "seconds or {'every': steps}", Seconds | EverySteps),
]


@entry(kw_only=True)
class Settings(Entry):
    """The settings of a simulation in equal steps from t = 0.

    Parameters
    ----------
    t_end : float [s]
    step : float, optional [s]
        By default that of the superelements, as rho_inf.
    contact_step : float, optional [s]
        A whole fraction of `step`: steps of this size are taken from where a contact or stop may
        close in the next step until all are open. Flexible bodies need modes then: their history is
        recursive.
    rho_inf : float, optional
        The spectral radius at infinite frequency, at most 0.99 in a model with joints or motions.
    rule : {"consistent", "paper"}
        Of convolution; that of the paper is eq. (55).
    history : {"auto", "recursive", "direct", "fft"}
        How displacements by past loads are computed; "auto" is the cheapest. All give the same
        motion.
    kernel_length : float, optional [s]
        Impulse responses are faded out and end there (those that modes carry do not).
    tolerance : float
        Of Newton's method, relative to the forces and displacements of a step.
    max_iterations : int
        A step that has not converged by then is an error.
    fixed_iterations : int, optional
        A step ends after so many iterations without an error, for steps of bounded cost.
    start : {"given", "equilibrium"} or StartFrom
        As the bodies say; or at rest, or in a steady rotation, under gravity and the loads at t =
        0, elastic displacements included: positions and joint coordinates are then the first guess,
        and velocities are refused. From another run, bodies of the same name continue with their
        motion, vibration and past, and so does time.
    steady_rotation : SteadyRotation, optional
        Of an equilibrium. It continues as it starts if gravity, and loads that do not follow, act
        along its axis.
    assemble : bool
        Close joints however far they are open at the start, otherwise by no more than a thousandth
        of the size of the model.
    redundant : {"error", "remove"}
        What happens to constraints that depend on one another.
    checkpoint : float [s] or {"every": int}, optional
        How often the state is kept beside the results file, so that the run can continue from it:
        in wall time, or in steps.
    output : OutputRequest
        What is recorded.

    Examples
    --------
    >>> Settings(t_end=2.0, step=1e-3).tolerance
    1e-10
    """

    t_end: PositiveTime
    step: PositiveTime | None = None
    contact_step: PositiveTime | None = None
    rho_inf: Fraction | None = None
    rule: Literal["consistent", "paper"] = "consistent"
    history: Literal["auto", "recursive", "direct", "fft"] = "auto"
    kernel_length: Annotated[PositiveTime | None, NameInFile("memory")] = None
    tolerance: Tolerance = 1e-10
    max_iterations: Iterations = 20
    fixed_iterations: Annotated[Iterations | None, NameInFile("corrections")] = None
    start: AnyStart = "given"
    steady_rotation: SteadyRotation | None = None
    assemble: bool = False
    redundant: Literal["error", "remove"] = "error"
    checkpoint: Interval | None = None
    output: OutputRequest = field(default_factory=OutputRequest)

    def validate(self) -> None:
        if self.steady_rotation is not None and self.start != "equilibrium":
            raise self.error("steady_rotation: needs start = 'equilibrium'")
        if self.contact_step is not None and self.history not in ("auto", "recursive"):
            raise self.error(
                "contact_step: needs recursive history, as only modes serve two sizes of steps; "
                f"got history = {self.history!r}"
            )
