"""The model file: what a user writes to run a simulation, and how it becomes a `Model`."""

import difflib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat, PositiveInt, model_validator

from ...inputs import InputError, Table, Vector, expected, read_part, read_table
from ...superelement import Superelement, read
from ..arrays import Array
from ..errors import ModelError, about
from .joints import Joint
from .model import Body, FlexibleBody, Frame, Load, Model, Place, RigidBody, Start
from .motions import PrescribedDisplacement, PrescribedMotion, PrescribedRotation
from .output_request import OutputRequest
from .settings import Settings, SteadyRotation
from .signals import Constant, Harmonic, Impulse, Input, Polynomial, Pulse, Signal, Spline, Steps
from .signals import Table as Points
from .springs import Law, Spring

Between = Annotated[tuple[str, str], expected("the names of two frames")]
Inertia = Annotated[
    Vector | tuple[Vector, Vector, Vector], expected("three numbers or a 3x3 matrix")
]
Coefficients = Annotated[
    float | tuple[float, ...] | tuple[tuple[float, ...], ...],
    expected("a number, six numbers or a 6x6 matrix"),
]


class _Points(Table):
    times: tuple[float, ...]
    values: tuple[float, ...]
    linear: bool = False
    spline: bool = False

    def signal(self) -> Signal:
        if self.linear and self.spline:
            raise ValueError("expected linear or spline, found both")
        kind = Spline if self.spline else Points if self.linear else Steps
        return kind(self.times, self.values)


class _Harmonic(Table):
    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0

    def signal(self) -> Signal:
        return Harmonic(self.amplitude, self.frequency, self.phase, self.offset)


class _Polynomial(Table):
    polynomial: Annotated[tuple[float, ...], Field(min_length=1)]

    def signal(self) -> Signal:
        return Polynomial(self.polynomial)


class _Impulse(Table):
    impulse: float
    at: NonNegativeFloat

    def signal(self) -> Signal:
        return Impulse(self.impulse, self.at)


class _Pulse(Table):
    pulse: float
    start: float = Field(alias="from")
    end: float = Field(alias="to")

    def signal(self) -> Signal:
        return Pulse(self.pulse, self.start, self.end)


class _Input(Table):
    input: str
    value: float = 0.0

    def signal(self) -> Signal:
        return Input(self.input, self.value)


_SIGNALS: dict[str, Any] = {
    "times": _Points,
    "amplitude": _Harmonic,
    "polynomial": _Polynomial,
    "impulse": _Impulse,
    "pulse": _Pulse,
    "input": _Input,
}
"""signals by the key that tells them apart"""


def _signal(value: Any) -> Signal:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return Constant(float(value))
    meant = ""
    if isinstance(value, Mapping):
        for key, kind in _SIGNALS.items():
            if key in value:
                signal: Signal = read_part(value, kind).signal()
                return signal
        nearest = [near for key in value for near in difflib.get_close_matches(key, _SIGNALS, n=1)]
        meant = f"; did you mean {nearest[0]!r}?" if nearest else ""
    raise ValueError(
        f"expected a number or a table with one of the keys {', '.join(_SIGNALS)}, found {value!r}{meant}"
    )


class _Frame(Table):
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Vector = (0.0, 0.0, 0.0)

    def frame(self) -> Frame:
        return Frame(np.array(self.position), np.array(self.rotation))


class _Place(Table):
    frame: str
    on: str


class _Body(Table):
    mass: PositiveFloat | None = None
    inertia: Inertia | None = None
    frames: dict[str, _Frame] = Field(default_factory=dict)
    superelement: Annotated[Path, Field(strict=False)] | None = None
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Vector = (0.0, 0.0, 0.0)
    place: _Place | None = None
    velocity: Vector = (0.0, 0.0, 0.0)
    angular_velocity: Vector = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _rigid_or_flexible(self) -> "_Body":
        if self.superelement is not None:
            if given := [
                key for key in ("mass", "inertia", "frames") if key in self.model_fields_set
            ]:
                raise ValueError(
                    f"the superelement brings {', '.join(given)}: give either, not both"
                )
        elif self.mass is None or self.inertia is None:
            raise ValueError("expected mass and inertia of a rigid body, or superelement")
        return self


class _Joint(Table):
    name: str
    type: str
    between: Between
    axis: Vector | None = None
    second_axis: Vector | None = None
    angle: Any = None
    distance: Any = None
    start: dict[str, float] = Field(default_factory=dict)


class _Law(Table):
    deformation: tuple[float, ...]
    force: tuple[float, ...]


class _Spring(Table):
    name: str
    type: str
    between: Between
    axis: Vector | None = None
    stiffness: Coefficients = 0.0
    damping: Coefficients = 0.0
    law: _Law | None = None
    rest: float | tuple[float, ...] | None = None


class _Motion(Table):
    name: str
    on: str
    direction: Vector | None = None
    displacement: Any = None
    axis: Vector | None = None
    angle: Any = None

    def motion(self) -> PrescribedMotion:
        owner = f"motion {self.name!r}"
        given = [
            key
            for key in ("direction", "displacement", "axis", "angle")
            if getattr(self, key) is not None
        ]
        if given == ["direction", "displacement"]:
            signal = _named(f"{owner}: displacement", self.displacement)
            return PrescribedDisplacement(self.name, self.on, np.array(self.direction), signal)
        if given == ["axis", "angle"]:
            signal = _named(f"{owner}: angle", self.angle)
            return PrescribedRotation(self.name, self.on, np.array(self.axis), signal)
        found = " and ".join(given) or "none"
        raise ModelError(
            f"{owner}: expected direction and displacement, or axis and angle, found {found}"
        )


