"""`duhamel import`: a robot or the solids of a CAD file as a model file."""

from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ...files.cad_suffixes import CAD_SUFFIXES
from ..arguments import TOML_SUFFIX, beside, file_argument, output_option
from ..failures import errors_in_one_line, one_line, unwritten

if TYPE_CHECKING:
    from ...robots import FlexibleLink

ROBOT_SUFFIXES = ".urdf", ".xml"
CAD_OPTIONS = ("robot_file", "output", "size", "scale")
RobotFile = Annotated[
    Path,
    file_argument(
        "FILE",
        "A robot in URDF, or in MJCF with mujoco; or parts in STEP, IGES or BREP with gmsh.",
        *ROBOT_SUFFIXES,
        *CAD_SUFFIXES,
    ),
]
Output = Annotated[Path | None, output_option("MODEL.toml", "Beside the robot unless given.")]
Base = Annotated[
    Literal["fixed", "free"],
    typer.Option(metavar="fixed|free", help="Whether the root link stands on the ground."),
]
Servo = Annotated[
    tuple[float, float] | None,
    typer.Option(
        metavar="KP KD",
        help="Servos at all joints, whose references are inputs named as the joints; in "
        "N m/rad and N m s/rad, of slides N/m and N s/m.",
    ),
]
ServoOf = Annotated[
    list[str] | None,
    typer.Option(metavar="JOINT=KP,KD", help="The same at one joint, where it differs."),
]
Flexible = Annotated[
    list[str] | None,
    typer.Option(
        metavar="LINK=FILE.h5,JOINT=INTERFACE,...",
        help="A superelement in place of a link, in its axes, and the interface of each joint.",
    ),
]
State = Annotated[
    list[str] | None,
    typer.Option(metavar="JOINT=VALUE", help="A coordinate at the start, in rad or m."),
]
StopStiffness = Annotated[
    float | None,
    typer.Option(
        metavar="NUMBER", help="Of all stops, in N m/rad or N/m; by the masses unless given."
    ),
]
Packages = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="DIR", help="Where package://NAME/... is, beside the folders around the robot."
    ),
]
EndTime = Annotated[float, typer.Option("--t-end", metavar="SECONDS", help="Of the simulation.")]
Step = Annotated[
    float, typer.Option(metavar="SECONDS", help="Of the simulation, unless links are flexible.")
]
GearRatio = Annotated[
    float,
    typer.Option(metavar="NUMBER", help="Of the rotors by which armatures of MJCF are modeled."),
]
Size = Annotated[
    float | None,
    typer.Option(metavar="METERS", help="Of the elements of parts of CAD, for some thousand each."),
]
Scale = Annotated[
    float | None,
    typer.Option(metavar="METERS", help="The unit of length of a .brep file, 1e-3 for mm."),
]


def import_(
    context: typer.Context,
    robot_file: RobotFile,
    output: Output = None,
    base: Base = "fixed",
    servo: Servo = None,
    servo_of: ServoOf = None,
    flexible: Flexible = None,
    state: State = None,
    stop_stiffness: StopStiffness = None,
    packages: Packages = None,
    t_end: EndTime = 1.0,
    step: Step = 5e-4,
    gear_ratio: GearRatio = 100.0,
    size: Size = None,
    scale: Scale = None,
) -> None:
    """Write the model of a robot in URDF or MJCF, or of the parts in a CAD file with body files."""
    from ... import files, robots

    of_cad = robot_file.suffix.lower() in CAD_SUFFIXES
    _require_own_options(context, CAD_OPTIONS if of_cad else None)
    if of_cad:
        _import_parts(robot_file, output, size, scale)
        return
    target = output or beside(robot_file, TOML_SUFFIX)
    try:
        options = robots.ImportOptions(
            base=base,
            servo=servo,
            servos=dict(map(_gains_of_joint, servo_of or ())),
            flexible=dict(map(_flexible_link, flexible or ())),
            state=dict(map(_start_of_joint, state or ())),
            stop_stiffness=stop_stiffness,
            packages=packages or (),
            t_end=t_end,
            step=step,
            gear_ratio=gear_ratio,
        )
    except ValueError as error:
        key, _, said = str(error).partition(": ")
        raise typer.BadParameter(f"--{key.replace('_', '-')}: {said}") from error
    with errors_in_one_line(robots, files), unwritten(target):
        imported = robots.import_robot(robot_file, target, options)
    for remark in imported.remarks:
        typer.echo(one_line(f"not taken, or otherwise: {remark}"))
    counts = {
        "body": imported.bodies,
        "joint": imported.joints,
        "stop": imported.stops,
        "motor": imported.motors,
    }
    counted = ", ".join(f"{n} {_plural(word, n)}" for word, n in counts.items())
    typer.echo(one_line(f"{target}: {counted}; {imported.mass:.4g} kg"))


