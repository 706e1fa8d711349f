"""Functional mock-up units (FMUs) in a model: controllers, motors, hydraulics of other tools."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

from ...inputs import FORM_OF_NAMES, Shown, is_name, quoted
from ...inputs.errors import did_you_mean
from ...superelement import sha256
from ..couplings.motors import Motor
from ..schema.entry import Entry, FieldSpec, entry, real
from ..schema.paths import FilePath
from ..schema.values import Name, PositiveTime
from ..signals.curves import Input
from .loads import AnyLoad

StartValue = bool | int | float | str
"""the value of a parameter of an FMU"""
RATE_SUFFIX = "_rate"
"""the end of the name of the rate of a joint coordinate"""


def _texts(value: Any) -> dict[str, str]:
    texts = dict(value)
    # Numbers and nested tables would pass as mappings, and fail far from here.
    if not all(isinstance(text, str) and text for pair in texts.items() for text in pair):
        raise TypeError
    return texts


def _starts(value: Any) -> dict[str, StartValue]:
    starts = dict(value)
    for name, start in starts.items():
        if not isinstance(name, str) or not isinstance(start, bool | int | float | str):
            raise TypeError
        # Whole numbers may be enumerations or counts of any size; floats follow the rule of models.
        if isinstance(start, float):
            real(start)
    return starts


_START = Annotated[bool | int | float | str, Shown(dict)]
Texts = Annotated[Mapping[str, str], FieldSpec("a table of names by names", _texts, dict[str, str])]
Starts = Annotated[
    Mapping[str, StartValue],
    FieldSpec("a table of numbers, texts or true and false", _starts, dict[str, Any]),
]


@entry()
class FMU(Entry):
    """A program of another tool that runs beside the model, by FMI 2 or 3 for co-simulation.

    At each communication step, from t to t + H, it gets outputs of the model at t and makes its
    own step. What it gives is the value of inputs of the model at t + H; in between they are
    linear.

    Parameters
    ----------
    name : str
    file : path
        The .fmu, which has a library for this machine.
    inputs : mapping of str
        Outputs of the model by the variables of the FMU that take them, as
        `{"angle": "joints/pivot/angle"}`; `"frames/beam.tip/position[2]"` is one of several
        numbers.
    outputs : mapping of str
        Names of `Input` signals of loads or motors by the variables of the FMU that give them.
    parameters : mapping, optional
        Values of parameters of the FMU, by name.
    step : float, optional [s]
        H, a multiple of the time step. By default that of the FMU, or else the time step.
    coupling : {"explicit", "slope"}
        How forces of the FMU react on the motion within a step: not at all, or by their slope. With
        "slope" Newton's method takes d(output)/d(input) of motors whose joint coordinate, or its
        rate, is an input of the FMU: high gains stay stable.

    Raises
    ------
    ModelError
        Where there is no such file.

    Examples
    --------
    >>> from pathlib import Path
    >>> from duhamel.solver import ModelError
    >>> try:
    ...     FMU("drive", "no.fmu", {"angle": "joints/pivot/angle"}, {"torque": "tau"})
    ... except ModelError as error:
    ...     print(str(error).replace(str(Path.cwd()), "."))
    fmu 'drive': file: ./no.fmu: no such file
    """

    label = "fmu {name!r}"
    group: ClassVar[str] = "fmus"

    name: Name
    file: FilePath
    inputs: Texts = field(default_factory=dict)
    outputs: Texts = field(default_factory=dict)
    parameters: Starts = field(default_factory=dict)
    step: PositiveTime | None = None
    coupling: Literal["explicit", "slope"] = "explicit"
    digest: str = field(init=False, repr=False, compare=False)
    """the SHA-256 of the file"""

    def validate(self) -> None:
        if not Path(self.file).is_file():
            raise self.error(f"file: {self.file}: no such file")
        for name in self.outputs.values():
            # Results name what an FMU gives by it, in paths and files.
            if not is_name(name):
                raise self.error(f"outputs: expected {FORM_OF_NAMES}, got {quoted(name)}")
        # Read at once: the state of a run belongs to the FMU as it was then.
        try:
            object.__setattr__(self, "digest", sha256(self.file))
        except OSError as error:
            raise self.error(f"file: {self.file}: cannot be read: {error.strerror}") from error


class Reaction(NamedTuple):
    """A motor through which an FMU reacts on a joint coordinate that it gets.

    motor: its number; output, angle, rate: variables of the FMU, "" of what it does not get.
    """

    motor: int
    output: str
    angle: str
    rate: str


def reactions(fmu: FMU, motors: Sequence[Motor]) -> Iterator[Reaction]:
    """The motors by which an FMU reacts on coordinates of joints that are inputs of it."""
    variables = {source: variable for variable, source in fmu.inputs.items()}
    for number, motor in enumerate(motors):
        signal = motor.torque or motor.force
        coordinate = f"joints/{motor.joint}/{motor.coordinate}"
        angle, rate = (variables.get(f"{coordinate}{end}", "") for end in ("", RATE_SUFFIX))
        if isinstance(signal, Input) and (angle or rate):
            for output, name in fmu.outputs.items():
                if name == signal.name:
                    yield Reaction(number, output, angle, rate)


def check_fmus(fmus: Sequence[FMU], loads: Sequence[AnyLoad], motors: Sequence[Motor]) -> None:
    """ModelError for what FMUs give and nothing follows, and for what has two givers."""
    signals = [
        *(load.signal for load in loads),
        *(s for motor in motors for s in (motor.torque, motor.force)),
        *(s for motor in motors for s in (motor.reference, motor.reference_rate)),
    ]
    known = dict.fromkeys(signal.name for signal in signals if isinstance(signal, Input))
    givers: dict[str, FMU] = {}
    for fmu in fmus:
        for variable, name in fmu.outputs.items():
            if name not in known:
                listed = ", ".join(map(quoted, known)) or "none"
                raise fmu.error(
                    f"outputs: {variable}: no load or motor follows {{input = {quoted(name)}}}; "
                    f"inputs of the model: {listed}{did_you_mean(name, known)}"
                )
            if name in givers:
                raise fmu.error(
                    f"outputs: {variable}: expected one giver of the input {quoted(name)}, found "
                    f"{givers[name].owner} too"
                )
            givers[name] = fmu
        if fmu.coupling == "slope":
            _check_slope(fmu, motors)


def _check_slope(fmu: FMU, motors: Sequence[Motor]) -> None:
    found = list(reactions(fmu, motors))
    if not found:
        raise fmu.error(
            'coupling: "slope" needs a motor whose torque or force is an output of the FMU, and '
            "whose joint coordinate, or its rate, is an input of it; found none"
        )
    for reaction in found:
        motor = motors[reaction.motor]
        # The slope takes the places of the gains and the reference of the motor.
        if motor.is_servo:
            raise fmu.error(
                f'coupling: "slope" needs a motor with a torque or force alone, found gains of '
                f"{motor.owner}"
            )