class _Load(Table):
    type: Literal["force", "torque"]
    on: str
    direction: Vector
    signal: Any
    follower: bool = False


class _SteadyRotation(Table):
    angular_velocity: Vector
    center: Vector = (0.0, 0.0, 0.0)

    def rotation(self) -> SteadyRotation:
        return SteadyRotation(np.array(self.angular_velocity), np.array(self.center))


class _Simulation(Table):
    t_end: PositiveFloat
    gravity: Vector = (0.0, 0.0, 0.0)
    step: PositiveFloat | None = None
    rho_inf: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    rule: Literal["consistent", "paper"] = "consistent"
    history: Literal["auto", "recursive", "direct", "fft"] = "auto"
    kernel_length: PositiveFloat | None = Field(None, alias="memory")
    tolerance: PositiveFloat = 1e-10
    max_iterations: PositiveInt = 20
    fixed_iterations: PositiveInt | None = Field(None, alias="corrections")
    start: Literal["given", "equilibrium"] = "given"
    steady_rotation: _SteadyRotation | None = None
    assemble: bool = False
    redundant: Literal["error", "remove"] = "error"

    def settings(self, output: OutputRequest) -> Settings:
        given = dict(self)
        del given["gravity"]
        if self.steady_rotation is not None:
            given["steady_rotation"] = self.steady_rotation.rotation()
        return Settings(**given, output=output)


class _Ground(Table):
    frames: dict[str, _Frame] = Field(default_factory=dict)


class _Output(Table):
    every: PositiveInt = 1
    quantities: tuple[str, ...] | None = None

    def request(self) -> OutputRequest:
        return OutputRequest(self.every, self.quantities)


class _ModelFile(Table):
    simulation: _Simulation
    output: _Output = _Output()
    bodies: dict[str, _Body] = Field(min_length=1)
    ground: _Ground = _Ground()
    joints: tuple[_Joint, ...] = ()
    loads: tuple[_Load, ...] = ()
    springs: tuple[_Spring, ...] = ()
    motions: tuple[_Motion, ...] = ()


def read_model(path: str | os.PathLike[str]) -> Model:
    """Read a model file and the superelements it names; ModelError names the file, the key and what
    was found.

    Paths of superelements are relative to the model file. A superelement named by several bodies is
    read once.
    """
    path = Path(path)
    try:
        file, text = read_table(path, _ModelFile)
    except InputError as error:
        raise ModelError(str(error)) from error
    with about(path):
        return _model(file, text, path)


def _model(file: _ModelFile, text: str, path: Path) -> Model:
    superelements: dict[Path, Superelement] = {}
    return Model(
        bodies={
            name: _body(name, body, path.parent, superelements)
            for name, body in file.bodies.items()
        },
        joints=tuple(_joint(joint) for joint in file.joints),
        loads=tuple(_load(load) for load in file.loads),
        springs=tuple(_spring(spring) for spring in file.springs),
        motions=tuple(motion.motion() for motion in file.motions),
        ground_frames={name: frame.frame() for name, frame in file.ground.frames.items()},
        gravity=np.array(file.simulation.gravity),
        settings=file.simulation.settings(file.output.request()),
        source=text,
        path=str(path),
    )


def _body(name: str, body: _Body, folder: Path, superelements: dict[Path, Superelement]) -> Body:
    place = None if body.place is None else Place(body.place.frame, body.place.on)
    try:
        start = Start(
            np.array(body.position),
            np.array(body.rotation),
            place,
            np.array(body.velocity),
            np.array(body.angular_velocity),
        )
        if body.superelement is None:
            frames = {frame: table.frame() for frame, table in body.frames.items()}
            return RigidBody(float(body.mass or 0.0), np.array(body.inertia), frames, start)
        source = folder / body.superelement
        if source not in superelements:
            superelements[source] = read(source, recovery=False)
        return FlexibleBody(superelements[source], start, str(source))
    except ValueError as error:
        raise ModelError(f"bodies.{name}: {error}") from error


def _joint(joint: _Joint) -> Joint:
    drives = {}
    for key in ("angle", "distance"):
        if (value := getattr(joint, key)) is not None:
            drives[key] = _named(f"joint {joint.name!r}: {key}", value)
    axis, second = _array(joint.axis), _array(joint.second_axis)
    return Joint(joint.name, joint.type, joint.between, axis, second, start=joint.start, **drives)


def _spring(spring: _Spring) -> Spring:
    return Spring(
        spring.name,
        spring.type,
        spring.between,
        _array(spring.axis),
        np.array(spring.stiffness),
        np.array(spring.damping),
        None if spring.law is None else Law(spring.law.deformation, spring.law.force),
        None if spring.rest is None else np.array(spring.rest),
    )


def _load(load: _Load) -> Load:
    signal = _named(f"load ({load.type}) on {load.on!r}: signal", load.signal)
    return Load(load.type, load.on, np.array(load.direction), signal, load.follower)


def _array(value: Sequence[float] | None) -> Array | None:
    return None if value is None else np.array(value)


def _named(owner: str, value: Any) -> Any:
    try:
        return _signal(value)
    except ValueError as error:
        raise ModelError(f"{owner}: {error}") from error