def _require_own_options(context: typer.Context, own: tuple[str, ...] | None) -> None:
    """Refuse options that belong to the other kind of file."""
    for name in context.params:
        source = context.get_parameter_source(name)
        given = source is not None and source.name == "COMMANDLINE"
        foreign = name in ("size", "scale") if own is None else name not in own
        if given and foreign:
            what = "robots" if own else "CAD files"
            raise typer.BadParameter(f"--{name.replace('_', '-')}: is for {what}")


def _import_parts(
    source: Path, output: Path | None, size: float | None, scale: float | None
) -> None:
    from ... import cad
    from ..assembly import import_assembly

    target = output or beside(source, TOML_SUFFIX, "model")
    for key, value in (("size", size), ("scale", scale)):
        if value is not None and not (isfinite(value) and value > 0.0):
            raise typer.BadParameter(f"--{key}: expected a positive number [m], got {value}")
    with errors_in_one_line(cad), unwritten(target):
        imported = import_assembly(source, target, size, scale)
    for path in imported.bodies.values():
        typer.echo(one_line(path))
    n, joints = len(imported.bodies), imported.joints
    typer.echo(
        one_line(
            f"{target}: {n} {_plural('body', n)}, {joints} {_plural('joint', joints)} to "
            "uncomment; steel is assumed: look at each body file"
        )
    )


def _flexible_link(text: str) -> "tuple[str, FlexibleLink]":
    """A link and its superelement, of LINK=FILE.h5,JOINT=INTERFACE,..."""
    from ...robots import FlexibleLink

    # The file stands between the first equals sign and the first comma.
    first, *others = text.split(",")
    link, file = _pair("--flexible", first, "LINK=FILE.h5")
    interfaces = dict(_pair("--flexible", other, "JOINT=INTERFACE") for other in others)
    return link, FlexibleLink(Path(file), interfaces)


def _start_of_joint(text: str) -> tuple[str, float]:
    joint, value = _pair("--state", text, "JOINT=VALUE")
    return joint, _number("--state", joint, value)


def _gains_of_joint(text: str) -> tuple[str, tuple[float, float]]:
    joint, values = _pair("--servo-of", text, "JOINT=KP,KD")
    stiffness, comma, damping = values.partition(",")
    if not comma:
        raise typer.BadParameter(f"--servo-of: expected JOINT=KP,KD, got {text!r}")
    return joint, (_number("--servo-of", joint, stiffness), _number("--servo-of", joint, damping))


def _pair(option: str, text: str, form: str) -> tuple[str, str]:
    # Names may hold an equals sign; values, numbers and interfaces, do not.
    name, equals, value = text.rpartition("=")
    if not (name and equals and value):
        raise typer.BadParameter(f"{option}: expected {form}, got {text!r}")
    return name, value


def _number(option: str, joint: str, text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise typer.BadParameter(f"{option}: {joint}: expected a number, got {text!r}") from error


def _plural(word: str, n: int) -> str:
    if n == 1:
        return word
    return f"{word[:-1]}ies" if word.endswith("y") else f"{word}s"
